//! What a rehearsal refuses.

/// Why nothing could be rehearsed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RehearsalError {
    /// A population of drives that makes no sense.
    #[error("not a population of drives: {0}")]
    Population(String),
    /// A condition whose drives cannot be made up.
    #[error(
        "`condition.{condition}.car`: what this car will do cannot be made up, expected {{ dial = POINTS }} or {{ across = true }} to rehearse"
    )]
    UnknownCar {
        /// Its id in the design.
        condition: maveric_domain::ConditionId,
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
    /// A design of roles alone.
    #[error("a rehearsal needs a design with at least one condition")]
    NoCondition,
    /// Effects under which the dial has no direction.
    #[error(
        "with these effects nobody perceives the high end of the dial as more aggressive than its middle, and the low end as less"
    )]
    NoDirection,
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
