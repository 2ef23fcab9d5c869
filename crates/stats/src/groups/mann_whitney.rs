//! Mann and Whitney's comparison of two groups.

use serde::{Deserialize, Serialize};

use super::Sample;
use crate::{
    Interval, PMethod, Reasons,
    numerics::distributions::{fisher_ends, normal_quantile, normal_two_sided},
    ranks::{self, greatest_common_divisor},
};

/// Sums that the exact distribution may take: about a quarter of a second.
const MOST_STEPS: f64 = 2e8;

/// How often a value of A is larger than one of B.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MannWhitney {
    /// Pairs in which the value of A is larger, ties counted half.
    #[serde(rename = "U")]
    pub u: f64,
    /// 2 U / (nA nB) - 1, from -1 to 1.
    pub rank_biserial: f64,
    /// Its 95 % interval: Fisher's z with the null standard error of U.
    #[serde(flatten, with = "crate::interval::rank_biserial_ci")]
    pub rank_biserial_ci: Interval,
    /// The normal deviate of U, ties corrected, without continuity correction.
    pub z: Option<f64>,
    /// `p_exact` where all pairs have it, else `p_normal_cc`.
    pub p: Option<f64>,
    /// Which of the two `p` is.
    pub p_method: Option<PMethod>,
    /// Holm's correction of `p` over all pairs.
    pub p_holm: Option<f64>,
    /// Of all assignments of the values to the groups, given their ties: those with U at least as far from nA nB / 2.
    pub p_exact: Option<f64>,
    /// Twice the smaller exact tail, at most 1; differs where ties make the distribution asymmetric.
    pub p_exact_doubled: Option<f64>,
    /// Holm's correction of `p_exact`.
    pub p_exact_holm: Option<f64>,
    /// Normal approximation, ties corrected.
    pub p_normal: Option<f64>,
    /// The same with continuity correction.
    pub p_normal_cc: Option<f64>,
    /// Its Holm correction.
    pub p_normal_cc_holm: Option<f64>,
}

pub(super) fn test(a: &Sample, b: &Sample) -> (MannWhitney, Reasons) {
    let mut reasons = Reasons::default();
    let keys = [&a.keys[..], &b.keys].concat();
    let (doubled, ties) = ranks::doubled(&keys);
    let (na, nb) = (a.values.len() as i64, b.values.len() as i64);
    let n = (na + nb) as f64;
    let sum: i64 = doubled[..a.values.len()].iter().sum();
    let twice_u = sum - na * (na + 1);
    let product = (na * nb) as f64;
    let u = 0.5 * twice_u as f64;
    let away = u - 0.5 * product;
    let variance = product / 12.0 * ((n + 1.0) - ties / (n * (n - 1.0)));
    let sd = (variance > 1e-9 * product).then(|| variance.sqrt());
    if sd.is_none() {
        let names = ["z", "p_normal", "p_normal_cc", "p_normal_cc_holm"];
        reasons.note_all(&names, "all values of the pair are equal");
    }
    let exact = exact(&doubled, a.values.len(), sum);
    if exact.is_none() {
        let names = ["p_exact", "p_exact_doubled", "p_exact_holm"];
        let reason = "too many values to count all assignments; p_normal_cc is close there";
        reasons.note_all(&names, reason);
    }
    let biserial = 2.0 * u / product - 1.0;
    let half = normal_quantile(0.975) * ((n + 1.0) / (3.0 * product)).sqrt();
    let interval = (biserial.abs() < 1.0).then(|| fisher_ends(biserial, half));
    if interval.is_none() {
        let reason = "the groups do not overlap: Fisher's z is infinite";
        reasons.note_ends(&["rank_biserial_ci"], reason);
    }
    let corrected = (away.abs() - 0.5).max(0.0);
    let result = MannWhitney {
        u,
        rank_biserial: biserial,
        rank_biserial_ci: interval.into(),
        z: sd.map(|sd| away / sd),
        p: None,
        p_method: None,
        p_holm: None,
        p_exact: exact.map(|(two, _)| two),
        p_exact_doubled: exact.map(|(_, doubled)| doubled),
        p_exact_holm: None,
        p_normal: sd.map(|sd| normal_two_sided(away / sd)),
        p_normal_cc: sd.map(|sd| normal_two_sided(corrected / sd)),
        p_normal_cc_holm: None,
    };
    (result, reasons)
}

