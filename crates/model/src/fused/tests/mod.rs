//! The kernel against the central differences of [`witness`].

mod witness;

use super::{
    batch::{At, Batches},
    layout::Layout,
    tile::{Known, Tile},
};
use crate::{
    losses::{LossWeights, Reading},
    network::{Architecture, Networks},
};
use pulp::Arch;
use rand::{RngExt as _, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use std::ops::Range;
use witness::Row;

/// Sizes that leave remainders everywhere.
const ODD: Architecture = Architecture {
    embedding_size: 3,
    hidden_units: 37,
    hidden_layers: 2,
    encoder_units: 21,
    encoding_size: 5,
    window_steps: 7,
};

const PAPER: Architecture = Architecture {
    embedding_size: 3,
    hidden_units: 64,
    hidden_layers: 2,
    encoder_units: 64,
    encoding_size: 16,
    window_steps: 20,
};

struct Problem {
    networks: Networks,
    rows: usize,
    drivers: usize,
    parameters: Vec<f32>,
    embeddings: Vec<f32>,
    driver_of: Vec<u32>,
    windows: Vec<f32>,
    noise: Vec<f32>,
    known: Vec<Known>,
}

impl Problem {
    fn new(architecture: Architecture, rows: usize, drivers: usize) -> Self {
        let networks = Networks::new(architecture);
        let mut rng = Pcg64Mcg::seed_from_u64(5);
        let parameters: Vec<f32> = networks.initialise(&mut rng);
        let mut normals = |n: usize| -> Vec<f32> {
            let draw = (0..n).map(|_| StandardNormal.sample(&mut rng));
            draw.collect()
        };
        let jitter = normals(parameters.len());
        let parameters = parameters.iter().zip(jitter);
        let parameters = parameters.map(|(p, n)| p + 0.05 * n).collect();
        let embeddings = normals(drivers * architecture.embedding_size);
        let windows = normals(rows * 4 * architecture.window_steps);
        let noise = normals(rows * architecture.embedding_size);
        let known = (0..rows).map(|row| {
            let v = normals(8);
            Known {
                values: [v[0], v[1], f32::from(u8::from(v[2] > 0.8)), v[3]],
                weights: [
                    v[4].max(0.0),
                    v[5].abs(),
                    f32::from(u8::from(row % 5 > 0)),
                    v[7].max(0.0),
                ],
            }
        });
        let known = known.collect();
        let driver_of = (0..rows).map(|_| rng.random_range(0..drivers as u32));
        Self {
            driver_of: driver_of.collect(),
            networks,
            rows,
            drivers,
            parameters,
            embeddings,
            windows,
            noise,
            known,
        }
    }

    fn fill(&self, tile: &mut Tile, rows: Range<usize>) {
        let numbers = self.windows.len() / self.rows;
        let d = self.noise.len() / self.rows;
        for (at, row) in rows.enumerate() {
            tile.windows.row_mut(at)[..numbers]
                .copy_from_slice(&self.windows[row * numbers..][..numbers]);
            tile.noise.row_mut(at)[..d].copy_from_slice(&self.noise[row * d..][..d]);
            tile.known[at] = self.known[row];
        }
    }

    /// The loss, the gradient by the native parameters, and that by the embeddings.
    fn fused(
        &self,
        arch: Arch,
        weights: LossWeights,
        reading: Reading,
    ) -> (f64, Vec<f32>, Vec<f32>) {
        let mut batches = Batches::new(arch, &self.networks, self.drivers, self.rows);
        let packed = batches.layout.pack(&self.parameters);
        let at = At { packed: &packed, embeddings: &self.embeddings, weights, reading };
        let driver = |row: usize| self.driver_of[row];
        let fill = |tile: &mut Tile, rows: Range<usize>| self.fill(tile, rows);
        // Twice: nothing of the batch before may be left.
        batches.evaluate(&at, self.rows, driver, fill);
        let sums = batches.evaluate(&at, self.rows, driver, fill);
        let loss = sums.weighted(&weights) / self.rows as f64;
        let gradient = batches.layout.unpack(&batches.gradient);
        (loss, gradient, batches.embedding_gradient)
    }

    /// Every row's loss by the witness, over the number of rows.
    fn witnessed(
        &self,
        parameters: &[f64],
        embeddings: &[f64],
        weights: &LossWeights,
        reading: Reading,
    ) -> Vec<f64> {
        let a = self.networks.architecture;
        let (d, numbers) = (a.embedding_size, 4 * a.window_steps);
        let loss = |row: usize| {
            let w = &embeddings[self.driver_of[row] as usize * d..][..d];
            let given = Row {
                window: &self.windows[row * numbers..][..numbers],
                noise: &self.noise[row * d..][..d],
                known: self.known[row],
            };
            witness::loss(&self.networks, parameters, w, &given, weights, reading)
                / self.rows as f64
        };
        (0..self.rows).map(loss).collect()
    }

    /// The loss by the witness, and its slopes in directions through all weights of a layer or all embeddings.
    fn slopes(&self, weights: LossWeights, reading: Reading) -> (f64, Vec<Slope>) {
        // Small against the distance to the next kink of a ReLU; rounding cancels as rows are compared one by one.
        const STEP: f64 = 1e-8;
        let mut rng = Pcg64Mcg::seed_from_u64(6);
        let parameters = doubles(&self.parameters);
        let embeddings = doubles(&self.embeddings);
        let at = self.witnessed(&parameters, &embeddings, &weights, reading);
        let layers = self.networks.all().into_iter().flatten();
        let places = layers.map(|layer| Some(layer.offset..layer.end()));
        let places = places.chain([None]).flat_map(|place| [place.clone(), place]);
        let slopes = places.map(|layer| {
            let size = layer.as_ref().map_or(embeddings.len(), ExactSizeIterator::len);
            let direction = StandardNormal.sample_iter(&mut rng).take(size);
            let direction: Vec<f64> = direction.collect();
            let losses = |step: f64| {
                let (mut parameters, mut embeddings) = (parameters.clone(), embeddings.clone());
                let moved = match &layer {
                    Some(layer) => &mut parameters[layer.clone()],
                    None => &mut embeddings[..],
                };
                for (value, by) in moved.iter_mut().zip(&direction) {
                    *value += step * by;
                }
                self.witnessed(&parameters, &embeddings, &weights, reading)
            };
            let (above, below) = (losses(STEP), losses(-STEP));
            let risen: f64 = above.iter().zip(&below).map(|(a, b)| a - b).sum();
            Slope { layer, direction, rise: risen / (2.0 * STEP) }
        });
        let slopes = slopes.collect();
        (at.iter().sum(), slopes)
    }
}

/// How the loss rises along a direction: numbers of N(0, 1) for every weight of a layer, or for every embedding.
struct Slope {
    layer: Option<Range<usize>>,
    direction: Vec<f64>,
    rise: f64,
}

fn doubles(values: &[f32]) -> Vec<f64> {
    values.iter().map(|&v| f64::from(v)).collect()
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| m.max(v.abs()))
}

