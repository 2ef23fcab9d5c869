//! The primary outcomes: declared tests, each at α in the order written, until the first that is not below it, or that cannot be tested:
//! to go on behind that one would give a second hypothesis its chance at α before the first has had its own.

use crate::{
    data::StudyData,
    pairs::{contrast, mean_difference, panel_of_everybody, why_no_p},
    result::{Panel, PrimaryOutcome},
    verdict::{FEWEST, Verdict, significant},
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
        let Some(panel) = panel_of_everybody(panels, &id) else {
            continue;
        };
        let contrast = contrast(panel, [first, second]);
        let n = if panel.rows.iter().flatten().all(Option::is_none) { 0 } else { panel.n };
        let contrast = contrast.filter(|_| closed_by.is_none() && n >= FEWEST);
        let p = contrast.as_ref().and_then(|c| c.p);
        let measured = contrast.as_ref().and_then(|_| mean_difference(panel, [first, second]));
        let verdict = if closed_by.is_some() { Verdict::NotTested } else { significant(n, p) };
        rows.push(PrimaryOutcome {
            title: panel.title.clone(),
            unit: panel.unit.clone(),
            first,
            second,
            test,
            n,
            closed_by: closed_by.clone(),
            mean_difference: contrast.as_ref().and_then(|c| c.mean_difference).or(measured),
            odds: contrast.as_ref().and_then(|c| c.odds),
            unbounded: contrast.as_ref().is_some_and(|c| c.unbounded),
            interval: contrast.and_then(|c| c.interval),
            p,
            verdict,
            why_not: (verdict == Verdict::NotTestable).then(|| why_no_p(panel, [first, second])),
            outcome: id.clone(),
        });
        if verdict != Verdict::Shown && closed_by.is_none() {
            closed_by = Some(id);
        }
    }
    rows
}
