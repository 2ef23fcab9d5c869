//! From an embedding and a window to what the controllers are asked for.

use crate::{
    error::ModelError,
    model::Model,
    network::{Networks, mlp::Mlp},
    scaling::{Scaling, Standardization},
    windows::{SIGNALS, WindowBuffer},
};
use maveric_domain::Embedding;
use pulp::Arch;

/// A multi-layer perceptron for one row: weights input by input, so that the sums run along the outputs.
#[derive(Debug, Clone)]
struct Network {
    layers: Vec<Layer>,
}

#[derive(Debug, Clone)]
struct Layer {
    /// Shape `(inputs, outputs)`.
    columns: Vec<f32>,
    biases: Vec<f32>,
}

impl Network {
    /// The layers of `mlp`, with the first inputs, `fixed`, folded into the first biases.
    fn new(mlp: &Mlp, parameters: &[f32], fixed: &[f64]) -> Self {
        let layers = mlp.layers().iter().enumerate().map(|(index, layer)| {
            let weights = layer.weights(parameters);
            let fixed = if index == 0 { fixed } else { &[] };
            let line = |output: usize| &weights[output * layer.inputs..(output + 1) * layer.inputs];
            let free = fixed.len()..layer.inputs;
            let columns = free.flat_map(|k| (0..layer.outputs).map(move |o| line(o)[k]));
            let biases = layer.biases(parameters).iter().enumerate().map(|(o, &b)| {
                let shift: f64 = fixed
                    .iter()
                    .zip(line(o))
                    .map(|(x, &w)| x * f64::from(w))
                    .sum();
                (f64::from(b) + shift) as f32
            });
            Layer {
                columns: columns.collect(),
                biases: biases.collect(),
            }
        });
        Self {
            layers: layers.collect(),
        }
    }

    fn run(&self, input: &[f32]) -> Vec<f32> {
        let mut x = input.to_vec();
        for (index, layer) in self.layers.iter().enumerate() {
            let mut y = layer.biases.clone();
            Arch::new().dispatch(|| {
                for (&x, column) in x.iter().zip(layer.columns.chunks_exact(y.len())) {
                    for (y, &w) in y.iter_mut().zip(column) {
                        *y += x * w;
                    }
                }
            });
            if index + 1 < self.layers.len() {
                for y in &mut y {
                    *y = y.max(0.0);
                }
            }
            x = y;
        }
        x
    }
}

/// F for one embedding.
#[derive(Debug, Clone)]
pub(crate) struct FollowingHead {
    network: Network,
    lead_speed: Standardization,
    distance: Standardization,
    learned: bool,
}

impl FollowingHead {
    pub(crate) fn new(model: &Model, embedding: &Embedding) -> Result<Self, ModelError> {
        model.check(embedding)?;
        let paper = model.paper()?;
        let head = &paper.networks.following_distance.head;
        Ok(Self {
            network: Network::new(head, &paper.parts.parameters, embedding.coordinates()),
            lead_speed: paper.scaling().signals[1],
            distance: paper.scaling().following_distance,
            learned: paper.learned().following_distance,
        })
    }

    /// f̂ in m, at least 0; 0 for a speed that is not a number, and from a model without F.
    pub(crate) fn distance_m(&self, lead_speed_mps: f64) -> f64 {
        if !(self.learned && lead_speed_mps.is_finite()) {
            return 0.0;
        }
        let input = self.lead_speed.apply(lead_speed_mps) as f32;
        let out = f64::from(self.network.run(&[input])[0]);
        let distance = self.distance.undo(out);
        if distance.is_finite() {
            distance.max(0.0)
        } else {
            0.0
        }
    }
}

/// What the networks say of the moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// v̂: speed to keep, in m/s.
    pub speed_mps: f64,
    /// f̂: bumper-to-bumper distance to keep behind the reference vehicle, in m.
    pub following_distance_m: f64,
    /// P(change): calibrated probability that a lane change starts within the next second.
    pub change_probability: f64,
}

/// The paper's networks with one driver's embedding built in; it needs neither afterwards.
///
/// # Source
/// Paper, "Low Level Controllers": the networks give parameters for controllers, never throttle or steering.
#[derive(Debug, Clone)]
pub struct Predictor {
    following: FollowingHead,
    lane_encoder: Network,
    lane_head: Network,
    speed_encoder: Network,
    speed_head: Network,
    scaling: Scaling,
    speed_range_mps: [f64; 2],
    log_odds_raised: f64,
    learned_lane_change: bool,
    steps: usize,
}

impl Predictor {
    /// Builds `embedding` into the networks of `model`.
    ///
    /// # Errors
    /// [`ModelError::OtherHeads`] if the model has no such networks, [`ModelError::EmbeddingSize`] if the embedding is not of the
    /// model's size.
    pub fn new(model: &Model, embedding: &Embedding) -> Result<Self, ModelError> {
        let following = FollowingHead::new(model, embedding)?;
        let paper = model.paper()?;
        let part = |which: fn(&Networks) -> &Mlp, fixed: &[f64]| {
            Network::new(which(&paper.networks), &paper.parts.parameters, fixed)
        };
        let w = embedding.coordinates();
        Ok(Self {
            following,
            lane_encoder: part(|n| &n.lane_change.encoded.encoder, &[]),
            lane_head: part(|n| &n.lane_change.encoded.head, w),
            speed_encoder: part(|n| &n.velocity.encoded.encoder, &[]),
            speed_head: part(|n| &n.velocity.encoded.head, w),
            scaling: *paper.scaling(),
            speed_range_mps: paper.speed_range_mps(),
            log_odds_raised: paper.parts.row_weights.log_odds_raised,
            learned_lane_change: paper.learned().lane_change,
            steps: paper.architecture().window_steps,
        })
    }

