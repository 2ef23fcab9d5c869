//! Clocks that were set back, or that differ.

use crate::{
    median::median,
    raw::{EgoSample, EgoSamples, RawDrive, Timed},
};
use std::collections::BTreeSet;

/// How far a clock must go back to count as set anew, in ns.
pub(crate) const SET_BACK_NS: i64 = 1_000_000_000;
/// Samples that stay behind once a clock was set back; fewer are late messages.
const LASTING: usize = 10;
/// Way beyond which ego was put elsewhere, whatever its speed, in m; and how fast it may be, in m/s.
const ELSEWHERE_M: f64 = 10.0;
const FASTEST_MPS: f64 = 100.0;

/// A day, in ns.
const DAY_NS: u64 = 86_400_000_000_000;
/// Share of stamps that nobody set, above which they are no mistake of single messages.
const MOST_UNSET: f64 = 0.25;

/// First and last time, in ns.
type Span = (i64, i64);

/// Goes by times of receipt where header stamps cannot be compared: ego's clock was set back while it drove on, or ego and
/// the others, or its speeds, are on two clocks.
pub(crate) fn one_clock(drive: &mut RawDrive) -> Option<&'static str> {
    let ego = &drive.ego;
    let of_ego = Times::from_samples(ego);
    let (of_objects, of_speeds) =
        (Times::from_samples(&drive.objects), Times::from_samples(&drive.speeds));
    let clocks = [&of_ego, &of_objects, &of_speeds];
    if clocks.iter().any(|times| times.receipt_back) || ego.is_empty() {
        // Receipt goes back as well: nothing is gained.
        return None;
    }
    let set_back = if of_ego.back { restarts(ego) } else { Vec::new() };
    let elsewhere = |&i: &usize| {
        let (a, b) = (ego.at(i - 1), ego.at(i));
        let dt = b.log_ns.saturating_sub(a.log_ns) as f64 / 1e9;
        libm::hypot(b.x_m - a.x_m, b.y_m - a.y_m) > ELSEWHERE_M + FASTEST_MPS * dt
    };
    let apart = |a: Span, b: Span| a.1 < b.0 || b.1 < a.0;
    let other_clock = |other: &Times, none: bool| {
        !none && apart(of_ego.span, other.span) && !apart(of_ego.receipt_span, other.receipt_span)
    };
    let two = other_clock(&of_objects, drive.objects.is_empty());
    let speeds = other_clock(&of_speeds, drive.speeds.is_empty());
    let why = if set_back.iter().any(elsewhere) {
        // The world began anew with its clock: two pieces of a drive, which times of receipt would join.
        return None;
    } else if !set_back.is_empty() {
        "the clock of ego's header stamps was set back: times of receipt are used"
    } else if two {
        "ego and the others are on two clocks: times of receipt are used"
    } else if speeds {
        "ego and its speeds are on two clocks: times of receipt are used"
    } else {
        return None;
    };
    by_receipt(drive);
    Some(why)
}

/// Leaves out samples whose stamp nobody set, such as 0 or -1 among times of day; returns the number of their messages or rows.
///
/// Such a stamp is more than a day from the median one, and so is its distance from the time of receipt. Many of them are left to
/// what else is known of the clock.
pub(crate) fn leave_out_unset(drive: &mut RawDrive) -> usize {
    let mut messages = BTreeSet::new();
    leave_out_unset_of(&mut drive.ego, &mut messages);
    leave_out_unset_of(&mut drive.objects, &mut messages);
    leave_out_unset_of(&mut drive.speeds, &mut messages);
    if let Some(sightings) = &mut drive.sightings {
        leave_out_unset_of(sightings, &mut messages);
    }
    messages.len()
}

fn leave_out_unset_of(samples: &mut impl Timed, messages: &mut BTreeSet<(u32, i64)>) {
    let stamps = samples.stamps();
    let ends = stamps.iter().min().zip(stamps.iter().max());
    if ends.is_none_or(|(first, last)| last.abs_diff(*first) <= DAY_NS) {
        return;
    }
    let late =
        || stamps.iter().zip(samples.receipts()).map(|(stamp, log)| log.saturating_sub(*stamp));
    let middle = |mut values: Vec<i64>| {
        values.sort_unstable();
        values[values.len() / 2]
    };
    let (usual, usual_late) = (middle(stamps.to_vec()), middle(late().collect()));
    // Rows of a table have no time of receipt.
    let is_far = |(stamp, late): (&i64, i64)| {
        stamp.abs_diff(usual) > DAY_NS
            && (late.abs_diff(usual_late) > DAY_NS || late == 0 && *stamp <= 0)
    };
    let unset: Vec<bool> = stamps.iter().zip(late()).map(is_far).collect();
    let count = unset.iter().filter(|unset| **unset).count();
    if count as f64 > MOST_UNSET * unset.len() as f64 {
        return;
    }
    let places = samples.numbers().iter().zip(samples.receipts());
    let of_unset = places.zip(&unset).filter(|(_, unset)| **unset);
    messages.extend(of_unset.map(|((nth, log), _)| (*nth, *log)));
    samples.keep(|i| !unset[i]);
}

