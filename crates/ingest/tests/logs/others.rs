//! The others of a rig's log: in whose frame, on how many channels, and when nobody looked.

use super::rigs::{
    CAR, OBJECTS, ODOMETRY, ROWS, Rig, SPEED, cdr, close, ego_at, gaps, objects, objects_in,
    odometry, read, road, said, times, try_read,
};
use maveric_ingest::{IngestError, WarningKind};

const EGO: &str = "/carla/hero/odometry";
const OTHERS: &str = "/carla/hero/objects";

/// A log of ego and one car 40 m ahead; lists of others in some frame at the times that `there` picks.
fn log(yaw: f64, frame: &str, there: impl Fn(usize) -> bool) -> Vec<u8> {
    let mut rig = Rig::new();
    for (i, t) in times().enumerate() {
        let along = SPEED * (t - 100.0);
        let ego = odometry(t, ego_at(yaw, t), SPEED, 0.0);
        rig.send(EGO, ODOMETRY, t, &ego);
        let place = match frame {
            "map" => road(yaw, along + 40.0, 0.2),
            _ => (40.0, 0.2, 0.0),
        };
        if there(i) {
            let list = objects_in(frame, cdr(), t, &[(31, place, 12.0, CAR)]);
            rig.send(OTHERS, OBJECTS, t, &list);
        }
    }
    rig.log()
}

#[test]
fn others_in_egos_own_frame_are_where_they_are_seen_from_ego() {
    for yaw in [0.0, 2.5, -1.2] {
        let of_map = gaps(&read(&log(yaw, "map", |_| true), None));
        // Ego's child frame is `ego_vehicle`.
        for frame in ["base_link", "ego_vehicle"] {
            let found = read(&log(yaw, frame, |_| true), None);
            let gaps = gaps(&found);
            assert_eq!(gaps.len(), of_map.len(), "{frame} {yaw}");
            close(&gaps, of_map[0], ROWS - 1);
            close(&found.recording.others()[0].speed_mps, SPEED, ROWS - 1);
            assert!(said(&found, "in ego's own frame"));
        }
        let found = read(&log(yaw, "velodyne", |_| true), None);
        assert!(found.recording.others().is_empty());
        assert!(said(&found, "nobody knows where they are"));
    }
}

#[test]
fn a_topic_on_two_channels_is_one() {
    let mut rig = Rig::new();
    for (i, t) in times().enumerate() {
        // The same topic, published by another node every second time.
        let fresh = |rig: &mut Rig, topic: &str, kind: (&str, &str)| {
            let schema = rig.out.add_schema(kind.0, "ros2msg", kind.1.as_bytes());
            let of_node = std::collections::BTreeMap::from([("node".to_owned(), "2".to_owned())]);
            let channel = rig.out.add_channel(schema.unwrap(), topic, "cdr", &of_node);
            rig.channels.insert(format!("{topic} again"), channel.unwrap());
        };
        if i == 1 {
            fresh(&mut rig, EGO, ODOMETRY);
            fresh(&mut rig, OTHERS, OBJECTS);
        }
        let on = |topic: &str| format!("{topic}{}", if i % 2 == 1 { " again" } else { "" });
        let ego = odometry(t, ego_at(0.4, t), SPEED, 0.0);
        rig.send(&on(EGO), ODOMETRY, t, &ego);
        let ahead = road(0.4, SPEED * (t - 100.0) + 40.0, 0.2);
        let list = objects(cdr(), t, &[(31, ahead, 12.0, CAR)]);
        rig.send(&on(OTHERS), OBJECTS, t, &list);
    }
    let found = read(&rig.log(), None);
    assert_eq!(found.recording.rows(), ROWS);
    let warnings: Vec<WarningKind> = found.warnings.iter().map(|w| w.kind).collect();
    assert_eq!(warnings, [WarningKind::Default], "{:?}", found.warnings);
    // Ego's length is not known: 4.7 m.
    close(&gaps(&found), 40.0 - 6.0 - 2.35, ROWS);
    close(&found.recording.ego().speed_mps, SPEED, ROWS);
}

#[test]
fn rows_at_which_nobody_looked_are_a_hole_and_no_free_road() {
    // Silent from second 10 to 20.
    let silent = |i: usize| !(200..400).contains(&i);
    let found = read(&log(0.3, "map", silent), None);
    let recording = &found.recording;
    assert_eq!(recording.rows(), ROWS - 200);
    assert_eq!(gaps(&found).len(), ROWS - 200, "the leader is there in every row");
    assert_eq!(recording.segment().last(), Some(&1));
    let hole = found.warnings.iter().find(|w| w.kind == WarningKind::Hole).unwrap();
    assert_eq!((hole.count, hole.spans_s.len()), (200, 1));
    assert!((hole.spans_s[0].0 - 9.95).abs() < 1e-6 && (hole.spans_s[0].1 - 20.0).abs() < 1e-6);
    // An empty list is a look at an empty road.
    let mut rig = Rig::new();
    for (i, t) in times().enumerate() {
        rig.send(EGO, ODOMETRY, t, &odometry(t, ego_at(0.3, t), SPEED, 0.0));
        let ahead = (31, road(0.3, SPEED * (t - 100.0) + 40.0, 0.2), 12.0, CAR);
        let all = [ahead];
        let list = objects(cdr(), t, if silent(i) { &all } else { &[] });
        rig.send(OTHERS, OBJECTS, t, &list);
    }
    let found = read(&rig.log(), None);
    assert_eq!((found.recording.rows(), gaps(&found).len()), (ROWS, ROWS - 200));
    assert!(!said(&found, "not seen"));
    // Once a second nobody knows anything between.
    let error = try_read(&log(0.3, "map", |i| i % 20 == 0), None).unwrap_err();
    assert!(matches!(error, IngestError::SeldomSeen { sightings: 30, .. }), "{error}");
}

#[test]
fn odometry_without_a_twist_has_the_speed_of_its_positions() {
    let head = ODOMETRY.1.find("geometry_msgs/TwistWithCovariance twist").unwrap();
    let rest = &ODOMETRY.1[head..];
    let line = rest.find('\n').unwrap();
    let without = format!("{}{}", &ODOMETRY.1[..head], &rest[line..]);
    for whole in [true, false] {
        let mut rig = Rig::new();
        for t in times() {
            if whole {
                rig.send("/odom", ODOMETRY, t, &odometry(t, ego_at(0.3, t), f64::NAN, f64::NAN));
            } else {
                let mut bytes = cdr();
                bytes.header(t, "map").string("ego_vehicle");
                bytes.pose(ego_at(0.3, t)).covariance();
                rig.send("/odom", (ODOMETRY.0, &without), t, &bytes);
            }
        }
        let found = read(&rig.log(), None);
        close(&found.recording.ego().speed_mps, SPEED, ROWS - 1);
        assert!(said(&found, "no speed was recorded"));
    }
}
