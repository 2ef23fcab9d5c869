//! What decides, once more by another choice: how much rests on the one that was made.

use crate::{
    AnalysisError,
    compare::whole,
    data::StudyData,
    design_test::Purpose,
    outcomes::Asked,
    result::{Contrast, Panel, PrimaryOutcome},
    verdict::{Verdict, directed, significant},
};
use maveric_domain::{
    ConditionId,
    design::{Outcome, Sign},
};
use serde::{Deserialize, Serialize};

/// An outcome by another choice than the one that decides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sensitivity {
    /// `SCALE.SUBSCALE` of the outcome.
    pub outcome: String,
    /// Name of the outcome for people.
    pub title: String,
    /// The other choice.
    #[serde(flatten)]
    pub choice: OtherChoice,
    /// People in the test that decides, and in the other.
    pub n: [usize; 2],
    /// A row a declared contrast.
    pub rows: Vec<SensitivityRow>,
}

/// What is chosen otherwise.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "choice", rename_all = "kebab-case")]
pub enum OtherChoice {
    /// The score without items that name what the conditions turn.
    WithoutItems {
        /// Numbers of the items.
        items: Vec<u32>,
    },
}

/// A contrast as it is decided, and by the other choice. Both p are of the primary contrast as it is, of others after Holm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SensitivityRow {
    /// First condition.
    pub first: ConditionId,
    /// Second; differences are first minus second.
    pub second: ConditionId,
    /// Mean difference in the unit of the score.
    pub mean_difference: Option<f64>,
    /// p of what decides, two-sided.
    pub p: Option<f64>,
    /// Whether what decides is below .05.
    pub differs: Verdict,
    /// Mean difference by the other choice.
    pub other_mean_difference: Option<f64>,
    /// Its p.
    pub other_p: Option<f64>,
    /// Of a difference, whether it is there with the same sign by the other choice; else whether one is there by that alone.
    pub other_differs: Verdict,
}

impl Sensitivity {
    /// Contrasts that differ by the other choice alone.
    pub fn only_there(&self) -> usize {
        let rows = self.rows.iter();
        let only = |row: &&SensitivityRow| {
            row.differs != Verdict::Shown && row.other_differs == Verdict::Shown
        };
        rows.filter(only).count()
    }
}

/// Each outcome that the design asks for by another choice too, against the panels over everybody.
pub(crate) fn sensitivity(
    data: &StudyData,
    purpose: Purpose,
    panels: &[Panel],
    primary: &[PrimaryOutcome],
) -> Result<Vec<Sensitivity>, AnalysisError> {
    let mut found = Vec::new();
    for outcome in data.design.outcomes() {
        if let Some(asked) = Asked::without_items(data, outcome) {
            let other = whole(data, purpose, &asked)?;
            let items = outcome.drop_items.clone();
            let choice = OtherChoice::WithoutItems { items };
            found.extend(beside(outcome, choice, &other, panels, primary));
        }
    }
    Ok(found)
}

/// A panel by another choice beside the one that decides; none where that is not there.
fn beside(
    outcome: &Outcome,
    choice: OtherChoice,
    other: &Panel,
    panels: &[Panel],
    primary: &[PrimaryOutcome],
) -> Option<Sensitivity> {
    let id = outcome.id();
    let decides = panels
        .iter()
        .find(|panel| panel.outcome == id && panel.group.is_none())?;
    let p = |contrast: &Contrast| {
        let pair = [contrast.first, contrast.second];
        let alone = primary.iter().any(|primary| primary.is_of(&id, pair));
        if alone { contrast.p } else { contrast.p_holm }
    };
    let row = |(one, other_one): (&Contrast, &Contrast)| {
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
