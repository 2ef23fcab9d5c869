//! Whether speeds fit positions in each window of a drive: a signal that is lost for a while is right on the whole.

use crate::{
    quality::{Warning, WarningKind},
    raw::{EgoSamples, ObjectSamples},
    speed_limits::{FASTEST_MPS, JUMP_M, MOVING_MPS},
};
use std::{collections::BTreeMap, path::Path};

/// Length of a window, in s: in less, a position that a receiver gives every other second says little.
const WINDOW_S: f64 = 10.0;
/// Longest time between two samples of one window, in s.
const STEP_S: f64 = 2.0;
/// Share of the way by positions below which the way by speeds is too short, or the other way round.
const LEAST_SHARE: f64 = 0.7;

/// A time, a place and a speed of one vehicle.
#[derive(Debug, Clone, Copy)]
struct Sample {
    time_s: f64,
    x_m: f64,
    y_m: f64,
    speed_mps: f64,
}

/// Warns of windows in which ego's speed does not fit its positions.
///
/// Steps from the samples in `left_out` are reported otherwise: no window contains them.
pub(crate) fn ego_speed(path: &Path, ego: &EgoSamples, left_out: &[usize]) -> Option<Warning> {
    let sample = |i: usize| Sample {
        time_s: ego.stamp_ns[i] as f64 / 1e9,
        x_m: ego.x_m[i],
        y_m: ego.y_m[i],
        speed_mps: ego.speed_mps[i],
    };
    let samples: Vec<Sample> = (0..ego.len()).map(sample).collect();
    warning(path, "ego", [misfits(&samples, left_out)])
}

/// Warns of windows in which the speed of another vehicle does not fit its positions.
pub(crate) fn others_speed(path: &Path, objects: &ObjectSamples) -> Option<Warning> {
    let mut vehicles: BTreeMap<u32, Vec<Sample>> = BTreeMap::new();
    for i in (0..objects.len()).filter(|&i| !objects.speed_mps[i].is_nan()) {
        vehicles.entry(objects.id[i]).or_default().push(Sample {
            time_s: objects.stamp_ns[i] as f64 / 1e9,
            x_m: objects.x_m[i],
            y_m: objects.y_m[i],
            speed_mps: objects.speed_mps[i],
        });
    }
    warning(path, "another vehicle", vehicles.values().map(|samples| misfits(samples, &[])))
}

fn warning(
    path: &Path,
    whose: &str,
    misfits: impl IntoIterator<Item = Misfits>,
) -> Option<Warning> {
    let (mut count, mut spans) = (0, Vec::new());
    for found in misfits {
        count += found.samples;
        spans.extend(found.spans_s);
    }
    let what = format!(
        "the speed of {whose} does not fit its positions within {WINDOW_S} s, so measures of it are doubtful there. Was a signal lost or frozen?"
    );
    (count > 0)
        .then(|| Warning::new(path, WarningKind::Contradiction, count, what).with_spans(spans))
}

/// Samples in windows whose speed does not fit, and the spans that these windows cover together.
#[derive(Debug, Default)]
struct Misfits {
    samples: usize,
    spans_s: Vec<(f64, f64)>,
}

fn misfits(samples: &[Sample], left_out: &[usize]) -> Misfits {
    let mut found = Misfits::default();
    for run in runs(samples, left_out) {
        let samples = &samples[run.0..run.1];
        // Ways up to each sample, by speeds and by positions.
        let (mut driven, mut moved) = (vec![0.0], vec![0.0]);
        for w in samples.windows(2) {
            let dt = w[1].time_s - w[0].time_s;
            let mean_mps = 0.5 * (w[0].speed_mps.abs() + w[1].speed_mps.abs());
            driven.push(driven[driven.len() - 1] + mean_mps * dt);
            moved.push(moved[moved.len() - 1] + distance(&w[0], &w[1]));
        }
        let (mut begin, mut covered) = (0, 0);
        for end in 1..samples.len() {
            while samples[end].time_s - samples[begin + 1].time_s >= WINDOW_S {
                begin += 1;
            }
            let length_s = samples[end].time_s - samples[begin].time_s;
            if length_s < WINDOW_S {
                continue;
            }
            let by_speed = driven[end] - driven[begin];
            // The true way is no shorter than the chord and, with noise, no longer than all steps together.
            let chord = distance(&samples[begin], &samples[end]);
            let steps = moved[end] - moved[begin];
            let slack = MOVING_MPS * length_s;
            let too_short = by_speed < LEAST_SHARE * chord && by_speed < chord - slack;
            let too_long = steps < LEAST_SHARE * by_speed && steps < by_speed - slack;
            if too_short || too_long {
                let span = (samples[begin].time_s, samples[end].time_s);
                found.samples += end + 1 - begin.max(covered);
                covered = end + 1;
                match found.spans_s.last_mut().filter(|last| span.0 <= last.1) {
                    Some(last) => last.1 = span.1,
                    None => found.spans_s.push(span),
                }
            }
        }
    }
    found
}

/// Stretches of samples without a hole, a jump or a step that is left out: from the first to behind the last.
fn runs(samples: &[Sample], left_out: &[usize]) -> Vec<(usize, usize)> {
    let is_step = |i: usize| {
        let dt = samples[i + 1].time_s - samples[i].time_s;
        let reach_m = FASTEST_MPS * dt + JUMP_M;
        dt <= STEP_S && distance(&samples[i], &samples[i + 1]) <= reach_m
    };
    let mut runs = Vec::new();
    let mut first = 0;
    for i in 0..samples.len() {
        let is_last = i + 1 == samples.len();
        if is_last || !is_step(i) || left_out.binary_search(&i).is_ok() {
            runs.push((first, i + 1));
            first = i + 1;
        }
    }
    runs
}

fn distance(a: &Sample, b: &Sample) -> f64 {
    libm::hypot(b.x_m - a.x_m, b.y_m - a.y_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A minute at 10 Hz at 20 m/s, with the speed that is recorded.
    fn spans_s(speed_mps: impl Fn(f64) -> f64, x_m: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        let sample = |i: u32| {
            let time_s = f64::from(i) / 10.0;
            Sample { time_s, x_m: x_m(time_s), y_m: 0.0, speed_mps: speed_mps(time_s) }
        };
        let samples: Vec<Sample> = (0..600).map(sample).collect();
        misfits(&samples, &[]).spans_s
    }

    #[test]
    fn lost_speed_is_found_in_its_windows() {
        let even = |t: f64| 20.0 * t;
        let lost = spans_s(|t| if (24.0..36.0).contains(&t) { 0.0 } else { 20.0 }, even);
        assert_eq!(lost.len(), 1);
        assert!((15.0..25.0).contains(&lost[0].0) && (35.0..45.0).contains(&lost[0].1), "{lost:?}");
        assert_eq!(spans_s(|_| 20.0, even), []);
        // Ego brakes from 20 m/s to 8 m/s while the recorded speed stays as it was.
        let brakes = |t: f64| 20.0 * t.min(30.0) + 8.0 * (t - 30.0).max(0.0);
        assert_eq!(spans_s(|_| 20.0, brakes).len(), 1);
        assert_eq!(spans_s(|t| if t < 30.0 { 20.0 } else { 8.0 }, brakes), []);
    }

    #[test]
    fn slow_receiver_noise_and_standstill_fit_their_speed() {
        assert_eq!(spans_s(|_| 20.0, |t| 40.0 * (t / 2.0).floor()), []);
        assert_eq!(spans_s(|_| 0.0, |t| (37.0 * t).sin()), []);
        assert_eq!(spans_s(|_| f64::NAN, |t| 20.0 * t), []);
    }
}
