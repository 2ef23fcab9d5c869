//! What scoring leaves out, and what it doubts.

use maveric_domain::{Moment, ParticipantId};

/// What was left out of the scores, or is doubtful, and why.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScoreWarning {
    /// A participant of the study without any answer.
    #[error("participant {participant} answered no questionnaire")]
    NoAnswers {
        /// Who.
        participant: ParticipantId,
    },
    /// A scale that others answered at this moment.
    #[error("participant {participant} ({moment}) did not answer scale `{scale}`")]
    Unanswered {
        /// Who.
        participant: ParticipantId,
        /// When.
        moment: Moment,
        /// Code name of the scale.
        scale: String,
    },
    /// Fewer items answered than the scale asks for: the score is missing.
    #[error(
        "participant {participant} ({moment}) answered {answered} of {items} items of `{scale}` {subscale}: no score"
    )]
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
    #[error(
        "participant {participant} ({moment}) answered all {items} items of `{scale}` with {answer}, reversed ones too: \
         straight-lining? kept"
    )]
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
    #[error(
        "participant {participant} ({moment}) gave the answer {answer} {}: straight-lining? kept",
        running(*run, *first, *items, scale)
    )]
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
    #[error(
        "participant {participant} ({moment}) answered `{scale}` in {seconds_an_item:.1} s an item, faster than it can be read: kept"
    )]
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
    #[error(
        "participant {participant} ({moment}) answered item {item} of `{scale}` with {answer}, which asks for {expected}: not read? kept"
    )]
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
    #[error("{answers} answer{} of {participant}, who is not in the study, left out", if *answers == 1 { "" } else { "s" })]
    UnknownParticipant {
        /// Who.
        participant: ParticipantId,
        /// How many they gave.
        answers: usize,
    },
}

impl ScoreWarning {
    /// Whether it doubts answers that are scored all the same.
    pub fn is_kept(&self) -> bool {
        match self {
            Self::OneAnswer { .. }
            | Self::LongString { .. }
            | Self::TooFast { .. }
            | Self::AttentionMissed { .. } => true,
            Self::NoAnswers { .. }
            | Self::Unanswered { .. }
            | Self::TooFewAnswers { .. }
            | Self::UnknownParticipant { .. } => false,
        }
    }

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

fn running(run: u32, first: u32, items: u32, scale: &str) -> String {
    if run == items {
        return format!("to all {items} items of `{scale}`");
    }
    format!("to {run} items of `{scale}` in a row, from item {first} (of {items})")
}
