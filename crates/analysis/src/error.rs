//! What an analysis refuses.

use maveric_domain::{ConditionId, ParticipantId};

/// Why a study cannot be analysed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AnalysisError {
    /// Fewer people than any comparison needs.
    #[error("{found} people who are tested drove or rated something, expected at least 3")]
    TooFewPeople {
        /// How many there are.
        found: usize,
    },
    /// A declared condition in which there is neither a drive nor an answer.
    #[error("nobody drove or rated the condition `{condition}`")]
    NobodyThere {
        /// Its id in the design.
        condition: ConditionId,
    },
    /// A declared outcome of which nobody has an answer about any condition.
    #[error("`[[outcome]]` names `{outcome}`, which nobody answered after any condition")]
    Unanswered {
        /// Its id: the measure or the score that it names.
        outcome: String,
    },
    /// A family of tests that names a scale without answers.
    #[error(
        "`[homophily] factors` names the scale `{scale}`, which nobody answered before the drives"
    )]
    UnansweredScale {
        /// Its name as the design writes it.
        scale: String,
    },
    /// A family of tests that names a factor which its scale does not have.
    #[error("`[homophily] factors` names `{scale}.{factor}`, but the factors of {scale} are {}", known.join(", "))]
    UnknownFactor {
        /// The scale, which has answers.
        scale: String,
        /// The factor asked for.
        factor: String,
        /// Those that were scored.
        known: Vec<String>,
    },
    /// A covariate that is no number.
    #[error(
        "the covariate `{column}` of `{participant}` is `{found}`, expected a number, or nothing where it is not known"
    )]
    NoNumber {
        /// Its column in the table of people.
        column: String,
        /// Whose it is.
        participant: ParticipantId,
        /// What stands there.
        found: String,
    },
    /// A declared contrast of a level that nobody has.
    #[error("`[contrasts] factors` names `{found}` of `{factor}`, expected one of {}", known.join(", "))]
    UnknownLevel {
        /// The factor that the contrast is of.
        factor: String,
        /// What the contrast names.
        found: String,
        /// What there is.
        known: Vec<String>,
    },
    /// A declared contrast of a factor that no test has.
    #[error("`[contrasts] factors` names `{factor}`, which is not tested as a factor, expected one of {}", known.join(", "))]
    UntestedFactor {
        /// What the contrast names as a factor.
        factor: String,
        /// Those that are tested.
        known: Vec<String>,
    },
    /// Contrasts of levels where one factor alone is tested.
    #[error("`[contrasts] factors` needs two factors, and the design has one: {factor}")]
    OneFactor {
        /// The only factor of the design.
        factor: String,
    },
    /// A declared test that takes no period, where orders are known.
    #[error(
        "`[[outcome]]` declares `test = \"{test}\"` of `{outcome}`, and the order in which {people} people met the conditions is known: \
         expected \"mixed\" or \"ordinal\", which take the period out"
    )]
    NoPeriod {
        /// Id of the outcome.
        outcome: String,
        /// The declared test, as the design writes it.
        test: &'static str,
        /// Whose order is known.
        people: usize,
    },
    /// A design without scores to learn from what people like.
    #[error(
        "the design does not say which scores tell how much people like a drive: it has no `[homophily] ratings`"
    )]
    NoRatings,
    /// Too little to learn a recommendation from.
    #[error("{problem}")]
    NothingToLearn {
        /// What was found and what was expected.
        problem: String,
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
            Self::TooFewPeople { .. } => Some(
                "`[people] test` of the design says who is tested; made-up people: generate --test 6",
            ),
            Self::NobodyThere { .. } => Some(
                "add its logs or answers, or take it out of the design: maveric status says what is there",
            ),
            Self::Unanswered { .. } => Some(
                "ask it after the conditions, or take it out of the design: rating_scores.csv has what was answered",
            ),
            Self::UnansweredScale { .. } | Self::UnknownFactor { .. } => Some(
                "name scales or SCALE.SUBSCALE that were answered before the drives under `[homophily] factors`",
            ),
            Self::NoNumber { .. } => Some(
                "mend the table of people, or declare the column under `[[factor]]`: it divides people by its words",
            ),
            Self::UnknownLevel { .. } => Some(
                "levels between people are those that stand in their table; within people, those of the conditions",
            ),
            Self::UntestedFactor { .. } => Some(
                "the conditions have to cross two factors completely, each combination of their `levels` once",
            ),
            Self::OneFactor { .. } => Some(
                "compare conditions by `[contrasts] compare`, or give every condition its `levels` of two factors",
            ),
            Self::NoPeriod { .. } => Some(
                "declare `test = \"mixed\"`; `rm-anova` and `friedman` are for studies in which nobody's order is known",
            ),
            Self::NoRatings => Some(
                "write them into the design: a table `[homophily]` with scales asked before the drives, such as `factors = [\"adb\"]`, and scores of \
                 scales asked after each ride, such as `ratings = [\"jian_trust.overall\"]`",
            ),
            Self::NothingToLearn { .. } => Some(
                "a recommendation needs a study with at least 6 people, own drives, all conditions and ratings",
            ),
            _ => None,
        }
    }
}
