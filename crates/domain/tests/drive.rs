//! A drive of two seconds whose every signal was worked out by hand, and what a drive or a recording refuses.
#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use maveric_domain::{
    DomainError, Drive, DriveMeta, DrivenBy, EgoTrack, ObjectTrack, Recording, Reference, Road,
    VehicleId,
    drive::{Direction, Rows},
};

const WIDTH_M: f64 = 3.66;

fn meta() -> DriveMeta {
    DriveMeta::named("P1-calm", "P1", "calm", DrivenBy::Synthetic).unwrap()
}

fn ego(x_m: &[f64], y_m: &[f64], speed_mps: f64) -> EgoTrack {
    EgoTrack {
        length_m: 5.0,
        x_m: x_m.to_vec(),
        y_m: y_m.to_vec(),
        speed_mps: vec![speed_mps; x_m.len()],
    }
}

/// A vehicle 5 m long that stays where it is relative to the road's grid: one x a row.
fn other(id: u32, first_row: usize, x_m: &[f64], lane: u8, speed_mps: f64) -> ObjectTrack {
    ObjectTrack {
        id: VehicleId(id),
        length_m: 5.0,
        first_row,
        x_m: x_m.to_vec(),
        y_m: vec![f64::from(lane) * WIDTH_M; x_m.len()],
        speed_mps: vec![speed_mps; x_m.len()],
    }
}

fn drive(
    road: Road,
    time_s: &[f64],
    segment: &[u32],
    ego: EgoTrack,
    others: Vec<ObjectTrack>,
) -> Drive {
    let recording =
        Recording::new(road, 2.0, time_s.to_vec(), segment.to_vec(), ego, others).unwrap();
    Drive::from_recording(meta(), &recording).unwrap()
}

/// Three lanes, ego in the middle at 10 m/s for four rows half a second apart.
fn by_hand() -> Drive {
    let road = Road { lanes: 3, ..Road::PAPER };
    let ego = ego(&[100.0, 105.0, 110.0, 115.0], &[WIDTH_M; 4], 10.0);
    let others = vec![
        // Ahead in ego's lane from the second row on, 20 m bumper to bumper, as fast as ego.
        other(7, 1, &[130.0, 135.0, 140.0], 1, 10.4),
        // Behind on the left: 45, 50, 55, 60 m.
        other(8, 0, &[50.0, 50.0, 50.0, 50.0], 2, 0.0),
        // Behind on the right, further than 200 m at first, then exactly 200 m, then beside ego.
        other(9, 0, &[-105.5, -100.0, 108.0, 112.0], 0, 0.0),
        // Ahead on the left: behind nobody.
        other(10, 0, &[160.0, 160.0, 160.0, 160.0], 2, 0.0),
    ];
    drive(road, &[0.0, 0.5, 1.0, 1.5], &[0; 4], ego, others)
}

#[test]
fn the_signals_are_those_worked_out_by_hand() {
    let drive = by_hand();
    let rows = drive.rows();
    assert_eq!((drive.len(), drive.is_empty()), (4, false));
    assert_eq!(drive.meta(), &meta());
    assert_eq!(drive.road().lanes, 3);
    assert!((drive.rate_hz() - 2.0).abs() < f64::EPSILON);
    assert_eq!(rows.time_s, [0.0, 0.5, 1.0, 1.5]);
    assert_eq!(rows.ego_x_m, [100.0, 105.0, 110.0, 115.0]);
    assert_eq!(rows.ego_y_m, [WIDTH_M; 4]);
    assert_eq!(rows.ego_speed_mps, [10.0; 4]);
    assert_eq!(rows.lane, [1; 4]);
    // In the first row nobody is ahead in the lane and the vehicle on the right is 205.5 − 5 = 200.5 m behind.
    assert_eq!(rows.lead_id, [None, Some(7), Some(7), Some(7)]);
    assert_eq!(rows.lead_present, [false, true, true, true]);
    assert_eq!(rows.lead_dx_m, [200.0, 20.0, 20.0, 20.0]);
    assert_eq!(rows.lead_dy_m, [0.0; 4]);
    assert_eq!(rows.lead_speed_mps, [24.5872, 10.4, 10.4, 10.4]);
    // 20 m at 10 m/s are 2 s, and the speeds are 0.4 m/s apart.
    assert_eq!(rows.following, [false, true, true, true]);
    let left = [45.0, 50.0, 55.0, 60.0].map(Some);
    assert_eq!(rows.gap_behind_left_m, left);
    // Beside ego is a gap of 0, not of −3.
    let right = [None, Some(200.0), Some(0.0), Some(0.0)];
    assert_eq!(rows.gap_behind_right_m, right);
    assert_eq!(rows.changing, [0; 4]);
    assert!(drive.lane_changes().is_empty());
}

