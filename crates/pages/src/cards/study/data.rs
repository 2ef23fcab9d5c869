//! What the cards of a study are made from.

use crate::words;
use maveric_analysis::Analysis;
use maveric_domain::{ConditionId, ConditionRow, Design};

/// What the cards of a study are made from.
#[derive(Debug, Clone, Copy)]
pub struct Study<'a> {
    /// Conditions, outcomes and scales, as `study.toml` declares them.
    pub design: &'a Design,
    pub analysis: &'a Analysis,
    /// Where each condition lay for each participant.
    pub conditions: &'a [ConditionRow],
    /// Lowest and highest score of the style.
    pub score_range: Option<(f64, f64)>,
    /// Cronbach's alpha of the style's score, where it is known.
    pub alpha: Option<f64>,
    /// Whether the page has a table of the dial's steps.
    pub steps: bool,
}

impl Study<'_> {
    /// What the page calls a condition, the baseline or a role.
    pub(super) fn label(&self, id: ConditionId) -> String {
        words::label(self.design, id)
    }
}
