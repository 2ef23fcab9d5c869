//! What is chosen for which design, and that it finds what the call of its own finds.

use super::*;
use crate::{
    ByDesign, ChosenTest, Formula, OmnibusTest, Predictor, compare, factorial, groups, ordinal,
    random_intercept,
};

/// A table of twelve people in two vehicles, in two modes on two roads.
struct Made {
    people: Vec<String>,
    mode: Vec<String>,
    road: Vec<String>,
    vehicle: Vec<Option<String>>,
    age: Vec<Option<f64>>,
    value: Vec<Option<f64>>,
}

/// Nearly normal numbers without order: 5 is a primitive root of 97.
fn noise(i: usize) -> f64 {
    let rank = (0..i).fold(5, |power, _| power * 5 % 97);
    crate::numerics::distributions::normal_quantile(f64::from(rank) / 97.0)
}

fn made() -> Made {
    let rows = 0..48;
    Made {
        people: rows.clone().map(|i| format!("p{}", i / 4)).collect(),
        mode: rows
            .clone()
            .map(|i| ["calm", "sporty"][i % 2].to_owned())
            .collect(),
        road: rows
            .clone()
            .map(|i| ["city", "country"][i / 2 % 2].to_owned())
            .collect(),
        vehicle: rows
            .clone()
            .map(|i| Some(["car", "truck"][i / 4 % 2].to_owned()))
            .collect(),
        age: rows
            .clone()
            .map(|i| Some(20.0 + (i / 4 * 7 % 12) as f64))
            .collect(),
        value: rows
            .map(|i| Some(10.0 + noise(i) + (i % 2) as f64))
            .collect(),
    }
}

impl Made {
    /// Every row; every first one a person; or the rows on one road.
    fn rows(&self, keep: impl Fn(usize) -> bool) -> Self {
        fn of<T: Clone>(all: &[T], keep: &impl Fn(usize) -> bool) -> Vec<T> {
            let kept = all.iter().enumerate().filter(|(i, _)| keep(*i));
            kept.map(|(_, cell)| cell.clone()).collect()
        }
        Self {
            people: of(&self.people, &keep),
            mode: of(&self.mode, &keep),
            road: of(&self.road, &keep),
            vehicle: of(&self.vehicle, &keep),
            age: of(&self.age, &keep),
            value: of(&self.value, &keep),
        }
    }

    fn columns(&self) -> DesignColumns<'_> {
        DesignColumns {
            subjects: &self.people,
            values: &self.value,
            ..DesignColumns::default()
        }
    }
}

fn run(data: &DesignColumns<'_>) -> ByDesign {
    compare_by_design(data, &DesignChoice::default()).unwrap()
}

#[test]
fn one_factor_within_is_the_comparison() {
    let made = made().rows(|i| i / 2 % 2 == 0);
    let data = DesignColumns {
        within: vec![("mode", &made.mode)],
        ..made.columns()
    };
    let ByDesign::OneFactor(found) = run(&data) else {
        panic!("one factor")
    };
    let table = crate::WithinSubjects::from_long(&made.people, &made.mode, &made.value).unwrap();
    assert_eq!(*found, compare(&table, 0.05).unwrap());
    assert_eq!(found.chosen, OmnibusTest::PairedT, "{:?}", found.reasons);
    assert_eq!(found.to_string().lines().count(), 1, "{found}");
}

#[test]
fn two_factors_within_and_one_of_each_kind_are_factorial() {
    let made = made();
    for (within, between) in [
        (
            vec![("mode", &made.mode[..]), ("road", &made.road[..])],
            vec![],
        ),
        (
            vec![("mode", &made.mode[..]), ("road", &made.road[..])],
            vec![("vehicle", &made.vehicle[..])],
        ),
    ] {
        let data = DesignColumns {
            within: within.clone(),
            between: between.clone(),
            ..made.columns()
        };
        let ByDesign::Factorial(found) = run(&data) else {
            panic!("several factors")
        };
        let design =
            crate::FactorialDesign::from_columns(&made.people, &within, &between, &made.value)
                .unwrap();
        assert_eq!(found.found.anova, factorial(&design));
        assert_eq!(found.chosen, ChosenTest::Factorial, "{:?}", found.reasons);
        assert_eq!(found.checks.len(), 1 + between.len());
    }
}

#[test]
fn residuals_that_are_not_normal_have_their_ranks_aligned() {
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
    let data = DesignColumns {
        within: vec![("mode", &made.mode), ("road", &made.road)],
        between: vec![("vehicle", &made.vehicle)],
        values: &value,
        ..made.columns()
    };
    let found = run(&data);
    let ByDesign::Factorial(inner) = &found else {
        panic!("two factors")
    };
    assert_eq!(inner.chosen, ChosenTest::AlignedRanks);
    assert!(
        inner.reasons[0].contains("not normal"),
        "{:?}",
        inner.reasons
    );
    let ranks = inner.found.ranks.as_ref().unwrap();
    assert_eq!(found.effects()[0].1, ranks.art.get("vehicle").unwrap().p);
}

