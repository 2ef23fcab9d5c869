//! A drive that is stepped from outside, a row at a time.

use crate::{
    collision::{Collision, cause},
    control::{
        AutomatedDriver, Hands, InterventionKind,
        action::{Action, Manoeuvre},
        path::{PathShape, Steering},
    },
    drivers::{DriverParams, EvidenceDriver, EvidenceParams, HumanDriver, Person},
    error::SimulatorError,
    outcome::{Rollout, RolloutReport},
    planner::{PLANNING_RATE_HZ, Planner},
    road::CentreLine,
    scenario::{ControllerSettings, Scenario, ScenarioSettings, setting::check_section},
    traffic::EgoView,
    vehicle::{Command, Vehicle, build, ego_state},
    watch::Watch,
    world::World,
};
use maveric_domain::{
    EgoState, EgoTrack, MetresPerSecond, Recording, Road, Scene, TraceRow, VehicleState,
};

/// Who drives.
pub enum Driver<'a> {
    /// A synthetic person.
    Human(&'a DriverParams),
    /// A synthetic person of the second kind.
    Evidence(&'a EvidenceParams),
    /// A planner, through the controllers.
    Automated(&'a mut dyn Planner, &'a ControllerSettings),
    /// A person's hands and feet, given at each [`Session::tick`].
    Hands,
}

impl<'a> From<&'a Person> for Driver<'a> {
    fn from(person: &'a Person) -> Self {
        match person {
            Person::Driver(params) => Self::Human(params),
            Person::Evidence(params) => Self::Evidence(params),
        }
    }
}

enum Seat<'a> {
    Human(HumanDriver<'a>),
    Evidence(EvidenceDriver<'a>),
    Automated(AutomatedDriver<'a>),
    Hands,
}

/// From the edge of the right lane to the barrier, in m.
pub const RIGHT_SHOULDER_M: f64 = 3.0;
/// From the edge of the left lane to the barrier, in m.
pub const LEFT_SHOULDER_M: f64 = 1.2;

/// Ego at the present integration step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarState {
    /// Position along the road, in m.
    pub x_m: f64,
    /// Lateral position, in m.
    pub y_m: f64,
    /// Heading relative to the road, in rad.
    pub heading_rad: f64,
    /// Speed, in m/s.
    pub speed_mps: f64,
    /// Angle of the front wheels, in rad, positive to the left.
    pub steering_rad: f64,
    /// Time since the row recorded last, in s.
    pub since_row_s: f64,
}

/// A drive under way: [`Session::step`] moves everybody on by a row of the recording, [`Session::tick`] by an integration step.
///
/// [`rollout`](crate::rollout()) steps one to its end. Whoever shows a drive while it happens, or lets a person drive, ticks it
/// against a clock.
///
/// # Example
/// ```
/// # use maveric_simulator::{Driver, DriverParams, Scenario, Session};
/// # use maveric_domain::{LatentTraits, Seconds};
/// let scenario = Scenario::paper().with_duration(Seconds(10.0))?;
/// let driver = DriverParams::draw(&LatentTraits::default(), 1, 1);
/// let mut session = Session::new(&scenario, Driver::Human(&driver), 7)?;
/// while session.step() {
///     assert!(session.scene().ego.speed_mps > 0.0);
/// }
/// assert_eq!(session.finish()?.recording.rows(), 200);
/// # Ok::<(), maveric_simulator::SimulatorError>(())
/// ```
pub struct Session<'a> {
    settings: &'a ScenarioSettings,
    road: Road,
    line: &'a CentreLine,
    rule: ControllerSettings,
    seat: Seat<'a>,
    car: Box<dyn Vehicle>,
    steering: Steering,
    world: World<'a>,
    watch: Watch,
    started_changes: u32,
    trace: Vec<TraceRow>,
    stopped: Option<SimulatorError>,
    ego: EgoTrack,
    time_s: Vec<f64>,
    scene: Scene,
    rows: usize,
    action: Action,
    /// Integration steps since the row recorded last.
    ticks: usize,
    hands: Hands,
    at_barrier: bool,
    barrier_touches: u32,
}

