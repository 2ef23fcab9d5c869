//! What decides how the automated car drives.

use maveric_domain::{Setpoints, Situation};

/// How often a planner is asked, and how often a drive is recorded, in Hz.
pub const PLANNING_RATE_HZ: f64 = 20.0;

/// Time between two calls of [`Planner::plan`], in s.
pub const PLANNING_STEP_S: f64 = 1.0 / PLANNING_RATE_HZ;

/// Sees the situation and asks for a speed, a gap and the moment of a lane change.
///
/// Called at [`PLANNING_RATE_HZ`], in order of time, from the first row of the drive. One planner
/// serves one drive: what it remembers, such as a window of the last seconds, is its own.
///
/// # Source
/// Paper, "Low Level Controllers": the network sets parameters for controllers, never throttle or steering.
///
/// # Example
/// ```
/// # use maveric_simulator::{Driver, Planner, Scenario, rollout};
/// # use maveric_domain::{Seconds, Setpoints, Situation};
/// struct Steady(f64);
///
/// impl Planner for Steady {
///     fn plan(&mut self, situation: &Situation) -> Setpoints {
///         Setpoints {
///             speed_mps: self.0,
///             following_distance_m: 1.2 * situation.ego_speed_mps,
///             change_probability: 0.0,
///         }
///     }
/// }
///
/// let scenario = Scenario::paper().with_duration(Seconds(60.0))?;
/// let mut planner = Steady(28.0);
/// let driver = Driver::Automated(&mut planner, &scenario.settings().controllers);
/// assert_eq!(rollout(&scenario, driver, 1)?.report.collisions, 0);
/// # Ok::<(), maveric_simulator::SimulatorError>(())
/// ```
pub trait Planner {
    /// What to ask of the controllers now.
    fn plan(&mut self, situation: &Situation) -> Setpoints;
}

impl<F: FnMut(&Situation) -> Setpoints> Planner for F {
    fn plan(&mut self, situation: &Situation) -> Setpoints {
        self(situation)
    }
}
