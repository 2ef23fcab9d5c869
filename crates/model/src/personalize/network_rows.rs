//! The paper's losses over one driver's rows as a function of `w`, with slope and curvature.
//!
//! Windows are encoded once. A pass over the rows then carries, beside every layer's output, its derivatives by the few numbers of
//! `w` (forward mode); squared errors bend by Gauss and Newton.

use crate::{
    damped_newton::{Evaluated, Minimum, minimise},
    heads::{Family, Outcome, Posterior},
    network::mlp::Mlp,
    paper::PaperNetworks,
    rows::Row,
    scaling::Scaling,
    windows::SIGNALS,
};
use nalgebra::{DMatrix, DVector};

/// Length of the blocks of time that the covariance takes as independent, in s.
const BLOCK_S: f64 = 30.0;
/// Newton steps at most.
const STEPS: usize = 60;
/// Promised gain, as a share of the value, at which they end.
const TOLERANCE: f64 = 1e-7;
/// Least curvature for a covariance, as a share of the largest: below it the drive says nothing of a direction.
const FLAT: f64 = 1e-9;

/// Outputs of a layer for all rows, and their derivatives by each number of `w`; shape `(units, rows)` each.
#[derive(Debug, Clone)]
struct Dual {
    value: DMatrix<f32>,
    by_w: Vec<DMatrix<f32>>,
}

impl Dual {
    fn constant(value: DMatrix<f32>, d: usize) -> Self {
        let by_w = vec![DMatrix::zeros(value.nrows(), value.ncols()); d];
        Self { value, by_w }
    }

    /// One below the other.
    fn stacked(parts: &[&Self]) -> Self {
        let stack = |of: &dyn Fn(&Self) -> DMatrix<f32>| {
            let parts: Vec<DMatrix<f32>> = parts.iter().map(|p| of(p)).collect();
            let rows = parts.iter().map(DMatrix::nrows).sum();
            let mut all = DMatrix::zeros(rows, parts[0].ncols());
            let mut from = 0;
            for part in &parts {
                all.rows_mut(from, part.nrows()).copy_from(part);
                from += part.nrows();
            }
            all
        };
        Self {
            value: stack(&|p| p.value.clone()),
            by_w: (0..parts[0].by_w.len())
                .map(|k| stack(&|p| p.by_w[k].clone()))
                .collect(),
        }
    }

    /// Through a perceptron: ReLU between its layers.
    fn through(&self, mlp: &Mlp, parameters: &[f32]) -> Self {
        let mut x = self.clone();
        for (index, layer) in mlp.layers().iter().enumerate() {
            let weights =
                DMatrix::from_row_slice(layer.outputs, layer.inputs, layer.weights(parameters));
            let mut value = &weights * &x.value;
            for mut column in value.column_iter_mut() {
                for (y, b) in column.iter_mut().zip(layer.biases(parameters)) {
                    *y += b;
                }
            }
            let mut by_w: Vec<DMatrix<f32>> = x.by_w.iter().map(|t| &weights * t).collect();
            if index + 1 < mlp.layers().len() {
                for t in &mut by_w {
                    t.zip_apply(&value, |t, y| *t = if y > 0.0 { *t } else { 0.0 });
                }
                value.apply(|y| *y = y.max(0.0));
            }
            x = Self { value, by_w };
        }
        x
    }

    fn row(&self, row: usize) -> Self {
        Self {
            value: self.value.rows(row, 1).into_owned(),
            by_w: self
                .by_w
                .iter()
                .map(|t| t.rows(row, 1).into_owned())
                .collect(),
        }
    }
}

/// Takes one term of the losses: which loss, its row if it has one, its weight, the loss by the output, the output by `w`.
type Take<'t> = dyn FnMut(usize, Option<usize>, f64, Term, &[f64]) + 't;

