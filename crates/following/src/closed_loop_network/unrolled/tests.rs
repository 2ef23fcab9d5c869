//! The gradient against difference quotients.

use super::*;
use rand::{RngExt, SeedableRng};

/// Leaders that come and go, for eight lanes of two drivers; the last lane only fills up.
fn batch(steps: usize) -> Batch {
    let at = |step: usize, lane: usize| (step as f64 / 10.0, lane as f64);
    let rows = |of: &dyn Fn(f64, f64) -> f64| -> Vec<Lanes> {
        (0..=steps)
            .map(|step| std::array::from_fn(|l| of(at(step, l).0, at(step, l).1)))
            .collect()
    };
    let lead = |t: f64, lane: f64| 12.0 + lane + 3.0 * (t / 2.0 + lane).sin();
    Batch {
        drivers: std::array::from_fn(|l| l % 2),
        weights: std::array::from_fn(|l| if l == 7 { 0.0 } else { 0.1 }),
        gap_m: rows(&|t, lane| 20.0 + 2.0 * lane + (t + lane).cos()),
        speed_mps: rows(&|t, lane| 12.0 + lane + (0.7 * t).sin()),
        lead_mps: rows(&lead),
        lead_moved_m: rows(&|t, lane| 0.1 * lead(t, lane)),
    }
}

#[test]
fn the_gradient_through_the_closed_loop_is_the_difference_quotient() {
    let layout = Layout {
        embedding: 2,
        hidden: 4,
    };
    let world = World {
        layout,
        scaling: controller::Scaling {
            speed_mean_mps: 14.0,
            speed_sd_mps: 3.0,
        },
        safety: crate::SAFETY,
        step_s: 0.1,
        gap_weight: 0.02,
        speed_weight: 0.1,
    };
    let mut rng = rand_pcg::Pcg64::seed_from_u64(3);
    let mut weights = layout.draw(&mut rng);
    for weight in &mut weights {
        *weight += 0.2 * (rng.random::<f64>() - 0.5);
    }
    let embeddings = [0.4, -0.3, -0.6, 0.8];
    let batch = batch(60);
    let found = gradient(&world, &weights, &embeddings, &batch);
    let close = |found: f64, expected: f64| {
        let error = (found - expected).abs();
        assert!(error < 1e-5 * (1e-2 + expected.abs()), "{found} {expected}");
    };
    let step = 1e-6;
    for at in 0..weights.len() {
        let loss = |by: f64| {
            let mut moved = weights.clone();
            moved[at] += by;
            gradient(&world, &moved, &embeddings, &batch).loss
        };
        close(found.weights[at], (loss(step) - loss(-step)) / (2.0 * step));
    }
    for at in 0..embeddings.len() {
        let loss = |by: f64| {
            let mut moved = embeddings;
            moved[at] += by;
            gradient(&world, &weights, &moved, &batch).loss
        };
        close(
            found.embeddings[at],
            (loss(step) - loss(-step)) / (2.0 * step),
        );
    }
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
    let asked = controller::Parameters::of([0.0; OUTPUTS]);
    for (g, v, lead) in [(3.0, 10.0, 9.0), (25.0, 10.0, 9.0)] {
        let accel = |g: f64, v: f64| asked.accel_mps2(&safety, g, v, lead);
        let back = asked.back([0.0; OUTPUTS], &safety, (g, v, lead), 1.0);
        let by_gap = (accel(g + step, v) - accel(g - step, v)) / (2.0 * step);
        let by_speed = (accel(g, v + step) - accel(g, v - step)) / (2.0 * step);
        assert!((back.gap - by_gap).abs() < 1e-4, "{} {by_gap}", back.gap);
        assert!(
            (back.speed - by_speed).abs() < 1e-4,
            "{} {by_speed}",
            back.speed
        );
    }
}
