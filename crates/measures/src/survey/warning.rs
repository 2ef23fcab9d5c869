//! What scoring leaves out.

use maveric_domain::{Moment, ParticipantId};
use std::fmt;

/// What was left out of the scores, and why.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ScoreWarning {
    /// A participant of the study without any answer.
    NoAnswers {
        /// Who.
        participant: ParticipantId,
    },
    /// A scale that others answered at this moment.
    Unanswered {
        /// Who.
        participant: ParticipantId,
        /// When.
        moment: Moment,
        /// Code name of the scale.
        scale: String,
    },
    /// Fewer items answered than the scale asks for: the score is missing.
    TooFewAnswers {
        /// Who.
        participant: ParticipantId,
        /// When.
        moment: Moment,
        /// Code name of the scale.
        scale: String,
        /// Code name of the subscale.
        subscale: String,
        /// Items answered.
        answered: u32,
        /// Items of the subscale.
        items: u32,
    },
    /// Answers of somebody who is not in the study: left out.
    UnknownParticipant {
        /// Who.
        participant: ParticipantId,
        /// Their answers.
        answers: usize,
    },
}

impl fmt::Display for ScoreWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoAnswers { participant } => {
                write!(f, "participant {participant} answered no questionnaire")
            }
            Self::Unanswered {
                participant,
                moment,
                scale,
            } => write!(
                f,
                "participant {participant} ({moment}) did not answer scale `{scale}`"
            ),
            Self::TooFewAnswers {
                participant,
                moment,
                scale,
                subscale,
                answered,
                items,
            } => write!(
                f,
                "participant {participant} ({moment}) answered {answered} of {items} items of `{scale}` {subscale}: no score"
            ),
            Self::UnknownParticipant {
                participant,
                answers,
            } => write!(
                f,
                "{answers} answers of {participant}, who is not in the study, left out"
            ),
        }
    }
}
