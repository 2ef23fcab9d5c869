//! The gradient against difference quotients.

use super::*;
use crate::closed_loop_network::controller::Scaling;
use rand::{RngExt, SeedableRng};

/// Leaders that come and go, for lanes of two embeddings; the last lane only fills up.
fn batch(steps: usize) -> Batch<f64> {
    let lead = |t: f64, lane: f64| 12.0 + lane + 3.0 * (t / 2.0 + lane).sin();
    let row = |step: usize| {
        let t = step as f64 / 10.0;
        let lanes = |of: &dyn Fn(f64) -> f64| std::array::from_fn(|l| of(l as f64 / 2.0));
        Row {
            gap_m: lanes(&|lane| 20.0 + 2.0 * lane + (t + lane).cos()),
            speed_mps: lanes(&|lane| 12.0 + lane + (0.7 * t).sin()),
            lead_mps: lanes(&|lane| lead(t, lane)),
            lead_moved_m: lanes(&|lane| 0.1 * lead(t, lane)),
        }
    };
    Batch {
        embeddings: std::array::from_fn(|l| l % 2),
        weights: std::array::from_fn(|l| if l == LANES - 1 { 0.0 } else { 0.05 }),
        rows: (0..=steps).map(row).collect(),
    }
}

fn world(hidden: usize) -> World {
    World {
        layout: Layout {
            embedding: 2,
            hidden,
        },
        scaling: Scaling {
            speed_mean_mps: 14.0,
            speed_sd_mps: 3.0,
        },
        safety: crate::SAFETY,
        step_s: 0.1,
        gap_weight: 0.02,
        speed_weight: 0.1,
    }
}

fn weights(layout: Layout) -> Vec<f64> {
    let mut rng = rand_pcg::Pcg64::seed_from_u64(3);
    let mut weights = layout.draw(&mut rng);
    for weight in &mut weights {
        *weight += 0.2 * (rng.random::<f64>() - 0.5);
    }
    weights
}

const EMBEDDINGS: [f64; 4] = [0.4, -0.3, -0.6, 0.8];

fn alone<T: Real>(world: &World<T>, weights: &[T], embeddings: &[T], batch: &Batch<T>) -> Gradient {
    gradient(world, weights, embeddings, batch, &mut Room::default())
}

#[test]
fn the_gradient_through_the_closed_loop_is_the_difference_quotient() {
    // The usual number of hidden units is compiled apart.
    for hidden in [4, 5, USUAL_HIDDEN] {
        let world = world(hidden);
        let (weights, batch) = (weights(world.layout), batch(60));
        let found = alone(&world, &weights, &EMBEDDINGS, &batch);
        let close = |found: f64, expected: f64| {
            let error = (found - expected).abs();
            assert!(error < 1e-5 * (1e-2 + expected.abs()), "{found} {expected}");
        };
        let step = 1e-6;
        for at in 0..weights.len() {
            let loss = |by: f64| {
                let mut moved = weights.clone();
                moved[at] += by;
                alone(&world, &moved, &EMBEDDINGS, &batch).loss
            };
            close(found.weights[at], (loss(step) - loss(-step)) / (2.0 * step));
        }
        for at in 0..EMBEDDINGS.len() {
            let loss = |by: f64| {
                let mut moved = EMBEDDINGS;
                moved[at] += by;
                alone(&world, &weights, &moved, &batch).loss
            };
            close(
                found.embeddings[at],
                (loss(step) - loss(-step)) / (2.0 * step),
            );
        }
    }
}

#[test]
fn single_precision_loses_nothing_that_counts_over_half_a_minute() {
    let world = world(USUAL_HIDDEN);
    let (weights, wide) = (weights(world.layout), batch(300));
    let narrow = |x: &[f64]| -> Vec<f32> { x.iter().map(|x| *x as f32).collect() };
    let lanes = |x: Lanes<f64>| x.map(|x| x as f32);
    let rows = wide.rows.iter().map(|row| Row {
        gap_m: lanes(row.gap_m),
        speed_mps: lanes(row.speed_mps),
        lead_mps: lanes(row.lead_mps),
        lead_moved_m: lanes(row.lead_moved_m),
    });
    let batch = Batch {
        embeddings: wide.embeddings,
        weights: wide.weights,
        rows: rows.collect(),
    };
    let expected = alone(&world, &weights, &EMBEDDINGS, &wide);
    let found = alone(
        &world.reckoned_in(),
        &narrow(&weights),
        &narrow(&EMBEDDINGS),
        &batch,
    );
    assert!((found.loss - expected.loss).abs() < 1e-4 * expected.loss);
    let all = |g: &Gradient| -> Vec<f64> { [&g.weights[..], &g.embeddings].concat() };
    let (found, expected) = (all(&found), all(&expected));
    let length = expected.iter().map(|x| x * x).sum::<f64>().sqrt();
    let apart = found.iter().zip(&expected).map(|(a, b)| (a - b).powi(2));
    assert!(apart.sum::<f64>().sqrt() < 1e-3 * length);
}

#[test]
fn the_squares_of_the_errors_are_the_loss() {
    let world = world(4);
    let (weights, batch) = (weights(world.layout), batch(60));
    let found = errors(&world, &weights, &EMBEDDINGS, &batch);
    let squares: f64 = found.iter().flatten().map(|e| e * e).sum();
    let loss = alone(&world, &weights, &EMBEDDINGS, &batch).loss;
    assert!((squares - loss).abs() < 1e-12 * loss, "{squares} {loss}");
}

#[test]
fn braking_to_a_stop_and_the_bounds_have_the_slopes_of_their_branches() {
    let step = 1e-6;
    for (v, a) in [
        (0.3, -6.0),
        (10.0, 1.0),
        (10.0, -9.0),
        (10.0, 5.0),
        (0.0, -1.0),
    ] {
        let of = |v: f64, a: f64| {
            let (moved, next) = advance(v, a, 0.1);
            3.0 * moved + 2.0 * next
        };
        let (d_v, d_a) = advance_back(v, a, 0.1, 3.0, 2.0);
        let by_v = (of(v + step, a) - of(v, a)) / step;
        let by_a = (of(v, a + step) - of(v, a - step)) / (2.0 * step);
        assert!((d_v - by_v).abs() < 1e-4, "{v} {a}: {d_v} {by_v}");
        assert!((d_a - by_a).abs() < 1e-4, "{v} {a}: {d_a} {by_a}");
    }
    let safety = crate::SAFETY;
    // A gap at which the bound commands: 3 m at 10 m/s behind 9 m/s.
    let usual = [1.5, 2.0, 1.0, 0.4];
    let accel = |parameters: [f64; OUTPUTS], g: f64, v: f64, lead: f64| {
        Parameters::from_array(parameters).accel_mps2(&safety, g, v, lead)
    };
    for (g, v, lead) in [(3.0, 10.0, 9.0), (25.0, 10.0, 9.0)] {
        let back = Parameters::from_array(usual).back(&safety, (g, v, lead), 1.0);
        let by = |of: &dyn Fn(f64) -> f64| (of(step) - of(-step)) / (2.0 * step);
        let close = |found: f64, expected: f64| {
            assert!((found - expected).abs() < 1e-4, "{found} {expected}");
        };
        close(back.gap, by(&|step| accel(usual, g + step, v, lead)));
        close(back.speed, by(&|step| accel(usual, g, v + step, lead)));
        for k in 0..OUTPUTS {
            let moved = |step: f64| {
                let mut moved = usual;
                moved[k] += step;
                accel(moved, g, v, lead)
            };
            close(back.parameters[k], by(&moved));
        }
    }
}
