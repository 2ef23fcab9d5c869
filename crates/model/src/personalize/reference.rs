//! The objective once more, in plain double-precision loops that share nothing with the fast one: its witness.

use crate::{
    losses::MutualInformationLoss,
    model::Model,
    network::mlp::Mlp,
    params::{TrainParams, TrainSettings},
    rows::{Row, rows_of},
    test_drives::drivers,
    train::{TrainingDrive, train},
};
use maveric_domain::AdbScore;
use std::ops::ControlFlow;

/// A model and a driver's rows to fit.
pub(super) struct Problem {
    pub(super) name: &'static str,
    pub(super) model: Model,
    pub(super) rows: Vec<Row>,
    pub(super) adb: Option<AdbScore>,
}

impl Problem {
    pub(super) fn new(name: &'static str, adb: bool, change: impl Fn(&mut TrainSettings)) -> Self {
        let drives = drivers(4, 150.0);
        let given: Vec<_> = drives[1..]
            .iter()
            .map(|(drive, adb)| TrainingDrive {
                drive,
                adb: Some(*adb),
            })
            .collect();
        let mut settings = TrainSettings {
            epochs: 10,
            batch_size: 128,
            ..TrainSettings::default()
        };
        change(&mut settings);
        let params = TrainParams::new(settings).unwrap();
        let model = train(&given, &params, 1, &mut |_| ControlFlow::Continue(()))
            .unwrap()
            .model;
        let (drive, score) = &drives[0];
        Self {
            rows: rows_of(drive, &model.row_settings(), 1.0).unwrap(),
            name,
            model,
            adb: adb.then_some(*score),
        }
    }

    pub(super) fn all() -> Vec<Self> {
        vec![
            Self::new("defaults", true, |_| {}),
            Self::new(
                "one number, one hidden layer, raw coordinates",
                false,
                |s| {
                    s.embedding_size = 1;
                    s.hidden_layers = 1;
                    s.whiten = false;
                },
            ),
            Self::new("five numbers, three hidden layers, likelihood", true, |s| {
                s.embedding_size = 5;
                s.hidden_layers = 3;
                s.hidden_units = 19;
                s.encoding_size = 7;
                s.mutual_information_loss = MutualInformationLoss::GaussianLikelihood;
            }),
        ]
    }

    pub(super) fn points(&self) -> Vec<Vec<f64>> {
        let at = |k: usize| {
            (0..self.model.embedding_size())
                .map(|i| ((3 * i + 5 * k) as f64).sin())
                .collect()
        };
        (0..3).map(at).collect()
    }
}

/// L1 to L5 as a function of `w`, written as the method states them.
pub(super) struct Reference<'a> {
    model: &'a Model,
    rows: &'a [Row],
    adb: Option<AdbScore>,
}

impl<'a> Reference<'a> {
    pub(super) fn new(model: &'a Model, rows: &'a [Row], adb: Option<AdbScore>) -> Self {
        Self { model, rows, adb }
    }

    fn run(&self, mlp: &Mlp, input: Vec<f64>) -> Vec<f64> {
        let parameters = self.model.parameters();
        let mut x = input;
        for (index, layer) in mlp.layers().iter().enumerate() {
            let weights = layer.weights(parameters);
            let biases = layer.biases(parameters);
            assert_eq!(x.len(), layer.inputs);
            let y = (0..layer.outputs).map(|o| {
                let sum: f64 = (0..layer.inputs)
                    .map(|i| f64::from(weights[o * layer.inputs + i]) * x[i])
                    .sum();
                let y = f64::from(biases[o]) + sum;
                if index + 1 < mlp.layers().len() {
                    y.max(0.0)
                } else {
                    y
                }
            });
            x = y.collect();
        }
        x
    }

