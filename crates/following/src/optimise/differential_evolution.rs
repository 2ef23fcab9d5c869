//! Differential evolution: a wide search that needs no start.

use super::{Cost, Minimum};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Probability that a trial takes a coordinate from the mutant.
const CROSSOVER: f64 = 0.9;
/// Spread of costs, as a share of the lowest, at which the members have met.
const CONVERGED: f64 = 1e-3;

/// Searches `bounds` by rand/1/bin with a weight drawn from 0.5..1 for each trial.
///
/// A member is replaced as soon as a trial is better, within the generation. At least four members.
pub(crate) fn minimise(
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
}
