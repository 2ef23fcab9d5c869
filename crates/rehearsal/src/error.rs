//! What a rehearsal refuses.

use crate::unknown_car::UnknownCar;
use maveric_domain::{ConditionId, design::FEWEST_DONORS};

/// Why nothing could be rehearsed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RehearsalError {
    /// A population of drives that makes no sense.
    #[error("not a population of drives: {0}")]
    Population(String),
    /// A condition whose drives cannot be made up.
    #[error(
        "`condition.{condition}.car` cannot be rehearsed, since {why}; expected {{ dial = POINTS }}, {{ across = true }}, {{ mean = true }} or {{ other = \"matched\" }}"
    )]
    UnknownCar {
        /// Its id in the design.
        condition: ConditionId,
        /// What is not known of it.
        why: UnknownCar,
    },
    /// A study of so few that nearly everybody meets the same donor.
    #[error(
        "`condition.{condition}.car` lends somebody else's style: a study of {people} has {donors} who could lend theirs, expected {FEWEST_DONORS} or more"
    )]
    FewDonors {
        /// Its id in the design.
        condition: ConditionId,
        people: usize,
        /// All but the one to whom it is lent.
        donors: usize,
    },
    /// A population in which people differ along the line alone, and a condition that lends what lies across it.
    #[error(
        "`condition.{condition}.car` lends what lies across the aggression line, and the population's drives come of {found} trait, expected loadings on two or more"
    )]
    NothingAcross {
        /// Its id in the design.
        condition: ConditionId,
        /// Traits that its measures and its line take something of.
        found: usize,
    },
    /// A probe whose scale no file has.
    #[error("`protocol.probe.scale`: `{scale}`, and no scale has that id")]
    NoProbeScale {
        /// The id that the design names.
        scale: String,
    },
    /// A design without a drive by hand to compare with.
    #[error("a rehearsal needs a design with a baseline")]
    NoBaseline,
    /// A value that the nouns refuse.
    #[error(transparent)]
    Domain(#[from] maveric_domain::DomainError),
    /// Answers that cannot be scored.
    #[error(transparent)]
    Measure(#[from] maveric_measures::MeasureError),
    /// A study that cannot be analysed.
    #[error(transparent)]
    Analysis(#[from] maveric_analysis::AnalysisError),
    /// People that could not be made up.
    #[error(transparent)]
    Participants(#[from] maveric_participants::ParticipantError),
    /// A test that refuses its data.
    #[error(transparent)]
    Stats(#[from] maveric_stats::StatsError),
}