/// Puts every sample on its time of receipt.
pub(crate) fn by_receipt(drive: &mut RawDrive) {
    fn each(samples: &mut impl Timed) {
        *samples.stamps_mut() = samples.receipts().to_vec();
    }
    each(&mut drive.ego);
    each(&mut drive.objects);
    each(&mut drive.speeds);
    drive.sightings.iter_mut().for_each(each);
}

/// How stamps and times of receipt run.
struct Times {
    back: bool,
    receipt_back: bool,
    span: Span,
    receipt_span: Span,
}

impl Times {
    /// Of samples in the order of the file.
    fn from_samples(samples: &impl Timed) -> Self {
        let none = (i64::MAX, i64::MIN);
        let mut times = Self { back: false, receipt_back: false, span: none, receipt_span: none };
        let grow = |span: &mut Span, t: i64| *span = (span.0.min(t), span.1.max(t));
        for (&stamp, &log) in samples.stamps().iter().zip(samples.receipts()) {
            times.back |= stamp < times.span.1.saturating_sub(SET_BACK_NS);
            times.receipt_back |= log < times.receipt_span.1.saturating_sub(SET_BACK_NS);
            grow(&mut times.span, stamp);
            grow(&mut times.receipt_span, log);
        }
        times
    }
}

/// Where ego's stamps, in the order of the file, go back by more than a second and rise again from there.
fn restarts(ego: &EgoSamples) -> Vec<usize> {
    let stamps = &ego.stamp_ns;
    let mut starts = Vec::new();
    let mut most = i64::MIN;
    for (i, &stamp_ns) in stamps.iter().enumerate() {
        let limit = most.saturating_sub(SET_BACK_NS);
        if stamp_ns < limit {
            let next = &stamps[i..stamps.len().min(i + LASTING)];
            let rises = next.windows(2).filter(|w| w[1] > w[0]);
            if 2 * rises.count() >= next.len() && next.iter().all(|ns| *ns < limit) {
                starts.push(i);
                most = stamp_ns;
            }
        }
        most = most.max(stamp_ns);
    }
    starts
}

/// Least step between sorted times, as a share of the median one, of rows of one drive in any order.
const LEAST_STEP: f64 = 0.5;

/// Whether samples make one drive once they are sorted by time, whatever their order: each time comes once, in steps that are about
/// even, and ego is never put elsewhere. Of two runs over the same times one of the three fails.
fn is_one_drive(ego: &EgoSamples) -> bool {
    let mut sorted = ego.clone();
    sorted.sort();
    let sorted: Vec<EgoSample> = sorted.iter().collect();
    let step_s = |w: &[EgoSample]| w[1].stamp_ns.saturating_sub(w[0].stamp_ns) as f64 / 1e9;
    let mut steps: Vec<f64> = sorted.windows(2).map(step_s).collect();
    let Some(usual) = median(&mut steps) else {
        return false;
    };
    sorted.windows(2).all(|w| {
        let way = libm::hypot(w[1].x_m - w[0].x_m, w[1].y_m - w[0].y_m);
        step_s(w) >= LEAST_STEP * usual.max(f64::MIN_POSITIVE)
            && way <= ELSEWHERE_M + FASTEST_MPS * step_s(w)
    })
}

/// Returns the samples, in the order of the file, at which a further run over times that are there already begins.
pub(crate) fn runs(ego: &EgoSamples) -> Vec<usize> {
    let starts = restarts(ego);
    if starts.is_empty() || is_one_drive(ego) {
        return Vec::new();
    }
    let mut in_order = pieces(ego, &starts).1;
    in_order.sort_unstable();
    let twice = |w: &[Span]| w[1].0 < w[0].1.saturating_sub(SET_BACK_NS);
    if in_order.windows(2).any(twice) { starts } else { Vec::new() }
}

/// Bounds of the pieces that begin at some samples, and first and last time of each.
fn pieces(ego: &EgoSamples, starts: &[usize]) -> (Vec<usize>, Vec<Span>) {
    let bounds: Vec<usize> =
        [0].into_iter().chain(starts.iter().copied()).chain([ego.len()]).collect();
    let span = |b: &[usize]| {
        let times = || ego.stamp_ns[b[0]..b[1]].iter().copied();
        (times().min().unwrap_or(0), times().max().unwrap_or(0))
    };
    let pieces = bounds.windows(2).map(span).collect();
    (bounds, pieces)
}

