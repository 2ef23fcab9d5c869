//! Whether values can be what log or mapping say: a wrong unit is easily declared.

use crate::{
    error::IngestError,
    median::median,
    quality::{Warning, WarningKind, report},
    raw::{EgoSamples, RawDrive, Timed},
    speed_limits::{FASTEST_MPS, JUMP_M, MOVING_MPS},
    speed_windows::{ego_speed, others_speed},
};
use maveric_domain::{EgoTrack, Road};
use std::{ops::RangeInclusive, path::Path};

/// Lengths of vehicles outside this are doubted, in m: a moped, a long truck.
const LENGTHS_M: (f64, f64) = (1.5, 26.0);
/// How long a position may stay as it is while ego drives, in s: some receivers give one a second.
const HELD_S: f64 = 2.0;
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
    total: usize,
    what: &str,
) -> Result<(), IngestError> {
    if total < ENOUGH || count as f64 <= MOST_SHARE * total as f64 {
        return Ok(());
    }
    Err(IngestError::Implausible { path: path.to_owned(), count, of: total, what: what.to_owned() })
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
    let (ego, speeds, objects) = (&mut raw.ego, &mut raw.speeds, &mut raw.objects);
    let bad = [&ego.speed_mps, &speeds.speed_mps, &objects.speed_mps].map(|v| impossible(v));
    let warnings = [
        left_out(path, "ego", ego, &bad[0], by_row)?,
        left_out(path, "ego", speeds, &bad[1], by_row)?,
        left_out(path, "others", objects, &bad[2], by_row)?,
    ];
    Ok(warnings.into_iter().flatten().collect())
}

/// Places of speeds that no car has, in rising order.
fn impossible(speed_mps: &[f64]) -> Vec<usize> {
    let is_impossible = |v: f64| v.abs() > FASTEST_MPS;
    // Without a branch: almost always there are none.
    if !speed_mps.iter().fold(false, |some, v| some | is_impossible(*v)) {
        return Vec::new();
    }
    (0..speed_mps.len()).filter(|&i| is_impossible(speed_mps[i])).collect()
}

/// Leaves out the samples at some places, whose speed is no car's.
fn left_out(
    path: &Path,
    whose: &str,
    samples: &mut impl Timed,
    places: &[usize],
    by_row: bool,
) -> Result<Option<Warning>, IngestError> {
    if places.is_empty() {
        return Ok(None);
    }
    let before = samples.stamps().len();
    let bad: Vec<(i64, u32)> =
        places.iter().map(|&i| (samples.stamps()[i], samples.numbers()[i])).collect();
    let what = format!("speeds of {whose} are above {FASTEST_MPS} m/s");
    let refused = format!("{what}: is their unit right?");
    refuse_many(path, bad.len(), before, &refused)?;
    samples.keep(|i| places.binary_search(&i).is_err());
    let rows = bad.iter().map(|(_, nth)| (nth + 1).to_string());
    let mut rows: Vec<String> = rows.take(Warning::MOST_SPANS + 1).collect();
    if rows.len() > Warning::MOST_SPANS {
        "and more".clone_into(&mut rows[Warning::MOST_SPANS]);
    }
    let which = if by_row { format!(" (rows {})", rows.join(", ")) } else { String::new() };
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
    let unit = WarningKind::Unit;
    let ego = &raw.ego;
    // Of a sample and the next; none where ego stands, does not move or its speed is missing.
    let ratio = |i: usize| {
        let (dt, moved) = step(ego, i)?;
        let v = ego.speed_mps[i].abs();
        (v > MOVING_MPS && moved > 0.0).then(|| v * dt / moved)
    };
    let ratios = || (0..ego.len().saturating_sub(1)).filter_map(ratio);
    let (least, most) = LENGTHS_M;
    let is_odd = |length_m: f64| !(least..=most).contains(&length_m);
    let (mut count, mut borne_out) = (0, 0);
    for ratio in ratios() {
        count += 1;
        borne_out += usize::from(BORNE_OUT.contains(&ratio));
    }
    let back = ego.speed_mps.iter().filter(|v| **v < -MOVING_MPS).count();
    let lengths = raw.objects.length_m.iter().copied();
    let lengths = lengths.filter(|l| !l.is_nan()).chain(raw.ego_length_m);
    let odd = lengths.filter(|l| is_odd(*l)).count();
    if 2 * back > ego.len() {
        let what = "ego drives backwards most of the time: is the sign of its speed right?";
        report(&mut doubts, path, unit, back, what);
    }
    let what =
        format!("lengths of vehicles are not between {least} and {most} m: is their unit right?");
    report(&mut doubts, path, unit, odd, &what);
    let mut is_unit_odd = false;
    // Where most are borne out, so is the median.
    if count >= ENOUGH && 2 * borne_out <= count {
        let mut ratios: Vec<f64> = ratios().collect();
        let ratio = median(&mut ratios).unwrap_or(1.0);
        if !BORNE_OUT.contains(&ratio) {
            is_unit_odd = true;
            // A thousandth is a unit too.
            let ratio = if ratio < 0.1 { format!("{ratio:.4}") } else { format!("{ratio:.2}") };
            let what = format!(
                "ego's speed is {ratio} times what its positions change a second: do the units of time, length \
                 and speed belong together?"
            );
            report(&mut doubts, path, unit, count, &what);
        }
    }
    let (held, jumps) = (held(ego), jumps(ego));
    doubts.extend(held_warning(path, ego, &held));
    doubts.extend(jumps_warning(path, ego, &jumps));
    // A speed that fits nowhere is reported above.
    if !is_unit_odd {
        let mut reported: Vec<usize> = held.into_iter().flatten().chain(jumps).collect();
        reported.sort_unstable();
        doubts.extend(ego_speed(path, ego, &reported));
    }
    doubts.extend(others_speed(path, &raw.objects));
    doubts
}

