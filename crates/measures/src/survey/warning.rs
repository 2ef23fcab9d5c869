//! What scoring leaves out, and what it doubts.

use maveric_domain::{Moment, ParticipantId};
use std::fmt;

/// What was left out of the scores, or is doubtful, and why.
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
    /// One answer to items of which some are reversed: it contradicts itself. Kept.
    OneAnswer {
        /// Who.
        participant: ParticipantId,
        /// When.
        moment: Moment,
        /// Code name of the scale.
        scale: String,
        /// As it was ticked, before any item is reversed.
        answer: i32,
        /// Items answered.
        items: u32,
    },
    /// The same answer to many items running. Kept.
    LongString {
        /// Who.
        participant: ParticipantId,
        /// When.
        moment: Moment,
        /// Code name of the scale.
        scale: String,
        /// As it was ticked, before any item is reversed.
        answer: i32,
        /// Items running.
        run: u32,
        /// The first of them.
        first: u32,
        /// Items of the scale.
        items: u32,
    },
    /// Answers given faster than the items can be read. Kept.
    TooFast {
        /// Who.
        participant: ParticipantId,
        /// When.
        moment: Moment,
        /// Code name of the scale.
        scale: String,
        /// Seconds an item, mean.
        seconds_an_item: f64,
    },
    /// Another answer than the one that an item asks for. Kept.
    AttentionMissed {
        /// Who.
        participant: ParticipantId,
        /// When.
        moment: Moment,
        /// Code name of the scale.
        scale: String,
        /// Its number in the scale.
        item: u32,
        /// What was ticked instead.
        answer: i32,
        /// The answer that it asks for.
        expected: i32,
    },
    /// Answers of somebody who is not in the study: left out.
    UnknownParticipant {
        /// Who.
        participant: ParticipantId,
        /// How many they gave.
        answers: usize,
    },
}

impl ScoreWarning {
    /// Whom it is about.
    pub fn participant(&self) -> &ParticipantId {
        match self {
            Self::NoAnswers { participant }
            | Self::Unanswered { participant, .. }
            | Self::TooFewAnswers { participant, .. }
            | Self::OneAnswer { participant, .. }
            | Self::LongString { participant, .. }
            | Self::TooFast { participant, .. }
            | Self::AttentionMissed { participant, .. }
            | Self::UnknownParticipant { participant, .. } => participant,
        }
    }
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
            Self::OneAnswer {
                participant,
                moment,
                scale,
                answer,
                items,
            } => write!(
                f,
                "participant {participant} ({moment}) answered all {items} items of `{scale}` with {answer}, reversed ones too: straight-lining? kept"
            ),
            Self::LongString {
                participant,
                moment,
                scale,
                answer,
                run,
                first,
                items,
            } => {
                let which = if run == items {
                    format!("to all {items} items of `{scale}`")
                } else {
                    format!("to {run} items of `{scale}` in a row, from item {first} (of {items})")
                };
                write!(
                    f,
                    "participant {participant} ({moment}) gave the answer {answer} {which}: straight-lining? kept"
                )
            }
            Self::TooFast {
                participant,
                moment,
                scale,
                seconds_an_item,
            } => write!(
                f,
                "participant {participant} ({moment}) answered `{scale}` in {seconds_an_item:.1} s an item, faster than it can be read: kept"
            ),
            Self::AttentionMissed {
                participant,
                moment,
                scale,
                item,
                answer,
                expected,
            } => write!(
                f,
                "participant {participant} ({moment}) answered item {item} of `{scale}` with {answer}, which asks for {expected}: not read? kept"
            ),
            Self::UnknownParticipant {
                participant,
                answers,
            } => {
                let s = if *answers == 1 { "" } else { "s" };
                write!(
                    f,
                    "{answers} answer{s} of {participant}, who is not in the study, left out"
                )
            }
        }
    }
}
