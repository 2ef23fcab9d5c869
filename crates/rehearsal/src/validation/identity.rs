//! Who is it? Points of drivers on one day, points on another, nearest neighbours.

use crate::error::RehearsalError;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use serde::Serialize;

/// By which distance drivers were told apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Metric {
    Euclidean,
    /// Mahalanobis distance by the covariance of one person's two days, over the training people.
    WithinPerson,
    /// By the covariances of the two posteriors themselves: −2 ln of the density of the difference.
    Posterior,
}

/// How well drivers are found again among `n`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Identification {
    pub what: &'static str,
    pub metric: Metric,
    pub n: usize,
    /// Drivers whose own point is the nearest.
    pub hits: usize,
    /// `hits` / `n`.
    pub rate: f64,
    /// Lower end of Wilson's 95 % interval.
    pub low: f64,
    pub high: f64,
    /// Mean place of the own point among all, 1 being the nearest; by chance (n + 1) / 2.
    pub mean_rank: f64,
}

/// The covariance of one person's days, factored.
#[derive(Debug, Clone)]
pub struct WithinPerson(Cholesky<f64, Dyn>);

impl WithinPerson {
    /// `covariance` has shape `(d, d)`; `None` if it is not positive definite.
    fn from_covariance(covariance: DMatrix<f64>) -> Option<Self> {
        // A matrix that is singular but for rounding tells no distance either.
        let diagonal = covariance.diagonal();
        let factor = covariance.cholesky()?;
        let pivots = factor.l_dirty().diagonal();
        let singular = |(pivot, own): (&f64, &f64)| pivot * pivot <= SINGULAR * own.abs();
        (!pivots.iter().zip(&diagonal).any(singular)).then_some(Self(factor))
    }

    /// L⁻¹ b: in these coordinates the covariance L Lᵀ is the identity.
    fn whiten(&self, b: &[f64]) -> Vec<f64> {
        let mut x = DVector::from_column_slice(b);
        self.0.l_dirty().solve_lower_triangular_mut(&mut x);
        x.data.into()
    }
}

/// A pivot below this share of its diagonal counts as zero.
const SINGULAR: f64 = 1e-10;

/// Place of each driver's own point among all, from 1; another at the same distance counts as nearer.
fn ranks(known: &[Vec<f64>], seen: &[Vec<f64>]) -> Vec<usize> {
    let distance =
        |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum() };
    let rank = |(i, seen): (usize, &Vec<f64>)| {
        let own_distance = distance(&known[i], seen);
        let nearer =
            |(j, other): (usize, &Vec<f64>)| j != i && distance(other, seen) <= own_distance;
        1 + known.iter().enumerate().filter(|&o| nearer(o)).count()
    };
    seen.iter().enumerate().map(rank).collect()
}

/// Looks for the driver of each point of `seen` among `known`, both of shape `(n, d)` in the same order of drivers:
/// once by straight-line distance and, where `within` is given, once by that covariance.
///
/// # Errors
/// [`RehearsalError::Stats`] without a driver.
pub fn identify(
    what: &'static str,
    known: &[Vec<f64>],
    seen: &[Vec<f64>],
    within: Option<&WithinPerson>,
) -> Result<Vec<Identification>, RehearsalError> {
    let whiten = |points: &[Vec<f64>], by: &WithinPerson| -> Vec<Vec<f64>> {
        points.iter().map(|p| by.whiten(p)).collect()
    };
    let mut by_metric = vec![(Metric::Euclidean, ranks(known, seen))];
    if let Some(by) = within {
        by_metric.push((Metric::WithinPerson, ranks(&whiten(known, by), &whiten(seen, by))));
    }
    let row = |(metric, ranks): (Metric, Vec<usize>)| identification(what, metric, &ranks);
    by_metric.into_iter().map(row).collect()
}

