//! Who is on the way into another lane.

use super::safety::lateral_safe_distance_m;
use crate::{planner::PLANNING_STEP_S, scenario::ControllerSettings};
use maveric_domain::{Road, Scene, VehicleId};

/// Lateral speed above which a vehicle is on its way to another lane, in m/s: nobody keeps a lane to the centimetre.
const DRIFT_MPS: f64 = 0.1;

/// Watches the lateral motion of every vehicle and says which lane it is about to take.
#[derive(Debug, Clone, Default)]
pub(super) struct Sideways {
    last: Vec<(VehicleId, f64)>,
    claims: Vec<Option<u8>>,
}

impl Sideways {
    /// Takes the next scene.
    ///
    /// A vehicle claims the lane that it moves towards once it is nearer to a car in that lane's centre than the lateral safe
    /// distance: it could no longer stop short of it.
    pub(super) fn observe(
        &mut self,
        settings: &ControllerSettings,
        scene: &Scene,
        road: &Road,
        width_m: f64,
    ) {
        self.claims.clear();
        for (i, v) in scene.vehicles.iter().enumerate() {
            let same = |&&(id, _): &&(VehicleId, f64)| id == v.id;
            // Vehicles keep their places in the list but for arrivals and departures.
            let before = self.last.get(i).filter(same);
            let before = before.or_else(|| self.last.iter().find(same));
            let speed = before.map_or(0.0, |&(_, y_m)| (v.y_m - y_m) / PLANNING_STEP_S);
            let current = road.lane_at(v.y_m);
            let lane = if speed > DRIFT_MPS {
                current.and_then(|current| current.checked_add(1)).filter(|&lane| lane < road.lanes)
            } else if speed < -DRIFT_MPS {
                current.and_then(|current| current.checked_sub(1))
            } else {
                None
            };
            self.claims.push(lane.filter(|&lane| {
                let beside = (road.lane_centre_m(lane) - v.y_m).abs() - width_m;
                beside < lateral_safe_distance_m(settings, speed.abs(), 0.0)
            }));
        }
        self.last.clear();
        self.last.extend(scene.vehicles.iter().map(|v| (v.id, v.y_m)));
    }

    /// The lane that each vehicle of the scene is about to take, in the scene's order.
    pub(super) fn claims(&self) -> &[Option<u8>] {
        &self.claims
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{other, scene};

    #[test]
    fn a_vehicle_that_moves_over_claims_the_lane_before_it_is_in_it() {
        let settings = ControllerSettings::default();
        let mut sideways = Sideways::default();
        let mut claimed_at = None;
        for row in 0..80 {
            let y_m = 3.66 - 0.05 * 0.9 * f64::from(row);
            let scene = Scene {
                time_s: 0.05 * f64::from(row),
                ..scene(0.0, 25.0, &[other(3, 25.0, y_m, 25.0)])
            };
            sideways.observe(&settings, &scene, &Road::PAPER, 1.9);
            if sideways.claims()[0] == Some(0) && claimed_at.is_none() {
                claimed_at = Some(y_m);
            }
        }
        let at = claimed_at.unwrap();
        assert!(at > 2.5 && at < 3.5, "{at}");
    }
}
