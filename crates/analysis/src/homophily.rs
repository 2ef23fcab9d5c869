//! 9.5: who prefers what, and what goes with it.

use crate::{
    AnalysisError,
    correlations::{correlate, correlate_within},
    data::StudyData,
    family::Family,
    result::{HomophilyRow, Preference, SimilarityRow},
};
use maveric_domain::{ConditionId, ParticipantId};
use maveric_stats::{CorrelationMethod, adjust, proportion};

/// The ratings of a condition: code name, scale, subscale, and whether more of it is better.
pub(crate) const RATINGS: [(&str, &str, &str, bool); 4] = [
    ("competence", "rosas", "competence", true),
    (
        "intelligence",
        "godspeed_intelligence",
        "intelligence",
        true,
    ),
    ("discomfort", "rosas", "discomfort", false),
    ("trust", "jian_trust", "overall", true),
];

pub(crate) fn rating(
    data: &StudyData,
    p: &ParticipantId,
    condition: ConditionId,
    name: &str,
) -> Option<f64> {
    let (_, scale, subscale, _) = RATINGS.iter().find(|r| r.0 == name)?;
    data.post(p, condition, scale, subscale)
}

/// Every factor of the family against every rating difference.
pub(crate) fn homophily(
    data: &StudyData,
    family: &Family,
) -> Result<Vec<HomophilyRow>, AnalysisError> {
    // Mimic minus the other, once for all factors.
    let mut differences = Vec::new();
    for versus in [ConditionId::CAUTIOUS, ConditionId::AGGRESSIVE] {
        for (name, ..) in RATINGS {
            let difference = |p| {
                Some(rating(data, p, ConditionId::MIMIC, name)? - rating(data, p, versus, name)?)
            };
            let y: Vec<Option<f64>> = data.participants.iter().map(difference).collect();
            differences.push((versus, name, y));
        }
    }
    let mut rows = Vec::new();
    for (scale, factor) in family.factors(data)? {
        let x: Vec<Option<f64>> = data
            .participants
            .iter()
            .map(|p| data.pre(p, &scale, &factor))
            .collect();
        for (versus, name, y) in &differences {
            rows.push(HomophilyRow {
                factor: factor.clone(),
                versus: *versus,
                rating: (*name).to_owned(),
                correlation: correlate(&x, y, CorrelationMethod::Auto)?,
                p_holm: None,
                p_bh: None,
            });
        }
    }
    let tested: Vec<usize> = (0..rows.len())
        .filter(|&i| rows[i].correlation.p.is_some())
        .collect();
    let p: Vec<f64> = tested
        .iter()
        .filter_map(|&i| rows[i].correlation.p)
        .collect();
    if !p.is_empty() {
        let adjusted = adjust(&p)?;
        for (k, &i) in tested.iter().enumerate() {
            rows[i].p_holm = adjusted.holm.get(k).copied();
            rows[i].p_bh = adjusted.bh.get(k).copied();
        }
    }
    Ok(rows)
}

/// Perceived similarity against the ratings, over participants × conditions.
pub(crate) fn similarity(data: &StudyData) -> Result<Vec<SimilarityRow>, AnalysisError> {
    let cells: Vec<(&ParticipantId, ConditionId)> = data
        .participants
        .iter()
        .flat_map(|p| ConditionId::AV.map(|c| (p, c)))
        .collect();
    let subjects: Vec<String> = cells.iter().map(|(p, _)| p.to_string()).collect();
    let x: Vec<Option<f64>> = cells
        .iter()
        .map(|(p, c)| data.post(p, *c, "similarity", "similarity"))
        .collect();
    let one = |name: &str| {
        let y: Vec<Option<f64>> = cells
            .iter()
            .map(|(p, c)| rating(data, p, *c, name))
            .collect();
        Ok(SimilarityRow {
            rating: name.to_owned(),
            pooled: correlate(&x, &y, CorrelationMethod::Spearman)?,
            within: correlate_within(&subjects, &x, &y)?,
        })
    };
    ["trust", "intelligence", "competence"]
        .into_iter()
        .map(one)
        .collect()
}

/// Who rated Aggressive and Cautious above Mimic.
pub(crate) fn preferences(data: &StudyData) -> Vec<Preference> {
    let one = |&(name, _, _, more_is_better): &(&str, &str, &str, bool)| {
        let mut found = Preference {
            rating: name.to_owned(),
            n: 0,
            aggressive_above: 0,
            cautious_above: 0,
            mimic_not_above_cautious: 0,
            aggressive_share: None,
            cautious_share: None,
            mimic_not_above_cautious_share: None,
        };
        let sign = if more_is_better { 1.0 } else { -1.0 };
        for p in &data.participants {
            let score = |c| rating(data, p, c, name).map(|v| v * sign);
            let (Some(mimic), Some(aggressive), Some(cautious)) = (
                score(ConditionId::MIMIC),
                score(ConditionId::AGGRESSIVE),
                score(ConditionId::CAUTIOUS),
            ) else {
                continue;
            };
            found.n += 1;
            found.aggressive_above += usize::from(aggressive > mimic);
            found.cautious_above += usize::from(cautious > mimic);
            found.mimic_not_above_cautious += usize::from(mimic <= cautious);
        }
        let share = |count: usize| proportion(count, found.n, 0.95).ok();
        found.aggressive_share = share(found.aggressive_above);
        found.cautious_share = share(found.cautious_above);
        found.mimic_not_above_cautious_share = share(found.mimic_not_above_cautious);
        found
    };
    RATINGS.iter().map(one).collect()
}
