//! What stays of somebody as it was when they were let in, kept at hand: their steps are not read again to say where they are.

use crate::{person::Person, steps::Step};

/// A step as the experimenter reads of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct KnownStep {
    /// The name of the sentence that says what it is.
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
    /// The language that they chose; none where nobody was asked.
    pub(crate) language: Option<String>,
}

impl Known {
    pub(crate) fn from_person(person: &Person) -> Self {
        let step = |step: &Step| KnownStep {
            what: what(step),
            seconds: step.world().map(|(_, seconds)| seconds),
        };
        Self {
            participant: person.participant.clone(),
            rides: person.rides(),
            language: person.language().map(str::to_owned),
            steps: person.steps.iter().map(step).collect(),
        }
    }
}

fn what(step: &Step) -> &'static str {
    match step {
        Step::Language { .. } => "lab_language",
        Step::Computer { .. } => "lab_computer",
        Step::Screen { .. } => "lab_screening",
        Step::Text { .. } => "lab_reading",
        Step::Scale { .. } => "lab_questionnaire",
        Step::Break { .. } => "lab_break",
        Step::Controls => "lab_controls",
        Step::Practice { .. } => "lab_practice",
        Step::Drive { .. } => "lab_driving",
        Step::Ride { .. } => "lab_riding",
        Step::Between { .. } => "lab_between",
        Step::Elsewhere { .. } => "lab_elsewhere",
        Step::Aftercare { .. } => "lab_aftercare",
        Step::Thanks { .. } => "lab_thanks",
    }
}
