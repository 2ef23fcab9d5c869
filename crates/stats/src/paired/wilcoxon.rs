//! Wilcoxon's signed-rank test.

use serde::{Deserialize, Serialize};

use super::signed_ranks::{MOST_EXACT, SignedRanks, Zeros};
use crate::{Interval, Reasons, numerics::distributions::fisher_interval};

/// How a p value was computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum PMethod {
    /// All rearrangements, given the ties.
    Exact,
    /// The normal approximation with ties and continuity corrected.
    NormalContinuity,
    /// The normal approximation, ties corrected.
    Normal,
    /// The t distribution.
    T,
    /// The studentised range.
    StudentizedRange,
}

/// Wilcoxon's signed-rank test.
///
/// Differences are ranked as written: 0.3 - 0.1 ties with 0.4 - 0.2, although the doubles
/// differ in their last bit. Numbers of more than 12 significant digits are rounded results, such as means of
/// items: their differences tie within four units of the 15th digit of what was subtracted. R and SciPy rank the
/// doubles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Wilcoxon {
    /// Differences that are not zero.
    pub n_used: usize,
    /// Rank sum of the positive differences.
    #[serde(rename = "W_plus")]
    pub w_plus: Option<f64>,
    /// Rank sum of the negative differences.
    #[serde(rename = "W_minus")]
    pub w_minus: Option<f64>,
    /// The normal deviate of W+, ties corrected, without continuity correction.
    pub z: Option<f64>,
    /// `p_exact` where it was computed, else `p_normal_cc`.
    pub p: Option<f64>,
    /// Which of the two `p` is.
    pub p_method: Option<PMethod>,
    /// Holm's correction of `p` over all pairs.
    pub p_holm: Option<f64>,
    /// All changes of sign, given the ties; up to 1,000 differences.
    pub p_exact: Option<f64>,
    /// Its Holm correction.
    pub p_exact_holm: Option<f64>,
    /// Normal approximation, ties corrected.
    pub p_normal: Option<f64>,
    /// The same with continuity correction.
    pub p_normal_cc: Option<f64>,
    /// Its Holm correction.
    pub p_normal_cc_holm: Option<f64>,
    /// Pratt: zeros ranked, then dropped; normal approximation.
    pub p_pratt: Option<f64>,
    /// Pratt, all changes of sign.
    pub p_pratt_exact: Option<f64>,
    /// (W+ - W-) / (W+ + W-), from -1 to 1.
    pub rank_biserial: Option<f64>,
    /// Its 95 % interval: Fisher's z with the null standard error of W.
    #[serde(flatten, with = "crate::interval::rank_biserial_ci")]
    pub rank_biserial_ci: Interval,
    /// What other programs print for the same data.
    #[serde(flatten)]
    pub compat: WilcoxonCompat,
}

/// Values that only other programs print, to compare with.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct WilcoxonCompat {
    /// SciPy's `zero_method="zsplit"`: zeros ranked and split between both sides; normal approximation. It ranks the
    /// doubles; rounded numbers are given to it with their ties.
    pub p_zsplit: Option<f64>,
    /// R's `wilcox.test(paired = TRUE)`, which ranks the doubles.
    pub p_r_default: Option<f64>,
    /// Its Holm correction.
    pub p_r_default_holm: Option<f64>,
    /// `scipy.stats.wilcoxon`, which ranks the doubles.
    pub p_scipy_auto: Option<f64>,
}

/// Compares two columns of shape `(n,)`; `keys` are their differences as written, with the ties that those have;
/// `rounded` says that some numbers are longer than stand for themselves.
pub(crate) fn test(a: &[f64], b: &[f64], keys: &[i64], rounded: bool) -> (Wilcoxon, Reasons) {
    let main = SignedRanks::from_differences(keys, Zeros::Dropped);
    let pratt =
        (main.zeros > 0).then(|| SignedRanks::from_differences(keys, Zeros::RankedThenDropped));
    let mut result = of_ranks(&main, pratt.as_ref().unwrap_or(&main));
    let raw: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    result.compat = quote_others(&result, &raw, &main);
    let split = if rounded {
        SignedRanks::from_differences(keys, Zeros::Split)
    } else {
        SignedRanks::from_differences(&raw, Zeros::Split)
    };
    result.compat.p_zsplit = split.p_normal(0.0);
    let reasons = reasons(&result);
    (result, reasons)
}

