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
        let near_count = count(sample);
        if near_count > best.1 {
            best = (sample, near_count);
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
    let point = |x_m: f64, y_m: f64| {
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
            .map(|i| point(from + i as f64 * step, y_m))
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
            let dash = [
                point(x_m, edge_m(line)),
                point(x_m + DASH_M.0, edge_m(line)),
            ];
            path(&mut out, "pl-dash", &dash, false);
            x_m += DASH_M.1;
        }
    }
    let steps = (PATH_S * SAMPLES_PER_S) as usize;
    let drawn = |from: usize, to: usize| -> Vec<(f64, f64)> {
        (from..to.min(sampled.samples))
            .filter(|&i| sampled.has(i))
            .map(|i| point(sampled.x_m[i], sampled.y_m[i]))
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
        let shape = body(point(x_m, y_m), road + turn, size, across / SCALE);
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
                point(ego_x + 0.5 * drive.ego.length_m, ego_y),
                point(x_m - 0.5 * seen.length_m, ego_y),
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

#[cfg(test)]
mod tests {
    use super::super::drive::Track;
    use super::super::pack::sample;
    use super::*;
    use maveric_domain::ConditionId;

    /// A straight road of two lanes, ego at 10 m/s in the right one, another car `ahead_m` before it in the left one.
    fn drive(ahead_m: f64) -> PlayerDrive {
        let n = 101_u32;
        let time_s: Vec<f64> = (0..n).map(|i| 0.1 * f64::from(i)).collect();
        let track = |id, x: f64, y: f64| Track {
            id,
            length_m: 4.0,
            width_m: 2.0,
            first_row: 0,
            x_m: time_s.iter().map(|t| x + 10.0 * t).collect(),
            y_m: vec![y; n as usize],
        };
        PlayerDrive {
            label: "One".to_owned(),
            note: "by hand".to_owned(),
            condition: ConditionId::new("same").unwrap(),
            lanes: 2,
            lane_width_m: 4.0,
            centre_line: None,
            segment: vec![0; n as usize],
            ego: track(0, 100.0, 0.0),
            speed_mps: vec![10.0; n as usize],
            gap_m: vec![Some(ahead_m - 4.0); n as usize],
            reference: vec![Some(1); n as usize],
            others: vec![track(1, 100.0 + ahead_m, 4.0), track(2, 60.0, 4.0)],
            lane_changes: Vec::new(),
            interventions: None,
            time_s,
        }
    }

    /// Corners of every path of a class.
    fn paths(svg: &str, class: &str) -> Vec<Vec<(f64, f64)>> {
        let mark = format!("class=\"{class}\" d=\"");
        let each = svg.split(&mark).skip(1).map(|rest| {
            let path = &rest[..rest.find('"').unwrap()];
            let corners = path.trim_end_matches('Z').split(['M', 'L']).skip(1);
            corners
                .map(|pair| {
                    let (x, y) = pair.split_once(' ').unwrap();
                    (x.parse().unwrap(), y.parse().unwrap())
                })
                .collect()
        });
        each.collect()
    }

    #[test]
    fn everything_stands_where_it_is_around_ego() {
        let drive = drive(30.0);
        let sampled = sample(&drive);
        let svg = still(&drive, &sampled, 25);
        // Five points a metre, across 1.6 times as much; ego 72 m from the left; two lanes of 4 m with a verge of 1.2 m.
        assert!(svg.contains("viewBox=\"0 0 1000 83\""), "{svg}");
        let (middle, across) = (5.2 * 8.0, 8.0);
        let at = |ahead: f64, left: f64| ((72.0 + ahead) * 5.0, middle - (left - 2.0) * across);
        let hull = |ahead: f64, left: f64| {
            let corners = [
                (-2.0, -1.0),
                (1.44, -1.0),
                (2.0, -0.56),
                (2.0, 0.56),
                (1.44, 1.0),
                (-2.0, 1.0),
            ];
            vec![corners.map(|(x, y)| at(ahead + x, left + y)).to_vec()]
        };
        let alike = |found: &[Vec<(f64, f64)>], expected: &[Vec<(f64, f64)>]| {
            assert_eq!(found.len(), expected.len());
            for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
                assert!(
                    (a.0 - b.0).abs() < 0.06 && (a.1 - b.1).abs() < 0.06,
                    "{found:?} instead of {expected:?}"
                );
            }
            let corners = |all: &[Vec<(f64, f64)>]| all.iter().map(Vec::len).collect::<Vec<_>>();
            assert_eq!(corners(found), corners(expected));
        };
        alike(&paths(&svg, "pl-ego"), &hull(0.0, 0.0));
        alike(&paths(&svg, "pl-car pl-lead"), &hull(30.0, 4.0));
        alike(&paths(&svg, "pl-car"), &hull(-40.0, 4.0));
        alike(&paths(&svg, "pl-gap"), &[vec![at(2.0, 0.0), at(28.0, 0.0)]]);
        let edge = |left: f64| vec![at(-72.0, left), at(128.0, left)];
        alike(&paths(&svg, "pl-edge"), &[edge(-2.0), edge(6.0)]);
        let tarmac = [edge(-2.0), edge(6.0).into_iter().rev().collect()].concat();
        alike(&paths(&svg, "pl-tarmac"), &[tarmac]);
        // Ego is at 150 m: a dash every 12 m of the road from 72 m on.
        let dashes: Vec<_> = (0..18)
            .map(|i| f64::from(72 + 12 * i) - 150.0)
            .filter(|x| *x < 128.0)
            .map(|x| vec![at(x, 2.0), at(x + 3.0, 2.0)])
            .collect();
        alike(&paths(&svg, "pl-dash"), &dashes);
        // Four seconds behind, at five samples a second and two metres each, and four ahead.
        let line =
            |from: i32, to: i32| vec![(from..=to).map(|i| at(2.0 * f64::from(i), 0.0)).collect()];
        alike(&paths(&svg, "pl-trail"), &line(-20, 0));
        alike(&paths(&svg, "pl-way"), &line(0, 20));
    }

    #[test]
    fn the_gap_is_drawn_to_a_car_ahead_alone_and_past_its_end_a_drive_stands_at_its_last() {
        for (ahead_m, drawn) in [(4.1, 1), (4.0, 0), (-30.0, 0)] {
            let drive = drive(ahead_m);
            let sampled = sample(&drive);
            let last = still(&drive, &sampled, sampled.samples - 1);
            assert_eq!(paths(&last, "pl-gap").len(), drawn, "{ahead_m}");
            assert_eq!(still(&drive, &sampled, 10_000), last);
            assert!(
                paths(&last, "pl-way").is_empty(),
                "nothing comes behind the end"
            );
        }
    }

    #[test]
    fn the_moment_is_the_first_whole_second_at_which_most_follow_somebody() {
        let mut first = sample(&drive(30.0));
        let mut second = first.clone();
        first.gap_m = (0..51)
            .map(|i| Some(if i < 11 { 61.0 } else { 20.0 }))
            .collect();
        second.gap_m = (0..51)
            .map(|i| Some(if i < 21 { 4.9 } else { 5.0 }))
            .collect();
        assert_eq!(moment(std::slice::from_ref(&first)), 15);
        assert_eq!(moment(&[first.clone(), second.clone()]), 25);
        second.gap_m = vec![Some(60.0); 51];
        assert_eq!(moment(&[second]), 0);
        assert_eq!(moment(&[]), 0);
    }

    #[test]
    fn a_car_points_where_it_moves_and_along_the_road_at_standstill() {
        let (x, y) = ([0.0, 1.0, 2.0, 2.0, 2.0], [0.0, 0.0, 1.0, 2.0, 2.05]);
        let at = |i: usize| heading(&x, &y, i);
        assert!((at(0) - 0.0).abs() < 1e-12);
        assert!((at(1) - 0.5_f64.atan()).abs() < 1e-12);
        assert!((at(3) - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert!((at(4) - 0.0).abs() < 1e-12, "5 cm are standstill");
    }
}
