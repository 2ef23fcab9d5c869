//! Fitting IDM to drives, by the gap of whole closed-loop runs.

use crate::{
    abreast::{gap_rmse_each, numbers, products},
    error::{FollowingError, enough_drivers},
    run::Stretch,
    search::{Cost, Minimum, SearchSettings, polish, search},
};
use maveric_laws::Idm;
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

/// A law and how well it fits what it was fitted to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Calibrated {
    /// The law with its fitted numbers.
    pub law: Idm,
    /// Its closed-loop RMSE of the gap there, the mean over people of that over the stretches of each, in m.
    pub fit_gap_rmse_m: f64,
}

/// Which numbers of IDM are free, and within which bounds.
///
/// # Source
/// Bounds: v0 20-50 m/s, since a wish below 20 m/s would let congestion pass for a wish to go slowly; T 0.1-4 s, s0
/// 0.1-10 m, a 0.1-4 and b 0.1-6 m/s².
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Family {
    Idm,
    /// The time gap alone, all else as in this law.
    IdmTimeGap(Idm),
}

impl Family {
    fn bounds(self) -> &'static [(f64, f64)] {
        const IDM: &[(f64, f64)] = &[(20.0, 50.0), (0.1, 4.0), (0.1, 10.0), (0.1, 4.0), (0.1, 6.0)];
        match self {
            Self::Idm => IDM,
            Self::IdmTimeGap(_) => &IDM[1..2],
        }
    }

    fn law(self, p: &[f64]) -> Idm {
        match self {
            Self::Idm => Idm {
                desired_speed_mps: p[0],
                time_gap_s: p[1],
                standstill_gap_m: p[2],
                max_accel_mps2: p[3],
                comfortable_braking_mps2: p[4],
            },
            Self::IdmTimeGap(all_else) => all_else.with_time_gap_s(p[0]),
        }
    }

    /// The free numbers of a law of this family, as [`Family::law`] takes them.
    fn numbers(self, law: Idm) -> Vec<f64> {
        let all_numbers = numbers(&law);
        let free = match self {
            Self::Idm => &all_numbers[..self.bounds().len()],
            Self::IdmTimeGap(_) => &all_numbers[1..2],
        };
        free.to_vec()
    }

    /// Fits the free numbers to one or more stretches, every person the same weight. Same seed, same result.
    ///
    /// # Errors
    /// [`FollowingError::TooFewDrivers`] without stretches.
    ///
    /// # Source
    /// Differential evolution on the closed-loop RMSE of the gap, then Levenberg-Marquardt.
    pub fn calibrate(
        self,
        stretches: &[Stretch<'_>],
        settings: &SearchSettings,
        seed: u64,
    ) -> Result<Calibrated, FollowingError> {
        let cost = GapError::new(self, stretches)?;
        let minimum = search(self.bounds(), settings, seed, &cost);
        Ok(self.calibrated(&minimum))
    }

    /// Fits the free numbers from those of a law of this family on, which was fitted to much the same stretches: a way down, and no search.
    ///
    /// # Errors
    /// [`FollowingError::TooFewDrivers`] without stretches.
    pub(crate) fn calibrate_from(
        self,
        law: Idm,
        stretches: &[Stretch<'_>],
        settings: &SearchSettings,
    ) -> Result<Calibrated, FollowingError> {
        let cost = GapError::new(self, stretches)?;
        let bounds = self.bounds();
        let numbers = self.numbers(law).into_iter().zip(bounds);
        let point: Vec<f64> = numbers.map(|(x, &(low, high))| x.clamp(low, high)).collect();
        let start =
            Minimum { cost: cost.costs(std::slice::from_ref(&point), &[f64::INFINITY])[0], point };
        let minimum = polish(bounds, start, settings.polishing_steps, &cost);
        Ok(self.calibrated(&minimum))
    }

    fn calibrated(self, minimum: &Minimum) -> Calibrated {
        Calibrated { law: self.law(&minimum.point), fit_gap_rmse_m: minimum.cost }
    }
}

/// Least RMSE by which a stretch is weighed, in m: one that is fitted exactly would outweigh all others.
const LEAST_RMSE_M: f64 = 1e-6;

/// The mean over people of the mean over their stretches of the RMSE of the gap, of the laws of a family.
struct GapError<'a> {
    family: Family,
    stretches: &'a [Stretch<'a>],
    /// How much each stretch counts: 1 where everybody has as many.
    shares: Vec<f64>,
}

