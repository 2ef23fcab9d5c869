//! Minimising a function of a few bounded numbers, without derivatives.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

/// How thoroughly to search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct SearchSettings {
    /// Members of the differential evolution for each parameter of the law.
    pub members_per_parameter: usize,
    /// Its generations at most.
    pub generations: usize,
    /// Moves of the simplex afterwards, at most.
    pub simplex_steps: usize,
}

impl Default for SearchSettings {
    fn default() -> Self {
        Self {
            members_per_parameter: 12,
            generations: 200,
            simplex_steps: 300,
        }
    }
}

/// A point and the cost there.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Minimum {
    pub(crate) point: Vec<f64>,
    pub(crate) cost: f64,
}

/// What is minimised: the cost of a point, or infinity as soon as the cost must exceed the limit beside it.
pub(crate) trait Cost: Fn(&[f64], f64) -> f64 {}
impl<T: Fn(&[f64], f64) -> f64> Cost for T {}

/// A wide search within `bounds`, and the last digits of what it found. The same seed gives the same point.
pub(crate) fn search(
    bounds: &[(f64, f64)],
    settings: &SearchSettings,
    seed: u64,
    cost: impl Cost,
) -> Minimum {
    let members = settings.members_per_parameter * bounds.len();
    let found = minimise(bounds, members, settings.generations, seed, &cost);
    polish(bounds, found, settings.simplex_steps, &cost)
}

/// Probability that a trial takes a coordinate from the mutant.
const CROSSOVER: f64 = 0.9;
/// Spread of costs, as a share of the lowest, at which the members have met.
const CONVERGED: f64 = 1e-3;

/// Differential evolution: searches `bounds` by rand/1/bin with a weight drawn from 0.5..1 for each trial.
///
/// A member is replaced as soon as a trial is better, within the generation. At least four members.
fn minimise(
    bounds: &[(f64, f64)],
    members: usize,
    generations: usize,
    seed: u64,
    cost: impl Cost,
) -> Minimum {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut population: Vec<Minimum> = (0..members.max(4))
        .map(|_| {
            let point: Vec<f64> = bounds
                .iter()
                .map(|&(low, high)| low + (high - low) * rng.random::<f64>())
                .collect();
            let cost = cost(&point, f64::INFINITY);
            Minimum { point, cost }
        })
        .collect();
    for _ in 0..generations {
        for target in 0..population.len() {
            let [a, b, c] = three_others(&mut rng, population.len(), target);
            let weight = 0.5 + 0.5 * rng.random::<f64>();
            let forced = rng.random_range(0..bounds.len());
            let mut trial = population[target].point.clone();
            for (i, &(low, high)) in bounds.iter().enumerate() {
                if i == forced || rng.random::<f64>() < CROSSOVER {
                    let from = population[a].point[i];
                    let mutant = from + weight * (population[b].point[i] - population[c].point[i]);
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
            let found = cost(&trial, population[target].cost);
            if found <= population[target].cost {
                population[target] = Minimum {
                    point: trial,
                    cost: found,
                };
            }
        }
        let lowest = population.iter().map(|m| m.cost).fold(f64::MAX, f64::min);
        let highest = population.iter().map(|m| m.cost).fold(f64::MIN, f64::max);
        if highest - lowest <= CONVERGED * lowest.abs() {
            break;
        }
    }
    population.swap_remove(lowest_index(&population))
}

fn lowest_index(population: &[Minimum]) -> usize {
    (0..population.len()).fold(0, |best, i| {
        if population[i].cost < population[best].cost {
            i
        } else {
            best
        }
    })
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

/// First step along each coordinate, as a share of its range.
const FIRST_STEP: f64 = 0.05;
/// Spread of costs, as a share of the lowest, at which the simplex has closed.
const CLOSED: f64 = 1e-7;

/// Polishes `start` within `bounds` for at most `steps` moves of the simplex. Never worse than `start`.
///
/// # Source
/// Nelder and Mead 1965, coefficients 1, 2, 1/2, 1/2; a point outside the bounds is moved onto them.
fn polish(bounds: &[(f64, f64)], start: Minimum, steps: usize, cost: impl Cost) -> Minimum {
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

    fn many_valleys(p: &[f64], _limit: f64) -> f64 {
        p.iter()
            .map(|x| x * x + 3.0 * (1.0 - (4.0 * x).cos()))
            .sum()
    }

    #[test]
    fn the_deepest_of_many_valleys_is_found() {
        let found = minimise(&[(-5.0, 4.0), (-3.0, 6.0)], 20, 80, 1, many_valleys);
        assert!(found.cost < 1e-3, "{found:?}");
    }

    #[test]
    fn the_same_seed_gives_the_same_bytes() {
        let run = |seed| minimise(&[(-5.0, 4.0)], 8, 5, seed, many_valleys);
        assert_eq!(run(3), run(3));
        assert_ne!(run(3), run(4));
    }

    #[test]
    fn no_point_leaves_the_bounds() {
        let cost = |p: &[f64], _: f64| {
            assert!((1.0..=2.0).contains(&p[0]));
            p[0]
        };
        assert!(minimise(&[(1.0, 2.0)], 6, 40, 1, cost).point[0] < 1.01);
    }

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
        let all = [3.0, 1.0, 2.0, 1.0].map(|cost| Minimum {
            point: Vec::new(),
            cost,
        });
        assert_eq!(lowest_index(&all), 1);
        assert_eq!(lowest_index(&all[..1]), 0);
    }
}
