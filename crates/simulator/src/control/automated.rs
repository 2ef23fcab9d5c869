//! The automated car: a planner's set-points through the controllers.

use super::{
    action::{Action, Manoeuvre},
    emergency::EmergencyBrake,
    following::following_acceleration,
    intervention::{Intervention, InterventionKind},
    lane_change::{ReturnRule, duration_s, gaps_are_safe},
    lead::Lead,
    passing::DrivingUp,
    path::Steering,
    sideways::Sideways,
    velocity::{VelocityController, bounded_jerk},
};
use crate::{
    error::SimulatorError,
    neighbours::{ahead, ahead_or_entering},
    planner::{PLANNING_STEP_S, Planner, View},
    road::CentreLine,
    scenario::{ControllerSettings, FollowingRule, VehicleSettings},
};
use maveric_domain::{
    LaneActivity as LaneState, LaneWish, Road, Scene, Setpoints, TraceRow, VehicleId, When,
    drive::ReferenceTracker,
};

/// A planner and the controllers that carry out what it asks.
pub(crate) struct AutomatedDriver<'a> {
    planner: &'a mut dyn Planner,
    settings: &'a ControllerSettings,
    vehicle: &'a VehicleSettings,
    road: Road,
    line: &'a CentreLine,
    tracker: ReferenceTracker,
    velocity: VelocityController,
    velocity_leads: bool,
    driving_up: DrivingUp,
    return_rule: ReturnRule,
    command_mps2: f64,
    lane_state: LaneState,
    brake: EmergencyBrake,
    setpoints: Option<Setpoints>,
    sideways: Sideways,
    interventions: Vec<Intervention>,
}

/// Time a change that is given up takes to undo, in s.
const GO_BACK_S: f64 = 3.0;

impl<'a> AutomatedDriver<'a> {
    pub(crate) fn new(
        planner: &'a mut dyn Planner,
        settings: &'a ControllerSettings,
        vehicle: &'a VehicleSettings,
        road: Road,
        line: &'a CentreLine,
    ) -> Self {
        Self {
            planner,
            settings,
            vehicle,
            road,
            line,
            tracker: ReferenceTracker::new(road),
            velocity: VelocityController::default(),
            velocity_leads: true,
            driving_up: DrivingUp::default(),
            return_rule: ReturnRule::default(),
            command_mps2: 0.0,
            lane_state: LaneState::Keeping,
            brake: EmergencyBrake::default(),
            setpoints: None,
            sideways: Sideways::default(),
            interventions: Vec::new(),
        }
    }

    /// What the safety layer did, in order of time.
    pub(crate) fn into_interventions(self) -> Vec<Intervention> {
        self.interventions
    }

    /// What was decided at the row acted on last; none before the first.
    pub(crate) fn trace(&self, time_s: f64, steering: &Steering) -> Option<TraceRow> {
        Some(TraceRow {
            time_s,
            asked: self.setpoints?,
            acceleration_mps2: self.command_mps2,
            braked: self.brake.braking(),
            lane: self.lane_state,
            path_m: steering.path_m(),
        })
    }

    pub(crate) fn act(
        &mut self,
        scene: &Scene,
        steering: &Steering,
    ) -> Result<Action, SimulatorError> {
        let reference = self.tracker.observe(scene);
        let changing = steering.coming_from().is_some();
        if !changing && self.lane_state != LaneState::Waiting {
            self.lane_state = LaneState::Keeping;
        }
        let view = View {
            scene,
            road: &self.road,
            reference,
            lane: steering.lane(),
            activity: self.lane_state,
        };
        let setpoints = self.planner.plan(&view);
        for (name, found) in [
            ("speed_mps", setpoints.speed_mps),
            ("following_distance_m", setpoints.following_distance_m),
        ] {
            finite(name, found, scene.time_s)?;
        }
        self.setpoints = Some(setpoints);
        self.sideways.observe(self.settings, scene, &self.road, self.vehicle.width_m);
        let acceleration_mps2 = self.accelerate(scene, steering, &setpoints);

        let manoeuvre = if changing {
            self.give_up_if_unsafe(scene, steering)
        } else {
            let ego_lane = steering.lane();
            let back =
                self.return_rule.due(self.settings, scene, &self.road, &reference, PLANNING_STEP_S);
            let wished = match setpoints.wish {
                LaneWish::MoveOut(When::Now) => Some(ego_lane + 1).filter(|&l| l < self.road.lanes),
                LaneWish::MoveBack(When::Now) => ego_lane.checked_sub(1),
                _ => None,
            };
            let lane = wished.or_else(|| ego_lane.checked_sub(1).filter(|_| back));
            self.start_if_safe(scene, ego_lane, lane)
        };
        Ok(Action { acceleration_mps2, manoeuvre, lane_offset_m: 0.0 })
    }

