//! The road and everybody on it but ego.

use crate::{
    elsewhere::Elsewhere,
    error::SimulatorError,
    flow::AroundEgo,
    planner::PLANNING_STEP_S,
    road::CentreLine,
    scenario::{Scenario, ScenarioSettings},
    traffic::{
        Arrival, Blockade, Car, EgoView, LeadSchedule, OffLaneTraffic, Role, Script, acceleration,
        distance_m,
    },
};
use maveric_domain::{ObjectTrack, Road, VehicleId, VehicleState, stream_seed};

/// Distance within which a vehicle ahead means that ego is not on free road, in m.
const FREE_ROAD_M: f64 = 200.0;

/// v_e: the mean of ego's speed on free road so far; the posted speed before that.
#[derive(Debug, Clone)]
struct TargetSpeed {
    posted_mps: f64,
    sum_mps: f64,
    rows: f64,
}

impl TargetSpeed {
    fn value_mps(&self) -> f64 {
        if self.rows > 0.0 { self.sum_mps / self.rows } else { self.posted_mps }
    }
}

/// The traffic, moved on row by row.
#[derive(Debug, Clone)]
pub(crate) struct World<'a> {
    settings: &'a ScenarioSettings,
    road: Road,
    line: &'a CentreLine,
    cars: Vec<Car>,
    tracks: Vec<ObjectTrack>,
    target: TargetSpeed,
    schedule: LeadSchedule,
    off_lane: OffLaneTraffic,
    blockade: Option<Blockade>,
    blockades: u32,
    background: Option<AroundEgo>,
    /// Whoever moves everybody in the place of all the above.
    elsewhere: Option<Elsewhere>,
}

impl<'a> World<'a> {
    pub(crate) fn new(scenario: &'a Scenario, seed: u64) -> Result<Self, SimulatorError> {
        let settings = scenario.settings();
        let road = scenario.road();
        let stream = |name| stream_seed(seed, &["world", name]);
        let mut world = Self {
            settings,
            road,
            line: scenario.centre_line(),
            cars: Vec::new(),
            tracks: Vec::new(),
            target: TargetSpeed { posted_mps: road.posted_speed_mps, sum_mps: 0.0, rows: 0.0 },
            schedule: LeadSchedule::new(settings, road.posted_speed_mps, stream("leads")),
            off_lane: OffLaneTraffic::new(&settings.off_lane, stream("off_lane")),
            blockade: None,
            blockades: 0,
            background: None,
            elsewhere: None,
        };
        for (index, placed) in settings.vehicles.iter().enumerate() {
            let arrival = Arrival {
                x_m: placed.ahead_m,
                lane: placed.lane,
                speed_mps: placed.speed_mps,
                role: if placed.script.is_empty() {
                    Role::Steady { speed_mps: placed.speed_mps, passing_by: false }
                } else {
                    Role::Scripted(Script::new(index, placed.speed_mps))
                },
            };
            world.arrive(arrival, 0);
        }
        if let Some(background) = &settings.background {
            let seed = stream("background");
            let around = AroundEgo::new(background, settings, road, seed, &mut world.tracks)?;
            world.background = Some(around);
        }
        Ok(world)
    }

    /// The road alone: who is on it is told from outside.
    pub(crate) fn elsewhere(scenario: &'a Scenario) -> Result<Self, SimulatorError> {
        let mut world = Self::new(scenario, 0)?;
        world.cars.clear();
        world.tracks.clear();
        world.background = None;
        world.elsewhere = Some(Elsewhere::default());
        Ok(world)
    }

    /// What is told from outside; none where the traffic is our own.
    pub(crate) fn elsewhere_mut(&mut self) -> Option<&mut Elsewhere> {
        self.elsewhere.as_mut()
    }

    /// Everybody's state, into `vehicles`.
    pub(crate) fn states(&self, vehicles: &mut Vec<VehicleState>) {
        vehicles.clear();
        vehicles.extend(self.cars.iter().map(|car| car.state));
        vehicles.extend(self.background.iter().flat_map(AroundEgo::states));
        vehicles.extend(self.elsewhere.iter().flat_map(|e| &e.states));
    }

    /// v_e, in m/s.
    pub(crate) fn target_mps(&self) -> f64 {
        self.target.value_mps()
    }

    /// Leads and blocked encounters so far.
    pub(crate) fn counts(&self) -> (u32, u32) {
        (self.schedule.count(), self.blockades)
    }

    /// The tracks of everybody who was ever there, in order of arrival.
    pub(crate) fn into_tracks(self) -> Vec<ObjectTrack> {
        let mut tracks = self.tracks;
        tracks.retain(|track| !track.x_m.is_empty());
        tracks
    }

