//! How alike two drives are as distributions: means can agree where the driving does not.

use maveric_domain::{Drive, stream_seed};
use rand::{SeedableRng, seq::SliceRandom};
use rand_pcg::Pcg64Mcg;
use std::ops::Range;

/// What describes a window, in the order of its numbers.
pub const COLUMNS: [&str; FEATURES] =
    ["speed", "time gap", "acceleration", "jerk", "lateral place"];
/// How many numbers describe a window.
pub const FEATURES: usize = 5;

/// Length of a window, in s.
const WINDOW_S: f64 = 5.0;
/// Time gap from which ego is on free road, in s.
const FREE_S: f64 = 6.0;
/// Neighbour by which densities are compared.
const NEIGHBOUR: usize = 5;
/// Least distance that counts as one, in spreads: two windows of one steady stretch are all but the same.
const LEAST_DISTANCE: f64 = 1e-3;

/// A window's numbers.
pub type Window = [f64; FEATURES];

/// The windows of a drive, one after the other; what is left at the end of a segment is left out.
///
/// Mean speed (m/s), mean time gap to the reference vehicle ahead in ego's lane (s, at most 6, which is also free road), root mean square of
/// acceleration (m/s²) and of jerk (m/s³) between samples half a second apart, mean distance from the right lane's centre (m).
pub fn windows(drive: &Drive) -> Vec<Window> {
    let rows = drive.rows();
    let length = ((WINDOW_S * drive.rate_hz()).round() as usize).max(1);
    let mut windows = Vec::new();
    let mut start = 0;
    while start + length <= drive.len() {
        let end = start + length;
        if let Some(cut) = (start + 1..end).find(|&r| rows.segment[r] != rows.segment[start]) {
            start = cut;
            continue;
        }
        windows.push(window(drive, start..end));
        start = end;
    }
    windows
}

fn window(drive: &Drive, range: Range<usize>) -> Window {
    let rows = drive.rows();
    let n = range.len() as f64;
    let gap = |row: usize| {
        let behind = drive.time_gap_s(row).filter(|_| drive.lead_ahead(row));
        behind.map_or(FREE_S, |gap_s| gap_s.min(FREE_S))
    };
    let apart = ((0.5 * drive.rate_hz()).round() as usize).max(1);
    let step_s = apart as f64 / drive.rate_hz();
    let speeds: Vec<f64> = range.clone().step_by(apart).map(|r| rows.ego_speed_mps[r]).collect();
    let differences = |values: &[f64]| -> Vec<f64> {
        values.windows(2).map(|w| (w[1] - w[0]) / step_s).collect()
    };
    let root = |values: &[f64]| {
        let squares: f64 = values.iter().map(|v| v * v).sum();
        (squares / values.len().max(1) as f64).sqrt()
    };
    let acceleration = differences(&speeds);
    [
        range.clone().map(|r| rows.ego_speed_mps[r]).sum::<f64>() / n,
        range.clone().map(gap).sum::<f64>() / n,
        root(&acceleration),
        root(&differences(&acceleration)),
        range.map(|r| rows.ego_y_m[r]).sum::<f64>() / n,
    ]
}

/// SD of each number over the windows of many drives: what one unit of distance is. A number without one is not looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread([Option<f64>; FEATURES]);

impl Spread {
    /// Over all windows of `drives`; 1 for a number that does not vary.
    pub fn of<'a>(drives: impl Iterator<Item = &'a [Window]>) -> Self {
        let windows: Vec<&Window> = drives.flatten().collect();
        let n = windows.len().max(1) as f64;
        Self(std::array::from_fn(|k| {
            let mean = windows.iter().map(|w| w[k]).sum::<f64>() / n;
            let sd = (windows.iter().map(|w| (w[k] - mean).powi(2)).sum::<f64>() / n).sqrt();
            Some(if sd > 1e-9 { sd } else { 1.0 })
        }))
    }

    /// The same with one of the [`COLUMNS`] alone.
    #[must_use]
    pub fn only(self, column: usize) -> Self {
        Self(std::array::from_fn(|k| self.0[k].filter(|_| k == column)))
    }

    /// The same without one of the [`COLUMNS`].
    #[must_use]
    pub fn without(self, column: usize) -> Self {
        Self(std::array::from_fn(|k| self.0[k].filter(|_| k != column)))
    }

    /// How many columns are looked at.
    fn columns(&self) -> usize {
        self.0.iter().flatten().count()
    }

    fn square(&self, a: &Window, b: &Window) -> f64 {
        let term = |k: usize| Some(((a[k] - b[k]) / self.0[k]?).powi(2));
        (0..FEATURES).filter_map(term).sum()
    }
}

