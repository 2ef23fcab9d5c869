//! Background traffic: the Intelligent Driver Model along the lane, MOBIL between lanes, on rings and open roads.
//!
//! Each lane holds its vehicles in order, one column a quantity, so that neighbours are the entries before and after:
//! a step costs the same per vehicle at 10 and at 10,000. Nothing is drawn at random in a step and nothing is
//! allocated.
//!
//! # Source
//! Treiber, Hennecke and Helbing 2000; Kesting, Treiber and Helbing 2007. See `docs/simulator.md` for what was checked.

mod around_ego;
mod changes;
mod driver;
mod lane;
mod mix;
mod mobil;
mod rebuild;
mod settings;

pub(crate) use around_ego::AroundEgo;
pub use driver::IdmDriver;
use lane::{Ends, Lane, Role};
pub use mix::{TrafficMix, departures, evenly};
pub use mobil::Mobil;
pub use settings::{Departure, FlowSettings, Placed, Shape};

use crate::error::SimulatorError;

/// A vehicle of the background as others see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowVehicle {
    /// Which one: its place in the list it was given in, departures after those placed.
    pub id: u32,
    /// Front bumper along the road, in m.
    pub front_m: f64,
    /// Speed, in m/s.
    pub speed_mps: f64,
    /// Acceleration of the last step, in m/s².
    pub acceleration_mps2: f64,
    /// Bumper to bumper, in m.
    pub length_m: f64,
    /// Lane that it drives in, or is moving into; 0 the right one.
    pub lane: u8,
    /// Where it is across the road, in lanes: between two whole numbers during a change.
    pub lateral_lanes: f64,
    /// Bumper to bumper to the vehicle ahead in `lane`, in m; infinite on free road.
    pub gap_m: f64,
}

/// A change of lane under way.
#[derive(Debug, Clone, Copy, Default)]
struct Change {
    from: u8,
    into: u8,
    began: u32,
    ends: u32,
}

/// A vehicle moved from outside.
#[derive(Debug, Clone, Copy)]
struct Guest {
    lanes: [Option<u8>; 2],
    front_m: f64,
    speed_mps: f64,
    driver: IdmDriver,
}

/// Background traffic on one road.
///
/// # Example
/// ```
/// use maveric_simulator::flow::{Flow, FlowSettings, Shape, TrafficMix, evenly};
/// let settings = FlowSettings { lanes: 2, length_m: 1000.0, shape: Shape::Ring, ..FlowSettings::default() };
/// let vehicles = evenly(&settings, 40, &TrafficMix::default(), 1)?;
/// let mut flow = Flow::new(settings, &vehicles, Vec::new())?;
/// for _ in 0..600 {
///     flow.step();
/// }
/// assert_eq!(flow.len(), 40);
/// assert!(flow.mean_speed_mps() > 10.0);
/// # Ok::<(), maveric_simulator::SimulatorError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Flow {
    settings: FlowSettings,
    ends: Ends,
    lanes: Vec<Lane>,
    /// Arrivals of this step by lane, in order.
    staged: Vec<Lane>,
    /// Whether a lane has arrivals or departures this step.
    touched: Vec<bool>,
    spare: Lane,
    decided: Vec<usize>,
    /// By vehicle.
    changes: Vec<Change>,
    /// Vehicles that take up two lanes now: id, then lane and index there of the entry that drives and the one that leaves.
    pairs: Vec<(u32, [(usize, usize); 2])>,
    changing: usize,
    guests: Vec<Option<Guest>>,
    departures: Vec<Departure>,
    /// By lane, the next departure.
    next_departure: Vec<usize>,
    placed: usize,
    step: u32,
    started_changes: u64,
}

impl Flow {
    /// Puts `vehicles` on the road of `settings`; `departures`, in order of time, come later at the start of an open road.
    ///
    /// # Errors
    /// [`SimulatorError::Setting`] if a number is out of range, a lane does not exist, two vehicles are nearer than 0.5 m,
    /// or departures are out of order or on a ring; it names the vehicle.
    pub fn new(
        settings: FlowSettings,
        vehicles: &[Placed],
        departures: Vec<Departure>,
    ) -> Result<Self, SimulatorError> {
        settings.check()?;
        settings.check_departures(&departures)?;
        let order = settings.check_placed(vehicles)?;
        let ends = match settings.shape {
            Shape::Ring => Ends::Ring(settings.length_m),
            Shape::Open => Ends::Open,
        };
        let count = usize::from(settings.lanes);
        let total = vehicles.len() + departures.len();
        // A vehicle takes up two entries while it changes lane, a guest two while ego does.
        let capacity = 2 * total + 2 * GUESTS;
        let lane = || Lane::with_capacity(capacity);
        let mut flow = Self {
            ends,
            lanes: (0..count).map(|_| lane()).collect(),
            staged: (0..count).map(|_| lane()).collect(),
            touched: vec![false; count],
            spare: lane(),
            decided: Vec::with_capacity(capacity),
            changes: vec![Change::default(); total],
            pairs: Vec::with_capacity(total),
            changing: 0,
            guests: vec![None; GUESTS],
            next_departure: vec![0; count],
            placed: vehicles.len(),
            departures,
            step: 0,
            started_changes: 0,
            settings,
        };
        for i in order {
            let placed = &vehicles[i];
            flow.lanes[usize::from(placed.lane)].push(
                placed.front_m,
                placed.speed_mps,
                i as u32,
                Role::Moving,
                &placed.driver,
            );
        }
        flow.accelerate_all();
        Ok(flow)
    }

