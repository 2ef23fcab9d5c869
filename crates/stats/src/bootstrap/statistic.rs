//! Statistics of a sample in which each row counts as often as it was drawn.

use super::{BootstrapData, Statistic};
use crate::{
    StatsError, complete, correlation,
    friedman::RankTable,
    numerics::{
        decimal::tied,
        moments::{centred, is_rounding, largest},
    },
    ranks,
    within_subjects::Index,
};

/// Data prepared so that a resample costs one pass.
pub(super) enum Sample {
    Mean(Vec<f64>),
    /// Sorted values.
    Median(Vec<f64>),
    Pearson(Vec<f64>, Vec<f64>),
    Spearman(Vec<f64>, Vec<f64>),
    /// A share of the variance of a within-subject design.
    Share {
        which: Statistic,
        /// Subject-centred rows, their squares, and the subjects' means less their mean.
        rows: Vec<f64>,
        squares: Vec<f64>,
        means: Vec<f64>,
        k: usize,
        floor: f64,
    },
    KendallW(RankTable),
    /// Of each person: sheets, Σ sum, Σ sum², Σ x² over all items, then Σ x of each item (items centred).
    Alpha(Vec<Vec<f64>>),
}

impl Sample {
    /// The sample and the number of rows left out.
    pub(super) fn from_data(
        statistic: Statistic,
        data: BootstrapData<'_>,
    ) -> Result<(Self, usize), StatsError> {
        match (statistic, data) {
            (Statistic::Mean | Statistic::Median, BootstrapData::Values(values)) => {
                let mut kept = complete::values(values, "value", 2)?;
                let missing = values.len() - kept.len();
                if statistic == Statistic::Mean {
                    return Ok((Self::Mean(kept), missing));
                }
                kept.sort_by(f64::total_cmp);
                Ok((Self::Median(kept), missing))
            }
            (Statistic::Pearson | Statistic::Spearman, BootstrapData::Pairs(x, y)) => {
                let mut complete = complete::rows(&[("x", x), ("y", y)], "pair", 2)?;
                let (y, x) = (complete.columns.pop(), complete.columns.pop());
                let (x, y) = (x.unwrap_or_default(), y.unwrap_or_default());
                let sample = if statistic == Statistic::Pearson {
                    Self::Pearson(centred(&x), centred(&y))
                } else {
                    Self::Spearman(tied(&x).into_owned(), tied(&y).into_owned())
                };
                Ok((sample, complete.missing))
            }
            (
                which @ (Statistic::Eta2Partial
                | Statistic::Eta2Generalized
                | Statistic::Omega2Partial),
                BootstrapData::Within(data),
            ) => {
                let rows: Vec<f64> = data.rows().flat_map(centred).collect();
                let squares =
                    rows.chunks_exact(data.k()).map(|r| r.iter().map(|v| v * v).sum()).collect();
                let pivot = data.values()[0];
                let mean =
                    |row: &[f64]| row.iter().map(|v| v - pivot).sum::<f64>() / row.len() as f64;
                let means: Vec<f64> = data.rows().map(mean).collect();
                let floor = (4.0 * f64::EPSILON * largest(data.values())).powi(2);
                let sample = Self::Share {
                    which,
                    rows,
                    squares,
                    means: centred(&means),
                    k: data.k(),
                    floor,
                };
                Ok((sample, data.dropped().len()))
            }
            (Statistic::KendallW, BootstrapData::Within(data)) => {
                Ok((Self::KendallW(RankTable::new(data)), data.dropped().len()))
            }
            (Statistic::Alpha, BootstrapData::Sheets { items, people }) => {
                let complete = complete::rows(items, "sheet", 2)?;
                let sheets = complete.kept.len() + complete.missing;
                StatsError::same_length("people", people.len(), sheets)?;
                let index = Index::from_labels(complete.kept.iter().map(|&i| &people[i]));
                complete::enough("person", index.names.len(), 0, 2)?;
                let columns: Vec<Vec<f64>> = complete.columns.iter().map(|c| centred(c)).collect();
                let mut sums = vec![vec![0.0; 4 + columns.len()]; index.names.len()];
                for (sheet, &person) in index.rows.iter().enumerate() {
                    let person_sums = &mut sums[person];
                    let sum: f64 = columns.iter().map(|c| c[sheet]).sum();
                    let squares: f64 = columns.iter().map(|c| c[sheet] * c[sheet]).sum();
                    for (to, add) in person_sums.iter_mut().zip([1.0, sum, sum * sum, squares]) {
                        *to += add;
                    }
                    for (to, column) in person_sums[4..].iter_mut().zip(&columns) {
                        *to += column[sheet];
                    }
                }
                Ok((Self::Alpha(sums), complete.missing))
            }
            (statistic, data) => Err(StatsError::WrongData {
                statistic: format!("{statistic:?}"),
                data: match data {
                    BootstrapData::Values(_) => "one column",
                    BootstrapData::Pairs(..) => "two columns",
                    BootstrapData::Within(_) => "a within-subject design",
                    BootstrapData::Sheets { .. } => "the items of a scale",
                }
                .to_owned(),
            }),
        }
    }

