//! Who takes part.

use maveric_domain::ParticipantId;
use std::collections::BTreeMap;

/// Somebody in the table of people.
#[derive(Debug, Clone, PartialEq)]
pub struct Person {
    /// Who.
    pub id: ParticipantId,
    /// Whether the networks learn from their drives.
    pub learned: bool,
    /// Whether they sat through the conditions.
    pub tested: bool,
    /// Every further column: factors and covariates.
    pub columns: BTreeMap<String, String>,
}