/// Both exact p values of a sum of doubled ranks of the first `size` values.
fn exact(doubled: &[i64], size: usize, sum: i64) -> Option<(f64, f64)> {
    // Counted for the smaller group: the other's sum is what remains.
    let total: i64 = doubled.iter().sum();
    let (size, sum) =
        if 2 * size > doubled.len() { (doubled.len() - size, total - sum) } else { (size, sum) };
    // Ranks from 0, in the largest steps that they all share: the fewest sums.
    let least = doubled.iter().copied().min()?;
    let shifted = doubled.iter().map(|r| r - least);
    let step = shifted.clone().fold(0_i64, greatest_common_divisor).max(1);
    let ranks: Vec<usize> = shifted.map(|r| (r / step) as usize).collect();
    let seen = ((sum - least * size as i64) / step) as usize;
    let mut sorted = ranks.clone();
    sorted.sort_unstable();
    let largest: usize = sorted[sorted.len() - size..].iter().sum();
    if ranks.len() as f64 * size as f64 * (largest + 1) as f64 > MOST_STEPS {
        return None;
    }
    // Ways to choose `count` ranks with a sum, for each count and sum.
    let width = largest + 1;
    let mut ways = vec![0.0_f64; (size + 1) * width];
    ways[0] = 1.0;
    for (done, &rank) in sorted.iter().enumerate() {
        for count in (0..size.min(done + 1)).rev() {
            let (from, to) = ways.split_at_mut((count + 1) * width);
            let from = &from[count * width..];
            for (to, from) in to[rank..width].iter_mut().zip(from) {
                *to += from;
            }
        }
    }
    let ways = &ways[size * width..];
    let all_ways: f64 = ways.iter().sum();
    // The mean of the sum is size / n of all ranks; distances are compared times n.
    let n = ranks.len();
    let middle = size * ranks.iter().sum::<usize>();
    let distance = |s: usize| (s * n).abs_diff(middle);
    let beyond = |keep: &dyn Fn(usize) -> bool| {
        let kept = ways.iter().enumerate().filter(|(s, _)| keep(*s));
        kept.map(|(_, w)| w).sum::<f64>() / all_ways
    };
    let two = beyond(&|s| distance(s) >= distance(seen));
    let smaller = beyond(&|s| s <= seen).min(beyond(&|s| s >= seen));
    Some((two.min(1.0), (2.0 * smaller).min(1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every assignment by hand.
    fn by_hand(doubled: &[i64], size: usize, sum: i64) -> (f64, f64) {
        let n = doubled.len();
        let middle = size as f64 * doubled.iter().sum::<i64>() as f64 / n as f64;
        let sums: Vec<i64> = (0_u32..1 << n)
            .filter(|set| set.count_ones() as usize == size)
            .map(|set| (0..n).filter(|i| set >> i & 1 == 1).map(|i| doubled[i]).sum())
            .collect();
        let share = |keep: &dyn Fn(i64) -> bool| {
            sums.iter().filter(|s| keep(**s)).count() as f64 / sums.len() as f64
        };
        let seen = (sum as f64 - middle).abs();
        let two = share(&|s| (s as f64 - middle).abs() >= seen - 1e-9);
        let doubled = 2.0 * share(&|s| s <= sum).min(share(&|s| s >= sum));
        (two, doubled.min(1.0))
    }

    #[test]
    fn the_exact_distribution_is_that_of_all_assignments() {
        for (values, size) in [
            (vec![1.0, 2.0, 2.0, 3.0, 5.0, 5.0, 5.0, 7.0, 8.0], 4),
            (vec![3.0, 1.0, 2.0, 4.0, 6.0, 5.0, 8.0, 7.0, 9.0, 10.0], 7),
            (vec![1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0], 2),
        ] {
            let (doubled, _) = ranks::doubled(&values);
            let sum: i64 = doubled[..size].iter().sum();
            let (two, twice) = exact(&doubled, size, sum).unwrap();
            let (want, want_twice) = by_hand(&doubled, size, sum);
            assert!((two - want).abs() < 1e-12 && (twice - want_twice).abs() < 1e-12);
        }
    }

    #[test]
    fn equal_values_have_a_p_of_one() {
        let (doubled, _) = ranks::doubled(&[2.0; 6]);
        assert_eq!(exact(&doubled, 3, doubled[..3].iter().sum()), Some((1.0, 1.0)));
    }
}
