//! Means, medians and spreads of everything that was measured or answered, condition by condition: what a reader looks for first.

use crate::{
    data::StudyData,
    outcomes::{Asked, outcomes},
    result::Described,
};
use maveric_domain::ConditionId;
use maveric_stats::normality;

/// The outcomes in their order, then every other rating that somebody gave; the baseline first where it has values.
pub(crate) fn describe(data: &StudyData) -> Vec<Described> {
    let mut asked = outcomes(data);
    for name in data.rated_names() {
        if !asked.iter().any(|a| a.id == name.to_string()) {
            asked.push(Asked::score(data, name));
        }
    }
    let baseline = data.design.baseline_id();
    let mut conditions: Vec<ConditionId> = data.design.conditions().iter().map(|c| c.id).collect();
    if let Some(baseline) = baseline.filter(|b| !conditions.contains(b)) {
        conditions.insert(0, baseline);
    }
    let mut found = Vec::new();
    for asked in &asked {
        for condition in &conditions {
            let value = |p| Some(asked.value(data, p, *condition)? * asked.factor);
            let values: Vec<Option<f64>> = data
                .participants
                .iter()
                .filter_map(value)
                .map(Some)
                .collect();
            if values.is_empty() && Some(*condition) == baseline {
                continue;
            }
            let shape = normality(&values).ok().map(|found| found.desc);
            found.push(Described {
                outcome: asked.id.clone(),
                title: asked.title.clone(),
                unit: asked.unit.clone(),
                condition: *condition,
                n: values.len(),
                mean: shape.as_ref().map(|s| s.mean),
                sd: shape.as_ref().and_then(|s| s.sd),
                median: shape.as_ref().map(|s| s.median),
            });
        }
    }
    found
}