#[test]
fn a_planner_would_have_been_told_what_the_rows_hold() {
    let drive = by_hand();
    let first = drive.situation(0).unwrap();
    assert_eq!(first.reference, Reference::free_road(drive.road()));
    let third = drive.situation(2).unwrap();
    assert_eq!((third.time_s, third.ego_speed_mps), (1.0, 10.0));
    assert_eq!(third.reference.vehicle, Some(VehicleId(7)));
    assert_eq!((third.reference.dx_m, third.reference.speed_mps), (20.0, 10.4));
    assert!(drive.situation(4).is_none());
}

#[test]
fn on_the_outermost_lanes_there_is_no_further_lane_to_look_into() {
    let road = Road::PAPER;
    for (y, left, right) in [(0.0, Some(25.0), None), (WIDTH_M, None, Some(25.0))] {
        let others = vec![other(1, 0, &[70.0, 70.0], 0, 9.0), other(2, 0, &[70.0, 70.0], 1, 9.0)];
        let drive = drive(road, &[0.0, 0.5], &[0, 0], ego(&[100.0, 100.0], &[y, y], 10.0), others);
        assert_eq!(drive.rows().gap_behind_left_m, [left; 2], "ego at {y} m");
        assert_eq!(drive.rows().gap_behind_right_m, [right; 2], "ego at {y} m");
    }
}

#[test]
fn after_a_hole_the_vehicle_that_was_being_passed_is_forgotten() {
    // Ego moves out beside a slower car; in the second case a hole lies between.
    let lead = |segment: &[u32]| {
        let ego = ego(&[0.0, 5.0, 10.0], &[0.0, WIDTH_M, WIDTH_M], 10.0);
        // One ahead in the slow lane, and one in the passing lane that is faster than ego.
        let others = vec![other(1, 0, &[40.0; 3], 0, 5.0), other(2, 0, &[60.0; 3], 1, 20.0)];
        let times = [0.0, 0.5, 1.0];
        drive(Road::PAPER, &times, segment, ego, others).rows().lead_id.clone()
    };
    assert_eq!(lead(&[0, 0, 0]), [Some(1), Some(1), Some(1)]);
    assert_eq!(lead(&[0, 1, 1]), [Some(1), Some(2), Some(2)]);
}

#[test]
fn a_slice_is_the_same_rows_and_needs_two() {
    let whole = by_hand();
    let part = whole.slice(1, 3).unwrap();
    assert_eq!(part.len(), 2);
    assert_eq!(part.meta(), whole.meta());
    assert_eq!(part.rows().lead_id, [Some(7), Some(7)]);
    assert_eq!(part.rows().gap_behind_left_m, [Some(50.0), Some(55.0)]);
    assert_eq!(part.rows().gap_behind_right_m, [Some(200.0), Some(0.0)]);
    assert_eq!(whole.slice(0, 4).unwrap(), whole);
    assert_eq!(whole.slice(2, 99).unwrap().len(), 2, "past the end is the end");
    for (start, end, found) in [(3, 4, 1), (3, 99, 1), (2, 1, 0), (9, 99, 0)] {
        let refused = whole.slice(start, end).unwrap_err();
        let expected = DomainError::TooShort { what: "drive", found, expected: 2 };
        assert_eq!(refused, expected, "{start}..{end}");
    }
}

#[test]
fn following_needs_all_of_its_conditions() {
    // Gap, speed of the lead; ego at 10 m/s.
    let follows = |gap: f64, speed: f64| {
        let x = 105.0 + gap;
        let others = vec![other(1, 0, &[x, x], 0, speed)];
        let ego = ego(&[100.0, 100.0], &[0.0, 0.0], 10.0);
        drive(Road::PAPER, &[0.0, 0.5], &[0, 0], ego, others).rows().following[0]
    };
    assert!(follows(29.9, 10.9) && follows(29.9, 9.1));
    assert!(!follows(30.0, 10.0), "3 s is too far");
    assert!(!follows(29.9, 11.0) && !follows(29.9, 9.0), "1 m/s is closing in or falling back");
    assert!(!follows(0.0, 10.0), "overlapping is not following");
}

