//! What stays of somebody as it was when they were let in, kept at hand: their steps are not read again to say where they are.

use crate::{person::Person, steps::Step};

/// A step as the experimenter reads of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct KnownStep {
    pub(crate) what: &'static str,
    /// How long is driven at most, in s; none where nothing is.
    pub(crate) seconds: Option<f64>,
}

/// Somebody as the experimenter reads of them.
#[derive(Debug)]
pub(crate) struct Known {
    pub(crate) participant: String,
    /// The conditions that they ride, in their order.
    pub(crate) rides: Vec<String>,
    pub(crate) steps: Vec<KnownStep>,
}

impl Known {
    pub(crate) fn of(person: &Person) -> Self {
        let step = |step: &Step| KnownStep {
            what: what(step),
            seconds: step.world().map(|(_, seconds)| seconds),
        };
        Self {
            participant: person.participant.clone(),
            rides: person.rides(),
            steps: person.steps.iter().map(step).collect(),
        }
    }
}

fn what(step: &Step) -> &'static str {
    match step {
        Step::Screen { .. } => "screening",
        Step::Text { .. } => "reading",
        Step::Scale { .. } => "questionnaire",
        Step::Controls => "controls",
        Step::Practice { .. } => "practice",
        Step::Drive { .. } => "driving",
        Step::Ride { .. } => "riding",
        Step::Aftercare { .. } => "stopped: aftercare",
        Step::Thanks { .. } => "thanks",
    }
}
