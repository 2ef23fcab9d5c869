//! The automated car.

use super::*;

/// Passes what is near ahead, merges back 1.4 s past it.
fn passing(speed_mps: f64) -> impl FnMut(&View<'_>) -> Setpoints {
    move |s| {
        let gap_s = s.reference.dx_m / s.scene.ego.speed_mps.max(1.0);
        let own_lane = s.reference.dy_m.abs() < 1.83;
        let wish = match (s.reference.vehicle.is_some(), own_lane) {
            (true, true) if gap_s < 2.0 => LaneWish::MoveOut(When::Now),
            (true, false) if gap_s < -1.4 => LaneWish::MoveBack(When::Now),
            _ => LaneWish::Stay,
        };
        Setpoints { speed_mps, following_distance_m: 1.2 * s.scene.ego.speed_mps, wish }
    }
}

#[test]
fn the_car_stops_behind_a_standing_one() {
    let scenario = empty_road(120.0, vec![placed(400.0, 0, 0.0)]);
    let stopped = automated(&scenario, always(30.0, 8.0), 1);
    assert!(*stopped.recording.ego().speed_mps.last().unwrap() < 0.1);
    let gap = final_gap_m(&stopped, 0);
    assert!((2.0..12.0).contains(&gap), "{gap}");
    assert_eq!(stopped.report.collisions, 0);
}

#[test]
fn the_car_passes_a_slower_lead_and_merges_back() {
    let scenario = empty_road(120.0, vec![placed(200.0, 0, 24.0)]);
    let passed = automated(&scenario, passing(30.0), 1);
    let changes = drive(&passed).lane_changes();
    let directions: Vec<Direction> = changes.iter().map(|c| c.direction).collect();
    assert_eq!(directions, [Direction::Left, Direction::Right]);
    assert!(changes.iter().all(|c| c.completed));
    assert!(passed.recording.ego().y_m.last().unwrap().abs() < 0.05);
    assert_eq!(passed.report.collisions + passed.report.interventions, 0);
}

#[test]
fn the_trace_says_what_was_asked_and_where_the_car_goes() {
    let scenario = empty_road(120.0, vec![placed(200.0, 0, 24.0)]);
    let passed = automated(&scenario, passing(30.0), 1);
    assert_eq!(passed.trace.len(), passed.recording.rows());
    assert!(passed.trace.iter().all(|row| (row.asked.speed_mps - 30.0).abs() < 1e-12));
    let first = passed.trace.iter().find(|row| row.path_m.is_some()).unwrap();
    assert_eq!(first.lane, LaneActivity::Changing);
    let path = first.path_m.unwrap();
    assert!(path[0].1.abs() < 0.1 && (path[3].1 - 3.66).abs() < 1e-9, "{path:?}");
    let person = person(0.0, 0.0, 0.0, 1);
    assert!(rollout(&scenario, Driver::Human(&person), 1).unwrap().trace.is_empty());
}

#[test]
fn the_car_waits_while_the_passing_lane_is_taken() {
    let beside = vec![placed(45.0, 0, 24.5), placed(8.0, 1, 24.5872), placed(-14.0, 1, 24.5872)];
    let scenario = empty_road(40.0, beside);
    let waited = automated(&scenario, passing(24.7), 1);
    assert_eq!(drive(&waited).lane_changes().len(), 0);
    assert_eq!(waited.report.held_changes, 1);
}

#[test]
fn the_car_returns_when_there_is_nobody_to_pass() {
    let scenario = with(|s| {
        s.duration_s = 25.0;
        s.start.lane = 1;
        s.off_lane.interval_s = [1e5, 1e5];
    });
    let returned = automated(&scenario, always(28.0, 40.0), 1);
    assert!(returned.recording.ego().y_m.last().unwrap().abs() < 0.1);
}

const BENDS: &str = r#"segments = [
    { kind = "straight", length_m = 300.0 },
    { kind = "clothoid", length_m = 100.0, to_radius_m = 250.0 },
    { kind = "arc", length_m = 200.0, radius_m = 250.0 },
    { kind = "clothoid", length_m = 200.0, to_radius_m = -400.0 },
    { kind = "arc", length_m = 150.0, radius_m = -400.0 },
    { kind = "clothoid", length_m = 100.0 },
]"#;

#[derive(serde::Deserialize)]
struct Bends {
    segments: Vec<crate::road::Segment>,
}

#[test]
fn in_bends_the_car_keeps_its_lane_and_the_lateral_acceleration_asked_for() {
    let bends: Bends = toml::from_str(BENDS).unwrap();
    for model in [VehicleModel::Kinematic, VehicleModel::Dynamic] {
        let mut settings = empty_road(120.0, vec![]).settings().clone();
        settings.road.segments.clone_from(&bends.segments);
        settings.vehicle.model = model;
        settings.vehicle.integrator = Integrator::Rk4;
        let scenario = Scenario::try_from(settings).unwrap();
        let driven = automated(&scenario, always(32.0, 40.0), 1);
        let ego = driven.recording.ego();
        let limit = scenario.settings().controllers.curve_acceleration_mps2;
        let mut slowest = f64::MAX;
        for row in 0..driven.recording.rows() {
            let curvature = scenario.centre_line().curvature_per_m(ego.x_m[row]);
            assert!(ego.y_m[row].abs() < 0.1, "row {row}: {}", ego.y_m[row]);
            let lateral = ego.speed_mps[row].powi(2) * curvature.abs();
            assert!(lateral < limit + 0.5, "row {row}: {lateral}");
            slowest = slowest.min(ego.speed_mps[row]);
        }
        assert!(slowest < 26.0 && ego.x_m.last().unwrap() > &2500.0);
    }
}