/// The time in s and the way in m from a sample to the next; none over longer than a position is held.
fn step(ego: &EgoSamples, i: usize) -> Option<(f64, f64)> {
    let dt = ego.stamp_ns[i + 1].saturating_sub(ego.stamp_ns[i]) as f64 / 1e9;
    let (dx, dy) = (ego.x_m[i + 1] - ego.x_m[i], ego.y_m[i + 1] - ego.y_m[i]);
    (dt > 0.0 && dt < HELD_S).then(|| (dt, (dx * dx + dy * dy).sqrt()))
}

/// Runs of samples of ego at which it drives and stays where it is, for longer than a position is held.
fn held(ego: &EgoSamples) -> Vec<Vec<usize>> {
    let is_held = |i: usize| {
        ego.speed_mps[i].abs() > MOVING_MPS && step(ego, i).is_some_and(|(_, moved)| moved <= 0.0)
    };
    let held: Vec<usize> = (0..ego.len().saturating_sub(1)).filter(|&i| is_held(i)).collect();
    let runs = held.chunk_by(|a, b| a + 1 == *b).filter(|run| {
        let (from, to) = span_s(ego, run);
        to - from > HELD_S
    });
    runs.map(<[usize]>::to_vec).collect()
}

/// From the first of some steps to the end of the last, in s.
fn span_s(ego: &EgoSamples, steps: &[usize]) -> (f64, f64) {
    let second = |i: usize| ego.stamp_ns[i] as f64 / 1e9;
    (second(steps[0]), second(steps[steps.len() - 1] + 1))
}

fn held_warning(path: &Path, ego: &EgoSamples, held: &[Vec<usize>]) -> Option<Warning> {
    let count = held.iter().map(Vec::len).sum();
    let spans = held.iter().map(|run| span_s(ego, run));
    let what = "ego's position stays the same although its speed is not 0: are the columns of its position right?";
    (count > 0).then(|| Warning::new(path, WarningKind::Unit, count, what).with_spans(spans))
}

