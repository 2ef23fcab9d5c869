//! Who drives: cars and trucks with desired speeds and time gaps of their own.

use super::{
    driver::IdmDriver,
    settings::{Departure, FlowSettings, Placed},
};
use crate::{
    error::SimulatorError,
    normal::standard_normal,
    scenario::setting::{Range, check, check_section, settings},
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

settings! {
    /// The drivers of the background.
    ///
    /// The spreads are chosen; the means are those of [`IdmDriver::CAR`] and [`IdmDriver::TRUCK`] unless a scenario says
    /// otherwise.
    #[derive(Copy)]
    pub struct TrafficMix {
        /// Share of trucks.
        truck_share: f64 = 0.1, 0.0..=1.0;
        /// The average car: all keys or none.
        car: IdmDriver = IdmDriver::CAR;
        /// The average truck: all keys or none.
        truck: IdmDriver = IdmDriver::TRUCK;
        /// SD of the desired speed, as a share of the mean; cut at two SD.
        desired_speed_spread: f64 = 0.1, 0.0..=0.3;
        /// SD of the time gap, as a share of the mean; cut at two SD.
        time_gap_spread: f64 = 0.15, 0.0..=0.3;
    }
}

impl TrafficMix {
    /// Everybody the same.
    pub fn alike(driver: IdmDriver) -> Self {
        Self {
            truck_share: 0.0,
            car: driver,
            truck: driver,
            desired_speed_spread: 0.0,
            time_gap_spread: 0.0,
        }
    }

    pub(crate) fn draw(&self, rng: &mut Pcg64Mcg) -> IdmDriver {
        let truck = rng.random::<f64>() < self.truck_share;
        let mut factor = |spread: f64| {
            let normal: f64 = standard_normal(rng);
            1.0 + spread * normal.clamp(-2.0, 2.0)
        };
        let (speed, gap) = (factor(self.desired_speed_spread), factor(self.time_gap_spread));
        let mean = if truck { self.truck } else { self.car };
        IdmDriver {
            desired_speed_mps: mean.desired_speed_mps * speed,
            time_gap_s: mean.time_gap_s * gap,
            ..mean
        }
    }
}

/// `count` vehicles of `mix`, lane by lane in turn, at even gaps and at the speed that suits the gap.
///
/// The same `seed` gives the same vehicles.
///
/// # Errors
/// [`SimulatorError::Setting`] if a number is out of range or the vehicles do not fit on the road with 1 m between them.
pub fn evenly(
    settings: &FlowSettings,
    count: usize,
    mix: &TrafficMix,
    seed: u64,
) -> Result<Vec<Placed>, SimulatorError> {
    settings.check()?;
    check_section("mix", mix)?;
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let drivers: Vec<IdmDriver> = (0..count).map(|_| mix.draw(&mut rng)).collect();
    let lanes = usize::from(settings.lanes);
    let mut placed = Vec::with_capacity(count);
    for lane in 0..lanes {
        let in_lane = || drivers.iter().skip(lane).step_by(lanes);
        let n = in_lane().count();
        let taken: f64 = in_lane().map(|d| d.length_m).sum();
        let gap_m = (settings.length_m - taken) / n.max(1) as f64;
        let room = Range::Because(1.0, f64::MAX, "at least 1 m between vehicles");
        if n > 0 {
            check(&format!("lane[{lane}].gap_m"), gap_m, room)?;
        }
        let slowest = in_lane().map(|d| d.equilibrium_speed_mps(gap_m));
        let speed_mps = slowest.fold(f64::INFINITY, f64::min);
        // Lanes start at shifted places, so that nobody has a neighbour exactly beside it.
        let mut rear_m = gap_m * lane as f64 / lanes as f64;
        for driver in in_lane() {
            placed.push(Placed {
                lane: lane as u8,
                front_m: (rear_m + driver.length_m) % settings.length_m,
                speed_mps,
                driver: *driver,
            });
            rear_m += driver.length_m + gap_m;
        }
    }
    Ok(placed)
}

/// Least time between two departures of one lane, in s.
const LEAST_HEADWAY_S: f64 = 1.5;

/// Departures of `duration_s` at `per_hour_and_lane` vehicles, drivers of `mix`, in order of time.
///
/// The time between two of a lane is 1.5 s and an exponential rest (chosen; at most 2,400 an hour).
///
/// # Errors
/// [`SimulatorError::Setting`] if a number is out of range.
pub fn departures(
    settings: &FlowSettings,
    per_hour_and_lane: f64,
    duration_s: f64,
    mix: &TrafficMix,
    seed: u64,
) -> Result<Vec<Departure>, SimulatorError> {
    settings.check()?;
    check_section("mix", mix)?;
    let rate = Range::Because(1.0, 2350.0, "1 to 2350 vehicles per hour and lane");
    check("inflow.per_hour_and_lane", per_hour_and_lane, rate)?;
    check("inflow.duration_s", duration_s, 0.0..=1e6)?;
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let rest_s = 3600.0 / per_hour_and_lane - LEAST_HEADWAY_S;
    let mut departures = Vec::new();
    for lane in 0..settings.lanes {
        let mut time_s = 0.0;
        loop {
            let uniform: f64 = rng.random();
            time_s += LEAST_HEADWAY_S - rest_s * libm::log(1.0 - uniform);
            if time_s > duration_s {
                break;
            }
            let driver = mix.draw(&mut rng);
            departures.push(Departure { time_s, lane, driver });
        }
    }
    departures.sort_by(|a, b| a.time_s.total_cmp(&b.time_s).then(a.lane.cmp(&b.lane)));
    Ok(departures)
}