fn of_ranks(main: &SignedRanks, pratt: &SignedRanks) -> Wilcoxon {
    let n = main.ranks.len();
    let some = n > 0;
    let sum = |doubled: i64| some.then_some(0.5 * doubled as f64);
    let p_exact = main.p_exact();
    let p_pratt_exact = if pratt.ranks == main.ranks { p_exact } else { pratt.p_exact() };
    let p_normal_cc = main.p_normal(0.5).filter(|_| some);
    let biserial = some.then(|| (main.plus - main.minus) as f64 / (main.plus + main.minus) as f64);
    let interval = biserial.filter(|r| r.abs() < 1.0).map(|r| {
        let n = n as f64;
        let error = ((2.0 * n.powi(3) + 3.0 * n * n + n) / 6.0).sqrt() / (0.5 * n * (n + 1.0));
        fisher_interval(r, error)
    });
    Wilcoxon {
        n_used: n,
        w_plus: sum(main.plus),
        w_minus: sum(main.minus),
        z: main.z(0.0).filter(|_| some),
        p: p_exact.or(p_normal_cc),
        p_method: match (p_exact, p_normal_cc) {
            (Some(_), _) => Some(PMethod::Exact),
            (None, Some(_)) => Some(PMethod::NormalContinuity),
            _ => None,
        },
        p_holm: None,
        p_exact,
        p_exact_holm: None,
        p_normal: main.p_normal(0.0).filter(|_| some),
        p_normal_cc,
        p_normal_cc_holm: None,
        p_pratt: pratt.p_normal(0.0).filter(|_| some),
        p_pratt_exact,
        rank_biserial: biserial,
        rank_biserial_ci: interval.into(),
        compat: WilcoxonCompat::default(),
    }
}

/// The p values that rank raw doubles, by the rules of R 4.2 and SciPy 1.17.
fn quote_others(result: &Wilcoxon, raw: &[f64], main: &SignedRanks) -> WilcoxonCompat {
    let dropped = SignedRanks::from_differences(raw, Zeros::Dropped);
    let clean = !dropped.has_ties && dropped.zeros == 0;
    let some = !dropped.ranks.is_empty();
    let same = dropped.ranks == main.ranks && dropped.plus == main.plus;
    let exact = || {
        if same { result.p_exact } else { dropped.p_exact() }
    };
    let r_default = clean && dropped.ranks.len() < 50;
    let scipy_auto = (clean && raw.len() <= 50) || raw.len() <= 13;
    let p_exact = (some && (r_default || scipy_auto)).then(exact).flatten();
    WilcoxonCompat {
        p_r_default: if r_default { p_exact } else { dropped.p_normal(0.5).filter(|_| some) },
        p_scipy_auto: if !some {
            Some(1.0)
        } else if scipy_auto {
            p_exact
        } else {
            dropped.p_normal(0.0)
        },
        ..WilcoxonCompat::default()
    }
}

fn reasons(result: &Wilcoxon) -> Reasons {
    let mut reasons = Reasons::default();
    if result.n_used == 0 {
        let reason = "all differences are zero";
        let sums = ["W_plus", "W_minus", "z", "rank_biserial"];
        reasons.note_all(&sums, reason);
        reasons.note_ends(&["rank_biserial_ci"], reason);
        reasons.note_all(&["p_normal", "p_pratt", "p_pratt_exact", "p_method"], reason);
        for p in ["p", "p_exact", "p_normal_cc", "p_r_default"] {
            reasons.note_all(&[p, &format!("{p}_holm")], reason);
        }
        return reasons;
    }
    if result.p_exact.is_none() {
        let reason = format!("not computed: more than {MOST_EXACT} differences");
        reasons.note_all(&["p_exact", "p_exact_holm", "p_pratt_exact"], &reason);
    }
    if result.rank_biserial_ci.low.is_none() {
        let reason = "the correlation is at its limit, where Fisher's z is infinite";
        reasons.note_ends(&["rank_biserial_ci"], reason);
    }
    reasons
}

#[cfg(test)]
mod tests {
    use crate::WithinSubjects;

    #[test]
    fn the_interval_of_a_rank_biserial_lies_on_either_side_of_it_by_fishers_z() {
        let names = ["a".to_owned(), "b".to_owned()];
        let subjects: Vec<String> = (1..=6).map(|i| format!("s{i}")).collect();
        let rows = [1.0, 2.0, -3.0, 4.0, 5.0, 6.0].map(|d| vec![d, 0.0]);
        let data = WithinSubjects::from_rows(&names, &subjects, &rows).unwrap();
        let all = crate::within(&data).wilcoxon;
        let w = all.get("a|b").unwrap();
        // W+ is 18, W- 3; the standard error √91 over their sum.
        let (r, half) = (15.0 / 21.0, 1.959_963_984_540_054 * 91.0_f64.sqrt() / 21.0);
        for (end, expected) in [
            (w.rank_biserial, r),
            (w.rank_biserial_ci.low, libm::tanh(libm::atanh(r) - half)),
            (w.rank_biserial_ci.high, libm::tanh(libm::atanh(r) + half)),
        ] {
            assert!((end.unwrap() - expected).abs() < 1e-12, "{end:?} {expected}");
        }
    }
}