/// One driver's rows, encoded.
#[derive(Debug)]
pub(crate) struct NetworkRows<'a> {
    paper: &'a PaperNetworks,
    lead_speed: DMatrix<f32>,
    lane_context: DMatrix<f32>,
    speed_context: DMatrix<f32>,
    /// Targets of F, C and V of each row.
    targets: Vec<[f64; 3]>,
    /// Weights of each row in L1, L2, L3 and L5.
    weights: Vec<[f64; 4]>,
    /// Block of time of each row.
    block: Vec<usize>,
    grid_rows: f64,
    /// Standardised score.
    score: Option<f64>,
}

impl<'a> NetworkRows<'a> {
    /// Encodes `rows`; `points` is a score to read too.
    pub(crate) fn new(paper: &'a PaperNetworks, rows: &[Row], points: Option<f64>) -> Self {
        let parts = &paper.parts;
        let Scaling {
            signals,
            following_distance,
            aggression,
        } = parts.scaling;
        let steps = parts.architecture.window_steps;
        let windows = DMatrix::from_fn(SIGNALS * steps, rows.len(), |i, r| {
            signals[i / steps].apply(rows[r].window[i]) as f32
        });
        let encode = |from: usize, mlp: &Mlp| {
            let read = windows.rows(from, (SIGNALS - 1) * steps).into_owned();
            Dual::constant(read, 0)
                .through(mlp, &parts.parameters)
                .value
        };
        let of_block = ((BLOCK_S * parts.row_rate_hz).round() as usize).max(1);
        let mut grid = 0_usize;
        let mut block = Vec::with_capacity(rows.len());
        for row in rows {
            grid += usize::from(row.on_grid);
            block.push(grid.saturating_sub(1) / of_block);
        }
        let targets = |row: &Row| {
            [
                row.following_distance_m
                    .map_or(0.0, |m| following_distance.apply(m)),
                f64::from(u8::from(row.lane_change == Some(true))),
                signals[0].apply(row.ego_speed_mps),
            ]
        };
        Self {
            lead_speed: DMatrix::from_fn(1, rows.len(), |_, r| {
                signals[1].apply(rows[r].lead_speed_mps) as f32
            }),
            lane_context: encode(0, &paper.networks.lane_change.encoded.encoder),
            speed_context: encode(steps, &paper.networks.velocity.encoded.encoder),
            targets: rows.iter().map(targets).collect(),
            weights: rows
                .iter()
                .map(|row| parts.row_weights.of_row(row))
                .collect(),
            block,
            grid_rows: grid.max(1) as f64,
            score: points.map(|p| aggression.apply(p)),
            paper,
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.targets.len()
    }

    /// The mean of each of L1, L2 and L3 over the rows that it concerns, weighted as in training; `None` without any.
    pub(crate) fn losses(&self, w: &[f64]) -> [Option<f64>; 3] {
        let mut sums = [(0.0, 0.0); 3];
        self.pass(w, &mut |loss, _, weight, value, _| {
            if let Some(sum) = sums.get_mut(loss) {
                *sum = (sum.0 + weight * value.value, sum.1 + weight);
            }
        });
        sums.map(|(loss, weight): (f64, f64)| (weight > 0.0).then(|| loss / weight))
    }

    /// The weighted sum of the losses.
    #[cfg(test)]
    pub(crate) fn objective(&self, w: &[f64]) -> f64 {
        self.evaluate(w).0.value
    }

    /// The minimum from `from` on, with the covariance of its place, and the steps taken.
    pub(crate) fn solve(&self, from: &[f64]) -> (Posterior, usize) {
        let Minimum {
            at,
            there,
            iterations,
        } = minimise(|w| self.evaluate(w).0, from.to_vec(), TOLERANCE, STEPS);
        let d = at.len();
        let (_, slopes) = self.evaluate(&at);
        let curvature = DMatrix::from_row_slice(d, d, &there.curvature);
        let eigen = curvature.clone().symmetric_eigen();
        let determined =
            eigen.eigenvalues.min() > FLAT * eigen.eigenvalues.max() && slopes.len() > d + 1;
        let covariance = curvature
            .try_inverse()
            .filter(|_| determined)
            .map(|inverse| {
                let mut spread = DMatrix::zeros(d, d);
                for slope in &slopes {
                    spread += slope * slope.transpose();
                }
                let covariance = &inverse * spread * &inverse;
                covariance.iter().copied().collect()
            });
        let posterior = Posterior {
            mean: at,
            covariance: covariance.unwrap_or_default(),
        };
        (posterior, iterations)
    }

    /// The weighted sum of the losses, and the slope of each block's part.
    fn evaluate(&self, w: &[f64]) -> (Evaluated, Vec<DVector<f64>>) {
        let d = w.len();
        let lambda = self.paper.active_weights();
        let of_loss = [
            lambda.following_distance,
            lambda.lane_change,
            lambda.velocity,
            lambda.mutual_information / d as f64,
            lambda.aggression,
        ];
        let blocks = self.block.last().map_or(0, |b| b + 1);
        let mut slopes = vec![DVector::zeros(d); blocks];
        let mut there = Evaluated {
            value: 0.0,
            gradient: vec![0.0; d],
            curvature: vec![0.0; d * d],
        };
        self.pass(w, &mut |loss, row, weight, value, by_w| {
            let rows = if loss == SCORE { 1.0 } else { self.grid_rows };
            let c = of_loss[loss] * weight / rows;
            there.value += c * value.value;
            for (i, a) in by_w.iter().enumerate() {
                there.gradient[i] += c * value.slope * a;
                if let Some(block) = row.map(|r| self.block[r]) {
                    slopes[block][i] += c * value.slope * a;
                }
                for (j, b) in by_w.iter().enumerate() {
                    there.curvature[i * d + j] += c * value.curvature * a * b;
                }
            }
        });
        (there, slopes)
    }

    /// Gives every term of the losses.
    fn pass(&self, w: &[f64], give: &mut Take<'_>) {
        let (parts, networks) = (&self.paper.parts, &self.paper.networks);
        let d = w.len();
        let n = self.len();
        let parameters = parts.parameters.as_slice();
        let mut style = Dual::constant(DMatrix::from_fn(d, n, |i, _| w[i] as f32), d);
        for (k, by) in style.by_w.iter_mut().enumerate() {
            by.row_mut(k).fill(1.0);
        }
        let with = |read: &DMatrix<f32>| Dual::constant(read.clone(), d);
        let run = |read: &Dual, mlp: &Mlp| Dual::stacked(&[&style, read]).through(mlp, parameters);
        let lane = with(&self.lane_context);
        let speed = with(&self.speed_context);
        let lead = with(&self.lead_speed);
        let distance = run(&lead, &networks.following_distance.head);
        let logits = run(&lane, &networks.lane_change.encoded.head);
        let velocity = run(&speed, &networks.velocity.encoded.head);
        let (keep, change) = (logits.row(0), logits.row(1));
        let odds = Dual {
            value: &change.value - &keep.value,
            by_w: change
                .by_w
                .iter()
                .zip(&keep.by_w)
                .map(|(a, b)| a - b)
                .collect(),
        };
        let column = |of: &Dual, r: usize, scale: f64| -> Vec<f64> {
            of.by_w
                .iter()
                .map(|t| scale * f64::from(t[(0, r)]))
                .collect()
        };
        for r in 0..n {
            let [to_distance, to_change, to_speed] = self.targets[r];
            let [in_distance, in_change, in_speed, _] = self.weights[r];
            for (loss, output, target, weight) in [
                (0, &distance, to_distance, in_distance),
                (2, &velocity, to_speed, in_speed),
            ] {
                if weight > 0.0 {
                    let term = squared(f64::from(output.value[(0, r)]) - target);
                    give(loss, Some(r), weight, term, &column(output, r, 1.0));
                }
            }
            if in_change > 0.0 {
                let found = Family::Logistic.loss(
                    Outcome::Value(to_change),
                    f64::from(odds.value[(0, r)]),
                    1.0,
                );
                let term = Term {
                    value: found.value,
                    slope: found.slope,
                    curvature: found.curvature,
                };
                give(1, Some(r), in_change, term, &column(&odds, r, 1.0));
            }
        }
        let score = style.through(&networks.style.layer, parameters);
        if let (Some(target), true) = (self.score, n > 0) {
            let term = squared(f64::from(score.value[(0, 0)]) - target);
            give(SCORE, None, 1.0, term, &column(&score, 0, 1.0));
        }
        if self.paper.active_weights().mutual_information <= 0.0 {
            return;
        }
        let p = odds.value.map(|x| 1.0 / (1.0 + (-x).exp()));
        let chance = Dual {
            by_w: odds
                .by_w
                .iter()
                .map(|t| t.zip_map(&p, |t, p| t * p * (1.0 - p)))
                .collect(),
            value: p,
        };
        let reads = Dual::stacked(&[&lead, &lane, &speed, &distance, &chance, &velocity, &score]);
        let read = reads.through(&networks.mutual_information.head, parameters);
        let raw = parts.whitening.undo(w);
        for r in 0..n {
            let weight = self.weights[r][3];
            if weight <= 0.0 {
                continue;
            }
            for (i, raw) in raw.iter().enumerate() {
                // In expectation over M's sample: the square of its mean's error, and its variance.
                let root = &parts.whitening.root[i * d..(i + 1) * d];
                let mut by_w = column(&read.row(i), r, 1.0);
                by_w.iter_mut().zip(root).for_each(|(b, root)| *b -= root);
                let error = f64::from(read.value[(i, r)]) - raw;
                give(3, Some(r), weight, squared(error), &by_w);
                let sd = f64::from(read.value[(d + i, r)]).exp();
                give(
                    3,
                    Some(r),
                    weight,
                    squared(sd),
                    &column(&read.row(d + i), r, sd),
                );
            }
        }
    }
}

/// Where L4 stands among the losses; it has no row.
const SCORE: usize = 4;

/// A loss by the output it is taken of.
#[derive(Debug, Clone, Copy)]
struct Term {
    value: f64,
    slope: f64,
    curvature: f64,
}

fn squared(error: f64) -> Term {
    Term {
        value: error * error,
        slope: 2.0 * error,
        curvature: 2.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        model::HeadsKind,
        params::{TrainParams, TrainSettings},
        rows::rows_of,
        test_drives::drivers,
        train::{TrainingDrive, train},
    };
    use std::ops::ControlFlow;

    #[test]
    fn the_slope_is_that_of_the_value_and_the_minimum_is_one() {
        let drives = drivers(3, 120.0);
        let given: Vec<_> = drives
            .iter()
            .map(|(drive, adb)| TrainingDrive {
                drive,
                adb: Some(*adb),
            })
            .collect();
        let settings = TrainSettings {
            heads: HeadsKind::Paper,
            epochs: 6,
            batch_size: 64,
            validation_fraction: 0.0,
            ..TrainSettings::default()
        };
        let params = TrainParams::new(settings).unwrap();
        let model = train(&given, &params, 1, &mut |_| ControlFlow::Continue(()))
            .unwrap()
            .model;
        let paper = model.paper().unwrap();
        let rows = rows_of(&drives[0].0, &paper.row_settings(), 1.0).unwrap();
        let rows = NetworkRows::new(paper, &rows, Some(30.0));
        let at = [0.2, -0.3, 0.4];
        let h = 2e-4;
        for i in 0..3 {
            let value = |by: f64| {
                let mut w = at;
                w[i] += by;
                rows.evaluate(&w).0.value
            };
            let slope = (value(h) - value(-h)) / (2.0 * h);
            let (there, blocks) = rows.evaluate(&at);
            assert!(
                (there.gradient[i] - slope).abs() < 0.02 * (1.0 + slope.abs()),
                "{slope} {there:?}"
            );
            assert!(blocks.len() > 3);
        }
        let from = model.mean_embedding().coordinates();
        let (found, _) = rows.solve(from);
        let lowest = rows.evaluate(&found.mean).0.value;
        assert!(lowest < rows.evaluate(from).0.value);
        for i in 0..3 {
            for by in [-0.05, 0.05] {
                let mut w = found.mean.clone();
                w[i] += by;
                assert!(rows.evaluate(&w).0.value > lowest - 1e-5);
            }
        }
    }
}
