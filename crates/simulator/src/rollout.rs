//! One drive, from the first row to the last.

use crate::{
    error::SimulatorError,
    outcome::Rollout,
    scenario::Scenario,
    session::{Driver, Session},
};

/// Drives `scenario` once and records it.
///
/// The recording has duration · [`PLANNING_RATE_HZ`](crate::PLANNING_RATE_HZ) rows and one segment. The same scenario, driver and seed give the same
/// bytes; a planner that gives a set-point that is not a number ends the drive, see [`Rollout::stopped`]; traffic, perception, wander and encounters each have a stream of their own, derived from `seed`.
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
pub fn rollout<'a>(
    scenario: &'a Scenario,
    driver: Driver<'a>,
    seed: u64,
) -> Result<Rollout, SimulatorError> {
    let mut session = Session::new(scenario, driver, seed)?;
    while session.step() {}
    session.finish()
}

#[cfg(test)]
mod tests;