impl<'a> Session<'a> {
    /// Puts `driver` on the road of `scenario`; nothing has been recorded yet.
    ///
    /// # Errors
    /// [`SimulatorError::Setting`] if the controller settings given with a planner, or a driver's parameters, are out of range.
    pub fn new(
        scenario: &'a Scenario,
        driver: Driver<'a>,
        seed: u64,
    ) -> Result<Self, SimulatorError> {
        let settings = scenario.settings();
        let (road, line) = (scenario.road(), scenario.centre_line());
        let vehicle = &settings.vehicle;
        let mut shape = PathShape::Bezier;
        let mut rule = settings.controllers.clone();
        let seat = match driver {
            Driver::Human(params) => {
                check_section("driver", params)?;
                Seat::Human(HumanDriver::new(params, vehicle, road, line, seed))
            }
            Driver::Evidence(params) => {
                check_section("driver", params)?;
                shape = PathShape::Eased { lateness: params.lateness };
                Seat::Evidence(EvidenceDriver::new(params, vehicle, road, line, seed))
            }
            Driver::Automated(planner, controllers) => {
                check_section("controllers", controllers)?;
                rule = controllers.clone();
                Seat::Automated(AutomatedDriver::new(planner, controllers, vehicle, road, line))
            }
            Driver::Hands => Seat::Hands,
        };
        let start = &settings.start;
        let car = build(
            vehicle,
            road.lane_centre_m(start.lane),
            MetresPerSecond::from_mph(start.speed_mph).0,
        );
        let steering = Steering::new(road.lane_width_m, rule.stanley_gain_per_s, start.lane, shape);
        let rows = (settings.duration_s * PLANNING_RATE_HZ).round() as usize;
        Ok(Self {
            settings,
            road,
            line,
            rule,
            seat,
            scene: Scene {
                time_s: 0.0,
                ego: ego_state(car.as_ref(), vehicle.length_m),
                vehicles: Vec::new(),
            },
            car,
            steering,
            world: World::new(scenario, seed)?,
            watch: Watch::default(),
            started_changes: 0,
            trace: Vec::new(),
            stopped: None,
            ego: EgoTrack { length_m: vehicle.length_m, ..EgoTrack::default() },
            time_s: Vec::with_capacity(rows),
            rows,
            action: Action::NOTHING,
            ticks: 0,
            hands: Hands::default(),
            at_barrier: false,
            barrier_touches: 0,
        })
    }

    /// As [`Session::new`], in traffic that the caller moves. Of the scenario count road, car, start, controllers and duration; nobody
    /// is on the road but who [`Session::meet`] tells of.
    ///
    /// # Errors
    /// As [`Session::new`].
    pub fn among_others(
        scenario: &'a Scenario,
        driver: Driver<'a>,
    ) -> Result<Self, SimulatorError> {
        let mut session = Self::new(scenario, driver, 0)?;
        session.world = World::elsewhere(scenario)?;
        Ok(session)
    }

    /// Says who is around at the row that the next step records. A vehicle keeps its id for as long as it is there.
    ///
    /// # Errors
    /// [`SimulatorError::Recording`] for a vehicle that is there twice, or whose place, speed or length is no number that a vehicle
    /// can have; [`SimulatorError::OwnTraffic`] in a session that moves its own traffic.
    pub fn meet(&mut self, vehicles: &[VehicleState]) -> Result<(), SimulatorError> {
        let row = self.time_s.len();
        let elsewhere = self.world.elsewhere_mut().ok_or(SimulatorError::OwnTraffic)?;
        Ok(elsewhere.tell(vehicles, row)?)
    }

    /// Where the car is at the row that the next step records.
    pub fn ego(&self) -> EgoState {
        ego_state(self.car.as_ref(), self.settings.vehicle.length_m)
    }

    /// Everything visible at the row recorded last; ego alone before the first.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Ego at the present integration step.
    pub fn car(&self) -> CarState {
        let pose = self.car.pose();
        CarState {
            x_m: pose.x_m,
            y_m: pose.y_m,
            heading_rad: pose.heading_rad,
            speed_mps: pose.speed_mps,
            steering_rad: self.car.steering_rad(),
            since_row_s: self.ticks as f64 * self.settings.vehicle.step_s,
        }
    }

