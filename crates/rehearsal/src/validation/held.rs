//! Do the standard errors of styles hold? Two drives of one person, each with what its fit leaves open.

use super::Known;
use crate::error::RehearsalError;
use maveric_stats::{BootstrapData, BootstrapSettings, Interval, Statistic, bootstrap};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// A share with its interval over people.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ShareOfPeople {
    pub estimate: f64,
    /// 95 % of the shares of people drawn with replacement; none for fewer than two.
    pub interval: Option<(f64, f64)>,
}

/// How many coordinates of the second drives lie where the first ones expect them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Held {
    /// People whose two drives both have a covariance.
    pub people: usize,
    /// People left out because a drive has none.
    pub left_out: usize,
    /// Coordinates of all of them.
    pub coordinates: usize,
    /// Coordinates about which one of the drives says nothing: they are expected exactly where they are, and not counted.
    pub silent: usize,
    /// Within one standard error: 68.3 % would be right.
    pub within_1: Option<ShareOfPeople>,
    /// Within two: 95.4 % would be right.
    pub within_2: Option<ShareOfPeople>,
}

/// A variance below this is that of a drive that says nothing.
const NOTHING: f64 = 1e-9;

/// Compares first and second drives of the same people, in whitened coordinates.
///
/// A fit with the prior N(0, I) is drawn to 0 as far as its drive leaves the style open, so that the second mean is expected at
/// (I − V₂) m₁, with the covariance (I − V₂) V₁ (I − V₂)ᵀ + (I − V₂) V₂, also where a drive shows little. Without a prior it is expected
/// at m₁, with V₁ + V₂.
///
/// # Errors
/// [`RehearsalError::Stats`] for a mean that is no number.
pub fn held(
    first: &[Option<Known>],
    again: &[Option<Known>],
    prior: bool,
    seed: u64,
) -> Result<Held, RehearsalError> {
    let pairs = first.iter().zip(again);
    let both: Vec<(&Known, &Known)> =
        pairs.filter_map(|(a, b)| a.as_ref().zip(b.as_ref())).collect();
    let errors: Vec<Vec<f64>> =
        both.iter().map(|(a, b)| standardised(a, b, prior, NOTHING)).collect();
    let counted: usize = errors.iter().map(Vec::len).sum();
    let coordinates = both.iter().map(|(a, _)| a.0.len()).sum();
    let share = |k: f64| -> Result<Option<ShareOfPeople>, RehearsalError> {
        let within = |z: &Vec<f64>| z.iter().filter(|z| z.abs() <= k).count() as f64;
        if counted == 0 {
            return Ok(None);
        }
        let estimate = errors.iter().map(within).sum::<f64>() / counted as f64;
        // Each person counts with all of their coordinates.
        let of_each = errors.iter().filter(|z| !z.is_empty());
        let of_each: Vec<Option<f64>> = of_each.map(|z| Some(within(z) / z.len() as f64)).collect();
        let settings = BootstrapSettings { seed, ..BootstrapSettings::default() };
        let interval = (of_each.len() > 1)
            .then(|| bootstrap(Statistic::Mean, BootstrapData::Values(&of_each), &settings))
            .transpose()?;
        let ends = |i: Interval| i.low.zip(i.high);
        Ok(Some(ShareOfPeople {
            estimate,
            interval: interval.and_then(|resampled| ends(resampled.percentile)),
        }))
    };
    Ok(Held {
        people: both.len(),
        left_out: first.len() - both.len(),
        coordinates,
        silent: coordinates - counted,
        within_1: share(1.0)?,
        within_2: share(2.0)?,
    })
}

