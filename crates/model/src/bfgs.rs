//! BFGS with a weak Wolfe line search: a minimum of a few numbers that may lie on a kink.

use nalgebra::{DMatrix, DVector};

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

/// A function at a point.
#[derive(Debug, Clone)]
pub struct Evaluated {
    /// The function.
    pub value: f64,
    /// Its gradient, shape `(d,)`.
    pub gradient: DVector<f64>,
}

/// Minimises `f` from `start`, of which nothing is known beforehand: the first step goes down the gradient.
///
/// The kinks of a network's ReLUs add up over rows that are alike, and the minimum often lies on one, where Newton's method creeps.
/// BFGS learns the kink's steepness as curvature and does not.
///
/// # Source
/// Lewis and Overton 2013, "Nonsmooth optimization via quasi-Newton methods": the line search is their algorithm 2.6.
pub fn minimise(
    mut f: impl FnMut(&DVector<f64>) -> Evaluated,
    start: DVector<f64>,
    most_iterations: usize,
) -> DVector<f64> {
    let d = start.len();
    let mut x = start;
    let mut current = f(&x);
    let mut inverse = DMatrix::identity(d, d);
    let (mut idle, mut iterations) = (0, 0);
    while iterations < most_iterations && idle < PATIENCE {
        let mut direction = -(&inverse * &current.gradient);
        let slope = direction.dot(&current.gradient);
        if slope.is_nan() || -slope <= ROUNDING * current.value.abs() {
            break;
        }
        direction *= (LONGEST / direction.norm()).min(1.0);
        let Some((candidate, there)) = line_search(&mut f, &x, &current, &direction) else {
            break;
        };
        iterations += 1;
        update(&mut inverse, &(&candidate - &x), &(&there.gradient - &current.gradient));
        let gained = current.value - there.value;
        idle = if gained <= ROUNDING * current.value.abs() { idle + 1 } else { 0 };
        (x, current) = (candidate, there);
    }
    x
}

/// A point along `direction` that is lower and flatter; failing that, one that is lower.
fn line_search(
    f: &mut impl FnMut(&DVector<f64>) -> Evaluated,
    x: &DVector<f64>,
    current: &Evaluated,
    direction: &DVector<f64>,
) -> Option<(DVector<f64>, Evaluated)> {
    let slope = direction.dot(&current.gradient);
    let (mut low, mut high) = (0.0, f64::INFINITY);
    let mut share = 1.0;
    let mut lower = None;
    for _ in 0..TRIES {
        let candidate = x + share * direction;
        let there = f(&candidate);
        let enough = current.value + SUFFICIENT * share * slope + ROUNDING * current.value.abs();
        if there.value <= enough {
            if direction.dot(&there.gradient) >= FLATTER * slope {
                return Some((candidate, there));
            }
            low = share;
            lower = Some((candidate, there));
        } else {
            high = share;
        }
        share = if high.is_finite() { 0.5 * (low + high) } else { 2.0 * low };
    }
    lower
}

/// `H ← (I − ρ s yᵀ) H (I − ρ y sᵀ) + ρ s sᵀ`, ρ = 1/sᵀy; nothing where the slope did not rise.
fn update(inverse: &mut DMatrix<f64>, s: &DVector<f64>, y: &DVector<f64>) {
    let curvature = s.dot(y);
    if curvature <= 1e-10 * s.norm() * y.norm() {
        return;
    }
    let rho = 1.0 / curvature;
    let hy = &*inverse * y;
    let both = &hy * s.transpose();
    *inverse +=
        rho * (1.0 + rho * y.dot(&hy)) * s * s.transpose() - rho * (&both + both.transpose());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_minimum_on_a_kink_is_found() {
        // A sharp valley along a parabola.
        let f = |x: &DVector<f64>| {
            let (a, b) = (x[0] * x[0] - x[1], x[0] - 0.4);
            let slope = 8.0 * a.signum();
            Evaluated {
                value: 1.0 + 8.0 * a.abs() + b * b,
                gradient: DVector::from_vec(vec![slope * 2.0 * x[0] + 2.0 * b, -slope]),
            }
        };
        let found = minimise(f, DVector::from_vec(vec![-0.8, 1.0]), 200);
        assert!((found[0] - 0.4).abs() < 1e-2, "{found}");
        assert!((found[1] - 0.16).abs() < 1e-2, "{found}");
    }

    #[test]
    fn a_smooth_minimum_is_found() {
        let f = |x: &DVector<f64>| Evaluated {
            value: 1.0 + 5.0 * x[0] * x[0] + x[0] * x[1] + 0.5 * x[1] * x[1],
            gradient: DVector::from_vec(vec![10.0 * x[0] + x[1], x[0] + x[1]]),
        };
        let found = minimise(f, DVector::from_vec(vec![0.7, -0.4]), 100);
        assert!(found.norm() < 1e-3, "{found}");
    }
}
