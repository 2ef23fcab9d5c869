//! A vehicle that does what its scenario says: brakes, speeds up, changes lane.

use super::{EgoView, distance_m};
use crate::{planner::PLANNING_STEP_S, scenario::VehiclePlacement};
use maveric_domain::{Road, VehicleState};

/// How far a script has come.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Script {
    /// Which of the scenario's vehicles.
    vehicle: usize,
    next: usize,
    /// Whether the gap was above that of the next step when this step became the next.
    was_above: Option<bool>,
    speed_mps: f64,
    limit_mps2: f64,
    sidestep: Option<Sidestep>,
}

#[derive(Debug, Clone, Copy)]
struct Sidestep {
    from_y_m: f64,
    lane: u8,
    start_s: f64,
    duration_s: f64,
}

/// Strongest acceleration without a word in the script, in m/s².
const USUAL_MPS2: f64 = 2.0;

impl Script {
    /// The script of the scenario's vehicle number `vehicle`, not begun.
    pub(crate) fn new(vehicle: usize, speed_mps: f64) -> Self {
        Self {
            vehicle,
            next: 0,
            was_above: None,
            speed_mps,
            limit_mps2: USUAL_MPS2,
            sidestep: None,
        }
    }

    /// Starts the steps whose moment has come and moves sideways; says which lane the vehicle is in.
    pub(crate) fn follow(
        &mut self,
        vehicles: &[VehiclePlacement],
        state: &mut VehicleState,
        ego: &EgoView,
        road: &Road,
        time_s: f64,
    ) -> u8 {
        while let Some(step) = vehicles[self.vehicle].script.get(self.next) {
            let due = match (step.at_s, step.at_gap_m) {
                (Some(at_s), _) => time_s >= at_s,
                (None, Some(at_gap_m)) => {
                    let above = distance_m(ego, state) >= at_gap_m;
                    *self.was_above.get_or_insert(above) != above
                }
                (None, None) => false,
            };
            if !due {
                break;
            }
            self.next += 1;
            self.was_above = None;
            if let Some(speed_mps) = step.speed_mps {
                self.speed_mps = speed_mps;
                self.limit_mps2 = step.acceleration_mps2.unwrap_or(USUAL_MPS2);
            }
            if let (Some(lane), Some(duration_s)) = (step.lane, step.duration_s) {
                self.sidestep = Some(Sidestep {
                    from_y_m: state.y_m,
                    lane,
                    start_s: time_s,
                    duration_s,
                });
            }
        }
        if let Some(side) = self.sidestep {
            let to_y_m = road.lane_centre_m(side.lane);
            let share = (time_s + PLANNING_STEP_S - side.start_s) / side.duration_s;
            if share >= 1.0 {
                state.y_m = to_y_m;
                self.sidestep = None;
            } else {
                // Quintic: no jump of lateral speed or acceleration at either end.
                let moved = share.powi(3) * (10.0 + share * (6.0 * share - 15.0));
                state.y_m = side.from_y_m + moved * (to_y_m - side.from_y_m);
            }
        }
        road.lane_at(state.y_m)
    }

    /// Acceleration towards the speed of the script, in m/s².
    pub(crate) fn acceleration_mps2(&self, speed_mps: f64) -> f64 {
        let limit = self.limit_mps2;
        ((self.speed_mps - speed_mps) / PLANNING_STEP_S).clamp(-limit, limit)
    }
}
