//! What somebody has practised: a lane kept by their own hands, and vehicles passed.

use crate::drive::SeatDrive;
use maveric_domain::{Road, VehicleId};
use maveric_simulator::Scenario;
use std::collections::BTreeMap;

/// Whoever stands or creeps keeps no lane, in m/s.
const SLOW_MPS: f64 = 5.0;

/// How long a lane was kept without a break until now, and how many vehicles were passed.
///
/// A lane is kept while the whole car is between its marks and faster than 5 m/s, from the moment on at which the person steers: a
/// road on which nobody has to steer teaches nobody to.
#[derive(Debug, Clone, PartialEq)]
pub struct Practised {
    road: Road,
    /// From the middle of a lane to where the car is on its mark, in m.
    room_m: f64,
    kept: u32,
    passes: u32,
    row: Option<f64>,
    ahead: BTreeMap<VehicleId, bool>,
}

impl Practised {
    /// Nothing yet, on the road of `scenario`.
    pub fn new(scenario: &Scenario) -> Self {
        let road = scenario.road();
        Self {
            road,
            room_m: 0.5 * (road.lane_width_m - scenario.settings().vehicle.width_m),
            kept: 0,
            passes: 0,
            row: None,
            ahead: BTreeMap::new(),
        }
    }

    /// Looks at the step that was driven last.
    pub fn look(&mut self, drive: &SeatDrive<'_>) {
        let car = drive.session().car();
        let middle_m = self.road.lane_centre_m(self.road.nearest_lane(car.y_m));
        let within = (car.y_m - middle_m).abs() < self.room_m;
        if !within || car.speed_mps <= SLOW_MPS {
            self.kept = 0;
        } else if self.kept > 0 || drive.input().steering != 0 {
            self.kept += 1;
        }
        let scene = drive.session().scene();
        if self.row.replace(scene.time_s) == Some(scene.time_s) {
            return;
        }
        for vehicle in &scene.vehicles {
            let ahead = vehicle.x_m > scene.ego.x_m;
            let beside = (vehicle.y_m - scene.ego.y_m).abs() > 0.5 * self.road.lane_width_m;
            let before = self.ahead.insert(vehicle.id, ahead);
            self.passes += u32::from(before == Some(true) && !ahead && beside);
        }
    }

    /// Time for which a lane was kept until now, in s.
    pub fn kept_s(&self) -> f64 {
        f64::from(self.kept) * 0.01
    }

    pub fn passes(&self) -> u32 {
        self.passes
    }
}
