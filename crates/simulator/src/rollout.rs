//! One drive, from the first row to the last.

use crate::{
    collision::{Collision, cause},
    control::{
        AutomatedDriver, Intervention, InterventionKind,
        path::{Manoeuvre, PathShape, Steering},
        safe_distance,
    },
    drivers::{DriverParams, EvidenceDriver, EvidenceParams, HumanDriver},
    error::SimulatorError,
    neighbours::ahead,
    planner::{PLANNING_RATE_HZ, Planner},
    scenario::{ControllerSettings, Scenario},
    traffic::EgoView,
    vehicle::{Command, build, ego_state},
    world::World,
};
use maveric_domain::{
    EgoTrack, MetresPerSecond, Recording, Road, Scene, TraceRow, VehicleId,
    scene::bumper_distance_m,
};

/// Who drives.
pub enum Driver<'a> {
    /// A synthetic person.
    Human(&'a DriverParams),
    /// A synthetic person of the second kind.
    Evidence(&'a EvidenceParams),
    /// A planner, through the controllers.
    Automated(&'a mut dyn Planner, &'a ControllerSettings),
}

/// A drive and what is to be said about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Rollout {
    /// Who was where, at [`PLANNING_RATE_HZ`].
    pub recording: Recording,
    /// What was counted.
    pub report: RolloutReport,
    /// What the safety layer did, in order of time; nothing for people.
    pub interventions: Vec<Intervention>,
    /// Every collision and what had gone wrong before it, in order of time.
    pub collisions: Vec<Collision>,
    /// Why the drive ended early: a set-point that no controller can follow. The recording then ends with that row.
    pub stopped: Option<SimulatorError>,
    /// What the automated car decided at each row; empty for people.
    pub trace: Vec<TraceRow>,
}

impl Rollout {
    /// The drive, if it went on to its end.
    ///
    /// # Errors
    /// [`SimulatorError::Setpoint`] if the planner's set-points ended it.
    pub fn completed(self) -> Result<Self, SimulatorError> {
        match self.stopped {
            Some(error) => Err(error),
            None => Ok(self),
        }
    }
}

/// Counts over one drive; an episode is counted once, however long it lasts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RolloutReport {
    /// Episodes in which ego and another vehicle overlapped.
    pub collisions: u32,
    /// Episodes with the vehicle ahead in ego's lane nearer than the safety rule allows.
    pub rule_violations: u32,
    /// Episodes in which the safety layer braked harder than the controllers asked; 0 for people.
    pub interventions: u32,
    /// Lane changes that were due and had to wait for a safe gap; 0 for people.
    pub held_changes: u32,
    /// Lane changes undone in their first half because a gap had become unsafe; 0 for people.
    pub given_up_changes: u32,
    /// Lane changes started.
    pub started_changes: u32,
    /// Lead vehicles that came.
    pub leads: u32,
    /// Encounters among them in which the passing lane was taken.
    pub blocked_encounters: u32,
}

/// What a driver does until the next row.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Action {
    pub(crate) acceleration_mps2: f64,
    pub(crate) manoeuvre: Option<Manoeuvre>,
    /// Where in the lane to drive, in m to the left of its centre.
    pub(crate) lane_offset_m: f64,
}

impl Action {
    const NOTHING: Self = Self {
        acceleration_mps2: 0.0,
        manoeuvre: None,
        lane_offset_m: 0.0,
    };
}

