//! One drive of the car.

use super::{Simulate, logs::log_of, rides::Ride};
use crate::{
    atomic_write::write_recording,
    error::StudyError,
    tables::drives::write_drive,
    watching::{WatchedDrive, braking},
};
use maveric_domain::{Drive, DriveId, DriveMeta, DrivenBy, Embedding, Recording, stream_seed};
use maveric_ingest::Beside;
use maveric_model::Model;
use maveric_report::html::CentreLine;
use maveric_simulator::{Driver, Rollout, RolloutReport, Scenario, SimulatorError, rollout};
use maveric_steering::ModelPlanner;

/// A drive that was driven to its end; with what the page plays where it is watched.
pub(super) struct Driven {
    pub(super) meta: DriveMeta,
    pub(super) rows: usize,
    pub(super) duration_s: f64,
    pub(super) report: RolloutReport,
    pub(super) watched: Option<WatchedDrive>,
}

/// The car with a style in a world of the scenario.
pub(crate) fn drive_style(
    model: &Model,
    style: &Embedding,
    scenario: &Scenario,
    world: u64,
) -> Result<Rollout, StudyError> {
    let mut planner = ModelPlanner::new(model, style, &scenario.settings().controllers)?;
    let controllers = planner.controllers();
    let driver = Driver::Automated(&mut planner, &controllers);
    let driven = rollout(scenario, driver, world)?;
    match planner.failure() {
        Some(error) => Err(error.into()),
        None => Ok(driven),
    }
}

/// A drive that ended early, and why.
pub(super) type Stopped = (DriveId, SimulatorError);

pub(super) fn drive(
    options: &Simulate,
    model: &Model,
    scenario: &Scenario,
    ride: &Ride<'_>,
    logged: bool,
    watched: bool,
) -> Result<Result<Driven, Stopped>, StudyError> {
    let (id, row) = (ride.id.clone(), ride.row);
    let seed = stream_seed(options.seed, &[id.as_str(), "world"]);
    let driven = drive_style(model, &row.embedding, scenario, seed)?;
    if let Some(why) = driven.stopped {
        return Ok(Err((id, why)));
    }
    let who = row.participant.clone();
    let meta = DriveMeta::new(id, who, row.condition, DrivenBy::Automated).on(ride.occasion);
    if logged {
        let beside = Beside { trace: &driven.trace, ..Beside::default() };
        let log = log_of(&options.out, meta.drive.as_str());
        write_recording(&log, &driven.recording, &meta, &beside)?;
    }
    let recorded = Drive::from_recording(meta.clone(), &driven.recording)?;
    write_drive(&options.out.join("drives"), &recorded)?;
    let watched = watched.then(|| {
        let interventions = Some(braking(&driven.trace));
        let road = centre_line(scenario, &driven.recording);
        WatchedDrive::new(meta.clone(), &driven.recording, interventions, road)
    });
    Ok(Ok(Driven {
        meta,
        rows: recorded.len(),
        duration_s: recorded.rows().time_s.last().copied().unwrap_or(0.0),
        report: driven.report,
        watched: watched.transpose()?,
    }))
}

/// Where a road that bends lies on the map, over the stretch that is driven and seen.
fn centre_line(scenario: &Scenario, recording: &Recording) -> Option<CentreLine> {
    const STEP_M: f64 = 10.0;
    const SIGHT_M: f64 = 200.0;
    let line = scenario.centre_line();
    if line.is_straight() {
        return None;
    }
    let x_m = &recording.ego().x_m;
    let start_m = x_m.iter().copied().fold(f64::MAX, f64::min) - SIGHT_M;
    let end_m = x_m.iter().copied().fold(f64::MIN, f64::max) + SIGHT_M;
    let places = ((end_m - start_m) / STEP_M).ceil() as usize + 1;
    let place = |i: usize| {
        let pose = line.map_pose(start_m + i as f64 * STEP_M, 0.0);
        (pose.x_m, pose.y_m)
    };
    Some(CentreLine { start_m, step_m: STEP_M, map_m: (0..places).map(place).collect() })
}
