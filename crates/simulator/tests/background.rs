//! Drives in background traffic: nobody collides, density holds, the same seed gives the same drive.

use maveric_domain::{LaneWish, LatentTraits, Seconds, Setpoints, When};
use maveric_simulator::{Driver, DriverParams, Rollout, Scenario, ScenarioSettings, View, rollout};

const DENSE: &str = maveric_data::SCENARIOS_DENSE;
const STOP_AND_GO: &str = maveric_data::SCENARIOS_STOP_AND_GO;

fn scenario(text: &str, duration_s: f64) -> Scenario {
    let read: Scenario = toml::from_str(text).expect("a scenario of ours");
    read.with_duration(Seconds(duration_s)).expect("a usual duration")
}

fn by_person(scenario: &Scenario, seed: u64) -> Rollout {
    let traits =
        LatentTraits { aggressiveness: seed as f64 % 3.0 - 1.0, ..LatentTraits::default() };
    let driver = DriverParams::draw(&traits, seed, seed);
    rollout(scenario, Driver::Human(&driver), seed).expect("a drive")
}

fn by_car(scenario: &Scenario, seed: u64) -> Rollout {
    let mut planner = |s: &View<'_>| {
        let gap_s = s.reference.dx_m / s.scene.ego.speed_mps.max(1.0);
        let near = s.reference.vehicle.is_some() && gap_s.abs() < 2.5;
        let wish = match (near, s.lane) {
            (true, 0) => LaneWish::MoveOut(When::Now),
            (true, _) => LaneWish::MoveBack(When::Now),
            _ => LaneWish::Stay,
        };
        Setpoints { speed_mps: 30.0, following_distance_m: 1.2 * s.scene.ego.speed_mps, wish }
    };
    let settings = &scenario.settings().controllers;
    rollout(scenario, Driver::Automated(&mut planner, settings), seed).expect("a drive")
}

/// Whether two of the others overlap in any row: 1.9 m wide, lengths of their own.
fn overlap(driven: &Rollout) -> Option<String> {
    for row in (0..driven.recording.rows()).step_by(4) {
        let all = driven.recording.scene(row)?.vehicles;
        for (i, a) in all.iter().enumerate() {
            for b in &all[..i] {
                let along = (a.x_m - b.x_m).abs() < 0.5 * (a.length_m + b.length_m);
                if along && (a.y_m - b.y_m).abs() < 1.9 {
                    return Some(format!("row {row}: {a:?} {b:?}"));
                }
            }
        }
    }
    None
}

#[test]
fn in_dense_traffic_nobody_collides_and_ego_takes_part() {
    let dense = scenario(DENSE, 600.0);
    for seed in 0..4 {
        for driven in [by_person(&dense, seed), by_car(&dense, seed)] {
            assert_eq!(overlap(&driven), None, "seed {seed}");
            assert_eq!(driven.report.collisions, 0, "seed {seed}");
            let ego = driven.recording.ego();
            assert!(*ego.x_m.last().unwrap() > 8000.0, "seed {seed}");
        }
    }
}

#[test]
fn the_density_seen_is_the_density_asked_for() {
    let dense = scenario(DENSE, 600.0);
    let driven = by_person(&dense, 2);
    let rows = driven.recording.rows();
    let ego = driven.recording.ego();
    let seen: usize = (0..rows)
        .map(|row| {
            let scene = driven.recording.scene(row).unwrap();
            let near = |v: &&maveric_domain::VehicleState| (v.x_m - ego.x_m[row]).abs() < 250.0;
            scene.vehicles.iter().filter(near).count() + 1
        })
        .sum();
    // Three lanes, 500 m.
    let per_km_and_lane = seen as f64 / rows as f64 / 1.5;
    assert!((per_km_and_lane - 18.0).abs() < 3.0, "{per_km_and_lane}");
}

#[test]
fn vehicles_come_and_go_out_of_sight() {
    let driven = by_person(&scenario(DENSE, 300.0), 1);
    let ego = driven.recording.ego();
    let rows = driven.recording.rows();
    let mut came = 0;
    for track in driven.recording.others() {
        let last = track.first_row + track.x_m.len() - 1;
        if track.first_row > 0 {
            came += 1;
            assert!((track.x_m[0] - ego.x_m[track.first_row]).abs() > 245.0);
        }
        if last + 1 < rows {
            assert!((track.x_m[track.x_m.len() - 1] - ego.x_m[last]).abs() > 265.0);
        }
        for pair in track.x_m.windows(2) {
            assert!((-0.01..2.5).contains(&(pair[1] - pair[0])), "{pair:?}");
        }
    }
    assert!(came > 10, "{came}");
}

#[test]
fn a_wave_stops_ego_and_lets_it_go() {
    let jam = scenario(STOP_AND_GO, 600.0);
    for seed in 0..2 {
        for driven in [by_person(&jam, seed), by_car(&jam, seed)] {
            assert_eq!((overlap(&driven), driven.report.collisions), (None, 0));
            let speed = &driven.recording.ego().speed_mps;
            let after = &speed[1200..];
            let slowest = after.iter().copied().fold(f64::INFINITY, f64::min);
            let fastest = after.iter().copied().fold(0.0, f64::max);
            assert!(slowest < 2.5 && fastest > 7.0, "{slowest} {fastest}");
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_drive_and_another_another() {
    let dense = scenario(DENSE, 120.0);
    assert_eq!(by_person(&dense, 5), by_person(&dense, 5));
    assert_ne!(by_person(&dense, 5).recording, by_person(&dense, 6).recording);
}

#[test]
fn what_does_not_go_together_is_refused_by_its_key() {
    let read: Scenario = toml::from_str(DENSE).unwrap();
    let refused = |change: &dyn Fn(&mut ScenarioSettings)| {
        let mut settings = read.settings().clone();
        change(&mut settings);
        Scenario::try_from(settings).unwrap_err().to_string()
    };
    let message = refused(&|s| s.leads.factors_of_target.push(0.9));
    assert!(message.contains("leads.factors_of_target"), "{message}");
    let message = refused(&|s| s.start.speed_mph = 95.0);
    assert!(message.contains("`start.speed_mph` is 95"), "{message}");
    let message = refused(&|s| s.background.as_mut().unwrap().ring_m = f64::NAN);
    assert!(message.contains("`background.ring_m`"), "{message}");
    let message = refused(&|s| s.background.as_mut().unwrap().mix.car.time_gap_s = 0.0);
    assert!(message.contains("`background.mix.car.time_gap_s`"), "{message}");
    let text = DENSE.replace("keep_right_mps2 =", "keep_write_mps2 =");
    let error = toml::from_str::<Scenario>(&text).unwrap_err();
    assert!(error.to_string().contains("keep_write_mps2"), "{error}");
}