/// A smooth change to the left in 2 s at 10 rows a second, on three lanes with somebody behind on either side.
fn change(to_the_left: bool) -> Drive {
    let times: Vec<f64> = (0..60).map(|i| f64::from(i) / 10.0).collect();
    let lateral = |t: f64| {
        let s = ((t - 2.0) / 2.0).clamp(0.0, 1.0);
        WIDTH_M * (1.0 + s * s * (3.0 - 2.0 * s) * if to_the_left { 1.0 } else { -1.0 })
    };
    let y: Vec<f64> = times.iter().map(|&t| lateral(t)).collect();
    let x: Vec<f64> = times.iter().map(|&t| 100.0 + 10.0 * t).collect();
    let behind = |gap: f64| x.iter().map(|x| x - 5.0 - gap).collect::<Vec<_>>();
    let road = Road { lanes: 3, ..Road::PAPER };
    let others = vec![other(1, 0, &behind(20.0), 2, 10.0), other(2, 0, &behind(30.0), 0, 10.0)];
    let recording =
        Recording::new(road, 10.0, times, vec![0; 60], ego(&x, &y, 10.0), others).unwrap();
    Drive::from_recording(meta(), &recording).unwrap()
}

#[test]
fn a_change_goes_the_way_it_goes_and_has_the_gap_of_the_lane_entered() {
    for (left, direction, gap, sign) in
        [(true, Direction::Left, 20.0, 1), (false, Direction::Right, 30.0, -1)]
    {
        let drive = change(left);
        let [change] = drive.lane_changes()[..] else {
            unreachable!("one change: {:?}", drive.lane_changes());
        };
        assert_eq!((change.direction, change.completed), (direction, true));
        assert_eq!(change.gap_behind_m, Some(gap));
        let rows = drive.rows();
        assert!(rows.changing[change.start..change.end].iter().all(|&c| c == sign));
        assert_eq!(rows.changing.iter().filter(|&&c| c != 0).count(), change.end - change.start);
        assert!(rows.change_completes[change.end - 1]);
        // The lateral speed of 3.66 m in 2 s passes 0.15 m/s close to its ends.
        assert!((19..=22).contains(&change.start) && (38..=41).contains(&change.end), "{change:?}");
        // The label: the ten rows that end at the start.
        let labelled: Vec<usize> = (0..60).filter(|&r| rows.lane_change[r]).collect();
        assert_eq!(labelled, (change.start - 9..=change.start).collect::<Vec<_>>());
        assert!(!rows.following[change.start]);
    }
}

/// What a recording is made of, its rate apart.
type Parts = (Road, Vec<f64>, Vec<u32>, EgoTrack, Vec<ObjectTrack>);

fn parts() -> Parts {
    let ego = ego(&[0.0, 5.0, 10.0], &[0.0; 3], 10.0);
    (Road::PAPER, vec![0.0, 0.5, 1.0], vec![0; 3], ego, vec![other(1, 1, &[40.0, 45.0], 0, 10.0)])
}

#[test]
fn a_recording_gives_back_what_it_took() {
    let (road, time_s, segment, ego, others) = parts();
    let recording =
        Recording::new(road, 2.0, time_s, segment, ego.clone(), others.clone()).unwrap();
    assert_eq!((recording.rows(), recording.rate_hz()), (3, 2.0));
    assert_eq!((recording.road(), recording.ego()), (&road, &ego));
    assert_eq!(recording.time_s(), [0.0, 0.5, 1.0]);
    assert_eq!(recording.segment(), [0; 3]);
    assert_eq!(recording.others(), others);
    assert!(recording.scene(0).unwrap().vehicles.is_empty(), "its track starts at row 1");
    let scene = recording.scene(2).unwrap();
    assert_eq!((scene.time_s, scene.ego.x_m, scene.ego.length_m), (1.0, 10.0, 5.0));
    let seen = &scene.vehicles[0];
    assert_eq!((seen.id, seen.x_m, seen.speed_mps), (VehicleId(1), 45.0, 10.0));
    assert!(recording.scene(3).is_none());
}

