//! A moment of a simulated drive, for the simulator view.

use crate::error::StudyError;
use maveric_domain::{ConditionId, Drive};
use maveric_ingest::{IngestSettings, read_log};
use maveric_report::figures::simulator_view::{SimulatorView, VehicleView};
use std::path::Path;

/// Width of every simulated vehicle, in m: the road frame knows lengths only.
const WIDTH_M: f64 = 1.9;
/// What the view reaches to, ahead and behind, in m.
const SIGHT_M: f64 = 90.0;
/// Trail behind and plan ahead, in s.
const PATH_S: f64 = 4.0;

/// The first moment of a drive in `condition` at which the car is half-way through a change to the left; without a change, the
/// drive's middle. `None` if there are no logs.
pub(super) fn view(
    logs: &Path,
    condition: Option<ConditionId>,
) -> Result<Option<SimulatorView>, StudyError> {
    let Ok(entries) = std::fs::read_dir(logs) else {
        return Ok(None);
    };
    let mut paths: Vec<_> = entries.filter_map(Result::ok).map(|e| e.path()).collect();
    paths.sort();
    let Some(path) = paths.into_iter().find(|p| {
        let name = p.to_string_lossy();
        condition.is_some_and(|c| name.ends_with(&format!("-{c}.mcap")))
    }) else {
        return Ok(None);
    };
    let Some(log) = read_log(&path, &IngestSettings::default())?.into_iter().next() else {
        return Ok(None);
    };
    let drive = Drive::from_recording(log.meta.clone(), &log.recording)?;
    let row =
        drive.lane_changes().first().map_or(drive.len() / 2, |c| usize::midpoint(c.start, c.end));
    let Some(scene) = log.recording.scene(row) else {
        return Ok(None);
    };
    let (x, y) = (&drive.rows().ego_x_m, &drive.rows().ego_y_m);
    let steps = (PATH_S * drive.rate_hz()) as usize;
    let path_between = |from: usize, to: usize| {
        (from..to.min(drive.len())).map(|i| (x[i], y[i])).collect::<Vec<_>>()
    };
    let heading = |i: usize| {
        let (a, b) = (i.saturating_sub(2), (i + 2).min(drive.len() - 1));
        libm::atan2(y[b] - y[a], x[b] - x[a])
    };
    let near: Vec<_> =
        scene.vehicles.iter().filter(|v| (v.x_m - scene.ego.x_m).abs() < SIGHT_M).collect();
    let reference = drive.rows().lead_id[row].and_then(|id| near.iter().position(|v| v.id.0 == id));
    let road = drive.road();
    Ok(Some(SimulatorView {
        participant: log.meta.participant.to_string(),
        condition: log.meta.condition,
        time_s: scene.time_s,
        lanes: usize::from(road.lanes),
        lane_width_m: road.lane_width_m,
        ego: VehicleView {
            x_m: scene.ego.x_m,
            y_m: scene.ego.y_m,
            heading_rad: heading(row),
            speed_mps: scene.ego.speed_mps,
            length_m: scene.ego.length_m,
            width_m: WIDTH_M,
        },
        others: near
            .iter()
            .map(|v| VehicleView {
                x_m: v.x_m,
                y_m: v.y_m,
                heading_rad: 0.0,
                speed_mps: v.speed_mps,
                length_m: v.length_m,
                width_m: WIDTH_M,
            })
            .collect(),
        reference,
        trail_m: path_between(row.saturating_sub(steps), row + 1),
        plan_m: path_between(row, row + steps),
    }))
}
