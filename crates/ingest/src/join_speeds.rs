//! Ego's speeds from a channel of their own, put to its positions once both are on one clock.

use crate::{
    quality::{Warning, WarningKind},
    raw::{EgoSamples, RawDrive, SpeedSamples},
};
use std::path::Path;

/// Longest time between two speeds that is bridged, in s.
const SPEED_GAP_S: f64 = 0.5;
/// Way beyond which ego has moved, in m.
const MOVED_M: f64 = 10.0;

/// Gives ego's samples the speeds of their own channel; samples are synchronised.
pub(crate) fn join_speeds(path: &Path, drive: &mut RawDrive) -> Option<Warning> {
    let speeds = std::mem::take(&mut drive.speeds);
    if speeds.is_empty() {
        return None;
    }
    let warn = |count, what: &str| Some(Warning::new(path, WarningKind::MissingValue, count, what));
    if speeds.speed_mps.iter().all(|&v| v == 0.0) && way_m(&drive.ego) > MOVED_M {
        return warn(
            speeds.len(),
            "ego moves but the speeds of their own channel are all 0: they are not used",
        );
    }
    let unknown = join(&mut drive.ego, &speeds);
    if unknown == 0 {
        return None;
    }
    // A few at the ends and in holes are left out; where most have none, the positions are the better source.
    if 2 * unknown < drive.ego.len() {
        drive.ego.retain(|s| s.speed_mps.is_some());
        return warn(unknown, "poses of ego between two speeds too far apart are left out");
    }
    warn(unknown, "most poses of ego lie between no two speeds of their own channel")
}

fn way_m(ego: &EgoSamples) -> f64 {
    let step = |(x, y): (&[f64], &[f64])| libm::hypot(x[1] - x[0], y[1] - y[0]);
    let steps = ego.x_m.windows(2).zip(ego.y_m.windows(2)).map(step);
    steps.filter(|m| m.is_finite()).sum()
}

/// Interpolates between speeds that are close; gives how many of ego's samples are left without.
fn join(ego: &mut EgoSamples, speeds: &SpeedSamples) -> usize {
    let most_ns = (SPEED_GAP_S * 1e9) as i64;
    for (&stamp_ns, speed_mps) in ego.stamp_ns.iter().zip(&mut ego.speed_mps) {
        if !speed_mps.is_nan() {
            continue;
        }
        let next = speeds.stamp_ns.partition_point(|&ns| ns <= stamp_ns);
        let before = next.checked_sub(1).map(|i| speeds.at(i));
        *speed_mps = match (before, speeds.get(next)) {
            (Some(a), _) if a.stamp_ns == stamp_ns => a.speed_mps,
            (Some(a), Some(b)) if b.stamp_ns.saturating_sub(a.stamp_ns) <= most_ns => {
                let w = (stamp_ns - a.stamp_ns) as f64 / (b.stamp_ns - a.stamp_ns) as f64;
                a.speed_mps + w * (b.speed_mps - a.speed_mps)
            }
            _ => f64::NAN,
        };
    }
    ego.speed_mps.iter().filter(|v| v.is_nan()).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raw::{EgoSample, SpeedSample};

    fn ego(i: i64) -> EgoSample {
        EgoSample {
            stamp_ns: i * 100_000_000,
            log_ns: 0,
            nth: 0,
            x_m: 10.0 * i as f64,
            y_m: 0.0,
            yaw_rad: None,
            speed_mps: None,
        }
    }

    fn at(stamp_ns: i64, speed_mps: f64) -> SpeedSample {
        SpeedSample { stamp_ns, log_ns: 0, nth: 0, speed_mps }
    }

    #[test]
    fn speeds_are_joined_but_not_over_a_hole() {
        let mut ego: EgoSamples = (0..4).map(ego).collect();
        let speeds = [at(50_000_000, 2.0), at(150_000_000, 4.0), at(900_000_000, 9.0)];
        let speeds = speeds.into_iter().collect();
        assert_eq!(join(&mut ego, &speeds), 3);
        let found: Vec<Option<f64>> = ego.iter().map(|s| s.speed_mps).collect();
        assert_eq!(found, [None, Some(3.0), None, None]);
    }

    #[test]
    fn speeds_that_are_all_zero_while_ego_moves_are_none() {
        let mut drive = RawDrive {
            ego: (0..4).map(ego).collect(),
            speeds: (0..4).map(|i| at(i * 100_000_000, 0.0)).collect(),
            ..RawDrive::default()
        };
        let warning = join_speeds(Path::new("log"), &mut drive).unwrap();
        assert!(warning.what.contains("all 0"), "{}", warning.what);
        assert!(drive.ego.iter().all(|s| s.speed_mps.is_none()));
    }
}
