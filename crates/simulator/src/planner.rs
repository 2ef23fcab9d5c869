//! What decides how the automated car drives.

use maveric_domain::{LaneActivity, Reference, Road, Scene, Setpoints, Situation};

/// How often a planner is asked, and how often a drive is recorded, in Hz.
pub const PLANNING_RATE_HZ: f64 = 20.0;

/// Time between two calls of [`Planner::plan`], in s.
pub const PLANNING_STEP_S: f64 = 1.0 / PLANNING_RATE_HZ;

/// What a planner sees: everybody around, and what its own car is doing.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// Everything visible now.
    pub scene: &'a Scene,
    /// Number of lanes, their width and the posted speed.
    pub road: &'a Road,
    /// The reference vehicle's signals.
    pub reference: Reference,
    /// The lane that the car keeps, or that the change under way goes to.
    pub lane: u8,
    /// What the car is doing about its lane.
    pub activity: LaneActivity,
}

impl View<'_> {
    /// The paper's state information.
    pub fn situation(&self) -> Situation {
        Situation {
            time_s: self.scene.time_s,
            ego_speed_mps: self.scene.ego.speed_mps,
            reference: self.reference,
        }
    }
}

/// Sees what is around and asks for a speed, a gap and a lane.
///
/// Called at [`PLANNING_RATE_HZ`], in order of time, from the first row of the drive. One planner
/// serves one drive: what it remembers, such as a window of the last seconds, is its own.
///
/// # Source
/// Paper, "Low Level Controllers": the network sets parameters for controllers, never throttle or steering.
///
/// # Example
/// ```
/// # use maveric_simulator::{Driver, Planner, Scenario, View, rollout};
/// # use maveric_domain::{LaneWish, Seconds, Setpoints};
/// struct Steady(f64);
///
/// impl Planner for Steady {
///     fn plan(&mut self, view: &View<'_>) -> Setpoints {
///         Setpoints {
///             speed_mps: self.0,
///             following_distance_m: 1.2 * view.scene.ego.speed_mps,
///             wish: LaneWish::Stay,
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
    fn plan(&mut self, view: &View<'_>) -> Setpoints;
}

impl<F: FnMut(&View<'_>) -> Setpoints> Planner for F {
    fn plan(&mut self, view: &View<'_>) -> Setpoints {
        self(view)
    }
}
