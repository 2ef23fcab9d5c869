//! What the study was set to, as far as the paper gives it too: for the claims ledger.

use super::Run;
use crate::{error::StudyError, mean::mean, tables::conditions::ConditionRow};
use maveric_domain::{ConditionId, MetresPerSecond, Road};
use maveric_model::style_space::PerpendicularEllipse;
use maveric_simulator::Scenario;
use std::collections::BTreeSet;

/// Keys and values, in the claims' units.
pub(super) fn setup(
    run: &Run,
    road: Option<&Road>,
    minutes: Option<f64>,
    scenario: Option<&Scenario>,
) -> Result<Vec<(String, f64)>, StudyError> {
    let moved = run.conditions.iter().filter_map(|c| Some(c.moved_points?.abs()));
    let conditions: BTreeSet<ConditionId> = run.conditions.iter().map(|c| c.condition).collect();
    let mut values: Vec<(String, f64)> = Vec::new();
    let mut set = |key: &str, value: Option<f64>| {
        values.extend(value.map(|value| (key.to_owned(), value)));
    };
    set("steer.adb_shift_points", Some(moved.fold(0.0, f64::max)));
    set("steer.conditions", Some(conditions.len() as f64));
    set("model.losses", losses(run).map(|n| n as f64));
    set("scenario.drive_minutes", minutes.map(f64::round));
    let posted = road.map(|r| MetresPerSecond(r.posted_speed_mps).mph());
    set("scenario.posted_speed_mph", posted);
    set("scenario.lanes", road.map(|r| f64::from(r.lanes)));
    set("steer.lowest_points", run.score_range().map(|r| r.0));
    set("steer.highest_points", run.score_range().map(|r| r.1));
    let size = run.model.as_ref().map(|m| m.embedding_size() as f64);
    set("model.embedding_size", size);
    set("steer.across_sd", across_sd(run)?);
    if let Some(leads) = scenario.map(|s| &s.settings().leads) {
        let factors = leads.factors_of_target.iter().chain(&leads.factors_of_posted);
        values.extend(
            factors.enumerate().map(|(i, f)| (format!("scenario.lead_speed.{}", i + 1), *f)),
        );
    }
    Ok(values)
}

/// How many of the five losses took part in the training; none for heads that have none.
fn losses(run: &Run) -> Option<usize> {
    let last = run.training.as_ref()?.networks.as_ref()?.epochs.last()?;
    let l = &last.losses;
    let terms =
        [l.following_distance, l.lane_change, l.velocity, l.aggression, l.mutual_information];
    Some(terms.iter().flatten().count())
}

/// Mean distance of the condition across the dial from that at 0, each half-axis of the ellipse counted as 1.
fn across_sd(run: &Run) -> Result<Option<f64>, StudyError> {
    let (Some(model), Some(at_0), Some(across)) =
        (&run.model, run.design.own_style(), run.design.across())
    else {
        return Ok(None);
    };
    if model.embedding_size() < 2 {
        return Ok(None);
    }
    let round = PerpendicularEllipse::of(model)?;
    let own_of = |row: &ConditionRow| {
        let is_own = |c: &&ConditionRow| c.participant == row.participant && c.condition == at_0;
        run.conditions.iter().find(is_own)
    };
    let distance = |row: &ConditionRow| {
        let (to, from) = (row.embedding.coordinates(), own_of(row)?.embedding.coordinates());
        let axes = round.axes().iter().zip(round.half_axes());
        let squares = axes.map(|(axis, half)| {
            let along: f64 =
                axis.iter().zip(to.iter().zip(from)).map(|(a, (t, f))| a * (t - f)).sum();
            (along / half).powi(2)
        });
        Some(squares.sum::<f64>().sqrt())
    };
    let across = run.conditions.iter().filter(|c| c.condition == across);
    let distances: Vec<f64> = across.filter_map(distance).filter(|d| d.is_finite()).collect();
    Ok(mean(&distances))
}
