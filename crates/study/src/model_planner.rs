//! The learned model as a planner of the simulated car: window buffer and predictor.

use maveric_domain::{Embedding, Setpoints, Situation};
use maveric_model::{Model, ModelError, Predictor, WindowBuffer};
use maveric_simulator::Planner;

/// Steers a simulated car as a driver would, from that driver's embedding.
#[derive(Debug)]
pub struct ModelPlanner {
    predictor: Predictor,
    buffer: WindowBuffer,
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
        })
    }
}

impl Planner for ModelPlanner {
    fn plan(&mut self, situation: &Situation) -> Setpoints {
        let setpoints = self
            .buffer
            .push(situation)
            .and_then(|()| self.predictor.predict(&self.buffer));
        // The simulator's situations are finite and ordered in time; should one not be, the car keeps its speed
        // behind whatever is ahead and changes no lane.
        setpoints.unwrap_or(Setpoints {
            speed_mps: situation.ego_speed_mps,
            following_distance_m: situation.reference.dx_m.max(0.0),
            change_probability: 0.0,
        })
    }
}
