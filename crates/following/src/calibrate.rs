//! Fitting a law to drives, by the gap of whole closed-loop runs.

use crate::{
    abreast::{gap_rmse_each, numbers, products},
    error::{FollowingError, enough_drivers},
    law::{Gains, Gipps, Helly, Idm, Law, Newell},
    run::Stretch,
    search::{Cost, LAST_DIGITS, Minimum, SearchSettings, polish, search},
};
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

/// A law and how well it fits what it was fitted to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Calibrated {
    /// The law with its fitted numbers.
    pub law: Law,
    /// Its closed-loop RMSE of the gap there, the mean over people of that over the stretches of each, in m.
    pub fit_gap_rmse_m: f64,
}

/// Which numbers of a law are free, and within which bounds.
///
/// # Source
/// Bounds of IDM: v0 20-50 m/s, since a wish below 20 m/s would let congestion pass for a wish to go slowly; T 0.1-4 s, s0
/// 0.1-10 m, a 0.1-4 and b 0.1-6 m/s². Gipps alike, reaction time 0.1-3 s, expected braking of the leader 0.1-8 m/s². Helly:
/// gains 0.01-2 1/s and 0.001-0.5 1/s², at standstill 0-10 m, slope 0.1-4 s. Newell: 0.1-4 s, 0-30 m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Family {
    /// Delay and distance.
    Newell,
    /// Both gains, gap at standstill and slope.
    Helly,
    /// All six.
    Gipps,
    /// All five.
    Idm,
    /// The time gap alone, all else as in this law.
    IdmTimeGap(Idm),
}

impl Family {
    fn bounds(self) -> &'static [(f64, f64)] {
        const IDM: &[(f64, f64)] = &[
            (20.0, 50.0),
            (0.1, 4.0),
            (0.1, 10.0),
            (0.1, 4.0),
            (0.1, 6.0),
        ];
        match self {
            Self::Newell => &[(0.1, 4.0), (0.0, 30.0)],
            // Gains by their logarithm: soft steering (0.01 1/s²) fits some drivers best and is a sliver of the straight range.
            Self::Helly => &[(-4.6, 0.7), (-6.9, -0.7), (0.0, 10.0), (0.1, 4.0)],
            Self::Gipps => &[
                (20.0, 50.0),
                (0.1, 3.0),
                (0.1, 10.0),
                (0.1, 4.0),
                (0.1, 6.0),
                (0.1, 8.0),
            ],
            Self::Idm => IDM,
            Self::IdmTimeGap(_) => &IDM[1..2],
        }
    }

    fn law(self, p: &[f64]) -> Law {
        match self {
            Self::Newell => Law::Newell(Newell {
                delay_s: p[0],
                distance_m: p[1],
            }),
            Self::Helly => Law::Helly(Helly {
                gains: Gains {
                    speed_per_s: libm::exp(p[0]),
                    gap_per_s2: libm::exp(p[1]),
                },
                standstill_gap_m: p[2],
                time_gap_s: p[3],
            }),
            Self::Gipps => Law::Gipps(Gipps {
                desired_speed_mps: p[0],
                reaction_s: p[1],
                standstill_gap_m: p[2],
                max_accel_mps2: p[3],
                ego_braking_mps2: p[4],
                lead_braking_mps2: p[5],
            }),
            Self::Idm => Law::Idm(Idm {
                desired_speed_mps: p[0],
                time_gap_s: p[1],
                standstill_gap_m: p[2],
                max_accel_mps2: p[3],
                comfortable_braking_mps2: p[4],
            }),
            Self::IdmTimeGap(all_else) => Law::Idm(all_else.with_time_gap_s(p[0])),
        }
    }

    /// The free numbers of a law of this family, as [`Family::law`] takes them.
    fn numbers(self, law: Law) -> Vec<f64> {
        let all_numbers = numbers(&law);
        let free = match self {
            Self::IdmTimeGap(_) => &all_numbers[1..2],
            _ => &all_numbers[..self.bounds().len()],
        };
        let logs = if matches!(self, Self::Helly) { 2 } else { 0 };
        let number = |(k, x): (usize, &f64)| if k < logs { libm::log(*x) } else { *x };
        free.iter().enumerate().map(number).collect()
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
        law: Law,
        stretches: &[Stretch<'_>],
        settings: &SearchSettings,
    ) -> Result<Calibrated, FollowingError> {
        let cost = GapError::new(self, stretches)?;
        let bounds = self.bounds();
        let numbers = self.numbers(law).into_iter().zip(bounds);
        let point: Vec<f64> = numbers
            .map(|(x, &(low, high))| x.clamp(low, high))
            .collect();
        let start = Minimum {
            cost: cost.costs(std::slice::from_ref(&point), &[f64::INFINITY])[0],
            point,
        };
        let minimum = polish(bounds, start, settings.polishing_steps, &LAST_DIGITS, &cost);
        Ok(self.calibrated(&minimum))
    }

    fn calibrated(self, minimum: &Minimum) -> Calibrated {
        Calibrated {
            law: self.law(&minimum.point),
            fit_gap_rmse_m: minimum.cost,
        }
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
        Ok(Self {
            family,
            stretches,
            shares,
        })
    }
}

