//! Minimising a function of a few bounded numbers, without derivatives.

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct SearchSettings {
    /// Members of the differential evolution for each parameter of the law.
    pub members_per_parameter: usize,
    pub generations: usize,
    /// Generations in a row after which it ends if they gained nothing.
    pub patience: usize,
    /// Steps towards the bottom afterwards, at most.
    pub polishing_steps: usize,
}

impl Default for SearchSettings {
    fn default() -> Self {
        Self { members_per_parameter: 12, generations: 200, patience: 40, polishing_steps: 60 }
    }
}

/// A point and the cost there.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Minimum {
    pub(crate) point: Vec<f64>,
    pub(crate) cost: f64,
}

pub(crate) trait Cost {
    /// The cost of each point, or infinity as soon as it must exceed the limit beside it.
    fn costs(&self, points: &[Vec<f64>], limits: &[f64]) -> Vec<f64>;

    /// Weighted products of what the cost is made of, shape `(points, points)`: of the errors of the first point, and of how far those of
    /// the others lie from them. Half of what they say of a step is what the cost does, to first order; the cost bends no more than
    /// they say.
    fn products(&self, points: &[Vec<f64>]) -> DMatrix<f64>;
}

/// A wide search within `bounds`, and the last digits of what it found. The same seed gives the same point.
pub(crate) fn search(
    bounds: &[(f64, f64)],
    settings: &SearchSettings,
    seed: u64,
    cost: &impl Cost,
) -> Minimum {
    let minimum = minimise(bounds, settings, seed, cost);
    polish(bounds, minimum, settings.polishing_steps, cost)
}

/// Probability that a trial takes a coordinate from the mutant.
const CROSSOVER: f64 = 0.9;
/// Spread of costs, as a share of the lowest, at which the members have met; and what is to be gained.
const CONVERGED: f64 = 1e-3;

/// Differential evolution: searches `bounds` by rand/1/bin with a weight drawn from 0.5..1 for each trial.
///
/// Trials of a generation are made of the members before it. At least four members.
fn minimise(
    bounds: &[(f64, f64)],
    settings: &SearchSettings,
    seed: u64,
    cost: &impl Cost,
) -> Minimum {
    let members = (settings.members_per_parameter * bounds.len()).max(4);
    let mut rng = Pcg64::seed_from_u64(seed);
    let points = (0..members).map(|_| {
        let coordinate = |&(low, high): &(f64, f64)| low + (high - low) * rng.random::<f64>();
        bounds.iter().map(coordinate).collect()
    });
    let mut points: Vec<Vec<f64>> = points.collect();
    let mut costs = cost.costs(&points, &vec![f64::INFINITY; members]);
    let mut lowest = Vec::new();
    for _ in 0..settings.generations {
        let trials: Vec<Vec<f64>> =
            (0..members).map(|target| trial(&mut rng, bounds, &points, target)).collect();
        let trial_costs = cost.costs(&trials, &costs);
        for (target, (trial, trial_cost)) in trials.into_iter().zip(trial_costs).enumerate() {
            if trial_cost <= costs[target] {
                (points[target], costs[target]) = (trial, trial_cost);
            }
        }
        let now = costs.iter().copied().fold(f64::MAX, f64::min);
        let highest = costs.iter().copied().fold(f64::MIN, f64::max);
        let little = CONVERGED * now.abs();
        lowest.push(now);
        let before = lowest.iter().rev().nth(settings.patience);
        if highest - now <= little || before.is_some_and(|before| before - now <= little) {
            break;
        }
    }
    let best = lowest_index(&costs);
    Minimum { point: points.swap_remove(best), cost: costs[best] }
}

/// A mutant of three others, crossed with the target.
fn trial(rng: &mut Pcg64, bounds: &[(f64, f64)], points: &[Vec<f64>], target: usize) -> Vec<f64> {
    let [a, b, c] = three_others(rng, points.len(), target);
    let weight = 0.5 + 0.5 * rng.random::<f64>();
    let forced = rng.random_range(0..bounds.len());
    let mut trial = points[target].clone();
    for (i, &(low, high)) in bounds.iter().enumerate() {
        if i == forced || rng.random::<f64>() < CROSSOVER {
            let from = points[a][i];
            let mutant = from + weight * (points[b][i] - points[c][i]);
            // Halfway to the bound, not on it: members on a bound lose their differences.
            trial[i] = if mutant < low {
                0.5 * (from + low)
            } else if mutant > high {
                0.5 * (from + high)
            } else {
                mutant
            };
        }
    }
    trial
}

