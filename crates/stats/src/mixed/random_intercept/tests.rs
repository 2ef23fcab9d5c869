//! The model against R, and its refusals.

use super::*;

struct Made {
    people: Vec<String>,
    mode: Vec<Option<String>>,
    speed: Vec<Option<f64>>,
    y: Vec<Option<f64>>,
}

/// Six people, three modes, a speed.
fn made() -> Made {
    let row = |i: usize| (i * 37 % 11) as f64;
    Made {
        people: (0..18).map(|i| (i / 3).to_string()).collect(),
        mode: (0..18).map(|i| Some(["calm", "mean", "sporty"][i % 3].to_owned())).collect(),
        speed: (0..18).map(|i| Some(row(i) + 0.5 * (i % 4) as f64)).collect(),
        y: (0..18).map(|i| Some(row(i + 5) * 0.3 + (i / 3) as f64 + (i % 3) as f64)).collect(),
    }
}

fn run(made: &Made, formula: &str) -> Result<RandomIntercept, StatsError> {
    let predictors = [
        ("mode", Predictor::Factor(&made.mode)),
        ("speed", Predictor::Covariate(&made.speed)),
        ("again", Predictor::Covariate(&made.speed)),
    ];
    random_intercept(&made.people, &formula.parse()?, &predictors, &made.y)
}

#[test]
fn one_factor_without_gaps_is_the_analysis_of_variance() {
    let made = made();
    let fit = run(&made, "mode").unwrap();
    let mode: Vec<String> = made.mode.iter().flatten().cloned().collect();
    let data = crate::WithinSubjects::from_long(&made.people, &mode, &made.y).unwrap();
    let anova = crate::rm_anova(&data).rm_anova;
    let term = fit.anova.get("mode").unwrap();
    assert!((term.f / anova.f.unwrap() - 1.0).abs() < 1e-6);
    assert!((term.df2.unwrap() - anova.df2 as f64).abs() < 1e-4);
    assert_eq!(fit.emm.get("mode").unwrap().len(), 3);
    assert!(fit.variance.subject.unwrap() > 0.0 && fit.icc.unwrap() > 0.0);
    // Without gaps a pair over the pooled error is the t test of the analysis of variance.
    let pooled = crate::within(&data).pooled;
    for (name, pair) in fit.contrast.get("mode").unwrap().iter() {
        let known = pooled.get(name).unwrap();
        assert!((pair.t / known.t.unwrap() - 1.0).abs() < 1e-6, "{name}");
        assert!((pair.p_holm.unwrap() / known.p_holm.unwrap() - 1.0).abs() < 1e-4);
    }
}

#[test]
fn people_may_differ_a_million_times_more_than_their_rows() {
    for step in [0.3, 1e-3, 1e-6] {
        let mut made = made();
        let row = |i: usize| (i * 37 % 11) as f64;
        let y = (0..18).map(|i| row(i + 5) * step + (i / 3) as f64 + (i % 3) as f64);
        made.y = y.map(Some).collect();
        let fit = run(&made, "mode").unwrap();
        let mode: Vec<String> = made.mode.iter().flatten().cloned().collect();
        let data = crate::WithinSubjects::from_long(&made.people, &mode, &made.y).unwrap();
        let anova = crate::rm_anova(&data);
        // Without gaps the estimates are those of the mean squares.
        let squares = &anova.rm_anova;
        let residual = squares.ss_error / squares.df2 as f64;
        let subject = (squares.ss_subject / 5.0 - residual) / 3.0;
        let (term, mean) = (fit.anova.get("mode").unwrap(), anova.desc.get("calm").unwrap());
        assert!((term.f / squares.f.unwrap() - 1.0).abs() < 1e-6, "{step}: {}", term.f);
        assert!((term.df2.unwrap() - 10.0).abs() < 1e-3, "{step}: {:?}", term.df2);
        assert!((fit.variance.residual / residual - 1.0).abs() < 1e-6, "{step}");
        assert!((fit.variance.subject.unwrap() / subject - 1.0).abs() < 1e-6, "{step}");
        let calm = fit.emm.get("mode").unwrap().get("calm").unwrap();
        assert!((calm.mean - mean.mean).abs() < 1e-9, "{step}: {}", calm.mean);
    }
}

#[test]
fn what_leaves_nothing_but_rounding_within_subjects_is_refused() {
    for shift in [0.0, 0.1] {
        let mut made = made();
        let y = (0..18).map(|i| f64::from(i / 3) * (1.0 + shift) + f64::from(i % 3) * 1.1);
        made.y = y.map(Some).collect();
        let refused = run(&made, "mode").unwrap_err();
        assert!(refused.to_string().contains("is rounding"), "{refused}");
    }
}

