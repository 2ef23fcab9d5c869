//! Who takes part.

use maveric_domain::{ConditionId, ParticipantId};
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
    /// The conditions in the order in which they met them; empty where it is not known.
    pub order: Vec<ConditionId>,
    /// Every further column: factors and covariates.
    pub columns: BTreeMap<String, String>,
}
