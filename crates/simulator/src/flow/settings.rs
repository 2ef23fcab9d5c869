//! What a road of background traffic is made of, checked.

use super::{driver::IdmDriver, mobil::Mobil};
use crate::{
    error::SimulatorError,
    scenario::setting::{Range, check, check_section},
};

/// Whether a road closes on itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// The end is the start: nobody enters or leaves.
    Ring,
    /// Vehicles enter at the start and leave at the end.
    Open,
}

/// A road of background traffic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowSettings {
    /// Number of lanes, 1 to 8.
    pub lanes: u8,
    /// From its start to its end, or once around a ring, 100 to 1 000 000 m.
    pub length_m: f64,
    /// Ring or open road.
    pub shape: Shape,
    /// Time of one step, in s.
    pub step_s: f64,
    /// How drivers change lane; `None`: they do not.
    pub mobil: Option<Mobil>,
}

impl Default for FlowSettings {
    /// A ring of 1 km with three lanes, lane changes as published, ten steps a second.
    fn default() -> Self {
        Self {
            lanes: 3,
            length_m: 1000.0,
            shape: Shape::Ring,
            step_s: 0.1,
            mobil: Some(Mobil::default()),
        }
    }
}

/// A vehicle that is there from the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    /// Lane, 0 the right one.
    pub lane: u8,
    /// Front bumper, in m from the start of the road.
    pub front_m: f64,
    /// Speed, in m/s.
    pub speed_mps: f64,
    /// Who drives.
    pub driver: IdmDriver,
}

/// A vehicle that enters an open road as soon as there is room.
///
/// It enters with its rear at the start of the road, at its desired speed or that of the vehicle ahead if that is
/// slower and within 200 m, once the gap there is at least s0 + vT.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Departure {
    /// Earliest time, in s.
    pub time_s: f64,
    /// 0 is the right one.
    pub lane: u8,
    /// Who drives.
    pub driver: IdmDriver,
}

/// Least gap between two vehicles at the start, in m.
const LEAST_GAP_M: f64 = 0.5;

impl FlowSettings {
    pub(super) fn check(&self) -> Result<(), SimulatorError> {
        check("flow.lanes", f64::from(self.lanes), 1.0..=8.0)?;
        check("flow.length_m", self.length_m, 100.0..=1e6)?;
        check("flow.step_s", self.step_s, 0.01..=0.5)?;
        check_section("flow.mobil", &self.mobil)
    }

    fn check_lane(&self, section: &str, lane: u8) -> Result<(), SimulatorError> {
        let name = format!("{section}.lane");
        check(&name, f64::from(lane), Range::lane_of(self.lanes))
    }

    pub(super) fn check_departures(&self, departures: &[Departure]) -> Result<(), SimulatorError> {
        let mut last = 0.0;
        for (i, departure) in departures.iter().enumerate() {
            let section = format!("departures[{i}]");
            if self.shape == Shape::Ring {
                let none = Range::Because(-1.0, -1.0, "no departure: a ring has no start");
                check(&format!("{section}.lane"), f64::from(departure.lane), none)?;
            }
            check_section(&section, &departure.driver)?;
            self.check_lane(&section, departure.lane)?;
            let later = Range::Because(last, 1e9, "no earlier than the departure before");
            check(&format!("{section}.time_s"), departure.time_s, later)?;
            last = departure.time_s;
        }
        Ok(())
    }

    /// The order of `vehicles` along the road, if none overlaps another.
    pub(super) fn check_placed(&self, vehicles: &[Placed]) -> Result<Vec<usize>, SimulatorError> {
        for (i, placed) in vehicles.iter().enumerate() {
            let section = format!("vehicles[{i}]");
            check_section(&section, &placed.driver)?;
            self.check_lane(&section, placed.lane)?;
            let on_road = Range::Because(0.0, self.length_m.next_down(), "on the road");
            check(&format!("{section}.front_m"), placed.front_m, on_road)?;
            check(&format!("{section}.speed_mps"), placed.speed_mps, 0.0..=70.0)?;
        }
        let mut order: Vec<usize> = (0..vehicles.len()).collect();
        order.sort_by(|&i, &j| {
            let lanes = vehicles[i].lane.cmp(&vehicles[j].lane);
            lanes.then(vehicles[i].front_m.total_cmp(&vehicles[j].front_m))
        });
        for (place, &i) in order.iter().enumerate() {
            let lane = vehicles[i].lane;
            let next = order.get(place + 1).filter(|&&j| vehicles[j].lane == lane);
            let (lead, round_m) = match (next, self.shape) {
                (Some(&j), _) => (j, 0.0),
                (None, Shape::Open) => continue,
                (None, Shape::Ring) => {
                    let first = order.iter().find(|&&j| vehicles[j].lane == lane);
                    (first.copied().unwrap_or(i), self.length_m)
                }
            };
            let ahead = &vehicles[lead];
            let gap_m = ahead.front_m + round_m - ahead.driver.length_m - vehicles[i].front_m;
            let apart =
                Range::Because(LEAST_GAP_M, f64::MAX, "at least 0.5 m to the vehicle ahead");
            check(&format!("vehicles[{i}].gap_m"), gap_m, apart)?;
        }
        Ok(order)
    }
}
