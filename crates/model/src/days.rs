//! How far one person's drives differ: what a single drive leaves open of the person who drove it.
//!
//! A fit says how well a drive's style is known. Whoever is personalised from one drive wants to know how well the *person's* style is
//! known, and people drive differently from day to day. That cannot be read from a drive, however long; it is learned from people who
//! drove more than once, as the covariance of a drive's style about the person's.

use crate::{
    error::ModelError,
    heads::{Posterior, StyleHead},
    linear_algebra::of_symmetric,
};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Shares of a fit's error that are tried as what differs from drive to drive.
const SHARES: usize = 20;
/// Difference of log-likelihoods that the search for the covariance may leave.
const AS_LIKELY: f64 = 0.01;
/// Rounds of expectation and maximisation at most, and the largest change at which they end.
const ROUNDS: usize = 2000;
const TOLERANCE: f64 = 1e-7;
/// Where they begin, in variances of drivers.
const FIRST: f64 = 0.2;
/// Least precision of a reading, so that a drive which says nothing of a direction can be written down.
const LEAST: f64 = 1e-6;
/// Variance of a difference, in variances of drivers, from which a direction is one of which the drives say nothing.
const SILENT: f64 = 200.0;

/// The covariance of drives of one person in style space.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Days {
    /// Shape `(d, d)`, row by row.
    covariance: Vec<f64>,
    /// Share of a fit's own error that another drive of the same person has anew. What a style leaves unsaid of somebody's habits is
    /// an error of their style's fit, but where it stays with the person, a second drive has it too.
    error_share: f64,
    /// People it was learned from, each by two drives.
    pub people: usize,
}

/// Two drives of one person, each with what it says of its style.
pub(crate) type Pair = [Posterior; 2];

impl Days {
    /// The likeliest covariance for people who drove twice; `None` with fewer people than numbers of a style.
    ///
    /// `prior` says whether the fits have the prior N(0, I), as those of linear heads do.
    pub(crate) fn learn(pairs: &[Pair], prior: bool, d: usize) -> Option<Self> {
        let differences: Vec<(DVector<f64>, DMatrix<f64>)> = pairs
            .iter()
            .filter_map(|[first, again]| {
                let (r1, e1) = reading(first, prior)?;
                let (r2, e2) = reading(again, prior)?;
                Some((r2 - r1, e1 + e2))
            })
            .collect();
        let people = differences.len();
        if people < d {
            return None;
        }
        let tried = (1..=SHARES).rev().filter_map(|step| {
            let share = step as f64 / SHARES as f64;
            let (twice, log_likelihood) = likeliest(&differences, share, d)?;
            Some((share, twice, log_likelihood))
        });
        // Of shares that are about as likely the largest.
        let (error_share, twice, _) =
            tried.reduce(|a, b| if b.2 > a.2 + AS_LIKELY { b } else { a })?;
        let covariance = 0.5 * twice;
        Some(Self { covariance: covariance.iter().copied().collect(), error_share, people })
    }

    /// Standard deviation of a person's drives along each number of a style.
    pub fn sd(&self) -> Vec<f64> {
        let diagonal = self.matrix().diagonal();
        diagonal.iter().map(|v| v.max(0.0).sqrt()).collect()
    }

    fn matrix(&self) -> DMatrix<f64> {
        let d = self.covariance.len().isqrt();
        DMatrix::from_row_slice(d, d, &self.covariance)
    }

    /// What a drive, by its posterior with the prior N(0, I), and a score say of the person who drove.
    pub(crate) fn of_person(
        &self,
        drive: &Posterior,
        score: Option<(f64, &StyleHead)>,
    ) -> Option<Posterior> {
        let (reading, error) = reading(drive, true)?;
        let d = reading.len();
        let known = (self.error_share * error + self.matrix()).try_inverse()?;
        let mut right = &known * reading;
        let mut precision = DMatrix::identity(d, d) + known;
        if let Some((points, style)) = score {
            let gradient = DVector::from_column_slice(&style.gradient);
            let weight = 1.0 / (style.reading_sd * style.reading_sd);
            precision += weight * &gradient * gradient.transpose();
            right += weight * (points - style.offset) * gradient;
        }
        let covariance = precision.try_inverse()?;
        let mean = &covariance * right;
        Some(Posterior {
            mean: mean.iter().copied().collect(),
            covariance: covariance.iter().copied().collect(),
        })
    }