#[test]
fn a_factor_in_a_product_is_tested_at_the_mean_of_the_covariate() {
    let age = [30.0, 44.0, 52.0, 35.0, 61.0, 48.0];
    let a = [1.0, 2.0, 3.0, 1.5, 2.5, 2.0];
    let b = [2.2, 2.9, 3.4, 3.0, 2.6, 2.5];
    let people: Vec<String> = (0..12).map(|i| (i / 2).to_string()).collect();
    let mode = (0..12).map(|i| Some(["a", "b"][i % 2].to_owned()));
    let mode: Vec<Option<String>> = mode.collect();
    let y = (0..12).map(|i| Some([a, b][i % 2][i / 2]));
    let y: Vec<Option<f64>> = y.collect();
    let of = |formula: &str, shift: f64| {
        let age: Vec<_> = (0..12).map(|i| Some(age[i / 2] + shift)).collect();
        let predictors = [("age", Predictor::Covariate(&age)), ("mode", Predictor::Factor(&mode))];
        random_intercept(&people, &formula.parse().unwrap(), &predictors, &y).unwrap()
    };
    let fit = of("age*mode", 0.0);
    let term = fit.anova.get("mode").unwrap();
    // Least squares of a - b on age less its mean, in numpy: F(1, 4); at an age of 0 it would be 53.38.
    assert!((term.f - 83.801_980_198).abs() < 1e-6, "{}", term.f);
    let pair = fit.contrast.get("mode").unwrap().get("a|b").unwrap();
    assert!((term.f / pair.t.powi(2) - 1.0).abs() < 1e-9);
    let moved = of("age*mode", 1000.0);
    assert!((moved.anova.get("mode").unwrap().f / term.f - 1.0).abs() < 1e-6);
    // The coefficient of the product's factor is at 0, as it is written.
    let [near, far] = [&fit, &moved].map(|fit| fit.coef.get("mode[b]").unwrap().estimate);
    assert!((near - far).abs() > 1.0, "{near} {far}");
}

#[test]
fn pairs_of_an_interaction_differ_in_one_factor() {
    let made = made();
    let side = (0..18).map(|i| Some(["left", "right"][i / 9].to_owned()));
    let side: Vec<Option<String>> = side.collect();
    let predictors = [("mode", Predictor::Factor(&made.mode)), ("side", Predictor::Factor(&side))];
    let formula = "mode*side".parse().unwrap();
    let fit = random_intercept(&made.people, &formula, &predictors, &made.y).unwrap();
    let pairs = fit.contrast.get("mode:side").unwrap();
    // Three of the sides at each mode, three of the modes at each side.
    assert_eq!(pairs.len(), 3 + 2 * 3);
    let means = fit.emm.get("mode:side").unwrap();
    let pair = pairs.get("calm:left|calm:right").unwrap();
    let [a, b] = ["calm:left", "calm:right"].map(|cell| means.get(cell).unwrap().mean);
    assert!((pair.estimate - (a - b)).abs() < 1e-12);
}

#[test]
fn single_rows_are_an_analysis_of_covariance() {
    // y = 1 + 2 x + 3 (group b), and residuals of +-1/4 that are orthogonal to all columns.
    let people: Vec<String> = (0..8).map(|i| i.to_string()).collect();
    let group: Vec<_> = (0..8).map(|i| Some(["a", "b"][i / 4].to_owned())).collect();
    let x = [1.0, 2.0, 3.0, 4.0, 1.0, 2.0, 3.0, 4.0];
    let rest = [1.0, -1.0, -1.0, 1.0, -1.0, 1.0, 1.0, -1.0];
    let y: Vec<_> =
        (0..8).map(|i| Some(1.0 + 2.0 * x[i] + 3.0 * (i / 4) as f64 + 0.25 * rest[i])).collect();
    let x = x.map(Some);
    let predictors = [("group", Predictor::Factor(&group)), ("x", Predictor::Covariate(&x))];
    let fit = random_intercept(&people, &"group + x".parse().unwrap(), &predictors, &y).unwrap();
    let group = fit.coef.get("group[b]").unwrap();
    // s² = 8/16 / (8 - 3) = .1; var = s² (1/4 + 1/4).
    assert!((group.estimate - 3.0).abs() < 1e-12 && (group.df.unwrap() - 5.0).abs() < 1e-9);
    assert!((group.se.unwrap() - 0.05_f64.sqrt()).abs() < 1e-12);
    assert_eq!((fit.variance.subject, fit.icc), (None, None));
    let reason = fit.undefined.get("variance.subject").unwrap();
    assert!(reason.contains("a single row"), "{reason}");
    assert!((fit.variance.residual - 0.1).abs() < 1e-12);
}

#[test]
fn offsets_of_value_and_covariate_move_the_intercept_alone() {
    let near = made();
    let mut far = made();
    far.y = far.y.iter().map(|v| v.map(|v| v + 1e8)).collect();
    far.speed = far.speed.iter().map(|v| v.map(|v| v + 1e6)).collect();
    let (near, far) = (run(&near, "mode + speed").unwrap(), run(&far, "mode + speed").unwrap());
    for name in ["mode[mean]", "mode[sporty]", "speed"] {
        let (a, b) = (near.coef.get(name).unwrap(), far.coef.get(name).unwrap());
        assert!((a.estimate - b.estimate).abs() < 1e-6, "{name}");
        assert!((a.df.unwrap() / b.df.unwrap() - 1.0).abs() < 1e-4, "{name}");
    }
    let slope = far.coef.get("speed").unwrap().estimate;
    let moved = far.coef.get("(Intercept)").unwrap().estimate - 1e8 + slope * 1e6;
    assert!((moved - near.coef.get("(Intercept)").unwrap().estimate).abs() < 1e-5);
}

#[test]
fn what_cannot_be_fitted_is_refused_by_name() {
    let said = |formula: &str| run(&made(), formula).unwrap_err();
    assert!(matches!(said("speed + again"), StatsError::Collinear { name } if name == "again"));
    assert!(matches!(said("week"), StatsError::Formula { text, .. } if text == "week"));
    let mut flat = made();
    flat.y = vec![Some(3.0); 18];
    assert!(matches!(run(&flat, "mode"), Err(StatsError::NoFit { .. })));
    let mut one = made();
    one.mode = vec![Some("calm".to_owned()); 18];
    assert!(matches!(run(&one, "mode"), Err(StatsError::OneLevel { .. })));
}
