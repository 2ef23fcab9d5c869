//! Such a person at the wheel.

use super::{merging::Merging, population::EvidenceParams, sideways::Sideways, urge::Urge};
use crate::{
    control::{
        action::{Action, Manoeuvre},
        path::Steering,
    },
    drivers::{
        bounds::SHORTEST_TIME_GAP_S,
        caution,
        idm::Following,
        noise::OrnsteinUhlenbeck,
        passing::is_clear,
        perception::{GAP_ERROR_TIME_S, Perception},
    },
    neighbours::ahead,
    planner::PLANNING_STEP_S,
    road::CentreLine,
    scenario::VehicleSettings,
};
use maveric_domain::{Road, Scene, VehicleId, stream_seed};
use maveric_laws::Idm;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// Correlation times of the wander of gap and desired speed, in s.
const GAP_WANDER_TIME_S: f64 = 15.0;
/// See above.
const SPEED_WANDER_TIME_S: f64 = 20.0;
/// Bounds of the factor on the following time gap.
const GAP_FACTOR: (f64, f64) = (0.6, 1.8);
/// Share of time gap and desired gap that is given up by somebody about to pass.
const GIVES_UP: f64 = 0.55;

/// A person who acts on evidence, driving.
pub(crate) struct EvidenceDriver<'a> {
    params: &'a EvidenceParams,
    vehicle: &'a VehicleSettings,
    road: Road,
    line: &'a CentreLine,
    perception: Perception,
    speed_wander: OrnsteinUhlenbeck,
    gap_wander: OrnsteinUhlenbeck,
    urge: Urge,
    merging: Merging,
    sideways: Sideways,
    passed: Option<VehicleId>,
}

impl<'a> EvidenceDriver<'a> {
    pub(crate) fn new(
        params: &'a EvidenceParams,
        vehicle: &'a VehicleSettings,
        road: Road,
        line: &'a CentreLine,
        seed: u64,
    ) -> Self {
        let stream = |name| Pcg64Mcg::seed_from_u64(stream_seed(seed, &["evidence", name]));
        let wander =
            |sd, time_s, name| OrnsteinUhlenbeck::new(sd, time_s, PLANNING_STEP_S, stream(name));
        Self {
            params,
            vehicle,
            road,
            line,
            perception: Perception::new(
                wander(params.gap_error_sd, GAP_ERROR_TIME_S, "perception"),
                params.delay_s,
            ),
            speed_wander: wander(params.speed_wander_sd_mps, SPEED_WANDER_TIME_S, "speed"),
            gap_wander: wander(params.gap_wander_sd, GAP_WANDER_TIME_S, "gap"),
            urge: Urge::new(stream("urge")),
            merging: Merging::new(params, stream("merging")),
            sideways: Sideways::new(params, stream("sideways")),
            passed: None,
        }
    }

    pub(crate) fn act(&mut self, scene: &Scene, steering: &Steering) -> Action {
        let p = self.params;
        let speed = scene.ego.speed_mps;
        let error = self.perception.next_error();
        let (lane, keeping) = (steering.lane(), steering.coming_from().is_none());
        let lead = ahead(scene, &self.road, lane);
        let seen = self.perception.see(lead, speed, error);
        let bend_mps = caution::bend_speed_mps(self.line, scene.ego.x_m);
        let (low, high) = GAP_FACTOR;
        let gap_factor = (1.0 + self.gap_wander.next()).clamp(low, high);
        let mut follow = Following {
            idm: Idm {
                desired_speed_mps: p.desired_speed_mps + self.speed_wander.next(),
                time_gap_s: p.following_time_gap_s * gap_factor,
                standstill_gap_m: p.standstill_m,
                max_accel_mps2: p.acceleration_mps2,
                comfortable_braking_mps2: p.braking_mps2,
            },
            gap_factor: 1.0,
        };

        let seen_lead = lead.map(|n| n.vehicle.id).zip(seen);
        let readiness = self.urge.next(p, seen_lead, speed).min(1.0);
        let left = lane + 1;
        let may_pass = left < self.road.lanes
            && is_clear(scene, &self.road, left)
            && lead.is_some_and(|n| caution::gets_past(&n, speed, p.lane_change_s));
        let mut manoeuvre = None;
        if may_pass {
            follow.gap_factor = 1.0 - GIVES_UP * readiness;
            follow.idm.time_gap_s =
                (follow.idm.time_gap_s * follow.gap_factor).max(SHORTEST_TIME_GAP_S);
            if readiness >= 1.0 && keeping {
                self.merging.begin(p);
                self.passed = lead.map(|n| n.vehicle.id);
                manoeuvre = Some(self.change_to(left));
            }
        }
        if lane > 0 && manoeuvre.is_none() {
            let passed = scene.vehicles.iter().find(|v| Some(v.id) == self.passed);
            let passed_mps = passed.map_or(0.0, |v| v.speed_mps);
            follow.idm.desired_speed_mps = (follow.idm.desired_speed_mps
                + p.passing_speed_added_mps)
                .max(passed_mps + p.passing_speed_over_lead_mps);
            let back = self.merging.next(p, scene, &self.road, lane - 1, error);
            manoeuvre = (back && keeping).then(|| self.change_to(lane - 1));
        }
        follow.idm.desired_speed_mps =
            follow.idm.desired_speed_mps.min(bend_mps).max(caution::SLOWEST_MPS);
        let lean = if may_pass && lane == 0 { readiness } else { 0.0 };
        let wanted = follow.acceleration_mps2(speed, seen);
        let braking = caution::emergency_braking_mps2(scene, self.vehicle.width_m);
        Action {
            acceleration_mps2: braking.map_or(wanted, |b| wanted.min(-b)),
            manoeuvre,
            lane_offset_m: self.sideways.next(p, lean),
        }
    }

    fn change_to(&self, lane: u8) -> Manoeuvre {
        Manoeuvre::Change { lane, duration_s: self.params.lane_change_s }
    }
}
