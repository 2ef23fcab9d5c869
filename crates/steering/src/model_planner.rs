//! The learned model as a planner of the simulated car: window buffer, predictor and rule.

use crate::paper::PaperRule;
use maveric_domain::{Embedding, LaneWish, Setpoints};
use maveric_model::{Model, ModelError, Prediction, Predictor, WindowBuffer};
use maveric_simulator::{ControllerSettings, Planner, View};

/// Steers a simulated car as a driver would, from that driver's embedding.
#[derive(Debug)]
pub struct ModelPlanner {
    predictor: Predictor,
    buffer: WindowBuffer,
    rule: PaperRule,
    controllers: ControllerSettings,
    failure: Option<ModelError>,
}

impl ModelPlanner {
    /// Builds `embedding` into the networks of `model`; δ and Λ are those of `settings`.
    ///
    /// # Errors
    /// [`ModelError::EmbeddingSize`] if the embedding is not of the model's size.
    pub fn new(
        model: &Model,
        embedding: &Embedding,
        settings: &ControllerSettings,
    ) -> Result<Self, ModelError> {
        Ok(Self {
            predictor: Predictor::new(model, embedding)?,
            buffer: model.window_buffer(),
            rule: PaperRule::new(settings),
            controllers: settings.literal(),
            failure: None,
        })
    }

    /// The controllers that go with this planner: those given, and the paper's rule of following behind a probability.
    pub fn controllers(&self) -> ControllerSettings {
        self.controllers.clone()
    }

    /// The first situation that the model could not answer, if there was one: the drive then says nothing about
    /// the model and should not be kept.
    pub fn failure(self) -> Option<ModelError> {
        self.failure
    }

    fn predict(&mut self, view: &View<'_>) -> Result<Prediction, ModelError> {
        self.buffer.push(&view.situation())?;
        self.predictor.predict(&self.buffer)
    }
}

impl Planner for ModelPlanner {
    fn plan(&mut self, view: &View<'_>) -> Setpoints {
        match self.predict(view) {
            Ok(prediction) => Setpoints {
                speed_mps: prediction.speed_mps,
                following_distance_m: prediction.following_distance_m,
                wish: self.rule.wish(view, prediction.change_probability),
            },
            // A planner has to answer; what it answers after a failure only brings the drive to its end.
            Err(error) => {
                self.failure.get_or_insert(error);
                Setpoints {
                    speed_mps: view.scene.ego.speed_mps,
                    following_distance_m: view.reference.dx_m.max(0.0),
                    wish: LaneWish::Stay,
                }
            }
        }
    }
}