#[test]
fn scenes_in_turn_are_those_of_their_rows_whatever_the_order_of_the_tracks() {
    let (road, ..) = parts();
    let rows = 40;
    let ego = EgoTrack {
        length_m: 5.0,
        x_m: (0..rows).map(f64::from).collect(),
        y_m: vec![0.0; rows as usize],
        speed_mps: vec![1.0; rows as usize],
    };
    // Tracks that begin late first, one that is over at once, one that fills the last row, and one that is empty.
    let others = [(30, 10), (0, 1), (7, 20), (39, 1), (7, 3), (20, 0), (0, 40)];
    let others = (0..).zip(others).map(|(id, (first_row, m))| ObjectTrack {
        id: VehicleId(id),
        length_m: 4.0,
        first_row,
        x_m: vec![f64::from(id); m],
        y_m: vec![0.0; m],
        speed_mps: vec![2.0; m],
    });
    let time_s = (0..rows).map(f64::from).collect();
    let segment = vec![0; rows as usize];
    let recording = Recording::new(road, 1.0, time_s, segment, ego, others.collect()).unwrap();
    let found: Vec<_> = recording.scenes().collect();
    let expected: Vec<_> = (0..).map_while(|row| recording.scene(row)).collect();
    assert_eq!(found, expected);
    assert_eq!(found.len(), 40);
    let ids: Vec<u32> = found[8].vehicles.iter().map(|v| v.id.0).collect();
    assert_eq!(ids, [2, 4, 6]);
}

#[test]
fn a_recording_that_cannot_be_is_refused_by_name() {
    type Change = fn(&mut Parts);
    let cases: [(Change, &str); 12] = [
        (|p| p.0.lane_width_m = 0.0, "`lane_width_m` is 0"),
        (|p| p.0.posted_speed_mps = f64::NAN, "`posted_speed_mps` is NaN"),
        (|p| p.0.lanes = 0, "`lanes` is 0"),
        (|p| p.1.truncate(1), "recording has 1 rows"),
        (|p| p.1[2] = f64::INFINITY, "column `time_s` row 2 is inf"),
        (|p| p.1[2] = 0.5, "`time_s` is 0.5, expected later"),
        (|p| p.2.push(0), "column `segment` has 4 rows, expected 3"),
        (|p| p.3.x_m.truncate(2), "column `ego.x_m` has 2 rows, expected 3"),
        (|p| p.3.y_m[1] = f64::NAN, "column `ego.y_m` row 1 is NaN"),
        (|p| p.3.speed_mps.clear(), "column `ego.speed_mps` has 0 rows"),
        (|p| p.4[0].first_row = 2, "column `object.x_m` has 4 rows, expected 3"),
        (|p| p.4[0].speed_mps.push(1.0), "column `object.speed_mps` has 3 rows, expected 2"),
    ];
    for (change, said) in cases {
        let mut p = parts();
        change(&mut p);
        let refused = Recording::new(p.0, 2.0, p.1, p.2, p.3, p.4).unwrap_err().to_string();
        assert!(refused.contains(said), "{refused}, expected {said}");
    }
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let p = parts();
        let refused = Recording::new(p.0, rate, p.1, p.2, p.3, p.4).unwrap_err().to_string();
        assert!(refused.contains("`rate_hz`"), "{refused}");
    }
}

/// Spoils rows that were a drive's.
type Spoil = fn(&mut Rows);

#[test]
fn rows_read_back_are_the_drive_again_and_impossible_ones_are_refused() {
    let drive = by_hand();
    let again =
        Drive::from_rows(meta(), *drive.road(), drive.rate_hz(), drive.rows().clone()).unwrap();
    assert_eq!(again, drive);
    let cases: [(Spoil, &str); 25] = [
        (|r| r.segment.truncate(3), "segment"),
        (|r| r.ego_x_m.truncate(3), "ego_x_m"),
        (|r| r.ego_y_m.truncate(3), "ego_y_m"),
        (|r| r.ego_speed_mps.truncate(3), "ego_speed_mps"),
        (|r| r.lane.truncate(3), "lane"),
        (|r| r.lead_present.truncate(3), "lead_present"),
        (|r| r.lead_id.truncate(3), "lead_id"),
        (|r| r.lead_dx_m.truncate(3), "lead_dx_m"),
        (|r| r.lead_dy_m.truncate(3), "lead_dy_m"),
        (|r| r.lead_speed_mps.truncate(3), "lead_speed_mps"),
        (|r| r.lane_change.truncate(3), "lane_change"),
        (|r| r.changing.truncate(3), "changing"),
        (|r| r.change_completes.truncate(3), "change_completes"),
        (|r| r.following.truncate(3), "following"),
        (|r| r.gap_behind_left_m.truncate(3), "gap_behind_left_m"),
        (|r| r.gap_behind_right_m.truncate(3), "gap_behind_right_m"),
        (|r| r.time_s[1] = f64::NAN, "time_s"),
        (|r| r.ego_x_m[1] = f64::NAN, "ego_x_m"),
        (|r| r.ego_y_m[1] = f64::NAN, "ego_y_m"),
        (|r| r.ego_speed_mps[1] = f64::INFINITY, "ego_speed_mps"),
        (|r| r.lead_dx_m[1] = f64::NAN, "lead_dx_m"),
        (|r| r.lead_dy_m[1] = f64::NAN, "lead_dy_m"),
        (|r| r.lead_speed_mps[1] = f64::NAN, "lead_speed_mps"),
        (|r| *r = Rows::default(), "drive has 0 rows"),
        (|r| r.time_s.truncate(1), "drive has 1 rows"),
    ];
    for (change, said) in cases {
        let mut rows = drive.rows().clone();
        change(&mut rows);
        let refused = Drive::from_rows(meta(), *drive.road(), 2.0, rows).unwrap_err().to_string();
        assert!(refused.contains(said), "{refused}, expected {said}");
    }
    for rate in [0.0, f64::NAN, f64::INFINITY] {
        let refused = Drive::from_rows(meta(), *drive.road(), rate, drive.rows().clone());
        assert!(refused.unwrap_err().to_string().contains("`rate_hz`"));
    }
}

