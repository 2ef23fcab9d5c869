//! A lateral position that is a place in the lane, and not one across the road.

use crate::{
    mapping::Layout,
    quality::{Warning, WarningKind},
    raw::EgoSamples,
};
use std::path::Path;

/// Widths of lanes, in m: a place in the lane jumps by as much where ego crosses a marking.
const WIDTHS_M: std::ops::RangeInclusive<f64> = 2.0..=5.0;
/// No car moves sideways faster than this, in m/s.
const SIDEWAYS_MPS: f64 = 3.0;
/// How long before and behind a jump is looked which way the place moves, in s.
const AROUND_S: f64 = 1.0;
/// Least way against the jump by which a place in the lane is told from steps between the centres of lanes, in m.
const AGAINST_M: f64 = 0.3;

/// Jumps by a lane's width to the other side of a lane, while the vehicle goes on the way it went: times in ns and widths in m.
///
/// Whoever crosses the marking on the left has the greatest place to the left before and the greatest to the right behind it. A position
/// that steps from centre to centre does not move around its step, and an outlier comes back.
fn jumps(times_ns: &[i64], places_m: &[f64]) -> Vec<(i64, f64)> {
    let step_s = |i: usize| times_ns[i].saturating_sub(times_ns[i - 1]) as f64 / 1e9;
    let jump = |i: usize| places_m[i] - places_m[i - 1];
    let is_jump = |&i: &usize| {
        WIDTHS_M.contains(&jump(i).abs())
            && step_s(i) > 0.0
            && jump(i).abs() > SIDEWAYS_MPS * step_s(i)
    };
    let jumps: Vec<usize> = (1..places_m.len()).filter(is_jump).collect();
    let around_ns = (AROUND_S * 1e9) as i64;
    let wraps = |(nth, &i): (usize, &usize)| {
        // As far as to the jump before and the next.
        let from = nth.checked_sub(1).map_or(0, |n| jumps[n]);
        let until = jumps.get(nth + 1).copied().unwrap_or(places_m.len());
        let near = |k: &usize| times_ns[*k].abs_diff(times_ns[i]) <= around_ns.unsigned_abs();
        let first = (from..i).rev().take_while(near).last()?;
        let last = (i..until).take_while(near).last()?;
        let moved_m = places_m[i - 1] - places_m[first] + places_m[last] - places_m[i];
        (moved_m * jump(i).signum() < -AGAINST_M).then(|| (times_ns[i], jump(i).abs()))
    };
    jumps.iter().enumerate().filter_map(wraps).collect()
}

/// Says of a column that is mapped as a position across the road that it is a place in the lane, and what to write.
pub(super) fn place_in_lane(path: &Path, layout: &Layout, ego: &EgoSamples) -> Option<Warning> {
    let (key, column) = layout.lateral()?;
    // What almost every column is: one that never jumps.
    let (times_ns, places_m) = (&ego.stamp_ns, &ego.y_m);
    let far = |w: &[f64]| (w[1] - w[0]).abs() >= *WIDTHS_M.start();
    if !places_m.windows(2).any(far) {
        return None;
    }
    let jumps = jumps(times_ns, places_m);
    let width_m = jumps.iter().map(|j| j.1).sum::<f64>() / jumps.len() as f64;
    let start_ns = times_ns.iter().min()?;
    let spans = jumps.iter().map(|(ns, _)| (ns - start_ns) as f64 / 1e9);
    let what = format!(
        "`{column}` jumps by a lane's width ({width_m:.2} m) while ego goes on the way it went: it is a place in the lane, not across \
         the road, and no lane change is seen by it. In the mapping, write `offset = \"{column}\"` in the place of `{key}`, \
         `offset_grows` with its side, and `lane` with the column that numbers the lanes"
    );
    (!jumps.is_empty()).then(|| {
        let warning = Warning::new(path, WarningKind::Unit, jumps.len(), what);
        warning.with_spans(spans.map(|t| (t, t)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sixty seconds at 10 Hz in which ego moves by two lanes of 3.6 m to the left, as a place across the road.
    fn across_m() -> Vec<f64> {
        let lane_change = |t: f64, at: f64| 3.6 / (1.0 + (2.0 * (at - t)).exp());
        (0..600)
            .map(|i| f64::from(i) / 10.0)
            .map(|t| lane_change(t, 20.0) + lane_change(t, 40.0))
            .collect()
    }

    fn found(places_m: &[f64]) -> Vec<(f64, f64)> {
        let times_ns: Vec<i64> = (0..).take(places_m.len()).map(|i| i * 100_000_000).collect();
        let jumps = jumps(&times_ns, places_m).into_iter();
        jumps.map(|(ns, m)| (ns as f64 / 1e9, m)).collect()
    }

    #[test]
    fn a_place_in_the_lane_jumps_where_a_marking_is_crossed_and_one_across_the_road_never() {
        let across = across_m();
        assert_eq!(found(&across), []);
        let offset: Vec<f64> = across.iter().map(|y| y - 3.6 * (y / 3.6).round()).collect();
        let jumps = found(&offset);
        assert_eq!(jumps.len(), 2);
        assert!((jumps[0].0 - 20.0).abs() < 0.2 && (jumps[1].0 - 40.0).abs() < 0.2, "{jumps:?}");
        assert!(jumps.iter().all(|j| (2.5..3.7).contains(&j.1)), "{jumps:?}");
        let mirrored: Vec<f64> = offset.iter().map(|y| -y).collect();
        assert_eq!(found(&mirrored).len(), 2);
    }

    #[test]
    fn steps_between_centres_of_lanes_and_an_outlier_are_no_places_in_a_lane() {
        let steps: Vec<f64> = across_m().iter().map(|y| 3.6 * (y / 3.6).round()).collect();
        assert_eq!(found(&steps), []);
        let mut outlier = vec![0.2; 600];
        outlier[300] = 3.8;
        assert_eq!(found(&outlier), []);
    }
}
