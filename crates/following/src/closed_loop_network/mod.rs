//! A network that gives a controller its parameters, trained through its own simulated following.
//!
//! From an embedding and ego's speed it gives a time gap and a gap at standstill (together the following distance),
//! an acceleration and a sensitivity to closing in; a controller under the safety bound drives by them. The error of
//! the simulated gap goes back through half a minute of driving to the weights and embeddings: unlike a network
//! fitted one step ahead it learns from what its own errors lead to.

mod alone;
mod controller;
mod lanes;
mod layers;
mod layout;
mod personalizing;
mod segments;
mod settings;
mod study;
mod training;
mod unrolled;
mod world;

pub use settings::ClosedLoopSettings;
pub(crate) use settings::check;
pub use study::{ClosedLoopSeed, ClosedLoopStudy, TrainedFor};
pub(crate) use study::{study, train_all};

use crate::{FollowingError, Stretch};
use alone::Alone;
use maveric_laws::Rss;
use serde::{Deserialize, Serialize};
use world::World;

/// A trained network; its weights are frozen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClosedLoopNetwork {
    world: World,
    weights: Vec<f64>,
    mean_embedding: Vec<f64>,
}

/// What a training gives.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrainedClosedLoop {
    /// The trained network, with the mean of `embeddings`.
    pub network: ClosedLoopNetwork,
    /// The embedding trained with it for each driver; shape `(drivers, d)`.
    pub embeddings: Vec<Vec<f64>>,
    /// Loss of each step of the optimiser: 1 is an error of one standard deviation of the recorded gap.
    pub losses: Vec<f64>,
}

impl ClosedLoopNetwork {
    /// Learns weights, and an embedding for each of `drivers`, every driver the same weight.
    ///
    /// Same seed, same bytes, whatever the number of threads.
    ///
    /// # Errors
    /// [`FollowingError::TooFewDrivers`] without drivers, [`FollowingError::RatesDiffer`], [`FollowingError::BadSetting`].
    ///
    /// # Source
    /// Ours; the idea is the paper's, networks that give parameters to controllers and never a pedal. The controller
    /// is the interaction term of the Intelligent Driver Model, held below a safety bound.
    ///
    /// # Example
    /// ```
    /// # use maveric_following::{FollowingColumns, FollowingRun, SAFETY};
    /// use maveric_following::closed_loop_network::{ClosedLoopNetwork, ClosedLoopSettings};
    /// # let n = 90;
    /// # let columns = FollowingColumns {
    /// #     time_s: (0..n).map(|i| f64::from(i) / 10.0).collect(), leader_x_m: (0..n).map(f64::from).collect(),
    /// #     lead_speed_mps: vec![10.0; 90], ego_speed_mps: vec![10.0; 90], gap_m: vec![20.0; 90],
    /// # };
    /// # let run = FollowingRun::new("P01", 10.0, columns)?;
    /// let settings = ClosedLoopSettings { iterations: 20, ..ClosedLoopSettings::default() };
    /// let trained = ClosedLoopNetwork::train(&[run.fit()], &settings, SAFETY, 1)?;
    /// let w = trained.network.personalize(&run.fit(), &settings);
    /// let accel_mps2 = trained.network.accel_mps2(&w, 20.0, 10.0, 10.0);
    /// assert!(accel_mps2.abs() < 4.0);
    /// # Ok::<(), maveric_following::FollowingError>(())
    /// ```
    pub fn train(
        drivers: &[Stretch<'_>],
        settings: &ClosedLoopSettings,
        safety: Rss,
        seed: u64,
    ) -> Result<TrainedClosedLoop, FollowingError> {
        training::train(drivers, settings, safety, seed)
    }

    /// Numbers in an embedding, d.
    pub fn embedding_size(&self) -> usize {
        self.mean_embedding.len()
    }

    /// Mean of the training embeddings.
    pub fn mean_embedding(&self) -> &[f64] {
        &self.mean_embedding
    }

    /// Fits an embedding to one driver's rows with all weights frozen, from the mean, by the loss of the training.
    pub fn personalize(&self, driver: &Stretch<'_>, settings: &ClosedLoopSettings) -> Vec<f64> {
        personalizing::personalize(self, driver, settings)
    }

    /// The following distance that this driver keeps at a speed (m/s), in m.
    ///
    /// # Panics
    /// If the embedding is not of the network's size.
    pub fn following_distance_m(&self, embedding: &[f64], ego_speed_mps: f64) -> f64 {
        Alone::new(&self.world, &self.weights, embedding)
            .parameters(ego_speed_mps)
            .following_distance_m(ego_speed_mps)
    }

    /// Acceleration, in m/s², from gap (m), ego speed and lead speed (m/s).
    ///
    /// # Panics
    /// If the embedding is not of the network's size.
    pub fn accel_mps2(
        &self,
        embedding: &[f64],
        gap_m: f64,
        ego_speed_mps: f64,
        lead_speed_mps: f64,
    ) -> f64 {
        self.driving(embedding)(gap_m, ego_speed_mps, lead_speed_mps)
    }

    /// [`ClosedLoopNetwork::accel_mps2`] of one embedding, for who asks many times.
    ///
    /// # Panics
    /// If the embedding is not of the network's size.
    pub fn driving<'a>(&'a self, embedding: &[f64]) -> impl FnMut(f64, f64, f64) -> f64 + use<'a> {
        let mut alone = Alone::new(&self.world, &self.weights, embedding);
        move |gap_m, ego_mps, lead_mps| alone.accel_mps2(gap_m, ego_mps, lead_mps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FollowingRun, SAFETY, SimulationErrors, simulate, testing};

