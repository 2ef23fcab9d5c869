//! Newton's method with a damped model of the curvature, for the few numbers of an embedding.

use crate::linear_algebra::{dot, norm, of_symmetric, symmetric_eigen, times};

/// A function at a point.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Evaluated {
    /// The function.
    pub(crate) value: f64,
    /// Its gradient; shape `(d,)`.
    pub(crate) gradient: Vec<f64>,
    /// A symmetric matrix that stands for the second derivatives and has no negative eigenvalue, such as Gauss's and
    /// Newton's; shape `(d, d)`, or empty where nobody reads it.
    pub(crate) curvature: Vec<f64>,
}

/// Where a minimisation ended.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Minimum {
    /// The point; shape `(d,)`.
    pub(crate) at: Vec<f64>,
    /// The function there.
    pub(crate) there: Evaluated,
    /// Steps that were taken.
    pub(crate) iterations: usize,
}

/// Share of the promised decrease that a step must bring.
const SUFFICIENT: f64 = 1e-3;
/// Longest step.
const LONGEST: f64 = 1.0;
/// First damping after a step that failed, in shares of the mean curvature.
const FIRST_DAMPING: f64 = 0.05;

/// Minimises `f` from `start`.
///
/// It ends when no step promises a decrease above `tolerance` times the value or, where that is larger, 1, or the last one brought none. A step solves `(H + λ h I) δ = −g`, with h the mean curvature; λ is 0 as long as steps keep what they promise, and rises when
/// they do not, as where the losses, piecewise smooth (ReLU), have a kink.
///
/// # Source
/// Levenberg 1944, Marquardt 1963; the rule for λ by the ratio of gain to promise as in Nocedal and Wright, Numerical
/// Optimization (2006), algorithm 4.1.
pub(crate) fn minimise(
    mut f: impl FnMut(&[f64]) -> Evaluated,
    start: Vec<f64>,
    tolerance: f64,
    most_iterations: usize,
) -> Minimum {
    let d = start.len();
    let mut x = start;
    let mut here = f(&x);
    let mut damping = 0.0_f64;
    let mut iterations = 0;
    while iterations < most_iterations {
        let (values, vectors) = symmetric_eigen(&here.curvature, d);
        let mean = values.iter().sum::<f64>().max(f64::MIN_POSITIVE) / d as f64;
        let raised = |v: f64| v.max(1e-6 * mean) + damping * mean;
        let inverse = of_symmetric(&values, &vectors, |v| 1.0 / raised(v));
        let mut step: Vec<f64> = times(&inverse, &here.gradient).iter().map(|x| -x).collect();
        let length = norm(&step);
        if !length.is_finite() {
            break;
        }
        if length > LONGEST {
            for s in &mut step {
                *s *= LONGEST / length;
            }
        }
        let bend = dot(&step, &times(&here.curvature, &step));
        let promised = -dot(&step, &here.gradient) - 0.5 * bend;
        if promised <= tolerance * (1.0 + here.value.abs()) {
            break;
        }
        iterations += 1;
        let candidate: Vec<f64> = x.iter().zip(&step).map(|(x, s)| x + s).collect();
        let there = f(&candidate);
        let gained = here.value - there.value;
        let kept = gained / promised;
        if kept < 0.25 || kept.is_nan() {
            damping = (4.0 * damping).max(FIRST_DAMPING);
        } else if kept > 0.75 {
            damping = if damping > FIRST_DAMPING {
                damping / 4.0
            } else {
                0.0
            };
        }
        if kept >= SUFFICIENT {
            let little = gained <= tolerance * (1.0 + here.value.abs());
            (x, here) = (candidate, there);
            if little {
                break;
            }
        }
    }
    Minimum {
        at: x,
        there: here,
        iterations,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley as a sum of two squares.
    fn valley(x: &[f64]) -> Evaluated {
        let (a, b) = (1.0 - x[0], 10.0 * (x[1] - x[0] * x[0]));
        let (da, db) = ([-1.0, 0.0], [-20.0 * x[0], 10.0]);
        let curvature = |i: usize, j: usize| 2.0 * (da[i] * da[j] + db[i] * db[j]);
        Evaluated {
            value: a * a + b * b,
            gradient: (0..2).map(|i| 2.0 * (a * da[i] + b * db[i])).collect(),
            curvature: vec![
                curvature(0, 0),
                curvature(0, 1),
                curvature(1, 0),
                curvature(1, 1),
            ],
        }
    }

    #[test]
    fn rosenbrock_is_solved() {
        let minimum = minimise(valley, vec![-1.2, 1.0], 1e-9, 200);
        assert!((minimum.at[0] - 1.0).abs() < 1e-3, "{minimum:?}");
        assert!((minimum.at[1] - 1.0).abs() < 1e-3, "{minimum:?}");
    }

    #[test]
    fn a_kink_and_a_flat_place_end_the_search() {
        let kink = |x: &[f64]| Evaluated {
            value: 1.0 + x[0].abs(),
            gradient: vec![x[0].signum()],
            curvature: vec![1.0],
        };
        let minimum = minimise(kink, vec![0.7], 1e-9, 100);
        assert!(minimum.at[0].abs() < 0.05, "{minimum:?}");
        let flat = |_: &[f64]| Evaluated {
            value: 2.0,
            gradient: vec![0.0],
            curvature: vec![0.0],
        };
        assert_eq!(minimise(flat, vec![0.7], 1e-9, 100).iterations, 0);
    }
}
