//! How the controllers answer a step: what a control engineer would plot.

use crate::{
    control::{
        action::Manoeuvre,
        path::{PathShape, Steering},
    },
    error::SimulatorError,
    outcome::Rollout,
    planner::{PLANNING_RATE_HZ, Planner, View},
    rollout::rollout,
    scenario::{Scenario, ScenarioSettings, VehiclePlacement, setting::check},
    session::Driver,
    vehicle::{Command, build},
};
use maveric_domain::{LaneWish, MetresPerSecond, Setpoints};
use serde::Serialize;

/// A controlled quantity after its target has stepped.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StepResponse {
    /// What steps: `velocity`, `following_gap`, `following_gap_paper` or `lane_change`.
    pub name: &'static str,
    /// Unit of `value` and `target`.
    pub unit: &'static str,
    /// Time since the step, in s; shape `(n,)`, from 2 s before it.
    pub time_s: Vec<f64>,
    /// The quantity; shape `(n,)`.
    pub value: Vec<f64>,
    /// What was asked for; shape `(n,)`.
    pub target: Vec<f64>,
    /// How far the quantity went past where it ends, as a share of how far it moved, in percent.
    pub overshoot_percent: f64,
    /// Time after which it stays within a twentieth of how far it moved of where it ends, in s; none if it does not settle.
    pub settling_time_s: Option<f64>,
    /// Mean of target minus value over the last 2 s, in `unit`.
    pub steady_state_error: f64,
}

/// How well a lane change is tracked at one speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LaneChangeTracking {
    /// Speed, in m/s.
    pub speed_mps: f64,
    /// Largest distance of the front axle from the path, in m.
    pub largest_lateral_error_m: f64,
    /// Largest lateral acceleration, in m/s².
    pub largest_lateral_acceleration_mps2: f64,
    /// Largest change of lateral acceleration over a tenth of a second, in m/s³.
    pub largest_lateral_jerk_mps3: f64,
    /// Time from the start until the car stays within 0.1 m of the new lane's centre, in s.
    pub duration_s: f64,
}

/// Time shown before the step, in s.
const BEFORE_S: f64 = 2.0;
/// When the step is asked for, in s: everything has settled by then.
const STEP_AT_S: f64 = 60.0;

/// Lets velocity, following and lane-change control of `scenario` answer a step each.
///
/// Velocity steps from 25 to 30 m/s on an empty road. The gap asked for steps from 40 to 30 m behind a vehicle at 25 m/s:
/// once by the scenario's own rule and once by the paper's, where the following controller takes part below λ only and the gap settles
/// near λ rather than at the target. The lane change goes one lane to the left at
/// 30 m/s over the longest duration. The road is straight, whatever the scenario's, and nobody else is on it.
///
/// # Errors
/// [`SimulatorError::Setting`] if the scenario cannot be driven so, such as with a speed range that excludes 25 to 33 m/s.
///
/// # Source
/// Overshoot, settling time (5% band) and steady-state error as in Åström and Murray, Feedback Systems, section 6.3.
pub fn step_responses(scenario: &Scenario) -> Result<Vec<StepResponse>, SimulatorError> {
    let mut paper = empty(scenario);
    paper.controllers = paper.controllers.literal();
    Ok(vec![
        velocity(empty(scenario))?,
        stepping_gap("following_gap", empty(scenario), (40.0, 30.0))?,
        stepping_gap("following_gap_paper", paper, (40.0, 30.0))?,
        lane_change(empty(scenario))?,
    ])
}

/// The same car and controllers on a straight, empty road.
fn empty(scenario: &Scenario) -> ScenarioSettings {
    let mut settings = scenario.settings().clone();
    settings.road.segments.clear();
    settings.leads.factors_of_target.clear();
    settings.leads.factors_of_posted.clear();
    settings.off_lane.interval_s = [1e6, 1e6];
    settings.vehicles.clear();
    settings.start.lane = 0;
    settings.start.speed_mph = MetresPerSecond(25.0).mph();
    settings.duration_s = STEP_AT_S + 60.0;
    settings
}

fn driven(
    settings: ScenarioSettings,
    mut planner: impl Planner,
) -> Result<Rollout, SimulatorError> {
    let scenario = Scenario::try_from(settings)?;
    let controllers = &scenario.settings().controllers;
    rollout(&scenario, Driver::Automated(&mut planner, controllers), 1)?.completed()
}

/// A planner that asks for `before` until the step and for `after` from then on.
fn stepping(before: Setpoints, after: Setpoints) -> impl Planner {
    move |view: &View<'_>| {
        if view.scene.time_s < STEP_AT_S {
            before
        } else {
            after
        }
    }
}

