//! One clock, in order, each time once.

use crate::{
    clock::{by_receipt, separate_restarts},
    median::median,
    quality::{Warning, WarningKind, report},
    raw::{EgoSamples, RawDrive, Timed},
};
use std::path::Path;

/// Median difference between times of receipt and stamps that is worth a word, in s.
const SKEW_S: f64 = 0.1;

/// Puts all samples on header stamps, sorted, each vehicle once a time.
///
/// Where ego, the others or the speeds carry no stamps (all zero), all go by times of receipt: two clocks cannot be
/// compared. Where the clock was set back over times that are recorded already, what follows is laid behind the rest with
/// a hole of more than `max_gap_s` between. Afterwards `stamp_ns` counts from ego's first sample.
pub(crate) fn synchronise(path: &Path, drive: &mut RawDrive, max_gap_s: f64) -> Vec<Warning> {
    let mut warnings = Vec::new();
    // A single stamp may well be 0, and so may a time of receipt beside it.
    if unstamped(&drive.ego) || unstamped(&drive.objects) || unstamped(&drive.speeds) {
        let count = drive.ego.len() + drive.objects.len() + drive.speeds.len();
        let what = "no header stamps: times of receipt are used";
        warnings.push(Warning::new(path, WarningKind::ReceiveTime, count, what));
        by_receipt(drive);
    } else {
        warnings.extend(skew(path, &drive.ego));
    }
    let restarts = separate_restarts(drive, hole_ns(max_gap_s));
    order(path, "ego", &mut drive.ego, &mut warnings);
    order(path, "the others", &mut drive.objects, &mut warnings);
    order(path, "its speed", &mut drive.speeds, &mut warnings);
    // What was wrong with their order the others told.
    if let Some(sightings) = drive.sightings.as_mut().filter(|s| !s.rises()) {
        sightings.sort();
        sightings.dedup();
    }
    let start = drive.ego.stamp_ns.first().copied().unwrap_or(0);
    if !restarts.is_empty() {
        let what = "the clock was set back over times that are recorded already: what follows is laid behind the rest, after a hole of no known length";
        let seconds = |ns: i64| ns.saturating_sub(start) as f64 / 1e9;
        let spans = restarts.iter().map(|s| (seconds(s.0), seconds(s.1)));
        let warning = Warning::new(path, WarningKind::ClockRestart, restarts.len(), what);
        warnings.push(warning.with_spans(spans));
    }
    if start == 0 {
        return warnings;
    }
    let sightings = drive.sightings.as_mut().map(|s| &mut s.stamp_ns);
    let others = [&mut drive.ego.stamp_ns, &mut drive.objects.stamp_ns, &mut drive.speeds.stamp_ns];
    for stamps in others.into_iter().chain(sightings) {
        for stamp_ns in stamps {
            *stamp_ns = stamp_ns.saturating_sub(start);
        }
    }
    warnings
}

/// The hole before what follows a clock that began anew, in ns: of unknown length, and longer than those that are bridged.
pub(crate) fn hole_ns(max_gap_s: f64) -> i64 {
    ((2.0 * max_gap_s).max(1.0) * 1e9) as i64
}

/// Whether nobody stamped these samples.
fn unstamped(samples: &impl Timed) -> bool {
    samples.stamps().iter().all(|&ns| ns == 0) && samples.receipts().iter().any(|&ns| ns != 0)
}

fn skew(path: &Path, ego: &EgoSamples) -> Option<Warning> {
    let times = || ego.log_ns.iter().zip(&ego.stamp_ns);
    let late = |(log, stamp): (&i64, &i64)| (i128::from(*log) - i128::from(*stamp)) as f64 / 1e9;
    // Where most are in time, so is the median.
    let most_ns = (SKEW_S * 1e9) as u64;
    let in_time = |(log, stamp): &(&i64, &i64)| log.abs_diff(**stamp) <= most_ns;
    if 2 * times().filter(in_time).count() > ego.len() {
        return None;
    }
    let mut late: Vec<f64> = times().map(late).collect();
    let median = median(&mut late)?;
    (median.abs() > SKEW_S).then(|| {
        let what = format!(
            "ego's times of receipt are {median:.3} s behind its header stamps (median): stamps are used"
        );
        Warning::new(path, WarningKind::ReceiveSkew, late.len(), what)
    })
}

fn order(path: &Path, who: &str, samples: &mut impl Timed, warnings: &mut Vec<Warning>) {
    // What almost every log is: finite, in order, each once.
    if samples.rises() && samples.all_finite() {
        return;
    }
    let before = samples.stamps().len();
    let finite = samples.finite();
    samples.keep(|i| finite[i]);
    let left_out = before - samples.stamps().len();
    let what = format!("samples of {who} with a value that is not finite are left out");
    report(warnings, path, WarningKind::MissingValue, left_out, &what);

    let backwards = samples.stamps().windows(2).filter(|w| w[1] < w[0]);
    let backwards = backwards.count();
    // Stable: of two samples at one time the first that came is kept.
    samples.sort();
    let what = format!("samples of {who} came out of order and were sorted");
    report(warnings, path, WarningKind::OutOfOrder, backwards, &what);

    let before = samples.stamps().len();
    samples.dedup();
    let left_out = before - samples.stamps().len();
    let what = format!("second samples of {who} at one time are left out");
    report(warnings, path, WarningKind::DuplicateTime, left_out, &what);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raw::EgoSample;

    fn ego(stamp_ns: i64, log_ns: i64, x_m: f64) -> EgoSample {
        EgoSample { stamp_ns, log_ns, nth: 0, x_m, y_m: 0.0, yaw_rad: None, speed_mps: Some(1.0) }
    }

    fn kinds(drive: &mut RawDrive) -> Vec<WarningKind> {
        let warnings = synchronise(Path::new("log"), drive, 0.5);
        warnings.iter().map(|w| w.kind).collect()
    }

    #[test]
    fn samples_are_sorted_and_the_first_of_one_time_is_kept() {
        let samples = [(30, 3.0), (10, 1.0), (20, 2.0), (20, 9.0), (40, f64::NAN)];
        let mut drive = RawDrive {
            ego: samples.map(|(t, x)| ego(t, t, x)).into_iter().collect(),
            ..RawDrive::default()
        };
        let found = kinds(&mut drive);
        let left: Vec<(i64, f64)> = drive.ego.iter().map(|s| (s.stamp_ns, s.x_m)).collect();
        assert_eq!(left, [(0, 1.0), (10, 2.0), (20, 3.0)]);
        assert_eq!(
            found,
            [WarningKind::MissingValue, WarningKind::OutOfOrder, WarningKind::DuplicateTime]
        );
    }

    #[test]
    fn without_stamps_times_of_receipt_are_used_and_said() {
        let mut drive = RawDrive {
            ego: [ego(0, 5, 1.0), ego(0, 7, 2.0)].into_iter().collect(),
            ..RawDrive::default()
        };
        assert_eq!(kinds(&mut drive), [WarningKind::ReceiveTime]);
        assert_eq!(drive.ego.stamp_ns[1], 2);
    }

    #[test]
    fn late_receipt_is_reported_and_stamps_are_used() {
        let mut drive = RawDrive {
            ego: [ego(0, 2_000_000_000, 1.0), ego(50, 2_000_000_050, 2.0)].into_iter().collect(),
            ..RawDrive::default()
        };
        assert_eq!(kinds(&mut drive), [WarningKind::ReceiveSkew]);
        assert_eq!(drive.ego.stamp_ns[1], 50);
    }
}