#[test]
fn groups_are_compared_by_means_or_by_ranks() {
    let made = made().rows(|i| i % 4 == 0);
    let data = DesignColumns {
        between: vec![("vehicle", &made.vehicle)],
        ..made.columns()
    };
    let vehicle: Vec<String> = made.vehicle.iter().flatten().cloned().collect();
    let whole = groups(&vehicle, &made.value).unwrap();
    let found = run(&data);
    let ByDesign::Groups(inner) = &found else {
        panic!("groups")
    };
    assert_eq!((inner.chosen, &inner.found), (ChosenTest::WelchT, &whole));
    assert_eq!(
        found.effects()[0].1,
        whole.welch_t.values().next().unwrap().p
    );
    let choice = DesignChoice {
        scale: OutcomeScale::Ordinal,
        ..DesignChoice::default()
    };
    let ByDesign::Groups(ranked) = compare_by_design(&data, &choice).unwrap() else {
        panic!("groups")
    };
    assert_eq!(ranked.chosen, ChosenTest::MannWhitney);
}

#[test]
fn a_covariate_asks_for_a_mixed_model() {
    let made = made().rows(|i| i / 2 % 2 == 0);
    let data = DesignColumns {
        within: vec![("mode", &made.mode)],
        covariates: vec![("age", &made.age)],
        ..made.columns()
    };
    let ByDesign::Mixed(found) = run(&data) else {
        panic!("a covariate")
    };
    let mode: Vec<_> = made.mode.iter().cloned().map(Some).collect();
    let formula: Formula = "mode + age".parse().unwrap();
    let predictors = [
        ("mode", Predictor::Factor(&mode)),
        ("age", Predictor::Covariate(&made.age)),
    ];
    let alone = random_intercept(&made.people, &formula, &predictors, &made.value).unwrap();
    assert_eq!(found.found.model, alone);
    // Two conditions have a single difference: nothing to correct.
    assert!(found.found.corrected.is_empty());
}

#[test]
fn terms_within_subjects_of_a_mixed_model_are_corrected_as_those_of_the_analysis_of_variance() {
    let made = made();
    let cell: Vec<String> = made
        .mode
        .iter()
        .zip(&made.road)
        .map(|(m, r)| format!("{m} {r}"))
        .collect();
    let data = DesignColumns {
        within: vec![("cell", &cell)],
        covariates: vec![("age", &made.age)],
        ..made.columns()
    };
    let ByDesign::Mixed(found) = run(&data) else {
        panic!("a covariate")
    };
    let table = crate::WithinSubjects::from_long(&made.people, &cell, &made.value).unwrap();
    let anova = crate::rm_anova(&table);
    let term = found.found.corrected.get("cell").unwrap();
    assert!((term.epsilon - anova.sphericity.gg.unwrap()).abs() < 1e-10);
    // A covariate of the subjects takes nothing from what lies within them.
    assert!((term.p / anova.sphericity.p_gg.unwrap() - 1.0).abs() < 1e-4);
    assert_eq!(found.found.p("cell"), Some(term.p));
    assert!(found.found.p("age").is_some());
}

#[test]
fn a_missing_cell_costs_the_subject_or_asks_for_a_mixed_model() {
    let made = made().rows(|i| i / 2 % 2 == 0);
    let mut value = made.value.clone();
    value[3] = None;
    let data = DesignColumns {
        within: vec![("mode", &made.mode)],
        values: &value,
        ..made.columns()
    };
    assert_eq!(run(&data).one_factor().unwrap().dropped, ["p1"]);
    let keep = DesignChoice {
        missing: MissingCells::Mixed,
        ..DesignChoice::default()
    };
    let ByDesign::Mixed(found) = compare_by_design(&data, &keep).unwrap() else {
        panic!("a missing cell")
    };
    assert_eq!(
        (found.found.model.n_obs, found.found.model.n_subjects),
        (23, 12)
    );
    assert!(
        found.reasons[0].starts_with("1 of the subjects"),
        "{:?}",
        found.reasons
    );
    let whole = DesignColumns {
        values: &made.value,
        ..data
    };
    let found = compare_by_design(&whole, &keep).unwrap();
    assert!(found.one_factor().is_some() && found.reasons()[0].contains("nobody needs"));
}

#[test]
fn an_item_is_ordinal_and_a_measure_or_a_mean_of_items_is_not() {
    let made = made().rows(|i| i / 2 % 2 == 0);
    let answers: Vec<_> = (0..24)
        .map(|i| Some(f64::from((i * 7 + i / 5) % 5) + 1.0))
        .collect();
    let data = DesignColumns {
        within: vec![("mode", &made.mode)],
        values: &answers,
        ..made.columns()
    };
    let as_what = |scale, values: &[Option<f64>]| {
        let choice = DesignChoice {
            scale,
            ..DesignChoice::default()
        };
        let data = DesignColumns {
            values,
            ..data.clone()
        };
        compare_by_design(&data, &choice).unwrap()
    };
    let ByDesign::Ordinal(found) = as_what(OutcomeScale::Rating, &answers) else {
        panic!("an item")
    };
    let alone = ordinal(&made.people, &made.mode, &answers).unwrap();
    assert_eq!(found.found.model, alone);
    assert!(
        found
            .found
            .beside
            .as_ref()
            .unwrap()
            .wilcoxon
            .get("calm|sporty")
            .is_some()
    );
    assert!(
        as_what(OutcomeScale::Measure, &answers)
            .one_factor()
            .is_some()
    );
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
    for data in [
        DesignColumns {
            covariates: vec![("age", &made.age)],
            ..data.clone()
        },
        data,
    ] {
        assert!(matches!(
            compare_by_design(&data, &DesignChoice::default()),
            Err(StatsError::TwoGroups { .. })
        ));
    }
}