    /// A fit without a prior, with what the day adds to its covariance; one without a covariance stays without.
    pub(crate) fn added_to(&self, mut drive: Posterior) -> Posterior {
        for (entry, day) in drive.covariance.iter_mut().zip(&self.covariance) {
            *entry = self.error_share * *entry + day;
        }
        drive
    }

    /// Checks what was read from a file.
    pub(crate) fn check(&self, d: usize) -> Result<(), ModelError> {
        let is_covariance = self.covariance.len() == d * d
            && (0.0..=1.0).contains(&self.error_share)
            && self.covariance.iter().all(|x| x.is_finite())
            && self.matrix().symmetric_eigenvalues().min() > -1e-9;
        if is_covariance {
            return Ok(());
        }
        Err(ModelError::bad_file("its covariance of a person's drives is of another size or none"))
    }
}

/// The covariance of differences between two drives, beside a share of the errors of both, and its log-likelihood but for a constant.
fn likeliest(
    differences: &[(DVector<f64>, DMatrix<f64>)],
    share: f64,
    d: usize,
) -> Option<(DMatrix<f64>, f64)> {
    // Of a difference: twice the days'.
    let mut twice = DMatrix::identity(d, d) * (2.0 * FIRST);
    for _ in 0..ROUNDS {
        let mut sum = DMatrix::zeros(d, d);
        for (difference, error) in differences {
            let total = (share * error + &twice).cholesky()?;
            let gain = total.solve(&twice).transpose();
            let mean = &gain * difference;
            sum += &mean * mean.transpose() + &twice - &gain * &twice;
        }
        let next = sum / differences.len() as f64;
        let next = 0.5 * (&next + next.transpose());
        let change = (&next - &twice).amax();
        twice = next;
        if change < TOLERANCE {
            break;
        }
    }
    let of_each = differences.iter().map(|(difference, error)| {
        // Of a direction in which the drives say nothing every share is as likely.
        let eigen = error.clone().symmetric_eigen();
        let directions = (0..d).filter(|j| eigen.eigenvalues[*j] < SILENT);
        let directions = eigen.eigenvectors.select_columns(directions.collect::<Vec<_>>().iter());
        if directions.ncols() == 0 {
            return Some(0.0);
        }
        let total = (directions.transpose() * (share * error + &twice) * &directions).cholesky()?;
        let difference = directions.transpose() * difference;
        let away = difference.dot(&total.solve(&difference));
        let determinant: f64 = total.l().diagonal().iter().map(|x| 2.0 * libm::log(*x)).sum();
        Some(-0.5 * (away + determinant))
    });
    let log_likelihood = of_each.sum::<Option<f64>>()?;
    Some((twice, log_likelihood))
}

