//! The aggression line against the measures and the score, and the habits that should not follow it.

use crate::{
    AnalysisError,
    correlations::{circular, correlate},
    data::StudyData,
    family::holm,
    outcomes::{Asked, outcomes},
    result::{AggressionLine, Kept, LineRow},
};
use maveric_measures::objective;
use maveric_stats::CorrelationMethod;

fn position(data: &StudyData, adb_used: bool) -> Vec<Option<f64>> {
    data.participants
        .iter()
        .map(|p| data.embedding(p, adb_used).and_then(|e| e.line_position))
        .collect()
}

fn own(data: &StudyData, measure: &str) -> Vec<Option<f64>> {
    data.participants.iter().map(|p| data.baseline(p, measure)).collect()
}

fn pairs(x: &[Option<f64>], y: &[Option<f64>]) -> Vec<(f64, f64)> {
    x.iter().zip(y).filter_map(|(x, y)| Some(((*x)?, (*y)?))).collect()
}

/// Positions against the baseline drive's measures, and against the score; none without a style or without positions.
pub(crate) fn line(
    data: &StudyData,
    adb_used: bool,
) -> Result<Option<AggressionLine>, AnalysisError> {
    let positions = position(data, adb_used);
    let Some(style) = data.design.style().filter(|_| positions.iter().any(Option::is_some)) else {
        return Ok(None);
    };
    let row = |id: String, title: String, unit: String, values: Vec<Option<f64>>| {
        let points = pairs(&positions, &values);
        let mut ends = points.clone();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        let correlation = correlate(&positions, &values, CorrelationMethod::Pearson)?;
        Ok::<_, AnalysisError>(LineRow {
            measure: id,
            title,
            unit,
            correlation,
            ends: ends.first().zip(ends.last()).map(|(low, high)| (low.1, high.1)),
            points,
        })
    };
    let mut rows = Vec::new();
    for asked in outcomes(data).into_iter().filter(|a| a.column().is_some()) {
        let values = own(data, &asked.id);
        let mut line_row = row(asked.id, asked.title, asked.unit, values)?;
        // Correlated in the unit of the tables, shown in that of people.
        let shown = |v: f64| v * asked.factor;
        line_row.ends = line_row.ends.map(|(low, high)| (shown(low), shown(high)));
        line_row.points = line_row.points.iter().map(|(x, y)| (*x, shown(*y))).collect();
        rows.push(line_row);
    }
    let score = data.participants.iter().map(|p| data.pre(p, &style.score));
    rows.push(row(
        style.score.to_string(),
        style.label.clone(),
        "points".to_owned(),
        score.collect(),
    )?);
    Ok(Some(AggressionLine { adb_used, rows }))
}

/// Habits that aggression does not move, along the line and round the ellipse; nothing where no car moves across the dial.
pub(crate) fn kept(data: &StudyData) -> Result<Vec<Kept>, AnalysisError> {
    let (Some(across), Some(from)) = (data.design.across(), data.design.own_style()) else {
        return Ok(Vec::new());
    };
    let positions = position(data, true);
    let angle = |p: &_| data.condition(p, across)?.angle_rad;
    let angles: Vec<Option<f64>> = data
        .participants
        .iter()
        .map(|p| angle(p).map(|a| a.rem_euclid(std::f64::consts::TAU)))
        .collect();
    let one = |measure: &str| -> Result<Kept, AnalysisError> {
        let change = |p| {
            let from = data.measured(p, from, measure)?;
            Some(data.measured(p, across, measure)? - from)
        };
        let changes: Vec<Option<f64>> = data.participants.iter().map(change).collect();
        let round = circular(&angles, &changes)?;
        let outcome = Asked::measure(&data.design, measure);
        Ok(Kept {
            across,
            from,
            measure: measure.to_owned(),
            title: outcome.title,
            unit: outcome.unit,
            line: correlate(&positions, &own(data, measure), CorrelationMethod::Pearson)?,
            angle: correlate(&angles, &changes, CorrelationMethod::Pearson)?,
            circular_r: round.0,
            circular_p: round.1,
            circular_p_holm: None,
            points: pairs(&angles, &changes)
                .into_iter()
                .map(|(angle, change)| (angle, change * outcome.factor))
                .collect(),
        })
    };
    let habits = objective::all().iter().filter(|m| m.aggression.is_none());
    let mut rows: Vec<Kept> = habits.map(|m| one(m.name)).collect::<Result<_, _>>()?;
    let tested = rows.iter_mut();
    holm(tested.map(|k| (k.circular_p, &mut k.circular_p_holm)))?;
    Ok(rows)
}
