//! 9.3: differences from the own drive in the four conditions, six panels.

use crate::{
    AnalysisError, Friedman,
    data::StudyData,
    line::{FOLLOWS, title, unit},
    result::{Panel, PanelPair},
};
use maveric_domain::{ConditionId, MetresPerSecond};
use maveric_measures::difference_from_own;
use maveric_stats::{WithinSubjects, compare, compare_without_exact};

/// Level of the assumption checks and of `reject`.
const ALPHA: f64 = 0.05;
/// "As aggressive as I am" on the scale of perceived aggressiveness.
const SAME_AGGRESSIVENESS: f64 = 4.0;

/// The six panels of the paper, in its order.
pub(crate) fn panels(data: &StudyData, friedman: Friedman) -> Result<Vec<Panel>, AnalysisError> {
    let mut panels = Vec::new();
    for measure in FOLLOWS {
        let value = |p: &_, c| {
            difference_from_own(
                data.measured(p, c, measure),
                data.measured(p, ConditionId::OWN, measure),
            )
        };
        // People read speeds in mph.
        let (scale, unit) = match measure {
            "mean_velocity_mps" => (MetresPerSecond(1.0).mph(), "mph".to_owned()),
            _ => (1.0, unit(measure)),
        };
        let row = |p| {
            ConditionId::AV
                .map(|c| value(p, c).map(|v| v * scale))
                .to_vec()
        };
        let rows = data.participants.iter().map(row).collect();
        panels.push(panel(
            data,
            friedman,
            measure,
            title(measure),
            unit,
            0.0,
            rows,
        )?);
    }
    let rated = |p| {
        ConditionId::AV
            .map(|c| data.post(p, c, "aggressiveness", "aggressiveness"))
            .to_vec()
    };
    let rows = data.participants.iter().map(rated).collect();
    let name = "Subjective aggressiveness".to_owned();
    panels.push(panel(
        data,
        friedman,
        "aggressiveness",
        name,
        "rating, 1 to 7".to_owned(),
        SAME_AGGRESSIVENESS,
        rows,
    )?);
    Ok(panels)
}

fn panel(
    data: &StudyData,
    friedman: Friedman,
    measure: &str,
    title: String,
    unit: String,
    same: f64,
    rows: Vec<Vec<Option<f64>>>,
) -> Result<Panel, AnalysisError> {
    let participants: Vec<String> = data.participants.iter().map(ToString::to_string).collect();
    let complete = |row: &Vec<Option<f64>>| row.iter().copied().collect::<Option<Vec<f64>>>();
    let mut subjects = Vec::new();
    let mut values = Vec::new();
    let mut dropped = Vec::new();
    for (who, row) in participants.iter().zip(&rows) {
        match complete(row) {
            Some(full) => {
                subjects.push(who.clone());
                values.push(full);
            }
            None => dropped.push(who.clone()),
        }
    }
    let n = subjects.len();
    let mut panel = Panel {
        measure: measure.to_owned(),
        title,
        unit,
        same,
        participants,
        rows,
        n,
        dropped,
        pairs: Vec::new(),
        comparison: None,
    };
    if n < 2 {
        return Ok(panel);
    }
    let names = ConditionId::AV.map(|c| c.to_string());
    let tested = WithinSubjects::from_rows(&names, &subjects, &values)?;
    let found = match friedman {
        Friedman::Exact => compare(&tested, ALPHA)?,
        Friedman::Approximate => compare_without_exact(&tested, ALPHA)?,
    };
    for (name, pair) in found.posthoc.pairs.iter() {
        let Some((first, second)) = name.split_once('|') else {
            continue;
        };
        panel.pairs.push(PanelPair {
            first: first.parse()?,
            second: second.parse()?,
            mean_difference: Some(pair.mean_diff).filter(|d| d.is_finite()),
            p: pair.p,
            p_holm: pair.p_adjusted,
        });
    }
    panel.comparison = Some(found);
    Ok(panel)
}
