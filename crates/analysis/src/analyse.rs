//! Every analysis of a study.

use crate::{
    Analysis, AnalysisError, Exclusion, Family, MimicAccuracy, Panel, StudyData, accuracy,
    homophily, line, mixed, panels,
};
use maveric_domain::ConditionId;

/// How much work Friedman's p is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Friedman {
    /// Exact where it is feasible, as a study is reported.
    Exact,
    /// By Iman and Davenport's F: a thousand times faster, for many studies.
    Approximate,
}

/// Every analysis of method section 9 over the tables of one study.
///
/// # Errors
/// [`AnalysisError`] if the family names what nobody answered, or a test refuses its data.
///
/// # Source
/// Method section 9.
pub fn analyse(
    data: &StudyData,
    family: &Family,
    friedman: Friedman,
) -> Result<Analysis, AnalysisError> {
    let line = line::line(data, true)?;
    let line_without_adb = line::line(data, false)?;
    let accuracy = accuracy::accuracy(data);
    let nearer = accuracy::nearer(data)?;
    let panels = panels::panels(data, friedman)?;
    let kept = line::kept(data)?;
    let shifted: Vec<bool> = data
        .conditions
        .iter()
        .filter(|c| matches!(c.condition, ConditionId::AGGRESSIVE | ConditionId::CAUTIOUS))
        .map(|c| c.beyond_training)
        .collect();
    let beyond = shifted.iter().filter(|b| **b).count() as f64 / shifted.len() as f64;
    let exclusions = exclusions(&panels, &accuracy);
    Ok(Analysis {
        synthetic: data.is_synthetic(),
        participants: data.participants.len(),
        line,
        line_without_adb,
        accuracy,
        panels,
        nearer,
        kept,
        homophily: homophily::homophily(data, family)?,
        family: family.clone(),
        mixed: mixed::mixed(data)?,
        similarity: homophily::similarity(data)?,
        preferences: homophily::preferences(data),
        beyond_training: Some(beyond).filter(|b| b.is_finite()),
        exclusions,
    })
}

fn exclusions(panels: &[Panel], accuracy: &[MimicAccuracy]) -> Vec<Exclusion> {
    let mut found = Vec::new();
    for panel in panels {
        for who in &panel.dropped {
            found.push(Exclusion {
                who: who.clone(),
                what: format!("comparison of {}", panel.title.to_lowercase()),
                why: "no value in at least one condition or in the own drive".to_owned(),
            });
        }
    }
    for row in accuracy.iter().filter(|a| a.dropped > 0) {
        found.push(Exclusion {
            who: format!("{} participants", row.dropped),
            what: format!("mimic accuracy of {}", row.title.to_lowercase()),
            why: "no value in the own or the Mimic drive, or an own value of zero".to_owned(),
        });
    }
    found
}
