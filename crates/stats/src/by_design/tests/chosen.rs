//! Which test a design gets.

use super::*;
use crate::apa::Statements;

#[test]
fn one_factor_within_is_the_comparison() {
    let made = made().rows(|i| i / 2 % 2 == 0);
    let data = DesignColumns { within: vec![("mode", &made.mode)], ..made.columns() };
    let ByDesign::OneFactor(found) = run(&data) else { panic!("one factor") };
    let table = crate::WithinSubjects::from_long(&made.people, &made.mode, &made.value).unwrap();
    assert_eq!(*found, compare(&table, 0.05).unwrap());
    assert_eq!(found.chosen, OmnibusTest::PairedT, "{:?}", found.reasons);
    assert_eq!(found.to_string().lines().count(), 1, "{found}");
}

#[test]
fn two_factors_within_and_one_of_each_kind_are_factorial() {
    let made = made();
    for (within, between) in [
        (vec![("mode", &made.mode[..]), ("road", &made.road[..])], vec![]),
        (
            vec![("mode", &made.mode[..]), ("road", &made.road[..])],
            vec![("vehicle", &made.vehicle[..])],
        ),
    ] {
        let data =
            DesignColumns { within: within.clone(), between: between.clone(), ..made.columns() };
        let found = factorial_of(run(&data));
        let design =
            crate::FactorialDesign::from_columns(&made.people, &within, &between, &made.value)
                .unwrap();
        let anova = factorial(&design);
        assert_eq!(found.found.anova, anova);
        assert_eq!(found.chosen, ChosenTest::Factorial, "{:?}", found.reasons);
        assert_eq!(found.checks.len(), 1 + between.len());
        assert_eq!(found.found.tests.len(), anova.anova.len());
        for (name, test) in found.found.tests.iter() {
            let effect = anova.anova.get(name).unwrap();
            if between.is_empty() {
                assert_eq!((test.statistic, test.p), (effect.f, effect.p), "{name}");
                assert_eq!(test.df2, Some(effect.df2 as f64));
            } else {
                assert_eq!(test.method, EffectMethod::Unpooled);
            }
        }
    }
}

#[test]
fn residuals_that_are_not_normal_have_the_ranks_of_their_contrasts() {
    let made = made();
    let twice = DesignColumns {
        within: vec![("mode", &made.mode)],
        between: vec![("vehicle", &made.vehicle)],
        ..made.columns()
    };
    assert!(matches!(
        compare_by_design(&twice, &DesignChoice::default()),
        Err(StatsError::DoubleCell { .. })
    ));
    let value: Vec<_> = (0..48).map(|i| Some((3.0 * noise(i)).exp())).collect();
    let data = DesignColumns { values: &value, ..made.grouped() };
    let found = run(&data);
    let ByDesign::Factorial(inner) = &found else { panic!("two factors") };
    assert_eq!(inner.chosen, ChosenTest::Ranks);
    assert!(inner.reasons[0].contains("not normal"), "{:?}", inner.reasons);
    let test = |name: &str| inner.found.tests.get(name).unwrap();
    assert_eq!(found.effects()[0].1, test("vehicle").p);
    // The vehicles' ranks are those of the subjects' means.
    let means: Vec<_> = value.chunks(4).map(|cells| cells.iter().copied().sum()).collect();
    let vehicle: Vec<String> = (0..12).map(|i| ["car", "truck"][i % 2].to_owned()).collect();
    let alone = groups(&vehicle, &means).unwrap();
    let alone = alone.mann_whitney.values().next().unwrap();
    assert_eq!((test("vehicle").statistic, test("vehicle").p), (Some(alone.u), alone.p));
    // The mode's are those of the differences: rows calm, sporty on each road.
    let pairs: Vec<Vec<f64>> = value
        .chunks(4)
        .map(|c| c.iter().map(|v| v.unwrap()).collect::<Vec<f64>>())
        .map(|c| vec![c[0] + c[2], c[1] + c[3]])
        .collect();
    let people: Vec<String> = (0..12).map(|i| i.to_string()).collect();
    let names = ["calm".to_owned(), "sporty".to_owned()];
    let table = crate::WithinSubjects::from_rows(&names, &people, &pairs).unwrap();
    let signed = crate::within(&table).wilcoxon;
    assert_eq!(test("mode").p, signed.values().next().unwrap().p);
    assert_eq!(test("mode").method, EffectMethod::SignedRanks);
    assert_eq!(test("vehicle:mode").method, EffectMethod::Unpooled);
}

