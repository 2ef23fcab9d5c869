//! The kernel against [`crate::objective`], which is the same in `f64` and held against finite differences.

use super::{
    batch::{At, Batches},
    layout::Layout,
    tile::{Known, Tile},
};
use crate::{
    kernel,
    losses::{LossWeights, Reading},
    network::{Architecture, Networks},
    objective::{Inputs, Objective, Pass},
};
use pulp::Arch;
use rand::{RngExt as _, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use std::ops::Range;

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
        let at = At {
            packed: &packed,
            embeddings: &self.embeddings,
            weights,
            reading,
        };
        let driver = |row: usize| self.driver_of[row];
        let fill = |tile: &mut Tile, rows: Range<usize>| self.fill(tile, rows);
        // Twice: nothing of the batch before may be left.
        batches.evaluate(&at, self.rows, driver, fill);
        let sums = batches.evaluate(&at, self.rows, driver, fill);
        let loss = sums.weighted(&weights) / self.rows as f64;
        let gradient = batches.layout.unpack(&batches.gradient);
        (loss, gradient, batches.embedding_gradient)
    }

    /// The same by [`Objective`] in `f64`.
    fn reference(&self, weights: LossWeights, reading: Reading) -> (f64, Vec<f64>, Vec<f64>) {
        let a = self.networks.architecture;
        let d = a.embedding_size;
        let parameters: Vec<f64> = self.parameters.iter().map(|&p| f64::from(p)).collect();
        let objective = Objective {
            networks: &self.networks,
            parameters: &parameters,
            weights,
            reading,
            raw: None,
        };
        let mut gradient = vec![0.0; parameters.len()];
        let mut by_embeddings = vec![0.0; self.embeddings.len()];
        let mut loss = 0.0;
        let scale = 1.0 / self.rows as f64;
        for first in (0..self.rows).step_by(kernel::ROWS) {
            let mut pass = Pass::new(&self.networks);
            let mut inputs = Inputs::new(d);
            let numbers = 4 * a.window_steps;
            let mut windows = kernel::Tile::zeros(numbers);
            let mut w = kernel::Tile::zeros(d);
            let rows = first..(first + kernel::ROWS).min(self.rows);
            for (column, row) in rows.clone().enumerate() {
                let driver = self.driver_of[row] as usize;
                for k in 0..numbers {
                    let value = self.windows[row * numbers + k];
                    windows.feature_mut(k)[column] = f64::from(value);
                }
                for i in 0..d {
                    inputs.noise.feature_mut(i)[column] = f64::from(self.noise[row * d + i]);
                    w.feature_mut(i)[column] = f64::from(self.embeddings[driver * d + i]);
                }
                let Known { values, weights } = self.known[row];
                inputs.lead_speed.all_mut()[column] = f64::from(values[0]);
                for i in 0..3 {
                    inputs.targets.feature_mut(i)[column] = f64::from(values[i + 1]);
                }
                for (i, weight) in weights.into_iter().enumerate() {
                    inputs.weights.feature_mut(i)[column] = f64::from(weight);
                }
            }
            pass.set_windows(&windows);
            objective.encode(&mut pass);
            let sums = objective.evaluate(&w, &inputs, &mut pass, scale, Some(&mut gradient));
            objective.encoders_backward(&mut pass, &mut gradient);
            loss += sums.weighted(&weights) * scale;
            for (column, row) in rows.enumerate() {
                let driver = self.driver_of[row] as usize;
                for i in 0..d {
                    by_embeddings[driver * d + i] += pass.embedding_gradient.feature(i)[column];
                }
            }
        }
        (loss, gradient, by_embeddings)
    }
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

fn agrees(problem: &Problem, arch: Arch, weights: LossWeights, reading: Reading) {
    let (loss, gradient, by_embeddings) = problem.fused(arch, weights, reading);
    let (expected, by_parameters, by_w) = problem.reference(weights, reading);
    assert!(
        (loss - expected).abs() < 1e-5 * expected.abs(),
        "{loss} {expected}"
    );
    for mlp in problem.networks.all() {
        for layer in mlp.layers() {
            let range = layer.offset..layer.end();
            let off = apart(&gradient[range.clone()], &by_parameters[range]);
            assert!(off < 1e-5, "{layer:?}: {off} ({weights:?})");
        }
    }
    let off = apart(&by_embeddings, &by_w);
    assert!(off < 1e-5, "embeddings: {off}");
}

/// Every path that this processor has.
fn paths() -> Vec<Arch> {
    let mut paths = vec![Arch::Scalar];
    #[cfg(target_arch = "x86_64")]
    paths.extend(pulp::x86::V3::try_new().map(Arch::V3));
    paths.push(Arch::new());
    paths
}

#[test]
fn the_kernel_has_the_losses_and_gradients_of_the_objective_on_every_path() {
    let problem = Problem::new(ODD, 301, 7);
    for arch in paths() {
        for reading in [Reading::Sample, Reading::Likelihood] {
            agrees(&problem, arch, LossWeights::default(), reading);
        }
    }
    let paper = Problem::new(PAPER, 300, 5);
    agrees(&paper, Arch::new(), LossWeights::default(), Reading::Sample);
}

#[test]
fn without_l5_nothing_flows_back_through_m() {
    let problem = Problem::new(ODD, 50, 3);
    let weights = LossWeights {
        mutual_information: 0.0,
        ..LossWeights::default()
    };
    let (_, gradient, _) = problem.fused(Arch::new(), weights, Reading::Sample);
    let (_, expected, by_w) = problem.reference(weights, Reading::Sample);
    assert!(apart(&gradient, &expected) < 1e-5);
    assert!(largest(&by_w) > 0.0);
    let m = problem.networks.mutual_information.head.first();
    assert!(gradient[m.offset..m.end()].iter().all(|&g| g == 0.0));
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
