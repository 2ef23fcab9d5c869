//! One moment of a drive as SVG without text: what is seen where no script runs, and on paper.

use super::drive::PlayerDrive;
use super::pack::{SAMPLES_PER_S, Sampled};
use super::view::{STILL_M, View, half_height_m, stretch};
use std::fmt::Write as _;

/// Points of the picture for a metre of road.
const SCALE: f64 = 5.0;
/// Trail behind and way ahead, in s.
const PATH_S: f64 = 4.0;
/// Lane markings: a dash of 3 m every 12 m.
const DASH_M: (f64, f64) = (3.0, 12.0);

/// The moment, as a sample, at which most drives have a vehicle ahead at 5 to 60 m; the first of them, on a whole second.
pub(super) fn moment(drives: &[Sampled]) -> usize {
    let second = SAMPLES_PER_S as usize;
    let longest = drives.iter().map(|d| d.samples).max().unwrap_or(0);
    let near = |drive: &&Sampled, sample: usize| {
        let gap = drive.gap_m.get(sample).copied().flatten();
        gap.is_some_and(|gap| (5.0..60.0).contains(&gap))
    };
    let count = |sample: usize| drives.iter().filter(|d| near(d, sample)).count();
    let mut best = (0, 0);
    for sample in (0..longest).step_by(second) {
        let found = count(sample);
        if found > best.1 {
            best = (sample, found);
        }
    }
    best.0
}

/// Draws a drive at a sample; past its end, at its last.
pub(super) fn still(drive: &PlayerDrive, sampled: &Sampled, sample: usize) -> String {
    let sample = sample.min(sampled.samples - 1);
    let (high, across) = (half_height_m(drive), SCALE * stretch(drive));
    let (width, height) = ((STILL_M.0 + STILL_M.1) * SCALE, 2.0 * high * across);
    let mut out = format!(
        "<svg class=\"pl-still\" viewBox=\"0 0 {width:.0} {height:.0}\" aria-hidden=\"true\" focusable=\"false\">"
    );
    if !sampled.has(sample) {
        out.push_str("</svg>");
        return out;
    }
    let (ego_x, ego_y) = (sampled.x_m[sample], sampled.y_m[sample]);
    let view = View::new(drive, ego_x);
    let at = |x_m: f64, y_m: f64| {
        let (ahead, left, _) = view.see(x_m, y_m);
        ((ahead + STILL_M.0) * SCALE, (high - left) * across)
    };
    let edge_m = |line: u8| (f64::from(line) - 0.5) * drive.lane_width_m;
    let (from, to) = (ego_x - STILL_M.0, ego_x + STILL_M.1);
    let step = if drive.centre_line.is_some() {
        5.0
    } else {
        to - from
    };
    let along = |y_m: f64| -> Vec<(f64, f64)> {
        let steps = ((to - from) / step).round() as usize;
        (0..=steps)
            .map(|i| at(from + i as f64 * step, y_m))
            .collect()
    };
    let mut tarmac = along(edge_m(0));
    tarmac.extend(along(edge_m(drive.lanes)).into_iter().rev());
    path(&mut out, "pl-tarmac", &tarmac, true);
    path(&mut out, "pl-edge", &along(edge_m(0)), false);
    path(&mut out, "pl-edge", &along(edge_m(drive.lanes)), false);
    for line in 1..drive.lanes {
        let mut x_m = (from / DASH_M.1).floor() * DASH_M.1;
        while x_m < to {
            let dash = [at(x_m, edge_m(line)), at(x_m + DASH_M.0, edge_m(line))];
            path(&mut out, "pl-dash", &dash, false);
            x_m += DASH_M.1;
        }
    }
    let steps = (PATH_S * SAMPLES_PER_S) as usize;
    let drawn = |from: usize, to: usize| -> Vec<(f64, f64)> {
        (from..to.min(sampled.samples))
            .filter(|&i| sampled.has(i))
            .map(|i| at(sampled.x_m[i], sampled.y_m[i]))
            .collect()
    };
    let trail = drawn(sample.saturating_sub(steps), sample + 1);
    path(&mut out, "pl-trail", &trail, false);
    path(
        &mut out,
        "pl-way",
        &drawn(sample, sample + steps + 1),
        false,
    );
    let car = |out: &mut String, class: &str, (x_m, y_m): (f64, f64), turn: f64, size| {
        let (_, _, road) = view.see(x_m, y_m);
        let shape = body(at(x_m, y_m), road + turn, size, across / SCALE);
        path(out, class, &shape, true);
    };
    let lead = sampled.reference[sample];
    for seen in &sampled.seen {
        let Some(i) = sample.checked_sub(seen.run.first) else {
            continue;
        };
        let Some(&x_m) = seen.x_m.get(i) else {
            continue;
        };
        let class = if lead == Some(seen.id) {
            "pl-car pl-lead"
        } else {
            "pl-car"
        };
        let turn = heading(&seen.x_m, &seen.y_m, i);
        let size = (seen.length_m, seen.width_m);
        car(&mut out, class, (x_m, seen.y_m[i]), turn, size);
        if lead == Some(seen.id) && x_m - ego_x > 0.5 * (seen.length_m + drive.ego.length_m) {
            let gap = [
                at(ego_x + 0.5 * drive.ego.length_m, ego_y),
                at(x_m - 0.5 * seen.length_m, ego_y),
            ];
            path(&mut out, "pl-gap", &gap, false);
        }
    }
    let turn = heading(&sampled.x_m, &sampled.y_m, sample);
    let size = (drive.ego.length_m, drive.ego.width_m);
    car(&mut out, "pl-ego", (ego_x, ego_y), turn, size);
    out.push_str("</svg>");
    out
}

/// Direction of movement at a sample, from those beside it; 0 at standstill.
fn heading(x_m: &[f64], y_m: &[f64], i: usize) -> f64 {
    let (a, b) = (i.saturating_sub(1), (i + 1).min(x_m.len() - 1));
    let (dx, dy) = (x_m[b] - x_m[a], y_m[b] - y_m[a]);
    if libm::hypot(dx, dy) < 0.2 {
        0.0
    } else {
        libm::atan2(dy, dx)
    }
}

/// A car's outline: a box with its nose cut.
fn body(
    (cx, cy): (f64, f64),
    turn: f64,
    (length_m, width_m): (f64, f64),
    stretch: f64,
) -> Vec<(f64, f64)> {
    let (sin, cos) = libm::sincos(turn);
    [
        (-0.5, -0.5),
        (0.36, -0.5),
        (0.5, -0.28),
        (0.5, 0.28),
        (0.36, 0.5),
        (-0.5, 0.5),
    ]
    .map(|(along, left)| {
        let (x, y) = (along * length_m, left * width_m);
        (
            cx + (x * cos - y * sin) * SCALE,
            cy - (x * sin + y * cos) * SCALE * stretch,
        )
    })
    .to_vec()
}

fn path(out: &mut String, class: &str, points: &[(f64, f64)], closed: bool) {
    if points.len() < 2 {
        return;
    }
    let _ = write!(out, "<path class=\"{class}\" d=\"");
    for (i, (x, y)) in points.iter().enumerate() {
        let letter = if i == 0 { 'M' } else { 'L' };
        let _ = write!(out, "{letter}{x:.1} {y:.1}");
    }
    out.push_str(if closed { "Z\"/>" } else { "\"/>" });
}
