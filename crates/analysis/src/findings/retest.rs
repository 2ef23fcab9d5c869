//! Does a person drive in the second session as in the first?

use crate::{
    finding::{Finding, Part, Question},
    retest::{FEWEST_FOR_ICC, Repeats},
};
use maveric_domain::Design;

/// An ICC below this is called poor agreement (Koo and Li 2016).
const POOR: f64 = 0.5;

/// Every reading of the drive by hand, of as many people as a coefficient needs: its whole interval above poor agreement.
pub(super) fn retest(design: &Design, repeats: Option<&Repeats>) -> Option<Finding> {
    let by_hand = repeats?
        .retest
        .iter()
        .filter(|row| Some(row.condition) == design.baseline_id() && row.n >= FEWEST_FOR_ICC);
    let part = |row: &crate::Retest| {
        let icc = row.icc.as_ref()?;
        let interval = icc.ci.ends();
        let estimate = (icc.icc, interval);
        Some(Part::within(&row.outcome, row.n, estimate, (POOR, f64::INFINITY)))
    };
    let parts: Vec<Part> = by_hand.filter_map(part).collect();
    (!parts.is_empty()).then(|| Finding::every(Question::Retest, parts))
}
