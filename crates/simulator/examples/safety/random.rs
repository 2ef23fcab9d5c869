//! Random feasible scenarios of every kind, and planners of every style, some of them senseless.

use maveric_domain::{
    LaneActivity, LaneWish, MetresPerSecond, Setpoints, VehicleId, When, stream_seed,
};
use maveric_simulator::{
    Integrator, PLANNING_RATE_HZ, Scenario, ScenarioSettings, ScriptStep, Segment, SimulatorError,
    VehicleModel, VehiclePlacement, View, safe_distance,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// The kinds of scenario.
pub(crate) const KINDS: [&str; 7] =
    ["paper", "curved", "many lanes", "cut-in", "hard-braking lead", "dense", "stop-and-go"];

const DENSE: &str = maveric_data::SCENARIOS_DENSE;
const STOP_AND_GO: &str = maveric_data::SCENARIOS_STOP_AND_GO;

fn between(rng: &mut Pcg64Mcg, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.random::<f64>()
}

fn chance(rng: &mut Pcg64Mcg, share: f64) -> bool {
    rng.random::<f64>() < share
}

fn read(text: &str) -> ScenarioSettings {
    let scenario: Scenario = toml::from_str(text).expect("a scenario of the study data");
    scenario.settings().clone()
}

/// How often a draw that is not a scenario, such as one too dense for its speed, is drawn again.
const DRAWS: usize = 50;

/// The `number`th scenario of `kind`.
///
/// # Errors
/// [`SimulatorError`] if no draw is a scenario; draws start with every vehicle beyond the safe distance.
pub(crate) fn scenario(kind: &str, number: u64) -> Result<Scenario, SimulatorError> {
    let seed = stream_seed(11, &["safety", kind, &number.to_string()]);
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut drawn = draw(kind, &mut rng);
    for _ in 1..DRAWS {
        if drawn.is_ok() {
            break;
        }
        drawn = draw(kind, &mut rng);
    }
    drawn
}

fn draw(kind: &str, rng: &mut Pcg64Mcg) -> Result<Scenario, SimulatorError> {
    let mut s = match kind {
        "dense" => read(DENSE),
        "stop-and-go" => read(STOP_AND_GO),
        _ => Scenario::paper().settings().clone(),
    };
    s.duration_s = between(rng, 120.0, 240.0);
    s.vehicle.integrator = Integrator::Rk4;
    if chance(rng, 0.3) {
        s.vehicle.model = VehicleModel::Dynamic;
    }
    match kind {
        "paper" => {
            s.start.speed_mph = between(rng, 30.0, 80.0);
            s.off_lane.interval_s = [10.0, 40.0];
        }
        "curved" => s.road.segments = bends(rng),
        "many lanes" => many_lanes(rng, &mut s),
        "cut-in" => cut_in(rng, &mut s),
        "hard-braking lead" => hard_braking(rng, &mut s),
        _ => {
            if let Some(background) = &mut s.background {
                background.vehicles_per_km_and_lane = between(rng, 8.0, 40.0);
                if chance(rng, 0.5) {
                    s.start.speed_mph = between(rng, 20.0, 45.0);
                }
            }
        }
    }
    if chance(rng, 0.2) && s.background.is_none() {
        s.road.segments = bends(rng);
    }
    Scenario::try_from(s)
}

fn bends(rng: &mut Pcg64Mcg) -> Vec<Segment> {
    let mut segments = vec![Segment::Straight { length_m: between(rng, 100.0, 600.0) }];
    for _ in 0..3 {
        let sign = if chance(rng, 0.5) { 1.0 } else { -1.0 };
        let radius_m = sign * between(rng, 180.0, 1500.0);
        segments.push(Segment::Clothoid {
            length_m: between(rng, 60.0, 250.0),
            to_radius_m: Some(radius_m),
        });
        segments.push(Segment::Arc { length_m: between(rng, 50.0, 600.0), radius_m });
    }
    segments.push(Segment::Clothoid { length_m: 120.0, to_radius_m: None });
    segments
}

fn nobody_else(s: &mut ScenarioSettings) {
    s.leads.factors_of_target.clear();
    s.leads.factors_of_posted.clear();
    s.off_lane.interval_s = [1e5, 1e5];
}

/// Room that ego needs behind something at `speed_mps`, in m from centre to centre.
fn room_m(s: &ScenarioSettings, speed_mps: f64) -> f64 {
    let ego = MetresPerSecond::from_mph(s.start.speed_mph);
    let safe = safe_distance(&s.controllers, ego, MetresPerSecond(speed_mps));
    safe.0 + s.vehicle.length_m + 2.0
}

fn many_lanes(rng: &mut Pcg64Mcg, s: &mut ScenarioSettings) {
    s.road.lanes = if chance(rng, 0.5) { 3 } else { 4 };
    s.start.lane = 1;
    for lane in 0..s.road.lanes {
        let mut ahead_m = 160.0 + 40.0 * f64::from(lane);
        for _ in 0..3 {
            let speed_mps = between(rng, 14.0, 27.0);
            let mut vehicle = VehiclePlacement::steady(ahead_m, lane, speed_mps);
            if chance(rng, 0.5) {
                let left = lane + 1 < s.road.lanes && (lane == 0 || chance(rng, 0.5));
                vehicle.script = vec![ScriptStep {
                    at_gap_m: Some(between(rng, 5.0, 80.0)),
                    lane: Some(if left { lane + 1 } else { lane - 1 }),
                    duration_s: Some(between(rng, 2.5, 6.0)),
                    ..ScriptStep::default()
                }];
            }
            s.vehicles.push(vehicle);
            ahead_m += between(rng, 60.0, 500.0);
        }
    }
}

fn cut_in(rng: &mut Pcg64Mcg, s: &mut ScenarioSettings) {
    nobody_else(s);
    s.start.speed_mph = between(rng, 45.0, 75.0);
    let mut behind_m = -60.0;
    for _ in 0..3 {
        let (at_gap_m, brakes) = (between(rng, -2.0, 45.0), chance(rng, 0.5));
        let mut vehicle = VehiclePlacement::steady(behind_m, 1, between(rng, 26.0, 38.0));
        vehicle.script = vec![ScriptStep {
            at_gap_m: Some(at_gap_m),
            lane: Some(0),
            duration_s: Some(between(rng, 1.8, 5.0)),
            ..ScriptStep::default()
        }];
        if brakes {
            vehicle.script.push(ScriptStep {
                at_s: Some(0.0),
                speed_mps: Some(between(rng, 0.0, 25.0)),
                acceleration_mps2: Some(between(rng, 1.0, 8.0)),
                ..ScriptStep::default()
            });
        }
        s.vehicles.push(vehicle);
        behind_m -= between(rng, 40.0, 500.0);
    }
    let slow = between(rng, 10.0, 24.0);
    let mut ahead = VehiclePlacement::steady(room_m(s, slow) + 200.0, 1, slow);
    ahead.script = vec![ScriptStep {
        at_gap_m: Some(between(rng, 5.0, 60.0)),
        lane: Some(0),
        duration_s: Some(between(rng, 1.8, 5.0)),
        ..ScriptStep::default()
    }];
    s.vehicles.push(ahead);
}

fn hard_braking(rng: &mut Pcg64Mcg, s: &mut ScenarioSettings) {
    nobody_else(s);
    s.start.speed_mph = between(rng, 35.0, 75.0);
    // One in ten brakes harder than the rule assumes.
    let hardest = if chance(rng, 0.1) { 11.0 } else { 8.0 };
    let speed_mps = between(rng, 12.0, 32.0);
    let ahead_m = room_m(s, speed_mps) + between(rng, 0.0, 60.0);
    let mut script = Vec::new();
    let mut at_s = between(rng, 2.0, 20.0);
    for _ in 0..4 {
        script.push(ScriptStep {
            at_s: Some(at_s),
            speed_mps: Some(if chance(rng, 0.3) { 0.0 } else { between(rng, 0.0, 15.0) }),
            acceleration_mps2: Some(hardest),
            ..ScriptStep::default()
        });
        at_s += between(rng, 3.0, 12.0);
        script.push(ScriptStep {
            at_s: Some(at_s),
            speed_mps: Some(between(rng, 15.0, 33.0)),
            acceleration_mps2: Some(between(rng, 1.0, 3.0)),
            ..ScriptStep::default()
        });
        at_s += between(rng, 8.0, 35.0);
    }
    let mut lead = VehiclePlacement::steady(ahead_m, 0, speed_mps);
    lead.script.clone_from(&script);
    s.vehicles.push(lead);
    if chance(rng, 0.5) {
        let mut beside = VehiclePlacement::steady(ahead_m - 4.0, 1, speed_mps);
        beside.script = script;
        s.vehicles.push(beside);
    }
}

/// Chances of a lane change a second that add up to a wish.
#[derive(Default)]
struct Urge {
    about: Option<VehicleId>,
    hazard: f64,
}

impl Urge {
    fn wish(&mut self, view: &View<'_>, probability: f64) -> LaneWish {
        let changing = matches!(view.activity, LaneActivity::Changing | LaneActivity::GoingBack);
        if changing || view.reference.vehicle != self.about {
            self.about = view.reference.vehicle;
            self.hazard = 0.0;
        }
        if !changing && self.about.is_some() {
            self.hazard -= (-probability.min(1.0 - 1e-9)).ln_1p() / PLANNING_RATE_HZ;
        }
        // Half a wish is said, too: a car that means to pass drives otherwise.
        let when = match self.hazard {
            0.4.. => When::Now,
            0.1.. => When::NotYet,
            _ => return LaneWish::Stay,
        };
        if view.lane == 0 { LaneWish::MoveOut(when) } else { LaneWish::MoveBack(when) }
    }
}

/// A planner of some style: steady, passing, swinging or senseless.
pub(crate) fn planner(kind: &str, number: u64) -> impl FnMut(&View<'_>) -> Setpoints {
    let seed = stream_seed(13, &["planner", kind, &number.to_string()]);
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let style = (rng.random::<f64>() * 4.0) as u8;
    let speed_mps = between(&mut rng, 12.0, 45.0);
    let gap_s = between(&mut rng, -0.5, 2.5);
    let pass_s = between(&mut rng, 0.5, 3.0);
    let eager = between(&mut rng, 0.0, 1.0);
    let mut urge = Urge::default();
    move |view: &View<'_>| {
        let v = view.scene.ego.speed_mps;
        let reference = &view.reference;
        let time_gap = reference.dx_m / v.max(1.0);
        let own_lane = reference.dy_m.abs() < 1.83;
        let near = reference.vehicle.is_some()
            && (own_lane && time_gap < pass_s || !own_lane && time_gap < -0.5 * pass_s);
        match style {
            // Asks for the same at all times.
            0 => Setpoints {
                speed_mps,
                following_distance_m: gap_s * v,
                wish: urge.wish(view, eager * eager * eager),
            },
            // Passes what is near.
            1 => Setpoints {
                speed_mps,
                following_distance_m: gap_s * v,
                wish: urge.wish(view, if near { 0.05 + 0.9 * eager } else { 0.0 }),
            },
            // Swings between two wishes.
            2 => {
                let high = ((view.scene.time_s / 7.0) as u64).is_multiple_of(2);
                Setpoints {
                    speed_mps: if high { 45.0 } else { 5.0 },
                    following_distance_m: if high { 0.0 } else { 90.0 },
                    wish: urge.wish(view, if near { eager } else { 0.0 }),
                }
            }
            // Asks for anything, another thing every time.
            _ => Setpoints {
                speed_mps: between(&mut rng, -50.0, 200.0),
                following_distance_m: between(&mut rng, -50.0, 300.0),
                wish: urge.wish(view, rng.random::<f64>()),
            },
        }
    }
}