/// How far two sets of windows are apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Discrepancy {
    /// Squared maximum mean discrepancy: Gaussian kernel, its width the median distance of the pooled windows, unbiased (so it may be
    /// below 0 for two sets of one distribution).
    pub mmd2: f64,
    /// Share of random splits of the pooled windows that are at least as far apart; none without permutations.
    pub p: Option<f64>,
    /// Kullback-Leibler divergence of the first from the second, in nats, from distances to the fifth-nearest window.
    pub divergence: f64,
}

/// Compares two sets of windows, each of seven or more; `None` of fewer. `permutations` decide how fine p is, 0 leaves it out.
///
/// # Source
/// Gretton et al. 2012 (JMLR 13, 723), equation 3; Pérez-Cruz 2008 for the divergence; both for personal driving in Person2Drive (arXiv 2602.18757).
pub fn discrepancy(
    one: &[Window],
    other: &[Window],
    spread: &Spread,
    permutations: usize,
    seed: u64,
) -> Option<Discrepancy> {
    let (m, n) = (one.len(), other.len());
    if m.min(n) < NEIGHBOUR + 2 {
        return None;
    }
    let pooled: Vec<&Window> = one.iter().chain(other).collect();
    let size = m + n;
    let mut squares = vec![0.0; size * size];
    for i in 0..size {
        for j in 0..i {
            let square = spread.square(pooled[i], pooled[j]);
            (squares[i * size + j], squares[j * size + i]) = (square, square);
        }
    }
    let mut below: Vec<f64> =
        (0..size).flat_map(|i| squares[i * size..i * size + i].to_vec()).collect();
    let middle = below.len() / 2;
    let width = below.select_nth_unstable_by(middle, f64::total_cmp).1.max(1e-12);
    // Only what lies below the diagonal is read.
    let mut kernel = vec![0.0; size * size];
    for i in 0..size {
        for j in 0..i {
            kernel[i * size + j] = libm::exp(-squares[i * size + j] / (2.0 * width));
        }
    }
    let mut first: Vec<bool> = (0..size).map(|i| i < m).collect();
    let observed = mmd2(&kernel, &first, m, n);
    let mut rng = Pcg64Mcg::seed_from_u64(stream_seed(seed, &["likeness", "permutations"]));
    let mut as_far = 0;
    for _ in 0..permutations {
        first.shuffle(&mut rng);
        as_far += usize::from(mmd2(&kernel, &first, m, n) >= observed);
    }
    Some(Discrepancy {
        mmd2: observed,
        p: (permutations > 0).then(|| (as_far + 1) as f64 / (permutations + 1) as f64),
        divergence: divergence(&squares, m, n, spread.columns()),
    })
}

fn mmd2(kernel: &[f64], first: &[bool], m: usize, n: usize) -> f64 {
    let size = first.len();
    let (mut within, mut beyond, mut across) = (0.0, 0.0, 0.0);
    for i in 0..size {
        for (j, k) in kernel[i * size..i * size + i].iter().enumerate() {
            match (first[i], first[j]) {
                (true, true) => within += k,
                (false, false) => beyond += k,
                _ => across += k,
            }
        }
    }
    let pairs = |n: usize| (n * (n - 1)) as f64 / 2.0;
    within / pairs(m) + beyond / pairs(n) - 2.0 * across / (m * n) as f64
}

