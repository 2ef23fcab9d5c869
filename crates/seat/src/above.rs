//! A drive from above, as far as it has come in.

use crate::words::Words;
use maveric_domain::SpeedUnit;
use maveric_seat_page::{Record, SeatPageError, replay};
use std::fmt::Write as _;

/// How far the picture reaches behind and ahead, in m.
const BEHIND_M: f64 = 120.0;
const AHEAD_M: f64 = 280.0;
/// Units of the picture for a metre across the road: lanes would be lines otherwise.
const ACROSS: f64 = 4.0;
/// Size of the curve of speed.
const CURVE: (f64, f64) = (400.0, 60.0);
const MOST_POINTS: usize = 200;

/// The last scene of a record from above, and the speed until then, as SVG.
///
/// # Errors
/// [`SeatPageError`] for a record that cannot be driven again, or in which nothing was driven yet.
pub(crate) fn picture(
    lines: &str,
    words: &Words,
    unit: SpeedUnit,
) -> Result<String, SeatPageError> {
    let speed = |mps: f64| format!("{:.0} {}", mps * unit.per_mps(), unit.name());
    let record = Record::from_lines(lines)?;
    let again = replay(&record)?;
    let recording = &again.rollout.recording;
    let (road, ego) = (recording.road(), recording.ego());
    let rows = recording.rows();
    let nothing = || SeatPageError::Record { problem: "nothing was driven yet".to_owned() };
    let scene = rows.checked_sub(1).and_then(|row| recording.scene(row));
    let scene = scene.ok_or_else(nothing)?;
    let width = ACROSS * road.lane_width_m * f64::from(road.lanes);
    let down = |y_m: f64| width - ACROSS * (y_m + 0.5 * road.lane_width_m);
    let length = BEHIND_M + AHEAD_M;
    let mut svg = format!(
        "<svg viewBox=\"0 0 {length} {:.1}\" width=\"100%\" role=\"img\" aria-label=\"{}\">\
         <rect width=\"{length}\" height=\"{width:.1}\" fill=\"#55575c\"/>",
        width + CURVE.1 + 12.0,
        words.plain("lab_above", &[])
    );
    for lane in 1..road.lanes {
        let y = ACROSS * road.lane_width_m * f64::from(lane);
        let _ = write!(
            svg,
            "<line x1=\"0\" x2=\"{length}\" y1=\"{y:.1}\" y2=\"{y:.1}\" stroke=\"#fff\" stroke-dasharray=\"3 9\"/>"
        );
    }
    let mut car = |x_m: f64, y_m: f64, length_m: f64, fill: &str, title: &str| {
        let x = x_m - scene.ego.x_m + BEHIND_M - 0.5 * length_m;
        let (high, y) = (1.9 * ACROSS, down(y_m) - 0.95 * ACROSS);
        if (0.0..length).contains(&x) {
            let _ = write!(
                svg,
                "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{length_m:.1}\" height=\"{high:.1}\" rx=\"1\" fill=\"{fill}\"><title>{title}</title></rect>"
            );
        }
    };
    for v in &scene.vehicles {
        let title = speed(v.speed_mps);
        car(v.x_m, v.y_m, v.length_m, "#d6d7d9", &title);
    }
    let title = speed(scene.ego.speed_mps);
    car(scene.ego.x_m, scene.ego.y_m, scene.ego.length_m, "#4aa3ff", &title);
    let highest = ego.speed_mps.iter().copied().fold(10.0, f64::max);
    let every = rows.div_ceil(MOST_POINTS).max(1);
    let points: Vec<String> = (0..rows)
        .step_by(every)
        .map(|row| {
            let x = CURVE.0 * row as f64 / rows.max(2) as f64;
            let y = width + 8.0 + CURVE.1 * (1.0 - ego.speed_mps[row] / highest);
            format!("{x:.1},{y:.1}")
        })
        .collect();
    let report = &again.rollout.report;
    let line = words.plain(
        "lab_drive_line",
        &[
            ("seconds", &format!("{:.0}", scene.time_s)),
            ("speed", &speed(scene.ego.speed_mps)),
            ("most", &speed(highest)),
            ("contacts", &report.collisions.to_string()),
            ("touches", &report.barrier_touches.to_string()),
        ],
    );
    let _ = write!(
        svg,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"#4aa3ff\"/></svg><p>{line}</p>",
        points.join(" ")
    );
    Ok(svg)
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::DrivenBy;
    use maveric_seat_page::{Frames, Input, SeatDrive};
    use maveric_simulator::Scenario;

    #[test]
    fn speeds_are_said_in_the_units_of_the_study() {
        let scenario = Scenario::paper();
        let mut drive = SeatDrive::by_hand(&scenario, 1, DrivenBy::Scripted).unwrap();
        for _ in 0..50 {
            drive.tick(Input::default());
        }
        let head = serde_json::to_string(&drive.begun().header).unwrap();
        let piece = serde_json::to_string(&drive.chunk(Frames::default())).unwrap();
        let lines = format!("{head}\n{piece}\n");
        let mps = drive.session().car().speed_mps;
        for (unit, factor) in [(SpeedUnit::Kmh, 3.6), (SpeedUnit::Mph, 2.236_94)] {
            let drawn = picture(&lines, &Words::default(), unit).unwrap();
            let now = format!("; {:.0} {} now", mps * factor, unit.name());
            assert!(drawn.contains(&now) && !drawn.contains("m/s"), "{now}: {drawn}");
        }
    }
}
