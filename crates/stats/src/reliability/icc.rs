//! Intraclass correlation: how much of what differs between readings is the person's.

use serde::{Deserialize, Serialize};
use std::f64::consts::SQRT_2;

use crate::{
    HALF_95, Interval, Reasons, StatsError, complete,
    numerics::{
        distributions::f_quantile_upper,
        moments::{is_constant, is_rounding},
    },
    sd_interval,
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
    /// Its 95 % interval.
    #[serde(flatten, with = "crate::interval::ci")]
    pub ci: Interval,
    /// Standard error of measurement: the standard deviation of one person's readings, in their unit, occasions and error together:
    /// √(σ²_occasion + σ²_error), where a σ²_occasion below 0 counts as 0.
    pub sem: f64,
    /// Its 95 % interval.
    #[serde(flatten, with = "crate::interval::sem")]
    pub sem_ci: Interval,
    /// Smallest detectable change: two readings of one person differ by less 95 times of 100; 1.96 · √2 · SEM.
    pub sdc: f64,
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
/// Shrout and Fleiss (1979), ICC(2,1), whose example this is; interval of McGraw and Wong (1996), ICC(A,1), whose mean squares give the
/// SEM of agreement (Weir 2005; de Vet, Terwee, Knol and Bouter 2006), and that the SDC. The SEM's interval is by χ² with Satterthwaite's
/// degrees of freedom (ours): of 3,000 tables with an occasion's SD of none, half and all of the error's it held 96, 97 and 94 % for 10
/// people and 2 occasions. Few occasions say little of a larger one: with twice the error's it held 79 %.
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
/// assert!((found.ci.low.unwrap() - 0.0188).abs() < 5e-5 && (found.ci.high.unwrap() - 0.7611).abs() < 5e-5);
/// assert!((found.sem - 2.5028).abs() < 5e-5 && (found.sdc - 6.9373).abs() < 5e-5);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn icc(occasions: &[(&str, &[Option<f64>])]) -> Result<Icc, StatsError> {
    complete::enough("occasion", occasions.len(), 0, 2)?;
    let complete = complete::rows(occasions, "person", 2)?;
    let columns = &complete.columns;
    let (people, times) = (columns[0].len(), columns.len());
    let (n, k) = (people as f64, times as f64);
    let readings = n * k;
    let grand = columns.iter().flatten().sum::<f64>() / readings;
    // Centred, so that a large mean takes no digits.
    let deviation = |i: usize, j: usize| columns[j][i] - grand;
    let person = |i: usize| (0..times).map(|j| deviation(i, j)).sum::<f64>() / k;
    let occasion = |j: usize| (0..people).map(|i| deviation(i, j)).sum::<f64>() / n;
    let between = k * (0..people).map(|i| person(i).powi(2)).sum::<f64>() / (n - 1.0);
    let over_times = n * (0..times).map(|j| occasion(j).powi(2)).sum::<f64>() / (k - 1.0);
    let (mut within, mut rest) = (0.0, 0.0);
    for i in 0..people {
        for j in 0..times {
            within += (deviation(i, j) - person(i)).powi(2);
            rest += (deviation(i, j) - person(i) - occasion(j)).powi(2);
        }
    }
    let rest_df = (n - 1.0) * (k - 1.0);
    let rest = rest / rest_df;
    let (of_occasions, of_rest) =
        if over_times > rest { (over_times / n, rest - rest / n) } else { (0.0, rest) };
    let variance = of_occasions + of_rest;
    let alike = is_rounding((within / readings).sqrt(), grand.abs().max(between.sqrt()));
    let sem = if alike { 0.0 } else { variance.sqrt() };
    let sem_df = variance.powi(2) / (of_occasions.powi(2) / (k - 1.0) + of_rest.powi(2) / rest_df);
    let sem_interval = sd_interval(sem, sem_df);
    let mut result = Icc {
        n: people,
        k: times,
        missing: complete.missing,
        icc: None,
        ci: Interval::default(),
        sem,
        sem_ci: sem_interval.into(),
        sdc: HALF_95 * SQRT_2 * sem,
        undefined: Reasons::default(),
    };
    if sem_interval.is_none() {
        let reason = "everybody's readings are alike on all occasions";
        result.undefined.note_ends(&["sem"], reason);
    }
    let total = between + (k - 1.0) * rest + k / n * (over_times - rest);
    let flat = columns.iter().flatten().copied().collect::<Vec<f64>>();
    if is_constant(&flat) || total <= 0.0 {
        let names = ["icc", "ci_low", "ci_high"];
        result.undefined.note_all(&names, "all readings are alike");
        return Ok(result);
    }
    let estimate = (between - rest) / total;
    result.icc = Some(estimate);
    if alike {
        let reason = "everybody's readings are alike on all occasions";
        result.undefined.note_ends(&["ci"], reason);
        return Ok(result);
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
    if low.is_some_and(|low| low > estimate) || high.is_some_and(|high| high < estimate) {
        let reason = "the approximate interval does not hold its own estimate";
        result.undefined.note_ends(&["ci"], reason);
        return Ok(result);
    }
    result.ci = Interval { low, high };
    if low.is_none() || high.is_none() {
        let reason = "the F distribution has no such quantile";
        result.undefined.note_ends(&["ci"], reason);
    }
    Ok(result)
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
        // Of a move of 3: σ²_occasion is 3²/2 less what error alone gives.
        assert!(moved.sem > 2.0 && alike.sem < 0.25, "{moved:?} {alike:?}");
        assert!(alike.ci.low.unwrap() < alike.icc.unwrap());
        assert!(alike.ci.high.unwrap() > alike.icc.unwrap());
    }

    #[test]
    fn an_interval_that_does_not_hold_its_own_estimate_is_none() {
        let of_five = |second: [f64; 5]| {
            let column = |x: [f64; 5]| x.map(Some).to_vec();
            of(&[column([7.5, 7.5, 6.5, 6.5, 5.5]), column(second)])
        };
        // -.151, of which the upper end would be -.160.
        let turned = of_five([1.5, 1.5, 3.25, 3.25, 5.0]);
        assert!(turned.icc.unwrap() < -0.15, "{turned:?}");
        assert_eq!((turned.ci.low, turned.ci.high), (None, None));
        let alike = of_five([7.0, 7.5, 6.0, 6.5, 5.0]);
        let estimate = alike.icc.unwrap();
        assert!(alike.ci.low.unwrap() < estimate && estimate < alike.ci.high.unwrap());
    }

    #[test]
    fn occasions_that_differ_less_than_chance_take_nothing_from_the_standard_error_of_measurement()
    {
        let of_three = |second: [f64; 3]| {
            let column = |x: [f64; 3]| x.map(Some).to_vec();
            of(&[column([1.0, 3.0, 6.0]), column(second)])
        };
        // Differences 1, 0, -1: MS of occasions 0, of error (1 + 0 + 1)/2/2 = 1/2; not √(Σd²/2n) = √(1/3).
        let found = of_three([2.0, 3.0, 5.0]);
        assert!((found.sem - 0.5_f64.sqrt()).abs() < 1e-12, "{found:?}");
        assert!((found.sdc - 1.96).abs() < 1e-12);
        // 2 degrees of freedom: χ² quantiles of R 7.377759 and 0.05063562.
        let ends = found.sem_ci.ends().unwrap();
        assert!((ends.0 - (1.0_f64 / 7.377_759).sqrt()).abs() < 1e-6);
        assert!((ends.1 - (1.0_f64 / 0.050_635_62).sqrt()).abs() < 1e-5);
        // Differences 3, 2, 1: MS of occasions 3 · 2 · 1² = 6, of error 1/2; σ²_occasion (6 - 1/2)/3, all in all 7/3.
        let moved = of_three([4.0, 5.0, 7.0]);
        assert!((moved.sem - (7.0_f64 / 3.0).sqrt()).abs() < 1e-12, "{moved:?}");
        // (7/3)² / (2²/1 + (1/3)²/2) degrees of freedom, about 1.34: wider on both sides.
        assert!(
            moved.sem_ci.low.unwrap() < moved.sem && moved.sem_ci.high.unwrap() > 10.0 * moved.sem
        );
        let same = of_three([1.0, 3.0, 6.0]);
        assert_eq!((same.sem, same.sdc, same.sem_ci.low), (0.0, 0.0, None));
        assert!(same.undefined.get("sem_high").is_some());
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
        assert_eq!((flat.icc, flat.ci.low), (None, None));
        assert!(flat.undefined.get("icc").is_some());
        let same: Vec<Option<f64>> = (0..5).map(|i| Some(f64::from(i))).collect();
        let same = of(&[same.clone(), same]);
        assert!((same.icc.unwrap() - 1.0).abs() < 1e-12);
        assert!(same.ci.low.is_none() && same.undefined.get("ci_low").is_some());
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
