//! Minimum headway distance.

use super::{Measure, Shown};
use maveric_domain::Drive;

/// How near a person gets to a lead vehicle before reacting to it.
///
/// # Source
/// Paper, Metrics: "the minimum distance between the ego and lead vehicle before either the ego slows down or changes
/// lanes". Ours: an encounter lasts while one vehicle is the reference ahead in ego's lane and ends with ego's change of lane; ego slows
/// down where it decelerates by more than 0.4 m/s² for 0.5 s (calibration section 2). The distance is `lead_dx_m`, a gap.
pub(super) const MEASURE: Measure = Measure {
    name: "min_headway_distance_m",
    title: "Minimum headway distance",
    unit: "m",
    shown: Shown::In("m"),
    aggression: None,
    description: "Smallest gap to a lead vehicle, over encounters, before ego first slows down or changes lane.",
    of_passing: true,
    grows: true,
    why_missing: "no lead vehicle ahead in ego's lane, or a log without lateral positions",
    value: |drive| nearest(drive, Until::SlowingOrChange),
};

/// The reading that does not stop where ego slows down: also the gap while following counts.
///
/// # Source
/// Calibration section 2, whose figures (31 ± 10 m) are for this one.
pub(super) const TO_CHANGE: Measure = Measure {
    name: "min_headway_distance_to_change_m",
    title: "Minimum headway distance up to the change",
    unit: "m",
    shown: Shown::In("m"),
    aggression: None,
    description: "Smallest gap to a lead vehicle, over encounters, before ego changes lane, whether it slows down or not.",
    of_passing: true,
    grows: true,
    why_missing: "no lead vehicle ahead in ego's lane, or a log without lateral positions",
    value: |drive| nearest(drive, Until::Change),
};

/// Deceleration from which ego slows down, in m/s².
const SLOWING_MPS2: f64 = 0.4;
/// How long it must last, in s.
const SLOWING_S: f64 = 0.5;
/// Half the span of the difference that gives the acceleration, in s.
const HALF_SPAN_S: f64 = 0.2;

#[derive(Clone, Copy, PartialEq)]
enum Until {
    SlowingOrChange,
    Change,
}

/// Whether a slowing that lasts long enough is under way at each row.
fn slowing(drive: &Drive) -> Vec<bool> {
    let rows = drive.rows();
    let acceleration = rows.slopes(&rows.ego_speed_mps, HALF_SPAN_S, drive.rate_hz());
    let braking: Vec<bool> = acceleration.iter().map(|&a| a < -SLOWING_MPS2).collect();
    let mut slow = vec![false; braking.len()];
    let mut start = 0;
    while start < braking.len() {
        let run = braking[start..]
            .iter()
            .zip(&rows.segment[start..])
            .take_while(|(b, s)| **b && **s == rows.segment[start])
            .count();
        if run as f64 / drive.rate_hz() >= SLOWING_S {
            slow[start..start + run].fill(true);
        }
        start += run.max(1);
    }
    slow
}

fn nearest(drive: &Drive, until: Until) -> Option<f64> {
    let rows = drive.rows();
    let slow = match until {
        Until::SlowingOrChange => slowing(drive),
        Until::Change => vec![false; drive.len()],
    };
    let mut nearest: Option<f64> = None;
    // The vehicle of the encounter under way, and whether ego has slowed down in it.
    let mut encounter: Option<(Option<u32>, bool)> = None;
    for (row, &slows) in slow.iter().enumerate() {
        if rows.changing[row] != 0 || (row > 0 && rows.segment[row] != rows.segment[row - 1]) {
            encounter = None;
        }
        if rows.changing[row] != 0 || !drive.lead_ahead(row) {
            continue;
        }
        let lead = rows.lead_id[row];
        let over = match encounter {
            Some((same, over)) if same == lead => over,
            _ => false,
        };
        if !over {
            let dx = rows.lead_dx_m[row];
            nearest = Some(nearest.map_or(dx, |least: f64| least.min(dx)));
        }
        encounter = Some((lead, over || slows));
    }
    nearest
}

#[cfg(test)]
mod tests {
    use super::super::testing::*;
    use super::*;
    use maveric_domain::drive::Rows;