#[test]
fn groups_are_compared_by_means_or_by_ranks() {
    let made = made().rows(|i| i % 4 == 0);
    let data = DesignColumns { between: vec![("vehicle", &made.vehicle)], ..made.columns() };
    let vehicle: Vec<String> = made.vehicle.iter().flatten().cloned().collect();
    let whole = groups(&vehicle, &made.value).unwrap();
    let found = run(&data);
    let ByDesign::Groups(inner) = &found else { panic!("groups") };
    assert_eq!((inner.chosen, &inner.found), (ChosenTest::WelchT, &whole));
    assert_eq!(found.effects()[0].1, whole.welch_t.values().next().unwrap().p);
    let choice = DesignChoice { scale: OutcomeScale::Ordinal, ..DesignChoice::default() };
    let ByDesign::Groups(ranked) = compare_by_design(&data, &choice).unwrap() else {
        panic!("groups")
    };
    assert_eq!(ranked.chosen, ChosenTest::MannWhitney);
}

#[test]
fn of_two_groups_the_unpooled_test_is_welchs() {
    let made = made();
    let value: Vec<_> =
        (0..48).map(|i| Some(10.0 + noise(i) * [1.0, 3.0][i / 4 % 2] + (i % 2) as f64)).collect();
    let data = DesignColumns { values: &value, ..made.grouped() };
    let found = factorial_of(run(&data));
    let vehicle: Vec<String> = (0..12).map(|i| ["car", "truck"][i % 2].to_owned()).collect();
    // Sums over the cells, with the sign that each has in the effect.
    for (name, signs) in [
        ("vehicle", [1.0, 1.0, 1.0, 1.0]),
        ("vehicle:mode", [1.0, -1.0, 1.0, -1.0]),
        ("vehicle:mode:road", [1.0, -1.0, -1.0, 1.0]),
    ] {
        let sums: Vec<_> = value
            .chunks(4)
            .map(|cells| Some(cells.iter().zip(signs).map(|(v, s)| s * v.unwrap()).sum()))
            .collect();
        let welch = groups(&vehicle, &sums).unwrap();
        let welch = welch.welch_t.values().next().unwrap();
        let test = found.found.tests.get(name).unwrap();
        assert!((test.statistic.unwrap() / welch.t.unwrap().powi(2) - 1.0).abs() < 1e-9, "{name}");
        assert!((test.df1.unwrap() - 1.0).abs() < 1e-9);
        assert!((test.df2.unwrap() / welch.df.unwrap() - 1.0).abs() < 1e-9, "{name}");
        assert!((test.p.unwrap() / welch.p.unwrap() - 1.0).abs() < 1e-9, "{name}");
    }
}

#[test]
fn an_item_with_two_factors_within_takes_the_rank_tests() {
    let made = made();
    let answers: Vec<_> =
        (0..48).map(|i| Some((3.0 + 1.2 * noise(i)).round().clamp(1.0, 5.0))).collect();
    let data = DesignColumns { values: &answers, ..made.within() };
    let of = |scale| {
        let choice = DesignChoice { scale, ..DesignChoice::default() };
        let found = factorial_of(compare_by_design(&data, &choice).unwrap());
        found.chosen
    };
    assert_eq!(of(OutcomeScale::Rating), ChosenTest::Ranks);
    assert_eq!(of(OutcomeScale::Ordinal), ChosenTest::Ranks);
    assert_eq!(of(OutcomeScale::Measure), ChosenTest::Factorial);
}

/// Twelve people in three modes on three roads, far from normal; every mode lies this far above the one before.
fn three_by_three(step: f64) -> Made {
    let rows = 0..12 * 9;
    let three = |of: fn(usize) -> usize| -> Vec<String> {
        (0..12 * 9).map(|i| format!("l{}", of(i) % 3)).collect()
    };
    Made {
        people: rows.clone().map(|i| format!("p{}", i / 9)).collect(),
        mode: three(|i| i),
        road: three(|i| i / 3),
        vehicle: Vec::new(),
        age: Vec::new(),
        value: rows.map(|i| Some((2.5 * noise(i)).exp() + step * (i % 3) as f64)).collect(),
    }
}

#[test]
fn larger_interactions_without_a_rank_test_say_so() {
    let found = factorial_of(run(&three_by_three(0.0).within()));
    let test = |name: &str| found.found.tests.get(name).unwrap();
    assert_eq!(test("mode").method, EffectMethod::Friedman);
    assert_eq!(test("mode:road").method, EffectMethod::StrataGreenhouseGeisser);
    let gg = found.found.anova.sphericity.get("mode:road").unwrap();
    assert_eq!((test("mode:road").epsilon, test("mode:road").p), (gg.gg, gg.p_gg));
    assert!(
        found.reasons.iter().any(|r| r.starts_with("mode:road: ") && r.contains("no rank test"))
    );
}