/// Steps of ego from one place to another that no car reaches in the time since it came to the first.
fn jumps(ego: &EgoSamples) -> Vec<usize> {
    let second = |i: usize| ego.stamp_ns[i] as f64 / 1e9;
    let (mut jumps, mut came) = (Vec::new(), 0);
    for i in 0..ego.len().saturating_sub(1) {
        let moved = step(ego, i).map(|(_, moved)| moved);
        let since_s = second(i + 1) - second(came);
        if moved.is_some_and(|moved| moved > FASTEST_MPS * since_s + JUMP_M) {
            jumps.push(i);
        }
        if moved.is_none_or(|moved| moved > 0.0) {
            came = i + 1;
        }
    }
    jumps
}

fn jumps_warning(path: &Path, ego: &EgoSamples, jumps: &[usize]) -> Option<Warning> {
    let spans = jumps.iter().map(|&i| span_s(ego, &[i]));
    let what = "ego's position jumps further than a car drives in that time: what is measured across the jump is not driven";
    (!jumps.is_empty())
        .then(|| Warning::new(path, WarningKind::Unit, jumps.len(), what).with_spans(spans))
}

/// Doubts about ego's place across a road whose lanes are known: further than half a lane beside all of them.
///
/// # Errors
/// [`IngestError::Implausible`] where it is there most of the time.
pub(crate) fn on_the_road(
    path: &Path,
    ego: &EgoSamples,
    road: &Road,
) -> Result<Option<Warning>, IngestError> {
    let off = off_the_road(ego, road);
    let what = format!(
        "ego is beside the road of {} lanes of {} m: are `lanes` and `right_lane_centre_y_m` right, and, of numbered lanes, `lanes_from` and `first_lane`?",
        road.lanes, road.lane_width_m
    );
    refuse_many(path, off.len(), ego.len(), &what)?;
    Ok(at_times(path, WarningKind::Unit, &off, &what))
}

/// Says that ego leaves the only lane that is known: by another lane's number, a lane change, or a bend.
pub(crate) fn in_the_only_lane(path: &Path, ego: &EgoSamples, road: &Road) -> Option<Warning> {
    let what = "ego is a lane or more beside the road's only lane: whoever is ahead of it there counts as its leader, and no lane change \
                is seen. If it changed lanes or its lane has another number, give `lanes` and, of numbered lanes, `first_lane`";
    let off = off_the_road(ego, road);
    at_times(path, WarningKind::OtherLane, &off, what)
}

/// Seconds at which ego is in none of the road's lanes.
fn off_the_road(ego: &EgoSamples, road: &Road) -> Vec<f64> {
    let places = ego.stamp_ns.iter().zip(&ego.y_m);
    places.filter(|(_, y)| road.lane_at(**y).is_none()).map(|(&ns, _)| ns as f64 / 1e9).collect()
}

