//! Whether values can be what their mapping says: a wrong unit is easily declared.

use crate::{
    quality::{Warning, WarningKind},
    raw::{ObjectSample, RawDrive},
};
use std::path::Path;

/// Speeds beyond this are no car's, in m/s.
const FASTEST_MPS: f64 = 90.0;
/// Lengths of vehicles outside this are doubted, in m: a moped, a long truck.
const LENGTHS_M: (f64, f64) = (1.5, 26.0);
/// Slower than this a speed says little about units, in m/s.
const MOVING_MPS: f64 = 2.0;
/// Samples that a comparison of speed and movement needs.
const ENOUGH: usize = 20;

/// Doubts about the units of a drive's samples.
pub(super) fn doubts(path: &Path, raw: &RawDrive) -> Vec<Warning> {
    let mut doubts = Vec::new();
    let mut doubt = |count: usize, what: String| {
        if count > 0 {
            doubts.push(Warning::new(path, WarningKind::Unit, count, what));
        }
    };
    let speeds = || raw.ego.iter().filter_map(|s| s.speed_mps);
    let fast = speeds().filter(|v| v.abs() > FASTEST_MPS).count();
    doubt(
        fast,
        format!("speeds of ego are above {FASTEST_MPS} m/s: is their unit right?"),
    );

    let (least, most) = LENGTHS_M;
    let lengths = raw
        .ego_length_m
        .into_iter()
        .chain(raw.objects.iter().filter_map(ObjectSample::known_length_m));
    let odd = lengths.filter(|l| !(least..=most).contains(l)).count();
    doubt(
        odd,
        format!("lengths of vehicles are not between {least} and {most} m: is their unit right?"),
    );

    let mut ratios: Vec<f64> = Vec::new();
    for pair in raw.ego.windows(2) {
        let dt = pair[1].stamp_ns.saturating_sub(pair[0].stamp_ns) as f64 / 1e9;
        let moved = (pair[1].x_m - pair[0].x_m).hypot(pair[1].y_m - pair[0].y_m);
        if let (Some(v), true) = (pair[0].speed_mps, dt > 0.0 && dt < 1.0)
            && v > MOVING_MPS
            && moved > 0.0
        {
            ratios.push(v * dt / moved);
        }
    }
    if ratios.len() >= ENOUGH {
        ratios.sort_by(f64::total_cmp);
        let ratio = ratios[ratios.len() / 2];
        if !(0.7..=1.4).contains(&ratio) {
            let what = format!(
                "ego's speed is {ratio:.2} times what its positions change a second: do the units of time, length \
                 and speed belong together?"
            );
            doubt(ratios.len(), what);
        }
    }
    doubts
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
        RawDrive {
            ego: ego.collect(),
            ego_length_m: Some(4.7),
            ..RawDrive::default()
        }
    }

    #[test]
    fn a_speed_that_positions_contradict_is_doubted_and_one_they_bear_out_is_not() {
        assert_eq!(doubts(Path::new("t"), &driving(20.0)), []);
        let found = doubts(Path::new("t"), &driving(20.0 * 3.6));
        assert_eq!(found[0].kind, WarningKind::Unit);
        assert!(found[0].what.contains("3.60 times"));
    }

    #[test]
    fn a_car_of_a_metre_and_a_speed_of_a_jet_are_doubted() {
        let mut raw = driving(20.0);
        raw.ego_length_m = Some(1.4);
        raw.ego[3].speed_mps = Some(300.0);
        let kinds = doubts(Path::new("t"), &raw).len();
        assert_eq!(kinds, 2);
    }
}
