//! A person's model as the driver of a ride, with a dial that may be turned on the way.

use crate::error::SeatPageError;
use maveric_domain::{Embedding, Setpoints};
use maveric_model::Model;
use maveric_simulator::{ControllerSettings, Planner, View};
use maveric_steering::{ModelPlanner, RideStyle};
use std::{cell::Cell, rc::Rc};

/// A style that drives; its dial is turned from outside.
#[derive(Debug)]
pub struct Rider {
    model: Rc<Model>,
    own: Embedding,
    style: RideStyle,
    begins_with: Embedding,
    settings: ControllerSettings,
    planner: ModelPlanner,
    dial: Rc<Cell<f64>>,
    turned_to: f64,
}

impl Rider {
    /// A style for somebody whose own is `own`, at `points` on the dial.
    ///
    /// # Errors
    /// [`SeatPageError::Model`] if an embedding is not of the model's size, or there is no dial to turn.
    pub fn new(
        model: Rc<Model>,
        own: Embedding,
        (style, points): (RideStyle, f64),
        settings: &ControllerSettings,
    ) -> Result<Self, SeatPageError> {
        let begins_with = style.place(&model, &own, points)?.embedding;
        let planner = ModelPlanner::new(&model, &begins_with, settings)?;
        Ok(Self {
            model,
            own,
            style,
            begins_with,
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

    /// The style that the ride begins with.
    pub fn begins_with(&self) -> Embedding {
        self.begins_with.clone()
    }

    /// The controllers that go with this rider.
    pub fn controllers(&self) -> ControllerSettings {
        self.planner.controllers()
    }
}

impl Planner for Rider {
    fn plan(&mut self, view: &View<'_>) -> Setpoints {
        let wanted = self.dial.get();
        if (wanted - self.turned_to).abs() > 0.0 {
            self.turned_to = wanted;
            // A dial that cannot be turned leaves the style where it is.
            let turned = self.style.place(&self.model, &self.own, wanted);
            let turned =
                turned.and_then(|to| ModelPlanner::new(&self.model, &to.embedding, &self.settings));
            if let Ok(planner) = turned {
                self.planner = planner;
            }
        }
        self.planner.plan(view)
    }
}
