//! The paper's networks as set-points: window buffer, predictor and rule.

use crate::paper::PaperRule;
use maveric_domain::{Embedding, Setpoints};
use maveric_model::{Model, ModelError, Predictor, WindowBuffer};
use maveric_simulator::{ControllerSettings, View};

/// Asks the networks of one driver about every moment.
#[derive(Debug)]
pub(crate) struct NetworkRule {
    predictor: Predictor,
    buffer: WindowBuffer,
    rule: PaperRule,
}

impl NetworkRule {
    pub(crate) fn new(
        model: &Model,
        embedding: &Embedding,
        settings: &ControllerSettings,
    ) -> Result<Self, ModelError> {
        Ok(Self {
            predictor: Predictor::new(model, embedding)?,
            buffer: model.paper()?.window_buffer(),
            rule: PaperRule::new(settings),
        })
    }

    pub(crate) fn setpoints(&mut self, view: &View<'_>) -> Result<Setpoints, ModelError> {
        self.buffer.push(&view.situation())?;
        let prediction = self.predictor.predict(&self.buffer)?;
        Ok(Setpoints {
            speed_mps: prediction.speed_mps,
            following_distance_m: prediction.following_distance_m,
            wish: self.rule.wish(view, prediction.change_probability),
        })
    }
}
