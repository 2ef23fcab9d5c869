//! Fitting a law to drives, by the gap of whole closed-loop runs.

use super::{
    closed_loop::gap_rmse_within,
    error::FollowingError,
    laws::{Parametric, helly::Helly, idm::Idm},
    optimise::{Minimum, differential_evolution, nelder_mead},
    run::Stretch,
};
use serde::{Deserialize, Serialize};

/// How thoroughly to search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct SearchSettings {
    /// Members of the differential evolution for each parameter of the law.
    pub members_per_parameter: usize,
    /// Its generations at most.
    pub generations: usize,
    /// Moves of the simplex afterwards, at most.
    pub simplex_steps: usize,
}

impl Default for SearchSettings {
    fn default() -> Self {
        Self {
            members_per_parameter: 12,
            generations: 200,
            simplex_steps: 300,
        }
    }
}

/// A law and how well it fits what it was fitted to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Calibrated<L> {
    /// The law.
    pub law: L,
    /// Its closed-loop RMSE of the gap there, mean over the stretches, in m.
    pub fit_gap_rmse_m: f64,
}

/// Fits the five parameters of [`Idm`] to one or more stretches, every stretch the same weight.
///
/// v0 20-50 m/s, T 0.1-4 s, s0 0.1-10 m, a 0.1-4 and b 0.1-6 m/s². Same seed, same result.
///
/// # Errors
/// [`FollowingError::TooFewDrivers`] without stretches.
///
/// # Source
/// Differential evolution on the closed-loop RMSE of the gap, then Nelder-Mead.
pub fn calibrate_idm(
    stretches: &[Stretch<'_>],
    search: &SearchSettings,
    seed: u64,
) -> Result<Calibrated<Idm>, FollowingError> {
    calibrate::<Idm>(stretches, search, seed, Idm::BOUNDS, Idm::from_parameters)
}

/// Fits the time gap of `population` to one or more stretches, all else as it is; 0.1-4 s.
///
/// # Errors
/// [`FollowingError::TooFewDrivers`] without stretches.
pub fn calibrate_idm_time_gap(
    population: Idm,
    stretches: &[Stretch<'_>],
    search: &SearchSettings,
    seed: u64,
) -> Result<Calibrated<Idm>, FollowingError> {
    let law = |p: &[f64]| population.with_time_gap_s(p[0]);
    calibrate(stretches, search, seed, &Idm::BOUNDS[1..2], law)
}

/// Fits the four parameters of [`Helly`] to one or more stretches, every stretch the same weight.
///
/// # Errors
/// [`FollowingError::TooFewDrivers`] without stretches.
pub fn calibrate_helly(
    stretches: &[Stretch<'_>],
    search: &SearchSettings,
    seed: u64,
) -> Result<Calibrated<Helly>, FollowingError> {
    calibrate(
        stretches,
        search,
        seed,
        Helly::BOUNDS,
        Helly::from_parameters,
    )
}

fn calibrate<L: Parametric>(
    stretches: &[Stretch<'_>],
    search: &SearchSettings,
    seed: u64,
    bounds: &[(f64, f64)],
    law_of: impl Fn(&[f64]) -> L,
) -> Result<Calibrated<L>, FollowingError> {
    if stretches.is_empty() {
        return Err(FollowingError::TooFewDrivers {
            found: 0,
            expected: 1,
        });
    }
    let rmse = |at: usize, law: L, limit: f64| {
        let accel = |gap, ego, lead| law.accel_mps2(gap, ego, lead);
        gap_rmse_within(&stretches[at], accel, limit)
    };
    Ok(search_law(
        bounds,
        search,
        seed,
        law_of,
        stretches.len(),
        rmse,
    ))
}

/// Searches the law with the lowest mean over `count` stretches of `rmse`, which gives `None` above a limit.
pub(super) fn search_law<L: Copy>(
    bounds: &[(f64, f64)],
    search: &SearchSettings,
    seed: u64,
    law_of: impl Fn(&[f64]) -> L,
    count: usize,
    rmse: impl Fn(usize, L, f64) -> Option<f64>,
) -> Calibrated<L> {
    let cost = |parameters: &[f64], limit: f64| {
        let law = law_of(parameters);
        let most = limit * count as f64;
        let mut sum = 0.0;
        for at in 0..count {
            match rmse(at, law, most - sum) {
                Some(found) => sum += found,
                None => return f64::INFINITY,
            }
        }
        sum / count as f64
    };
    let members = search.members_per_parameter * bounds.len();
    let found = differential_evolution::minimise(bounds, members, search.generations, seed, cost);
    let Minimum { point, cost } = nelder_mead::polish(bounds, found, search.simplex_steps, cost);
    Calibrated {
        law: law_of(&point),
        fit_gap_rmse_m: cost,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::following::made_up::{DRIVER, driven_by_idm};

    #[test]
    fn idm_is_recovered_from_its_own_drive() {
        let run = driven_by_idm("P01", DRIVER);
        let found = calibrate_idm(&[run.fit()], &SearchSettings::default(), 1).unwrap();
        assert!(found.fit_gap_rmse_m < 0.05, "{found:?}");
        assert!((found.law.time_gap_s - DRIVER.time_gap_s).abs() < 0.02);
        assert!((found.law.standstill_gap_m - DRIVER.standstill_gap_m).abs() < 0.2);
        assert!((found.law.max_accel_mps2 - DRIVER.max_accel_mps2).abs() < 0.1);
    }

    #[test]
    fn the_own_time_gap_is_recovered_with_all_else_known() {
        let run = driven_by_idm("P01", DRIVER);
        let population = DRIVER.with_time_gap_s(2.6);
        let search = SearchSettings::default();
        let found = calibrate_idm_time_gap(population, &[run.fit()], &search, 1).unwrap();
        assert!((found.law.time_gap_s - DRIVER.time_gap_s).abs() < 1e-3);
    }

    #[test]
    fn nothing_to_fit_to_is_an_error() {
        assert!(calibrate_helly(&[], &SearchSettings::default(), 1).is_err());
    }
}