fn lowest_index(costs: &[f64]) -> usize {
    (0..costs.len()).fold(0, |best, i| if costs[i] < costs[best] { i } else { best })
}

/// Three members that differ from each other and from `target`.
fn three_others(rng: &mut Pcg64, members: usize, target: usize) -> [usize; 3] {
    let mut chosen = [target; 3];
    for i in 0..3 {
        chosen[i] = loop {
            let candidate = rng.random_range(0..members);
            if candidate != target && !chosen[..i].contains(&candidate) {
                break candidate;
            }
        };
    }
    chosen
}

/// How far [`polish`] moves coordinates to see what the errors do, as a share of their range.
const DISPLACED: f64 = 1e-6;
/// Gain of a step, as a share of the cost, that is none.
const CLOSED: f64 = 1e-7;
/// Decades of damping that are tried at once, from next to none to next to no step.
const DAMPING: RangeInclusive<i32> = -7..=8;

/// Goes down from `start` within `bounds` in at most `steps` steps. Never worse than `start`.
///
/// # Source
/// Levenberg 1944 and Marquardt 1963, with every damping tried at once and the best taken; a coordinate on a bound that wants to leave stays there.
pub(crate) fn polish(
    bounds: &[(f64, f64)],
    start: Minimum,
    steps: usize,
    cost: &impl Cost,
) -> Minimum {
    let mut best_yet = start;
    for _ in 0..steps {
        let candidates = steps_down(bounds, &best_yet.point, cost);
        let costs = cost.costs(&candidates, &vec![best_yet.cost; candidates.len()]);
        let Some(best) = (!costs.is_empty()).then(|| lowest_index(&costs)) else {
            break;
        };
        let gained = best_yet.cost - costs[best];
        if gained > 0.0 {
            best_yet = Minimum { point: candidates[best].clone(), cost: costs[best] };
        }
        if gained.is_nan() || gained <= CLOSED * best_yet.cost.abs() {
            break;
        }
    }
    best_yet
}