/// What a drive alone says of its style, without a prior: a reading and its error.
fn reading(drive: &Posterior, prior: bool) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let mean = DVector::from_column_slice(&drive.mean);
    let d = mean.len();
    if drive.covariance.len() != d * d {
        return None;
    }
    let covariance = DMatrix::from_row_slice(d, d, &drive.covariance);
    if !prior {
        return Some((mean, covariance));
    }
    let precision = covariance.try_inverse()?;
    let right = &precision * mean;
    let information = precision - DMatrix::identity(d, d);
    let error =
        of_symmetric(&(0.5 * (&information + information.transpose())), |v| 1.0 / v.max(LEAST));
    Some((&error * right, error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng as _;
    use rand_distr::{Distribution as _, StandardNormal};
    use rand_pcg::Pcg64Mcg;

    /// People whose drives differ by this variance, each read with errors of this variance, in one number.
    fn pairs(n: usize, day: f64, error: f64, prior: bool) -> Vec<Pair> {
        pairs_that_share(n, day, error, prior, 0.0)
    }

    /// The same, where this share of the errors' variance is the same in both drives of a person.
    fn pairs_that_share(n: usize, day: f64, error: f64, prior: bool, shared: f64) -> Vec<Pair> {
        let mut rng = Pcg64Mcg::seed_from_u64(3);
        let mut normal = |variance: f64| -> f64 {
            let z: f64 = StandardNormal.sample(&mut rng);
            variance.sqrt() * z
        };
        let drive = |person: f64, stays: f64, normal: &mut dyn FnMut(f64) -> f64| {
            let reading = person + normal(day) + stays + normal((1.0 - shared) * error);
            let open = if prior { error / (1.0 + error) } else { error };
            Posterior {
                mean: vec![if prior { (1.0 - open) * reading } else { reading }],
                covariance: vec![open],
            }
        };
        (0..n)
            .map(|i| {
                let person = 1.0 - 2.0 * ((i as f64 * 0.754_877) % 1.0);
                let stays = normal(shared * error);
                [(); 2].map(|()| drive(person, stays, &mut normal))
            })
            .collect()
    }

    #[test]
    fn an_error_that_stays_with_the_person_is_none_of_another_drive() {
        for prior in [true, false] {
            for shared in [0.0, 0.5] {
                let days = Days::learn(&pairs_that_share(3000, 0.0, 0.8, prior, shared), prior, 1);
                let days = days.unwrap();
                let differs = days.error_share * 0.8 + days.sd()[0].powi(2);
                assert!((differs - (1.0 - shared) * 0.8).abs() < 0.04, "{prior} {shared} {days:?}");
                assert!((days.error_share - (1.0 - shared)).abs() < 0.11, "{days:?}");
            }
        }
        // Where nothing is shared the error is the drive's, whole.
        let whole = Days::learn(&pairs(3000, 0.3, 0.2, true), true, 1).unwrap();
        assert!((whole.error_share - 1.0).abs() < 1e-9, "{whole:?}");
    }

    #[test]
    fn drives_that_say_nothing_are_no_reason_to_trust_the_others() {
        let silent = Posterior { mean: vec![0.0], covariance: vec![1.0] };
        let mut some = pairs(300, 0.0, 0.5, true);
        let without = Days::learn(&some, true, 1).unwrap();
        some.extend((0..300).map(|_| [silent.clone(), silent.clone()]));
        let with = Days::learn(&some, true, 1).unwrap();
        assert!((with.error_share - without.error_share).abs() < 1e-9, "{with:?} {without:?}");
    }

    #[test]
    fn the_days_come_back_with_and_without_a_prior_and_none_is_none() {
        for prior in [true, false] {
            for day in [0.0, 0.3] {
                let found = Days::learn(&pairs(3000, day, 0.2, prior), prior, 1).unwrap();
                let variance = found.sd()[0].powi(2);
                assert!((variance - day).abs() < 0.03, "{prior} {day} {variance}");
            }
        }
        assert!(Days::learn(&[], true, 1).is_none());
    }

    #[test]
    fn a_person_is_known_less_well_than_the_drive_and_lies_nearer_to_the_mean() {
        let days = Days { covariance: vec![0.5], error_share: 1.0, people: 30 };
        let drive = Posterior { mean: vec![1.0], covariance: vec![0.2] };
        // Reading 1.25 with error .25; with the day .75: precision 1 + 4/3.
        let person = days.of_person(&drive, None).unwrap();
        assert!((person.covariance[0] - 3.0 / 7.0).abs() < 1e-9);
        assert!((person.mean[0] - 5.0 / 7.0).abs() < 1e-9);
        let style = StyleHead {
            gradient: vec![8.0],
            offset: 28.0,
            covariance: vec![0.0; 4],
            reading_sd: 4.0,
            cross_fitted_rmse: None,
            cross_fitted_r: None,
            people: 30,
            drives: 30,
        };
        let with = days.of_person(&drive, Some((44.0, &style))).unwrap();
        assert!(with.mean[0] > 1.0 && with.covariance[0] < 0.2);
        let open = Posterior { mean: vec![0.0], covariance: vec![1.0] };
        let nothing = days.of_person(&open, None).unwrap();
        assert!(nothing.mean[0].abs() < 1e-6 && (nothing.covariance[0] - 1.0).abs() < 1e-5);
        assert!((days.added_to(drive).covariance[0] - 0.7).abs() < 1e-12);
        assert!(days.check(1).is_ok() && days.check(2).is_err());
    }
}