fn asks(speed_mps: f64, following_distance_m: f64) -> Setpoints {
    Setpoints {
        speed_mps,
        following_distance_m,
        wish: LaneWish::Stay,
    }
}

fn velocity(settings: ScenarioSettings) -> Result<StepResponse, SimulatorError> {
    let planner = stepping(asks(25.0, 40.0), asks(30.0, 40.0));
    let driven = driven(settings, planner)?;
    let value = driven.recording.ego().speed_mps.clone();
    Ok(response("velocity", "m/s", &value, STEP_AT_S, [25.0, 30.0]))
}

fn stepping_gap(
    name: &'static str,
    mut settings: ScenarioSettings,
    (before_m, after_m): (f64, f64),
) -> Result<StepResponse, SimulatorError> {
    settings.vehicles = vec![VehiclePlacement::steady(
        before_m + settings.vehicle.length_m,
        0,
        25.0,
    )];
    let planner = stepping(asks(33.0, before_m), asks(33.0, after_m));
    let driven = driven(settings, planner)?;
    let (ego, lead) = (driven.recording.ego(), &driven.recording.others()[0]);
    let length_m = 0.5 * (ego.length_m + lead.length_m);
    let value: Vec<f64> = ego
        .x_m
        .iter()
        .zip(&lead.x_m)
        .map(|(ego, lead)| lead - ego - length_m)
        .collect();
    Ok(response(name, "m", &value, STEP_AT_S, [before_m, after_m]))
}

fn lane_change(mut settings: ScenarioSettings) -> Result<StepResponse, SimulatorError> {
    settings.start.speed_mph = MetresPerSecond(30.0).mph();
    settings.duration_s = 20.0;
    let (width_m, duration_s) = (
        settings.road.lane_width_m,
        settings.controllers.change_longest_s,
    );
    let start_s = 2.0;
    let mut change = Change::new(&Scenario::try_from(settings)?, 30.0);
    let value: Vec<f64> = (0..(20.0 * PLANNING_RATE_HZ) as usize)
        .map(|row| {
            if row as f64 >= start_s * PLANNING_RATE_HZ {
                change.begin_once(duration_s);
            }
            change.row()
        })
        .collect();
    Ok(response(
        "lane_change",
        "m",
        &value,
        start_s,
        [0.0, width_m],
    ))
}

/// What is said about `value`, a sample each planning step, whose target stepped `at_s`.
fn response(
    name: &'static str,
    unit: &'static str,
    value: &[f64],
    at_s: f64,
    [before, after]: [f64; 2],
) -> StepResponse {
    let first = ((at_s - BEFORE_S) * PLANNING_RATE_HZ).round() as usize;
    let step_row = (BEFORE_S * PLANNING_RATE_HZ).round() as usize;
    let value = value[first..].to_vec();
    let n = value.len();
    let time_s: Vec<f64> = (0..n)
        .map(|row| row as f64 / PLANNING_RATE_HZ - BEFORE_S)
        .collect();
    let target: Vec<f64> = (0..n)
        .map(|row| if row < step_row { before } else { after })
        .collect();
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    let tail = &value[n.saturating_sub((2.0 * PLANNING_RATE_HZ) as usize)..];
    let (start, end) = (mean(&value[..step_row]), mean(tail));
    // A quantity that did not move at all is measured by what was asked.
    let moved = if (end - start).abs() > 1e-9 {
        end - start
    } else {
        after - before
    };
    let past = value[step_row..]
        .iter()
        .map(|v| (v - end) / moved)
        .fold(0.0, f64::max);
    let outside = value
        .iter()
        .rposition(|v| (v - end).abs() > 0.05 * moved.abs());
    // Still outside in the last two seconds: it swings.
    let settles = outside.is_none_or(|row| row + tail.len() < n);
    StepResponse {
        name,
        unit,
        overshoot_percent: 100.0 * past,
        settling_time_s: settles.then(|| outside.map_or(0.0, |row| time_s[row + 1].max(0.0))),
        steady_state_error: after - end,
        time_s,
        value,
        target,
    }
}

/// One car, one lane change, no traffic, at a held speed.
struct Change {
    car: Box<dyn crate::vehicle::Vehicle>,
    steering: Steering,
    line: crate::road::CentreLine,
    steps_per_row: usize,
    begun: bool,
}

impl Change {
    fn new(scenario: &Scenario, speed_mps: f64) -> Self {
        let s = scenario.settings();
        Self {
            car: build(&s.vehicle, 0.0, speed_mps),
            steering: Steering::new(
                s.road.lane_width_m,
                s.controllers.stanley_gain_per_s,
                0,
                PathShape::Bezier,
            ),
            line: crate::road::CentreLine::default(),
            steps_per_row: s.vehicle.steps_per_row(),
            begun: false,
        }
    }