/// Where steps of every damping lead.
fn steps_down(bounds: &[(f64, f64)], point: &[f64], cost: &impl Cost) -> Vec<Vec<f64>> {
    let ranges: Vec<f64> = bounds.iter().map(|(low, high)| high - low).collect();
    // Inwards, where the range ends.
    let by = |i: usize| {
        let ends = point[i] + DISPLACED * ranges[i] > bounds[i].1;
        if ends { -DISPLACED } else { DISPLACED }
    };
    let mut points = vec![point.to_vec()];
    points.extend((0..point.len()).map(|i| {
        let mut displaced = point.to_vec();
        displaced[i] += by(i) * ranges[i];
        displaced
    }));
    let products = cost.products(&points);
    let slope = |i: usize| products[(0, i + 1)] / by(i);
    let leaves = |i: usize| {
        (point[i] <= bounds[i].0 && slope(i) > 0.0) || (point[i] >= bounds[i].1 && slope(i) < 0.0)
    };
    let free: Vec<usize> = (0..point.len()).filter(|&i| !leaves(i)).collect();
    if free.is_empty() {
        return Vec::new();
    }
    let n = free.len();
    let bend = DMatrix::from_fn(n, n, |a, b| {
        let (a, b) = (free[a], free[b]);
        products[(a + 1, b + 1)] / (by(a) * by(b))
    });
    let down = DVector::from_fn(n, |a, _| -slope(free[a]));
    let least = 1e-12 * bend.trace();
    let step = |decade: i32| {
        let mut damped = bend.clone();
        for a in 0..n {
            damped[(a, a)] += libm::pow(10.0, f64::from(decade)) * bend[(a, a)] + least;
        }
        let step = damped.cholesky()?.solve(&down);
        let mut there = point.to_vec();
        for (a, &i) in free.iter().enumerate() {
            there[i] = (point[i] + step[a] * ranges[i]).clamp(bounds[i].0, bounds[i].1);
        }
        Some(there)
    };
    DAMPING.filter_map(step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sum of squares of errors; the products are those of the errors times two.
    struct Squares<F: Fn(&[f64]) -> Vec<f64>>(F);

    impl<F: Fn(&[f64]) -> Vec<f64>> Cost for Squares<F> {
        fn costs(&self, points: &[Vec<f64>], limits: &[f64]) -> Vec<f64> {
            let cost = |point: &Vec<f64>| (self.0)(point).iter().map(|e| e * e).sum::<f64>();
            let within =
                |(cost, limit): (f64, &f64)| if cost > *limit { f64::INFINITY } else { cost };
            points.iter().map(cost).zip(limits).map(within).collect()
        }

        fn products(&self, points: &[Vec<f64>]) -> DMatrix<f64> {
            let errors: Vec<DVector<f64>> =
                points.iter().map(|p| DVector::from_vec((self.0)(p))).collect();
            let line = |i: usize| {
                if i == 0 { errors[0].clone() } else { &errors[i] - &errors[0] }
            };
            DMatrix::from_fn(points.len(), points.len(), |a, b| 2.0 * line(a).dot(&line(b)))
        }
    }

    fn many_valleys(p: &[f64]) -> Vec<f64> {
        let square = |x: &f64| x * x + 3.0 * (1.0 - (4.0 * x).cos());
        p.iter().map(|x| square(x).sqrt()).collect()
    }

    fn settings(members_per_parameter: usize, generations: usize) -> SearchSettings {
        SearchSettings {
            members_per_parameter,
            generations,
            patience: generations,
            ..SearchSettings::default()
        }
    }

    #[test]
    fn the_deepest_of_many_valleys_is_found() {
        let bounds = [(-5.0, 4.0), (-3.0, 6.0)];
        let found = minimise(&bounds, &settings(10, 80), 1, &Squares(many_valleys));
        assert!(found.cost < 1e-3, "{found:?}");
    }

    #[test]
    fn the_same_seed_gives_the_same_bytes() {
        let run = |seed| minimise(&[(-5.0, 4.0)], &settings(8, 5), seed, &Squares(many_valleys));
        assert_eq!(run(3), run(3));
        assert_ne!(run(3), run(4));
    }

    #[test]
    fn who_gains_nothing_for_some_generations_stops() {
        let asked = std::cell::Cell::new(0);
        let flat = Squares(|_: &[f64]| {
            asked.set(asked.get() + 1);
            vec![1.0 + 0.5 * f64::from(asked.get() % 2)]
        });
        let few = SearchSettings { patience: 3, ..settings(8, 50) };
        minimise(&[(0.0, 1.0)], &few, 1, &flat);
        // The first members, the first generation, and three that gain nothing.
        assert_eq!(asked.get(), 8 * 5);
    }

    #[test]
    fn no_point_leaves_the_bounds() {
        let cost = Squares(|p: &[f64]| {
            assert!((1.0..=2.0).contains(&p[0]));
            vec![p[0]]
        });
        let found = search(&[(1.0, 2.0)], &settings(6, 40), 1, &cost);
        assert!((found.point[0] - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_bend_of_a_curved_valley_is_found() {
        let rosenbrock = Squares(|p: &[f64]| vec![1.0 - p[0], 10.0 * (p[1] - p[0] * p[0])]);
        let start = Minimum { point: vec![-1.2, 1.0], cost: 24.2 };
        let found = polish(&[(-2.0, 2.0), (-2.0, 2.0)], start, 400, &rosenbrock);
        assert!((found.point[0] - 1.0).abs() < 1e-3, "{found:?}");
    }

    #[test]
    fn a_minimum_outside_the_bounds_ends_on_them_and_the_rest_goes_on() {
        let cost = Squares(|p: &[f64]| vec![p[0] - 9.0, p[1] - 1.0 - 0.1 * p[0]]);
        let start = Minimum { point: vec![1.0, 4.0], cost: 64.0 + 8.41 };
        let found = polish(&[(0.0, 5.0), (0.0, 5.0)], start, 100, &cost);
        assert!((found.point[0] - 5.0).abs() < 1e-9, "{found:?}");
        assert!((found.point[1] - 1.5).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn three_others_are_three_and_others() {
        let mut rng = Pcg64::seed_from_u64(7);
        let mut seen = [0; 5];
        for target in (0..5).cycle().take(500) {
            let [a, b, c] = three_others(&mut rng, 5, target);
            assert!(a != b && b != c && a != c, "{a} {b} {c}");
            assert!(![a, b, c].contains(&target));
            for i in [a, b, c] {
                seen[i] += 1;
            }
        }
        // Each of five is one of three in three of five draws.
        assert!(seen.iter().all(|n| (240..360).contains(n)), "{seen:?}");
    }

    #[test]
    fn the_lowest_is_the_first_of_least_cost() {
        assert_eq!(lowest_index(&[3.0, 1.0, 2.0, 1.0]), 1);
        assert_eq!(lowest_index(&[3.0]), 0);
    }
}
