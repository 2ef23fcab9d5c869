//! What makes a hypothesis "shown": rules that stand before the result.

use crate::{AnalysisError, compare::ALPHA, data::StudyData, result::Panel};
use maveric_domain::{
    ConditionId,
    design::{Claim, Hypothesis, Sign},
};
use maveric_stats::{Bounds, equivalence_one};
use serde::{Deserialize, Serialize};

/// What became of a hypothesis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// As it says, by its rule.
    Shown,
    /// The data decide neither way.
    NotShown,
    /// The opposite of what it says, by the same rule.
    Fails,
    /// Nobody answered, or nothing measured, what it is about.
    NotAsked,
    /// Fewer than three people have both values.
    TooFew,
}

/// Fewest people in whom a contrast can be judged.
const FEWEST: usize = 3;

/// A hypothesis of the design, judged.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Judged {
    /// In words, as declared.
    pub says: String,
    /// Id of the outcome.
    pub outcome: String,
    /// First condition of the contrast.
    pub first: ConditionId,
    /// Second; the difference is first minus second.
    pub second: ConditionId,
    /// The rule, in words.
    pub rule: String,
    /// What became of it.
    pub verdict: Verdict,
    /// People with both values.
    pub n: usize,
    /// Mean of first minus second, in the unit of the panel.
    pub mean_difference: Option<f64>,
    /// The p that decides: Holm's within the outcome, or the larger of the two one-sided tests.
    pub p: Option<f64>,
}

/// Every hypothesis against the panel of its outcome over everybody.
pub(crate) fn verdicts(data: &StudyData, panels: &[Panel]) -> Result<Vec<Judged>, AnalysisError> {
    let mut found = Vec::new();
    for hypothesis in data.design.hypotheses() {
        let whole = |p: &&Panel| p.outcome == hypothesis.outcome && p.group.is_none();
        for panel in panels.iter().filter(whole) {
            found.push(judge(hypothesis, panel)?);
        }
    }
    Ok(found)
}

fn judge(hypothesis: &Hypothesis, panel: &Panel) -> Result<Judged, AnalysisError> {
    let [first, second] = hypothesis.contrast;
    let pairs = values(panel, first, second);
    let mut judged = Judged {
        says: hypothesis.says.clone(),
        outcome: hypothesis.outcome.clone(),
        first,
        second,
        rule: rule(&hypothesis.claim, &panel.unit),
        verdict: Verdict::NotAsked,
        n: pairs.len(),
        mean_difference: None,
        p: None,
    };
    if panel.rows.iter().flatten().all(Option::is_none) {
        return Ok(judged);
    }
    if pairs.len() < FEWEST {
        judged.verdict = Verdict::TooFew;
        return Ok(judged);
    }
    match hypothesis.claim {
        Claim::Direction(sign) => {
            let Some((difference, p)) = contrast(panel, first, second) else {
                judged.verdict = Verdict::TooFew;
                return Ok(judged);
            };
            judged.n = panel.n;
            (judged.mean_difference, judged.p) = (Some(difference), Some(p));
            judged.verdict = match Sign::of(difference) {
                Some(way) if p < ALPHA && way == sign => Verdict::Shown,
                Some(_) if p < ALPHA => Verdict::Fails,
                _ => Verdict::NotShown,
            };
        }
        Claim::Equivalent(bounds) => {
            let n = pairs.len() as f64;
            judged.mean_difference = Some(pairs.iter().map(|[a, b]| a - b).sum::<f64>() / n);
            (judged.verdict, judged.p) = equivalent(bounds, &pairs)?;
        }
    }
    Ok(judged)
}

fn rule(claim: &Claim, unit: &str) -> String {
    let unit = if unit.is_empty() || unit.starts_with("rating") {
        String::new()
    } else {
        format!(" {unit}")
    };
    match claim {
        Claim::Direction(sign) => {
            let way = if *sign == Sign::Plus {
                "above"
            } else {
                "below"
            };
            format!(
                "shown if the first lies {way} the second with p < .05 (two-sided, Holm over the contrasts of this outcome); fails if it lies on \
                 the other side by the same rule"
            )
        }
        Claim::Equivalent([low, high]) => format!(
            "shown if two one-sided t tests place the difference between {low} and {high}{unit} (both p < .05); fails if one of them places it \
             outside"
        ),
    }
}

/// Two one-sided t tests of the differences against the bounds; the larger p decides.
fn equivalent(
    [low, high]: [f64; 2],
    pairs: &[[f64; 2]],
) -> Result<(Verdict, Option<f64>), AnalysisError> {
    let differences: Vec<Option<f64>> = pairs.iter().map(|[a, b]| Some(a - b)).collect();
    let found = equivalence_one(&differences, 0.0, Bounds::Raw { low, high })?;
    let Some(test) = found.tost.values().next() else {
        return Ok((Verdict::TooFew, None));
    };
    let (Some(p), Some(above_low), Some(below_high)) = (test.p, test.p_lower, test.p_upper) else {
        return Ok((Verdict::TooFew, None));
    };
    let verdict = if p < ALPHA {
        Verdict::Shown
    } else if 1.0 - above_low < ALPHA || 1.0 - below_high < ALPHA {
        Verdict::Fails
    } else {
        Verdict::NotShown
    };
    Ok((verdict, Some(p)))
}

/// Values of both conditions, of everybody who has them; the baseline of a panel of differences is 0.
fn values(panel: &Panel, first: ConditionId, second: ConditionId) -> Vec<[f64; 2]> {
    let column = |id| panel.conditions.iter().position(|c| *c == id);
    let value = |row: &[Option<f64>], id| match column(id) {
        Some(at) => row[at],
        None => (panel.differences_from == Some(id)).then_some(0.0),
    };
    panel
        .rows
        .iter()
        .filter_map(|row| Some([value(row, first)?, value(row, second)?]))
        .collect()
}

/// The contrast, first minus second, whichever way round it was declared: mean difference and Holm's p.
fn contrast(panel: &Panel, first: ConditionId, second: ConditionId) -> Option<(f64, f64)> {
    panel.contrasts.iter().find_map(|c| {
        let sign = if (c.first, c.second) == (first, second) {
            1.0
        } else if (c.first, c.second) == (second, first) {
            -1.0
        } else {
            return None;
        };
        Some((sign * c.mean_difference?, c.p_holm?))
    })
}
