//! The hypotheses of a design, judged by the rules of [`crate::verdict`].

use crate::{
    AnalysisError,
    data::StudyData,
    pairs::{contrast, mean_difference, values, why_no_p},
    result::{ContrastTest, Judged, Panel, PrimaryOutcome},
    verdict::{FEWEST, Verdict, directed, equivalent, one_sided, outside},
};
use maveric_domain::design::{Claim, Hypothesis, Sign};
use maveric_stats::tost_of_estimate;

/// Every hypothesis against the panel of its outcome over everybody.
///
/// Of the contrast that decides about a primary outcome p is not adjusted, and behind a closed gate nothing is judged.
pub(crate) fn verdicts(
    data: &StudyData,
    panels: &[Panel],
    primary: &[PrimaryOutcome],
) -> Result<Vec<Judged>, AnalysisError> {
    let mut judged = Vec::new();
    for hypothesis in data.design.hypotheses() {
        let whole = |p: &&Panel| p.outcome == hypothesis.outcome && p.group.is_none();
        for panel in panels.iter().filter(whole) {
            let decides = |p: &&PrimaryOutcome| p.is_of(&hypothesis.outcome, hypothesis.contrast);
            judged.push(judge(hypothesis, panel, primary.iter().find(decides))?);
        }
    }
    Ok(judged)
}

fn judge(
    hypothesis: &Hypothesis,
    panel: &Panel,
    primary: Option<&PrimaryOutcome>,
) -> Result<Judged, AnalysisError> {
    let [first, second] = hypothesis.contrast;
    let pairs = values(panel, first, second);
    let mut judged = Judged {
        says: hypothesis.says.clone(),
        outcome: hypothesis.outcome.clone(),
        first,
        second,
        rule: rule(&hypothesis.claim, panel, primary),
        verdict: Verdict::NotAsked,
        n: pairs.len(),
        mean_difference: None,
        interval: None,
        odds: None,
        bounds: match hypothesis.claim {
            Claim::Equivalent([low, high]) => Some((low, high)),
            Claim::Direction(_) => None,
        },
        expected: match hypothesis.claim {
            Claim::Direction(sign) => Some(sign),
            Claim::Equivalent(_) => None,
        },
        p: None,
        holm: primary.is_none() && matches!(hypothesis.claim, Claim::Direction(_)),
        p_outside: None,
        unbounded: false,
        why_not: None,
    };
    if panel.rows.iter().flatten().all(Option::is_none) {
        return Ok(judged);
    }
    if pairs.len() < FEWEST {
        judged.verdict = Verdict::TooFew;
        return Ok(judged);
    }
    if primary.is_some_and(|p| p.closed_by.is_some()) {
        judged.verdict = Verdict::NotTested;
        return Ok(judged);
    }
    let differences: Vec<f64> = pairs.iter().map(|[a, b]| a - b).collect();
    let tested = contrast(panel, hypothesis.contrast);
    let model = tested.as_ref().and_then(|c| Some((c.mean_difference?, c.se?, c.df?)));
    match hypothesis.claim {
        Claim::Direction(sign) => {
            judged.mean_difference = mean_difference(panel, hypothesis.contrast);
            if let Some(tested) = tested.filter(|tested| tested.p_holm.is_some()) {
                judged.mean_difference = tested.mean_difference;
                judged.p = tested.p_holm;
                judged.interval = tested.interval;
                judged.odds = tested.odds;
                judged.unbounded = tested.unbounded;
                if primary.is_some() {
                    judged.p = tested.p;
                }
            }
            if judged.p.is_some() && model.is_none() && panel.test != Some(ContrastTest::Ordinal) {
                // The interval is the same whatever the bounds.
                let ordinary = equivalent((-1.0, 1.0), &differences)?.1;
                judged.interval = ordinary.and_then(|t| t.ci.ends());
            }
            judged.verdict = directed(judged.n, judged.mean_difference, judged.p, sign);
        }
        Claim::Equivalent([low, high]) if let Some((mean, se, df)) = model => {
            let test = tost_of_estimate((mean, se), df, (low, high));
            let sides = (test.p_lower, test.p_upper);
            judged.mean_difference = Some(mean);
            judged.interval = test.ci90;
            judged.p = Some(test.p_lower.max(test.p_upper));
            judged.p_outside = Some(outside(sides));
            judged.verdict = one_sided(judged.n, Some(sides));
        }
        Claim::Equivalent([low, high]) => {
            let n = pairs.len() as f64;
            judged.mean_difference = Some(differences.iter().sum::<f64>() / n);
            let (verdict, test) = equivalent((low, high), &differences)?;
            judged.verdict = verdict;
            judged.p = test.as_ref().and_then(|t| t.p);
            let sides = test.as_ref().and_then(|t| t.p_lower.zip(t.p_upper));
            judged.p_outside = sides.map(outside);
            judged.interval = test.and_then(|t| t.ci90.ends());
        }
    }
    if judged.verdict == Verdict::NotTestable {
        judged.why_not = Some(why_no_p(panel, hypothesis.contrast));
    }
    Ok(judged)
}

fn rule(claim: &Claim, panel: &Panel, primary: Option<&PrimaryOutcome>) -> String {
    let unit = match panel.unit.as_str() {
        unit if panel.measured && !unit.is_empty() => format!(" {unit}"),
        _ => String::new(),
    };
    match claim {
        Claim::Direction(sign) => {
            let way = if *sign == Sign::Plus { "above" } else { "below" };
            format!(
                "shown if the first lies {way} the second with p < .05 (two-sided, {}); fails if it lies on \
                 the other side by the same rule",
                if primary.is_some() {
                    "the primary contrast of a primary outcome"
                } else {
                    "Holm over the contrasts of this outcome"
                }
            )
        }
        Claim::Equivalent(bounds) => {
            let [low, high] = bounds.map(|bound| bound.to_string().replace('-', "−"));
            format!(
                "shown if two one-sided t tests place the difference between {low} and {high}{unit} (both p < .05); fails if one of them \
                 places it outside"
            )
        }
    }
}
