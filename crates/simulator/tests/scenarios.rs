//! Every scenario of the study data loads and can be driven; bad ones say what is wrong and where.

#[path = "support/passing.rs"]
mod passing;

use maveric_domain::LatentTraits;
use maveric_simulator::{
    Collision, CollisionCause, Driver, DriverParams, Scenario, SimulatorError, rollout,
};
use passing::passing;

const PAPER: &str = maveric_data::SCENARIOS_PAPER;
const ALL: [(&str, &str); 9] = [
    ("paper", PAPER),
    ("seat", maveric_data::SCENARIOS_SEAT),
    ("curved", maveric_data::SCENARIOS_CURVED),
    ("four_lane", maveric_data::SCENARIOS_FOUR_LANE),
    ("cut_in", maveric_data::SCENARIOS_CUT_IN),
    ("hard_braking_lead", maveric_data::SCENARIOS_HARD_BRAKING_LEAD),
    ("dense", maveric_data::SCENARIOS_DENSE),
    ("motorway_120", maveric_data::SCENARIOS_MOTORWAY_120),
    ("stop_and_go", maveric_data::SCENARIOS_STOP_AND_GO),
];

#[test]
fn every_scenario_is_driven_by_a_person_and_by_a_planner() -> Result<(), SimulatorError> {
    for (name, text) in ALL {
        let scenario: Scenario = toml::from_str(text).unwrap();
        let person = DriverParams::draw(&LatentTraits::default(), 3, 3);
        let by_person = rollout(&scenario, Driver::Human(&person), 5)?;
        let controllers = &scenario.settings().controllers;
        let mut planner = passing(28.0);
        let by_car = rollout(&scenario, Driver::Automated(&mut planner, controllers), 5)?;
        let rows = (scenario.settings().duration_s * 20.0).round() as usize;
        for driven in [&by_person, &by_car] {
            assert_eq!(driven.recording.rows(), rows, "{name}");
            assert!(driven.stopped.is_none(), "{name}");
            assert!(driven.recording.others().len() > 1, "{name}");
            let last = driven.recording.ego().x_m.last().unwrap();
            assert!(*last > 1000.0, "{name}: {last}");
        }
        let own = |c: &Collision| c.cause == CollisionCause::AssumptionsHeld;
        assert!(!by_car.collisions.iter().any(own), "{name}: {:?}", by_car.collisions);
        assert_eq!(
            by_car.report.interventions as usize,
            by_car
                .interventions
                .iter()
                .filter(|i| matches!(i.kind, maveric_simulator::InterventionKind::Braked { .. }))
                .count()
        );
    }
    Ok(())
}

#[test]
fn the_follower_is_chosen_by_its_name_and_hits_nobody() -> Result<(), SimulatorError> {
    let mut drives = Vec::new();
    for rule in ["asked_gap", "idm", "paper"] {
        let text = PAPER.replace("\"asked_gap\"", &format!("\"{rule}\""));
        let scenario: Scenario = toml::from_str(&text).unwrap();
        let mut planner = passing(28.0);
        let controllers = &scenario.settings().controllers;
        let drive = rollout(&scenario, Driver::Automated(&mut planner, controllers), 5)?;
        assert!(drive.collisions.is_empty(), "{rule}");
        drives.push(drive.recording.ego().x_m.clone());
    }
    assert!(drives[0] != drives[1] && drives[1] != drives[2]);
    let unknown = PAPER.replace("\"asked_gap\"", "\"idn\"");
    let refusal = toml::from_str::<Scenario>(&unknown).unwrap_err().to_string();
    assert!(refusal.contains("`asked_gap`, `idm`, `paper`"), "{refusal}");
    Ok(())
}

#[test]
fn a_file_written_from_a_scenario_reads_back_as_it() {
    for (name, text) in ALL {
        let scenario: Scenario = toml::from_str(text).unwrap();
        let written = toml::to_string(&scenario).unwrap();
        let read: Scenario = toml::from_str(&written).unwrap();
        assert_eq!(read, scenario, "{name}");
    }
}

#[test]
fn bad_scenarios_are_refused_by_the_path_of_the_key() {
    let vehicles = |list: &str| PAPER.replacen("vehicles = []", &format!("vehicles = {list}"), 1);
    let bends =
        |list: &str| PAPER.replacen("lanes = 2", &format!("lanes = 2\nsegments = {list}"), 1);
    let key = |from: &str, to: &str| {
        assert!(PAPER.contains(from), "{from}");
        PAPER.replacen(from, to, 1)
    };
    let cases = [
        (vehicles("[{ ahead_m = 3.0, lane = 0, speed_mps = 20.0 }]"), "`vehicles[0].ahead_m` is 3"),
        (
            vehicles(
                "[{ ahead_m = 60.0, lane = 1, speed_mps = 20.0 }, { ahead_m = 63.0, lane = 1, speed_mps = 20.0 }]",
            ),
            "`vehicles[1].ahead_m` is 63",
        ),
        (vehicles("[{ ahead_m = 60.0, lane = 2, speed_mps = 20.0 }]"), "`vehicles[0].lane` is 2"),
        (
            vehicles("[{ ahead_m = inf, lane = 0, speed_mps = 20.0 }]"),
            "`vehicles[0].ahead_m` is inf",
        ),
        (
            vehicles(
                "[{ ahead_m = 60.0, lane = 0, speed_mps = 20.0, script = [{ speed_mps = 1.0 }] }]",
            ),
            "`vehicles[0].script[0].at_s` is 0, expected one of at_s and at_gap_m",
        ),
        (
            vehicles(
                "[{ ahead_m = 60.0, lane = 0, speed_mps = 20.0, script = [{ at_s = 1.0, lane = 1 }] }]",
            ),
            "`vehicles[0].script[0].duration_s` is 0",
        ),
        (vehicles("[{ ahead_m = 60.0, lane = 0, speed = 20.0 }]"), "unknown field `speed`"),
        (
            bends("[{ kind = \"arc\", length_m = 10.0, radius_m = 20.0 }]"),
            "`road.segments[0].radius_m` is 20",
        ),
        (bends("[{ kind = \"straight\", length_m = 0.0 }]"), "`road.segments[0].length_m` is 0"),
        (bends("[{ kind = \"spiral\", length_m = 10.0 }]"), "unknown variant `spiral`"),
        (key("step_s = 0.01", "step_s = 0.0"), "`vehicle.step_s` is 0"),
        (key("step_s = 0.01", "step_s = 0.03"), "a whole fraction of 0.05 s"),
        (key("lanes = 2", "lanes = 9"), "`road.lanes` is 9"),
        (
            key("appears_ahead_m = 200.0", "appears_ahead_m = -200.0"),
            "`leads.appears_ahead_m` is -200",
        ),
        (key("friction = 0.9", "friction = nan"), "`vehicle.dynamics.friction` is NaN"),
        (key("front_axle_m = 1.25", "front_axle_m = 1.8"), "where the car would oversteer"),
        (key("margin_m = 2.0", "margin_m = -2.0"), "`controllers.margin_m` is -2"),
    ];
    for (text, expected) in cases {
        let error = toml::from_str::<Scenario>(&text).unwrap_err().to_string();
        assert!(error.contains(expected), "{expected}:\n{error}");
    }
}
