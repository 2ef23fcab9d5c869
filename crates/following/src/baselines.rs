//! What a few parameters can do: the laws that stand beside a learned following distance.

use super::{
    calibrate::{
        Calibrated, calibrate_gipps, calibrate_helly, calibrate_idm, calibrate_idm_along,
        calibrate_idm_time_gap, calibrate_idm_time_gap_and_standstill, calibrate_newell,
    },
    error::FollowingError,
    laws::{
        gipps::Gipps, helly::Helly, idm::Idm, idm_directions::IdmDirections, newell::Newell,
        time_gap::ConstantTimeGap,
    },
    method::FollowingMethod,
    run::{FollowingRun, Stretch},
    settings::FollowingSettings,
};
use maveric_domain::stream_seed;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// The laws fitted for one driver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DriverBaselines {
    /// Name of the driver.
    pub driver: String,
    /// The mean time gap of the own fit rows.
    pub constant_time_gap_own: ConstantTimeGap,
    /// The mean of the others' mean time gaps.
    pub constant_time_gap_population: ConstantTimeGap,
    /// Fitted to the own fit rows.
    pub newell_own: Calibrated<Newell>,
    /// Fitted to the own fit rows.
    pub helly_own: Calibrated<Helly>,
    /// Fitted to the others' fit rows; its gains also steer by F.
    pub helly_population: Calibrated<Helly>,
    /// Fitted to the own fit rows.
    pub gipps_own: Calibrated<Gipps>,
    /// Fitted to the own fit rows.
    pub idm_own: Calibrated<Idm>,
    /// Fitted to the others' fit rows.
    pub idm_population: Calibrated<Idm>,
    /// The same, its time gap fitted to the own fit rows.
    pub idm_population_own_time_gap: Calibrated<Idm>,
    /// The same, its time gap and its gap at standstill fitted to the own fit rows.
    pub idm_population_own_time_gap_and_standstill: Calibrated<Idm>,
    /// Along the principal directions of the others' own fits, as far as fits the own fit rows best.
    pub idm_principal_directions: Calibrated<Idm>,
    /// Fitted to the own test rows: no prediction.
    pub idm_floor: Calibrated<Idm>,
}

/// The laws fitted for each driver, in the order of the runs.
///
/// They do not depend on any network: fit them once for all training seeds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Baselines {
    /// One entry a driver.
    pub drivers: Vec<DriverBaselines>,
}

impl Baselines {
    /// Fits every law for every driver; a driver's population is all the other runs.
    ///
    /// A search's random numbers depend on the seed, the driver's name and the method alone, and the result not on
    /// the number of threads.
    ///
    /// # Errors
    /// [`FollowingError::TooFewDrivers`] below two runs; [`FollowingError::NeverMoves`] for a driver without a
    /// time gap; [`FollowingError::BadSetting`].
    pub fn calibrate(
        runs: &[FollowingRun],
        settings: &FollowingSettings,
    ) -> Result<Self, FollowingError> {
        settings.check()?;
        if runs.len() < 2 {
            return Err(FollowingError::TooFewDrivers {
                found: runs.len(),
                expected: 2,
            });
        }
        let time_gaps = runs
            .iter()
            .map(|run| run.fit().mean_time_gap_s(settings.moving_above_mps))
            .collect::<Result<Vec<_>, _>>()?;
        let idm_own = each(runs, |run| {
            let seed = seed(settings, run, FollowingMethod::IdmOwn);
            calibrate_idm(&[run.fit()], &settings.search, seed)
        })?;
        let drivers = each_at(runs, |driver| {
            calibrate_driver(runs, driver, &time_gaps, &idm_own, settings)
        })?;
        Ok(Self { drivers })
    }
}

fn each<T: Send>(
    runs: &[FollowingRun],
    fit: impl Fn(&FollowingRun) -> Result<T, FollowingError> + Sync + Send,
) -> Result<Vec<T>, FollowingError> {
    each_at(runs, |at| fit(&runs[at]))
}

fn each_at<T: Send>(
    runs: &[FollowingRun],
    fit: impl Fn(usize) -> Result<T, FollowingError> + Sync + Send,
) -> Result<Vec<T>, FollowingError> {
    // Collected before looking for an error, so that the first one is always the same one.
    let fitted: Vec<_> = (0..runs.len()).into_par_iter().map(fit).collect();
    fitted.into_iter().collect()
}

fn seed(settings: &FollowingSettings, run: &FollowingRun, method: FollowingMethod) -> u64 {
    stream_seed(settings.seed, &[run.driver(), method.as_str()])
}

fn calibrate_driver(
    runs: &[FollowingRun],
    driver: usize,
    time_gaps_s: &[f64],
    idm_own: &[Calibrated<Idm>],
    settings: &FollowingSettings,
) -> Result<DriverBaselines, FollowingError> {
    use FollowingMethod as M;
    let run = &runs[driver];
    let seed = |method| seed(settings, run, method);
    let search = &settings.search;
    let others: Vec<usize> = (0..runs.len()).filter(|&at| at != driver).collect();
    let of_others: Vec<Stretch<'_>> = others.iter().map(|&at| runs[at].fit()).collect();
    let own = [run.fit()];
    let gaps = others.iter().map(|&at| time_gaps_s[at]);
    let population_gap_s = gaps.sum::<f64>() / others.len() as f64;
    let idm_population = calibrate_idm(&of_others, search, seed(M::IdmPopulation))?;
    let law = idm_population.law;
    let fits: Vec<Idm> = others.iter().map(|&at| idm_own[at].law).collect();
    let directions = IdmDirections::of(&fits);
    Ok(DriverBaselines {
        driver: run.driver().to_owned(),
        constant_time_gap_own: ConstantTimeGap::new(time_gaps_s[driver]),
        constant_time_gap_population: ConstantTimeGap::new(population_gap_s),
        newell_own: calibrate_newell(&own, search, seed(M::NewellOwn))?,
        helly_own: calibrate_helly(&own, search, seed(M::HellyOwn))?,
        helly_population: calibrate_helly(&of_others, search, seed(M::HellyPopulation))?,
        gipps_own: calibrate_gipps(&own, search, seed(M::GippsOwn))?,
        idm_own: idm_own[driver],
        idm_population,
        idm_population_own_time_gap: {
            let seed = seed(M::IdmPopulationOwnTimeGap);
            calibrate_idm_time_gap(law, &own, search, seed)?
        },
        idm_population_own_time_gap_and_standstill: {
            let seed = seed(M::IdmPopulationOwnTimeGapAndStandstill);
            calibrate_idm_time_gap_and_standstill(law, &own, search, seed)?
        },
        idm_principal_directions: {
            let seed = seed(M::IdmPrincipalDirections);
            calibrate_idm_along(&directions, &own, search, seed)?
        },
        idm_floor: calibrate_idm(&[run.test()], search, seed(M::IdmFloor))?,
    })
}
