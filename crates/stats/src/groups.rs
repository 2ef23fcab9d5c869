//! Independent groups: every pair, and all of them at once.

mod anova;
mod games_howell;
mod kruskal;
mod mann_whitney;
mod samples;
mod t;

pub use anova::{OneWayAnova, WelchAnova};
pub use games_howell::GamesHowell;
pub use kruskal::{Dunn, Kruskal};
pub use mann_whitney::MannWhitney;
pub use t::{Hedges, MeanDifference};

pub(crate) use samples::{Sample, Samples};
pub(crate) use t::student;

use serde::{Deserialize, Serialize};

use crate::{
    Adjustment, Interval, Named, PMethod, Reasons, StatsError,
    numerics::distributions::t_quantile_two_sided,
};

/// The values of one group in short.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GroupSummary {
    /// Values.
    pub n: usize,
    /// In the unit of the values.
    pub mean: f64,
    /// Their standard deviation, with n - 1.
    pub sd: Option<f64>,
    /// The 95 % interval of the mean, by t with n - 1 degrees of freedom.
    #[serde(flatten, with = "crate::interval::ci")]
    pub ci: Interval,
}

/// Comparison of independent groups; each row is another person.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GroupsAnalysis {
    /// Values.
    pub n: usize,
    /// Groups.
    pub k: usize,
    /// Rows left out because the value is missing.
    pub missing: usize,
    /// Each group in short.
    pub desc: Named<GroupSummary>,
    /// Welch's t test of each pair, which does not assume equal variances.
    pub welch_t: Named<MeanDifference>,
    /// Student's t test of each pair, with the variance pooled over the two.
    pub student_t: Named<MeanDifference>,
    /// The standardised mean difference of each pair.
    pub hedges: Named<Hedges>,
    /// Mann and Whitney's U of each pair.
    pub mann_whitney: Named<MannWhitney>,
    /// With more than two groups: all of them at once, and pairs in their light.
    #[serde(flatten)]
    pub several: Option<SeveralGroups>,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// More than two groups.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SeveralGroups {
    /// Fisher's analysis of variance.
    pub anova: OneWayAnova,
    /// Welch's, which does not assume equal variances.
    pub welch_anova: WelchAnova,
    /// Kruskal and Wallis' test of the ranks.
    pub kruskal: Kruskal,
    /// Games and Howell's comparison of each pair: Welch's t by the studentised range.
    pub games_howell: Named<GamesHowell>,
    /// Dunn's comparison of each pair: mean ranks of all groups.
    pub dunn: Named<Dunn>,
}

/// Compares the groups named beside the values (both of shape `(rows,)`): Welch, Student, Hedges and Mann-Whitney of each pair,
/// and with more than two groups Welch's and Fisher's analysis of variance, Kruskal-Wallis, Games-Howell and Dunn.
///
/// Groups keep the order of their first appearance; a pair `A|B` means A minus B. The p values of the pairs of one test are one
/// family for Holm.
///
/// # Errors
/// [`StatsError::LengthMismatch`]; [`StatsError::NotFinite`]; [`StatsError::TooFew`] below two groups; [`StatsError::EmptyCell`] if
/// all values of a group are missing.
///
/// # Source
/// Welch (1947, 1951); Hedges (1981); Mann and Whitney (1947); Kruskal and Wallis (1952); Games and Howell (1976); Dunn (1964).
///
/// # Example
/// ```
/// let group = ["car", "car", "car", "truck", "truck", "truck", "truck"].map(str::to_owned);
/// let value = [1.0, 2.0, 4.0, 5.0, 7.0, 6.0, 9.0].map(Some);
/// let found = maveric_stats::groups(&group, &value)?;
/// let u = found.mann_whitney.get("car|truck").unwrap();
/// assert_eq!(u.u, 0.0);
/// assert!((u.p_exact.unwrap() - 2.0 / 35.0).abs() < 1e-12);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn groups(groups: &[String], values: &[Option<f64>]) -> Result<GroupsAnalysis, StatsError> {
    let samples = Samples::new(groups, values)?;
    let mut undefined = Reasons::default();
    let [welch_t, student_t] = [
        samples.pairs("welch_t", &mut undefined, t::welch),
        samples.pairs("student_t", &mut undefined, t::student),
    ]
    .map(|tests| tests.with_holm(|t| t.p, |t, p| t.p_holm = p));
    let hedges = samples.pairs("hedges", &mut undefined, t::hedges);
    let mut mann_whitney = samples.pairs("mann_whitney", &mut undefined, mann_whitney::test);
    adjust_ranks(&mut mann_whitney, &mut undefined);
    let several = (samples.all.len() > 2).then(|| {
        let (kruskal, dunn, reasons) = kruskal::tests(&samples);
        undefined.absorb("", reasons);
        let k = samples.all.len();
        SeveralGroups {
            anova: undefined.result("anova", anova::fisher(&samples)),
            welch_anova: undefined.result("welch_anova", anova::welch(&samples)),
            kruskal,
            games_howell: samples
                .pairs("games_howell", &mut undefined, |a, b| games_howell::test(a, b, k)),
            dunn,
        }
    });
    let desc = samples.all.iter().map(|s| {
        let sd = s.variance().map(f64::sqrt);
        if sd.is_none() {
            let (name, parts) = (format!("desc.{}", s.name), ["sd", "ci_low", "ci_high"]);
            undefined.note_below(&name, &parts, "the group has a single value");
        }
        let (n, mean) = (s.values.len() as f64, samples.pivot + s.mean);
        let half = sd.and_then(|sd| Some(t_quantile_two_sided(0.05, n - 1.0)? * sd / n.sqrt()));
        let summary =
            GroupSummary { n: s.values.len(), mean, sd, ci: Interval::around(mean, half) };
        (s.name.clone(), summary)
    });
    Ok(GroupsAnalysis {
        n: samples.n(),
        k: samples.all.len(),
        missing: samples.missing,
        desc: desc.collect(),
        welch_t,
        student_t,
        hedges,
        mann_whitney,
        several,
        undefined,
    })
}

