//! Networks of several training seeds on every driver's test rows.

use super::{ClosedLoopNetwork, ClosedLoopSettings};
use crate::{
    FollowingError, FollowingRun, FollowingSettings, SimulationErrors, Stretch,
    peers::{each, others, people, shrinkage_of},
    shrinkage::Shrinkage,
    simulate,
};
use maveric_domain::stream_seed;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// A network, and where the drivers who are judged stand in it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrainedFor {
    /// The network, of all who were learned from.
    pub network: ClosedLoopNetwork,
    /// Each driver's embedding, fitted to the own fit rows; shape `(drivers, d)`.
    pub own: Vec<Vec<f64>>,
    /// The same, shrunken towards the mean embedding.
    pub shrunken: Vec<Vec<f64>>,
    /// How much of an embedding to believe.
    pub shrinkage: Shrinkage,
}

/// One network on every driver's test rows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClosedLoopSeed {
    /// Seed of the training.
    pub seed: u64,
    /// With the driver's own embedding, fitted to the own fit rows; one entry a driver.
    pub own: Vec<SimulationErrors>,
    /// With the own embedding shrunken.
    pub shrunken: Vec<SimulationErrors>,
    /// With the mean of the training embeddings.
    pub mean: Vec<SimulationErrors>,
}

/// The network in closed loop, trained from several seeds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClosedLoopStudy {
    /// How it was trained.
    pub settings: ClosedLoopSettings,
    /// The networks; what drives asks for the mean of what they ask for.
    pub trained: Vec<TrainedFor>,
    /// Each alone; never one chosen by these errors.
    pub seeds: Vec<ClosedLoopSeed>,
    /// The first seed again, each driver by a network that was trained on the drives of other people alone; `None` where somebody who
    /// is judged was not learned from, as every seed is that for them, or where fewer than two other people are left.
    pub strangers: Option<ClosedLoopSeed>,
}

impl ClosedLoopSeed {
    /// Mean over drivers of the gap's RMSE with own, with shrunken and with mean embedding, in m.
    pub fn gap_rmse_m(&self) -> [f64; 3] {
        [&self.own, &self.shrunken, &self.mean]
            .map(|errors| errors.iter().map(|e| e.gap_rmse_m).sum::<f64>() / errors.len() as f64)
    }
}

/// Trains a network on the fit rows of `learned` and fits the embedding of each of `judged` with frozen weights; shrinks it by
/// how far those embeddings move between the halves of their fit rows.
fn train_for(
    judged: &[FollowingRun],
    learned: &[FollowingRun],
    settings: &FollowingSettings,
    seed: u64,
) -> Result<TrainedFor, FollowingError> {
    let how = &settings.closed_loop;
    let fits: Vec<Stretch<'_>> = learned.iter().map(FollowingRun::fit).collect();
    let root = stream_seed(seed, &["closed_loop_network"]);
    let network = ClosedLoopNetwork::train(&fits, how, settings.safety, root)?.network;
    let fit = |stretch: &Stretch<'_>| network.personalize(stretch, how);
    let halves: Vec<[Vec<f64>; 2]> = fits
        .par_iter()
        .map(|f| f.halves().map(|h| fit(&h)))
        .collect();
    let embeddings: Vec<Vec<f64>> = judged.par_iter().map(|run| fit(&run.fit())).collect();
    let shrinkage = shrinkage_of(learned, &halves)?;
    let mean = network.mean_embedding();
    let shrunken = judged
        .iter()
        .zip(&embeddings)
        .map(|(run, own)| shrinkage.shrink(own, mean, run.fit().seconds()))
        .collect();
    Ok(TrainedFor {
        network,
        own: embeddings,
        shrunken,
        shrinkage,
    })
}

/// [`train_for`] from successive seeds.
pub(crate) fn train_all(
    judged: &[FollowingRun],
    learned: &[FollowingRun],
    settings: &FollowingSettings,
) -> Result<Vec<TrainedFor>, FollowingError> {
    let trained: Vec<_> = (0..settings.closed_loop_seeds as u64)
        .into_par_iter()
        .map(|offset| {
            train_for(
                judged,
                learned,
                settings,
                settings.seed.wrapping_add(offset),
            )
        })
        .collect();
    trained.into_iter().collect()
}