/// Largest difference, as a share of the largest number.
fn apart(found: &[f32], expected: &[f64]) -> f64 {
    let pairs = found.iter().zip(expected);
    let differences: Vec<f64> = pairs.map(|(&a, b)| f64::from(a) - b).collect();
    largest(&differences) / largest(expected).max(1e-30)
}

/// Holds the kernel's loss and gradient against the witness's; along a direction through all of them one wrong weight
/// shows as well as many.
fn agrees(problem: &Problem, archs: &[Arch], weights: LossWeights, reading: Reading) {
    let (expected, slopes) = problem.slopes(weights, reading);
    for &arch in archs {
        let (loss, gradient, by_embeddings) = problem.fused(arch, weights, reading);
        assert!((loss - expected).abs() < 1e-5 * expected.abs(), "{loss} {expected}");
        for Slope { layer, direction, rise } in &slopes {
            let part = layer.clone().map_or(&by_embeddings[..], |l| &gradient[l]);
            let pairs = part.iter().zip(direction);
            let found: f64 = pairs.map(|(&g, d)| f64::from(g) * d).sum();
            let length = part.iter().map(|&g| f64::from(g).powi(2)).sum::<f64>();
            let tolerance = 1e-5 * length.sqrt() + 1e-7;
            assert!(
                (found - rise).abs() < tolerance,
                "{layer:?}: {found} {rise} ± {tolerance} ({weights:?}, {reading:?})"
            );
        }
    }
}

