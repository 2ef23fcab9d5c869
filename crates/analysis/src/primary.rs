//! The primary outcomes: declared tests, each at α in the order written, until the first that is not below it.

use crate::{
    data::StudyData,
    result::{Contrast, Panel, PrimaryOutcome},
    verdict::{ALPHA, FEWEST, Verdict, significant},
};
use maveric_domain::ConditionId;

impl PrimaryOutcome {
    /// Whether a contrast is the one that decides.
    pub(crate) fn is_of(&self, outcome: &str, pair: [ConditionId; 2]) -> bool {
        self.outcome == outcome && pair.contains(&self.first) && pair.contains(&self.second)
    }
}

/// The primary outcomes in the order written, against the panels over everybody.
pub(crate) fn primary(data: &StudyData, panels: &[Panel]) -> Vec<PrimaryOutcome> {
    let mut closed_by: Option<String> = None;
    let mut rows = Vec::new();
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
        rows.push(PrimaryOutcome {
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
    rows
}

/// The contrast of two conditions, whichever way round it stands.
fn contrast(panel: &Panel, pair: [ConditionId; 2]) -> Option<&Contrast> {
    let contrasts = panel.contrasts.iter();
    contrasts
        .filter(|c| pair.contains(&c.first) && pair.contains(&c.second))
        .find(|c| c.first != c.second)
}
