//! The fast objective against plain loops.

use super::*;
use crate::{
    linear_algebra::dot,
    personalize::reference::{Problem, Reference},
};

#[test]
fn value_and_gradient_are_those_of_plain_loops_in_double_precision() {
    for problem in Problem::all() {
        let frozen = Frozen::of(&problem.model);
        let fit = Fit::new(&frozen, &problem.rows, problem.adb);
        let reference = Reference::new(&problem.model, &problem.rows, problem.adb);
        for w in problem.points() {
            let found = fit.value(&w);
            let expected = reference.value(&w);
            assert!(
                (found.value - expected).abs() < 1e-5 * (1.0 + expected.abs()),
                "{}: {} {expected}",
                problem.name,
                found.value
            );
            // Forwards along each coordinate, and backwards.
            let backwards = fit.slope(&w);
            assert!((backwards.value - found.value).abs() < 1e-9 * (1.0 + expected.abs()));
            let gradients = found.gradient.iter().enumerate();
            for (i, slope) in gradients.chain(backwards.gradient.iter().enumerate()) {
                let numeric = reference.slope(&w, i);
                assert!(
                    (slope - numeric).abs()
                        < 1e-3 * (1.0 + dot(&found.gradient, &found.gradient).sqrt()),
                    "{}: {slope} {numeric}",
                    problem.name
                );
            }
        }
    }
}

#[test]
fn blocks_share_out_the_whole_gradient() {
    let problem = Problem::all().remove(0);
    let frozen = Frozen::of(&problem.model);
    let fit = Fit::with_blocks(&frozen, &problem.rows, None, 20);
    let w = [0.2, -0.4, 0.1];
    let close = fit.close(&w);
    let blocks = &close.block_gradients;
    let gradient = fit.value(&w).gradient;
    assert_eq!(blocks.len(), (close.grid_rows / 20.0).ceil() as usize);
    for (i, whole) in gradient.iter().enumerate() {
        let sum: f64 = blocks.iter().map(|b| b[i]).sum();
        assert!((sum - whole).abs() < 1e-9 * (1.0 + whole.abs()));
    }
}
