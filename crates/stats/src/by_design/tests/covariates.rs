//! Covariates, alone and multiplied by an effect.

use super::*;

/// Within people, two modes on two roads, a covariate of people that `value` leans on.
fn with_age(with: Vec<(&'static str, Vec<&'static str>)>) -> (Chosen<FactorialFinding>, Made) {
    let mut made = made();
    for (i, value) in made.value.iter_mut().enumerate() {
        let age = made.age[i].unwrap();
        *value = value.map(|v| v + 0.2 * age + 0.05 * age * (i % 2) as f64);
    }
    let data = DesignColumns { covariates: vec![("age", &made.age)], with, ..made.within() };
    (factorial_of(run(&data)), made)
}

#[test]
fn a_covariate_of_people_changes_no_effect_within_them() {
    let (found, made) = with_age(Vec::new());
    let within = [("mode", &made.mode[..]), ("road", &made.road[..])];
    let design =
        crate::FactorialDesign::from_columns(&made.people, &within, &[], &made.value).unwrap();
    for (name, effect) in factorial(&design).anova.iter() {
        let test = found.found.tests.get(name).unwrap();
        assert_eq!((test.statistic, test.p), (effect.f, effect.p), "{name}");
        assert_eq!((test.df1, test.df2), (Some(1.0), Some(11.0)), "{name}");
    }
    // Between people: the regression of their means on their ages.
    let ages: Vec<f64> = made.age.chunks(4).map(|a| a[0].unwrap()).collect();
    let means: Vec<f64> = made
        .value
        .chunks(4)
        .map(|cells| cells.iter().map(|v| v.unwrap()).sum::<f64>() / 4.0)
        .collect();
    let r = crate::correlate(
        &ages.into_iter().map(Some).collect::<Vec<_>>(),
        &means.into_iter().map(Some).collect::<Vec<_>>(),
        crate::CorrelationMethod::Pearson,
        None,
    )
    .unwrap();
    let r = r.pearson.unwrap();
    let age = found.found.tests.get("age").unwrap();
    assert_eq!((age.df1, age.df2), (Some(1.0), Some(10.0)));
    assert!((age.p.unwrap() / r.p.unwrap() - 1.0).abs() < 1e-9);
    assert!(found.found.tests.get("age:mode").is_none());
}

#[test]
fn a_declared_product_takes_a_degree_of_freedom_of_its_effect_alone() {
    let (found, made) = with_age(vec![("age", vec!["mode"])]);
    let test = |name: &str| found.found.tests.get(name).unwrap();
    assert_eq!(test("mode").df2, Some(10.0));
    assert_eq!(test("road").df2, Some(11.0));
    assert_eq!(test("mode:road").df2, Some(11.0));
    // The product is the regression of the differences on age; at the mean age the effect's estimate is as without it.
    let differences: Vec<_> = made
        .value
        .chunks(4)
        .map(|c| Some(c[0].unwrap() - c[1].unwrap() + c[2].unwrap() - c[3].unwrap()))
        .collect();
    let ages: Vec<_> = made.age.chunks(4).map(|a| a[0]).collect();
    let r = crate::correlate(&ages, &differences, crate::CorrelationMethod::Pearson, None).unwrap();
    let r = r.pearson.unwrap();
    assert!((test("age:mode").p.unwrap() / r.p.unwrap() - 1.0).abs() < 1e-9);
    let plain = with_age(Vec::new()).0;
    let before = plain.found.tests.get("mode").unwrap();
    // F = SS / MSe: the same SS, an error less what age explains of it.
    let rest = (1.0 - r.r.unwrap().powi(2)) * 11.0 / 10.0;
    let ratio = before.statistic.unwrap() / test("mode").statistic.unwrap();
    assert!((ratio / rest - 1.0).abs() < 1e-9);
}

