//! The primary outcomes: declared tests, each at α in the order written, until the first that is not below it.

use crate::{
    data::StudyData,
    result::{Contrast, Panel},
    verdict::{ALPHA, FEWEST, Verdict, significant},
};
use maveric_domain::{ConditionId, design::DeclaredTest};
use serde::{Deserialize, Serialize};

/// What became of a primary outcome.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PrimaryOutcome {
    /// Id of the outcome.
    pub outcome: String,
    /// Name for people.
    pub title: String,
    /// Unit of the difference; empty for counts and shares.
    pub unit: String,
    /// First condition of the contrast that decides.
    pub first: ConditionId,
    /// Second; the difference is first minus second.
    pub second: ConditionId,
    /// The declared test.
    pub test: DeclaredTest,
    /// People in it.
    pub n: usize,
    /// The outcome before it at which the gate closed: then there is neither p nor verdict.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub closed_by: Option<String>,
    /// Mean difference, of a mixed model with the period taken out.
    pub mean_difference: Option<f64>,
    /// Ends of its 95 % interval, of a mixed model.
    pub interval: Option<(f64, f64)>,
    /// p of the contrast, two-sided, not adjusted: it is the only one that decides.
    pub p: Option<f64>,
    /// Whether p is below α.
    pub verdict: Verdict,
}

impl PrimaryOutcome {
    /// Whether a contrast is the one that decides.
    pub(crate) fn is_of(&self, outcome: &str, pair: [ConditionId; 2]) -> bool {
        self.outcome == outcome && pair.contains(&self.first) && pair.contains(&self.second)
    }
}

/// The primary outcomes in the order written, against the panels over everybody.
pub(crate) fn primary(data: &StudyData, panels: &[Panel]) -> Vec<PrimaryOutcome> {
    let mut closed_by: Option<String> = None;
    let mut found = Vec::new();
    for outcome in data.design.outcomes() {
        let (Some([first, second]), Some(test)) = (outcome.primary, outcome.test) else {
            continue;
        };
        let id = outcome.id();
        let whole = |p: &&Panel| p.outcome == id && p.group.is_none();
        let Some(panel) = panels.iter().find(whole) else {
            continue;
        };
        let contrast = contrast(panel, [first, second]);
        let n = if panel.rows.iter().flatten().all(Option::is_none) {
            0
        } else {
            panel.n
        };
        let contrast = contrast.filter(|_| closed_by.is_none() && n >= FEWEST);
        let p = contrast.and_then(|c| c.p);
        let turned = |c: &Contrast| c.first == second;
        let way = |c: &Contrast| if turned(c) { -1.0 } else { 1.0 };
        let verdict = if closed_by.is_some() {
            Verdict::NotTested
        } else {
            significant(n, p)
        };
        found.push(PrimaryOutcome {
            title: panel.title.clone(),
            unit: panel.unit.clone(),
            first,
            second,
            test,
            n,
            closed_by: closed_by.clone(),
            mean_difference: contrast.and_then(|c| Some(way(c) * c.mean_difference?)),
            interval: contrast.and_then(|c| {
                let (low, high) = c.interval?;
                Some(if turned(c) {
                    (-high, -low)
                } else {
                    (low, high)
                })
            }),
            p,
            verdict,
            outcome: id.clone(),
        });
        if p.is_none_or(|p| p >= ALPHA) && closed_by.is_none() {
            closed_by = Some(id);
        }
    }
    found
}

/// The contrast of two conditions, whichever way round it stands.
fn contrast(panel: &Panel, pair: [ConditionId; 2]) -> Option<&Contrast> {
    let contrasts = panel.contrasts.iter();
    contrasts
        .filter(|c| pair.contains(&c.first) && pair.contains(&c.second))
        .find(|c| c.first != c.second)
}