    #[test]
    fn passing_without_slowing_is_measured_to_the_start_of_the_change() {
        let drive = Scripted::new(40.0).lead(85.0, 25.0).pass(5.0, 30.0).drive();
        let (both, to_change) = (MEASURE.of(&drive).unwrap(), TO_CHANGE.of(&drive).unwrap());
        assert!((both - 60.0).abs() < 1.5, "{both}");
        assert!((both - to_change).abs() < 1e-12);
    }

    #[test]
    fn what_follows_the_first_slowing_does_not_count() {
        // Closing at 5 m/s from 90 m; from second 8 ego brakes at 1 m/s² for 5 s.
        let braking = |t: f64| 30.0 - (t - 8.0).clamp(0.0, 5.0);
        let drive = Scripted::new(30.0).speed(braking).lead(90.0, 25.0).drive();
        let before = MEASURE.of(&drive).unwrap();
        assert!((before - 50.0).abs() < 1.5, "{before}");
        let nearest = TO_CHANGE.of(&drive).unwrap();
        assert!((nearest - 37.5).abs() < 1.0, "{nearest}");
    }

    #[test]
    fn a_touch_of_the_brake_is_not_slowing_down() {
        let touch = |t: f64| 30.0 - (t - 8.0).clamp(0.0, 0.2);
        let drive = Scripted::new(12.0).speed(touch).lead(90.0, 25.0).drive();
        assert!((MEASURE.of(&drive).unwrap() - TO_CHANGE.of(&drive).unwrap()).abs() < 1e-12);
    }

    /// Ten seconds at 10 Hz that come a metre nearer a row.
    fn nearing(change: impl FnOnce(&mut Rows)) -> Drive {
        by_rows(10.0, 100, |rows| {
            rows.lead_dx_m = (0..100).map(|row| 100.0 - f64::from(row)).collect();
            change(rows);
        })
    }

    #[test]
    fn slowing_down_is_half_a_second_of_braking_within_one_piece_of_the_log() {
        let braked_for = |rows_of_it: usize| {
            nearing(|rows| {
                for row in 0..100 {
                    let braked = row.clamp(20, 20 + rows_of_it) - 20;
                    rows.ego_speed_mps[row] -= 0.1 * braked as f64;
                }
            })
        };
        // At 1 m/s² and over 0.4 s: seen from the row where it begins to the one where it ends.
        assert_eq!(MEASURE.of(&braked_for(3)), Some(1.0));
        assert_eq!(MEASURE.of(&braked_for(4)), Some(80.0));
        assert_eq!(TO_CHANGE.of(&braked_for(4)), Some(1.0));
        // Slower behind a hole is no braking.
        let hole = nearing(|rows| {
            rows.segment[50..].fill(1);
            rows.ego_speed_mps[50..].fill(10.0);
        });
        assert_eq!(MEASURE.of(&hole), Some(1.0));
    }

    #[test]
    fn an_encounter_ends_with_its_vehicle_a_hole_or_a_change() {
        let braked = |rows: &mut Rows| {
            for row in 20..100 {
                rows.ego_speed_mps[row] -= 0.1 * (row - 20) as f64;
            }
        };
        assert_eq!(MEASURE.of(&nearing(braked)), Some(80.0));
        // Another one is not met before row 60, and there ego slows down from the start.
        let other = |rows: &mut Rows| rows.lead_id[60..].fill(Some(2));
        let hole = |rows: &mut Rows| rows.segment[60..].fill(1);
        for end in [other, hole] {
            let both = nearing(|rows| {
                braked(rows);
                end(rows);
            });
            assert_eq!(MEASURE.of(&both), Some(40.0));
        }
        // While changing nothing counts, behind it a new encounter does.
        let change = |rows: &mut Rows| rows.changing[30..70].fill(1);
        assert_eq!(
            TO_CHANGE.of(&nearing(|r| {
                change(r);
                r.lead_present[70..].fill(false);
            })),
            Some(71.0)
        );
        assert_eq!(
            MEASURE.of(&nearing(|r| {
                braked(r);
                change(r);
            })),
            Some(30.0)
        );
        // Beside ego's lane, or beside ego, is not ahead.
        let width = maveric_domain::Road::PAPER.lane_width_m;
        assert_eq!(MEASURE.of(&nearing(|r| r.lead_dy_m[40..].fill(-0.5 * width))), Some(61.0));
        assert_eq!(MEASURE.of(&nearing(|r| r.lead_dx_m[40..].fill(0.0))), Some(61.0));
    }
}
