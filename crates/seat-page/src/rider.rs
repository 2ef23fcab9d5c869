//! A person's model as the driver of a ride, with a dial that may be turned on the way.

use crate::error::SeatPageError;
use maveric_domain::{Embedding, Setpoints};
use maveric_model::{Model, style_space::LinearHead};
use maveric_simulator::{ControllerSettings, Planner, View};
use maveric_steering::ModelPlanner;
use std::{cell::Cell, rc::Rc};

/// A style that drives; its dial is turned from outside.
#[derive(Debug)]
pub struct Rider {
    model: Rc<Model>,
    own: Embedding,
    settings: ControllerSettings,
    planner: ModelPlanner,
    dial: Rc<Cell<f64>>,
    turned_to: f64,
}

impl Rider {
    /// The style at `points` on the dial from `own`.
    ///
    /// # Errors
    /// [`SeatPageError::Model`] if the embedding is not of the model's size, or there is no dial to turn.
    pub fn new(
        model: Rc<Model>,
        own: Embedding,
        points: f64,
        settings: &ControllerSettings,
    ) -> Result<Self, SeatPageError> {
        let planner = ModelPlanner::new(&model, &at(&model, &own, points)?, settings)?;
        Ok(Self {
            model,
            own,
            settings: settings.clone(),
            planner,
            dial: Rc::new(Cell::new(points)),
            turned_to: points,
        })
    }

    /// The dial: what is set here is driven from the next row on.
    pub fn dial(&self) -> Rc<Cell<f64>> {
        Rc::clone(&self.dial)
    }

    /// The controllers that go with this rider.
    pub fn controllers(&self) -> ControllerSettings {
        self.planner.controllers()
    }
}

/// The embedding at `points` on the dial from `own`; `own` itself at 0, dial or not.
fn at(model: &Model, own: &Embedding, points: f64) -> Result<Embedding, SeatPageError> {
    if points.abs() <= 0.0 {
        return Ok(own.clone());
    }
    Ok(LinearHead::aggression(model)?.shift(own, points)?.embedding)
}

impl Planner for Rider {
    fn plan(&mut self, view: &View<'_>) -> Setpoints {
        let wanted = self.dial.get();
        if (wanted - self.turned_to).abs() > 0.0 {
            self.turned_to = wanted;
            // A dial that cannot be turned leaves the style where it is.
            let turned = at(&self.model, &self.own, wanted)
                .and_then(|w| Ok(ModelPlanner::new(&self.model, &w, &self.settings)?));
            if let Ok(planner) = turned {
                self.planner = planner;
            }
        }
        self.planner.plan(view)
    }
}
