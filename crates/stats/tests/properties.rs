//! What must hold for any data.
#![expect(clippy::unwrap_used, reason = "helpers of tests may fail like tests")]

use maveric_stats::{
    Adjustment, CorrelationMethod, PosthocTest, WithinSubjects, adjust, compare, correlate,
    normality, posthoc, within,
};
use proptest::prelude::*;
use serde_json::Value;

fn labels(size: usize) -> Vec<String> {
    (0..size).map(|i| format!("n{i}")).collect()
}

fn table(rows: &[Vec<f64>]) -> WithinSubjects {
    WithinSubjects::from_rows(&labels(rows[0].len()), &labels(rows.len()), rows).unwrap()
}

/// Rows of quarter steps: exact in binary, so that shifts and scales are too.
fn rows() -> impl Strategy<Value = Vec<Vec<f64>>> {
    (3_usize..9, 2_usize..5).prop_flat_map(|(n, k)| {
        let value = (-40_i32..40).prop_map(|v| f64::from(v) * 0.25);
        prop::collection::vec(prop::collection::vec(value, k), n)
    })
}

fn changed(rows: &[Vec<f64>], change: impl Fn(f64) -> f64) -> WithinSubjects {
    let rows: Vec<Vec<f64>> = rows
        .iter()
        .map(|row| row.iter().map(|&v| change(v)).collect())
        .collect();
    table(&rows)
}

fn close(a: Option<f64>, b: Option<f64>, tolerance: f64) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() <= tolerance * (1.0 + a.abs().max(b.abs())),
        (None, None) => true,
        _ => false,
    }
}

/// The tests' statistics that neither shift, scale nor order of subjects may move.
fn statistics(data: &WithinSubjects) -> Vec<Option<f64>> {
    let a = within(data);
    let mut all = vec![
        a.rm_anova.f,
        a.rm_anova.p,
        a.rm_anova.eta2_partial,
        a.rm_anova.eta2_generalized,
        a.sphericity.gg,
        a.friedman.chi2,
        a.friedman.p_exact,
    ];
    for pair in a.paired.values() {
        all.extend([pair.t, pair.p_holm, pair.dz_ci_low]);
    }
    for pair in a.wilcoxon.values() {
        all.extend([pair.p_exact, pair.rank_biserial]);
    }
    for test in a.shapiro.values() {
        all.push(test.w);
    }
    all
}

fn finite_or_explained(value: &Value, name: &str, root: &Value, faults: &mut Vec<String>) {
    match value {
        Value::Object(map) => {
            for (key, inner) in map.iter().filter(|(key, _)| *key != "undefined") {
                let name = if name.is_empty() {
                    key.clone()
                } else {
                    format!("{name}.{key}")
                };
                finite_or_explained(inner, &name, root, faults);
            }
        }
        Value::Array(list) => {
            for (i, inner) in list.iter().enumerate() {
                finite_or_explained(inner, &format!("{name}.{i}"), root, faults);
            }
        }
        Value::Null => {
            let reasons = root["undefined"].as_object().unwrap();
            let said = reasons.keys().any(|key| {
                name.strip_prefix(key.as_str())
                    .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
            });
            if !said {
                faults.push(name.to_owned());
            }
        }
        _ => {}
    }
}

