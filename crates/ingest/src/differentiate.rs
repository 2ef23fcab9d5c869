//! Speed from positions, where a log has no speed.

use crate::{
    quality::{Warning, WarningKind},
    raw::{EgoSamples, ObjectSamples},
};
use std::path::Path;

/// Half the window over which positions are differentiated, in s: long enough to calm a localisation of some
/// centimetres at 100 Hz, short enough for a car's braking.
const HALF_WINDOW_S: f64 = 0.2;

/// Most samples to either side: a guard against logs with very many samples at almost one time.
const MOST_SAMPLES: usize = 256;

/// Fills in missing speeds: the slope of a straight line fitted to x and y over ±0.2 s (at least one sample to
/// either side), a smoothed central difference, in the plane of x and y.
///
/// Samples are sorted; windows do not reach over holes longer than `max_gap_s`. A sample that stands alone keeps
/// no speed. Poses alone do not tell reversing: the speed is positive.
pub(crate) fn fill_speeds(ego: &mut EgoSamples, max_gap_s: f64) {
    let (stamp_ns, n) = (&ego.stamp_ns, ego.len());
    let time_s = |i: usize| stamp_ns[i] as f64 / 1e9;
    for i in 0..n {
        if !ego.speed_mps[i].is_nan() {
            continue;
        }
        let mut first = i;
        while first > 0
            && i - first < MOST_SAMPLES
            && time_s(first) - time_s(first - 1) <= max_gap_s
            && (first == i || time_s(i) - time_s(first - 1) <= HALF_WINDOW_S)
        {
            first -= 1;
        }
        let mut last = i;
        while last + 1 < n
            && last - i < MOST_SAMPLES
            && time_s(last + 1) - time_s(last) <= max_gap_s
            && (last == i || time_s(last + 1) - time_s(i) <= HALF_WINDOW_S)
        {
            last += 1;
        }
        let around = first..last + 1;
        let places = (&ego.x_m[around.clone()], &ego.y_m[around.clone()]);
        ego.speed_mps[i] = slope(&stamp_ns[around], places).unwrap_or(f64::NAN);
    }
}

/// Fills in the speeds of others of whom only positions were recorded, each vehicle by its own; one that is seen alone is left out.
///
/// Samples are sorted by time.
pub(crate) fn fill_speeds_of_others(
    path: &Path,
    objects: &mut ObjectSamples,
    max_gap_s: f64,
) -> Option<Warning> {
    let count = objects.speed_mps.iter().filter(|v| v.is_nan()).count();
    if count == 0 {
        return None;
    }
    let mut places: Vec<usize> = (0..objects.len()).collect();
    // Stable: each vehicle's samples stay in the order of time.
    places.sort_by_key(|&i| objects.id[i]);
    let ids = objects.id.clone();
    for same in places.chunk_by(|&a, &b| ids[a] == ids[b]) {
        let mut samples: EgoSamples = same.iter().map(|&i| objects.at(i).as_ego()).collect();
        fill_speeds(&mut samples, max_gap_s);
        for (&i, speed) in same.iter().zip(samples.speed_mps) {
            objects.speed_mps[i] = speed;
        }
    }
    objects.retain(|o| !o.speed_mps.is_nan());
    let what = "speeds of others were not recorded: they are differentiated from their positions";
    Some(Warning::new(path, WarningKind::Default, count, what))
}

/// Length of the velocity that fits some positions (x and y) best; none for a single one.
fn slope(stamp_ns: &[i64], (x_m, y_m): (&[f64], &[f64])) -> Option<f64> {
    let n = stamp_ns.len() as f64;
    let start = stamp_ns.first()?;
    let since = |ns: &i64| (ns - start) as f64 / 1e9;
    let mean_t = stamp_ns.iter().map(since).sum::<f64>() / n;
    let (mut tt, mut tx, mut ty) = (0.0, 0.0, 0.0);
    for (ns, (x, y)) in stamp_ns.iter().zip(x_m.iter().zip(y_m)) {
        let t = since(ns) - mean_t;
        tt += t * t;
        tx += t * (x - x_m[0]);
        ty += t * (y - y_m[0]);
    }
    (tt > 0.0).then(|| libm::hypot(tx / tt, ty / tt))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raw::EgoSample;

    #[test]
    fn a_steady_movement_has_its_speed_up_to_both_ends_and_a_lone_sample_has_none() {
        let mut ego: EgoSamples = (0..50)
            .map(|i| EgoSample {
                stamp_ns: i64::from(i) * 10_000_000 + if i == 49 { 5_000_000_000 } else { 0 },
                log_ns: 0,
                nth: 0,
                x_m: 0.03 * f64::from(i),
                y_m: 0.04 * f64::from(i),
                yaw_rad: None,
                speed_mps: None,
            })
            .collect();
        fill_speeds(&mut ego, 0.5);
        for speed in &ego.speed_mps[..49] {
            assert!((speed - 5.0).abs() < 1e-9);
        }
        assert_eq!(ego.at(49).speed_mps, None);
    }

    #[test]
    fn a_speed_is_the_slope_over_a_fifth_of_a_second_to_both_sides_and_never_over_a_hole() {
        let at = |ms: i64, x_m: f64| EgoSample {
            stamp_ns: ms * 1_000_000,
            log_ns: 0,
            nth: 0,
            x_m,
            y_m: 0.0,
            yaw_rad: None,
            speed_mps: None,
        };
        let speeds = |samples: &[EgoSample], hole_s: f64| {
            let mut ego: EgoSamples = samples.iter().copied().collect();
            fill_speeds(&mut ego, hole_s);
            ego.iter().map(|s| s.speed_mps).collect::<Vec<_>>()
        };
        // x = t³ every 60 ms: over three samples to both sides the slope at t is 3t² and a part that follows from the window alone.
        let time = |i: usize| 0.06 * i as f64;
        let cubic: Vec<EgoSample> =
            (0..=20_u8).map(|i| at(60 * i64::from(i), time(i.into()).powi(3))).collect();
        let window: [f64; 7] = [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0].map(|i| 0.06 * i);
        let sum = |power: i32| window.iter().map(|t| t.powi(power)).sum::<f64>();
        let part = sum(4) / sum(2);
        let found = speeds(&cubic, 0.5);
        for (i, speed) in found.iter().enumerate().skip(3).take(15) {
            let expected = 3.0 * time(i) * time(i) + part;
            assert!((speed.unwrap() - expected).abs() < 1e-9, "row {i}");
        }
        // One sample to either side, however far, but for a hole.
        let sparse = [at(0, 0.0), at(400, 4.0), at(1000, 16.0), at(1900, 16.9)];
        let found = speeds(&sparse, 0.7);
        assert!((found[0].unwrap() - 10.0).abs() < 1e-9);
        let (mean_t, mean_x) = (1.4 / 3.0, 20.0 / 3.0);
        let points = [(0.0, 0.0), (0.4, 4.0), (1.0, 16.0)];
        let both: f64 = points.iter().map(|(t, x)| (t - mean_t) * (x - mean_x)).sum();
        let square: f64 = points.iter().map(|(t, _)| (t - mean_t) * (t - mean_t)).sum();
        assert!((found[1].unwrap() - both / square).abs() < 1e-9);
        assert!((found[2].unwrap() - 20.0).abs() < 1e-9);
        assert_eq!(found[3], None);
        // What was recorded stays.
        let mut known = sparse;
        known[1].speed_mps = Some(-3.0);
        assert_eq!(speeds(&known, 0.7)[1], Some(-3.0));
    }
}
