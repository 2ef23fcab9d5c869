//! What can be wrong with a questionnaire or with the answers to it.

use maveric_domain::{Moment, ParticipantId, survey::Item};

/// A questionnaire definition or an answer that is refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// Two definitions with one id.
    #[error("scale `{scale}` is defined twice")]
    ScaleTwice {
        /// The id.
        scale: String,
    },
    /// An answer to a scale that nobody defined.
    #[error(
        "participant {participant} ({moment}) answered scale `{scale}`; the scales known are {known}"
    )]
    UnknownScale {
        /// Who answered.
        participant: ParticipantId,
        /// When.
        moment: Moment,
        /// The scale's id.
        scale: String,
        /// The ids that are defined.
        known: Box<str>,
    },
    /// An answer to an item that the scale does not have.
    #[error(
        "participant {participant} ({moment}), scale `{scale}`: item {item} is not among its {items} items"
    )]
    UnknownItem {
        /// Who answered.
        participant: ParticipantId,
        /// When.
        moment: Moment,
        /// The scale's id.
        scale: String,
        /// Its number in the scale.
        item: u32,
        /// Number of items of the scale.
        items: u32,
    },
    /// An answer that the item does not have.
    #[error(
        "participant {participant} ({moment}), scale `{scale}`, item {item}: answer {found} is not in {}", asked.range()
    )]
    AnswerOutOfRange {
        /// Who answered.
        participant: ParticipantId,
        /// When.
        moment: Moment,
        /// The scale's id.
        scale: String,
        /// Its number in the scale.
        item: u32,
        /// The answer.
        found: i32,
        /// What the item asks for; boxed, as the other errors are small.
        asked: Box<Item>,
    },
    /// Two answers of one participant to one item at one moment.
    #[error("participant {participant} ({moment}), scale `{scale}`: item {item} is answered twice")]
    DoubleAnswer {
        /// Who answered.
        participant: ParticipantId,
        /// When.
        moment: Moment,
        /// The scale's id.
        scale: String,
        /// Its number in the scale.
        item: u32,
    },
}
