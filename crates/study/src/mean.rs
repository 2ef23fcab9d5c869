//! Means of values as they are, and how sure a mean is.

use crate::error::StudyError;
pub(crate) use maveric_rehearsal::validation::mean;
use maveric_stats::{BootstrapData, BootstrapSettings, Interval, Statistic, bootstrap};

/// Mean of each column of rows, over the rows that have a value there.
pub(crate) fn column_means<const COLUMNS: usize>(
    rows: &[[Option<f64>; COLUMNS]],
) -> [Option<f64>; COLUMNS] {
    let known = |column: usize| rows.iter().filter_map(move |row| row[column]);
    std::array::from_fn(|column| mean(&known(column).collect::<Vec<f64>>()))
}

/// Standard deviation, n − 1; `None` for fewer than two values.
pub(crate) fn sd(values: &[f64]) -> Option<f64> {
    let m = mean(values)?;
    let squares: f64 = values.iter().map(|v| (v - m).powi(2)).sum();
    (values.len() > 1).then(|| (squares / (values.len() - 1) as f64).sqrt())
}

/// 95% interval of the mean of the values that are there: percentiles of bootstrap resamples; `None` for fewer than two.
pub(crate) fn mean_interval(
    values: &[Option<f64>],
    seed: u64,
) -> Result<Option<Interval>, StudyError> {
    if values.iter().flatten().count() < 2 {
        return Ok(None);
    }
    let settings = BootstrapSettings { seed, ..BootstrapSettings::default() };
    let intervals = bootstrap(Statistic::Mean, BootstrapData::Values(values), &settings)?;
    Ok(Some(intervals.percentile))
}
