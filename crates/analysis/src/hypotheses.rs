//! The hypotheses of a design, judged by the rules of [`crate::verdict`].

use crate::{
    AnalysisError,
    compare::values,
    data::StudyData,
    result::{Judged, Panel},
    verdict::{FEWEST, Verdict, directed, equivalent},
};
use maveric_domain::{
    ConditionId,
    design::{Claim, Hypothesis, Sign},
};

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
        rule: rule(&hypothesis.claim, panel),
        verdict: Verdict::NotAsked,
        n: pairs.len(),
        mean_difference: None,
        interval: None,
        bounds: match hypothesis.claim {
            Claim::Equivalent([low, high]) => Some((low, high)),
            Claim::Direction(_) => None,
        },
        expected: match hypothesis.claim {
            Claim::Direction(sign) => Some(sign),
            Claim::Equivalent(_) => None,
        },
        p: None,
    };
    if panel.rows.iter().flatten().all(Option::is_none) {
        return Ok(judged);
    }
    if pairs.len() < FEWEST {
        judged.verdict = Verdict::TooFew;
        return Ok(judged);
    }
    let differences: Vec<f64> = pairs.iter().map(|[a, b]| a - b).collect();
    match hypothesis.claim {
        Claim::Direction(sign) => {
            // The interval is the same whatever the bounds.
            let ordinary = equivalent((-1.0, 1.0), &differences)?.1;
            judged.interval = ordinary.and_then(|t| t.ci_low.zip(t.ci_high));
            (judged.mean_difference, judged.p) = contrast(panel, first, second).unzip();
            judged.verdict = directed(judged.n, judged.mean_difference, judged.p, sign);
        }
        Claim::Equivalent([low, high]) => {
            let n = pairs.len() as f64;
            judged.mean_difference = Some(differences.iter().sum::<f64>() / n);
            let (verdict, test) = equivalent((low, high), &differences)?;
            judged.verdict = verdict;
            judged.p = test.as_ref().and_then(|t| t.p);
            judged.interval = test.and_then(|t| t.ci90_low.zip(t.ci90_high));
        }
    }
    Ok(judged)
}

fn rule(claim: &Claim, panel: &Panel) -> String {
    let unit = match panel.unit.as_str() {
        unit if panel.measured && !unit.is_empty() => format!(" {unit}"),
        _ => String::new(),
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