/// Every path that this processor has.
fn paths() -> Vec<Arch> {
    let mut paths = vec![Arch::Scalar];
    #[cfg(target_arch = "x86_64")]
    paths.extend(pulp::x86::V3::try_new().map(Arch::V3));
    paths.push(Arch::new());
    paths
}

const NONE: LossWeights = LossWeights {
    following_distance: 0.0,
    lane_change: 0.0,
    velocity: 0.0,
    aggression: 0.0,
    mutual_information: 0.0,
};

#[test]
fn the_kernel_has_the_losses_and_gradients_of_the_witness_on_every_path() {
    let problem = Problem::new(ODD, 301, 7);
    for reading in [Reading::Sample, Reading::Likelihood] {
        agrees(&problem, &paths(), LossWeights::default(), reading);
    }
    let paper = Problem::new(PAPER, 300, 5);
    let weights = LossWeights::default();
    agrees(&paper, &[Arch::new()], weights, Reading::Sample);
}

#[test]
fn every_loss_alone_reaches_the_sub_networks_it_is_of_and_no_other() {
    let problem = Problem::new(ODD, 60, 3);
    let alone = |change: fn(&mut LossWeights)| {
        let mut weights = NONE;
        change(&mut weights);
        agrees(&problem, &[Arch::new()], weights, Reading::Sample);
        let (_, gradient, by_embeddings) = problem.fused(Arch::new(), weights, Reading::Sample);
        assert!(by_embeddings.iter().any(|&g| g != 0.0));
        problem.networks.all().map(|mlp| {
            let first = mlp[0];
            gradient[first.offset..first.end()].iter().any(|&g| g != 0.0)
        })
    };
    // F, C's encoder and head, V's, S, M.
    let [yes, no] = [true, false];
    let reached = alone(|w| w.following_distance = 1.0);
    assert_eq!(reached, [yes, no, no, no, no, no, no]);
    let reached = alone(|w| w.lane_change = 1.0);
    assert_eq!(reached, [no, yes, yes, no, no, no, no]);
    let reached = alone(|w| w.velocity = 1.0);
    assert_eq!(reached, [no, no, no, yes, yes, no, no]);
    // L5 flows on through M into every predictor.
    assert_eq!(alone(|w| w.mutual_information = 1.0), [yes; 7]);
}

#[test]
fn vectors_of_every_width_give_the_same_bits_and_plain_code_the_same_to_rounding() {
    let problem = Problem::new(PAPER, 200, 4);
    let run = |arch| problem.fused(arch, LossWeights::default(), Reading::Sample);
    let all: Vec<_> = paths().into_iter().map(run).collect();
    for (_, gradient, by_w) in &all[2..] {
        assert!(*gradient == all[1].1 && *by_w == all[1].2);
    }
    let plain: Vec<f64> = all[0].1.iter().map(|&g| f64::from(g)).collect();
    assert!(apart(&all[1].1, &plain) < 1e-5);
}

#[test]
fn packing_and_unpacking_is_the_identity() {
    for architecture in [ODD, PAPER] {
        let problem = Problem::new(architecture, 1, 1);
        let layout = Layout::new(&problem.networks);
        let packed = layout.pack(&problem.parameters);
        assert_eq!(layout.unpack(&packed), problem.parameters);
    }
}