/// Trains networks on the fit rows of `learned` from successive seeds and drives the test rows of `judged`; and once more with
/// each driver who was learned from left out of the training.
///
/// # Errors
/// Those of [`ClosedLoopNetwork::train`]; what a simulation fails with.
pub(crate) fn study(
    judged: &[FollowingRun],
    learned: &[FollowingRun],
    settings: &FollowingSettings,
) -> Result<ClosedLoopStudy, FollowingError> {
    let trained = train_all(judged, learned, settings)?;
    let seeds = (settings.seed..).zip(&trained);
    let seeds = seeds
        .map(|(seed, trained)| errors_of(judged, seed, |index| (trained, index)))
        .collect::<Result<_, _>>()?;
    let first = settings.seed;
    let all = people(learned);
    let can_be_left_out = |run: &FollowingRun| all.contains(&run.person()) && all.len() > 2;
    let strangers = if judged.iter().all(can_be_left_out) {
        let left_out = each(judged, |run| {
            let from: Vec<FollowingRun> =
                others(learned, run.person()).into_iter().cloned().collect();
            train_for(std::slice::from_ref(run), &from, settings, first)
        })?;
        Some(errors_of(judged, first, |index| (&left_out[index], 0))?)
    } else {
        None
    };
    Ok(ClosedLoopStudy {
        settings: settings.closed_loop,
        trained,
        seeds,
        strangers,
    })
}

fn errors_of<'a>(
    runs: &[FollowingRun],
    seed: u64,
    network_of: impl Fn(usize) -> (&'a TrainedFor, usize),
) -> Result<ClosedLoopSeed, FollowingError> {
    let errors = |embedding: fn(&TrainedFor, usize) -> &[f64]| {
        let one = |(index, run): (usize, &FollowingRun)| {
            let (trained, index) = network_of(index);
            let (test, w) = (run.test(), embedding(trained, index));
            let driven = simulate(&test, "closed_loop", trained.network.driving(w))?;
            Ok(SimulationErrors::between(&test, &driven))
        };
        runs.iter()
            .enumerate()
            .map(one)
            .collect::<Result<_, FollowingError>>()
    };
    Ok(ClosedLoopSeed {
        seed,
        own: errors(|t, index| &t.own[index])?,
        shrunken: errors(|t, index| &t.shrunken[index])?,
        mean: errors(|t, _| t.network.mean_embedding())?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    fn runs() -> Vec<FollowingRun> {
        [0.9, 1.3, 1.8, 2.4]
            .map(|t| testing::driven_by_idm(&format!("T{t}"), testing::DRIVER.with_time_gap_s(t)))
            .to_vec()
    }

    fn settings(seeds: usize) -> FollowingSettings {
        FollowingSettings {
            closed_loop_seeds: seeds,
            closed_loop: ClosedLoopSettings {
                iterations: 100,
                ..ClosedLoopSettings::default()
            },
            ..FollowingSettings::default()
        }
    }

    #[test]
    fn a_stranger_is_followed_better_with_the_own_embedding_than_with_the_others_mean() {
        let runs = runs();
        let found = study(&runs, &runs, &settings(2)).unwrap();
        assert_eq!(found.seeds.len(), 2);
        assert_eq!(found.seeds[1].seed, found.seeds[0].seed + 1);
        assert_eq!(found.strangers.as_ref().unwrap().own.len(), runs.len());
        for seed in found.seeds.iter().chain(&found.strangers) {
            let [own, shrunken, mean] = seed.gap_rmse_m();
            assert!(
                own < 0.7 * mean && shrunken < 0.8 * mean,
                "{own} {shrunken} {mean}"
            );
            let all = seed.own.iter().chain(&seed.shrunken).chain(&seed.mean);
            assert!(!all.into_iter().any(|e| e.reached_zero));
        }
        // These people never change.
        for trained in &found.trained {
            assert!(trained.shrinkage.share(100.0) > 0.9, "{trained:?}");
        }
    }

    #[test]
    fn a_stranger_to_a_network_is_one_of_whom_it_has_learned_from_no_drive() {
        let mut runs = runs();
        runs[1] = runs[1].clone().of_person("T0.9");
        let found = study(&runs, &runs, &settings(1)).unwrap();
        let alone = study(&runs[..1], &runs[2..], &settings(1)).unwrap();
        let strangers = found.strangers.unwrap();
        assert_eq!(strangers.own[0], alone.seeds[0].own[0]);
        assert_eq!(strangers.mean[0], alone.seeds[0].mean[0]);
        let few = study(&runs[..3], &runs[..3], &settings(1)).unwrap();
        assert_eq!(few.strangers, None, "one drive is left without the two");
        runs[3] = runs[3].clone().of_person("T1.8");
        let two = study(&runs, &runs, &settings(1)).unwrap();
        assert_eq!(two.strangers, None, "one person is left without the other");
    }

    #[test]
    fn those_who_were_not_learned_from_are_strangers_to_every_seed() {
        let runs = runs();
        let found = study(&runs[..1], &runs[1..], &settings(1)).unwrap();
        assert_eq!(found.strangers, None);
        assert_eq!(found.seeds[0].own.len(), 1);
    }
}