    /// The smaller of what velocity, following and safety ask, without a jump.
    fn accelerate(&mut self, scene: &Scene, steering: &Steering, setpoints: &Setpoints) -> f64 {
        let s = self.settings;
        let speed = scene.ego.speed_mps;
        let [low, high] = s.speed_range_mps;
        let bend_mps = self.line.speed_limit_mps(
            scene.ego.x_m,
            s.curve_acceleration_mps2,
            s.curve_braking_mps2,
        );
        let cruise = self.velocity.command(
            s,
            setpoints.speed_mps.clamp(low, high).min(bend_mps),
            speed,
            self.velocity_leads,
            PLANNING_STEP_S,
        );
        let driven_up_to = self.driven_up_to(scene, steering, setpoints);
        // The lane being left counts for the first half of a change, the one entered from its start.
        let left_behind =
            steering.coming_from().filter(|_| steering.progress(scene.ego.x_m) < Some(0.5));
        let lanes = [Some(steering.lane()), left_behind];
        let wanted = lanes
            .into_iter()
            .flatten()
            .filter_map(|lane| ahead_or_entering(scene, &self.road, lane, self.sideways.claims()))
            .filter(|n| driven_up_to != Some(n.vehicle.id))
            .map(|n| {
                let lead = Lead { gap_m: n.gap_m, speed_mps: n.vehicle.speed_mps };
                following_acceleration(s, setpoints.following_distance_m, speed, lead, cruise)
            })
            .fold(cruise, f64::min);
        self.velocity_leads = wanted >= cruise;

        let limit = self.vehicle.braking_limit_mps2;
        let wanted = wanted.clamp(-limit, self.vehicle.acceleration_limit_mps2);
        let smooth = bounded_jerk(s, self.command_mps2, wanted, PLANNING_STEP_S);
        let (command, note) = self.brake.override_command(
            s,
            self.vehicle,
            scene,
            &self.road,
            self.sideways.claims(),
            (smooth, driven_up_to),
        );
        self.interventions.extend(note);
        self.command_mps2 = command;
        command
    }

    /// The vehicle ahead that is about to be passed, while the car means to and may.
    fn driven_up_to(
        &mut self,
        scene: &Scene,
        steering: &Steering,
        setpoints: &Setpoints,
    ) -> Option<VehicleId> {
        let s = self.settings;
        if s.following_rule == FollowingRule::Paper {
            return None;
        }
        let claims = self.sideways.claims();
        let speed = scene.ego.speed_mps;
        let lead = match (steering.coming_from(), setpoints.wish) {
            // Out of a lane: the lead left behind, until the line is crossed.
            (Some(from), _) => {
                let out = from < steering.lane() && self.lane_state == LaneState::Changing;
                let early = steering.progress(scene.ego.x_m) < Some(0.5);
                ahead_or_entering(scene, &self.road, from, claims).filter(|_| out && early)
            }
            (None, LaneWish::MoveOut(_)) => {
                let (ego_lane, left) = (steering.lane(), steering.lane() + 1);
                let lead = ahead_or_entering(scene, &self.road, ego_lane, claims);
                let may = left < self.road.lanes
                    && self.gaps_are_safe(scene, left, s.margin_m)
                    && duration_s(s, speed, lead).is_some();
                lead.filter(|_| may)
            }
            (None, _) => None,
        }?;
        let may = self.driving_up.may(s, speed, &lead);
        may.then_some(lead.vehicle.id)
    }

    /// Before the line is crossed a change whose gaps have become unsafe is undone.
    fn give_up_if_unsafe(&mut self, scene: &Scene, steering: &Steering) -> Option<Manoeuvre> {
        let early = steering.progress(scene.ego.x_m) < Some(0.5);
        if self.lane_state == LaneState::GoingBack || !early {
            return None;
        }
        // Without the margin that starting needs: a change does not flutter at the edge of the rule.
        if self.gaps_are_safe(scene, steering.lane(), 0.0) {
            return None;
        }
        self.lane_state = LaneState::GoingBack;
        self.note(
            scene,
            InterventionKind::GaveUpChange {
                asked_lane: steering.lane(),
                kept_lane: steering.coming_from().unwrap_or(steering.lane()),
            },
        );
        Some(Manoeuvre::GoBack { duration_s: GO_BACK_S })
    }

    fn gaps_are_safe(&self, scene: &Scene, lane: u8, margin_m: f64) -> bool {
        let claims = self.sideways.claims();
        gaps_are_safe(self.settings, scene, &self.road, lane, claims, margin_m)
    }

    fn note(&mut self, scene: &Scene, kind: InterventionKind) {
        self.interventions.push(Intervention { time_s: scene.time_s, vehicle: None, kind });
    }

    fn start_if_safe(&mut self, scene: &Scene, ego_lane: u8, due: Option<u8>) -> Option<Manoeuvre> {
        let Some(lane) = due else {
            self.lane_state = LaneState::Keeping;
            return None;
        };
        let safe = self.gaps_are_safe(scene, lane, self.settings.margin_m);
        let duration =
            duration_s(self.settings, scene.ego.speed_mps, ahead(scene, &self.road, ego_lane));
        let Some(duration_s) = duration.filter(|_| safe) else {
            if self.lane_state != LaneState::Waiting {
                self.note(
                    scene,
                    InterventionKind::HeldChange { asked_lane: lane, kept_lane: ego_lane },
                );
            }
            self.lane_state = LaneState::Waiting;
            return None;
        };
        self.lane_state = LaneState::Changing;
        Some(Manoeuvre::Change { lane, duration_s })
    }
}

fn finite(name: &'static str, found: f64, time_s: f64) -> Result<(), SimulatorError> {
    if found.is_finite() {
        return Ok(());
    }
    Err(SimulatorError::Setpoint { name, found, time_s, expected: "a finite number" })
}
