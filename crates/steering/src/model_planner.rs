//! The learned model as a planner of the simulated car, whichever heads it has.

use crate::{habits::HabitRule, networks::NetworkRule};
use maveric_domain::{Embedding, LaneWish, Setpoints};
use maveric_model::{Habits, HeadsKind, Model, ModelError};
use maveric_simulator::{ControllerSettings, Planner, View};

/// Steers a simulated car as a driver would, from that driver's embedding.
#[derive(Debug)]
pub struct ModelPlanner {
    rule: Rule,
    controllers: ControllerSettings,
    failure: Option<ModelError>,
}

#[derive(Debug)]
enum Rule {
    Habits(Box<HabitRule>),
    Networks(Box<NetworkRule>),
}

impl ModelPlanner {
    /// Builds `embedding` into the heads of `model`; the thresholds of the paper's networks are those of `settings`.
    ///
    /// # Errors
    /// [`ModelError::EmbeddingSize`] if the embedding is not of the model's size.
    pub fn new(
        model: &Model,
        embedding: &Embedding,
        settings: &ControllerSettings,
    ) -> Result<Self, ModelError> {
        let (rule, controllers) = match model.kind() {
            HeadsKind::Linear => {
                let habits = HabitRule::new(Habits::new(model, embedding)?, settings.clone());
                (Rule::Habits(Box::new(habits)), settings.clone())
            }
            HeadsKind::Paper => {
                let networks = NetworkRule::new(model, embedding, settings)?;
                (Rule::Networks(Box::new(networks)), settings.literal())
            }
        };
        Ok(Self { rule, controllers, failure: None })
    }

    /// The controllers that go with this planner: those given, with the paper's rule of following if the paper's networks plan.
    pub fn controllers(&self) -> ControllerSettings {
        self.controllers.clone()
    }

    /// The first situation that the model could not answer, if there was one: the drive then says nothing about
    /// the model and should not be kept.
    pub fn failure(self) -> Option<ModelError> {
        self.failure
    }
}

impl Planner for ModelPlanner {
    fn plan(&mut self, view: &View<'_>) -> Setpoints {
        let setpoints = match &mut self.rule {
            Rule::Habits(rule) => Ok(rule.setpoints(view)),
            Rule::Networks(rule) => rule.setpoints(view),
        };
        // A planner has to answer; what it answers after a failure only brings the drive to its end.
        setpoints.unwrap_or_else(|error| {
            self.failure.get_or_insert(error);
            Setpoints {
                speed_mps: view.scene.ego.speed_mps,
                following_distance_m: view.reference.dx_m.max(0.0),
                wish: LaneWish::Stay,
            }
        })
    }
}
