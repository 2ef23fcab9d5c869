//! Whether values can be what log or mapping say: a wrong unit is easily declared.

use crate::{
    error::IngestError,
    median::median,
    quality::{Warning, WarningKind},
    raw::{EgoSample, RawDrive},
};
use maveric_domain::{EgoTrack, Road};
use std::{ops::RangeInclusive, path::Path};

/// Speeds beyond this are no car's, in m/s.
const FASTEST_MPS: f64 = 90.0;
/// Lengths of vehicles outside this are doubted, in m: a moped, a long truck.
const LENGTHS_M: (f64, f64) = (1.5, 26.0);
/// Slower than this a speed says little about units, in m/s.
const MOVING_MPS: f64 = 2.0;
/// Samples that a comparison of speed and movement needs.
const ENOUGH: usize = 20;
/// Speeds over what positions change a second that belong together.
const BORNE_OUT: RangeInclusive<f64> = 0.7..=1.4;
/// Share of impossible samples above which a log is refused: below it single values are wrong, above it a unit is.
const MOST_SHARE: f64 = 0.25;

/// Refuses a log in which too many samples are impossible.
///
/// # Errors
/// [`IngestError::Implausible`].
pub(crate) fn refuse_many(
    path: &Path,
    count: usize,
    of: usize,
    what: &str,
) -> Result<(), IngestError> {
    if of < ENOUGH || count as f64 <= MOST_SHARE * of as f64 {
        return Ok(());
    }
    Err(IngestError::Implausible {
        path: path.to_owned(),
        count,
        of,
        what: what.to_owned(),
    })
}

/// Leaves out samples with speeds that no car has, such as the 9999 that stands for none: they are holes as if nothing were there.
/// Samples are in the order of time.
///
/// # Errors
/// [`IngestError::Implausible`] where they are too many for chance.
pub(crate) fn leave_out_impossible(
    path: &Path,
    raw: &mut RawDrive,
) -> Result<Vec<Warning>, IngestError> {
    let by_row = raw.pair.is_some();
    let known = |v: Option<f64>| v.unwrap_or(0.0);
    let warnings = [
        left_out(path, "ego", &mut raw.ego, by_row, |s| {
            (known(s.speed_mps), s.stamp_ns, s.nth)
        })?,
        left_out(path, "ego", &mut raw.speeds, by_row, |s| {
            (s.speed_mps, s.stamp_ns, s.nth)
        })?,
        left_out(path, "others", &mut raw.objects, by_row, |s| {
            (s.speed_mps, s.stamp_ns, s.nth)
        })?,
    ];
    Ok(warnings.into_iter().flatten().collect())
}

/// Leaves out those whose speed (the first of what `of` gives, beside time and number) is no car's.
fn left_out<T>(
    path: &Path,
    whose: &str,
    samples: &mut Vec<T>,
    by_row: bool,
    of: impl Fn(&T) -> (f64, i64, u32),
) -> Result<Option<Warning>, IngestError> {
    let impossible = |s: &T| of(s).0.abs() > FASTEST_MPS;
    let (before, bad) = (samples.len(), samples.iter().filter(|s| impossible(s)));
    let bad: Vec<(i64, u32)> = bad
        .map(|s| {
            let (_, ns, nth) = of(s);
            (ns, nth)
        })
        .collect();
    if bad.is_empty() {
        return Ok(None);
    }
    let what = format!("speeds of {whose} are above {FASTEST_MPS} m/s");
    let refused = format!("{what}: is their unit right?");
    refuse_many(path, bad.len(), before, &refused)?;
    samples.retain(|s| !impossible(s));
    let rows = bad.iter().map(|(_, nth)| (nth + 1).to_string());
    let mut rows: Vec<String> = rows.take(Warning::MOST_SPANS + 1).collect();
    if rows.len() > Warning::MOST_SPANS {
        "and more".clone_into(&mut rows[Warning::MOST_SPANS]);
    }
    let which = if by_row {
        format!(" (rows {})", rows.join(", "))
    } else {
        String::new()
    };
    let what = format!("{what}, as no car drives: they are left out like empty ones{which}");
    let warning = Warning::new(path, WarningKind::Unit, bad.len(), what);
    let spans = bad.iter().map(|&(ns, _)| ns as f64 / 1e9);
    Ok(Some(warning.with_spans(spans.map(|t| (t, t)))))
}

/// Refuses a table whose ego drives against the x along which its road is said to run: left would be right.
///
/// # Errors
/// [`IngestError::Implausible`].
pub(crate) fn along_x(path: &Path, ego: &EgoTrack) -> Result<(), IngestError> {
    let (mut moving, mut against) = (0, 0);
    for (x, v) in ego.x_m.windows(2).zip(&ego.speed_mps) {
        if *v > MOVING_MPS {
            moving += 1;
            against += usize::from(x[1] < x[0]);
        }
    }
    let what = "ego's x falls while it drives forward: say `forward = \"-x\"` in the mapping's `[table]`, or \
                `directions = \"both\"` where vehicles drive both ways";
    refuse_many(path, against, moving, what)
}