    /// v̂, f̂ and P(change) for the window that ends now.
    ///
    /// v̂ is kept within the speeds the model was trained on. P is calibrated: the probability that a lane change
    /// starts within the next second; 0 from a model without C. f̂ is as in [`Self::following_distance`].
    ///
    /// # Errors
    /// [`ModelError::EmptyWindow`], or [`ModelError::WindowLength`] if the buffer was made with other settings.
    pub fn predict(&self, window: &WindowBuffer) -> Result<Prediction, ModelError> {
        let window = window.window().ok_or(ModelError::EmptyWindow)?;
        let (found, expected) = (window.steps(), self.steps);
        if found != expected {
            return Err(ModelError::WindowLength { found, expected });
        }
        let signals = window
            .values()
            .chunks_exact(found)
            .zip(&self.scaling.signals);
        let input: Vec<f32> = signals
            .flat_map(|(values, s)| values.iter().map(|&v| s.apply(v) as f32))
            .collect();
        let read = (SIGNALS - 1) * found;
        let logits = self.lane_head.run(&self.lane_encoder.run(&input[..read]));
        let log_odds = f64::from(logits[1]) - f64::from(logits[0]) - self.log_odds_raised;
        let change_probability = if self.learned_lane_change {
            1.0 / (1.0 + (-log_odds).exp())
        } else {
            0.0
        };
        let code = self.speed_encoder.run(&input[input.len() - read..]);
        let speed = f64::from(self.speed_head.run(&code)[0]);
        let [low, high] = self.speed_range_mps;
        Ok(Prediction {
            speed_mps: self.scaling.signals[0].undo(speed).clamp(low, high),
            following_distance_m: self.following.distance_m(window.lead_speed_mps()),
            change_probability,
        })
    }

    /// f̂ behind a lead at `lead_speed_mps` (m/s), in m, 0 or more; a model that saw no following rows answers 0, which leaves
    /// the gap to the safety rule.
    pub fn following_distance(&self, lead_speed_mps: f64) -> f64 {
        self.following.distance_m(lead_speed_mps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        params::{TrainParams, TrainSettings},
        test_drives::drivers,
        train::{TrainingDrive, train},
        windows::WindowSettings,
    };
    use maveric_domain::{AdbScore, Drive};
    use std::ops::ControlFlow;

    fn trained(drives: &[(Drive, AdbScore)], epochs: usize) -> Model {
        let given: Vec<_> = drives
            .iter()
            .map(|(drive, adb)| TrainingDrive {
                drive,
                adb: Some(*adb),
            })
            .collect();
        let settings = TrainSettings {
            heads: crate::HeadsKind::Paper,
            epochs,
            batch_size: 128,
            ..TrainSettings::default()
        };
        let params = TrainParams::new(settings).unwrap();
        let go_on = &mut |_: &_| ControlFlow::Continue(());
        train(&given, &params, 1, go_on).unwrap().model
    }

    #[test]
    fn predictions_fit_the_drives_they_were_learned_from() {
        let drives = drivers(4, 200.0);
        let model = trained(&drives, 25);
        let [low, high] = model.paper().unwrap().speed_range_mps();
        let (mut expected_changes, mut true_changes) = (0.0, 0.0);
        let mut speed_error = 0.0;
        let mut n = 0.0;
        for ((drive, _), training) in drives.iter().zip(model.training()) {
            let predictor = Predictor::new(&model, &training.embedding).unwrap();
            let mut window = WindowBuffer::new(model.paper().unwrap().windows());
            for row in 0..drive.len() {
                window.push(&drive.situation(row).unwrap()).unwrap();
                let out = predictor.predict(&window).unwrap();
                assert!((low..=high).contains(&out.speed_mps));
                assert!(out.following_distance_m >= 0.0);
                let columns = drive.rows();
                let starting = columns.lane_change[row];
                if starting || columns.changing[row] == 0 {
                    expected_changes += out.change_probability;
                    true_changes += f64::from(u8::from(starting));
                }
                speed_error += (out.speed_mps - columns.ego_speed_mps[row]).powi(2);
                n += 1.0;
            }
        }
        // Calibrated: as many changes are expected as there are, within what a short training leaves open.
        let ratio = expected_changes / true_changes;
        assert!((0.5..2.0).contains(&ratio), "{ratio}");
        let rmse = (speed_error / n).sqrt();
        assert!(rmse < 2.5, "{rmse}");
        // The driver with the longer time gap keeps more distance.
        let at = |i: usize| {
            let w = &model.training()[i].embedding;
            Predictor::new(&model, w).unwrap().following_distance(23.0)
        };
        assert!(at(0) > at(3) + 5.0, "{} {}", at(0), at(3));
    }

    #[test]
    fn what_does_not_belong_to_the_model_is_refused() {
        let drives = drivers(2, 40.0);
        let model = trained(&drives, 1);
        let wrong = Embedding::new(vec![0.0; 2]).unwrap();
        assert!(matches!(
            Predictor::new(&model, &wrong),
            Err(ModelError::EmbeddingSize { .. })
        ));
        let predictor = Predictor::new(&model, model.mean_embedding()).unwrap();
        let window = WindowBuffer::new(model.paper().unwrap().windows());
        assert_eq!(predictor.predict(&window), Err(ModelError::EmptyWindow));
        let mut window = WindowBuffer::new(WindowSettings {
            window_s: 2.0,
            ..WindowSettings::default()
        });
        window.push(&drives[0].0.situation(0).unwrap()).unwrap();
        assert!(matches!(
            predictor.predict(&window),
            Err(ModelError::WindowLength { .. })
        ));
    }
}
