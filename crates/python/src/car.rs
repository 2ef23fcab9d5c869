//! Cars under way: our planner elsewhere, anybody's planner here.

use crate::{
    drive::Drive as DriveOfPython,
    error::{asked_to_stop, maveric_error, raised},
    model::Style,
};
use maveric_domain::{
    Drive, DriveMeta, DrivenBy, EgoState, LaneActivity, LaneWish, Road, Scene, Seconds, Setpoints,
    VehicleId, VehicleState, When, drive::ReferenceTracker,
};
use maveric_simulator::{Driver, Planner as Plans, Rollout, Scenario, Session, View};
use maveric_steering::ModelPlanner;
use pyo3::{prelude::*, types::PyDict};
use std::{cell::RefCell, rc::Rc};

/// Rows between two looks for Ctrl-C.
const LOOK_EVERY: usize = 200;

/// A vehicle, as Python gives it: id, x, y, speed, length.
type Around = (u32, f64, f64, f64, f64);

fn vehicle((id, x_m, y_m, speed_mps, length_m): Around) -> VehicleState {
    VehicleState { id: VehicleId(id), x_m, y_m, speed_mps, length_m }
}

/// A speed, a gap and a wish, as Python gives them.
fn setpoints(asked: (f64, f64, String)) -> PyResult<Setpoints> {
    let (speed_mps, following_distance_m, wish) = asked;
    let wish = match wish.as_str() {
        "stay" => LaneWish::Stay,
        "move_out" => LaneWish::MoveOut(When::Now),
        "move_back" => LaneWish::MoveBack(When::Now),
        other => {
            return Err(maveric_error(format!(
                "a planner wished `{other}`, expected `stay`, `move_out` or `move_back`"
            )));
        }
    };
    Ok(Setpoints { speed_mps, following_distance_m, wish })
}

/// The wish in Python's words; one that is not due yet is to stay.
fn word(wish: LaneWish) -> &'static str {
    match wish {
        LaneWish::MoveOut(When::Now) => "move_out",
        LaneWish::MoveBack(When::Now) => "move_back",
        _ => "stay",
    }
}

fn scenario_of(text: Option<&str>, duration_s: Option<f64>) -> PyResult<Scenario> {
    let scenario = match text {
        None => Scenario::paper(),
        Some(text) => toml::from_str(text).map_err(raised)?,
    };
    match duration_s {
        Some(duration) => scenario.with_duration(Seconds(duration)).map_err(raised),
        None => Ok(scenario),
    }
}

/// Our planner as a callable in somebody else's loop: a scene in, set-points out.
#[pyclass(module = "maveric")]
pub struct Planner {
    inner: ModelPlanner,
    tracker: ReferenceTracker,
    road: Road,
}

#[pymethods]
impl Planner {
    #[new]
    #[pyo3(signature = (style, lanes = 2, lane_width_m = 3.66, posted_speed_mps = 24.5872))]
    fn new(style: &Style, lanes: u8, lane_width_m: f64, posted_speed_mps: f64) -> PyResult<Self> {
        let numbers = [f64::from(lanes), lane_width_m, posted_speed_mps];
        if !numbers.iter().all(|v| v.is_finite() && *v > 0.0) {
            return Err(maveric_error(
                "a road needs at least one lane, a lane width and a posted speed above 0",
            ));
        }
        let road = Road { lanes, lane_width_m, posted_speed_mps };
        let paper = Scenario::paper();
        let controllers = &paper.settings().controllers;
        Ok(Self {
            inner: ModelPlanner::new(&style.model, &style.embedding, controllers)
                .map_err(raised)?,
            tracker: ReferenceTracker::new(road),
            road,
        })
    }

