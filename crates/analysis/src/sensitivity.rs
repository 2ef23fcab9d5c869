//! What decides, once more by another choice: how much rests on the one that was made.

use crate::{
    AnalysisError,
    compare::whole,
    data::StudyData,
    design_test::Purpose,
    other_choice::{OtherChoice, Sensitivity, SensitivityRow},
    outcomes::{Asked, outcomes},
    pairs::panel_of_everybody,
    result::{Contrast, Panel, PrimaryOutcome},
    verdict::{Verdict, directed, significant},
};
use maveric_domain::design::Sign;

/// Each outcome that the design asks for by another choice too, and each rating of rides of which some were stopped, against the panels over everybody.
pub(crate) fn sensitivity(
    data: &StudyData,
    purpose: Purpose,
    panels: &[Panel],
    primary: &[PrimaryOutcome],
) -> Result<Vec<Sensitivity>, AnalysisError> {
    let mut rows = Vec::new();
    for outcome in data.design.outcomes() {
        if let Some(asked) = Asked::without_items(data, outcome) {
            let other = whole(data, purpose, &asked)?;
            let items = outcome.drop_items.clone();
            let choice = OtherChoice::WithoutItems { items };
            rows.extend(beside(choice, &other, panels, primary));
        }
    }
    let with_stopped = data.with_stopped();
    for asked in outcomes(data) {
        let rides = data.stopped_rides(&asked.quantity);
        if rides > 0 {
            let other = whole(&with_stopped, purpose, &asked)?;
            let choice = OtherChoice::WithStopped { rides };
            rows.extend(beside(choice, &other, panels, primary));
        }
    }
    Ok(rows)
}

/// A panel by another choice beside the one that decides; none where that is not there.
fn beside(
    choice: OtherChoice,
    other: &Panel,
    panels: &[Panel],
    primary: &[PrimaryOutcome],
) -> Option<Sensitivity> {
    let id = other.outcome.clone();
    let decides = panel_of_everybody(panels, &id)?;
    let row = |(one, other_one): (&Contrast, &Contrast)| {
        let pair = [one.first, one.second];
        let holm = !primary.iter().any(|primary| primary.is_of(&id, pair));
        let p = |contrast: &Contrast| if holm { contrast.p_holm } else { contrast.p };
        let differs = significant(decides.n, p(one));
        let way = one.mean_difference.and_then(Sign::of);
        let other_p = p(other_one);
        SensitivityRow {
            first: one.first,
            second: one.second,
            mean_difference: one.mean_difference,
            p: p(one),
            differs,
            other_mean_difference: other_one.mean_difference,
            other_p,
            holm,
            other_differs: match way.filter(|_| differs == Verdict::Shown) {
                Some(way) => directed(other.n, other_one.mean_difference, other_p, way),
                None => significant(other.n, other_p),
            },
        }
    };
    // Both have the contrasts of one outcome, in one order.
    let rows = decides.contrasts.iter().zip(&other.contrasts);
    Some(Sensitivity {
        title: decides.title.clone(),
        choice,
        n: [decides.n, other.n],
        rows: rows.map(row).collect(),
        outcome: id,
    })
}
