//! Which of the vehicles is ego.

use super::*;

#[test]
fn carla_with_ego_among_all_objects_in_any_direction() {
    for yaw in [0.0, 2.5, -1.2] {
        let mut rig = Rig::new();
        for t in times() {
            let along = SPEED * (t - 100.0);
            rig.send("/carla/hero/odometry", ODOMETRY, t, &odometry(t, ego_at(yaw, t), SPEED, 0.0));
            let all = [
                (24, ego_at(yaw, t), 4.0, CAR),
                (31, road(yaw, along + 40.0, 0.2), 12.0, CAR),
                (32, road(yaw, along + 15.0, 3.7), 4.5, CAR),
                (33, road(yaw, along + 10.0, 0.5), 0.5, 4),
            ];
            rig.send("/carla/objects", OBJECTS, t, &objects(cdr(), t, &all));
        }
        let found = read(&rig.log(), None);
        // Centres 40 m apart, half a truck of 12 m and half an ego of 4 m off: its own dimensions, not a default.
        let length = found.recording.ego().length_m;
        assert!((length - 4.0).abs() < 1e-9, "ego's own length, {length}");
        close(&gaps(&found), 40.0 - 6.0 - 2.0, ROWS - 1);
        assert!(said(&found, "24"), "{:?}", found.warnings);
        close(&found.recording.ego().speed_mps, SPEED, ROWS - 1);
    }
}

#[test]
fn ego_is_told_from_transforms_where_nothing_else_tells_it() {
    for packed in [false, true] {
        let header = if packed { "uint32 seq\n" } else { "" };
        let line = "=".repeat(80);
        let text = format!(
            "geometry_msgs/TransformStamped[] transforms\n{line}\n\
            MSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n{line}\n\
            MSG: std_msgs/Header\n{header}{} stamp\nstring frame_id\n{line}\n\
            MSG: geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n{line}\n\
            MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n{line}\n\
            MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w",
            if packed { "time" } else { "builtin_interfaces/Time" }
        );
        let name = if packed { "tf2_msgs/TFMessage" } else { "tf2_msgs/msg/TFMessage" };
        let mut rig = Rig::new();
        for t in times() {
            let all = [
                ("base_link", "camera", (1.0, 0.0, 0.0)),
                // Drifts: passed over once a frame of the map is there.
                ("odom", "base_link", (0.9 * SPEED * (t - 100.0), 0.0, 0.0)),
                ("/map", "ego/base_link", ego_at(0.4, t)),
            ];
            let mut bytes = if packed { Bytes { bytes: Vec::new(), packed } } else { cdr() };
            bytes.u32(all.len() as u32);
            for (parent, child, place) in all {
                bytes.header(t, parent).string(child).pose(place);
            }
            rig.send("/tf", (name, &text), t, &bytes);
        }
        let found = read(&rig.log(), None);
        assert!(said(&found, "from `map` to `base_link`"), "{:?}", found.warnings);
        assert!(said(&found, "differentiated"), "{:?}", found.warnings);
        close(&found.recording.ego().speed_mps, SPEED, ROWS - 1);
        assert!(found.recording.ego().y_m.iter().all(|y| y.abs() < 1e-6));
    }
}

#[test]
fn ego_is_told_from_the_objects_where_a_mapping_names_it() {
    let mut rig = Rig::new();
    for t in times() {
        let x = SPEED * (t - 100.0);
        let all = [(24, (x, 0.0, 0.0), 4.0, CAR), (31, (x + 40.0, 0.0, 0.0), 6.0, CAR)];
        rig.send("/carla/objects", OBJECTS, t, &objects(cdr(), t, &all));
    }
    let found = read(&rig.log(), Some("[mcap]\nego_object = 24"));
    close(&gaps(&found), 40.0 - 3.0 - 2.0, ROWS - 1);
    assert!(found.warnings.iter().any(|w| w.kind == WarningKind::Choice));
}
