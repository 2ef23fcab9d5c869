//! Fitting an embedding to a driver's rows with frozen weights.

use super::{
    ClosedLoopNetwork, ClosedLoopSettings,
    lanes::LANES,
    segments::{OVERLAP, Segment, batches, overlapping, recorded, segment_steps},
    training::prior,
    unrolled::errors,
    world::{Batch, World},
};
use crate::{
    Stretch,
    search::{Cost, Descent, Minimum, polish},
};
use nalgebra::DMatrix;
use rayon::prelude::*;

/// How far an embedding may lie from the mean in each number; the prior's standard deviation is 1.
const REACH: f64 = 10.0;
/// Steps at most; it takes a few.
const MOST_STEPS: usize = 40;
/// The errors are reckoned in single precision: what is moved to see what they do must move them by more than that leaves out. A gain of
/// less than a ten-thousandth of the loss is none: going on moves no error of a gap by more than two thousandths.
const DESCENT: Descent = Descent {
    displaced: 5e-4,
    closed: 1e-4,
    damping: &[-7, -3, -1, 1],
};

/// Fits an embedding to a driver's rows from the mean, by the loss of the training, weights frozen: first over every row once, then over
/// segments that overlap.
pub(super) fn personalize(
    network: &ClosedLoopNetwork,
    driver: &Stretch<'_>,
    settings: &ClosedLoopSettings,
) -> Vec<f64> {
    let mean = &network.mean_embedding;
    let bounds: Vec<(f64, f64)> = mean.iter().map(|m| (m - REACH, m + REACH)).collect();
    let mut point = mean.clone();
    for share in [1, OVERLAP] {
        let cost = FromMean::new(network, driver, settings, share);
        let start = Minimum {
            cost: cost.costs(std::slice::from_ref(&point), &[f64::INFINITY])[0],
            point,
        };
        point = polish(&bounds, start, MOST_STEPS, &DESCENT, &cost).point;
    }
    point
}

/// The loss of a driver's segments, and how far an embedding lies from the mean.
struct FromMean<'a> {
    world: World<f32>,
    weights: Vec<f32>,
    mean: &'a [f64],
    prior: f64,
    batches: Vec<Batch<f32>>,
    /// Embeddings that drive abreast.
    copies: usize,
}

impl<'a> FromMean<'a> {
    /// Segments begin a share of a segment apart.
    fn new(
        network: &'a ClosedLoopNetwork,
        driver: &Stretch<'_>,
        settings: &ClosedLoopSettings,
        share: usize,
    ) -> Self {
        let alone = std::slice::from_ref(driver);
        let steps = segment_steps(alone, settings);
        let copies = network.mean_embedding.len() + 1;
        // Every segment as often as there are embeddings at once.
        let segments: Vec<Segment> = overlapping(alone, steps, share)
            .into_iter()
            .flat_map(|s| (0..copies).map(move |embedding| Segment { embedding, ..s }))
            .collect();
        Self {
            world: network.world.reckoned_in(),
            weights: network.weights.iter().map(|w| *w as f32).collect(),
            mean: &network.mean_embedding,
            prior: prior(driver, settings),
            batches: batches(&[recorded(driver)], &segments, steps),
            copies,
        }
    }

    /// What `reduce` makes of the errors of each batch, driven by at most as many embeddings as there are copies.
    fn each<T: Send>(
        &self,
        points: &[Vec<f64>],
        reduce: impl Fn(&Batch<f32>, &[[f32; LANES]]) -> T + Sync + Send,
    ) -> Vec<T> {
        // Copies without an embedding repeat the first.
        let numbers = (0..self.copies).flat_map(|copy| points.get(copy).unwrap_or(&points[0]));
        let embeddings: Vec<f32> = numbers.map(|number| *number as f32).collect();
        let one = |batch: &Batch<f32>| {
            let errors = errors(&self.world, &self.weights, &embeddings, batch);
            reduce(batch, &errors)
        };
        self.batches.par_iter().map(one).collect()
    }

    fn away(&self, point: &[f64]) -> impl Iterator<Item = f64> {
        let root = (0.5 * self.prior).sqrt();
        let away = point.iter().zip(self.mean);
        away.map(move |(number, mean)| root * (number - mean))
    }
}

