//! Training through the simulated following, and fitting an embedding with frozen weights.

use super::{
    ClosedLoopNetwork, ClosedLoopSettings, TrainedClosedLoop,
    controller::Scaling,
    layers::Gradient,
    layout::Layout,
    segments::{batches, one_after_the_other, recorded, segment_steps},
    unrolled::{Room, gradient},
    world::{Batch, World},
};
use crate::{FollowingError, Stretch};
use maveric_laws::Rss;
use maveric_model::cosine;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use rayon::prelude::*;
use std::cell::Cell;

/// Longest gradient that a step of the optimiser follows.
const CLIP: f64 = 1.0;

pub(super) fn train(
    drivers: &[Stretch<'_>],
    settings: &ClosedLoopSettings,
    safety: Rss,
    seed: u64,
) -> Result<TrainedClosedLoop, FollowingError> {
    settings.check()?;
    let Some(first) = drivers.first() else {
        return Err(FollowingError::TooFewDrivers {
            found: 0,
            expected: 1,
        });
    };
    let rate_hz = first.run.rate_hz();
    if let Some(other) = drivers
        .iter()
        .find(|s| (s.run.rate_hz() - rate_hz).abs() > 1e-9 * rate_hz)
    {
        return Err(FollowingError::RatesDiffer {
            driver: other.run.driver().to_owned(),
            found_hz: other.run.rate_hz(),
            expected_hz: rate_hz,
        });
    }
    let layout = Layout {
        embedding: settings.embedding_size,
        hidden: settings.hidden_units,
    };
    let world = World {
        layout,
        scaling: scaling(drivers),
        safety,
        step_s: 1.0 / rate_hz,
        gap_weight: 1.0 / gap_variance_m2(drivers),
        speed_weight: settings.speed_weight,
    };
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut weights = layout.draw(&mut rng);
    let d = layout.embedding;
    let mut embeddings: Vec<f64> = (0..drivers.len() * d)
        .map(|_| 0.1 * rng.sample::<f64, _>(StandardNormal))
        .collect();
    let steps = segment_steps(drivers, settings);
    // Driven in single precision; where the optimiser stands is kept in double.
    let driven = world.reckoned_in::<f32>();
    let rows: Vec<_> = drivers.iter().map(recorded::<f32>).collect();
    let (mut of_weights, mut of_embeddings) =
        (Adam::new(weights.len()), Adam::new(embeddings.len()));
    let mut losses = Vec::with_capacity(settings.iterations);
    for iteration in 0..settings.iterations {
        let phase = rng.random_range(0..steps);
        let segments = one_after_the_other(drivers, steps, phase);
        let batches = batches(&rows, &segments, steps);
        let mut gradient = loss(&driven, &weights, &embeddings, &batches);
        losses.push(gradient.loss);
        shrink(&mut gradient.weights, &weights, settings.weight_decay);
        for (driver, stretch) in drivers.iter().enumerate() {
            let range = driver * d..(driver + 1) * d;
            let by = prior(stretch, settings) / drivers.len() as f64;
            shrink(
                &mut gradient.embeddings[range.clone()],
                &embeddings[range],
                by,
            );
        }
        let length = libm::hypot(norm(&gradient.weights), norm(&gradient.embeddings));
        let scale = if length > CLIP { CLIP / length } else { 1.0 };
        let rate = cosine(iteration, settings.iterations);
        of_weights.step(
            &mut weights,
            &gradient.weights,
            scale,
            settings.learning_rate * rate,
        );
        of_embeddings.step(
            &mut embeddings,
            &gradient.embeddings,
            scale,
            settings.embedding_rate * rate,
        );
    }
    let embeddings: Vec<Vec<f64>> = embeddings.chunks_exact(d).map(<[f64]>::to_vec).collect();
    let mean = |k: usize| embeddings.iter().map(|w| w[k]).sum::<f64>() / embeddings.len() as f64;
    let mean_embedding = (0..d).map(mean).collect();
    Ok(TrainedClosedLoop {
        network: ClosedLoopNetwork {
            world,
            weights,
            mean_embedding,
        },
        embeddings,
        losses,
    })
}

/// Strength of the prior beside a mean over this driver's rows.
pub(super) fn prior(driver: &Stretch<'_>, settings: &ClosedLoopSettings) -> f64 {
    settings.embedding_prior * driver.run.rate_hz() / driver.rows.len() as f64
}

thread_local! {
    static ROOM: Cell<Room<f32>> = Cell::default();
}

fn loss(
    world: &World<f32>,
    weights: &[f64],
    embeddings: &[f64],
    batches: &[Batch<f32>],
) -> Gradient {
    let narrow = |numbers: &[f64]| -> Vec<f32> { numbers.iter().map(|x| *x as f32).collect() };
    let (narrow_weights, narrow_embeddings) = (narrow(weights), narrow(embeddings));
    let parts: Vec<Gradient> = batches
        .par_iter()
        .map(|batch| {
            let mut room = ROOM.take();
            let part = gradient(world, &narrow_weights, &narrow_embeddings, batch, &mut room);
            ROOM.set(room);
            part
        })
        .collect();
    // In the batches' order, whichever was ready first.
    let mut sum = Gradient::zero(weights.len(), embeddings.len());
    for part in &parts {
        sum.add(part);
    }
    sum
}

fn shrink(gradient: &mut [f64], values: &[f64], by: f64) {
    for (gradient, value) in gradient.iter_mut().zip(values) {
        *gradient += by * value;
    }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn scaling(drivers: &[Stretch<'_>]) -> Scaling {
    let (speed_mean_mps, variance) =
        mean_and_variance(drivers, |s, row| s.run.columns().ego_speed_mps[row]);
    Scaling {
        speed_mean_mps,
        speed_sd_mps: variance.sqrt().max(0.1),
    }
}

fn gap_variance_m2(drivers: &[Stretch<'_>]) -> f64 {
    mean_and_variance(drivers, |s, row| s.run.columns().gap_m[row])
        .1
        .max(1.0)
}

fn mean_and_variance(
    drivers: &[Stretch<'_>],
    value: impl Fn(&Stretch<'_>, usize) -> f64,
) -> (f64, f64) {
    let values = || {
        drivers
            .iter()
            .flat_map(|s| s.rows.clone().map(|row| value(s, row)))
    };
    let count = values().count() as f64;
    let mean = values().sum::<f64>() / count;
    (
        mean,
        values().map(|x| (x - mean).powi(2)).sum::<f64>() / count,
    )
}

/// Adam (Kingma and Ba 2015), in double precision: the way back through hundreds of steps loses digits.
struct Adam {
    first: Vec<f64>,
    second: Vec<f64>,
    steps: i32,
}

impl Adam {
    fn new(size: usize) -> Self {
        Self {
            first: vec![0.0; size],
            second: vec![0.0; size],
            steps: 0,
        }
    }

    fn step(&mut self, values: &mut [f64], gradient: &[f64], scale: f64, rate: f64) {
        self.steps += 1;
        let (c1, c2) = (
            1.0 - 0.9_f64.powi(self.steps),
            1.0 - 0.999_f64.powi(self.steps),
        );
        let moments = self.first.iter_mut().zip(&mut self.second);
        for ((value, g), (first, second)) in values.iter_mut().zip(gradient).zip(moments) {
            let g = g * scale;
            *first = 0.9 * *first + 0.1 * g;
            *second = 0.999 * *second + 0.001 * g * g;
            *value -= rate * (*first / c1) / ((*second / c2).sqrt() + 1e-8);
        }
    }
}