/// Doubts about the units of a drive's samples, which are in the order of time.
pub(crate) fn doubts(path: &Path, raw: &RawDrive) -> Vec<Warning> {
    let mut doubts = Vec::new();
    let mut doubt = |count: usize, what: String| {
        if count > 0 {
            doubts.push(Warning::new(path, WarningKind::Unit, count, what));
        }
    };
    let ratio = |pair: &[EgoSample]| {
        let dt = pair[1].stamp_ns.saturating_sub(pair[0].stamp_ns) as f64 / 1e9;
        let v = pair[0].speed_mps?.abs();
        let told = v > MOVING_MPS && dt > 0.0 && dt < 1.0;
        let (dx, dy) = (pair[1].x_m - pair[0].x_m, pair[1].y_m - pair[0].y_m);
        let moved = (dx * dx + dy * dy).sqrt();
        (told && moved > 0.0).then(|| v * dt / moved)
    };
    let ratios = || raw.ego.windows(2).filter_map(ratio);
    let (least, most) = LENGTHS_M;
    let is_odd = |length_m: f64| !(least..=most).contains(&length_m);
    let (mut back, mut count, mut borne_out) = (0, 0, 0);
    let mut odd = usize::from(raw.ego_length_m.is_some_and(is_odd));
    for i in 0..raw.ego.len() {
        if let Some(v) = raw.ego[i].speed_mps {
            back += usize::from(v < -MOVING_MPS);
        }
        if let Some(ratio) = raw.ego.get(i..i + 2).and_then(ratio) {
            count += 1;
            borne_out += usize::from(BORNE_OUT.contains(&ratio));
        }
    }
    for object in &raw.objects {
        odd += usize::from(object.known_length_m().is_some_and(is_odd));
    }
    if 2 * back > raw.ego.len() {
        let what = "ego drives backwards most of the time: is the sign of its speed right?";
        doubt(back, what.to_owned());
    }
    doubt(
        odd,
        format!("lengths of vehicles are not between {least} and {most} m: is their unit right?"),
    );
    // Where most are borne out, so is the median.
    if count >= ENOUGH && 2 * borne_out <= count {
        let mut ratios: Vec<f64> = ratios().collect();
        let ratio = median(&mut ratios).unwrap_or(1.0);
        if !BORNE_OUT.contains(&ratio) {
            let what = format!(
                "ego's speed is {ratio:.2} times what its positions change a second: do the units of time, length \
                 and speed belong together?"
            );
            doubt(count, what);
        }
    }
    doubts
}

/// Doubts about ego's place across a road whose lanes are known: further than half a lane beside all of them.
///
/// # Errors
/// [`IngestError::Implausible`] where it is there most of the time.
pub(crate) fn on_the_road(
    path: &Path,
    ego: &[EgoSample],
    road: &Road,
) -> Result<Option<Warning>, IngestError> {
    let off = |s: &&EgoSample| road.lane_at(s.y_m).is_none();
    let off: Vec<f64> = ego
        .iter()
        .filter(off)
        .map(|s| s.stamp_ns as f64 / 1e9)
        .collect();
    let what = format!(
        "ego is beside the road of {} lanes of {} m: is `right_lane_centre_y_m` right, or, of numbered lanes, `lanes_from` and `first_lane`?",
        road.lanes, road.lane_width_m
    );
    refuse_many(path, off.len(), ego.len(), &what)?;
    Ok((!off.is_empty()).then(|| {
        let warning = Warning::new(path, WarningKind::Unit, off.len(), what);
        warning.with_spans(off.iter().map(|&t| (t, t)))
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn driving(speed_mps: f64) -> RawDrive {
        let ego = (0..100).map(|i| EgoSample {
            stamp_ns: i * 100_000_000,
            log_ns: 0,
            nth: 0,
            x_m: i as f64 * 2.0,
            y_m: 0.0,
            yaw_rad: None,
            speed_mps: Some(speed_mps),
        });
        RawDrive {
            ego: ego.collect(),
            ego_length_m: Some(4.7),
            ..RawDrive::default()
        }
    }

    #[test]
    fn a_speed_that_positions_contradict_is_doubted_and_one_they_bear_out_is_not() {
        let of = |speed: f64| doubts(Path::new("t"), &driving(speed));
        assert_eq!(of(20.0), []);
        for (kmh, times) in [(72.0, "3.60"), (20.0 / 3.6, "0.28")] {
            assert!(of(kmh)[0].what.contains(times));
        }
        assert!(of(-20.0)[0].what.contains("backwards"));
        let refused = leave_out_impossible(Path::new("t"), &mut driving(1e308)).unwrap_err();
        assert!(
            refused.to_string().contains("in 100 of 100 samples"),
            "{refused}"
        );
    }

    #[test]
    fn a_car_of_a_metre_and_a_speed_of_a_jet_are_doubted() {
        let mut raw = driving(20.0);
        raw.ego_length_m = Some(1.4);
        raw.ego[3].speed_mps = Some(300.0);
        let fast = leave_out_impossible(Path::new("t"), &mut raw).unwrap();
        assert_eq!(
            (fast.len(), fast[0].spans_s.as_slice()),
            (1, &[(0.3, 0.3)][..])
        );
        assert_eq!((raw.ego.len(), doubts(Path::new("t"), &raw).len()), (99, 1));
    }

    #[test]
    fn ego_beside_every_lane_is_counted_and_most_of_the_time_refused() {
        let mut drive = driving(20.0);
        let on = |drive: &RawDrive| on_the_road(Path::new("t"), &drive.ego, &Road::PAPER);
        assert_eq!(on(&drive).unwrap(), None);
        drive.ego[3].y_m = 9.0;
        drive.ego[4].y_m = -4.0;
        let warning = on(&drive).unwrap().unwrap();
        assert_eq!(warning.count, 2);
        assert_eq!(warning.spans_s.len(), 2);
        drive.ego.iter_mut().for_each(|s| s.y_m = 40.0);
        assert!(
            on(&drive)
                .unwrap_err()
                .to_string()
                .contains("beside the road")
        );
    }
}