/// Lays what follows a clock that was set back behind what stands before, `hole_ns` apart; gives the holes.
///
/// Only where times come twice: pieces of a file that are merely in another order are left to sorting. Samples are in
/// the order of the file. The others and the speeds go with ego by their place in the file, and between two pieces by their
/// time.
pub(crate) fn separate_restarts(drive: &mut RawDrive, hole_ns: i64) -> Vec<Span> {
    let ego = &mut drive.ego;
    let starts = runs(ego);
    if starts.is_empty() {
        return Vec::new();
    }
    let (bounds, pieces) = pieces(ego, &starts);
    let mut shifts = vec![0_i64];
    let mut holes = Vec::new();
    for w in pieces.windows(2) {
        let end = w[0].1.saturating_add(shifts[shifts.len() - 1]);
        let begin = end.saturating_add(hole_ns);
        shifts.push(begin.saturating_sub(w[1].0));
        holes.push((end, begin));
    }
    let first_nth: Vec<u32> = starts.iter().map(|&i| ego.nth[i]).collect();
    let last_nth: Vec<u32> = starts.iter().map(|&i| ego.nth[i - 1]).collect();
    let shift = |nth: u32, stamp_ns: i64| {
        let mut piece = first_nth.partition_point(|&first| first <= nth);
        // Between the last sample of one piece and the first of the next.
        if last_nth.get(piece).is_some_and(|&last| last < nth) {
            let to = |t: i64| stamp_ns.abs_diff(t);
            piece += usize::from(to(pieces[piece + 1].0) < to(pieces[piece].1));
        }
        stamp_ns.saturating_add(shifts[piece])
    };
    let (objects, speeds) = (&mut drive.objects, &mut drive.speeds);
    let sightings = drive.sightings.as_mut().map(|s| (&mut s.stamp_ns, &s.nth));
    let others = [(&mut objects.stamp_ns, &objects.nth), (&mut speeds.stamp_ns, &speeds.nth)];
    for (stamps, nths) in others.into_iter().chain(sightings) {
        for (stamp_ns, &nth) in stamps.iter_mut().zip(nths) {
            *stamp_ns = shift(nth, *stamp_ns);
        }
    }
    for (b, shift) in bounds.windows(2).zip(&shifts) {
        for stamp_ns in &mut ego.stamp_ns[b[0]..b[1]] {
            *stamp_ns = stamp_ns.saturating_add(*shift);
        }
    }
    holes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raw::ObjectSample;

    const STEP: i64 = 50_000_000;

    fn ego(nth: u32, stamp_ns: i64) -> EgoSample {
        EgoSample {
            stamp_ns,
            log_ns: stamp_ns,
            nth,
            x_m: 0.0,
            y_m: 0.0,
            yaw_rad: None,
            speed_mps: Some(1.0),
        }
    }

    fn object(nth: u32, stamp_ns: i64) -> ObjectSample {
        ObjectSample {
            stamp_ns,
            log_ns: stamp_ns,
            nth,
            id: 1,
            x_m: 0.0,
            y_m: 0.0,
            speed_mps: 1.0,
            length_m: f64::NAN,
        }
    }

    fn stamped(stamps: impl Iterator<Item = i64>) -> EgoSamples {
        (0..).zip(stamps).map(|(i, t)| ego(2 * i, t * STEP)).collect()
    }

    fn separated(ego: EgoSamples) -> (Vec<i64>, usize) {
        let mut drive = RawDrive { ego, ..RawDrive::default() };
        let holes = separate_restarts(&mut drive, 20 * STEP);
        let stamps = drive.ego.iter().map(|s| s.stamp_ns / STEP).collect();
        (stamps, holes.len())
    }

    #[test]
    fn a_clock_set_back_over_recorded_times_begins_behind_the_rest() {
        let (stamps, holes) = separated(stamped((0..100).chain(10..80).chain(0..30)));
        assert_eq!(holes, 2);
        let expected: Vec<i64> = (0..100).chain(119..189).chain(208..238).collect();
        assert_eq!(stamps, expected);
    }

    #[test]
    fn late_messages_and_pieces_in_another_order_are_left_to_sorting() {
        for stamps in [
            stamped((0..50).chain([5]).chain(50..90)),
            stamped((0..100).rev()),
            stamped((50..100).chain(0..50)),
        ] {
            let before: Vec<i64> = stamps.iter().map(|s| s.stamp_ns / STEP).collect();
            assert_eq!(separated(stamps), (before, 0));
        }
    }

    #[test]
    fn the_others_go_with_ego_by_their_place_in_the_file() {
        // Of the first piece; between both, of either; of the second.
        let mut drive = RawDrive {
            ego: stamped((0..100).chain(0..100)),
            objects: [
                object(199, 99 * STEP),
                object(199, 0),
                object(201, STEP),
                object(21, 10 * STEP),
            ]
            .into_iter()
            .collect(),
            ..RawDrive::default()
        };
        separate_restarts(&mut drive, 20 * STEP);
        let found: Vec<i64> = drive.objects.iter().map(|o| o.stamp_ns / STEP).collect();
        assert_eq!(found, [99, 119, 120, 10]);
    }
}
