//! BFGS with a backtracking line search, for the few numbers of an embedding.

use crate::linear_algebra::{dot, norm, times};

/// Where a minimisation ended.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Minimum {
    pub(crate) at: Vec<f64>,
    pub(crate) value: f64,
    pub(crate) iterations: usize,
}

/// Share of the promised decrease that a step must bring (Armijo).
const SUFFICIENT: f64 = 1e-4;
/// Gradient norm below which the bottom is reached.
const FLAT: f64 = 1e-5;
/// Longest step, so that the first one, whose scale is a guess, stays in the neighbourhood.
const LONGEST: f64 = 1.0;

/// Minimises `f`, which returns value and gradient, from `start`.
///
/// The losses are piecewise smooth (ReLU) and computed in `f32`: a pair of gradients that shows no
/// curvature is not learned from, and a line search that finds no decrease ends the search.
pub(crate) fn minimise(
    f: impl Fn(&[f64]) -> (f64, Vec<f64>),
    start: Vec<f64>,
    most_iterations: usize,
) -> Minimum {
    let d = start.len();
    let mut x = start;
    let (mut value, mut gradient) = f(&x);
    let mut inverse = scaled_identity(d, 1.0 / norm(&gradient).max(1.0));
    let mut fresh = true;
    let mut iterations = 0;
    while iterations < most_iterations && norm(&gradient) > FLAT {
        iterations += 1;
        let mut direction: Vec<f64> = times(&inverse, &gradient).iter().map(|g| -g).collect();
        if dot(&direction, &gradient) >= 0.0 {
            inverse = scaled_identity(d, 1.0 / norm(&gradient).max(1.0));
            fresh = true;
            direction = times(&inverse, &gradient).iter().map(|g| -g).collect();
        }
        let length = norm(&direction);
        if length > LONGEST {
            for x in &mut direction {
                *x *= LONGEST / length;
            }
        }
        let slope = dot(&direction, &gradient);
        let mut share = 1.0;
        let next = loop {
            let candidate: Vec<f64> = x
                .iter()
                .zip(&direction)
                .map(|(x, d)| x + share * d)
                .collect();
            let (v, g) = f(&candidate);
            if v <= value + SUFFICIENT * share * slope {
                break Some((candidate, v, g));
            }
            share *= 0.5;
            if share < 1e-6 {
                break None;
            }
        };
        let Some((candidate, v, g)) = next else {
            if fresh {
                break;
            }
            inverse = scaled_identity(d, 1.0 / norm(&gradient).max(1.0));
            fresh = true;
            continue;
        };
        let step: Vec<f64> = candidate.iter().zip(&x).map(|(a, b)| a - b).collect();
        let change: Vec<f64> = g.iter().zip(&gradient).map(|(a, b)| a - b).collect();
        let curvature = dot(&step, &change);
        if curvature > 1e-10 * norm(&step) * norm(&change) {
            if fresh {
                inverse = scaled_identity(d, curvature / dot(&change, &change));
                fresh = false;
            }
            update(&mut inverse, &step, &change, curvature);
        }
        let gained = value - v;
        (x, value, gradient) = (candidate, v, g);
        if gained <= 1e-9 * value.abs() && norm(&step) < 1e-4 {
            break;
        }
    }
    Minimum {
        at: x,
        value,
        iterations,
    }
}

fn scaled_identity(d: usize, scale: f64) -> Vec<f64> {
    let mut matrix = vec![0.0; d * d];
    for i in 0..d {
        matrix[i * d + i] = scale;
    }
    matrix
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
    fn rosenbrock_is_solved() {
        let f = |x: &[f64]| {
            let (a, b) = (1.0 - x[0], x[1] - x[0] * x[0]);
            let gradient = vec![-2.0 * a - 400.0 * x[0] * b, 200.0 * b];
            (a * a + 100.0 * b * b, gradient)
        };
        let minimum = minimise(f, vec![-1.2, 1.0], 200);
        assert!((minimum.at[0] - 1.0).abs() < 1e-3, "{minimum:?}");
        assert!((minimum.at[1] - 1.0).abs() < 1e-3, "{minimum:?}");
    }
}
