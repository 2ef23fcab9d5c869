//! Where the speed comes from.

use super::*;

#[test]
fn twists_in_either_frame_give_the_speed() {
    let yaw = 3.0_f64;
    for in_map in [false, true] {
        let mut rig = Rig::new();
        for t in times() {
            let (vx, vy) =
                if in_map { (SPEED * yaw.cos(), SPEED * yaw.sin()) } else { (SPEED, 0.0) };
            rig.send("/odom", ODOMETRY, t, &odometry(t, ego_at(yaw, t), vx, vy));
        }
        let found = read(&rig.log(), None);
        close(&found.recording.ego().speed_mps, SPEED, ROWS - 1);
        assert_eq!(said(&found, "frame of the map"), in_map);
    }
}

#[test]
fn a_pose_and_a_fix_take_their_speed_from_the_channel_beside_them() {
    for fix in [false, true] {
        let mut rig = Rig::new();
        for t in times() {
            let east = SPEED * (t - 100.0);
            let mut bytes = cdr();
            bytes.header(t, "map");
            if fix {
                // One second of arc at the equator: 30.92 m.
                let degrees = east / (6_378_137.0_f64.to_radians());
                bytes.u8(0).u16(1).f64s(&[0.0, degrees, 30.0]).f64s(&[0.0; 9]).u8(0);
                rig.send("/fix", FIX, t, &bytes);
            } else {
                bytes.pose((east, 0.0, 0.0));
                rig.send("/pose", POSE, t, &bytes);
            }
            let mut speed = cdr();
            speed.header(t + 0.02, "base_link").twist(SPEED, 0.0);
            rig.send("/vel", TWIST, t, &speed);
        }
        let found = read(&rig.log(), None);
        assert!(!said(&found, "differentiated"), "{:?}", found.warnings);
        close(&found.recording.ego().speed_mps, SPEED, ROWS - 3);
        let x = &found.recording.ego().x_m;
        assert!((x[200] - x[0] - SPEED * 10.0).abs() < 1e-3, "{}", x[200] - x[0]);
    }
}

#[test]
fn speeds_of_another_channel_stay_with_their_poses_whatever_the_clock_does() {
    const SPEED_ALONE: (&str, &str) = ("lab_msgs/msg/Speed", "float64 value\n");
    const MAPPING: &str = "[mcap]\n[[mcap.messages]]\ntype = \"lab_msgs/Speed\"\ntells = \"speed\"\nfields = { speed = \"value\" }\n";
    let speed_at = |t: f64| SPEED + 5.0 * (0.5 * t).sin();
    // What the stamps of both channels are, or of the mapped one that has none.
    let clocks: [&dyn Fn(f64) -> f64; 3] =
        [&|_| 0.0, &|t| if t < 115.0 { t } else { t - 15.0 }, &|t| t];
    for (case, stamp) in clocks.iter().enumerate() {
        let mapped = case == 2;
        let mut rig = Rig::new();
        let mut east = 0.0;
        for t in times() {
            east += speed_at(t) / 20.0;
            let mut pose = cdr();
            pose.header(stamp(t), "map").pose((east, 0.0, 0.0));
            rig.send("/pose", POSE, t, &pose);
            let mut speed = cdr();
            if mapped {
                speed.f64s(&[speed_at(t)]);
                rig.send("/vel", SPEED_ALONE, t, &speed);
            } else {
                speed.header(stamp(t), "base_link").twist(speed_at(t), 0.0);
                rig.send("/vel", TWIST, t, &speed);
            }
        }
        let found = read(&rig.log(), mapped.then_some(MAPPING));
        assert!(!said(&found, "differentiated"), "{case}: {:?}", found.warnings);
        let ego = found.recording.ego();
        assert!(ego.speed_mps.len() > ROWS - 5, "{case}");
        for (time, v) in found.recording.time_s().iter().zip(&ego.speed_mps) {
            let expected = speed_at(100.0 + time);
            assert!((v - expected).abs() < 0.05, "{case}: {v} at {time}, expected {expected}");
        }
    }
}