    const QUICK: ClosedLoopSettings = ClosedLoopSettings {
        iterations: 120,
        ..ClosedLoopSettings::DEFAULT
    };

    fn drivers() -> Vec<FollowingRun> {
        [1.0, 1.5, 2.2]
            .map(|t| testing::driven_by_idm(&format!("T{t}"), testing::DRIVER.with_time_gap_s(t)))
            .to_vec()
    }

    fn train(runs: &[FollowingRun], seed: u64) -> TrainedClosedLoop {
        let fits: Vec<_> = runs.iter().map(FollowingRun::fit).collect();
        ClosedLoopNetwork::train(&fits, &QUICK, SAFETY, seed).unwrap()
    }

    fn gap_rmse_m(network: &ClosedLoopNetwork, run: &FollowingRun, w: &[f64]) -> f64 {
        let test = run.test();
        let law = |g, v, lead| network.accel_mps2(w, g, v, lead);
        SimulationErrors::between(&test, &simulate(&test, "network", law).unwrap()).gap_rmse_m
    }

    #[test]
    fn a_fitted_embedding_follows_its_driver_better_than_the_mean() {
        let runs = drivers();
        let trained = train(&runs, 1);
        let network = &trained.network;
        assert!(trained.losses[119] < 0.5 * trained.losses[0]);
        let mean = |of: &dyn Fn(&FollowingRun) -> f64| runs.iter().map(of).sum::<f64>() / 3.0;
        let own = mean(&|run| gap_rmse_m(network, run, &network.personalize(&run.fit(), &QUICK)));
        let not_own = mean(&|run| gap_rmse_m(network, run, network.mean_embedding()));
        assert!(own < 0.7 * not_own, "{own} {not_own}");
        let distance = |run: &FollowingRun| {
            network.following_distance_m(&network.personalize(&run.fit(), &QUICK), 15.0)
        };
        assert!(distance(&runs[0]) < distance(&runs[1]) && distance(&runs[1]) < distance(&runs[2]));
    }

    #[test]
    fn the_same_seed_gives_the_same_bytes_with_one_thread_and_with_several() {
        let runs = drivers();
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().unwrap().install(|| train(&runs, 7))
        };
        let one = with(1);
        assert_eq!(one, with(3));
        assert_ne!(one.network, train(&runs, 8).network);
        let text = serde_json::to_string(&one).unwrap();
        assert_eq!(one, serde_json::from_str(&text).unwrap());
    }

    #[test]
    fn the_safety_bound_holds_whatever_was_learned() {
        // Trained on drivers who keep next to nothing; then the leader stops as hard as it can.
        let tight = testing::behind("P01", 600, 0.4, 10.0, |_| 10.0);
        let network = train(&[tight], 1).network;
        let stop = |t: f64| (20.0 - 8.0 * (t - 30.0).max(0.0)).max(0.0);
        let run = testing::behind("P02", 600, 40.0, 20.0, stop);
        let w = network.mean_embedding();
        let law = |g, v, lead| network.accel_mps2(w, g, v, lead);
        let driven = simulate(&run.fit(), "network", law).unwrap();
        let least = driven.gap_m.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(least > 1.0, "{least}");
    }

    #[test]
    fn test_rows_are_not_read() {
        let runs = drivers();
        let before = train(&runs, 1);
        let changed: Vec<FollowingRun> = runs
            .iter()
            .map(|run| {
                let mut columns = run.columns().clone();
                columns.gap_m[run.test_start()..].fill(50.0);
                FollowingRun::new(run.driver(), run.rate_hz(), columns).unwrap()
            })
            .collect();
        assert_eq!(before, train(&changed, 1));
    }

    #[test]
    fn what_cannot_be_trained_is_refused() {
        let safety = SAFETY;
        let none = ClosedLoopNetwork::train(&[], &QUICK, safety, 1);
        assert!(matches!(none, Err(FollowingError::TooFewDrivers { .. })));
        let runs = drivers();
        let other = FollowingRun::new("slow", 20.0, {
            let mut columns = runs[0].columns().clone();
            for t in &mut columns.time_s {
                *t /= 2.0;
            }
            columns
        })
        .unwrap();
        let mixed = ClosedLoopNetwork::train(&[runs[0].fit(), other.fit()], &QUICK, safety, 1);
        assert!(matches!(mixed, Err(FollowingError::RatesDiffer { .. })));
        let bad = ClosedLoopSettings {
            hidden_units: 0,
            ..QUICK
        };
        let refused = ClosedLoopNetwork::train(&[runs[0].fit()], &bad, safety, 1);
        assert!(matches!(
            refused,
            Err(FollowingError::BadSetting {
                name: "hidden_units",
                ..
            })
        ));
    }
}
