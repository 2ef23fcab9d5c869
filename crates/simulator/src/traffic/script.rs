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
                self.sidestep =
                    Some(Sidestep { from_y_m: state.y_m, lane, start_s: time_s, duration_s });
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
        road.nearest_lane(state.y_m)
    }

    /// Acceleration towards the speed of the script, in m/s².
    pub(crate) fn acceleration_mps2(&self, speed_mps: f64) -> f64 {
        let limit = self.limit_mps2;
        ((self.speed_mps - speed_mps) / PLANNING_STEP_S).clamp(-limit, limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        scenario::ScriptStep,
        testing::{other, seen_ego},
    };

    const BRAKE: ScriptStep = ScriptStep {
        at_s: None,
        at_gap_m: None,
        speed_mps: None,
        acceleration_mps2: None,
        lane: None,
        duration_s: None,
    };

    fn vehicle(steps: &[ScriptStep]) -> [VehiclePlacement; 1] {
        let mut vehicle = VehiclePlacement::steady(50.0, 0, 20.0);
        vehicle.script = steps.to_vec();
        [vehicle]
    }

    #[test]
    fn a_step_comes_at_its_time_or_when_the_gap_passes_its_mark_either_way() {
        let step = |at_s, at_gap_m, speed| ScriptStep {
            at_s,
            at_gap_m,
            speed_mps: Some(speed),
            acceleration_mps2: Some(3.0),
            ..BRAKE
        };
        let vehicles = vehicle(&[
            step(Some(2.0), None, 10.0),
            step(None, Some(30.0), 12.0),
            step(None, Some(30.0), 20.1),
        ]);
        let mut script = Script::new(0, 20.0);
        let mut asked = |time_s: f64, gap_m: f64| {
            let mut state = other(1, gap_m, 0.0, 20.0);
            script.follow(&vehicles, &mut state, &seen_ego(), &Road::PAPER, time_s);
            script.acceleration_mps2(20.0)
        };
        assert!(asked(1.9, 40.0).abs() < 1e-12);
        // 10 m/s are to be had by 3 m/s².
        assert!((asked(2.0, 40.0) + 3.0).abs() < 1e-12);
        assert!((asked(2.1, 30.0) + 3.0).abs() < 1e-12, "not below the mark yet");
        assert!((asked(2.2, 29.9) + 3.0).abs() < 1e-12);
        assert!((asked(2.3, 29.9) + 3.0).abs() < 1e-12);
        // Up through the same mark: 0.1 m/s within a twentieth of a second.
        assert!((asked(2.4, 30.0) - 2.0).abs() < 1e-9);
    }

    #[test]
    fn a_sidestep_is_smooth_and_ends_in_the_lane() {
        let vehicles = vehicle(&[ScriptStep {
            at_s: Some(1.0),
            lane: Some(1),
            duration_s: Some(2.0),
            ..BRAKE
        }]);
        let mut script = Script::new(0, 20.0);
        let mut state = other(1, 40.0, 0.0, 20.0);
        let mut at = |row: u32| {
            let time_s = f64::from(row) * PLANNING_STEP_S;
            let lane = script.follow(&vehicles, &mut state, &seen_ego(), &Road::PAPER, time_s);
            (lane, state.y_m)
        };
        let path: Vec<(u8, f64)> = (0..80).map(&mut at).collect();
        assert_eq!(path[19], (0, 0.0));
        // A row ahead of the time: half of the way after 1 s, 0.1035 of it after a quarter of the time.
        assert!((path[39].1 - 1.83).abs() < 1e-9);
        assert!((path[29].1 - 3.66 * 0.103_515_625).abs() < 1e-9);
        assert!(path[20..60].windows(2).all(|w| w[1].1 > w[0].1));
        assert_eq!((path[59], path[79]), ((1, 3.66), (1, 3.66)));
    }
}