enum Seat<'a> {
    Human(HumanDriver<'a>),
    Evidence(EvidenceDriver<'a>),
    Automated(AutomatedDriver<'a>),
}

/// What goes wrong around ego, counted by episode.
#[derive(Debug, Default)]
struct Watch {
    touching: Vec<VehicleId>,
    too_near: bool,
    collisions: Vec<(usize, VehicleId)>,
    violations: u32,
}

impl Watch {
    fn look(
        &mut self,
        row: usize,
        scene: &Scene,
        road: &Road,
        rule: &ControllerSettings,
        width_m: f64,
    ) {
        let ego = &scene.ego;
        let touching: Vec<VehicleId> = scene
            .vehicles
            .iter()
            .filter(|v| bumper_distance_m(ego, v).abs() <= 0.0 && (v.y_m - ego.y_m).abs() < width_m)
            .map(|v| v.id)
            .collect();
        let fresh = touching.iter().filter(|id| !self.touching.contains(id));
        self.collisions.extend(fresh.map(|&id| (row, id)));
        self.touching = touching;
        let too_near = ahead(scene, road, road.lane_at(ego.y_m)).is_some_and(|n| {
            let rear = MetresPerSecond(ego.speed_mps);
            let safe = safe_distance(rule, rear, MetresPerSecond(n.vehicle.speed_mps));
            n.gap_m < safe.0 - rule.margin_m
        });
        self.violations += u32::from(too_near && !self.too_near);
        self.too_near = too_near;
    }
}

/// Drives `scenario` once and records it.
///
/// The recording has duration · [`PLANNING_RATE_HZ`] rows and one segment. The same scenario, driver and seed give the same
/// bytes; a planner that gives a set-point that is not a number or not a probability ends the drive, see [`Rollout::stopped`]; traffic, perception, wander and encounters each have a stream of their own, derived from `seed`.
///
/// # Errors
/// [`SimulatorError::Setting`] if the controller settings given with a planner are out of range,
/// [`SimulatorError::Recording`] if the drive is shorter than two rows.
///
/// # Source
/// Method sections 5 to 7, calibration sections 1, 2 and 4.
///
/// # Example
/// ```
/// # use maveric_simulator::{Driver, DriverParams, Scenario, rollout};
/// # use maveric_domain::{LatentTraits, Seconds};
/// let scenario = Scenario::paper().with_duration(Seconds(60.0))?;
/// let driver = DriverParams::draw(&LatentTraits::default(), 1, 1);
/// let drive = rollout(&scenario, Driver::Human(&driver), 7)?;
/// assert_eq!(drive.recording.rows(), 1200);
/// assert_eq!(drive.report.collisions, 0);
/// # Ok::<(), maveric_simulator::SimulatorError>(())
/// ```
pub fn rollout(
    scenario: &Scenario,
    driver: Driver<'_>,
    seed: u64,
) -> Result<Rollout, SimulatorError> {
    let settings = scenario.settings();
    let road = scenario.road();
    let line = scenario.centre_line();
    let rule = match &driver {
        Driver::Automated(_, settings) => {
            settings.check()?;
            (*settings).clone()
        }
        Driver::Human(_) | Driver::Evidence(_) => settings.controllers.clone(),
    };
    let shape = match &driver {
        Driver::Evidence(params) => PathShape::Eased {
            lateness: params.lateness,
        },
        Driver::Human(_) | Driver::Automated(..) => PathShape::Bezier,
    };
    let mut seat = match driver {
        Driver::Human(params) => Seat::Human(HumanDriver::new(
            params,
            &settings.vehicle,
            road,
            line,
            seed,
        )),
        Driver::Evidence(params) => Seat::Evidence(EvidenceDriver::new(
            params,
            &settings.vehicle,
            road,
            line,
            seed,
        )),
        Driver::Automated(planner, controllers) => Seat::Automated(AutomatedDriver::new(
            planner,
            controllers,
            &settings.vehicle,
            road,
            line,
        )),
    };
    let start = &settings.start;
    let start_y_m = road.lane_centre_m(start.lane);
    let start_mps = MetresPerSecond::from_mph(start.speed_mph).0;
    let mut car = build(&settings.vehicle, start_y_m, start_mps);
    let mut steering = Steering::new(
        road.lane_width_m,
        rule.stanley_gain_per_s,
        start.lane,
        shape,
    );
    let mut world = World::new(scenario, seed)?;
    let mut watch = Watch::default();
    let mut started_changes = 0;
    let mut trace = Vec::new();
    let mut stopped = None;

    let rows = (settings.duration_s * PLANNING_RATE_HZ).round() as usize;
    let mut ego = EgoTrack {
        length_m: settings.vehicle.length_m,
        ..EgoTrack::default()
    };
    let mut time_s = Vec::with_capacity(rows);
    let mut scene = Scene {
        time_s: 0.0,
        ego: ego_state(car.as_ref(), settings.vehicle.length_m),
        vehicles: Vec::new(),
    };
    for row in 0..rows {
        // A recording has at least two rows.
        if stopped.is_some() && row >= 2 {
            break;
        }
        scene.time_s = row as f64 / PLANNING_RATE_HZ;
        scene.ego = ego_state(car.as_ref(), settings.vehicle.length_m);
        world.states(&mut scene.vehicles);
        for vehicle in &mut scene.vehicles {
            vehicle.x_m = line.lane_x_m(scene.ego.x_m, vehicle.x_m, vehicle.y_m);
        }
        time_s.push(scene.time_s);
        ego.x_m.push(scene.ego.x_m);
        ego.y_m.push(scene.ego.y_m);
        ego.speed_mps.push(scene.ego.speed_mps);
        world.record();
        watch.look(row, &scene, &road, &rule, settings.vehicle.width_m);

        let action = match &mut seat {
            Seat::Human(human) => human.act(&scene, &steering),
            Seat::Evidence(person) => person.act(&scene, &steering),
            Seat::Automated(_) if stopped.is_some() => Action::NOTHING,
            Seat::Automated(automated) => match automated.act(&scene, &steering) {
                Ok(action) => action,
                Err(error) => {
                    stopped = Some(error);
                    Action::NOTHING
                }
            },
        };
        let view = EgoView {
            x_m: scene.ego.x_m,
            y_m: scene.ego.y_m,
            speed_mps: scene.ego.speed_mps,
            length_m: scene.ego.length_m,
            lane: road.lane_at(scene.ego.y_m),
            bound_for: steering.lane(),
            keeping: steering.coming_from().is_none(),
            target_mps: world.target_mps(),
        };
        world.decide(&view, row, scene.time_s);
        steering.drive_at(action.lane_offset_m);
        if let Some(manoeuvre) = action.manoeuvre {
            started_changes += u32::from(matches!(manoeuvre, Manoeuvre::Change { .. }));
            steering.begin(manoeuvre, car.pose());
        }
        if let Seat::Automated(automated) = &seat
            && stopped.is_none()
        {
            trace.extend(automated.trace(scene.time_s, &steering));
        }
        for _ in 0..settings.vehicle.steps_per_row() {
            let command = Command {
                acceleration_mps2: action.acceleration_mps2,
                steering_rad: steering.angle_rad(car.as_ref(), line),
            };
            car.step(command, line);
        }
        world.advance();
    }

    let interventions = match seat {
        Seat::Human(_) | Seat::Evidence(_) => Vec::new(),
        Seat::Automated(automated) => automated.into_interventions(),
    };
    let counted = |of: fn(&InterventionKind) -> bool| {
        interventions.iter().filter(|i| of(&i.kind)).count() as u32
    };
    let (leads, blocked_encounters) = world.counts();
    let segment = vec![0; time_s.len()];
    let recording = Recording::new(
        road,
        PLANNING_RATE_HZ,
        time_s,
        segment,
        ego,
        world.into_tracks(),
    )?;
    let collisions: Vec<Collision> = watch
        .collisions
        .iter()
        .map(|&(row, vehicle)| Collision {
            time_s: row as f64 / PLANNING_RATE_HZ,
            vehicle,
            cause: cause(
                &recording,
                line,
                &rule,
                settings.vehicle.width_m,
                (row, vehicle),
            ),
        })
        .collect();
    Ok(Rollout {
        recording,
        report: RolloutReport {
            collisions: collisions.len() as u32,
            rule_violations: watch.violations,
            interventions: counted(|k| matches!(k, InterventionKind::Braked { .. })),
            held_changes: counted(|k| matches!(k, InterventionKind::HeldChange { .. })),
            given_up_changes: counted(|k| matches!(k, InterventionKind::GaveUpChange { .. })),
            started_changes,
            leads,
            blocked_encounters,
        },
        trace,
        interventions,
        collisions,
        stopped,
    })
}

#[cfg(test)]
mod tests;