    pub(super) fn rows(&self) -> usize {
        match self {
            Self::Mean(v) | Self::Median(v) | Self::Pearson(v, _) | Self::Spearman(v, _) => v.len(),
            Self::Share { squares, .. } => squares.len(),
            Self::KendallW(table) => table.n,
            Self::Alpha(people) => people.len(),
        }
    }

    /// The statistic with row i taken `counts[i]` times; `None` where it has no value.
    pub(super) fn statistic(&self, counts: &[u32]) -> Option<f64> {
        let total: u32 = counts.iter().sum();
        match self {
            Self::Mean(values) => {
                let pivot = values[0];
                let sum: f64 =
                    values.iter().zip(counts).map(|(v, &c)| (v - pivot) * f64::from(c)).sum();
                Some(pivot + sum / f64::from(total))
            }
            Self::Median(sorted) => {
                let value_at = |place: u32| {
                    let mut seen = 0;
                    let mut pairs = sorted.iter().zip(counts);
                    pairs.find_map(|(v, &c)| {
                        seen += c;
                        (seen > place).then_some(*v)
                    })
                };
                Some(0.5 * (value_at((total - 1) / 2)? + value_at(total / 2)?))
            }
            Self::Pearson(x, y) => weighted_r(x, y, counts, f64::from(total)),
            Self::Spearman(x, y) => {
                let repeat = |v: &[f64]| -> Vec<f64> {
                    let rows = v.iter().zip(counts);
                    rows.flat_map(|(v, &c)| std::iter::repeat_n(*v, c as usize)).collect()
                };
                let rank = |v: &[f64]| -> Vec<f64> {
                    ranks::doubled(&repeat(v)).0.iter().map(|&r| r as f64).collect()
                };
                correlation::coefficient(&rank(x), &rank(y))
            }
            Self::Share { which, rows, squares, means, k, floor } => {
                let mut sums = [0.0_f64; 16];
                let mut long;
                let sums: &mut [f64] = if *k <= 16 {
                    &mut sums[..*k]
                } else {
                    long = vec![0.0; *k];
                    &mut long
                };
                let (mut within, mut mean, mut mean_squares) = (0.0, 0.0, 0.0);
                let subjects = rows.chunks_exact(*k).zip(squares).zip(means).zip(counts);
                for (((row, square), subject_mean), &count) in subjects {
                    if count > 0 {
                        let weight = f64::from(count);
                        within += weight * square;
                        mean += weight * subject_mean;
                        mean_squares += weight * subject_mean * subject_mean;
                        for (sum, v) in sums.iter_mut().zip(row) {
                            *sum += weight * v;
                        }
                    }
                }
                let n = f64::from(total);
                let condition = sums.iter().map(|s| s * s).sum::<f64>() / n;
                let subject = *k as f64 * (mean_squares - mean * mean / n).max(0.0);
                let freedom = *k as f64 - 1.0;
                let mse = (within - condition).max(0.0) / (freedom * (n - 1.0));
                let (above, below) = match which {
                    Statistic::Eta2Partial => (condition, within),
                    Statistic::Eta2Generalized => (condition, within + subject),
                    _ => (condition - freedom * mse, within + subject + subject / (n - 1.0)),
                };
                (below > floor * rows.len() as f64).then(|| (above / below).min(1.0))
            }
            Self::KendallW(table) => table.resampled(counts).kendall_w(),
            Self::Alpha(people) => weighted_alpha(people, counts),
        }
    }
}

/// Alpha of the sheets of people, each counted as often as drawn.
fn weighted_alpha(people: &[Vec<f64>], counts: &[u32]) -> Option<f64> {
    let mut sums = vec![0.0; people[0].len()];
    for (person_sums, &count) in people.iter().zip(counts).filter(|(_, c)| **c > 0) {
        for (sum, v) in sums.iter_mut().zip(person_sums) {
            *sum += f64::from(count) * v;
        }
    }
    let (n, items) = (sums[0], &sums[4..]);
    let total = sums[2] - sums[1] * sums[1] / n;
    let trace = sums[3] - items.iter().map(|x| x * x).sum::<f64>() / n;
    let k = items.len() as f64;
    (total > 1e-14 * sums[3] && total > 1e-14 * trace)
        .then(|| k / (k - 1.0) * (1.0 - trace / total))
}

/// r of centred columns with row weights.
fn weighted_r(x: &[f64], y: &[f64], counts: &[u32], total: f64) -> Option<f64> {
    let (mut sx, mut sy, mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for ((&a, &b), &c) in x.iter().zip(y).zip(counts) {
        let c = f64::from(c);
        sx += c * a;
        sy += c * b;
        xx += c * a * a;
        yy += c * b * b;
        xy += c * a * b;
    }
    let (vx, vy) = (xx - sx * sx / total, yy - sy * sy / total);
    // A resample of one row only has no spread but for rounding.
    if is_rounding(vx, 16.0 * xx) || is_rounding(vy, 16.0 * yy) {
        return None;
    }
    Some(((xy - sx * sy / total) / (vx.sqrt() * vy.sqrt())).clamp(-1.0, 1.0))
}