/// d_j / √C_jj of each coordinate of a variance above `least` (`NOTHING`: both drives say something of it). With the prior
/// d = m₂ − (I − V₂) m₁ and C = (I − V₂) V₁ (I − V₂)ᵀ + (I − V₂) V₂; without it d = m₂ − m₁ and C = V₁ + V₂.
pub(crate) fn standardised(first: &Known, again: &Known, prior: bool, least: f64) -> Vec<f64> {
    let matrix = |known: &Known| {
        let d = known.0.len();
        DMatrix::from_fn(d, d, |i, j| known.1[i][j])
    };
    let mean = |known: &Known| DVector::from_column_slice(&known.0);
    let (v1, v2) = (matrix(first), matrix(again));
    let (difference, covariance) = if prior {
        let kept = DMatrix::identity(v2.nrows(), v2.nrows()) - &v2;
        (mean(again) - &kept * mean(first), &kept * &v1 * kept.transpose() + &kept * &v2)
    } else {
        (mean(again) - mean(first), v1 + v2)
    };
    let each = difference.iter().zip(covariance.diagonal().iter().copied().collect::<Vec<f64>>());
    each.filter(|(_, variance)| *variance > least)
        .map(|(d, variance)| d / variance.sqrt())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng as _;
    use rand_distr::{Distribution as _, StandardNormal};
    use rand_pcg::Pcg64;

    /// Posteriors of two drives of `n` people whose readings have this error, taken for `said` by the fit.
    fn twice(n: usize, error: f64, said: f64, prior: bool) -> [Vec<Option<Known>>; 2] {
        let mut rng = Pcg64::seed_from_u64(7);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut days = [Vec::new(), Vec::new()];
        for _ in 0..n {
            let w = [normal(), normal()];
            for day in &mut days {
                // The second coordinate is read half as well.
                let sds = [said, 2.0 * said];
                let fitted = [0, 1].map(|j| {
                    let reading = w[j] + error * (sds[j] / said) * normal();
                    let open = if prior { 1.0 / (1.0 + sds[j].powi(-2)) } else { sds[j].powi(2) };
                    (if prior { (1.0 - open) * reading } else { reading }, open)
                });
                let covariance = vec![vec![fitted[0].1, 0.0], vec![0.0, fitted[1].1]];
                day.push(Some((fitted.map(|f| f.0).to_vec(), covariance)));
            }
        }
        days
    }

    #[test]
    fn errors_as_large_as_said_hold_with_and_without_a_prior_and_larger_ones_do_not() {
        for prior in [true, false] {
            let found = |error: f64| {
                let [first, again] = twice(4000, error, 0.7, prior);
                let found = held(&first, &again, prior, 1).unwrap();
                (found.within_1.unwrap(), found.within_2.unwrap())
            };
            let (one, two) = found(0.7);
            assert!((one.estimate - 0.683).abs() < 0.015, "{prior} {one:?}");
            assert!((two.estimate - 0.954).abs() < 0.01, "{prior} {two:?}");
            let (low, high) = one.interval.unwrap();
            assert!(low < one.estimate && one.estimate < high && high - low < 0.05);
            let (one, two) = found(1.4);
            assert!(one.estimate < 0.6 && two.estimate < 0.9, "{prior} {one:?} {two:?}");
            let (one, _) = found(0.2);
            assert!(one.estimate > 0.75, "{prior} {one:?}");
        }
    }

    #[test]
    fn a_drive_that_says_nothing_is_not_counted_and_one_without_a_covariance_is_left_out() {
        let open = || Some((vec![0.0], vec![vec![1.0]]));
        let known = || Some((vec![0.5], vec![vec![0.5]]));
        let first = [known(), known(), known()];
        let again = [open(), None, known()];
        let found = held(&first, &again, true, 1).unwrap();
        assert_eq!((found.people, found.left_out), (2, 1));
        assert_eq!((found.coordinates, found.silent), (2, 1));
        assert!((found.within_1.unwrap().estimate - 1.0).abs() < 1e-12);
        assert_eq!(found.within_1.unwrap().interval, None);
        let nobody = held(&[None], &[None], true, 1).unwrap();
        assert_eq!((nobody.people, nobody.within_1), (0, None));
    }
}