    /// Puts the guest `key` (0 to 7), such as ego, where it is now, in up to two lanes; no lanes: it is gone.
    ///
    /// `front_m` may lie anywhere; on a ring it is taken round. The others follow it and change lane around it as if
    /// it were one of them; the step moves it on at its speed until it is placed again. A `key` above 7 or a lane that
    /// does not exist is ignored.
    pub fn place_guest(
        &mut self,
        key: usize,
        lanes: [Option<u8>; 2],
        front_m: f64,
        speed_mps: f64,
        length_m: f64,
    ) {
        let there = |lane: &Option<u8>| lane.is_some_and(|l| l < self.settings.lanes);
        let lanes = lanes.map(|lane| lane.filter(|_| there(&lane)));
        let front_m = match self.ends {
            Ends::Ring(length) => front_m.rem_euclid(length),
            Ends::Open => front_m,
        };
        let guest = Guest {
            lanes,
            front_m,
            speed_mps: speed_mps.max(0.0),
            driver: IdmDriver { length_m, ..IdmDriver::CAR },
        };
        if let Some(slot) = self.guests.get_mut(key) {
            let before = slot.replace(guest).map_or([None; 2], |g| g.lanes);
            self.move_guest(key, before, &guest);
        }
    }

    /// Moves everybody on by one step.
    pub fn step(&mut self) {
        self.accelerate_all();
        self.end_changes();
        self.let_enter();
        self.consider_changes();
        self.rebuild_touched();
        let dt = self.settings.step_s;
        for lane in &mut self.lanes {
            lane.advance(dt, self.ends);
        }
        if self.ends == Ends::Open {
            self.let_leave();
        }
        self.step += 1;
    }

    fn accelerate_all(&mut self) {
        for lane in &mut self.lanes {
            lane.accelerate(self.ends);
        }
        self.join_pairs();
    }

    /// Vehicles on the road.
    pub fn len(&self) -> usize {
        let entries: usize = self.lanes.iter().map(Lane::len).sum();
        let guests: usize =
            self.guests.iter().flatten().map(|g| g.lanes.iter().flatten().count()).sum();
        entries - self.changing - guests
    }

    /// Whether nobody is on the road.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Time since the start, in s.
    pub fn time_s(&self) -> f64 {
        f64::from(self.step) * self.settings.step_s
    }

    /// Lane changes started so far.
    pub fn started_changes(&self) -> u64 {
        self.started_changes
    }

    /// Mean speed of those on the road, in m/s; 0 where there is nobody.
    pub fn mean_speed_mps(&self) -> f64 {
        let (sum, n) = self.vehicles().fold((0.0, 0.0), |(sum, n), v| (sum + v.speed_mps, n + 1.0));
        if n > 0.0 { sum / n } else { 0.0 }
    }

    /// Everybody on the road but guests, lane by lane from the right, in order along each.
    pub fn vehicles(&self) -> impl Iterator<Item = FlowVehicle> + '_ {
        self.lanes.iter().enumerate().flat_map(move |(lane, entries)| {
            (0..entries.len()).filter_map(move |rank| {
                let i = entries.at(rank);
                (entries.role[i] == Role::Moving).then(|| self.view(lane as u8, entries, i))
            })
        })
    }

    fn view(&self, lane: u8, entries: &Lane, i: usize) -> FlowVehicle {
        let id = entries.id[i];
        let change = self.changes[id as usize];
        let lateral_lanes = if change.ends > self.step {
            let share = f64::from(self.step - change.began) / f64::from(change.ends - change.began);
            f64::from(change.from) + (f64::from(lane) - f64::from(change.from)) * eased(share)
        } else {
            f64::from(lane)
        };
        FlowVehicle {
            id,
            front_m: entries.x[i],
            speed_mps: entries.v[i],
            acceleration_mps2: entries.acc[i],
            length_m: entries.length[i],
            lane,
            lateral_lanes,
            gap_m: entries.lead(i, self.ends).0,
        }
    }
}

/// Number of guests that a road takes.
const GUESTS: usize = 8;

/// From 0 to 1 without a jump in speed or acceleration: 10t³ - 15t⁴ + 6t⁵.
fn eased(t: f64) -> f64 {
    t * t * t * (10.0 + t * (6.0 * t - 15.0))
}

#[cfg(test)]
mod tests;