    fn begin_once(&mut self, duration_s: f64) {
        if !self.begun {
            self.begun = true;
            let out = Manoeuvre::Change {
                lane: 1,
                duration_s,
            };
            self.steering.begin(out, self.car.pose());
        }
    }

    /// One integration step; the front axle's distance from the path before it, in m.
    fn step(&mut self) -> f64 {
        let axle = self.car.front_axle(&self.line);
        let error = axle.y_m - self.steering.path_at(axle.x_m).0;
        let command = Command {
            acceleration_mps2: 0.0,
            steering_rad: self.steering.angle_rad(self.car.as_ref(), &self.line),
        };
        self.car.step(command, &self.line);
        error
    }

    /// The lateral position now, in m, before one row's steps.
    fn row(&mut self) -> f64 {
        let y_m = self.car.pose().y_m;
        for _ in 0..self.steps_per_row {
            self.step();
        }
        y_m
    }
}

/// Drives one lane change to the left at each of `speeds`, with the scenario's car, gain and longest duration, and says how
/// well it was tracked; shape as `speeds`.
///
/// # Errors
/// [`SimulatorError::Setting`] for a speed outside 5 to 60 m/s.
pub fn lane_change_tracking(
    scenario: &Scenario,
    speeds: &[MetresPerSecond],
) -> Result<Vec<LaneChangeTracking>, SimulatorError> {
    speeds
        .iter()
        .map(|speed| {
            check("speed_mps", speed.0, 5.0..=60.0)?;
            Ok(tracking(scenario, speed.0))
        })
        .collect()
}

