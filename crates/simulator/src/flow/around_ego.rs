//! A ring of background traffic that moves with ego.

use super::{Flow, evenly};
use crate::{
    error::SimulatorError,
    scenario::{BackgroundSettings, ScenarioSettings},
    traffic::EgoView,
};
use maveric_domain::{MetresPerSecond, ObjectTrack, Road, VehicleId, VehicleState};

/// How much further than it came into sight a vehicle goes out of it, in m: no flutter at the edge.
const EDGE_M: f64 = 20.0;
/// Ego, among the guests of the ring.
const EGO: usize = 0;

/// A vehicle in sight.
#[derive(Debug, Clone, Copy)]
struct Shown {
    state: VehicleState,
    track: usize,
}

/// The background as ego meets it.
#[derive(Debug, Clone)]
pub(crate) struct AroundEgo {
    flow: Flow,
    road: Road,
    ring_m: f64,
    seen_m: f64,
    ego_width_m: f64,
    /// Place on the ring of the road's x = 0.
    origin_m: f64,
    /// Ego at `row`, the present row.
    ego: EgoView,
    row: usize,
    /// By vehicle of the ring.
    shown: Vec<Option<Shown>>,
}

impl AroundEgo {
    /// Fills the ring; ego takes the place of one of its vehicles.
    ///
    /// # Errors
    /// [`SimulatorError::Setting`] if so many vehicles do not fit.
    pub(crate) fn new(
        background: &BackgroundSettings,
        settings: &ScenarioSettings,
        road: Road,
        seed: u64,
        tracks: &mut Vec<ObjectTrack>,
    ) -> Result<Self, SimulatorError> {
        let ego = EgoView {
            x_m: 0.0,
            y_m: road.lane_centre_m(settings.start.lane),
            speed_mps: MetresPerSecond::from_mph(settings.start.speed_mph).0,
            length_m: settings.vehicle.length_m,
            lane: settings.start.lane,
            bound_for: settings.start.lane,
            keeping: true,
            target_mps: road.posted_speed_mps,
        };
        let flow_settings = background.flow(road.lanes);
        let count = background.count(road.lanes);
        let mut vehicles = evenly(&flow_settings, count, &background.mix, seed)?;
        let index = vehicles.iter().position(|v| v.lane == ego.lane);
        let place = index.map(|i| vehicles.swap_remove(i));
        let front_m = ego.x_m + 0.5 * ego.length_m;
        let origin_m = place.map_or(0.0, |place| place.front_m - front_m);
        if let Some(wave) = &background.wave {
            for vehicle in &mut vehicles {
                let ahead_m = (vehicle.front_m - origin_m - front_m).rem_euclid(background.ring_m);
                let share = (ahead_m - wave.ahead_m) / wave.length_m;
                if (0.0..=1.0).contains(&share) {
                    vehicle.speed_mps += share * (wave.speed_mps - vehicle.speed_mps);
                }
            }
        }
        let mut around = Self {
            flow: Flow::new(flow_settings, &vehicles, Vec::new())?,
            road,
            ring_m: background.ring_m,
            seen_m: background.seen_within_m,
            ego_width_m: settings.vehicle.width_m,
            origin_m,
            ego,
            row: 0,
            shown: vec![None; vehicles.len()],
        };
        around.place_ego(&ego, 0);
        around.look(tracks);
        Ok(around)
    }

    /// Tells the background where ego is at `row`: in each lane that its body reaches into or its turn signal shows.
    pub(crate) fn place_ego(&mut self, ego: &EgoView, row: usize) {
        (self.ego, self.row) = (*ego, row);
        let reach_m = 0.5 * (self.road.lane_width_m + self.ego_width_m);
        let mut lanes = [None; 2];
        let touched = (0..self.road.lanes).filter(|&lane| {
            let reaches = (ego.y_m - self.road.lane_centre_m(lane)).abs() < reach_m;
            reaches || lane == ego.bound_for
        });
        for (slot, lane) in lanes.iter_mut().zip(touched) {
            *slot = Some(lane);
        }
        let front_m = ego.x_m + 0.5 * ego.length_m + self.origin_m;
        self.flow.place_guest(EGO, lanes, front_m, ego.speed_mps, ego.length_m);
    }

    /// Moves everybody on by one row, and notes who is in sight then.
    pub(crate) fn advance(&mut self, tracks: &mut Vec<ObjectTrack>) {
        self.flow.step();
        self.row += 1;
        self.look(tracks);
    }

    fn look(&mut self, tracks: &mut Vec<ObjectTrack>) {
        let (ego, row) = (self.ego, self.row);
        let half_m = 0.5 * self.ring_m;
        let ego_m = (ego.x_m + self.origin_m).rem_euclid(self.ring_m);
        for vehicle in self.flow.vehicles() {
            let straight_m = vehicle.front_m - 0.5 * vehicle.length_m - ego_m;
            let ahead_m = if straight_m > half_m {
                straight_m - self.ring_m
            } else if straight_m < -half_m {
                straight_m + self.ring_m
            } else {
                straight_m
            };
            let slot = &mut self.shown[vehicle.id as usize];
            let limit_m = self.seen_m + if slot.is_some() { EDGE_M } else { 0.0 };
            if ahead_m.abs() > limit_m {
                *slot = None;
                continue;
            }
            let shown = slot.get_or_insert_with(|| {
                let id = VehicleId(tracks.len() as u32 + 1);
                tracks.push(ObjectTrack::new(id, vehicle.length_m, row));
                Shown {
                    state: VehicleState {
                        id,
                        x_m: 0.0,
                        y_m: 0.0,
                        speed_mps: 0.0,
                        length_m: vehicle.length_m,
                    },
                    track: tracks.len() - 1,
                }
            });
            shown.state.x_m = ego.x_m + ahead_m;
            shown.state.y_m = vehicle.lateral_lanes * self.road.lane_width_m;
            shown.state.speed_mps = vehicle.speed_mps;
        }
    }

    /// Those in sight.
    pub(crate) fn states(&self) -> impl Iterator<Item = VehicleState> + '_ {
        self.shown.iter().flatten().map(|shown| shown.state)
    }

    /// Writes those in sight down as the next row of the recording.
    pub(crate) fn record(&self, tracks: &mut [ObjectTrack]) {
        for shown in self.shown.iter().flatten() {
            tracks[shown.track].push(&shown.state);
        }
    }
}