/// ln of the ratio of densities at each of the first `m`, by the distance to the fifth neighbour among either set.
fn divergence(squares: &[f64], m: usize, n: usize, columns: usize) -> f64 {
    let size = m + n;
    let fifth = |mut squares: Vec<f64>| {
        let (_, square, _) = squares.select_nth_unstable_by(NEIGHBOUR - 1, f64::total_cmp);
        square.sqrt().max(LEAST_DISTANCE)
    };
    let ratio = |i: usize| {
        let line = &squares[i * size..(i + 1) * size];
        let within = (0..m).filter(|&j| j != i).map(|j| line[j]).collect();
        libm::log(fifth(line[m..].to_vec()) / fifth(within))
    };
    let mean = (0..m).map(ratio).sum::<f64>() / m as f64;
    columns as f64 * mean + libm::log(n as f64 / (m as f64 - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objective::testing::by_rows;
    use maveric_domain::drive::Rows;
    use rand_distr::{Distribution, StandardNormal};

    fn drawn(n: usize, shift: f64, seed: u64) -> Vec<Window> {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        (0..n)
            .map(|_| std::array::from_fn(|k| normal() + if k == 0 { shift } else { 0.0 }))
            .collect()
    }

    fn between(shift: f64, seed: u64) -> Discrepancy {
        let (a, b) = (drawn(120, 0.0, seed), drawn(120, shift, seed + 1000));
        let spread = Spread::of([a.as_slice(), b.as_slice()].into_iter());
        discrepancy(&a, &b, &spread, 99, 1).unwrap()
    }

    #[test]
    fn two_draws_of_one_distribution_are_no_distance_apart_and_others_are() {
        let same: Vec<Discrepancy> = (0..20).map(|s| between(0.0, s)).collect();
        let mean = |of: fn(&Discrepancy) -> f64| same.iter().map(of).sum::<f64>() / 20.0;
        // Unbiased: about 0 on average, and p about uniform.
        assert!(mean(|d| d.mmd2).abs() < 3e-3, "{}", mean(|d| d.mmd2));
        assert!((0.3..0.7).contains(&mean(|d| d.p.unwrap())));
        assert!(mean(|d| d.divergence).abs() < 0.3);
        let far = between(1.5, 7);
        assert!(far.p.unwrap() < 0.02 && far.mmd2 > 0.05, "{far:?}");
        assert!(far.divergence > 0.5, "{far:?}");
        assert!(between(0.7, 7).mmd2 < far.mmd2);
    }

    #[test]
    fn sets_of_unequal_size_are_as_near_and_the_second_may_be_the_nearer() {
        let (few, many) = (drawn(60, 0.0, 3), drawn(240, 0.0, 4));
        let spread = Spread::of([few.as_slice(), many.as_slice()].into_iter());
        let found = discrepancy(&few, &many, &spread, 0, 1).unwrap();
        assert!(found.mmd2.abs() < 0.01 && found.p.is_none(), "{found:?}");
        assert!(found.divergence.abs() < 0.4, "{found:?}");
        let back = discrepancy(&many, &few, &spread, 0, 1).unwrap();
        assert!((back.mmd2 - found.mmd2).abs() < 1e-12);
        assert!(back.divergence.abs() < 0.4, "{back:?}");
        // Half a squared distance of means, for two normal distributions alike but for that.
        let far = drawn(240, 1.0, 5);
        let found = discrepancy(&many, &far, &spread, 0, 1).unwrap();
        assert!((found.divergence - 0.5).abs() < 0.25, "{found:?}");
    }

    #[test]
    fn windows_are_whole_and_their_numbers_those_worked_out_by_hand() {
        let near = |window: Window, expected: Window| {
            for (found, expected) in window.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-9, "{window:?}");
            }
        };
        // 20 s at 10 Hz, cut at row 73: 0 to 50, then from 73, and what is left of either piece is not used.
        let found = windows(&by_rows(10.0, 200, |rows| {
            rows.segment[73..].fill(1);
            rows.ego_y_m.fill(1.2);
            rows.ego_speed_mps[73..123].fill(10.0);
            rows.ego_speed_mps[123..].fill(0.4);
        }));
        assert_eq!(found.len(), 3);
        near(found[0], [20.0, 2.0, 0.0, 0.0, 1.2]);
        near(found[1], [10.0, 4.0, 0.0, 0.0, 1.2]);
        near(found[2], [0.4, 6.0, 0.0, 0.0, 1.2]);
        // Half of the time nobody ahead, or far, or in another lane, or behind.
        for change in [
            |rows: &mut Rows| rows.lead_present[..25].fill(false),
            |rows: &mut Rows| rows.lead_dx_m[..25].fill(500.0),
            |rows: &mut Rows| rows.lead_dy_m[..25].fill(-1.83),
            |rows: &mut Rows| rows.lead_dx_m[..25].fill(-40.0),
        ] {
            near(windows(&by_rows(10.0, 50, change))[0], [20.0, 4.0, 0.0, 0.0, 0.0]);
        }
        // From 20 m/s at a jerk of 2 m/s³: v = 20 + t², seen each half second.
        let jerked = windows(&by_rows(10.0, 50, |rows| {
            for row in 0..50 {
                rows.ego_speed_mps[row] += (row as f64 / 10.0).powi(2);
                rows.lead_dx_m[row] = rows.ego_speed_mps[row];
            }
        }));
        let speed = 20.0 + (0..50).map(|r| f64::from(r * r) / 100.0).sum::<f64>() / 50.0;
        let squares: f64 = (0..9).map(|k| (f64::from(k) + 0.5).powi(2)).sum();
        near(jerked[0], [speed, 1.0, (squares / 9.0).sqrt(), 2.0, 0.0]);
    }

    #[test]
    fn a_unit_of_distance_is_the_spread_over_all_windows() {
        let (low, high) = ([[0.0, 1.0, 0.0, 0.0, 0.0]], [[2.0, 1.0, 0.0, 0.0, 6.0]]);
        let spread = Spread::of([low.as_slice(), high.as_slice()].into_iter());
        assert_eq!(spread, Spread([1.0, 1.0, 1.0, 1.0, 3.0].map(Some)));
        let square = |spread: Spread| spread.square(&low[0], &high[0]);
        assert!((square(spread) - (4.0 + 4.0)).abs() < 1e-12);
        assert!((square(spread.only(0)) - 4.0).abs() < 1e-12);
        assert!((square(spread.without(0)) - 4.0).abs() < 1e-12);
        assert!(square(spread.only(1)).abs() < 1e-12);
    }

    #[test]
    fn what_differs_in_one_column_is_told_by_that_column_alone_and_not_without_it() {
        let (a, b) = (drawn(120, 0.0, 3), drawn(120, 1.5, 4));
        let spread = Spread::of([a.as_slice(), b.as_slice()].into_iter());
        let of = |spread: Spread| discrepancy(&a, &b, &spread, 99, 1).unwrap();
        let (alone, rest) = (of(spread.only(0)), of(spread.without(0)));
        assert!(alone.p.unwrap() < 0.02 && alone.divergence > 0.4, "{alone:?}");
        assert!(rest.p.unwrap() > 0.1 && rest.divergence.abs() < 0.4, "{rest:?}");
        // Half a squared distance of means whichever columns that do not differ are looked at beside it.
        assert!((of(spread).divergence - alone.divergence).abs() < 0.5);
        assert!(of(spread.only(2)).divergence.abs() < 0.3);
    }

    #[test]
    fn too_few_windows_say_nothing() {
        for (n, enough) in [(6, false), (7, true)] {
            let few = drawn(n, 0.0, 1);
            let spread = Spread::of(std::iter::once(few.as_slice()));
            let found = discrepancy(&few, &few, &spread, 0, 1);
            assert_eq!(found.is_some(), enough, "{n}");
        }
    }
}