fn tracking(scenario: &Scenario, speed_mps: f64) -> LaneChangeTracking {
    let s = scenario.settings();
    let (step_s, width_m) = (s.vehicle.step_s, s.road.lane_width_m);
    let duration_s = s.controllers.change_longest_s;
    let mut change = Change::new(scenario, speed_mps);
    change.begin_once(duration_s);
    let steps = ((duration_s + 10.0) / step_s) as usize;
    let (mut error, mut y_m) = (0.0_f64, Vec::with_capacity(steps));
    for _ in 0..steps {
        y_m.push(change.car.pose().y_m);
        error = error.max(change.step().abs());
    }
    let second = |w: &[f64]| (w[2] - 2.0 * w[1] + w[0]) / (step_s * step_s);
    let acceleration: Vec<f64> = y_m.windows(3).map(second).collect();
    let tenth = ((0.1 / step_s).round() as usize).max(1);
    let jerk = acceleration
        .iter()
        .zip(&acceleration[tenth..])
        .map(|(a, b)| (b - a).abs() / (tenth as f64 * step_s));
    let last_outside = y_m.iter().rposition(|y| (y - width_m).abs() > 0.1);
    LaneChangeTracking {
        speed_mps,
        largest_lateral_error_m: error,
        largest_lateral_acceleration_mps2: acceleration.iter().fold(0.0, |m, a| m.max(a.abs())),
        largest_lateral_jerk_mps3: jerk.fold(0.0, f64::max),
        duration_s: last_outside.map_or(0.0, |row| (row + 1) as f64 * step_s),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Integrator, VehicleModel};

    #[test]
    fn every_response_settles_and_only_the_papers_gap_stays_off_its_target() {
        let responses = step_responses(&Scenario::paper()).unwrap();
        for (r, most) in responses.iter().zip([10.0, 10.0, 20.0, 5.0]) {
            assert!(r.settling_time_s.is_some(), "{}", r.name);
            assert!(
                r.overshoot_percent < most,
                "{} {}",
                r.name,
                r.overshoot_percent
            );
            assert!(r.value.iter().all(|v| v.is_finite()));
            let rows = r.time_s.len();
            assert!((r.value.len(), r.target.len()) == (rows, rows));
        }
        let error = |i: usize| responses[i].steady_state_error.abs();
        assert!(error(0) < 0.05 && error(3) < 0.01);
        // λ = 0.7 f̂ is where V and F hold each other: the paper's gap ends there, not at f̂.
        assert!(error(2) > 3.0, "{}", error(2));
    }

    #[test]
    fn the_gap_asked_for_is_the_gap_kept_within_ten_seconds_and_without_hunting() {
        for model in [VehicleModel::Kinematic, VehicleModel::Dynamic] {
            let mut settings = empty(&Scenario::paper());
            settings.vehicle.model = model;
            let [shorter, longer] = [(40.0, 30.0), (30.0, 40.0)]
                .map(|step| stepping_gap("gap", settings.clone(), step).unwrap());
            for r in [shorter, longer] {
                assert!(r.settling_time_s.unwrap() < 10.0, "{:?}", r.settling_time_s);
                assert!(r.overshoot_percent < 10.0, "{}", r.overshoot_percent);
                let asked = r.target[r.target.len() - 1];
                assert!(
                    r.steady_state_error.abs() < 0.02 * asked,
                    "{}",
                    r.steady_state_error
                );
                // From fifteen seconds on the gap stands still.
                let late = &r.value[((BEFORE_S + 15.0) * PLANNING_RATE_HZ) as usize..];
                let spread = late.iter().copied().fold(f64::MIN, f64::max)
                    - late.iter().copied().fold(f64::MAX, f64::min);
                assert!(spread < 0.1, "{spread}");
            }
        }
    }

    #[test]
    fn what_is_said_of_a_response_is_what_can_be_read_off_it() {
        // Twelve seconds at 20 rows a second, the step after four of them.
        let of = |value: &dyn Fn(usize) -> f64, ends: [f64; 2]| {
            let value: Vec<f64> = (0..240).map(value).collect();
            response("made up", "m", &value, 4.0, ends)
        };
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-9, "{found}");
        // From 4 past the target of 2 to 1.6 for a second, then 2.1 for good: 0.5 of 1.9 too far.
        let past = |row: usize| match row {
            0..80 => 4.0,
            80..100 => 1.6,
            _ => 2.1,
        };
        let found = of(&past, [4.0, 2.0]);
        near(found.overshoot_percent, 100.0 * 0.5 / 1.9);
        near(found.settling_time_s.unwrap(), 1.0);
        near(found.steady_state_error, -0.1);
        // Two seconds before the step are shown.
        assert_eq!(
            (found.time_s.len(), found.target[39], found.target[40]),
            (200, 4.0, 2.0)
        );
        near(found.time_s[0], -2.0);
        near(found.time_s[40], 0.0);
        // A lag of a second is within a twentieth after three.
        let lag = |row: usize| 1.0 - ((80.0 - row.max(80) as f64) / 20.0).exp();
        let found = of(&|row| lag(row), [0.0, 1.0]);
        assert!(found.overshoot_percent < 0.1 && found.steady_state_error.abs() < 0.01);
        near(found.settling_time_s.unwrap(), 3.0);
        let swings = |row: usize| if row > 80 && row % 10 < 5 { 1.2 } else { 1.0 };
        assert_eq!(of(&swings, [0.0, 1.0]).settling_time_s, None);
        // What does not move at all is off by what was asked.
        let found = of(&|_| 1.0, [1.0, 3.0]);
        assert_eq!(
            (found.settling_time_s, found.overshoot_percent),
            (Some(0.0), 0.0)
        );
        near(found.steady_state_error, 2.0);
    }

    #[test]
    fn the_change_of_lane_begins_where_it_is_said_to() {
        let responses = step_responses(&Scenario::paper()).unwrap();
        let change = responses.iter().find(|r| r.name == "lane_change").unwrap();
        let at = |seconds: f64| change.value[((BEFORE_S + seconds) * PLANNING_RATE_HZ) as usize];
        assert!(
            at(0.0).abs() < 1e-9 && at(0.5) > 0.01,
            "{} {}",
            at(0.0),
            at(0.5)
        );
        // Half of the lane after about half of the 4.8 s.
        assert!((at(2.4) - 1.83).abs() < 0.5, "{}", at(2.4));
    }

    #[test]
    fn a_dynamic_car_settles_too() {
        let mut settings = Scenario::paper().settings().clone();
        settings.vehicle.model = VehicleModel::Dynamic;
        let responses = step_responses(&Scenario::try_from(settings).unwrap()).unwrap();
        assert!(responses.iter().all(|r| r.settling_time_s.is_some()));
    }

    #[test]
    fn the_path_is_tracked_within_decimetres_at_every_speed() {
        for (model, within_m) in [
            (VehicleModel::Kinematic, 0.1),
            (VehicleModel::Dynamic, 0.25),
        ] {
            let mut settings = Scenario::paper().settings().clone();
            settings.vehicle.model = model;
            settings.vehicle.integrator = Integrator::Rk4;
            let scenario = Scenario::try_from(settings).unwrap();
            let speeds: Vec<_> = [15.0, 25.0, 35.0].map(MetresPerSecond).into();
            for t in lane_change_tracking(&scenario, &speeds).unwrap() {
                assert!(t.largest_lateral_error_m < within_m, "{model:?} {t:?}");
                assert!(t.largest_lateral_acceleration_mps2 < 2.0, "{model:?} {t:?}");
                assert!(t.largest_lateral_jerk_mps3 < 20.0, "{model:?} {t:?}");
                assert!((3.0..7.0).contains(&t.duration_s), "{model:?} {t:?}");
            }
        }
        let refused = lane_change_tracking(&Scenario::paper(), &[MetresPerSecond(f64::NAN)]);
        assert!(refused.unwrap_err().to_string().contains("speed_mps"));
    }
}