    /// What is asked of the car now; called 20 times a second.
    #[pyo3(signature = (time_s, ego, vehicles, lane = None, changing = false))]
    fn __call__(
        &mut self,
        time_s: f64,
        ego: Around,
        vehicles: Vec<Around>,
        lane: Option<u8>,
        changing: bool,
    ) -> PyResult<(f64, f64, &'static str)> {
        let (_, x_m, y_m, speed_mps, length_m) = ego;
        let scene = Scene {
            time_s,
            ego: EgoState { x_m, y_m, speed_mps, length_m },
            vehicles: vehicles.into_iter().map(vehicle).collect(),
        };
        let numbers = [time_s, x_m, y_m, speed_mps, length_m];
        let around = scene.vehicles.iter();
        let around = around.flat_map(|v| [v.x_m, v.y_m, v.speed_mps, v.length_m]);
        if let Some(bad) = numbers.into_iter().chain(around).find(|v| !v.is_finite()) {
            return Err(maveric_error(format!("a scene holds {bad}, expected finite numbers")));
        }
        let view = View {
            scene: &scene,
            road: &self.road,
            reference: self.tracker.observe(&scene),
            lane: lane.unwrap_or_else(|| self.road.nearest_lane(y_m)),
            activity: if changing { LaneActivity::Changing } else { LaneActivity::Keeping },
        };
        let setpoints = self.inner.plan(&view);
        Ok((setpoints.speed_mps, setpoints.following_distance_m, word(setpoints.wish)))
    }
}

/// A Python callable at the wheel: what it raises ends the drive.
struct Callable<'py> {
    callable: Bound<'py, PyAny>,
    raised: Rc<RefCell<Option<PyErr>>>,
}

impl Callable<'_> {
    fn ask(&self, view: &View<'_>) -> PyResult<Setpoints> {
        let py = self.callable.py();
        let seen = PyDict::new(py);
        let scene = view.scene;
        let ego = &scene.ego;
        seen.set_item("time_s", scene.time_s)?;
        seen.set_item("ego", (0_u32, ego.x_m, ego.y_m, ego.speed_mps, ego.length_m))?;
        let around = scene.vehicles.iter();
        let around = around.map(|v| (v.id.0, v.x_m, v.y_m, v.speed_mps, v.length_m));
        seen.set_item("vehicles", around.collect::<Vec<_>>())?;
        seen.set_item("lane", view.lane)?;
        seen.set_item("lanes", view.road.lanes)?;
        seen.set_item("lane_width_m", view.road.lane_width_m)?;
        seen.set_item("changing", view.activity == LaneActivity::Changing)?;
        let led = view.reference.vehicle.map(|id| id.0);
        seen.set_item("lead_id", led)?;
        seen.set_item("lead_dx_m", view.reference.dx_m)?;
        seen.set_item("lead_dy_m", view.reference.dy_m)?;
        seen.set_item("lead_speed_mps", view.reference.speed_mps)?;
        setpoints(self.callable.call1((seen,))?.extract()?)
    }
}

impl Plans for Callable<'_> {
    fn plan(&mut self, view: &View<'_>) -> Setpoints {
        match self.ask(view) {
            Ok(setpoints) => return setpoints,
            Err(error) => drop(self.raised.replace(Some(error))),
        }
        // The session is left before the next row.
        Setpoints {
            speed_mps: view.scene.ego.speed_mps,
            following_distance_m: 0.0,
            wish: LaneWish::Stay,
        }
    }
}

/// What was driven and what was counted.
type Driven<'py> = (DriveOfPython, Bound<'py, PyDict>);

/// Drives a scenario of ours by a style, or by anybody's planner.
#[pyfunction]
pub fn simulate<'py>(
    py: Python<'py>,
    planner: Bound<'py, PyAny>,
    scenario: Option<&str>,
    duration_s: Option<f64>,
    seed: u64,
    name: &str,
) -> PyResult<Driven<'py>> {
    let scenario = scenario_of(scenario, duration_s)?;
    let rollout = if let Ok(style) = planner.downcast::<Style>() {
        let style = style.get();
        py.allow_threads(|| {
            by_style(style, &scenario, |scenario, driver| {
                let session = Session::new(scenario, driver, seed).map_err(raised)?;
                to_the_end(session, |_| Ok(true))
            })
        })?
    } else {
        by_callable(&planner, &scenario, |scenario, driver, failed| {
            let session = Session::new(scenario, driver, seed).map_err(raised)?;
            to_the_end(session, |_| failed())
        })?
    };
    finished(py, rollout, name)
}