#[test]
fn levels_that_everybody_orders_alike_are_tested_by_chi_squared_as_f_has_no_bound() {
    let said = |step: f64| {
        let made = three_by_three(step);
        let found = factorial_of(run(&made.within()));
        let unbounded = found.reasons.iter().any(|r| r.contains("F has no bound"));
        let sentences = found.found.statements();
        let of_mode = sentences.into_iter().find(|(name, _)| name == "mode");
        let simple = simple_effects(&made.within(), &found).unwrap();
        let at_a_road = simple.into_iter().find(|s| s.factor == "mode").unwrap();
        let at_a_road = at_a_road.statement(at_a_road.p_holm.unwrap()).unwrap();
        let test = found.found.tests.get("mode").unwrap().clone();
        (test, unbounded, of_mode.unwrap().1, at_a_road)
    };
    // The values beside the steps are below 400.
    let (alike, unbounded, sentence, at_a_road) = said(1000.0);
    assert!(alike.is_unanimous() && unbounded);
    assert_eq!((alike.df1, alike.df2), (Some(2.0), None));
    let sentence = sentence.to_string();
    assert_eq!(sentence, "χ²(2, N = 12) = 24.00, p < .001");
    assert_eq!(at_a_road.to_string(), "χ²(2) = 24.00, p < .001");
    let (apart, unbounded, sentence, _) = said(0.0);
    assert!(!apart.is_unanimous() && !unbounded);
    assert_eq!((apart.df1, apart.df2), (Some(2.0), Some(22.0)));
    assert!(sentence.to_string().starts_with("F(2, 22) = "), "{sentence}");
}

#[test]
fn a_missing_cell_costs_the_subject_or_asks_for_a_mixed_model() {
    let made = made().rows(|i| i / 2 % 2 == 0);
    let mut value = made.value.clone();
    value[3] = None;
    let data =
        DesignColumns { within: vec![("mode", &made.mode)], values: &value, ..made.columns() };
    assert_eq!(run(&data).one_factor().unwrap().dropped, ["p1"]);
    let keep = DesignChoice { missing: MissingCells::Mixed, ..DesignChoice::default() };
    let ByDesign::Mixed(found) = compare_by_design(&data, &keep).unwrap() else {
        panic!("a missing cell")
    };
    assert_eq!((found.found.model.n_obs, found.found.model.n_subjects), (23, 12));
    assert!(found.reasons[0].starts_with("1 of the subjects"), "{:?}", found.reasons);
    let whole = DesignColumns { values: &made.value, ..data };
    let found = compare_by_design(&whole, &keep).unwrap();
    assert!(found.one_factor().is_some() && found.reasons()[0].contains("nobody needs"));
}

#[test]
fn an_item_is_ordinal_and_a_measure_or_a_mean_of_items_is_not() {
    let made = made().rows(|i| i / 2 % 2 == 0);
    let answers: Vec<_> = (0..24).map(|i| Some(f64::from((i * 7 + i / 5) % 5) + 1.0)).collect();
    let data =
        DesignColumns { within: vec![("mode", &made.mode)], values: &answers, ..made.columns() };
    let as_what = |scale, values: &[Option<f64>]| {
        let choice = DesignChoice { scale, ..DesignChoice::default() };
        let data = DesignColumns { values, ..data.clone() };
        compare_by_design(&data, &choice).unwrap()
    };
    let ByDesign::Ordinal(found) = as_what(OutcomeScale::Rating, &answers) else {
        panic!("an item")
    };
    let alone = ordinal(&made.people, &made.mode, &answers).unwrap();
    assert_eq!(found.found.model, alone);
    assert!(found.found.beside.as_ref().unwrap().wilcoxon.get("calm|sporty").is_some());
    assert!(as_what(OutcomeScale::Measure, &answers).one_factor().is_some());
    let means: Vec<_> = answers.iter().map(|a| a.map(|a| a + 1.0 / 3.0)).collect();
    let found = as_what(OutcomeScale::Rating, &means);
    assert!(found.one_factor().is_some() && found.reasons()[0].contains("mean of items"));
}

#[test]
fn a_subject_in_two_groups_is_refused_in_every_design() {
    let mut made = made().rows(|i| i / 2 % 2 == 0);
    made.vehicle[0] = Some("truck".to_owned());
    let data = DesignColumns {
        within: vec![("mode", &made.mode)],
        between: vec![("vehicle", &made.vehicle)],
        ..made.columns()
    };
    for data in [DesignColumns { covariates: vec![("age", &made.age)], ..data.clone() }, data] {
        assert!(matches!(
            compare_by_design(&data, &DesignChoice::default()),
            Err(StatsError::TwoGroups { .. })
        ));
    }
}