#[test]
fn words_for_who_drove_read_back() {
    for (who, word) in [
        (DrivenBy::Human, "human"),
        (DrivenBy::Synthetic, "synthetic"),
        (DrivenBy::Automated, "automated"),
    ] {
        assert_eq!((who.as_str(), word.parse::<DrivenBy>().unwrap()), (word, who));
    }
    let refused = "robot".parse::<DrivenBy>().unwrap_err().to_string();
    assert!(refused.contains("robot") && refused.contains("human, scripted, synthetic, automated"));
}

#[test]
fn who_is_beside_the_road_is_in_none_of_its_lanes() {
    // Parked 25 and 200 m to the right, oncoming beyond the left lane: nobody to follow, and nobody to merge back before.
    let at = |id, y_m: f64, x_m: &[f64]| ObjectTrack {
        y_m: vec![y_m; x_m.len()],
        ..other(id, 0, x_m, 0, 0.0)
    };
    let time_s = [0.0, 0.5, 1.0, 1.5];
    let beside = || {
        vec![
            at(1, -25.0, &[130.0; 4]),
            at(2, -200.0, &[90.0; 4]),
            at(3, 3.1 * WIDTH_M, &[140.0; 4]),
        ]
    };
    let signals = |lane: u8, with: Vec<ObjectTrack>| {
        let ego_x = [100.0, 105.0, 110.0, 115.0];
        let ego = ego(&ego_x, &[f64::from(lane) * WIDTH_M; 4], 10.0);
        drive(Road::PAPER, &time_s, &[0; 4], ego, with)
    };
    for lane in [0, 1] {
        let alone = signals(lane, beside());
        assert_eq!(alone.rows().lead_id, [None; 4], "lane {lane}");
        assert_eq!(alone.rows().gap_behind_right_m, [None; 4]);
        // The one ahead in the lane is the leader, as if nobody stood beside the road.
        let mut with = beside();
        with.push(other(7, 0, &[160.0, 165.0, 170.0, 175.0], lane, 10.0));
        let led = signals(lane, with);
        assert_eq!(led.rows().lead_id, [Some(7); 4], "lane {lane}");
    }
}

#[test]
fn who_follows_is_in_the_lane_of_the_road_that_it_drives_on() {
    let following = |lane_width_m: f64, aside_m: f64| {
        let road = Road { lane_width_m, ..Road::PAPER };
        let ahead = ObjectTrack {
            y_m: vec![0.5 * aside_m; 4],
            ..other(7, 0, &[130.0, 135.0, 140.0, 145.0], 0, 10.0)
        };
        let ego = ego(&[100.0, 105.0, 110.0, 115.0], &[-0.5 * aside_m; 4], 10.0);
        let drive = drive(road, &[0.0, 0.5, 1.0, 1.5], &[0; 4], ego, vec![ahead]);
        assert_eq!(drive.rows().lead_id, [Some(7); 4]);
        drive.rows().following.clone()
    };
    for (lane_width_m, aside_m, follows) in
        [(3.66, 1.82, true), (3.66, 1.84, false), (2.8, 1.6, false), (5.0, 2.2, true)]
    {
        let found = following(lane_width_m, aside_m);
        assert_eq!(found, [follows; 4], "{aside_m} m aside in {lane_width_m} m");
    }
}
