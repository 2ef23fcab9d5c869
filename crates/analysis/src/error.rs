//! What an analysis refuses.

/// Why a study cannot be analysed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AnalysisError {
    /// Fewer people than any comparison needs.
    #[error("{found} people who are tested have an own drive, expected at least 3")]
    TooFewPeople {
        /// People with an own drive.
        found: usize,
    },
    /// A family of tests that names a scale without answers.
    #[error("the family names the scale `{scale}`, which nobody answered before the drives")]
    UnansweredScale {
        /// The scale.
        scale: String,
    },
    /// A family of tests that names a factor which its scale does not have.
    #[error("the family names `{scale}.{factor}`, but the factors of {scale} are {}", known.join(", "))]
    UnknownFactor {
        /// The scale.
        scale: String,
        /// The factor asked for.
        factor: String,
        /// Those that were scored.
        known: Vec<String>,
    },
    /// A test that refuses its data.
    #[error(transparent)]
    Stats(#[from] maveric_stats::StatsError),
    /// A value that the nouns refuse.
    #[error(transparent)]
    Domain(#[from] maveric_domain::DomainError),
}

impl AnalysisError {
    /// The next step, where one is known.
    pub fn suggestion(&self) -> Option<&'static str> {
        match self {
            Self::TooFewPeople { .. } => {
                Some("run the pipeline with more participants: --set study2=6")
            }
            Self::UnansweredScale { .. } | Self::UnknownFactor { .. } => Some(
                "declare the family by scales and factors that were answered before the drives: --family mini_ipip,mdsi",
            ),
            _ => None,
        }
    }
}