impl Cost for GapError<'_> {
    fn costs(&self, points: &[Vec<f64>], limits: &[f64]) -> Vec<f64> {
        let count = self.stretches.len() as f64;
        let mut left: Vec<usize> = (0..points.len()).collect();
        let mut sums = vec![0.0; points.len()];
        for (stretch, share) in self.stretches.iter().zip(&self.shares) {
            let laws: Vec<Law> = left.iter().map(|&i| self.family.law(&points[i])).collect();
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
        let laws: Vec<Law> = points.iter().map(|p| self.family.law(p)).collect();
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

/// Fits the time gap of `all_else` to a stretch, in s.
///
/// # Errors
/// None that a stretch can cause: those of [`Family::calibrate`].
pub(crate) fn own_time_gap_s(
    all_else: Idm,
    stretch: &Stretch<'_>,
    settings: &SearchSettings,
    seed: u64,
) -> Result<(f64, Calibrated), FollowingError> {
    let alone = std::slice::from_ref(stretch);
    let calibrated = Family::IdmTimeGap(all_else).calibrate(alone, settings, seed)?;
    let time_gap_s = match calibrated.law {
        Law::Idm(law) => law.time_gap_s,
        _ => all_else.time_gap_s,
    };
    Ok((time_gap_s, calibrated))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        FollowingRun, simulate,
        testing::{self, DRIVER, driven_by_idm},
    };

    #[test]
    fn idm_is_recovered_from_its_own_drive() {
        let run = driven_by_idm("P01", DRIVER);
        let found = Family::Idm
            .calibrate(&[run.fit()], &SearchSettings::default(), 1)
            .unwrap();
        assert!(found.fit_gap_rmse_m < 0.05, "{found:?}");
        let Law::Idm(law) = found.law else {
            panic!("{found:?}");
        };
        assert!((law.time_gap_s - DRIVER.time_gap_s).abs() < 0.02);
        assert!((law.standstill_gap_m - DRIVER.standstill_gap_m).abs() < 0.2);
        assert!((law.max_accel_mps2 - DRIVER.max_accel_mps2).abs() < 0.1);
    }

    #[test]
    fn the_own_time_gap_is_recovered_with_all_else_known() {
        let run = driven_by_idm("P01", DRIVER);
        let population = DRIVER.with_time_gap_s(2.6);
        let search = SearchSettings::default();
        let (found, _) = own_time_gap_s(population, &run.fit(), &search, 1).unwrap();
        assert!((found - DRIVER.time_gap_s).abs() < 1e-3);
    }

    #[test]
    fn newell_is_recovered_from_its_own_drive() {
        let newell = Law::Newell(Newell {
            delay_s: 1.3,
            distance_m: 5.0,
        });
        let run = testing::driven(|stretch| simulate(stretch, "newell", newell.driving(stretch)));
        let found = Family::Newell
            .calibrate(&[run.fit()], &SearchSettings::default(), 1)
            .unwrap();
        assert!(found.fit_gap_rmse_m < 0.05, "{found:?}");
        assert!(matches!(found.law, Law::Newell(l) if (l.delay_s - 1.3).abs() < 0.02));
    }

    #[test]
    fn gipps_follows_its_own_drive() {
        let gipps = Gipps {
            desired_speed_mps: 35.0,
            reaction_s: 0.9,
            standstill_gap_m: 3.0,
            max_accel_mps2: 1.6,
            ego_braking_mps2: 2.5,
            lead_braking_mps2: 2.8,
        };
        let run = testing::driven_by("P01", |g, v, l| gipps.accel_mps2(g, v, l));
        let found = Family::Gipps
            .calibrate(&[run.fit()], &SearchSettings::default(), 1)
            .unwrap();
        assert!(found.fit_gap_rmse_m < 0.2, "{found:?}");
    }

    #[test]
    fn a_person_weighs_as_much_as_another_however_many_drives_they_have() {
        let [a, b] = [("A", 1.0), ("B", 2.4)]
            .map(|(name, seconds)| driven_by_idm(name, DRIVER.with_time_gap_s(seconds)));
        let point = Family::Idm.numbers(Law::Idm(DRIVER));
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
        let found = Family::Helly.calibrate(&[], &SearchSettings::default(), 1);
        assert!(found.is_err());
    }
}
