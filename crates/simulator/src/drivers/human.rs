//! A synthetic person at the wheel: following, passing, merging back.

use super::{
    idm::{Idm, SeenLead},
    noise::OrnsteinUhlenbeck,
    params::DriverParams,
    passing::{Passing, is_clear},
    perception::Perception,
};
use crate::{
    control::path::{Manoeuvre, Steering},
    neighbours::{Neighbour, ahead, in_the_way},
    planner::PLANNING_STEP_S,
    road::CentreLine,
    rollout::Action,
    scenario::VehicleSettings,
};
use maveric_domain::{Road, Scene, VehicleId, stream_seed};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// Shortest time gap a person follows with while waiting to pass, in s.
const SHORTEST_TIME_GAP_S: f64 = 0.4;
/// Factor on the desired gap while about to pass.
const ABOUT_TO_PASS: f64 = 0.5;
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
const SLOWEST_MPS: f64 = 5.0;

/// A person driving.
pub(crate) struct HumanDriver<'a> {
    params: &'a DriverParams,
    vehicle: &'a VehicleSettings,
    road: Road,
    line: &'a CentreLine,
    perception: Perception,
    wander: OrnsteinUhlenbeck,
    passing: Passing,
    passed: Option<VehicleId>,
}

impl<'a> HumanDriver<'a> {
    pub(crate) fn new(
        params: &'a DriverParams,
        vehicle: &'a VehicleSettings,
        road: Road,
        line: &'a CentreLine,
        seed: u64,
    ) -> Self {
        let stream = |name| Pcg64Mcg::seed_from_u64(stream_seed(seed, &["driver", name]));
        let noise = &params.noise;
        Self {
            params,
            vehicle,
            road,
            line,
            perception: Perception::new(noise, stream("perception")),
            wander: OrnsteinUhlenbeck::new(
                noise.speed_wander_sd_mps,
                noise.speed_wander_time_s,
                PLANNING_STEP_S,
                stream("wander"),
            ),
            passing: Passing::new(params, stream("encounters")),
            passed: None,
        }
    }

    pub(crate) fn act(&mut self, scene: &Scene, steering: &Steering) -> Action {
        let speed = scene.ego.speed_mps;
        let error = self.perception.next_error();
        let wander = self.wander.next();
        let lane = steering.lane();
        let keeping = steering.coming_from().is_none();
        let lead = ahead(scene, &self.road, lane);
        let seen = self.perception.see(lead, speed, error);
        let (lateral, braking) = BEND_MPS2;
        let bend_mps = self.line.speed_limit_mps(scene.ego.x_m, lateral, braking);
        let mut idm = Idm {
            desired_speed_mps: (self.params.desired_speed_mps + wander)
                .min(bend_mps)
                .max(SLOWEST_MPS),
            time_gap_s: self.params.following_time_gap_s,
            standstill_m: self.params.standstill_m,
            acceleration_mps2: self.params.acceleration_mps2,
            braking_mps2: self.params.braking_mps2,
            gap_factor: 1.0,
        };

        let out = (lane == 0 || lane + 1 < self.road.lanes)
            .then(|| self.moves_out(scene, lane, lead, seen, keeping, &mut idm))
            .flatten();
        let manoeuvre = if lane == 0 || out.is_some() {
            out
        } else {
            self.in_a_passing_lane(scene, lane, keeping, error, &mut idm)
        };
        idm.desired_speed_mps = idm.desired_speed_mps.min(bend_mps.max(SLOWEST_MPS));
        let wanted = idm.acceleration(speed, seen);
        Action {
            acceleration_mps2: wanted.min(-self.emergency(scene)),
            manoeuvre,
        }
    }

    fn moves_out(
        &mut self,
        scene: &Scene,
        lane: u8,
        lead: Option<Neighbour>,
        seen: Option<SeenLead>,
        keeping: bool,
        idm: &mut Idm,
    ) -> Option<Manoeuvre> {
        let speed = scene.ego.speed_mps;
        let pass_at_s = self.passing.wanted_at(self.params, lead, speed)?;
        let left = lane + 1;
        if !(is_clear(scene, &self.road, left) && self.gets_past(lead?, speed)) {
            return None;
        }
        idm.time_gap_s = idm.time_gap_s.min(0.5 * pass_at_s).max(SHORTEST_TIME_GAP_S);
        idm.gap_factor = ABOUT_TO_PASS;
        let near = seen?.gap_m < pass_at_s * speed;
        if !(near && keeping) {
            return None;
        }
        self.passing.begin(self.params);
        self.passed = lead.map(|n| n.vehicle.id);
        Some(Manoeuvre::Change {
            lane: left,
            duration_s: self.params.lane_change_s,
        })
    }

    /// Whether a change that starts now is far enough on before ego would meet `lead`.
    fn gets_past(&self, lead: Neighbour, speed_mps: f64) -> bool {
        let closing = speed_mps - lead.vehicle.speed_mps;
        let meets_late = lead.gap_m > GETS_PAST_SHARE * self.params.lane_change_s * closing;
        lead.gap_m > LEAST_ROOM_M && meets_late
    }

    fn in_a_passing_lane(
        &mut self,
        scene: &Scene,
        lane: u8,
        keeping: bool,
        error: f64,
        idm: &mut Idm,
    ) -> Option<Manoeuvre> {
        let passed = scene
            .vehicles
            .iter()
            .find(|v| Some(v.id) == self.passed)
            .map_or(0.0, |v| v.speed_mps);
        idm.desired_speed_mps = (idm.desired_speed_mps + self.params.passing_speed_added_mps)
            .max(passed + self.params.passing_speed_over_lead_mps);
        let right = lane - 1;
        let back = keeping && self.passing.merges_back(scene, &self.road, right, error);
        back.then_some(Manoeuvre::Change {
            lane: right,
            duration_s: self.params.lane_change_s,
        })
    }

    /// Braking that keeps ego off whatever is in the way, in m/s², positive; minus infinity for none.
    fn emergency(&self, scene: &Scene) -> f64 {
        let Some(n) = in_the_way(scene, self.vehicle.width_m, 0.2) else {
            return f64::NEG_INFINITY;
        };
        let closing = scene.ego.speed_mps - n.vehicle.speed_mps;
        if n.gap_m < EMERGENCY_MARGIN_M && closing > -1.0 {
            return EMERGENCY_MPS2;
        }
        if closing <= 0.0 {
            return f64::NEG_INFINITY;
        }
        let needed = closing * closing / (2.0 * (n.gap_m - EMERGENCY_MARGIN_M).max(0.1));
        if needed > EMERGENCY_MPS2 {
            1.2 * needed
        } else {
            f64::NEG_INFINITY
        }
    }
}
