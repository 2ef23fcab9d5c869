//! Bootstrap intervals: percentile, and bias-corrected and accelerated (BCa).

mod statistic;

use rand::Rng;
use rand_pcg::Pcg64;
#[cfg(feature = "parallel")]
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use statistic::Sample;

use crate::{
    Interval, Reasons, StatsError, WithinSubjects,
    normality::quantile,
    numerics::distributions::{normal_quantile, normal_upper},
};

/// Most resamples: an interval moves by less than a thousandth of its width beyond, and takes minutes.
const MOST_RESAMPLES: usize = 1_000_000;

/// What is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Statistic {
    /// Mean of one column.
    Mean,
    /// Median of one column.
    Median,
    /// Pearson's r of two columns.
    Pearson,
    /// Spearman's ρ of two columns.
    Spearman,
    /// Partial eta squared of a within-subject design.
    Eta2Partial,
    /// Generalised eta squared of a within-subject design.
    Eta2Generalized,
    /// Omega squared of a within-subject design.
    Omega2Partial,
    /// Kendall's W of a within-subject design (Friedman's χ² over n (k-1)).
    KendallW,
    /// Cronbach's alpha of a scale.
    Alpha,
}

/// The data whose rows, or subjects, are drawn with replacement.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum BootstrapData<'a> {
    /// One column, shape `(rows,)`.
    Values(&'a [Option<f64>]),
    /// Two columns of shape `(rows,)`; whole pairs are drawn.
    Pairs(&'a [Option<f64>], &'a [Option<f64>]),
    /// A within-subject design; whole subjects are drawn.
    Within(&'a WithinSubjects),
    /// Answer sheets to the items of a scale.
    Sheets {
        /// Each item's name and its answers, shape `(sheets,)`.
        items: &'a [(&'a str, &'a [Option<f64>])],
        /// Whose each sheet is, shape `(sheets,)`: whole people are drawn, with all of their sheets.
        people: &'a [String],
    },
}

/// How the interval is simulated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BootstrapSettings {
    /// Number of resamples, 100 to a million.
    pub resamples: usize,
    /// Seed; the same seed gives the same interval on any number of threads.
    pub seed: u64,
    /// Confidence of the interval, such as 0.95.
    pub confidence: f64,
}

impl Default for BootstrapSettings {
    fn default() -> Self {
        Self { resamples: 10_000, seed: 0, confidence: 0.95 }
    }
}

/// An estimate with its bootstrap intervals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bootstrap {
    /// What is estimated.
    pub statistic: Statistic,
    /// Rows, or subjects.
    pub n: usize,
    /// Rows left out because a value is missing.
    pub missing: usize,
    /// How it was simulated.
    #[serde(flatten)]
    pub settings: BootstrapSettings,
    /// Resamples in which the statistic has no value, and which are left out.
    pub without_value: usize,
    /// The statistic of the data.
    pub estimate: Option<f64>,
    /// Standard deviation over resamples.
    pub se: Option<f64>,
    /// Quantiles of the resamples (R's type 7).
    pub percentile: Interval,
    /// Efron's (1987) interval, corrected for bias and skewness.
    pub bca: Interval,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Resamples drawn from one stream of the generator.
const CHUNK: usize = 256;

/// Draws rows with replacement and gives the intervals of a statistic.
///
/// Resamples `256 c` to `256 c + 255` come from a PCG-64 generator of their own, derived
/// from the seed and `c`, so the result depends on neither threads nor their number.
///
/// # Errors
/// [`StatsError::WrongData`] if the statistic is not one of that data;
/// [`StatsError::TooFew`] below two rows; [`StatsError::BadParameter`];
/// [`StatsError::NotFinite`]; [`StatsError::LengthMismatch`].
///
/// # Source
/// Efron and Tibshirani (1993), chapters 13 and 14; the acceleration from the jackknife.
///
/// # Example
/// ```
/// use maveric_stats::{BootstrapData, BootstrapSettings, Statistic, bootstrap};
/// let hours = [3.0, 5.0, 7.0, 18.0, 43.0, 85.0, 91.0, 98.0, 100.0].map(Some);
/// let result = bootstrap(Statistic::Mean, BootstrapData::Values(&hours), &BootstrapSettings::default())?;
/// assert_eq!(result.estimate, Some(50.0));
/// assert!((result.percentile.low.unwrap() - 24.0).abs() < 2.0); // enumerated: 24
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn bootstrap(
    statistic: Statistic,
    data: BootstrapData<'_>,
    settings: &BootstrapSettings,
) -> Result<Bootstrap, StatsError> {
    check(settings)?;
    let (sample, missing) = Sample::from_data(statistic, data)?;
    let n = sample.rows();
    let whole: Vec<u32> = vec![1; n];
    let estimate = sample.statistic(&whole);
    let mut values = draw(&sample, settings);
    let without_value = settings.resamples - values.len();
    values.sort_by(f64::total_cmp);
    let mut result = Bootstrap {
        statistic,
        n,
        missing,
        settings: *settings,
        without_value,
        estimate,
        se: None,
        percentile: Interval::default(),
        bca: Interval::default(),
        undefined: Reasons::default(),
    };
    let Some(estimate) = estimate.filter(|_| values.len() * 2 > settings.resamples) else {
        let reason = "the statistic has no value for these data, or for most of their resamples";
        result.estimate = None;
        result.undefined.note_all(&["estimate", "se", "percentile", "bca"], reason);
        return Ok(result);
    };
    let (_, squares) = crate::numerics::moments::mean_and_square_sum(values.iter().copied());
    result.se = Some((squares / (values.len() as f64 - 1.0)).sqrt());
    let tail = 0.5 * (1.0 - settings.confidence);
    let between = |low: f64, high: f64| (quantile(&values, low), quantile(&values, high)).into();
    result.percentile = between(tail, 1.0 - tail);
    match bca_levels(&sample, &values, estimate, tail) {
        Some((low, high)) => result.bca = between(low, high),
        None => result.undefined.note(
            "bca",
            "all resamples lie on one side of the estimate, or leaving out one row changes nothing",
        ),
    }
    Ok(result)
}

