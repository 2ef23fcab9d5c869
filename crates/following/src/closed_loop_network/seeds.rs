//! The network on every driver's test rows, from several training seeds.

use super::{ClosedLoopNetwork, ClosedLoopSettings};
use crate::{FollowingError, FollowingRun, FollowingSettings, SimulationErrors, Stretch, simulate};
use maveric_domain::stream_seed;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// One training seed on every driver's test rows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClosedLoopSeed {
    /// The seed.
    pub seed: u64,
    /// With the driver's own embedding, fitted to the own fit rows; one entry a driver.
    pub own: Vec<SimulationErrors>,
    /// With the mean of the training embeddings.
    pub mean: Vec<SimulationErrors>,
}

/// The network in closed loop, trained from several seeds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClosedLoopStudy {
    /// How it was trained.
    pub settings: ClosedLoopSettings,
    /// The network of the first seed.
    pub network: ClosedLoopNetwork,
    /// The drivers' embeddings in it; shape `(drivers, d)`.
    pub embeddings: Vec<Vec<f64>>,
    /// Every seed, trained on all drivers' fit rows; never one chosen by these errors.
    pub seeds: Vec<ClosedLoopSeed>,
    /// The first seed again, each driver by a network that was trained on the other drivers alone.
    pub strangers: ClosedLoopSeed,
}

impl ClosedLoopSeed {
    /// Mean over drivers of the gap's RMSE with own and with mean embedding, in m.
    pub fn gap_rmse_m(&self) -> (f64, f64) {
        let mean = |of: &[SimulationErrors]| {
            of.iter().map(|e| e.gap_rmse_m).sum::<f64>() / of.len() as f64
        };
        (mean(&self.own), mean(&self.mean))
    }
}

/// Trains `count` networks (at least one) on the fit rows of `runs` from successive seeds, fits every driver's
/// embedding with frozen weights, and drives the test rows; and once more with each driver left out of the training.
///
/// # Errors
/// [`FollowingError::TooFewDrivers`] below two runs; those of [`ClosedLoopNetwork::train`].
pub fn study(
    runs: &[FollowingRun],
    settings: &ClosedLoopSettings,
    following: &FollowingSettings,
    count: usize,
) -> Result<ClosedLoopStudy, FollowingError> {
    following.check()?;
    if runs.len() < 2 {
        return Err(FollowingError::TooFewDrivers {
            found: runs.len(),
            expected: 2,
        });
    }
    let (first, safety) = (following.seed, following.safety);
    let root = |seed: u64| stream_seed(seed, &["closed_loop_network"]);
    let fits: Vec<Stretch<'_>> = runs.iter().map(FollowingRun::fit).collect();
    let trained: Vec<_> = (0..count.max(1) as u64)
        .into_par_iter()
        .map(|at| {
            let seed = first.wrapping_add(at);
            let found = ClosedLoopNetwork::train(&fits, settings, safety, root(seed))?;
            let network = found.network;
            let own: Vec<Vec<f64>> = fits
                .par_iter()
                .map(|fit| network.personalize(fit, settings))
                .collect();
            let errors = errors_of(runs, seed, |at| (&network, &own[at]))?;
            Ok((errors, network, own))
        })
        .collect::<Vec<Result<_, FollowingError>>>()
        .into_iter()
        .collect::<Result<_, _>>()?;
    let left_out: Vec<(ClosedLoopNetwork, Vec<f64>)> = (0..runs.len())
        .into_par_iter()
        .map(|driver| {
            let others: Vec<Stretch<'_>> = (0..runs.len())
                .filter(|&at| at != driver)
                .map(|at| runs[at].fit())
                .collect();
            let network = ClosedLoopNetwork::train(&others, settings, safety, root(first))?.network;
            let own = network.personalize(&fits[driver], settings);
            Ok((network, own))
        })
        .collect::<Vec<Result<_, FollowingError>>>()
        .into_iter()
        .collect::<Result<_, _>>()?;
    let strangers = errors_of(runs, first, |at| (&left_out[at].0, &left_out[at].1))?;
    let (network, embeddings) = (trained[0].1.clone(), trained[0].2.clone());
    Ok(ClosedLoopStudy {
        settings: *settings,
        network,
        embeddings,
        seeds: trained.into_iter().map(|(errors, ..)| errors).collect(),
        strangers,
    })
}

fn errors_of<'a>(
    runs: &[FollowingRun],
    seed: u64,
    of: impl Fn(usize) -> (&'a ClosedLoopNetwork, &'a Vec<f64>),
) -> Result<ClosedLoopSeed, FollowingError> {
    let (mut own, mut mean) = (Vec::new(), Vec::new());
    for (at, run) in runs.iter().enumerate() {
        let (network, w) = of(at);
        let test = run.test();
        let drive = |w: &[f64]| {
            let law = |g, v, lead| network.accel_mps2(w, g, v, lead);
            Ok(SimulationErrors::of(
                &test,
                &simulate(&test, "closed_loop", law)?,
            ))
        };
        own.push(drive(w)?);
        mean.push(drive(network.mean_embedding())?);
    }
    Ok(ClosedLoopSeed { seed, own, mean })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made_up;

    #[test]
    fn a_stranger_is_followed_better_with_the_own_embedding_than_with_the_others_mean() {
        let runs: Vec<FollowingRun> = [0.9, 1.3, 1.8, 2.4]
            .map(|t| made_up::driven_by_idm(&format!("T{t}"), made_up::DRIVER.with_time_gap_s(t)))
            .to_vec();
        let settings = ClosedLoopSettings {
            iterations: 100,
            ..ClosedLoopSettings::default()
        };
        let found = study(&runs, &settings, &FollowingSettings::default(), 2).unwrap();
        assert_eq!(found.seeds.len(), 2);
        assert_eq!(found.seeds[1].seed, found.seeds[0].seed + 1);
        for seed in found.seeds.iter().chain([&found.strangers]) {
            let (own, mean) = seed.gap_rmse_m();
            assert!(own < 0.7 * mean, "{own} {mean}");
            assert!(!seed.own.iter().chain(&seed.mean).any(|e| e.reached_zero));
        }
    }
}
