//! Intraclass correlation: how much of what differs between readings is the person's.

use serde::{Deserialize, Serialize};

use crate::{
    Reasons, StatsError, complete,
    numerics::{
        distributions::f_quantile_upper,
        moments::{is_constant, is_rounding},
    },
};

/// ICC(2,1): people and occasions are drawn at random, absolute agreement, one reading each.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Icc {
    /// People with a reading on every occasion.
    pub n: usize,
    /// Occasions.
    pub k: usize,
    /// People left out because a reading is missing.
    pub missing: usize,
    /// Share of the variance of one reading that is between people; below 0 where people differ less than chance would have it.
    pub icc: Option<f64>,
    /// Lower end of its 95 % interval.
    pub ci_low: Option<f64>,
    /// Upper end.
    pub ci_high: Option<f64>,
    /// Standard deviation of one person's readings, from the variance within people.
    pub within_sd: f64,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// ICC(2,1) of readings of the same people, a column of shape `(people,)` for each occasion; people without one of the readings are
/// left out.
///
/// # Errors
/// [`StatsError::LengthMismatch`]; [`StatsError::NotFinite`]; [`StatsError::TooFew`] below two occasions or two complete people.
///
/// # Source
/// Shrout and Fleiss (1979), ICC(2,1), whose example this is; interval of McGraw and Wong (1996), ICC(A,1).
///
/// # Example
/// ```
/// let judges = [
///     [9.0, 6.0, 8.0, 7.0, 10.0, 6.0],
///     [2.0, 1.0, 4.0, 1.0, 5.0, 2.0],
///     [5.0, 3.0, 6.0, 2.0, 6.0, 4.0],
///     [8.0, 2.0, 8.0, 6.0, 9.0, 7.0],
/// ];
/// let judges = judges.map(|column| column.map(Some));
/// let columns: Vec<(&str, &[Option<f64>])> = judges.iter().map(|c| ("judge", c.as_slice())).collect();
/// let found = maveric_stats::icc(&columns)?;
/// assert!((found.icc.unwrap() - 0.2898).abs() < 5e-5);
/// assert!((found.ci_low.unwrap() - 0.0188).abs() < 5e-5 && (found.ci_high.unwrap() - 0.7611).abs() < 5e-5);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn icc(occasions: &[(&str, &[Option<f64>])]) -> Result<Icc, StatsError> {
    complete::enough("occasion", occasions.len(), 0, 2)?;
    let complete = complete::rows(occasions, "person", 2)?;
    let columns = &complete.columns;
    let (people, times) = (columns[0].len(), columns.len());
    let (n, k) = (people as f64, times as f64);
    let all = n * k;
    let grand = columns.iter().flatten().sum::<f64>() / all;
    // Centred, so that a large mean takes no digits.
    let at = |i: usize, j: usize| columns[j][i] - grand;
    let person = |i: usize| (0..times).map(|j| at(i, j)).sum::<f64>() / k;
    let occasion = |j: usize| (0..people).map(|i| at(i, j)).sum::<f64>() / n;
    let between = k * (0..people).map(|i| person(i).powi(2)).sum::<f64>() / (n - 1.0);
    let over_times = n * (0..times).map(|j| occasion(j).powi(2)).sum::<f64>() / (k - 1.0);
    let (mut within, mut rest) = (0.0, 0.0);
    for i in 0..people {
        for j in 0..times {
            within += (at(i, j) - person(i)).powi(2);
            rest += (at(i, j) - person(i) - occasion(j)).powi(2);
        }
    }
    let rest = rest / ((n - 1.0) * (k - 1.0));
    let mut found = Icc {
        n: people,
        k: times,
        missing: complete.missing,
        icc: None,
        ci_low: None,
        ci_high: None,
        within_sd: (within / (n * (k - 1.0))).sqrt(),
        undefined: Reasons::default(),
    };
    let total = between + (k - 1.0) * rest + k / n * (over_times - rest);
    let flat = columns.iter().flatten().copied().collect::<Vec<f64>>();
    if is_constant(&flat) || total <= 0.0 {
        let reason = "all readings are alike";
        found
            .undefined
            .note_all(&["icc", "ci_low", "ci_high"], reason);
        return Ok(found);
    }
    let estimate = (between - rest) / total;
    found.icc = Some(estimate);
    let scale = grand.abs().max(between.sqrt());
    if is_rounding((within / all).sqrt(), scale) {
        let reason = "everybody's readings are alike on all occasions";
        found.undefined.note_all(&["ci_low", "ci_high"], reason);
        return Ok(found);
    }
    let free = {
        let ratio = k * estimate / (n * (1.0 - estimate));
        let (a, b) = (ratio * over_times, (1.0 + ratio * (n - 1.0)) * rest);
        (a + b).powi(2) / (a * a / (k - 1.0) + b * b / ((n - 1.0) * (k - 1.0)))
    };
    let others = k * over_times + (k * n - k - n) * rest;
    let low = f_quantile_upper(0.025, n - 1.0, free)
        .map(|f| n * (between - f * rest) / (f * others + n * between));
    let high = f_quantile_upper(0.025, free, n - 1.0)
        .map(|f| n * (f * between - rest) / (others + n * f * between));
    (found.ci_low, found.ci_high) = (low, high);
    if low.is_none() || high.is_none() {
        let reason = "the F distribution has no such quantile";
        found.undefined.note_all(&["ci_low", "ci_high"], reason);
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(columns: &[Vec<Option<f64>>]) -> Icc {
        let named: Vec<(&str, &[Option<f64>])> =
            columns.iter().map(|c| ("x", c.as_slice())).collect();
        icc(&named).unwrap()
    }

    #[test]
    fn an_occasion_that_moves_everybody_counts_against_agreement() {
        let first: Vec<Option<f64>> = (0..10).map(|i| Some(f64::from(i))).collect();
        let noisy = |by: f64| -> Vec<Option<f64>> {
            let wave = |i: usize| if i.is_multiple_of(2) { 0.3 } else { -0.3 };
            let moved = first.iter().enumerate();
            moved.map(|(i, x)| x.map(|x| x + wave(i) + by)).collect()
        };
        let alike = of(&[first.clone(), noisy(0.0)]);
        let moved = of(&[first.clone(), noisy(3.0)]);
        assert!(alike.icc.unwrap() > 0.98, "{alike:?}");
        assert!(moved.icc.unwrap() < 0.7, "{moved:?}");
        assert!(moved.within_sd > alike.within_sd);
        assert!(alike.ci_low.unwrap() < alike.icc.unwrap());
        assert!(alike.ci_high.unwrap() > alike.icc.unwrap());
    }

    #[test]
    fn whoever_lacks_a_reading_is_left_out_and_counted_and_alike_readings_have_no_correlation() {
        let with_hole = [
            vec![Some(1.0), Some(2.0), None, Some(4.0)],
            vec![Some(1.5), Some(2.5), Some(3.0), Some(3.5)],
        ];
        let found = of(&with_hole);
        assert_eq!((found.n, found.missing), (3, 1));
        let flat = of(&[vec![Some(1.0); 4], vec![Some(1.0); 4]]);
        assert_eq!((flat.icc, flat.ci_low), (None, None));
        assert!(flat.undefined.get("icc").is_some());
        let same: Vec<Option<f64>> = (0..5).map(|i| Some(f64::from(i))).collect();
        let same = of(&[same.clone(), same]);
        assert!((same.icc.unwrap() - 1.0).abs() < 1e-12);
        assert!(same.ci_low.is_none() && same.undefined.get("ci_low").is_some());
    }

    #[test]
    fn a_large_constant_takes_nothing_from_it() {
        let rows = [[1.0, 1.4], [2.0, 1.7], [3.5, 3.0], [5.0, 5.25]];
        let by = |offset: f64| {
            let column = |j: usize| rows.iter().map(|r| Some(r[j] + offset)).collect();
            of(&[column(0), column(1)])
        };
        let (near, far) = (by(0.0), by(1e9));
        assert!((near.icc.unwrap() - far.icc.unwrap()).abs() < 1e-5);
    }
}