fn identification(
    what: &'static str,
    metric: Metric,
    ranks: &[usize],
) -> Result<Identification, RehearsalError> {
    let n = ranks.len();
    let hits = ranks.iter().filter(|&&r| r == 1).count();
    let share = maveric_stats::proportion(hits, n, 0.95)?;
    Ok(Identification {
        what,
        metric,
        n,
        hits,
        rate: share.estimate,
        low: share.low,
        high: share.high,
        mean_rank: ranks.iter().sum::<usize>() as f64 / n as f64,
    })
}

/// A style as far as it is known: mean and covariance, shape `(d, d)`.
pub type Known = (Vec<f64>, Vec<Vec<f64>>);

/// −2 ln of the density of the difference of two styles, by what both leave open; none where that cannot be inverted.
pub(crate) fn distance(a: &Known, b: &Known) -> Option<f64> {
    let d = a.0.len();
    let both = DMatrix::from_fn(d, d, |i, j| a.1[i][j] + b.1[i][j]);
    let difference: Vec<f64> = a.0.iter().zip(&b.0).map(|(a, b)| a - b).collect();
    let factor = WithinPerson::from_covariance(both)?;
    let square: f64 = factor.whiten(&difference).iter().map(|x| x * x).sum();
    Some(square + factor.0.ln_determinant())
}

/// Looks for the driver of each style of `seen` among `known` by what both posteriors leave open; `None` where a covariance
/// cannot be inverted.
///
/// # Errors
/// [`RehearsalError::Stats`] without a driver.
pub fn identify_posteriors(
    what: &'static str,
    known: &[Known],
    seen: &[Known],
) -> Result<Option<Identification>, RehearsalError> {
    let mut places = Vec::with_capacity(seen.len());
    for (i, point) in seen.iter().enumerate() {
        let distances: Option<Vec<f64>> = known.iter().map(|k| distance(k, point)).collect();
        let Some(distances) = distances else {
            return Ok(None);
        };
        let nearer = |(j, d): &(usize, &f64)| *j != i && **d <= distances[i];
        places.push(1 + distances.iter().enumerate().filter(nearer).count());
    }
    identification(what, Metric::Posterior, &places).map(Some)
}

/// The covariance of one person's days: half the mean product of the differences of two, shape `(d, d)`, factored;
/// `None` where too few people drove twice for one that can be inverted.
pub fn within_person(first: &[Vec<f64>], again: &[Vec<f64>]) -> Option<WithinPerson> {
    let d = first.first()?.len();
    let differences: Vec<Vec<f64>> = first
        .iter()
        .zip(again)
        .map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect())
        .collect();
    let n = differences.len() as f64;
    let entry =
        |i: usize, j: usize| differences.iter().map(|x| x[i] * x[j]).sum::<f64>() / (2.0 * n);
    WithinPerson::from_covariance(DMatrix::from_fn(d, d, entry))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whoever_is_nearest_is_found_and_a_tie_is_not_a_hit() {
        let known = [vec![0.0], vec![1.0], vec![1.0]];
        let seen = [vec![0.1], vec![0.9], vec![0.2]];
        assert_eq!(ranks(&known, &seen), [1, 2, 3]);
        let found = identify("made up", &known, &seen, None).unwrap();
        assert_eq!((found[0].hits, found[0].n), (1, 3));
        assert!((found[0].mean_rank - 2.0).abs() < 1e-12);
        assert!(found[0].low > 0.05 && found[0].high < 0.8);
    }

    #[test]
    fn the_within_person_distance_looks_past_a_coordinate_that_changes_daily() {
        // The second number is the day, the first is the driver.
        let known = [vec![0.0, 5.0], vec![1.0, -5.0], vec![2.0, 0.0]];
        let seen = [vec![0.1, -4.0], vec![1.1, 4.0], vec![1.9, -6.0]];
        let days = [vec![0.1, -3.0], vec![-0.1, 4.0], vec![0.05, 6.0]];
        let zero = vec![vec![0.0, 0.0]; 3];
        let within = within_person(&zero, &days).unwrap();
        let found = identify("made up", &known, &seen, Some(&within)).unwrap();
        assert_eq!((found[0].metric, found[0].hits), (Metric::Euclidean, 0));
        assert_eq!((found[1].metric, found[1].hits), (Metric::WithinPerson, 3));
    }
}