impl<'a> GapError<'a> {
    fn new(family: Family, stretches: &'a [Stretch<'a>]) -> Result<Self, FollowingError> {
        enough_drivers(stretches.len(), 1)?;
        let of_person = |stretch: &Stretch<'_>| {
            let person = stretch.run.person();
            let theirs = stretches.iter().filter(|s| s.run.person() == person);
            theirs.count() as f64
        };
        let counts: Vec<f64> = stretches.iter().map(of_person).collect();
        let people = counts.iter().map(|count| 1.0 / count).sum::<f64>();
        let all = stretches.len() as f64;
        let shares = counts.iter().map(|count| all / (people * count)).collect();
        Ok(Self { family, stretches, shares })
    }
}

impl Cost for GapError<'_> {
    fn costs(&self, points: &[Vec<f64>], limits: &[f64]) -> Vec<f64> {
        let count = self.stretches.len() as f64;
        let mut left: Vec<usize> = (0..points.len()).collect();
        let mut sums = vec![0.0; points.len()];
        for (stretch, share) in self.stretches.iter().zip(&self.shares) {
            let laws: Vec<Idm> = left.iter().map(|&i| self.family.law(&points[i])).collect();
            let most = left.iter().map(|&i| (limits[i] * count - sums[i]) / share);
            let most: Vec<f64> = most.collect();
            for (&i, rmse_m) in left.iter().zip(gap_rmse_each(stretch, &laws, &most)) {
                sums[i] += share * rmse_m;
            }
            left.retain(|&i| sums[i].is_finite());
        }
        sums.iter().map(|sum| sum / count).collect()
    }

    /// An error of a stretch weighs by its share over its RMSE: so the squares add up to the mean of the RMSEs.
    fn products(&self, points: &[Vec<f64>]) -> DMatrix<f64> {
        let n = points.len();
        let laws: Vec<Idm> = points.iter().map(|p| self.family.law(p)).collect();
        let mut sum = DMatrix::zeros(n, n);
        for (stretch, share) in self.stretches.iter().zip(&self.shares) {
            let sums = products(stretch, &laws);
            let rows = (stretch.rows.len() - 1) as f64;
            let rmse = (sums[0][0] / rows).sqrt().max(LEAST_RMSE_M);
            let weight = share / (rows * rmse * self.stretches.len() as f64);
            sum += DMatrix::from_fn(n, n, |k, l| weight * sums[k][l]);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        FollowingRun,
        testing::{DRIVER, driven_by_idm},
    };

    #[test]
    fn idm_is_recovered_from_its_own_drive() {
        let run = driven_by_idm("P01", DRIVER);
        let found = Family::Idm.calibrate(&[run.fit()], &SearchSettings::default(), 1).unwrap();
        assert!(found.fit_gap_rmse_m < 0.05, "{found:?}");
        let law = found.law;
        assert!((law.time_gap_s - DRIVER.time_gap_s).abs() < 0.02);
        assert!((law.standstill_gap_m - DRIVER.standstill_gap_m).abs() < 0.2);
        assert!((law.max_accel_mps2 - DRIVER.max_accel_mps2).abs() < 0.1);
    }

    #[test]
    fn the_own_time_gap_is_recovered_with_all_else_known() {
        let run = driven_by_idm("P01", DRIVER);
        let population = DRIVER.with_time_gap_s(2.6);
        let search = SearchSettings::default();
        let found = Family::IdmTimeGap(population).calibrate(&[run.fit()], &search, 1).unwrap();
        assert!((found.law.time_gap_s - DRIVER.time_gap_s).abs() < 1e-3);
        assert_eq!(found.law.with_time_gap_s(2.6), population);
    }

    #[test]
    fn a_person_weighs_as_much_as_another_however_many_drives_they_have() {
        let [a, b] = [("A", 1.0), ("B", 2.4)]
            .map(|(name, seconds)| driven_by_idm(name, DRIVER.with_time_gap_s(seconds)));
        let point = Family::Idm.numbers(DRIVER);
        let error = |runs: &[&FollowingRun]| {
            let fits: Vec<Stretch<'_>> = runs.iter().map(|run| run.fit()).collect();
            let error = GapError::new(Family::Idm, &fits).unwrap();
            let cost = error.costs(std::slice::from_ref(&point), &[f64::INFINITY])[0];
            (cost, error.products(std::slice::from_ref(&point))[(0, 0)])
        };
        let (of_a, of_b, of_both) = (error(&[&a]), error(&[&b]), error(&[&a, &a, &a, &b]));
        assert!((of_a.0 - of_b.0).abs() > 0.1, "{of_a:?} {of_b:?}");
        assert!((of_both.0 - 0.5 * (of_a.0 + of_b.0)).abs() < 1e-9);
        assert!((of_both.1 - 0.5 * (of_a.1 + of_b.1)).abs() < 1e-9);
    }

    #[test]
    fn nothing_to_fit_to_is_an_error() {
        let found = Family::Idm.calibrate(&[], &SearchSettings::default(), 1);
        assert!(found.is_err());
    }
}