/// Drives in a world that somebody else moves: `world` is given ego (x, y, speed, length) and gives everybody around, or None to end.
#[pyfunction]
pub fn drive_in<'py>(
    py: Python<'py>,
    world: Bound<'py, PyAny>,
    planner: Bound<'py, PyAny>,
    scenario: Option<&str>,
    duration_s: Option<f64>,
    name: &str,
) -> PyResult<Driven<'py>> {
    let scenario = scenario_of(scenario, duration_s)?;
    let around = |session: &mut Session<'_>| {
        let ego = session.ego();
        let answer = world.call1(((ego.x_m, ego.y_m, ego.speed_mps, ego.length_m),))?;
        if answer.is_none() {
            return Ok(false);
        }
        let vehicles: Vec<Around> = answer.extract()?;
        let vehicles: Vec<VehicleState> = vehicles.into_iter().map(vehicle).collect();
        session.meet(&vehicles).map_err(raised)?;
        Ok(true)
    };
    let rollout = if let Ok(style) = planner.downcast::<Style>() {
        by_style(style.get(), &scenario, |scenario, driver| {
            to_the_end(Session::among_others(scenario, driver).map_err(raised)?, around)
        })?
    } else {
        by_callable(&planner, &scenario, |scenario, driver, failed| {
            let session = Session::among_others(scenario, driver).map_err(raised)?;
            to_the_end(session, |session| Ok(failed()? && around(session)?))
        })?
    };
    finished(py, rollout, name)
}

/// Lets a style's planner drive.
fn by_style(
    style: &Style,
    scenario: &Scenario,
    drive: impl for<'d> FnOnce(&'d Scenario, Driver<'d>) -> PyResult<Rollout>,
) -> PyResult<Rollout> {
    let settings = &scenario.settings().controllers;
    let mut planner =
        ModelPlanner::new(&style.model, &style.embedding, settings).map_err(raised)?;
    let controllers = planner.controllers();
    let driven = drive(scenario, Driver::Automated(&mut planner, &controllers));
    match planner.failure() {
        Some(error) => Err(raised(error)),
        None => driven,
    }
}

/// Lets a Python callable drive; what is given to `drive` raises what the callable has raised.
fn by_callable<'py>(
    callable: &Bound<'py, PyAny>,
    scenario: &Scenario,
    drive: impl for<'d> FnOnce(
        &'d Scenario,
        Driver<'d>,
        &dyn Fn() -> PyResult<bool>,
    ) -> PyResult<Rollout>,
) -> PyResult<Rollout> {
    let failure = Rc::new(RefCell::new(None));
    let mut planner = Callable { callable: callable.clone(), raised: failure.clone() };
    let failed = || failure.take().map_or(Ok(true), Err);
    let controllers = &scenario.settings().controllers;
    let driven = drive(scenario, Driver::Automated(&mut planner, controllers), &failed);
    failed()?;
    driven
}

/// Steps a session to its end, or until `before` a row says that it is over.
fn to_the_end(
    mut session: Session<'_>,
    before: impl Fn(&mut Session<'_>) -> PyResult<bool>,
) -> PyResult<Rollout> {
    for row in 1_usize.. {
        if !before(&mut session)? || !session.step() {
            break;
        }
        if row.is_multiple_of(LOOK_EVERY) {
            asked_to_stop()?;
        }
    }
    let rollout = session.finish().map_err(raised)?;
    rollout.completed().map_err(raised)
}

/// The drive, and what was counted in it.
fn finished<'py>(py: Python<'py>, rollout: Rollout, name: &str) -> PyResult<Driven<'py>> {
    let meta = DriveMeta::named(name, name, "car", DrivenBy::Automated).map_err(raised)?;
    let signals = Drive::from_recording(meta, &rollout.recording).map_err(raised)?;
    let (report, counts) = (rollout.report, PyDict::new(py));
    for (key, count) in [
        ("collisions", report.collisions),
        ("rule_violations", report.rule_violations),
        ("interventions", report.interventions),
        ("held_changes", report.held_changes),
        ("given_up_changes", report.given_up_changes),
        ("started_changes", report.started_changes),
    ] {
        counts.set_item(key, count)?;
    }
    counts.set_item("inside_safe_distance_s", report.inside_safe_distance_s)?;
    counts.set_item("least_safe_distance_share", report.least_safe_distance_share)?;
    let drive = DriveOfPython { signals, warnings: Vec::new(), source: "Simulated".to_owned() };
    Ok((drive, counts))
}