/// Holm's correction of exact, normal and chosen p; the chosen p is exact only where all pairs are, so that one family is of one kind.
fn adjust_ranks(tests: &mut Named<MannWhitney>, undefined: &mut Reasons) {
    let holm = |p: Vec<Option<f64>>| Adjustment::Holm.apply_defined(&p);
    let exact = holm(tests.values().map(|t| t.p_exact).collect());
    let normal = holm(tests.values().map(|t| t.p_normal_cc).collect());
    let all_exact = exact.iter().all(Option::is_some);
    let mut missing = Vec::new();
    for ((test, exact), normal) in tests.values_mut().zip(exact).zip(normal) {
        test.p_exact_holm = exact;
        test.p_normal_cc_holm = normal;
        (test.p, test.p_holm) =
            if all_exact { (test.p_exact, exact) } else { (test.p_normal_cc, normal) };
        test.p_method =
            test.p.map(|_| if all_exact { PMethod::Exact } else { PMethod::NormalContinuity });
        missing.push(test.p.is_none());
    }
    for ((name, _), missing) in tests.iter().zip(missing) {
        if missing {
            let (name, parts) = (format!("mann_whitney.{name}"), ["p", "p_method", "p_holm"]);
            undefined.note_below(&name, &parts, "all values of the pair are equal");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(text: &str) -> Vec<String> {
        text.split(' ').map(str::to_owned).collect()
    }

    #[test]
    fn an_offset_moves_no_test() {
        let group = labels("a a a a b b b b b c c c");
        let at = |offset: f64| {
            let values: Vec<_> = [1.0, 3.0, 2.5, 4.0, 6.0, 5.5, 7.0, 3.5, 8.0, 2.0, 2.25, 9.0]
                .iter()
                .map(|v| Some(v + offset))
                .collect();
            let mut found = groups(&group, &values).unwrap();
            // The means themselves move, and are rounded as the values.
            found.desc = Named::from_iter([]);
            found
        };
        assert_eq!(at(0.0), at(1e9));
    }

    #[test]
    fn a_group_of_one_has_a_mean_and_a_reason_for_no_more() {
        let values = [1.0, 2.0, 3.0, 9.0].map(Some);
        let found = groups(&labels("a a a b"), &values).unwrap();
        let welch = found.welch_t.get("a|b").unwrap();
        assert!((welch.mean_diff + 7.0).abs() < 1e-12 && welch.t.is_none());
        assert!(found.undefined.get("welch_t.a|b.t").is_some());
        assert!(found.student_t.get("a|b").unwrap().t.is_some());
        assert!(found.several.is_none());
    }

    #[test]
    fn the_interval_of_a_rank_biserial_lies_on_either_side_of_it_by_fishers_z() {
        let values = [1.0, 2.0, 3.0, 5.0, 8.0, 4.0, 6.0, 7.0, 9.0, 10.0, 11.0].map(Some);
        let found = groups(&labels("a a a a a b b b b b b"), &values).unwrap();
        let u = found.mann_whitney.get("a|b").unwrap();
        // Of 30 pairs the first is the larger in 4: 8 over 4, 6 and 7, 5 over 4.
        let r = (4.0 - 26.0) / 30.0;
        let half = 1.959_963_984_540_054 * (12.0_f64 / 90.0).sqrt();
        for (end, expected) in [
            (Some(u.rank_biserial), r),
            (u.rank_biserial_ci.low, libm::tanh(libm::atanh(r) - half)),
            (u.rank_biserial_ci.high, libm::tanh(libm::atanh(r) + half)),
        ] {
            assert!((end.unwrap() - expected).abs() < 1e-12, "{end:?} {expected}");
        }
    }

    #[test]
    fn a_single_group_and_a_group_without_values_are_refused() {
        let one = groups(&labels("a a"), &[Some(1.0), Some(2.0)]);
        assert!(matches!(one, Err(StatsError::TooFew { found: 1, .. })));
        let empty = groups(&labels("a a b"), &[Some(1.0), Some(2.0), None]);
        assert!(matches!(empty, Err(StatsError::EmptyCell { .. })));
    }

    #[test]
    fn what_is_written_is_read_again() {
        let values = [1.0, 2.0, 3.0, 9.0, 5.0, 4.0].map(Some);
        let found = groups(&labels("a a b b c c"), &values).unwrap();
        let text = serde_json::to_string(&found).unwrap();
        assert_eq!(serde_json::from_str::<GroupsAnalysis>(&text).unwrap(), found);
    }
}
