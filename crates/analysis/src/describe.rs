//! Means, medians and spreads of everything that was measured or answered, condition by condition: what a reader looks for first.

use crate::{
    data::StudyData,
    outcomes::{Asked, outcomes_and},
    result::Described,
};
use maveric_domain::ConditionId;
use maveric_measures::objective;
use maveric_stats::normality;

/// An outcome or a rating as it was observed.
#[derive(Debug, Clone)]
pub struct Observed {
    /// Code name of the measure, or `SCALE.SUBSCALE`.
    pub outcome: String,
    /// Name for people.
    pub title: String,
    /// Unit in which people read it; empty for counts and shares.
    pub unit: String,
    /// What a value is multiplied with to be in that unit.
    pub factor: f64,
    /// Everybody's values in each condition, the baseline first where it has any: in the order of [`StudyData::participants`] and in the
    /// unit of the tables.
    pub conditions: Vec<(ConditionId, Vec<Option<f64>>)>,
}

/// The outcomes in their order, then every other rating that somebody gave, then what the drives met on their road.
pub fn observed(data: &StudyData) -> Vec<Observed> {
    let rated = data.rated_names().iter();
    let met = objective::met().iter().filter(|m| data.is_measured(m.name));
    let met = met.map(|m| Asked::measure(&data.design, m.name));
    let more = rated.map(|name| Asked::score(data, name)).chain(met);
    let quantities = outcomes_and(data, more);
    let baseline = data.design.baseline_id();
    let mut conditions: Vec<ConditionId> = data.design.condition_ids().collect();
    if let Some(baseline) = baseline.filter(|b| !conditions.contains(b)) {
        conditions.insert(0, baseline);
    }
    let observed = |quantity: Asked| {
        let values = |condition: &ConditionId| {
            let value = |p| quantity.value(data, p, *condition);
            (*condition, data.participants.iter().map(value).collect())
        };
        let there = |(condition, values): &(ConditionId, Vec<Option<f64>>)| {
            Some(*condition) != baseline || values.iter().any(Option::is_some)
        };
        Observed {
            conditions: conditions.iter().map(values).filter(there).collect(),
            outcome: quantity.id,
            title: quantity.title,
            unit: quantity.unit,
            factor: quantity.factor,
        }
    };
    quantities.into_iter().map(observed).collect()
}

/// Each condition of [`observed`] in numbers, in the unit in which people read it.
pub(crate) fn describe(data: &StudyData) -> Vec<Described> {
    let mut rows = Vec::new();
    for seen in observed(data) {
        for (condition, values) in seen.conditions {
            let shown = values.into_iter().flatten().map(|v| Some(v * seen.factor));
            let values: Vec<Option<f64>> = shown.collect();
            let shape = normality(&values).ok().map(|tested| tested.desc);
            rows.push(Described {
                outcome: seen.outcome.clone(),
                title: seen.title.clone(),
                unit: seen.unit.clone(),
                condition,
                n: values.len(),
                mean: shape.as_ref().map(|s| s.mean),
                sd: shape.as_ref().and_then(|s| s.sd),
                median: shape.as_ref().map(|s| s.median),
            });
        }
    }
    rows
}
