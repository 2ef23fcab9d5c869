//! From an embedding and a window to what the controllers are asked for.

use crate::{
    error::ModelError,
    model::Model,
    network::Mlp,
    paper::Learned,
    scaling::Scaling,
    windows::{SIGNALS, WindowBuffer},
};
use maveric_domain::Embedding;
use nalgebra::{DMatrix, DVector};

/// A multi-layer perceptron for one row: weights `(outputs, inputs)` and biases of each layer.
#[derive(Debug, Clone)]
struct Network(Vec<(DMatrix<f32>, DVector<f32>)>);

impl Network {
    fn new(mlp: &Mlp, parameters: &[f32]) -> Self {
        let layers = mlp.iter().map(|l| {
            let weights = DMatrix::from_row_slice(l.outputs, l.inputs, l.weights(parameters));
            (weights, DVector::from_column_slice(l.biases(parameters)))
        });
        Self(layers.collect())
    }

    /// Of `first` and then `then`.
    fn run(&self, first: &[f32], then: &[f32]) -> DVector<f32> {
        let both = first.iter().chain(then).copied();
        let mut x = DVector::from_iterator(first.len() + then.len(), both);
        for (index, (weights, biases)) in self.0.iter().enumerate() {
            let mut y = biases.clone();
            y.gemv(1.0, weights, &x, 1.0);
            if index + 1 < self.0.len() {
                y.apply(|y| *y = y.max(0.0));
            }
            x = y;
        }
        x
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
    /// In the coordinates of training.
    w: Vec<f32>,
    following: Network,
    lane_encoder: Network,
    lane_head: Network,
    speed_encoder: Network,
    speed_head: Network,
    scaling: Scaling,
    learned: Learned,
    speed_range_mps: [f64; 2],
    log_odds_raised: f64,
    steps: usize,
}

impl Predictor {
    /// Builds `embedding` into the networks of `model`.
    ///
    /// # Errors
    /// [`ModelError::OtherHeads`] if the model has no such networks, [`ModelError::EmbeddingSize`] if the embedding is not of the
    /// model's size.
    pub fn new(model: &Model, embedding: &Embedding) -> Result<Self, ModelError> {
        model.check(embedding)?;
        let paper = model.paper()?;
        let networks = paper.networks();
        let part = |mlp: &Mlp| Network::new(mlp, &paper.parameters);
        let w = paper.whitening.undo(embedding.coordinates());
        Ok(Self {
            w: w.iter().map(|&x| x as f32).collect(),
            following: part(&networks.following_distance),
            lane_encoder: part(&networks.lane_encoder),
            lane_head: part(&networks.lane_head),
            speed_encoder: part(&networks.speed_encoder),
            speed_head: part(&networks.speed_head),
            scaling: paper.scaling,
            learned: paper.learned,
            speed_range_mps: paper.speed_range_mps,
            log_odds_raised: paper.row_weights.log_odds_raised,
            steps: paper.architecture.window_steps,
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
        let signals = window.values().chunks_exact(found);
        let signals = signals.zip(&self.scaling.signals);
        let input: Vec<f32> =
            signals.flat_map(|(values, s)| values.iter().map(|&v| s.apply(v) as f32)).collect();
        let read = (SIGNALS - 1) * found;
        let code = self.lane_encoder.run(&input[..read], &[]);
        let logits = self.lane_head.run(&self.w, code.as_slice());
        let log_odds = f64::from(logits[1]) - f64::from(logits[0]) - self.log_odds_raised;
        let change_probability =
            if self.learned.lane_change { 1.0 / (1.0 + libm::exp(-log_odds)) } else { 0.0 };
        let code = self.speed_encoder.run(&input[input.len() - read..], &[]);
        let speed = f64::from(self.speed_head.run(&self.w, code.as_slice())[0]);
        let [low, high] = self.speed_range_mps;
        Ok(Prediction {
            speed_mps: self.scaling.signals[0].undo(speed).clamp(low, high),
            following_distance_m: self.following_distance(window.lead_speed_mps()),
            change_probability,
        })
    }

    /// f̂ behind a lead at `lead_speed_mps` (m/s), in m, 0 or more; a model that saw no following rows answers 0, which leaves
    /// the gap to the safety rule.
    pub fn following_distance(&self, lead_speed_mps: f64) -> f64 {
        if !(self.learned.following_distance && lead_speed_mps.is_finite()) {
            return 0.0;
        }
        let lead = self.scaling.signals[1].apply(lead_speed_mps) as f32;
        let out = f64::from(self.following.run(&self.w, &[lead])[0]);
        let distance = self.scaling.following_distance.undo(out);
        if distance.is_finite() { distance.max(0.0) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{params::TrainSettings, test_drives::drivers, windows::WindowSettings};
    use maveric_domain::{Drive, StyleScore};

    fn trained(drives: &[(Drive, StyleScore)], epochs: usize) -> Model {
        let settings = TrainSettings {
            heads: crate::HeadsKind::Paper,
            epochs,
            batch_size: 128,
            ..TrainSettings::default()
        };
        crate::train::tests::trained(drives, &settings)
    }

    #[test]
    fn predictions_fit_the_drives_they_were_learned_from() {
        let drives = drivers(4, 200.0);
        let model = trained(&drives, 25);
        let [low, high] = model.paper().unwrap().speed_range_mps;
        let (mut expected_changes, mut true_changes) = (0.0, 0.0);
        let mut speed_error = 0.0;
        let mut n = 0.0;
        for ((drive, _), training) in drives.iter().zip(model.training()) {
            let predictor = Predictor::new(&model, &training.embedding).unwrap();
            let mut window = model.paper().unwrap().window_buffer();
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
        assert!(matches!(Predictor::new(&model, &wrong), Err(ModelError::EmbeddingSize { .. })));
        let predictor = Predictor::new(&model, model.mean_embedding()).unwrap();
        let window = model.paper().unwrap().window_buffer();
        assert_eq!(predictor.predict(&window), Err(ModelError::EmptyWindow));
        let mut window =
            WindowBuffer::new(WindowSettings { window_s: 2.0, ..WindowSettings::default() });
        window.push(&drives[0].0.situation(0).unwrap()).unwrap();
        assert!(matches!(predictor.predict(&window), Err(ModelError::WindowLength { .. })));
    }
}
