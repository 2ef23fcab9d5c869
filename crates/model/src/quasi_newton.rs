//! BFGS with a weak Wolfe line search: the last steps to a minimum that may lie on a kink.

use crate::{
    damped_newton::{Evaluated, Minimum},
    linear_algebra::{dot, norm, of_symmetric, symmetric_eigen, times},
};

/// Share of the promised decrease that a step must bring.
const SUFFICIENT: f64 = 1e-4;
/// Share of the slope that must be gone after a step.
const FLATTER: f64 = 0.9;
/// Change of the value, relative to it, that is the rounding of sums of `f32`.
const ROUNDING: f64 = 1e-8;
/// Steps in a row that may bring nothing.
const PATIENCE: usize = 2;
/// Longest first try of a step.
const LONGEST: f64 = 0.5;
/// Tries of a line search.
const TRIES: usize = 12;

/// Minimises `f` from `start`, where it is `here`; the curvature there is the first model, and no other is read.
///
/// Free road is the same row again and again, so that kinks of the networks' ReLUs add up and the minimum often lies on
/// one, where Newton's method creeps. BFGS learns the kink's steepness as curvature and does not.
///
/// # Source
/// Lewis and Overton 2013, "Nonsmooth optimization via quasi-Newton methods": the line search is their algorithm 2.6.
pub fn polish(
    mut f: impl FnMut(&[f64]) -> Evaluated,
    start: Vec<f64>,
    mut here: Evaluated,
    most_iterations: usize,
) -> Minimum {
    let d = start.len();
    let mut x = start;
    let mut inverse = inverse_of(&here.curvature, d);
    let mut idle = 0;
    let mut iterations = 0;
    while iterations < most_iterations && idle < PATIENCE {
        let mut direction: Vec<f64> = times(&inverse, &here.gradient).iter().map(|g| -g).collect();
        let slope = dot(&direction, &here.gradient);
        if slope.is_nan() || -slope <= ROUNDING * here.value.abs() {
            break;
        }
        let length = norm(&direction);
        let shrink = (LONGEST / length).min(1.0);
        for p in &mut direction {
            *p *= shrink;
        }
        let Some((candidate, there)) = line_search(&mut f, &x, &here, &direction) else {
            break;
        };
        iterations += 1;
        let step: Vec<f64> = candidate.iter().zip(&x).map(|(a, b)| a - b).collect();
        let change = there.gradient.iter().zip(&here.gradient);
        let change: Vec<f64> = change.map(|(a, b)| a - b).collect();
        let curvature = dot(&step, &change);
        if curvature > 1e-10 * norm(&step) * norm(&change) {
            update(&mut inverse, &step, &change, curvature);
        }
        let gained = here.value - there.value;
        idle = if gained <= ROUNDING * here.value.abs() {
            idle + 1
        } else {
            0
        };
        (x, here) = (candidate, there);
    }
    Minimum {
        at: x,
        there: here,
        iterations,
    }
}

/// A point along `direction` that is lower and flatter; failing that, one that is lower.
fn line_search(
    f: &mut impl FnMut(&[f64]) -> Evaluated,
    x: &[f64],
    here: &Evaluated,
    direction: &[f64],
) -> Option<(Vec<f64>, Evaluated)> {
    let slope = dot(direction, &here.gradient);
    let (mut low, mut high) = (0.0, f64::INFINITY);
    let mut share = 1.0;
    let mut lower = None;
    for _ in 0..TRIES {
        let along = x.iter().zip(direction).map(|(x, p)| x + share * p);
        let candidate: Vec<f64> = along.collect();
        let there = f(&candidate);
        let enough = here.value + SUFFICIENT * share * slope + ROUNDING * here.value.abs();
        if there.value <= enough {
            if dot(direction, &there.gradient) >= FLATTER * slope {
                return Some((candidate, there));
            }
            low = share;
            lower = Some((candidate, there));
        } else {
            high = share;
        }
        share = if high.is_finite() {
            0.5 * (low + high)
        } else {
            2.0 * low
        };
    }
    lower
}

fn inverse_of(curvature: &[f64], d: usize) -> Vec<f64> {
    let (values, vectors) = symmetric_eigen(curvature, d);
    let least = (1e-3 * values[0]).max(1e-9);
    of_symmetric(&values, &vectors, |v| 1.0 / v.max(least))
}

/// `H ← (I − ρ s yᵀ) H (I − ρ y sᵀ) + ρ s sᵀ`, ρ = 1/sᵀy.
fn update(inverse: &mut [f64], s: &[f64], y: &[f64], curvature: f64) {
    let d = s.len();
    let rho = 1.0 / curvature;
    let hy = times(inverse, y);
    let yhy = dot(y, &hy);
    for i in 0..d {
        for j in 0..d {
            inverse[i * d + j] +=
                rho * (1.0 + rho * yhy) * s[i] * s[j] - rho * (hy[i] * s[j] + s[i] * hy[j]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_minimum_on_a_kink_is_found() {
        // A sharp valley along a parabola.
        let f = |x: &[f64]| {
            let (a, b) = (x[0] * x[0] - x[1], x[0] - 0.4);
            let gradient = vec![8.0 * a.signum() * 2.0 * x[0] + 2.0 * b, -8.0 * a.signum()];
            Evaluated {
                value: 1.0 + 8.0 * a.abs() + b * b,
                gradient,
                curvature: vec![2.0, 0.0, 0.0, 0.1],
            }
        };
        let start = vec![-0.8, 1.0];
        let here = f(&start);
        let minimum = polish(f, start, here, 200);
        assert!((minimum.at[0] - 0.4).abs() < 1e-2, "{minimum:?}");
        assert!((minimum.at[1] - 0.16).abs() < 1e-2, "{minimum:?}");
    }

    #[test]
    fn a_smooth_minimum_is_found_in_a_few_steps() {
        let f = |x: &[f64]| Evaluated {
            value: 1.0 + 5.0 * x[0] * x[0] + x[0] * x[1] + 0.5 * x[1] * x[1],
            gradient: vec![10.0 * x[0] + x[1], x[0] + x[1]],
            curvature: vec![9.0, 0.5, 0.5, 1.0],
        };
        let start = vec![0.7, -0.4];
        let here = f(&start);
        let minimum = polish(f, start, here, 100);
        assert!(norm(&minimum.at) < 1e-3, "{minimum:?}");
        assert!(minimum.iterations < 12, "{minimum:?}");
    }
}