    /// The lane that the automated or synthetic driver keeps or goes to, and the one a change under way came from; a person's
    /// lane is where the car is.
    pub fn lane(&self) -> (u8, Option<u8>) {
        match self.seat {
            Seat::Hands => (self.road.nearest_lane(self.car.pose().y_m), None),
            _ => (self.steering.lane(), self.steering.coming_from()),
        }
    }

    /// What was asked and decided at the row recorded last; none for people.
    pub fn decided(&self) -> Option<&TraceRow> {
        self.trace.last()
    }

    /// Collisions so far, and how often the barrier was touched.
    pub fn contacts(&self) -> (u32, u32) {
        (self.watch.collisions.len() as u32, self.barrier_touches)
    }

    /// Records the next row and drives on until the one after; false, and nothing done, once the drive is over. A person's
    /// hands stay where they were.
    pub fn step(&mut self) -> bool {
        let hands = self.hands;
        while self.tick(hands) {
            if self.ticks == 0 {
                return true;
            }
        }
        false
    }

    /// Drives one integration step on (0.01 s unless the scenario says otherwise), with a person's hands where a person drives;
    /// false, and nothing done, once the drive is over. A row is recorded at the first step of each 0.05 s.
    pub fn tick(&mut self, hands: Hands) -> bool {
        if self.ticks == 0 && !self.begin_row() {
            return false;
        }
        self.hands = hands;
        let command = match self.seat {
            Seat::Hands => hands.command(&self.settings.vehicle, self.car.pose().speed_mps),
            _ => Command {
                acceleration_mps2: self.action.acceleration_mps2,
                steering_rad: self.steering.angle_rad(self.car.as_ref(), self.line),
            },
        };
        self.car.step(command, self.line);
        if matches!(self.seat, Seat::Hands) {
            self.stay_between_barriers();
        }
        self.ticks += 1;
        if self.ticks == self.settings.vehicle.steps_per_row() {
            self.ticks = 0;
            self.world.advance();
        }
        true
    }

    fn stay_between_barriers(&mut self) {
        let outermost = f64::from(self.road.lanes) - 0.5;
        let half_m = 0.5 * self.settings.vehicle.width_m;
        let low_m = half_m - 0.5 * self.road.lane_width_m - RIGHT_SHOULDER_M;
        let high_m = outermost * self.road.lane_width_m + LEFT_SHOULDER_M - half_m;
        let y_m = self.car.pose().y_m;
        let touches = !(low_m..=high_m).contains(&y_m);
        if touches {
            self.car.slide_along(y_m.clamp(low_m, high_m));
        }
        self.barrier_touches += u32::from(touches && !self.at_barrier);
        self.at_barrier = touches;
    }

    /// Records the row that begins here and decides what everybody does until the next; false once the drive is over.
    fn begin_row(&mut self) -> bool {
        let row = self.time_s.len();
        // A recording has at least two rows.
        if row >= self.rows || (self.stopped.is_some() && row >= 2) {
            return false;
        }
        self.record(row);
        let action = self.act();
        self.decide(row);
        self.steering.drive_at(action.lane_offset_m);
        if let Some(manoeuvre) = action.manoeuvre {
            self.started_changes += u32::from(matches!(manoeuvre, Manoeuvre::Change { .. }));
            self.steering.begin(manoeuvre, self.car.pose());
        }
        if let Seat::Automated(automated) = &self.seat
            && self.stopped.is_none()
        {
            let now = automated.trace(self.scene.time_s, &self.steering);
            self.trace.extend(now);
        }
        self.action = action;
        true
    }

