//! What a few parameters can do: the laws that stand beside a learned following distance.

use super::{
    calibrate::{Calibrated, calibrate_helly, calibrate_idm, calibrate_idm_time_gap},
    error::FollowingError,
    laws::{helly::Helly, idm::Idm, time_gap::ConstantTimeGap},
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
    /// Fitted to the others' fit rows; its gains also steer by F.
    pub helly_population: Calibrated<Helly>,
    /// Fitted to the own fit rows.
    pub idm_own: Calibrated<Idm>,
    /// Fitted to the others' fit rows.
    pub idm_population: Calibrated<Idm>,
    /// The same, its time gap fitted to the own fit rows.
    pub idm_population_own_time_gap: Calibrated<Idm>,
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
        // Collected before looking for an error, so that the first one is always the same one.
        let fitted: Vec<_> = (0..runs.len())
            .into_par_iter()
            .map(|driver| calibrate_driver(runs, driver, settings))
            .collect();
        let drivers = fitted.into_iter().collect::<Result<_, _>>()?;
        Ok(Self { drivers })
    }
}

fn calibrate_driver(
    runs: &[FollowingRun],
    driver: usize,
    settings: &FollowingSettings,
) -> Result<DriverBaselines, FollowingError> {
    let run = &runs[driver];
    let seed =
        |method: FollowingMethod| stream_seed(settings.seed, &[run.driver(), method.as_str()]);
    let search = &settings.search;
    let others: Vec<Stretch<'_>> = runs
        .iter()
        .enumerate()
        .filter(|(i, _)| *i != driver)
        .map(|(_, other)| other.fit())
        .collect();
    let time_gap_s = run.fit().mean_time_gap_s(settings.moving_above_mps)?;
    let idm_population = calibrate_idm(&others, search, seed(FollowingMethod::IdmPopulation))?;
    Ok(DriverBaselines {
        driver: run.driver().to_owned(),
        constant_time_gap_own: ConstantTimeGap::new(time_gap_s),
        helly_population: calibrate_helly(&others, search, seed(FollowingMethod::HellyPopulation))?,
        idm_own: calibrate_idm(&[run.fit()], search, seed(FollowingMethod::IdmOwn))?,
        idm_population,
        idm_population_own_time_gap: calibrate_idm_time_gap(
            idm_population.law,
            &[run.fit()],
            search,
            seed(FollowingMethod::IdmPopulationOwnTimeGap),
        )?,
        idm_floor: calibrate_idm(&[run.test()], search, seed(FollowingMethod::IdmFloor))?,
    })
}
