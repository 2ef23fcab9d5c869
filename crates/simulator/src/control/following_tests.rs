//! What is driven after another gap or speed is asked for.

use crate::{
    outcome::Rollout,
    planner::{PLANNING_RATE_HZ, View},
    rollout::rollout,
    scenario::{Scenario, ScenarioSettings, VehicleModel, VehiclePlacement},
    session::Driver,
};
use maveric_domain::{LaneWish, MetresPerSecond, Setpoints};

/// When something else is asked for, in s: everything has settled by then.
const STEP_AT_S: f64 = 60.0;

/// A straight road with nobody else on it, at 25 m/s.
fn empty() -> ScenarioSettings {
    let mut settings = Scenario::paper().settings().clone();
    settings.leads.factors_of_target.clear();
    settings.leads.factors_of_posted.clear();
    settings.off_lane.interval_s = [1e6, 1e6];
    settings.start.speed_mph = MetresPerSecond(25.0).mph();
    settings.duration_s = STEP_AT_S + 60.0;
    settings
}

/// Asks for one speed and gap until the step, and for another from then on.
fn driven(settings: ScenarioSettings, [before, after]: [(f64, f64); 2]) -> Rollout {
    let scenario = Scenario::try_from(settings).unwrap();
    let mut planner = |view: &View<'_>| {
        let stepped = view.scene.time_s >= STEP_AT_S;
        let (speed_mps, following_distance_m) = if stepped { after } else { before };
        Setpoints { speed_mps, following_distance_m, wish: LaneWish::Stay }
    };
    let driver = Driver::Automated(&mut planner, &scenario.settings().controllers);
    rollout(&scenario, driver, 1).unwrap().completed().unwrap()
}

/// The gap behind a car at 25 m/s where another one is asked for.
fn gap_m(mut settings: ScenarioSettings, before_m: f64, after_m: f64) -> Answer {
    let ahead_m = before_m + settings.vehicle.length_m;
    settings.vehicles = vec![VehiclePlacement::steady(ahead_m, 0, 25.0)];
    let driven = driven(settings, [(33.0, before_m), (33.0, after_m)]);
    let (ego, lead) = (driven.recording.ego(), &driven.recording.others()[0]);
    let length_m = 0.5 * (ego.length_m + lead.length_m);
    let both = ego.x_m.iter().zip(&lead.x_m);
    Answer::of(&both.map(|(ego, lead)| lead - ego - length_m).collect::<Vec<_>>())
}

/// How a value answers a step.
#[derive(Debug)]
struct Answer {
    /// From the step on.
    values: Vec<f64>,
    /// Where it ends: the mean of the last two seconds.
    end: f64,
    /// How far it goes past where it ends, as a share of how far it moves.
    overshoot: f64,
    /// When it is within a twentieth of how far it moves of where it ends, and stays there.
    settled_s: f64,
}

impl Answer {
    fn of(values: &[f64]) -> Self {
        let step = (STEP_AT_S * PLANNING_RATE_HZ).round() as usize;
        let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
        let (start, end) = (mean(&values[step - 40..step]), mean(&values[values.len() - 40..]));
        let values = values[step..].to_vec();
        let past = values.iter().map(|v| (v - end) / (end - start));
        let outside = values.iter().rposition(|v| (v - end).abs() > 0.05 * (end - start).abs());
        Self {
            overshoot: past.fold(0.0, f64::max),
            settled_s: outside.map_or(0.0, |row| (row + 1) as f64 / PLANNING_RATE_HZ),
            values,
            end,
        }
    }
}

#[test]
fn the_gap_asked_for_is_the_gap_kept_within_ten_seconds_and_without_hunting() {
    for model in [VehicleModel::Kinematic, VehicleModel::Dynamic] {
        let mut settings = empty();
        settings.vehicle.model = model;
        for (before_m, after_m) in [(40.0, 30.0), (30.0, 40.0)] {
            let gap = gap_m(settings.clone(), before_m, after_m);
            assert!(gap.settled_s < 10.0 && gap.overshoot < 0.1, "{gap:?}");
            assert!((gap.end / after_m - 1.0).abs() < 0.02, "{}", gap.end);
            // From fifteen seconds on it stands still.
            let late = &gap.values[(15.0 * PLANNING_RATE_HZ) as usize..];
            let spread = late.iter().copied().fold(f64::MIN, f64::max)
                - late.iter().copied().fold(f64::MAX, f64::min);
            assert!(spread < 0.1, "{spread}");
        }
    }
}

/// λ = 0.7 f̂ is where V and F hold each other: the paper's gap ends there, not at f̂.
#[test]
fn the_papers_rule_settles_too_and_stays_off_the_gap_that_is_asked_for() {
    let mut settings = empty();
    settings.controllers = settings.controllers.literal();
    let gap = gap_m(settings, 40.0, 30.0);
    assert!(gap.settled_s < 15.0 && gap.overshoot < 0.2, "{gap:?}");
    assert!((gap.end - 30.0).abs() > 3.0, "{}", gap.end);
}

#[test]
fn the_speed_asked_for_is_driven_within_ten_seconds() {
    for model in [VehicleModel::Kinematic, VehicleModel::Dynamic] {
        let mut settings = empty();
        settings.vehicle.model = model;
        let driven = driven(settings, [(25.0, 40.0), (30.0, 40.0)]);
        let speed = Answer::of(&driven.recording.ego().speed_mps);
        assert!(speed.settled_s < 10.0 && speed.overshoot < 0.1, "{speed:?}");
        assert!((speed.end - 30.0).abs() < 0.05, "{}", speed.end);
    }
}
