//! A planner without a learned model.

use maveric_domain::{LaneWish, Setpoints, When};
use maveric_simulator::View;

/// A constant speed, a gap of 1.2 s, out within 2 s of the lead and back 1.4 s past it.
pub(crate) fn passing(speed_mps: f64) -> impl FnMut(&View<'_>) -> Setpoints {
    move |view: &View<'_>| {
        let gap_s = view.reference.dx_m / view.scene.ego.speed_mps.max(1.0);
        let own_lane = view.reference.dy_m.abs() < 1.83;
        let wish = match (view.reference.vehicle.is_some(), own_lane) {
            (true, true) if gap_s < 2.0 => LaneWish::MoveOut(When::Now),
            (true, false) if gap_s < -1.4 => LaneWish::MoveBack(When::Now),
            _ => LaneWish::Stay,
        };
        Setpoints { speed_mps, following_distance_m: 1.2 * view.scene.ego.speed_mps, wish }
    }
}