impl Cost for FromMean<'_> {
    fn costs(&self, points: &[Vec<f64>], _: &[f64]) -> Vec<f64> {
        let some = |points: &[Vec<f64>]| {
            let mut costs: Vec<f64> = points
                .iter()
                .map(|point| self.away(point).map(|a| a * a).sum())
                .collect();
            let squares = self.each(points, |batch, errors| {
                let mut sums = [0.0; LANES];
                for error in errors {
                    for (sum, e) in sums.iter_mut().zip(error) {
                        *sum += e * e;
                    }
                }
                batch.embeddings.into_iter().zip(sums).collect::<Vec<_>>()
            });
            for (copy, square) in squares.into_iter().flatten() {
                if let Some(cost) = costs.get_mut(copy) {
                    *cost += f64::from(square);
                }
            }
            // What is no number is no minimum.
            let number = |cost: f64| if cost.is_nan() { f64::INFINITY } else { cost };
            costs.into_iter().map(number).collect::<Vec<_>>()
        };
        points.chunks(self.copies).flat_map(some).collect()
    }

    fn products(&self, points: &[Vec<f64>]) -> DMatrix<f64> {
        let of_lanes = self.each(points, |batch, errors| {
            let line = |l: usize| errors.iter().map(|error| error[l]).collect();
            let lines = (0..LANES).map(line);
            (batch.embeddings.into_iter().zip(lines)).collect::<Vec<(usize, Vec<f32>)>>()
        });
        // Every segment is driven by every copy, so that their lines keep step; at the end there may be lanes without weight.
        let mut lines: Vec<Vec<f32>> = vec![Vec::new(); points.len()];
        for (copy, line) in of_lanes.into_iter().flatten() {
            if let Some(of_copy) = lines.get_mut(copy) {
                of_copy.extend(line);
            }
        }
        let (first, others) = lines.split_at_mut(1);
        for line in others {
            for (error, base) in line.iter_mut().zip(&first[0]) {
                *error -= base;
            }
        }
        let away: Vec<Vec<f64>> = points.iter().map(|p| self.away(p).collect()).collect();
        let way = |i: usize, k: usize| {
            if i == 0 {
                away[0][k]
            } else {
                away[i][k] - away[0][k]
            }
        };
        DMatrix::from_fn(points.len(), points.len(), |a, b| {
            let (a, b) = (a.min(b), a.max(b));
            let prior: f64 = (0..self.mean.len()).map(|k| way(a, k) * way(b, k)).sum();
            2.0 * (product(&lines[a], &lines[b]) + prior)
        })
    }
}

/// The sum of the products of two lines, as far as both go.
fn product(a: &[f32], b: &[f32]) -> f64 {
    let both = a.len().min(b.len());
    let (a, b) = (&a[..both], &b[..both]);
    let mut sums = [0.0; LANES];
    let ((a, rest_a), (b, rest_b)) = (a.as_chunks(), b.as_chunks());
    for (a, b) in a.iter().zip(b) {
        let (a, b): (&[f32; LANES], &[f32; LANES]) = (a, b);
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    let rest = rest_a.iter().zip(rest_b).map(|(a, b)| a * b);
    sums.into_iter().chain(rest).map(f64::from).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FollowingRun, SAFETY, testing};

    #[test]
    fn no_embedding_beside_the_fitted_one_is_better() {
        let run = |t: f64| testing::driven_by_idm("P", testing::DRIVER.with_time_gap_s(t));
        let runs: Vec<FollowingRun> = [1.0, 1.6, 2.2].map(run).to_vec();
        let fits: Vec<Stretch<'_>> = runs.iter().map(FollowingRun::fit).collect();
        // One where batches are full of copies of a segment, one where they are not, and one where a segment fills more than one.
        for embedding_size in [3, 4, LANES] {
            let settings = ClosedLoopSettings {
                iterations: 40,
                embedding_size,
                ..ClosedLoopSettings::default()
            };
            let trained = ClosedLoopNetwork::train(&fits, &settings, SAFETY, 1).unwrap();
            let network = &trained.network;
            let own = personalize(network, &fits[2], &settings);
            let cost = FromMean::new(network, &fits[2], &settings, OVERLAP);
            let alone = |point: &Vec<f64>| cost.costs(std::slice::from_ref(point), &[0.0])[0];
            let least = alone(&own);
            assert!(least < 0.9 * alone(&network.mean_embedding));
            for k in 0..embedding_size {
                for by in [-0.2, 0.2] {
                    let mut beside = own.clone();
                    beside[k] += by;
                    assert!(least < alone(&beside), "{embedding_size}: {k} {by}");
                }
            }
            // Many at once cost what each does alone.
            let many: Vec<Vec<f64>> = (0..7)
                .map(|i| own.iter().map(|x| x + 0.1 * f64::from(i)).collect())
                .collect();
            let at_once = cost.costs(&many, &[0.0; 7]);
            for (point, found) in many.iter().zip(at_once) {
                assert!((found - alone(point)).abs() < 1e-9 * found);
            }
        }
    }
}