#[test]
fn a_person_and_the_car_pass_on_the_middle_lanes_of_a_bending_road() {
    let bends: Bends = toml::from_str(BENDS).unwrap();
    for (lane, aggressiveness) in [(1, 0.0), (2, 1.0)] {
        let mut settings = empty_road(100.0, vec![]).settings().clone();
        settings.road.segments.clone_from(&bends.segments);
        settings.road.lanes = 4;
        settings.start.lane = lane;
        // Somebody on the right, too: nobody goes back before having passed.
        settings.vehicles = vec![placed(150.0, lane, 19.0), placed(100.0, lane - 1, 19.0)];
        let scenario = Scenario::try_from(settings).unwrap();
        let driver = person(aggressiveness, 0.0, 0.5, 3);
        let by_person = rollout(&scenario, Driver::Human(&driver), 3).unwrap();
        let by_car = automated(&scenario, passing(26.0), 3);
        for driven in [by_person, by_car] {
            let first = drive(&driven).lane_changes()[0];
            assert_eq!(first.direction, Direction::Left);
            let reached = driven.recording.ego().y_m.iter().copied().fold(0.0, f64::max);
            assert_eq!(driven.recording.road().nearest_lane(reached), lane + 1);
            assert_eq!(driven.report.collisions, 0);
        }
    }
}

#[test]
fn an_asked_gap_below_the_safe_distance_is_not_kept() {
    let scenario = empty_road(180.0, vec![placed(100.0, 0, 25.0)]);
    let followed = automated(&scenario, always(33.0, 1.0), 1);
    let gap = final_gap_m(&followed, 0);
    let v = MetresPerSecond(25.0);
    let safe = safe_distance(&scenario.settings().controllers, v, v).0;
    assert!(gap > safe - 1.5, "{gap} {safe}");
    assert_eq!(followed.report.rule_violations, 0);
}

#[test]
fn a_car_off_the_road_slides_along_the_barrier_and_is_counted_once() {
    let scenario = empty_road(10.0, Vec::new());
    let slides = |steering: f64| {
        let mut session = Session::new(&scenario, Driver::Hands, 1).unwrap();
        let hands = Hands { steering, throttle: 0.3, brake: 0.0 };
        while session.tick(hands) {}
        let driven = session.finish().unwrap();
        let ego = driven.recording.ego();
        assert!(ego.speed_mps.last() < ego.speed_mps.first());
        assert_eq!(driven.report.barrier_touches, 1);
        let furthest = ego.y_m.iter().copied();
        (furthest.clone().fold(0.0, f64::min), furthest.fold(0.0, f64::max))
    };
    // Half a lane and a shoulder of 3 m to the right, one and a half lanes and 1.2 m to the left, less half a car of 1.9 m.
    let (right, left) = (slides(-0.05).0, slides(0.05).1);
    assert!((right + 1.83 + 3.0 - 0.95).abs() < 1e-9, "{right}");
    assert!((left - 5.49 - 1.2 + 0.95).abs() < 1e-9, "{left}");
}

#[test]
fn a_set_point_that_is_no_number_ends_the_drive_and_says_when() {
    for (row, rows) in [(0, 2), (1, 2), (57, 58)] {
        let planner = move |s: &View<'_>| Setpoints {
            speed_mps: 25.0,
            following_distance_m: if s.scene.time_s > 0.05 * f64::from(row) - 0.01 {
                f64::NAN
            } else {
                30.0
            },
            wish: LaneWish::Stay,
        };
        let driven = automated(&Scenario::paper(), planner, 1);
        assert_eq!(driven.recording.rows(), rows);
        let error = driven.completed().unwrap_err().to_string();
        let moment = format!("`following_distance_m` = NaN at {} s", f64::from(row) / 20.0);
        assert!(error.contains(&moment), "{error}");
    }
    let whole = automated(&empty_road(5.0, vec![]), always(25.0, 30.0), 1);
    assert!(whole.completed().is_ok());
}

#[test]
fn controller_settings_out_of_range_are_refused() {
    let mut planner = always(30.0, 30.0);
    let settings = ControllerSettings { gap_gain_per_s2: -1.0, ..ControllerSettings::default() };
    let driver = Driver::Automated(&mut planner, &settings);
    let error = rollout(&Scenario::paper(), driver, 1).unwrap_err();
    assert!(error.to_string().contains("controllers.gap_gain_per_s2"));
}
