//! The learned model as a planner of the simulated car: window buffer and predictor.

use maveric_domain::{Embedding, Setpoints, Situation};
use maveric_model::{Model, ModelError, Predictor, WindowBuffer};
use maveric_simulator::Planner;

/// Steers a simulated car as a driver would, from that driver's embedding.
#[derive(Debug)]
pub struct ModelPlanner {
    predictor: Predictor,
    buffer: WindowBuffer,
    failure: Option<ModelError>,
}

impl ModelPlanner {
    /// Builds `embedding` into the networks of `model`.
    ///
    /// # Errors
    /// [`ModelError::EmbeddingSize`] if the embedding is not of the model's size.
    pub fn new(model: &Model, embedding: &Embedding) -> Result<Self, ModelError> {
        Ok(Self {
            predictor: Predictor::new(model, embedding)?,
            buffer: model.window_buffer(),
            failure: None,
        })
    }

    /// The first situation that the model could not answer, if there was one: the drive then says nothing about
    /// the model and should not be kept.
    pub fn failure(self) -> Option<ModelError> {
        self.failure
    }
}

impl Planner for ModelPlanner {
    fn plan(&mut self, situation: &Situation) -> Setpoints {
        let setpoints = self
            .buffer
            .push(situation)
            .and_then(|()| self.predictor.predict(&self.buffer));
        // A planner has to answer; what it answers after a failure only brings the drive to its end.
        setpoints.unwrap_or_else(|error| {
            self.failure.get_or_insert(error);
            Setpoints {
                speed_mps: situation.ego_speed_mps,
                following_distance_m: situation.reference.dx_m.max(0.0),
                change_probability: 0.0,
            }
        })
    }
}
