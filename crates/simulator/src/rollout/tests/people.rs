//! People, and the vehicles around them.

use super::*;

#[test]
fn a_person_stops_where_both_lanes_are_taken() {
    let scenario = empty_road(120.0, vec![placed(400.0, 0, 0.0), placed(400.0, 1, 0.0)]);
    for seed in 0..5 {
        let driver = person(1.0, -1.0, 1.0, seed);
        let stopped = rollout(&scenario, Driver::Human(&driver), seed).unwrap();
        assert!(*stopped.recording.ego().speed_mps.last().unwrap() < 0.3);
        assert_eq!(stopped.report.collisions, 0);
        assert!(final_gap_m(&stopped, 0) > 0.5);
    }
}

#[test]
fn people_meet_six_leads_and_hit_none() {
    for seed in 0..8 {
        let driver = person(0.3 * seed as f64 - 1.2, 0.0, 0.0, seed);
        let driven = rollout(&Scenario::paper(), Driver::Human(&driver), seed).unwrap();
        assert_eq!(driven.report.collisions, 0);
        assert_eq!((driven.report.leads, driven.report.blocked_encounters), (6, 2));
        assert!(drive(&driven).lane_changes().len() >= 2);
    }
}

#[test]
fn the_other_vehicles_never_overlap_each_other() {
    for seed in 0..6 {
        let driver = person(0.0, 0.0, 0.0, seed);
        let driven = rollout(&Scenario::paper(), Driver::Human(&driver), seed).unwrap();
        for row in (0..driven.recording.rows()).step_by(4) {
            let all = driven.recording.scene(row).unwrap().vehicles;
            for (i, a) in all.iter().enumerate() {
                for b in &all[..i] {
                    let apart = (a.y_m - b.y_m).abs() > 1.9 || (a.x_m - b.x_m).abs() > 4.7;
                    assert!(apart, "seed {seed} row {row}: {a:?} {b:?}");
                }
            }
        }
    }
}

#[test]
fn two_minutes_meet_two_leads() {
    let scenario = Scenario::paper().with_duration(Seconds(120.0)).unwrap();
    let driver = person(0.5, 0.0, 0.5, 1);
    let driven = rollout(&scenario, Driver::Human(&driver), 1).unwrap();
    assert_eq!(driven.report.leads, 2);
    assert_eq!(driven.recording.rows(), 2400);
}

#[test]
fn aggressive_people_drive_faster_and_merge_back_closer() {
    let mean_of = |a: f64| {
        let (mut speed, mut gap, mut merges) = (0.0, 0.0, 0.0);
        for seed in 0..12 {
            let driver = person(a, 0.0, 0.0, seed);
            let driven = rollout(&Scenario::paper(), Driver::Human(&driver), seed).unwrap();
            let drive = drive(&driven);
            let speeds = &drive.rows().ego_speed_mps;
            speed += speeds.iter().sum::<f64>() / speeds.len() as f64;
            for gap_m in drive
                .lane_changes()
                .iter()
                .filter_map(|c| c.gap_behind_m.filter(|_| c.direction == Direction::Right))
            {
                gap += gap_m;
                merges += 1.0;
            }
        }
        (speed / 12.0, gap / merges)
    };
    let (calm, wild) = (mean_of(-1.5), mean_of(1.5));
    assert!(wild.0 > calm.0 + 3.0, "{calm:?} {wild:?}");
    assert!(wild.1 < calm.1 - 10.0, "{calm:?} {wild:?}");
}

#[test]
fn the_same_seed_gives_the_same_drive_and_another_another() {
    let scenario = Scenario::paper().with_duration(Seconds(200.0)).unwrap();
    let driver = person(0.2, 0.1, -0.3, 5);
    let once = |seed| rollout(&scenario, Driver::Human(&driver), seed).unwrap();
    assert_eq!(once(9), once(9));
    assert_ne!(once(9), once(10));
}

#[test]
fn a_vehicle_out_of_sight_changes_nobody_elses_drive() {
    let duration_s = 200.0;
    let far = with(|s| {
        s.duration_s = duration_s;
        s.vehicles = vec![placed(-20_000.0, 0, 0.0)];
    });
    let without = with(|s| s.duration_s = duration_s);
    let driver = person(0.2, 0.1, -0.3, 5);
    let ego = |scenario: &Scenario| {
        let driven = rollout(scenario, Driver::Human(&driver), 3).unwrap();
        driven.recording.ego().clone()
    };
    assert_eq!(ego(&far), ego(&without));
}

#[test]
fn more_off_lane_traffic_leaves_the_order_of_the_leads() {
    let approach_speeds = |interval_s: f64| {
        let scenario = with(|s| s.off_lane.interval_s = [interval_s, interval_s]);
        let driven = automated(&scenario, always(28.0, 40.0), 4);
        assert_eq!(driven.report.leads, 6);
        let ego = driven.recording.ego();
        let leads = driven.recording.others().iter().filter(|t| t.y_m[0] < 1.0);
        // Each lead drives off in the end; its speed 20 s before is its own.
        leads
            .filter(|t| t.first_row > 0 && t.x_m[0] > ego.x_m[t.first_row])
            .map(|t| (t.speed_mps[t.speed_mps.len().min(1100) - 1] * 2.0).round())
            .collect::<Vec<_>>()
    };
    assert_eq!(approach_speeds(60.0), approach_speeds(1e5));
}