    fn arrive(&mut self, arrival: Arrival, row: usize) -> VehicleId {
        let id = VehicleId(self.tracks.len() as u32 + 1);
        let length_m = self.settings.vehicle.length_m;
        self.cars.push(Car {
            state: VehicleState {
                id,
                x_m: arrival.x_m,
                y_m: self.road.lane_centre_m(arrival.lane),
                speed_mps: arrival.speed_mps,
                length_m,
            },
            lane: arrival.lane,
            acceleration_mps2: 0.0,
            role: arrival.role,
            track: self.tracks.len(),
        });
        self.tracks.push(ObjectTrack::new(id, length_m, row));
        id
    }

    /// Writes everybody's state down as the next row of the recording, which is `row`.
    pub(crate) fn record(&mut self, row: usize) {
        if let Some(elsewhere) = &mut self.elsewhere {
            elsewhere.record(row, &mut self.tracks);
        }
        for car in &self.cars {
            self.tracks[car.track].push(&car.state);
        }
        if let Some(background) = &self.background {
            background.record(&mut self.tracks);
        }
    }

    /// Decides what everybody does until the next row: who comes, who leaves, who speeds up.
    ///
    /// `row` is the present row of the recording; arrivals are in the next.
    pub(crate) fn decide(&mut self, ego: &EgoView, row: usize, time_s: f64) {
        if self.elsewhere.is_some() {
            return;
        }
        self.note_target_speed(ego, time_s);
        if let Some(background) = &mut self.background {
            background.place_ego(ego, row);
        }
        let limit_m = self.settings.leads.removed_m;
        self.cars.retain(|car| {
            let stays =
                matches!(car.role, Role::Scripted(_) | Role::Steady { passing_by: false, .. });
            stays || distance_m(ego, &car.state).abs() <= limit_m
        });
        self.let_arrive(ego, row + 1, time_s);
        self.end_blockade(ego, time_s);
        for car in &mut self.cars {
            if let Role::Scripted(script) = &mut car.role {
                let vehicles = &self.settings.vehicles;
                car.lane = script.follow(vehicles, &mut car.state, ego, &self.road, time_s);
            }
        }
        let accelerations: Vec<f64> =
            self.cars.iter().map(|car| acceleration::held_back(car, &self.cars, ego)).collect();
        for (car, held_back) in self.cars.iter_mut().zip(accelerations) {
            let free = acceleration::wanted(car, self.settings, self.line, ego, time_s);
            car.acceleration_mps2 = free.min(held_back);
        }
    }

    fn note_target_speed(&mut self, ego: &EgoView, time_s: f64) {
        let free = !self.cars.iter().any(|car| {
            car.lane == ego.lane
                && car.state.x_m > ego.x_m
                && distance_m(ego, &car.state) <= FREE_ROAD_M
        });
        if free && ego.keeping && time_s > self.settings.leads.target_speed_from_s {
            self.target.sum_mps += ego.speed_mps;
            self.target.rows += 1.0;
        }
    }

    fn let_arrive(&mut self, ego: &EgoView, row: usize, time_s: f64) {
        let length_m = self.settings.vehicle.length_m;
        if let Some((lead, blocked)) = self.schedule.next(&self.cars, ego, length_m, time_s) {
            let id = self.arrive(lead, row);
            self.schedule.arrived(id);
            if blocked && ego.lane == 0 && self.settings.blocked.cars > 0 {
                let s = &self.settings.blocked;
                let (blockade, cars) = Blockade::raise(s, &mut self.cars, ego, id, time_s);
                for car in cars {
                    self.arrive(car, row);
                }
                self.blockade = Some(blockade);
                self.blockades += 1;
                self.off_lane.quiet_until(time_s + s.quiet_s);
            }
        }
        if self.blockade.is_none()
            && self.background.is_none()
            && let Some(car) = self.off_lane.next(&self.cars, ego, time_s)
        {
            self.arrive(car, row);
        }
    }

    fn end_blockade(&mut self, ego: &EgoView, time_s: f64) {
        let Some(blockade) = &mut self.blockade else {
            return;
        };
        if !blockade.ends(&self.settings.blocked, &self.cars, ego, time_s) {
            return;
        }
        self.blockade = None;
        for car in &mut self.cars {
            if let Role::Blocker { leaving, .. } = &mut car.role {
                *leaving = true;
            }
        }
    }

    /// Moves everybody on by one row.
    pub(crate) fn advance(&mut self) {
        if let Some(background) = &mut self.background {
            background.advance(&mut self.tracks);
        }
        for car in &mut self.cars {
            let before = car.state.speed_mps;
            let after = (before + car.acceleration_mps2 * PLANNING_STEP_S).max(0.0);
            car.state.speed_mps = after;
            let travelled = 0.5 * (before + after) * PLANNING_STEP_S;
            car.state.x_m += travelled * self.line.stretch(car.state.x_m, car.state.y_m);
        }
    }
}
