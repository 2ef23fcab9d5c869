//! Messages of several makes, and a recording in parts.

use super::*;

#[test]
fn autoware_tracks_with_uuids_and_twists_of_their_own() {
    let yaw = 1.9_f64;
    let mut rig = Rig::new();
    for t in times() {
        let along = SPEED * (t - 100.0);
        rig.send(
            "/localization/kinematic_state",
            ODOMETRY,
            t,
            &odometry(t, ego_at(yaw, t), SPEED, 0.0),
        );
        let mut velocity = cdr();
        velocity.header(t, "base_link").f32(SPEED).f32(0.0).f32(0.0);
        rig.send("/vehicle/status/velocity_status", VELOCITY, t, &velocity);
        let mut bytes = cdr();
        bytes.header(t, "map").u32(2);
        for (uuid, place, label) in
            [(0xab, road(yaw, along + 30.0, 0.0), 1), (0xac, road(yaw, along + 9.0, 0.0), 7)]
        {
            (0..16).for_each(|i| {
                bytes.u8(uuid ^ i);
            });
            bytes.f32(0.9).u32(1).u8(label).f32(1.0);
            bytes.pose(place).covariance().twist(SPEED, 0.0).covariance();
            bytes.twist(0.0, 0.0).covariance().u8(2).u8(0);
            bytes.u8(0).u32(0).f64s(&[5.0, 2.0, 1.5]);
        }
        rig.send("/perception/object_recognition/tracking/objects", TRACKED, t, &bytes);
    }
    let found = read(&rig.log(), None);
    assert_eq!(found.recording.others().len(), 1, "the pedestrian is no vehicle");
    let lead = &found.recording.others()[0];
    close(&lead.speed_mps, SPEED, ROWS - 1);
    // Autoware does not say how long ego is.
    close(&gaps(&found), 30.0 - 2.5 - 4.7 / 2.0, ROWS - 1);
    assert!(said(&found, "ego's length is not known"));
}

#[test]
fn ros_1_json_and_left_handed_logs_give_the_same_gap() {
    let lead = |t: f64, y: f64| [(5, (SPEED * (t - 100.0) + 25.0, y, 0.0), 5.0, CAR)];
    // ROS 1: numbers are packed, and the header has a number.
    let mut rig = Rig::new();
    let text = |text: &str| {
        let text = text.replace("builtin_interfaces/Time stamp", "uint32 seq\ntime stamp");
        text.replace("builtin_interfaces/Time ", "time ")
    };
    let (of_ego, of_objects) = (text(ODOMETRY.1), text(OBJECTS.1));
    for t in times() {
        let packed = || Bytes { bytes: Vec::new(), packed: true };
        let mut ego = packed();
        ego.header(t, "map").string("ego").pose((SPEED * (t - 100.0), 0.0, 0.0));
        ego.covariance().twist(SPEED, 0.0).covariance();
        rig.send("/carla/ego_vehicle/odometry", ("nav_msgs/Odometry", &of_ego), t, &ego);
        let list = objects(packed(), t, &lead(t, 0.0));
        rig.send(
            "/carla/ego_vehicle/objects",
            ("derived_object_msgs/ObjectArray", &of_objects),
            t,
            &list,
        );
    }
    close(&gaps(&read(&rig.log(), None)), 25.0 - 2.5 - 4.7 / 2.0, ROWS - 1);

    // JSON of a rig's own types, which a mapping explains; the frame is left-handed.
    let mut rig = Rig::new();
    for t in times() {
        let x = SPEED * (t - 100.0);
        let ego = format!(r#"{{"t":{t},"at":{{"x":{x},"y":-2.0}},"heading":0.0,"speed":{SPEED}}}"#);
        rig.send_as("/me", ("my/Ego", "jsonschema", b"{}"), "json", t, ego.as_bytes());
        let cars = format!(
            r#"{{"cars":[{{"id":5,"x":{},"y":-2.0,"v":{SPEED},"len":5}},{{"id":6,"x":{x},"y":-5.7,"v":1,"len":5}}],"t":{t}}}"#,
            x + 25.0
        );
        rig.send_as("/cars", ("my/Cars", "jsonschema", b"{}"), "json", t, cars.as_bytes());
    }
    let mapping = r#"
        [road]
        lanes = 2
        lane_width_m = 3.7
        posted_speed_mps = 25.0
        frame = "map"
        right_lane_centre_y_m = 2.0
        [mcap]
        left_handed = true
        [[mcap.messages]]
        type = "my/Ego"
        tells = "ego"
        fields = { sec = "t", x = "at.x", y = "at.y", yaw = "heading", speed = "speed" }
        [[mcap.messages]]
        type = "my/Cars"
        tells = "objects"
        fields = { sec = "t", id = "cars[].id", x = "cars[].x", y = "cars[].y", speed = "cars[].v", length = "cars[].len" }
    "#;
    let found = read(&rig.log(), Some(mapping));
    close(&gaps(&found), 25.0 - 2.5 - 4.7 / 2.0, ROWS - 1);
    let beside = found.recording.others().iter().find(|o| o.id.0 == 6).unwrap();
    // At its right in the left-handed frame's sense of y: in lane 1 after the turn.
    assert!((beside.y_m[0] - 3.7).abs() < 1e-9, "{}", beside.y_m[0]);
}

#[test]
fn one_drive_of_a_recording_that_was_split() {
    let whole = crate::bytes_of(&crate::recording(false));
    let expected = read(&whole, None);
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("run");
    std::fs::create_dir(&folder).unwrap();
    let minute = 60_000_000_000_u64;
    for part in 0..3_u64 {
        let within = part * minute / 3..(part + 1) * minute / 3;
        let bytes = crate::rewritten(&whole, WriteOptions::new(), |mut message| {
            // Channel numbers are a file's own.
            let mut channel = (*message.channel).clone();
            channel.id += 7 * part as u16;
            message.channel = channel.into();
            within.contains(&message.log_time).then_some(message)
        });
        std::fs::write(folder.join(format!("run_{part}.mcap")), bytes).unwrap();
    }
    let files = maveric_ingest::log_files(root.path(), None).unwrap();
    assert_eq!(files, std::slice::from_ref(&folder));
    let found = read_log(&folder, &IngestSettings::default()).unwrap().remove(0);
    assert_eq!(found.meta, expected.meta);
    assert_eq!(found.recording, expected.recording);
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    // A part that is damaged refuses the whole, or is salvaged by itself.
    let second = folder.join("run_1.mcap");
    let bytes = std::fs::read(&second).unwrap();
    std::fs::write(&second, &bytes[..bytes.len() / 2]).unwrap();
    assert!(read_log(&folder, &IngestSettings::default()).is_err());
    let recover = IngestSettings { recover: true, ..IngestSettings::default() };
    let found = read_log(&folder, &recover).unwrap().remove(0);
    assert!(found.recording.rows() > 800 && found.recording.rows() < 1200);
    assert!(found.warnings.iter().any(|w| w.file == second && w.kind == WarningKind::Damage));
}
