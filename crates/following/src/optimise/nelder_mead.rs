//! The downhill simplex of Nelder and Mead: the last digits of a minimum.

use super::{Cost, Minimum};

/// First step along each coordinate, as a share of its range.
const FIRST_STEP: f64 = 0.05;
/// Spread of costs, as a share of the lowest, at which the simplex has closed.
const CLOSED: f64 = 1e-7;

/// Polishes `start` within `bounds` for at most `steps` moves of the simplex. Never worse than `start`.
///
/// # Source
/// Nelder and Mead 1965, coefficients 1, 2, 1/2, 1/2; a point outside the bounds is moved onto them.
pub(crate) fn polish(
    bounds: &[(f64, f64)],
    start: Minimum,
    steps: usize,
    cost: impl Cost,
) -> Minimum {
    let n = bounds.len();
    let at = |point: Vec<f64>, limit: f64| {
        let point: Vec<f64> = point
            .iter()
            .zip(bounds)
            .map(|(x, &(low, high))| x.clamp(low, high))
            .collect();
        let cost = cost(&point, limit);
        Minimum { point, cost }
    };
    let mut simplex = vec![start];
    for i in 0..n {
        let (low, high) = bounds[i];
        let mut point = simplex[0].point.clone();
        let step = FIRST_STEP * (high - low);
        point[i] += if point[i] + step > high { -step } else { step };
        simplex.push(at(point, f64::INFINITY));
    }
    for _ in 0..steps {
        simplex.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let (best, second_worst, worst) = (simplex[0].cost, simplex[n - 1].cost, simplex[n].cost);
        if worst - best <= CLOSED * best.abs() {
            break;
        }
        let centre: Vec<f64> = (0..n)
            .map(|i| simplex[..n].iter().map(|m| m.point[i]).sum::<f64>() / n as f64)
            .collect();
        let along = |by: f64| -> Vec<f64> {
            let from = &simplex[n].point;
            (0..n)
                .map(|i| centre[i] + by * (from[i] - centre[i]))
                .collect()
        };
        let reflected = at(along(-1.0), worst);
        let replacement = if reflected.cost < best {
            let expanded = at(along(-2.0), reflected.cost);
            Some(if expanded.cost < reflected.cost {
                expanded
            } else {
                reflected
            })
        } else if reflected.cost < second_worst {
            Some(reflected)
        } else {
            let inner = if reflected.cost < worst { -0.5 } else { 0.5 };
            let contracted = at(along(inner), worst);
            (contracted.cost < worst.min(reflected.cost)).then_some(contracted)
        };
        if let Some(better) = replacement {
            simplex[n] = better;
            continue;
        }
        let lowest = simplex[0].point.clone();
        for member in &mut simplex[1..] {
            let halved = member.point.iter().zip(&lowest).map(|(x, b)| 0.5 * (x + b));
            *member = at(halved.collect(), f64::INFINITY);
        }
    }
    simplex.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    simplex.swap_remove(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bend_of_a_curved_valley_is_found() {
        let rosenbrock =
            |p: &[f64], _: f64| (1.0 - p[0]).powi(2) + 100.0 * (p[1] - p[0] * p[0]).powi(2);
        let start = Minimum {
            point: vec![-1.2, 1.0],
            cost: rosenbrock(&[-1.2, 1.0], 0.0),
        };
        let found = polish(&[(-2.0, 2.0), (-2.0, 2.0)], start, 400, rosenbrock);
        assert!((found.point[0] - 1.0).abs() < 1e-3, "{found:?}");
    }

    #[test]
    fn a_minimum_outside_the_bounds_ends_on_them() {
        let cost = |p: &[f64], _: f64| (p[0] - 9.0).powi(2);
        let start = Minimum {
            point: vec![1.0],
            cost: 64.0,
        };
        let found = polish(&[(0.0, 5.0)], start, 100, cost);
        assert!((found.point[0] - 5.0).abs() < 1e-9);
    }
}
