//! 9.1: the aggression line against the measures and the score; 9.4: what should not follow it.

use crate::{
    AnalysisError,
    correlations::{circular, correlate},
    data::StudyData,
    result::{AggressionLine, Correlation, Kept, LineRow},
};
use maveric_domain::{ConditionId, MetresPerSecond};
use maveric_measures::objective;
use maveric_stats::CorrelationMethod;

/// The measures that the paper found to follow the line, in its order.
pub(crate) const FOLLOWS: [&str; 5] = [
    "mean_velocity_mps",
    "mean_headway_time_s",
    "headway_merge_back_m",
    "lane_changes",
    "headway_merge_back_s",
];
/// Those that it found not to.
const DOES_NOT: [&str; 2] = ["min_headway_distance_m", "left_lane_fraction"];

/// Name for people of a measure.
pub(crate) fn title(measure: &str) -> String {
    objective::find(measure).map_or_else(|| measure.to_owned(), |m| m.title.to_owned())
}

/// Unit of a measure, empty for counts and shares.
pub(crate) fn unit(measure: &str) -> String {
    objective::find(measure)
        .map_or("", |m| if m.unit == "1" { "" } else { m.unit })
        .to_owned()
}

fn position(data: &StudyData, adb_used: bool) -> Vec<Option<f64>> {
    data.participants
        .iter()
        .map(|p| data.embedding(p, adb_used).and_then(|e| e.line_position))
        .collect()
}

fn own(data: &StudyData, measure: &str) -> Vec<Option<f64>> {
    data.participants
        .iter()
        .map(|p| data.measured(p, ConditionId::OWN, measure))
        .collect()
}

fn pairs(x: &[Option<f64>], y: &[Option<f64>]) -> Vec<(f64, f64)> {
    x.iter()
        .zip(y)
        .filter_map(|(x, y)| Some(((*x)?, (*y)?)))
        .collect()
}

/// Positions against the own drive's measures, and against ADB.
pub(crate) fn line(data: &StudyData, adb_used: bool) -> Result<AggressionLine, AnalysisError> {
    let positions = position(data, adb_used);
    let row = |measure: &str,
               title: String,
               values: Vec<Option<f64>>|
     -> Result<LineRow, AnalysisError> {
        let correlation = correlate(&positions, &values, CorrelationMethod::Pearson)?;
        Ok(LineRow {
            measure: measure.to_owned(),
            title,
            correlation,
            points: pairs(&positions, &values),
        })
    };
    let mut rows = Vec::new();
    for measure in FOLLOWS {
        rows.push(row(measure, title(measure), own(data, measure))?);
    }
    let adb = data
        .participants
        .iter()
        .map(|p| data.pre(p, "adb", "total"))
        .collect();
    rows.push(row("adb", "ADB score".to_owned(), adb)?);
    let mut ends = rows[0].points.clone();
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let velocity_ends_mph = ends
        .first()
        .zip(ends.last())
        .map(|(low, high)| (MetresPerSecond(low.1).mph(), MetresPerSecond(high.1).mph()));
    Ok(AggressionLine {
        adb_used,
        rows,
        velocity_ends_mph,
    })
}

/// Habits along the line and round the ellipse.
pub(crate) fn kept(data: &StudyData) -> Result<Vec<Kept>, AnalysisError> {
    let positions = position(data, true);
    let angle = |p: &_| data.condition(p, ConditionId::PERPENDICULAR)?.angle_rad;
    let angles: Vec<Option<f64>> = data
        .participants
        .iter()
        .map(|p| angle(p).map(|a| a.rem_euclid(std::f64::consts::TAU)))
        .collect();
    let one = |measure: &str| -> Result<Kept, AnalysisError> {
        let change = |p| {
            let mimic = data.measured(p, ConditionId::MIMIC, measure)?;
            Some(data.measured(p, ConditionId::PERPENDICULAR, measure)? - mimic)
        };
        let changes: Vec<Option<f64>> = data.participants.iter().map(change).collect();
        let round = circular(&angles, &changes)?;
        let line: Correlation =
            correlate(&positions, &own(data, measure), CorrelationMethod::Pearson)?;
        Ok(Kept {
            measure: measure.to_owned(),
            title: title(measure),
            unit: unit(measure),
            line,
            angle: correlate(&angles, &changes, CorrelationMethod::Pearson)?,
            circular_r: round.0,
            circular_p: round.1,
            points: pairs(&angles, &changes),
        })
    };
    DOES_NOT.iter().map(|measure| one(measure)).collect()
}