fn check(settings: &BootstrapSettings) -> Result<(), StatsError> {
    let resamples = settings.resamples;
    if !(100..=MOST_RESAMPLES).contains(&resamples) {
        let expected = format!("100 to {MOST_RESAMPLES}");
        return Err(StatsError::parameter("resamples", &expected, resamples as f64));
    }
    StatsError::between_0_and_1("confidence", settings.confidence)
}

/// The generator of one chunk: state and increment are SplitMix64 steps from the seed, so
/// that neighbouring chunks share nothing.
pub(crate) fn stream(seed: u64, chunk: u64) -> Pcg64 {
    let mix = |value: u64| {
        let z = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    let first = mix(mix(seed) ^ chunk);
    let second = mix(first);
    Pcg64::new(u128::from(first) << 64 | u128::from(second), u128::from(mix(second)))
}

/// The statistic of each resample that has one, in the order of the streams.
fn draw(sample: &Sample, settings: &BootstrapSettings) -> Vec<f64> {
    let n = sample.rows();
    let chunks = settings.resamples.div_ceil(CHUNK);
    let numbers = 0..chunks;
    #[cfg(feature = "parallel")]
    let numbers = numbers.into_par_iter();
    let parts: Vec<Vec<f64>> = numbers
        .map(|chunk| {
            let mut generator = stream(settings.seed, chunk as u64);
            let size = CHUNK.min(settings.resamples - chunk * CHUNK);
            let mut counts = vec![0_u32; n];
            let mut values = Vec::with_capacity(size);
            for _ in 0..size {
                counts.fill(0);
                for _ in 0..n {
                    // Multiply and shift: uniform to one part in 2^32 / n.
                    let row = (u64::from(generator.next_u32()) * n as u64) >> 32;
                    counts[row as usize] += 1;
                }
                values.extend(sample.statistic(&counts));
            }
            values
        })
        .collect();
    parts.concat()
}

/// The levels whose quantiles are the ends of the BCa interval.
fn bca_levels(sample: &Sample, sorted: &[f64], estimate: f64, tail: f64) -> Option<(f64, f64)> {
    let below = sorted.partition_point(|v| *v < estimate) as f64;
    let equal = sorted.partition_point(|v| *v <= estimate) as f64 - below;
    let share = (below + 0.5 * equal) / sorted.len() as f64;
    if !(share > 0.0 && share < 1.0) {
        return None;
    }
    let bias = normal_quantile(share);
    let acceleration = acceleration(sample)?;
    let level = |z: f64| {
        let shifted = bias + z;
        1.0 - normal_upper(bias + shifted / (1.0 - acceleration * shifted))
    };
    let z = normal_quantile(tail);
    let (low, high) = (level(z), level(-z));
    (low.is_finite() && high.is_finite() && low < high).then_some((low, high))
}

/// Σ d³ / (6 (Σ d²)^1.5) of the jackknife deviations.
fn acceleration(sample: &Sample) -> Option<f64> {
    let n = sample.rows();
    let mut counts = vec![1; n];
    let mut values = Vec::with_capacity(n);
    for left_out in 0..n {
        counts[left_out] = 0;
        values.push(sample.statistic(&counts)?);
        counts[left_out] = 1;
    }
    let deviations = crate::numerics::moments::centred(&values);
    let squares: f64 = deviations.iter().map(|d| d * d).sum();
    let cubes: f64 = deviations.iter().map(|d| -d * d * d).sum();
    (squares > 0.0).then(|| cubes / (6.0 * libm::pow(squares, 1.5)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_gives_the_same_interval_and_another_seed_does_not() {
        let x = [1.0, 4.0, 2.0, 8.0, 5.0, 7.0].map(Some);
        let run = |seed| {
            let settings = BootstrapSettings { seed, resamples: 1000, ..Default::default() };
            bootstrap(Statistic::Median, BootstrapData::Values(&x), &settings).unwrap()
        };
        assert_eq!(run(1), run(1));
        assert_ne!(run(1).se, run(2).se);
    }

    #[test]
    fn a_statistic_of_other_data_is_refused() {
        let x = [1.0, 2.0].map(Some);
        let result =
            bootstrap(Statistic::Pearson, BootstrapData::Values(&x), &BootstrapSettings::default());
        assert!(matches!(result, Err(StatsError::WrongData { .. })));
    }
}
