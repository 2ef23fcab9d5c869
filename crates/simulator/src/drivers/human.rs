//! A synthetic person at the wheel: following, passing, merging back.

use super::{
    bounds::SHORTEST_TIME_GAP_S,
    caution,
    idm::{Following, SeenLead},
    noise::OrnsteinUhlenbeck,
    passing::{Passing, is_clear},
    perception::Perception,
    population::DriverParams,
};
use crate::{
    control::{
        action::{Action, Manoeuvre},
        path::Steering,
    },
    neighbours::{Neighbour, ahead},
    planner::PLANNING_STEP_S,
    road::CentreLine,
    scenario::VehicleSettings,
};
use maveric_domain::{Road, Scene, VehicleId, stream_seed};
use maveric_laws::Idm;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// Factor on the desired gap while about to pass.
const ABOUT_TO_PASS: f64 = 0.5;
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
        let wander =
            |sd, time_s, name| OrnsteinUhlenbeck::new(sd, time_s, PLANNING_STEP_S, stream(name));
        let noise = &params.noise;
        Self {
            params,
            vehicle,
            road,
            line,
            perception: Perception::new(
                wander(noise.gap_error_sd, noise.gap_error_time_s, "perception"),
                noise.delay_s,
            ),
            wander: wander(noise.speed_wander_sd_mps, noise.speed_wander_time_s, "wander"),
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
        let bend_mps = caution::bend_speed_mps(self.line, scene.ego.x_m);
        let mut follow = Following {
            idm: Idm {
                desired_speed_mps: (self.params.desired_speed_mps + wander)
                    .min(bend_mps)
                    .max(caution::SLOWEST_MPS),
                time_gap_s: self.params.following_time_gap_s,
                standstill_gap_m: self.params.standstill_m,
                max_accel_mps2: self.params.acceleration_mps2,
                comfortable_braking_mps2: self.params.braking_mps2,
            },
            gap_factor: 1.0,
        };

        let out = (lane == 0 || lane + 1 < self.road.lanes)
            .then(|| self.moves_out(scene, lane, lead, seen, keeping, &mut follow))
            .flatten();
        let manoeuvre = if lane == 0 || out.is_some() {
            out
        } else {
            self.in_a_passing_lane(scene, lane, keeping, error, &mut follow)
        };
        follow.idm.desired_speed_mps =
            follow.idm.desired_speed_mps.min(bend_mps.max(caution::SLOWEST_MPS));
        let wanted = follow.acceleration_mps2(speed, seen);
        let braking = caution::emergency_braking_mps2(scene, self.vehicle.width_m);
        Action {
            acceleration_mps2: braking.map_or(wanted, |b| wanted.min(-b)),
            manoeuvre,
            lane_offset_m: 0.0,
        }
    }

    fn moves_out(
        &mut self,
        scene: &Scene,
        lane: u8,
        lead: Option<Neighbour>,
        seen: Option<SeenLead>,
        keeping: bool,
        follow: &mut Following,
    ) -> Option<Manoeuvre> {
        let speed = scene.ego.speed_mps;
        let pass_at_s = self.passing.wanted_at(self.params, lead, speed)?;
        let left = lane + 1;
        if !(is_clear(scene, &self.road, left)
            && caution::gets_past(&lead?, speed, self.params.lane_change_s))
        {
            return None;
        }
        follow.idm.time_gap_s = follow.idm.time_gap_s.min(0.5 * pass_at_s).max(SHORTEST_TIME_GAP_S);
        follow.gap_factor = ABOUT_TO_PASS;
        let near = seen?.gap_m < pass_at_s * speed;
        if !(near && keeping) {
            return None;
        }
        self.passing.begin(self.params);
        self.passed = lead.map(|n| n.vehicle.id);
        Some(Manoeuvre::Change { lane: left, duration_s: self.params.lane_change_s })
    }

    fn in_a_passing_lane(
        &mut self,
        scene: &Scene,
        lane: u8,
        keeping: bool,
        error: f64,
        follow: &mut Following,
    ) -> Option<Manoeuvre> {
        let passed =
            scene.vehicles.iter().find(|v| Some(v.id) == self.passed).map_or(0.0, |v| v.speed_mps);
        // Whoever is passed may speed up; nobody races them for longer than they would pass anybody.
        let usual = follow.idm.desired_speed_mps + self.params.passing_speed_added_mps;
        let over = self.params.passing_speed_over_lead_mps;
        follow.idm.desired_speed_mps = usual.max((passed + over).min(usual + over));
        let right = lane - 1;
        let back = keeping && self.passing.merges_back(scene, &self.road, right, error);
        back.then_some(Manoeuvre::Change { lane: right, duration_s: self.params.lane_change_s })
    }
}