fn at_times(path: &Path, kind: WarningKind, times_s: &[f64], what: &str) -> Option<Warning> {
    (!times_s.is_empty()).then(|| {
        let warning = Warning::new(path, kind, times_s.len(), what);
        warning.with_spans(times_s.iter().map(|&t| (t, t)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raw::EgoSample;

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
        RawDrive { ego: ego.collect(), ego_length_m: Some(4.7), ..RawDrive::default() }
    }

    #[test]
    fn a_speed_that_positions_contradict_is_doubted_and_one_they_bear_out_is_not() {
        let of = |speed: f64| doubts(Path::new("t"), &driving(speed));
        assert_eq!(of(20.0), []);
        for (kmh, times) in [(72.0, "3.60"), (20.0 / 3.6, "0.28")] {
            assert!(of(kmh)[0].what.contains(times));
        }
        let mut in_mm = driving(20.0);
        for x in &mut in_mm.ego.x_m {
            *x *= 1000.0;
        }
        let doubt = &doubts(Path::new("t"), &in_mm)[0].what;
        assert!(doubt.contains("0.0010 times"), "{doubt}");
        assert!(of(-20.0)[0].what.contains("backwards"));
        let refused = leave_out_impossible(Path::new("t"), &mut driving(1e308)).unwrap_err();
        assert!(refused.to_string().contains("in 100 of 100 samples"), "{refused}");
    }

    #[test]
    fn a_position_that_stays_for_long_or_jumps_is_told_and_that_of_a_receiver_is_not() {
        let of = |x_m: &dyn Fn(usize) -> f64| {
            let mut raw = driving(20.0);
            raw.ego.x_m = (0..100).map(x_m).collect();
            let doubts = doubts(Path::new("t"), &raw).into_iter();
            let doubts = doubts.map(|w| (w.what, w.count, w.spans_s.len()));
            doubts.collect::<Vec<_>>()
        };
        let still = of(&|_| 5.0);
        assert!(still[0].0.contains("stays the same"), "{still:?}");
        assert_eq!((still.len(), still[0].1, still[0].2), (1, 99, 1));
        // Three seconds of ten, and half a second.
        let held = |until: usize| {
            of(&|i| {
                let held = (20..=until).contains(&i);
                2.0 * if held { 20.0 } else { i as f64 }
            })
        };
        let frozen = held(50);
        assert_eq!((frozen.len(), frozen[0].1, frozen[0].2), (1, 30, 1));
        assert_eq!(held(25), []);
        // A receiver's position a second: between two of them ego does not move.
        assert_eq!(of(&|i| 2.0 * (i - i % 10) as f64), []);
        let jump = |by_m: f64| of(&|i| 2.0 * i as f64 + if i < 50 { 0.0 } else { by_m });
        let far = jump(500.0);
        assert!(far[0].0.contains("jumps further"), "{far:?}");
        assert_eq!((far.len(), far[0].1), (1, 1));
        assert_eq!(jump(15.0), []);
        let mut parked = driving(0.0);
        parked.ego.x_m.fill(5.0);
        assert_eq!(doubts(Path::new("t"), &parked), []);
    }

    #[test]
    fn samples_of_one_a_second_are_doubted_as_others_are() {
        let of = |x_m: &dyn Fn(usize) -> f64| {
            let mut raw = driving(20.0);
            for (second, stamp_ns) in (0..).zip(&mut raw.ego.stamp_ns) {
                *stamp_ns = second * 1_000_000_000;
            }
            raw.ego.x_m = (0..100).map(x_m).collect();
            let doubts = doubts(Path::new("t"), &raw).into_iter();
            doubts.map(|w| w.what).collect::<Vec<_>>()
        };
        assert_eq!(of(&|i| 20.0 * i as f64), Vec::<String>::new());
        let in_feet = of(&|i| 20.0 * i as f64 / 0.3048);
        assert!(in_feet[0].contains("0.30 times"), "{in_feet:?}");
        let still = of(&|_| 5.0);
        assert!(still[0].contains("stays the same"), "{still:?}");
        let far = of(&|i| 20.0 * i as f64 + if i < 50 { 0.0 } else { 500.0 });
        assert!(far[0].contains("jumps further"), "{far:?}");
    }

    #[test]
    fn a_car_of_a_metre_and_a_speed_of_a_jet_are_doubted() {
        let mut raw = driving(20.0);
        raw.ego_length_m = Some(1.4);
        raw.ego.speed_mps[3] = 300.0;
        let fast = leave_out_impossible(Path::new("t"), &mut raw).unwrap();
        assert_eq!((fast.len(), fast[0].spans_s.as_slice()), (1, &[(0.3, 0.3)][..]));
        assert_eq!((raw.ego.len(), doubts(Path::new("t"), &raw).len()), (99, 1));
    }

    #[test]
    fn ego_beside_every_lane_is_counted_and_most_of_the_time_refused() {
        let mut drive = driving(20.0);
        let on = |drive: &RawDrive| on_the_road(Path::new("t"), &drive.ego, &Road::PAPER);
        assert_eq!(on(&drive).unwrap(), None);
        drive.ego.y_m[3] = 9.0;
        drive.ego.y_m[4] = -4.0;
        let warning = on(&drive).unwrap().unwrap();
        assert_eq!(warning.count, 2);
        assert_eq!(warning.spans_s.len(), 2);
        drive.ego.y_m.fill(40.0);
        assert!(on(&drive).unwrap_err().to_string().contains("beside the road"));
    }
}
