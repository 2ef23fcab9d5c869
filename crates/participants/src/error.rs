//! What synthetic participants refuse.

use maveric_domain::{ConditionId, DomainError, ParticipantId};

/// Settings, effects or trials that make no sense.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParticipantError {
    /// A number outside its range, in the settings or in the file of effects.
    #[error("`{name}` is {found}, expected {expected}")]
    BadSetting {
        /// The key, with the tables it is in.
        name: String,
        found: f64,
        expected: &'static str,
    },
    /// A model for a subscale that no scale has.
    #[error("effects name subscale `{scale}.{subscale}`, which is in no scale")]
    UnknownSubscale {
        /// Code name of the scale.
        scale: String,
        /// Code name of the subscale.
        subscale: String,
    },
    /// Two models for one item.
    #[error("scale `{scale}`: item {item} belongs to two of the subscales with effects")]
    ItemTwice {
        /// Code name of the scale.
        scale: String,
        /// Its number in the scale.
        item: u32,
    },
    /// A scale with models for some items but not for this one.
    #[error("scale `{scale}`: item {item} belongs to none of the subscales with effects")]
    ItemWithoutModel {
        /// Code name of the scale.
        scale: String,
        /// Its number in the scale.
        item: u32,
    },
    /// A subscale with effects but without norms: nothing says how its answers are spread.
    #[error("subscale `{scale}.{subscale}` has effects but no norms in its scale's file")]
    NoNorms {
        /// Code name of the scale.
        scale: String,
        /// Code name of the subscale.
        subscale: String,
    },
    /// Norms that no answers can have.
    #[error("norms of `{scale}.{subscale}` ask for {problem}")]
    BadNorms {
        /// Code name of the scale.
        scale: String,
        /// Code name of the subscale, or `correlations`.
        subscale: String,
        problem: &'static str,
    },
    /// A condition rated twice, or one that is not rated.
    #[error("participant {participant}: condition {condition} {problem}")]
    BadTrial {
        participant: ParticipantId,
        /// Its id in the design.
        condition: ConditionId,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// A measure that is NaN or infinite.
    #[error("participant {participant}: measure `{measure}` is {found}, expected a finite number")]
    BadMeasure {
        participant: ParticipantId,
        /// Code name of the measure.
        measure: String,
        found: f64,
    },
    /// A questionnaire definition or an identifier that is refused.
    #[error(transparent)]
    Domain(#[from] DomainError),
}

/// Refuses a number outside `low` to `high`; `expected` are the words for the range.
pub(crate) fn within(
    name: &str,
    found: f64,
    low: f64,
    high: f64,
    expected: &'static str,
) -> Result<(), ParticipantError> {
    if (low..=high).contains(&found) {
        return Ok(());
    }
    Err(ParticipantError::BadSetting { name: name.to_owned(), found, expected })
}