/// JSON writes NaN and infinity as null, so one look finds those too.
fn unexplained(result: &impl serde::Serialize) -> Vec<String> {
    let json = serde_json::to_value(result).unwrap();
    let mut faults = Vec::new();
    finite_or_explained(&json, "", &json, &mut faults);
    faults
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(48) })]

    #[test]
    fn a_shift_of_1e12_and_a_scale_change_no_statistic(rows in rows()) {
        let before = statistics(&table(&rows));
        // Quarter steps at 1e12 are exact; eight binary places more would not be.
        for after in [changed(&rows, |v| v + 1e12), changed(&rows, |v| v * 1024.0)] {
            for (i, (a, b)) in before.iter().zip(statistics(&after)).enumerate() {
                prop_assert!(close(*a, b, 1e-9), "{i}: {a:?} {b:?}");
            }
        }
    }

    #[test]
    fn the_order_of_subjects_does_not_matter(rows in rows()) {
        let mut turned = rows.clone();
        turned.reverse();
        for (a, b) in statistics(&table(&rows)).iter().zip(statistics(&table(&turned))) {
            prop_assert!(close(*a, b, 1e-9), "{a:?} {b:?}");
        }
    }

    #[test]
    fn the_order_of_conditions_turns_signs_and_nothing_else(rows in rows()) {
        let a = within(&table(&rows));
        let turned: Vec<Vec<f64>> = rows.iter().map(|r| r.iter().rev().copied().collect()).collect();
        let b = within(&table(&turned));
        prop_assert!(close(a.rm_anova.f, b.rm_anova.f, 1e-9));
        prop_assert!(close(a.mauchly.w, b.mauchly.w, 1e-7));
        prop_assert!(close(a.friedman.p_exact, b.friedman.p_exact, 1e-12));
        let (first, last) = (a.paired.values().next().unwrap(), b.paired.values().last().unwrap());
        prop_assert!(close(first.t, last.t.map(|t| -t), 1e-9));
    }

    #[test]
    fn epsilons_keep_to_their_range(rows in rows()) {
        let a = within(&table(&rows));
        let k = a.k as f64;
        for epsilon in a.sphericity.gg.into_iter().chain(a.sphericity.hf) {
            prop_assert!((1.0 / (k - 1.0) - 1e-12..=1.0 + 1e-12).contains(&epsilon));
        }
        if let (Some(p), Some(gg)) = (a.sphericity.p_hf, a.sphericity.p_gg) {
            prop_assert!((0.0..=1.0).contains(&p) && (0.0..=1.0).contains(&gg));
        }
    }

    #[test]
    fn every_null_has_a_reason(rows in rows()) {
        let data = table(&rows);
        prop_assert_eq!(unexplained(&within(&data)), Vec::<String>::new());
        prop_assert_eq!(unexplained(&compare(&data, 0.05).unwrap()), Vec::<String>::new());
        for test in [PosthocTest::T, PosthocTest::PooledT, PosthocTest::Wilcoxon, PosthocTest::Conover, PosthocTest::Nemenyi] {
            let result = posthoc(&data, test, Adjustment::Holm, 0.05).unwrap();
            prop_assert_eq!(unexplained(&result), Vec::<String>::new());
        }
    }

    #[test]
    fn few_levels_and_constant_columns_are_answered_too(rows in prop::collection::vec(prop::collection::vec(0..2_i32, 3), 2..6)) {
        let rows: Vec<Vec<f64>> = rows.iter().map(|r| r.iter().map(|&v| f64::from(v)).collect()).collect();
        let data = table(&rows);
        prop_assert_eq!(unexplained(&within(&data)), Vec::<String>::new());
        prop_assert_eq!(unexplained(&compare(&data, 0.05).unwrap()), Vec::<String>::new());
        let column = |j: usize| rows.iter().map(|r| Some(r[j])).collect::<Vec<_>>();
        let result = correlate(&column(0), &column(1), CorrelationMethod::All, None).unwrap();
        prop_assert_eq!(unexplained(&result), Vec::<String>::new());
        prop_assert_eq!(unexplained(&normality(&column(2)).unwrap()), Vec::<String>::new());
    }

    #[test]
    fn holm_keeps_the_order_and_lies_between_p_and_bonferroni(p in prop::collection::vec(0.0..=1.0_f64, 1..20)) {
        let all = adjust(&p).unwrap();
        for i in 0..p.len() {
            prop_assert!(p[i] <= all.holm[i] && all.holm[i] <= all.bonferroni[i]);
            prop_assert!(all.bh[i] <= all.hochberg[i] && all.hochberg[i] <= all.holm[i] + 1e-15);
            for j in 0..p.len() {
                prop_assert!(p[i] > p[j] || all.holm[i] <= all.holm[j]);
            }
        }
    }

    #[test]
    fn any_finite_numbers_are_answered(rows in prop::collection::vec(prop::collection::vec(prop::num::f64::NORMAL.prop_map(|v| v.clamp(-1e75, 1e75)), 3), 2..6)) {
        let data = table(&rows);
        prop_assert_eq!(unexplained(&within(&data)), Vec::<String>::new());
        prop_assert_eq!(unexplained(&compare(&data, 0.05).unwrap()), Vec::<String>::new());
    }
}
