//! Signed ranks and the distribution of their sum.

use crate::{numerics::distributions::normal_two_sided, ranks};

/// What happens to differences of zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Zeros {
    /// Left out before ranking (Wilcoxon).
    Dropped,
    /// Ranked, then left out (Pratt).
    RankedThenDropped,
    /// Ranked, and their ranks given half to either side.
    Split,
}

/// A sample of differences, ranked by magnitude. All rank sums are doubled.
pub(crate) struct SignedRanks {
    pub(crate) plus: i64,
    pub(crate) minus: i64,
    /// Doubled ranks of the differences that are not zero.
    pub(crate) ranks: Vec<i64>,
    pub(crate) zeros: usize,
    pub(crate) has_ties: bool,
    mean: f64,
    variance: f64,
}

impl SignedRanks {
    /// `keys` are the differences: doubles, or the decimal numbers as written.
    pub(crate) fn from_differences<K: PartialOrd + Copy + Default + std::ops::Neg<Output = K>>(
        keys: &[K],
        treatment: Zeros,
    ) -> Self {
        let zero = K::default();
        let magnitude = |k: K| if k < zero { -k } else { k };
        let is_zero = |k: K| magnitude(k) <= zero;
        let zeros = keys.iter().filter(|&&k| is_zero(k)).count();
        let ranked: Vec<K> = match treatment {
            Zeros::Dropped => keys.iter().copied().filter(|&k| !is_zero(k)).collect(),
            _ => keys.to_vec(),
        };
        let sizes: Vec<K> = ranked.iter().map(|&k| magnitude(k)).collect();
        let (ranks, mut ties) = ranks::doubled(&sizes);
        let (mut plus, mut minus, mut null) = (0, 0, 0);
        let mut kept = Vec::with_capacity(ranks.len());
        for (&key, &rank) in ranked.iter().zip(&ranks) {
            if is_zero(key) {
                null += rank;
            } else {
                kept.push(rank);
                if key > zero {
                    plus += rank;
                } else {
                    minus += rank;
                }
            }
        }
        let n = ranked.len() as f64;
        let mut mean = n * (n + 1.0) / 4.0;
        let mut scatter = n * (n + 1.0) * (2.0 * n + 1.0);
        let z = zeros as f64;
        match treatment {
            Zeros::Dropped => {}
            Zeros::RankedThenDropped => {
                mean -= z * (z + 1.0) / 4.0;
                scatter -= z * (z + 1.0) * (2.0 * z + 1.0);
                ties -= z * z * z - z;
            }
            Zeros::Split => {
                // Doubled rank sums stay whole: a tie group's ranks sum to a whole number.
                plus += null / 2;
                minus += null - null / 2;
            }
        }
        Self {
            plus,
            minus,
            ranks: kept,
            zeros,
            has_ties: ties > 0.0,
            mean,
            variance: (scatter - 0.5 * ties) / 24.0,
        }
    }

    /// The normal deviate of W+, moved towards the mean by `continuity`.
    pub(crate) fn z(&self, continuity: f64) -> Option<f64> {
        let gap = 0.5 * self.plus as f64 - self.mean;
        let shift = if gap.abs() > 0.0 { continuity.copysign(gap) } else { 0.0 };
        (self.variance > 0.0).then(|| (gap - shift) / self.variance.sqrt())
    }

    pub(crate) fn p_normal(&self, continuity: f64) -> Option<f64> {
        self.z(continuity).map(normal_two_sided)
    }

    /// P(|W+ - mean| at least as large) over all changes of sign, given the ranks.
    pub(crate) fn p_exact(&self) -> Option<f64> {
        if self.ranks.is_empty() || self.ranks.len() > MOST_EXACT {
            return None;
        }
        let even = self.ranks.iter().all(|r| r % 2 == 0);
        let unit = if even { 2 } else { 1 };
        let total: i64 = self.ranks.iter().sum::<i64>() / unit;
        let smaller = self.plus.min(self.minus) / unit;
        if 2 * smaller >= total {
            return Some(1.0);
        }
        // Only sums up to the smaller one matter. Counts are whole numbers until they pass
        // 2^53, and the last scaling, by a power of two, is exact.
        let most = smaller as usize;
        let mut counts = vec![0.0_f64; most + 1];
        counts[0] = 1.0;
        let mut order: Vec<usize> = self.ranks.iter().map(|r| (r / unit) as usize).collect();
        order.sort_unstable();
        let mut reach = 0;
        for &rank in order.iter().take_while(|&&rank| rank <= most) {
            reach = (reach + rank).min(most);
            // From the top in blocks as long as the rank: a block and the one below it never
            // overlap, so that its sums do not wait for each other.
            let mut end = reach + 1;
            while end > rank {
                let start = end.saturating_sub(rank).max(rank);
                let (lower, upper) = counts.split_at_mut(start);
                let without = &lower[start - rank..end - rank];
                for (count, without) in upper.iter_mut().zip(without) {
                    *count += without;
                }
                end = start;
            }
        }
        let all_signs = 2.0_f64.powi(order.len() as i32);
        Some((2.0 * (counts.iter().sum::<f64>() / all_signs)).min(1.0))
    }
}

/// Differences up to which all changes of sign are counted.
pub(crate) const MOST_EXACT: usize = 1000;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exact_p_is_that_of_all_sign_changes() {
        let differences = [3.0, -1.0, 2.0, 2.0, -5.0, 7.0, 0.0, 4.0];
        for treatment in [Zeros::Dropped, Zeros::RankedThenDropped] {
            let ranks = SignedRanks::from_differences(&differences, treatment);
            let n = ranks.ranks.len();
            let total: i64 = ranks.ranks.iter().sum();
            let gap = |plus: i64| (2 * plus - total).abs();
            let hits = (0..1_u32 << n)
                .filter(|signs| {
                    let plus = (0..n).filter(|i| signs >> i & 1 == 1).map(|i| ranks.ranks[i]).sum();
                    gap(plus) >= gap(ranks.plus)
                })
                .count();
            let p = hits as f64 / f64::from(1 << n);
            assert!((ranks.p_exact().unwrap() - p).abs() < 1e-15);
        }
    }
}
