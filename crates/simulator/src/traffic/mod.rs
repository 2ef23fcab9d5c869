//! The other vehicles: leads, cars that block the passing lane, cars that use it.

pub(crate) mod acceleration;
mod blocked;
mod off_lane;
mod schedule;
mod script;

pub(crate) use blocked::Blockade;
use maveric_domain::{VehicleId, VehicleState};
pub(crate) use off_lane::OffLaneTraffic;
pub(crate) use schedule::{LeadPlan, LeadSchedule};
pub(crate) use script::Script;

/// A vehicle other than ego.
#[derive(Debug, Clone)]
pub(crate) struct Car {
    pub(crate) state: VehicleState,
    pub(crate) lane: u8,
    pub(crate) acceleration_mps2: f64,
    pub(crate) role: Role,
    /// Index of its track in the recording.
    pub(crate) track: usize,
}

/// What a vehicle is there for.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Role {
    /// One of the six leads.
    Lead(LeadPlan),
    /// One of the cars beside ego; its place relative to ego, in m.
    Blocker {
        /// Place ahead of ego's centre, in m.
        place_m: f64,
        /// Whether it is on its way off.
        leaving: bool,
    },
    /// A car that does what the scenario says.
    Scripted(Script),
    /// A car that keeps its speed.
    Steady {
        /// Its speed, in m/s.
        speed_mps: f64,
        /// Whether it leaves the world once far from ego.
        passing_by: bool,
    },
}

/// Ego as the traffic sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EgoView {
    pub(crate) x_m: f64,
    pub(crate) y_m: f64,
    pub(crate) speed_mps: f64,
    pub(crate) length_m: f64,
    /// Lane it is in.
    pub(crate) lane: u8,
    /// Lane it is changing to, or keeping: its turn signal shows.
    pub(crate) bound_for: u8,
    /// Whether it is keeping that lane.
    pub(crate) keeping: bool,
    /// v_e, its target speed, in m/s.
    pub(crate) target_mps: f64,
}

/// A vehicle about to enter the world.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Arrival {
    pub(crate) x_m: f64,
    pub(crate) lane: u8,
    pub(crate) speed_mps: f64,
    pub(crate) role: Role,
}

/// Bumper to bumper along x, in m: positive ahead of ego, negative behind, 0 while beside.
pub(crate) fn distance_m(ego: &EgoView, state: &VehicleState) -> f64 {
    let centres = state.x_m - ego.x_m;
    (centres.abs() - 0.5 * (ego.length_m + state.length_m)).max(0.0).copysign(centres)
}

/// The lead now in play, if it is still in the world.
pub(crate) fn find(cars: &[Car], id: Option<VehicleId>) -> Option<&Car> {
    cars.iter().find(|car| Some(car.state.id) == id)
}
