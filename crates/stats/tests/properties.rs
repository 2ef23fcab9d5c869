//! What must hold for any data.
#![expect(clippy::unwrap_used, reason = "helpers of tests may fail like tests")]
#![expect(clippy::cast_possible_wrap, reason = "samples of a few values")]

use maveric_stats::{
    Adjustment, BootstrapData, BootstrapSettings, Comparison, CorrelationMethod, Interval,
    PosthocTest, Statistic, WithinAnalysis, WithinSubjects, adjust, bootstrap, compare, correlate,
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
    let rows: Vec<Vec<f64>> =
        rows.iter().map(|row| row.iter().map(|&v| change(v)).collect()).collect();
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
        all.extend([pair.t, pair.p_holm, pair.dz_ci.low]);
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
                let name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
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
    fn results_are_the_same_when_read_back(rows in rows()) {
        let data = table(&rows);
        let (analysis, comparison) = (within(&data), compare(&data, 0.05).unwrap());
        let text = serde_json::to_string(&analysis).unwrap();
        prop_assert_eq!(serde_json::from_str::<WithinAnalysis>(&text).unwrap(), analysis);
        let text = serde_json::to_string(&comparison).unwrap();
        prop_assert_eq!(serde_json::from_str::<Comparison>(&text).unwrap(), comparison);
    }

    #[test]
    fn intervals_hold_their_estimate_and_p_is_never_zero(rows in rows()) {
        let a = within(&table(&rows));
        let holds = |low: Option<f64>, value: Option<f64>, high: Option<f64>| match (low, value, high) {
            (Some(low), Some(value), Some(high)) => low <= value + 1e-9 && value <= high + 1e-9,
            _ => true,
        };
        for t in a.paired.values() {
            prop_assert!(holds(t.dz_ci.low, t.dz, t.dz_ci.high));
            prop_assert!(holds(t.gz_ci.low, t.gz, t.gz_ci.high));
            prop_assert!(holds(t.d_av_ci.low, t.d_av, t.d_av_ci.high));
            prop_assert!(t.p.is_none_or(|p| p > 0.0));
        }
        for w in a.wilcoxon.values() {
            prop_assert!(holds(w.rank_biserial_ci.low, w.rank_biserial, w.rank_biserial_ci.high));
        }
        let anova = &a.rm_anova;
        for Interval { low, high } in [
            anova.eta2_partial_ci90,
            anova.eta2_generalized_ci90,
            anova.omega2_partial_ci90,
            a.friedman.kendall_w_ci90,
        ] {
            prop_assert!(holds(Some(0.0), low, high) && holds(low, high, Some(1.0)));
            prop_assert_eq!(low.is_some(), high.is_some());
        }
        prop_assert!(anova.p.is_none_or(|p| p > 0.0) && a.friedman.p.is_none_or(|p| p > 0.0));
    }

    #[test]
    fn exact_p_of_friedman_is_that_of_every_order_of_every_subject(rows in prop::collection::vec(prop::collection::vec(0..4_i32, 3), 2..5)) {
        let rows: Vec<Vec<f64>> = rows.iter().map(|r| r.iter().map(|&v| f64::from(v)).collect()).collect();
        let found = within(&table(&rows)).friedman;
        let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
        let ranks: Vec<[i32; 3]> = rows.iter().map(|r| std::array::from_fn(|j| {
            r.iter().map(|&v| if v < r[j] { 2 } else { i32::from(v <= r[j]) }).sum()
        })).collect();
        let spread = |choice: usize| -> i32 {
            let mut sums = [0; 3];
            let mut rest = choice;
            for row in &ranks {
                for (sum, &from) in sums.iter_mut().zip(&orders[rest % 6]) {
                    *sum += row[from];
                }
                rest /= 6;
            }
            sums.iter().map(|s| s * s).sum()
        };
        let all = 6_usize.pow(rows.len() as u32);
        let hits = (0..all).filter(|&choice| spread(choice) >= spread(0)).count();
        // Without ranks to compare every order is as far out as any other.
        let p = found.p_exact.unwrap_or(1.0);
        prop_assert!((p - hits as f64 / all as f64).abs() < 1e-12, "{p} {hits} {all}");
    }

    #[test]
    fn exact_p_of_wilcoxon_is_that_of_every_change_of_sign(differences in prop::collection::vec(-6..7_i32, 2..10)) {
        let rows: Vec<Vec<f64>> = differences.iter().map(|&d| vec![f64::from(d), 0.0]).collect();
        let found = within(&table(&rows)).wilcoxon.get("n0|n1").cloned().unwrap();
        let used: Vec<i32> = differences.iter().copied().filter(|d| *d != 0).collect();
        let doubled = |d: i32| -> i32 {
            used.iter().map(|o| if o.abs() < d.abs() { 2 } else { i32::from(o.abs() == d.abs()) }).sum::<i32>() + 1
        };
        let ranks: Vec<i32> = used.iter().map(|&d| doubled(d)).collect();
        let total: i32 = ranks.iter().sum();
        let plus = |signs: usize| -> i32 { (0..used.len()).filter(|i| signs >> i & 1 == 1).map(|i| ranks[i]).sum() };
        let observed: i32 = used.iter().zip(&ranks).filter(|(d, _)| **d > 0).map(|(_, r)| r).sum();
        let all = 1_usize << used.len();
        let hits = (0..all).filter(|&s| (2 * plus(s) - total).abs() >= (2 * observed - total).abs()).count();
        match found.p_exact {
            Some(p) => prop_assert!((p - hits as f64 / all as f64).abs() < 1e-14),
            None => prop_assert!(used.is_empty()),
        }
    }

    #[test]
    fn exact_p_of_spearman_is_that_of_every_pairing(pairs in prop::collection::vec((0..5_i32, 0..5_i32), 3..7)) {
        let column = |pick: fn(&(i32, i32)) -> i32| pairs.iter().map(|p| Some(f64::from(pick(p)))).collect::<Vec<_>>();
        let (x, y) = (column(|p| p.0), column(|p| p.1));
        let found = correlate(&x, &y, CorrelationMethod::Spearman, None).unwrap().spearman.unwrap();
        let rank = |v: &[Option<f64>]| -> Vec<i64> {
            v.iter().map(|a| v.iter().map(|b| if b < a { 2 } else { i64::from(b == a) }).sum::<i64>() - v.len() as i64).collect()
        };
        let (rx, ry) = (rank(&x), rank(&y));
        let sum = |order: &[usize]| -> i64 { order.iter().zip(&rx).map(|(&j, a)| a * ry[j]).sum() };
        let mut orders: Vec<Vec<usize>> = vec![vec![]];
        for _ in 0..x.len() {
            orders = orders.iter().flat_map(|o| (0..x.len()).filter(|j| !o.contains(j)).map(|j| [o.clone(), vec![j]].concat())).collect();
        }
        let limit = sum(&(0..x.len()).collect::<Vec<_>>()).abs();
        let hits = orders.iter().filter(|o| sum(o).abs() >= limit).count();
        match found.p_exact {
            Some(p) => prop_assert!((p - hits as f64 / orders.len() as f64).abs() < 1e-12),
            None => prop_assert!(found.rho.is_none()),
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

#[test]
fn covariances_too_small_for_an_epsilon_say_so() {
    let rows = [
        [4.657e-279, 4.825e-85, 4.781e-189],
        [7.755e-134, 1.124e-265, 5.046e-90],
        [3.107e-182, 2.596e-140, 3.562e-293],
    ];
    let data = table(&rows.map(Vec::from));
    let found = compare(&data, 0.05).unwrap();
    assert!(found.omnibus.statistic.is_some() && found.omnibus.p.is_none());
    assert_eq!(unexplained(&found), Vec::<String>::new());
}

/// The ideal bootstrap: every multiset of subjects with its multinomial weight, sorted by value.
fn ideal(n: usize, value: impl Fn(&[u32]) -> Option<f64>) -> Vec<(f64, f64)> {
    fn fill(counts: &mut Vec<u32>, left: u32, n: usize, all: &mut Vec<Vec<u32>>) {
        if counts.len() + 1 == n {
            counts.push(left);
            all.push(counts.clone());
            counts.pop();
            return;
        }
        for count in 0..=left {
            counts.push(count);
            fill(counts, left - count, n, all);
            counts.pop();
        }
    }
    let mut all = Vec::new();
    fill(&mut Vec::new(), n as u32, n, &mut all);
    let factorial = |m: u32| (1..=m).map(f64::from).product::<f64>();
    let weight = |counts: &[u32]| {
        let ways = factorial(n as u32) / counts.iter().map(|&c| factorial(c)).product::<f64>();
        ways / (n as f64).powi(n as i32)
    };
    let mut values: Vec<(f64, f64)> =
        all.iter().filter_map(|counts| Some((value(counts)?, weight(counts)))).collect();
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    values
}

type Read = fn(&WithinAnalysis) -> Option<f64>;

#[test]
fn bootstrap_intervals_are_the_enumerated_ones_within_simulation_error() {
    let rows = [
        [4.0, 6.0, 5.5],
        [3.0, 4.5, 6.0],
        [5.0, 5.5, 7.0],
        [2.0, 6.0, 3.5],
        [4.5, 4.0, 6.5],
        [3.5, 5.0, 5.0],
        [1.0, 2.5, 4.0],
    ]
    .map(Vec::from);
    let data = table(&rows);
    let drawn = |counts: &[u32]| {
        let rows: Vec<Vec<f64>> =
            counts.iter().zip(&rows).flat_map(|(&c, row)| vec![row.clone(); c as usize]).collect();
        within(&table(&rows))
    };
    let statistics: [(Statistic, Read); 4] = [
        (Statistic::Eta2Partial, |a| a.rm_anova.eta2_partial),
        (Statistic::Eta2Generalized, |a| a.rm_anova.eta2_generalized),
        (Statistic::Omega2Partial, |a| a.rm_anova.omega2_partial),
        (Statistic::KendallW, |a| a.friedman.kendall_w),
    ];
    for (statistic, read) in statistics {
        let all = ideal(rows.len(), |counts| read(&drawn(counts)));
        let settings = BootstrapSettings { resamples: 20_000, seed: 11, confidence: 0.95 };
        let found = bootstrap(statistic, BootstrapData::Within(&data), &settings).unwrap();
        let share = |limit: f64, inside: fn(f64, f64) -> bool| -> f64 {
            let inner = all.iter().filter(|(v, _)| inside(*v, limit));
            inner.map(|(_, w)| w).sum()
        };
        // Five standard errors of a share of 20,000 draws; ties may sit on either side.
        let error = 5.0 * (0.025_f64 * 0.975 / 20_000.0).sqrt();
        let (low, high) = (found.percentile.low.unwrap(), found.percentile.high.unwrap());
        assert!(share(low, |v, l| v < l - 1e-12) <= 0.025 + error, "{statistic:?} {low}");
        assert!(share(low, |v, l| v <= l + 1e-12) >= 0.025 - error, "{statistic:?} {low}");
        assert!(share(high, |v, l| v > l + 1e-12) <= 0.025 + error, "{statistic:?} {high}");
        assert!(share(high, |v, l| v >= l - 1e-12) >= 0.025 - error, "{statistic:?} {high}");
        let estimate = read(&within(&data)).unwrap();
        assert!((found.estimate.unwrap() - estimate).abs() < 1e-12);
    }
}