    fn record(&mut self, row: usize) {
        let scene = &mut self.scene;
        scene.time_s = row as f64 / PLANNING_RATE_HZ;
        scene.ego = ego_state(self.car.as_ref(), self.settings.vehicle.length_m);
        self.world.states(&mut scene.vehicles);
        for vehicle in &mut scene.vehicles {
            vehicle.x_m = self.line.lane_x_m(scene.ego.x_m, vehicle.x_m, vehicle.y_m);
        }
        self.time_s.push(scene.time_s);
        self.ego.x_m.push(scene.ego.x_m);
        self.ego.y_m.push(scene.ego.y_m);
        self.ego.speed_mps.push(scene.ego.speed_mps);
        self.world.record(row);
        let width_m = self.settings.vehicle.width_m;
        self.watch.look(row, &self.scene, &self.road, &self.rule, width_m);
    }

    fn act(&mut self) -> Action {
        let (scene, steering) = (&self.scene, &self.steering);
        match &mut self.seat {
            Seat::Human(human) => human.act(scene, steering),
            Seat::Evidence(person) => person.act(scene, steering),
            Seat::Hands => Action::NOTHING,
            Seat::Automated(_) if self.stopped.is_some() => Action::NOTHING,
            Seat::Automated(automated) => automated.act(scene, steering).unwrap_or_else(|error| {
                self.stopped = Some(error);
                Action::NOTHING
            }),
        }
    }

    fn decide(&mut self, row: usize) {
        let ego = &self.scene.ego;
        let lane = self.road.nearest_lane(ego.y_m);
        let beside_m = (ego.y_m - self.road.lane_centre_m(lane)).abs();
        let body_inside =
            beside_m + 0.5 * self.settings.vehicle.width_m <= 0.5 * self.road.lane_width_m;
        let (bound_for, keeping) = match self.seat {
            // Nobody says where a person is going: a lane is kept as long as the car is between its marks.
            Seat::Hands => (lane, body_inside),
            _ => (self.steering.lane(), self.steering.coming_from().is_none()),
        };
        let view = EgoView {
            x_m: ego.x_m,
            y_m: ego.y_m,
            speed_mps: ego.speed_mps,
            length_m: ego.length_m,
            lane,
            bound_for,
            keeping,
            target_mps: self.world.target_mps(),
        };
        self.world.decide(&view, row, self.scene.time_s);
    }

    /// What was recorded, and what is to be said about it.
    ///
    /// # Errors
    /// [`SimulatorError::Recording`] if fewer than two rows were driven.
    pub fn finish(self) -> Result<Rollout, SimulatorError> {
        let interventions = match self.seat {
            Seat::Human(_) | Seat::Evidence(_) | Seat::Hands => Vec::new(),
            Seat::Automated(automated) => automated.into_interventions(),
        };
        let counted = |is_kind: fn(&InterventionKind) -> bool| {
            interventions.iter().filter(|i| is_kind(&i.kind)).count() as u32
        };
        let (leads, blocked_encounters) = self.world.counts();
        let segment = vec![0; self.time_s.len()];
        let recording = Recording::new(
            self.road,
            PLANNING_RATE_HZ,
            self.time_s,
            segment,
            self.ego,
            self.world.into_tracks(),
        )?;
        let width_m = self.settings.vehicle.width_m;
        let collision = |&(row, vehicle)| Collision {
            time_s: row as f64 / PLANNING_RATE_HZ,
            vehicle,
            cause: cause(&recording, self.line, &self.rule, width_m, (row, vehicle)),
        };
        let collisions: Vec<Collision> = self.watch.collisions.iter().map(collision).collect();
        Ok(Rollout {
            report: RolloutReport {
                collisions: collisions.len() as u32,
                rule_violations: self.watch.violations,
                inside_safe_distance_s: self.watch.inside_s,
                least_safe_distance_share: self.watch.least_share,
                interventions: counted(|k| matches!(k, InterventionKind::Braked { .. })),
                held_changes: counted(|k| matches!(k, InterventionKind::HeldChange { .. })),
                given_up_changes: counted(|k| matches!(k, InterventionKind::GaveUpChange { .. })),
                started_changes: self.started_changes,
                barrier_touches: self.barrier_touches,
                leads,
                blocked_encounters,
            },
            recording,
            trace: self.trace,
            interventions,
            collisions,
            stopped: self.stopped,
        })
    }
}
