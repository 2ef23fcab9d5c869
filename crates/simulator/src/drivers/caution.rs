//! What keeps a person out of trouble, whatever their habits.

use crate::{
    neighbours::{Neighbour, in_the_way},
    road::CentreLine,
};
use maveric_domain::Scene;

/// Braking that a person uses for whatever is in the way once it takes more than this, in m/s².
const EMERGENCY_MPS2: f64 = 3.5;
/// Distance a person keeps to it, in m.
const EMERGENCY_MARGIN_M: f64 = 2.0;
/// Share of a lane change after which ego is clear of the lane it leaves.
const GETS_PAST_SHARE: f64 = 0.7;
/// Room ahead below which nobody begins a lane change, in m.
const LEAST_ROOM_M: f64 = 8.0;
/// Lateral acceleration a person takes in a bend, and braking before it, in m/s²: chosen.
const BEND_MPS2: (f64, f64) = (3.0, 1.5);
/// Slowest desired speed, in m/s, so that the car-following model stays defined.
pub(super) const SLOWEST_MPS: f64 = 5.0;

/// Speed that the road's bends leave a person at `x_m`, in m/s.
pub(super) fn bend_speed_mps(line: &CentreLine, x_m: f64) -> f64 {
    let (lateral, braking) = BEND_MPS2;
    line.speed_limit_mps(x_m, lateral, braking)
}

/// Whether a change of `lane_change_s` that starts now is far enough on before ego would meet `lead`.
pub(super) fn gets_past(lead: &Neighbour, speed_mps: f64, lane_change_s: f64) -> bool {
    let closing = speed_mps - lead.vehicle.speed_mps;
    let meets_late = lead.gap_m > GETS_PAST_SHARE * lane_change_s * closing;
    lead.gap_m > LEAST_ROOM_M && meets_late
}

/// Braking that keeps ego off whatever is in the way, in m/s², positive, where comfort no longer does.
pub(super) fn emergency_braking_mps2(scene: &Scene, width_m: f64) -> Option<f64> {
    let n = in_the_way(scene, width_m, 0.2)?;
    let closing = scene.ego.speed_mps - n.vehicle.speed_mps;
    if n.gap_m < EMERGENCY_MARGIN_M && closing > -1.0 {
        return Some(EMERGENCY_MPS2);
    }
    if closing <= 0.0 {
        return None;
    }
    let needed = closing * closing / (2.0 * (n.gap_m - EMERGENCY_MARGIN_M).max(0.1));
    (needed > EMERGENCY_MPS2).then_some(1.2 * needed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{other, scene};

    #[test]
    fn who_moves_out_gets_past_before_it_would_meet_the_lead() {
        let past = |gap_m: f64, lead_mps: f64| {
            let vehicle = other(1, gap_m, 0.0, lead_mps);
            gets_past(&Neighbour { vehicle, gap_m }, 30.0, 4.0)
        };
        // 0.7 of 4 s at 10 m/s, and 8 m in any case.
        assert!(past(28.1, 20.0) && !past(27.9, 20.0));
        assert!(past(8.1, 35.0) && !past(8.0, 35.0));
    }

    #[test]
    fn an_emergency_is_braked_for_by_a_fifth_more_than_needed() {
        let braking = |gap_m: f64, other_mps: f64| {
            let scene = scene(0.0, 20.0, &[other(1, gap_m, 1.0, other_mps)]);
            emergency_braking_mps2(&scene, 1.9)
        };
        // 20² / 2 over what is left before the margin of 2 m: 4 m/s² are needed, then 2.
        assert!((braking(52.0, 0.0).unwrap() - 1.2 * 4.0).abs() < 1e-12);
        assert_eq!(braking(102.0, 0.0), None);
        // Within the margin, unless it draws away.
        assert_eq!(braking(1.9, 20.9), Some(3.5));
        assert_eq!(braking(1.9, 21.1), None);
        assert_eq!((braking(10.0, 20.5), braking(-10.0, 0.0)), (None, None));
    }
}
