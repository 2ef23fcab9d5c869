//! `stats paper`: every analysis of the paper over the results of a run (method section 9).

mod adapt;
pub(crate) mod data;
mod family;
mod homophily;
mod line;
mod mimic;
mod mixed;
mod panels;
mod result;

pub use family::Family;
pub use result::{
    AggressionLine, Analysis, Correlation, Exclusion, HomophilyRow, Kept, LineRow, MimicAccuracy,
    MixedRow, Nearer, Panel, PanelPair, Preference, SimilarityRow,
};

use crate::{
    atomic_write::write_json,
    error::StudyError,
    outcome::{Outcome, Watch},
};
use data::StudyData;
use maveric_domain::ConditionId;
use std::path::PathBuf;

/// What to analyse.
#[derive(Debug, Clone)]
pub struct AnalyseOptions {
    /// Folder of results, as the pipeline leaves it.
    pub results: PathBuf,
    /// Analysis to write (JSON).
    pub out: PathBuf,
    /// The factors of the homophily tests.
    pub family: Family,
}

/// How much work Friedman's p is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Friedman {
    /// Exact where it is feasible, as a study is reported.
    Exact,
    /// By Iman and Davenport's F: a thousand times faster, for many studies.
    Approximate,
}

/// Runs every analysis of the paper and writes the results.
///
/// # Errors
/// [`StudyError`] if a table is missing, or holds fewer than three participants of Study 2.
///
/// # Source
/// Method section 9.
pub fn analyse(
    options: &AnalyseOptions,
    watch: Watch<'_>,
) -> Result<Outcome<Analysis>, StudyError> {
    let data = StudyData::read(&options.results)?;
    let analysis = analysis(&data, &options.family, Friedman::Exact, watch)?;
    write_json(&options.out, &analysis)?;
    let warnings = analysis
        .exclusions
        .iter()
        .map(|e| format!("{}: left out of {}: {}", e.who, e.what, e.why))
        .collect();
    let summary = vec![format!(
        "{} participants analysed: {}",
        analysis.participants,
        options.out.display()
    )];
    Ok(Outcome {
        value: analysis,
        summary,
        warnings,
    })
}

/// Every analysis of method section 9 over the tables of one study: what [`analyse`] writes, and what a rehearsal repeats.
///
/// # Errors
/// [`StudyError`] if the family names what nobody answered, a test refuses its data, or the work was interrupted.
pub(crate) fn analysis(
    data: &StudyData,
    family: &Family,
    friedman: Friedman,
    watch: Watch<'_>,
) -> Result<Analysis, StudyError> {
    let steps = 6;
    watch.step(1, steps, "aggression line")?;
    let line = line::line(data, true)?;
    let line_without_adb = line::line(data, false)?;
    watch.step(2, steps, "mimic accuracy")?;
    let accuracy = mimic::accuracy(data);
    let nearer = mimic::nearer(data)?;
    watch.step(3, steps, "six panels")?;
    let panels = panels::panels(data, friedman)?;
    watch.step(4, steps, "other habits")?;
    let kept = line::kept(data)?;
    watch.step(5, steps, "homophily")?;
    let shifted: Vec<bool> = data
        .conditions
        .iter()
        .filter(|c| matches!(c.condition, ConditionId::AGGRESSIVE | ConditionId::CAUTIOUS))
        .map(|c| c.beyond_training)
        .collect();
    let beyond = shifted.iter().filter(|b| **b).count() as f64 / shifted.len() as f64;
    let exclusions = exclusions(&panels, &accuracy);
    watch.step(steps, steps, "analyses")?;
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
