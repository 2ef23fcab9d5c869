//! Fitting a law to drives, by the gap of whole closed-loop runs.

use super::{
    closed_loop::gap_rmse_within,
    error::FollowingError,
    laws::{
        Parametric, gipps::Gipps, helly::Helly, idm::Idm, idm_directions::IdmDirections,
        newell::Newell,
    },
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

/// Fits time gap and gap at standstill of `population` to one or more stretches, all else as it is.
///
/// # Errors
/// [`FollowingError::TooFewDrivers`] without stretches.
pub fn calibrate_idm_time_gap_and_standstill(
    population: Idm,
    stretches: &[Stretch<'_>],
    search: &SearchSettings,
    seed: u64,
) -> Result<Calibrated<Idm>, FollowingError> {
    let law = |p: &[f64]| Idm {
        time_gap_s: p[0],
        standstill_gap_m: p[1],
        ..population
    };
    calibrate(stretches, search, seed, &Idm::BOUNDS[1..3], law)
}

/// Fits where a driver stands along other drivers' `directions`, to one or more stretches.
///
/// # Errors
/// [`FollowingError::TooFewDrivers`] without stretches.
pub fn calibrate_idm_along(
    directions: &IdmDirections,
    stretches: &[Stretch<'_>],
    search: &SearchSettings,
    seed: u64,
) -> Result<Calibrated<Idm>, FollowingError> {
    let law = |p: &[f64]| directions.law(p);
    calibrate(stretches, search, seed, &directions.bounds(), law)
}

/// Fits the six parameters of [`Gipps`] to one or more stretches, every stretch the same weight.
///
/// # Errors
/// [`FollowingError::TooFewDrivers`] without stretches.
pub fn calibrate_gipps(
    stretches: &[Stretch<'_>],
    search: &SearchSettings,
    seed: u64,
) -> Result<Calibrated<Gipps>, FollowingError> {
    let law = Gipps::from_parameters;
    calibrate::<Gipps>(stretches, search, seed, Gipps::BOUNDS, law)
}

/// Fits delay and distance of [`Newell`] to one or more stretches, every stretch the same weight.
///
/// # Errors
/// [`FollowingError::TooFewDrivers`] without stretches.
pub fn calibrate_newell(
    stretches: &[Stretch<'_>],
    search: &SearchSettings,
    seed: u64,
) -> Result<Calibrated<Newell>, FollowingError> {
    some(stretches)?;
    let law_of = |p: &[f64]| Newell {
        delay_s: p[0],
        distance_m: p[1],
    };
    let rmse = |at: usize, newell: Newell, limit: f64| {
        gap_rmse_within(&stretches[at], newell.law(&stretches[at]), limit)
    };
    Ok(search_law(
        Newell::BOUNDS,
        search,
        seed,
        law_of,
        stretches.len(),
        rmse,
    ))
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
    some(stretches)?;
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

fn some(stretches: &[Stretch<'_>]) -> Result<(), FollowingError> {
    if stretches.is_empty() {
        return Err(FollowingError::TooFewDrivers {
            found: 0,
            expected: 1,
        });
    }
    Ok(())
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
    if bounds.is_empty() {
        // Nothing to search: other drivers without a direction in which they differ.
        return Calibrated {
            law: law_of(&[]),
            fit_gap_rmse_m: cost(&[], f64::INFINITY),
        };
    }
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
    use crate::{
        made_up::{self, DRIVER, driven_by_idm},
        simulate,
    };

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
    fn newell_is_recovered_from_its_own_drive() {
        let newell = Newell {
            delay_s: 1.3,
            distance_m: 5.0,
        };
        let run = made_up::driven(|stretch| simulate(stretch, "newell", newell.law(stretch)));
        let found = calibrate_newell(&[run.fit()], &SearchSettings::default(), 1).unwrap();
        assert!(found.fit_gap_rmse_m < 0.05, "{found:?}");
        assert!((found.law.delay_s - 1.3).abs() < 0.02);
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
        let run = made_up::driven_by("P01", |g, v, l| gipps.accel_mps2(g, v, l));
        let found = calibrate_gipps(&[run.fit()], &SearchSettings::default(), 1).unwrap();
        assert!(found.fit_gap_rmse_m < 0.2, "{found:?}");
    }

    #[test]
    fn nothing_to_fit_to_is_an_error() {
        assert!(calibrate_helly(&[], &SearchSettings::default(), 1).is_err());
    }
}