#[test]
fn an_effect_that_no_covariate_can_be_multiplied_by_is_refused() {
    let made = made();
    let of = |with: Vec<(&'static str, Vec<&'static str>)>| {
        let data = DesignColumns { covariates: vec![("age", &made.age)], with, ..made.within() };
        compare_by_design(&data, &DesignChoice::default())
    };
    let refused = of(vec![("age", vec!["weather"])]).unwrap_err().to_string();
    assert!(refused.contains("weather") && refused.contains("mode, road, mode:road"), "{refused}");
    assert!(of(vec![("speed", vec!["mode"])]).is_err());
    assert!(of(vec![("age", vec!["mode:road"])]).is_ok());
}

#[test]
fn a_declared_product_is_tested_where_people_with_gaps_stay_too() {
    let (_, mut made) = with_age(Vec::new());
    made.value[5] = None;
    let data = DesignColumns {
        covariates: vec![("age", &made.age)],
        with: vec![("age", vec!["mode:road"])],
        ..made.within()
    };
    let choice = DesignChoice { missing: MissingCells::Mixed, ..DesignChoice::default() };
    let found = compare_by_design(&data, &choice).unwrap();
    let effects: Vec<&str> = found.effects().into_iter().map(|(name, _)| name).collect();
    assert_eq!(effects, ["mode", "road", "age", "mode:road", "age:mode:road"]);
    assert!(found.effects()[4].1.is_some());
    let unknown = DesignColumns { with: vec![("age", vec!["weather"])], ..data };
    assert!(compare_by_design(&unknown, &choice).is_err());
}

#[test]
fn a_person_without_the_covariate_is_left_out_by_name() {
    let mut made = made();
    for row in 8..12 {
        made.age[row] = None;
    }
    let data = DesignColumns { covariates: vec![("age", &made.age)], ..made.within() };
    let found = factorial_of(run(&data));
    assert_eq!(found.found.anova.dropped, ["p2"]);
    assert_eq!(found.found.tests.get("age").unwrap().df2, Some(9.0));
}

#[test]
fn a_covariate_that_changes_within_people_asks_for_a_mixed_model_with_a_variance_by_factor() {
    let mut made = made();
    for (i, age) in made.age.iter_mut().enumerate() {
        *age = age.map(|a| a + (i * 5 % 7) as f64);
    }
    let data = DesignColumns { covariates: vec![("age", &made.age)], ..made.within() };
    let ByDesign::Mixed(found) = run(&data) else { panic!("a covariate that changes") };
    let [mode, road] =
        [&made.mode, &made.road].map(|c| c.iter().cloned().map(Some).collect::<Vec<_>>());
    let formula: Formula = "mode*road + age".parse().unwrap();
    let predictors = [
        ("mode", Predictor::Factor(&mode)),
        ("road", Predictor::Factor(&road)),
        ("age", Predictor::Covariate(&made.age)),
    ];
    let by = ["mode", "road"];
    let alone = random_by_factor(&made.people, &formula, &by, &predictors, &made.value).unwrap();
    assert_eq!(found.found.model, alone);
    assert_eq!(found.found.model.variance_by.len(), 2);
}

#[test]
fn one_factor_with_a_covariate_of_people_is_that_of_the_analysis_of_variance() {
    let made = made();
    let cell: Vec<String> =
        made.mode.iter().zip(&made.road).map(|(m, r)| format!("{m} {r}")).collect();
    let data = DesignColumns {
        within: vec![("cell", &cell)],
        covariates: vec![("age", &made.age)],
        ..made.columns()
    };
    let found = factorial_of(run(&data));
    let table = crate::WithinSubjects::from_long(&made.people, &cell, &made.value).unwrap();
    let whole = compare(&table, 0.05).unwrap();
    let test = found.found.tests.get("cell").unwrap();
    assert!((test.p.unwrap() / whole.omnibus.p.unwrap() - 1.0).abs() < 1e-9);
    assert_eq!(test.correction, whole.omnibus.correction);
    assert!(found.found.tests.get("age").unwrap().p.is_some());
}