    pub(super) fn value(&self, w: &[f64]) -> f64 {
        let n = self.model.networks();
        let scaling = self.model.scaling();
        let loss_weights = self.model.active_weights();
        let d = w.len();
        let steps = self.model.architecture().window_steps;
        let raw = self.model.whitening().undo(w);
        let s_hat = self.run(&n.style.layer, w.to_vec())[0];
        let with = |w: &[f64], z: &[f64]| -> Vec<f64> { w.iter().chain(z).copied().collect() };
        let mut total = 0.0;
        let mut grid_rows = 0.0;
        for row in self.rows {
            let window: Vec<f64> = row
                .window
                .iter()
                .enumerate()
                .map(|(i, &v)| scaling.signals[i / steps].apply(v))
                .collect();
            let lead = scaling.signals[1].apply(row.lead_speed_mps);
            let z_l = self.run(&n.lane_change.encoded.encoder, window[..3 * steps].to_vec());
            let z_v = self.run(&n.velocity.encoded.encoder, window[steps..].to_vec());
            let f_hat = self.run(&n.following_distance.head, with(w, &[lead]))[0];
            let logits = self.run(&n.lane_change.encoded.head, with(w, &z_l));
            let v_hat = self.run(&n.velocity.encoded.head, with(w, &z_v))[0];
            let p = logits[1].exp() / (logits[0].exp() + logits[1].exp());
            let [c1, c2, c3, c5] = self.model.row_weights().of_row(row);
            grid_rows += c5;
            if let Some(gap) = row.following_distance_m {
                let target = scaling.following_distance.apply(gap);
                total += loss_weights.following_distance * c1 * (f_hat - target).powi(2);
            }
            let right = if row.lane_change == Some(true) {
                p
            } else {
                1.0 - p
            };
            total -= loss_weights.lane_change * c2 * right.ln();
            let target = scaling.signals[0].apply(row.ego_speed_mps);
            total += loss_weights.velocity * c3 * (v_hat - target).powi(2);
            let reads: Vec<f64> = std::iter::once(lead)
                .chain(z_l)
                .chain(z_v)
                .chain([f_hat, p, v_hat, s_hat])
                .collect();
            let m = self.run(&n.mutual_information.head, reads);
            let l5: f64 = (0..d)
                .map(|i| {
                    let (mean, log_sd) = (m[i], m[d + i].clamp(-6.0, 3.0));
                    match self.model.mutual_information_loss() {
                        MutualInformationLoss::MeanSquared => {
                            (mean - raw[i]).powi(2) + (2.0 * log_sd).exp()
                        }
                        MutualInformationLoss::GaussianLikelihood => {
                            0.5 * ((raw[i] - mean) / log_sd.exp()).powi(2) + log_sd
                        }
                    }
                })
                .sum();
            total += loss_weights.mutual_information * c5 * l5 / d as f64;
        }
        total /= grid_rows;
        if let Some(adb) = self.adb {
            let target = scaling.aggression.apply(adb.points());
            total += loss_weights.aggression * (s_hat - target).powi(2);
        }
        total
    }

    /// f̂ in m and v̂ in m/s at a row.
    pub(super) fn distance_and_speed(&self, w: &[f64], row: &Row) -> [f64; 2] {
        let n = self.model.networks();
        let scaling = self.model.scaling();
        let steps = self.model.architecture().window_steps;
        let window = row.window.iter().enumerate();
        let window: Vec<f64> = window
            .map(|(i, &v)| scaling.signals[i / steps].apply(v))
            .collect();
        let lead = scaling.signals[1].apply(row.lead_speed_mps);
        let with = |z: &[f64]| -> Vec<f64> { w.iter().chain(z).copied().collect() };
        let z_v = self.run(&n.velocity.encoded.encoder, window[steps..].to_vec());
        let distance = self.run(&n.following_distance.head, with(&[lead]))[0];
        let speed = self.run(&n.velocity.encoded.head, with(&z_v))[0];
        [
            scaling.following_distance.undo(distance),
            scaling.signals[0].undo(speed),
        ]
    }

    /// Derivative by coordinate `i`.
    pub(super) fn slope(&self, w: &[f64], i: usize) -> f64 {
        let at = |step: f64| {
            let mut w = w.to_vec();
            w[i] += step;
            self.value(&w)
        };
        // Small against the distance to the next kink of a ReLU, large against rounding.
        (at(1e-6) - at(-1e-6)) / 2e-6
    }
}
