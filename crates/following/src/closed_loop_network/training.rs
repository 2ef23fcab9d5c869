//! Training through the simulated following, and fitting an embedding with frozen weights.

use super::{
    ClosedLoopNetwork, ClosedLoopSettings, TrainedClosedLoop,
    controller::Scaling,
    layout::Layout,
    unrolled::{Batch, Gradient, LANES, World, gradient},
};
use crate::{FollowingColumns, FollowingError, Stretch};
use maveric_laws::Rss;
use maveric_model::{
    bfgs::{Evaluated, minimise},
    cosine,
};
use nalgebra::DVector;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use rayon::prelude::*;

/// Longest gradient that a step of the optimiser follows.
const CLIP: f64 = 1.0;
/// Segments over each row when an embedding is fitted: with each row in one only, the fit hangs on where they begin.
const OVERLAP: usize = 5;
/// Steps of BFGS at most; it takes about twenty.
const MOST_ITERATIONS: usize = 60;

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
    let (mut of_weights, mut of_embeddings) =
        (Adam::new(weights.len()), Adam::new(embeddings.len()));
    let mut losses = Vec::with_capacity(settings.iterations);
    for iteration in 0..settings.iterations {
        let phase = rng.random_range(0..steps);
        let mut found = loss(
            &world,
            &weights,
            &embeddings,
            &batches(drivers, steps, Some(phase)),
        );
        losses.push(found.loss);
        shrink(&mut found.weights, &weights, settings.weight_decay);
        for (driver, stretch) in drivers.iter().enumerate() {
            let own = driver * d..(driver + 1) * d;
            let by = prior(stretch, settings) / drivers.len() as f64;
            shrink(&mut found.embeddings[own.clone()], &embeddings[own], by);
        }
        let length = libm::hypot(norm(&found.weights), norm(&found.embeddings));
        let scale = if length > CLIP { CLIP / length } else { 1.0 };
        let rate = cosine(iteration, settings.iterations);
        of_weights.step(
            &mut weights,
            &found.weights,
            scale,
            settings.learning_rate * rate,
        );
        of_embeddings.step(
            &mut embeddings,
            &found.embeddings,
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

/// Fits an embedding to a driver's rows from the mean, by the same loss, weights frozen.
pub(super) fn personalize(
    network: &ClosedLoopNetwork,
    driver: &Stretch<'_>,
    settings: &ClosedLoopSettings,
) -> Vec<f64> {
    let alone = std::slice::from_ref(driver);
    let batches = batches(alone, segment_steps(alone, settings), None);
    let prior = prior(driver, settings);
    let value = |w: &DVector<f64>| {
        let w = w.as_slice();
        let mut found = loss(&network.world, &network.weights, w, &batches);
        let away: Vec<f64> = w
            .iter()
            .zip(&network.mean_embedding)
            .map(|(w, m)| w - m)
            .collect();
        found.loss += 0.5 * prior * away.iter().map(|a| a * a).sum::<f64>();
        shrink(&mut found.embeddings, &away, prior);
        Evaluated {
            value: found.loss,
            gradient: DVector::from_vec(found.embeddings),
        }
    };
    let start = DVector::from_column_slice(&network.mean_embedding);
    minimise(value, start, MOST_ITERATIONS).as_slice().to_vec()
}

/// Strength of the prior beside a mean over this driver's rows.
fn prior(driver: &Stretch<'_>, settings: &ClosedLoopSettings) -> f64 {
    settings.embedding_prior * driver.run.rate_hz() / driver.rows.len() as f64
}

fn loss(world: &World, weights: &[f64], embeddings: &[f64], batches: &[Batch]) -> Gradient {
    let parts: Vec<Gradient> = batches
        .par_iter()
        .map(|batch| gradient(world, weights, embeddings, batch))
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

fn segment_steps(drivers: &[Stretch<'_>], settings: &ClosedLoopSettings) -> usize {
    let rate_hz = drivers[0].run.rate_hz();
    let shortest = drivers.iter().map(|s| s.rows.len() - 1).min().unwrap_or(1);
    ((settings.segment_s * rate_hz).round() as usize).clamp(1, shortest)
}

/// Cuts each driver's rows into segments of `steps` steps: one after the other from `phase` on, or overlapping.
fn batches(drivers: &[Stretch<'_>], steps: usize, phase: Option<usize>) -> Vec<Batch> {
    let mut segments: Vec<(usize, usize, f64)> = Vec::new();
    for (driver, stretch) in drivers.iter().enumerate() {
        let all = stretch.rows.len() - 1;
        let starts: Vec<usize> = if let Some(phase) = phase {
            let phase = phase.min(all - steps);
            (0..(all - phase) / steps)
                .map(|i| phase + i * steps)
                .collect()
        } else {
            let between = (steps / OVERLAP).max(1);
            let count = 1 + (all - steps).div_ceil(between);
            (0..count).map(|i| (i * between).min(all - steps)).collect()
        };
        let weight = 1.0 / (drivers.len() * starts.len()) as f64;
        segments.extend(
            starts
                .iter()
                .map(|s| (driver, stretch.rows.start + s, weight)),
        );
    }
    segments
        .chunks(LANES)
        .map(|some| batch(drivers, some, steps))
        .collect()
}

fn batch(drivers: &[Stretch<'_>], segments: &[(usize, usize, f64)], steps: usize) -> Batch {
    // A lane without a segment repeats the first one, without weight.
    let lane = |l: usize| {
        segments
            .get(l)
            .copied()
            .unwrap_or((segments[0].0, segments[0].1, 0.0))
    };
    // Lane by lane: each reads its rows one after the other.
    let rows = |column: fn(&FollowingColumns) -> &Vec<f64>, of: fn(&[f64], usize) -> f64| {
        let mut rows = vec![[0.0; LANES]; steps + 1];
        for l in 0..LANES {
            let (driver, start, _) = lane(l);
            let values = column(drivers[driver].run.columns());
            for (step, row) in rows.iter_mut().enumerate() {
                row[l] = of(values, start + step);
            }
        }
        rows
    };
    let recorded = |values: &[f64], row: usize| values[row];
    Batch {
        drivers: std::array::from_fn(|l| lane(l).0),
        weights: std::array::from_fn(|l| lane(l).2),
        gap_m: rows(|c| &c.gap_m, recorded),
        speed_mps: rows(|c| &c.ego_speed_mps, |v, row| v[row].max(0.0)),
        lead_mps: rows(|c| &c.lead_speed_mps, recorded),
        lead_moved_m: rows(
            |c| &c.leader_x_m,
            |x, row| if row == 0 { 0.0 } else { x[row] - x[row - 1] },
        ),
    }
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
    of: impl Fn(&Stretch<'_>, usize) -> f64,
) -> (f64, f64) {
    let values = || {
        drivers
            .iter()
            .flat_map(|s| s.rows.clone().map(|row| of(s, row)))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{run::FollowingRun, testing};

    /// Drivers whose recorded gap is the row it stands in.
    fn runs(rows: &[usize]) -> Vec<FollowingRun> {
        let run = |(i, rows): (usize, &usize)| {
            let run = testing::behind(&format!("P{i}"), *rows, 10.0, 5.0, |_| 5.0);
            let columns = crate::run::FollowingColumns {
                gap_m: (0..*rows).map(|row| (row + 1) as f64).collect(),
                ..run.columns().clone()
            };
            FollowingRun::new(format!("P{i}"), testing::RATE_HZ, columns).unwrap()
        };
        rows.iter().enumerate().map(run).collect()
    }

    /// Driver, first and last row, and weight of every segment; lanes that only fill up are left out.
    fn cut(
        stretches: &[Stretch<'_>],
        steps: usize,
        phase: Option<usize>,
    ) -> Vec<(usize, usize, usize, f64)> {
        let mut found = Vec::new();
        for batch in batches(stretches, steps, phase) {
            assert_eq!(batch.gap_m.len(), steps + 1);
            for lane in (0..LANES).filter(|l| batch.weights[*l] > 0.0) {
                let row = |step: usize| batch.gap_m[step][lane] as usize - 1;
                assert!((0..=steps).all(|step| row(step) == row(0) + step));
                found.push((batch.drivers[lane], row(0), row(steps), batch.weights[lane]));
            }
        }
        found
    }

    #[test]
    fn segments_follow_one_another_from_a_phase_or_overlap_to_the_end() {
        let runs = runs(&[31, 22]);
        let stretches: Vec<Stretch<'_>> = (runs.iter())
            .map(|run| Stretch {
                run,
                rows: 1..run.rows(),
            })
            .collect();
        // 29 and 20 steps: from the third on there are two of ten, and one; the second's phase is cut to where one still fits.
        let found = cut(&stretches, 10, Some(3));
        let rows: Vec<_> = found.iter().map(|f| (f.0, f.1, f.2)).collect();
        assert_eq!(rows, [(0, 4, 14), (0, 14, 24), (1, 4, 14)]);
        // Every driver weighs the same.
        let weights: Vec<f64> = found.iter().map(|f| f.3).collect();
        assert_eq!(weights, [0.25, 0.25, 0.5]);
        let found = cut(&stretches, 10, Some(15));
        let rows: Vec<_> = found.iter().map(|f| (f.0, f.1)).collect();
        assert_eq!(rows, [(0, 16), (1, 11)]);
        // A fifth of a segment apart, the last at the end.
        let found = cut(&stretches, 10, None);
        let starts = |driver: usize| -> Vec<usize> {
            found
                .iter()
                .filter(|f| f.0 == driver)
                .map(|f| f.1)
                .collect()
        };
        assert_eq!(starts(0), [1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 20]);
        assert_eq!(starts(1), [1, 3, 5, 7, 9, 11]);
        let total: f64 = found.iter().map(|f| f.3).sum();
        assert!((total - 1.0).abs() < 1e-12);
        assert!((found[0].3 - 0.5 / 11.0).abs() < 1e-12);
        // Short ones move on by a row.
        assert_eq!(cut(&stretches[1..], 3, None).len(), 18);
    }

    #[test]
    fn a_lane_holds_what_was_recorded_and_how_far_the_leader_moved() {
        let run = testing::behind("P", 12, 20.0, 7.0, |t| 5.0 + t);
        let whole = Stretch {
            run: &run,
            rows: 0..12,
        };
        let found = batch(&[whole], &[(0, 0, 1.0), (0, 6, 0.5)], 5);
        assert_eq!(
            (found.weights[0], found.weights[1], found.weights[2]),
            (1.0, 0.5, 0.0)
        );
        let columns = run.columns();
        for step in 0..=5 {
            for (lane, start) in [(0, 0), (1, 6), (2, 0)] {
                let row = start + step;
                let [gap, speed, lead] =
                    [&found.gap_m, &found.speed_mps, &found.lead_mps].map(|c| c[step][lane]);
                let expected = [20.0, 7.0, columns.lead_speed_mps[row]];
                let bits = |values: [f64; 3]| values.map(f64::to_bits);
                assert_eq!(bits([gap, speed, lead]), bits(expected), "row {row}");
                let moved = if row == 0 {
                    0.0
                } else {
                    0.5 * (columns.lead_speed_mps[row] + columns.lead_speed_mps[row - 1])
                        / testing::RATE_HZ
                };
                assert!(
                    (found.lead_moved_m[step][lane] - moved).abs() < 1e-9,
                    "row {row}"
                );
            }
        }
    }

    #[test]
    fn a_segment_is_as_long_as_wanted_and_no_longer_than_the_shortest() {
        let runs = runs(&[401, 101]);
        let of = |run: usize, segment_s: f64| {
            let stretches: Vec<Stretch<'_>> = (runs[run..].iter())
                .map(|run| Stretch {
                    run,
                    rows: 0..run.rows(),
                })
                .collect();
            let settings = ClosedLoopSettings {
                segment_s,
                ..ClosedLoopSettings::default()
            };
            segment_steps(&stretches, &settings)
        };
        assert_eq!((of(0, 5.0), of(0, 30.0), of(1, 0.01)), (50, 100, 1));
    }
}
