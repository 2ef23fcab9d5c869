//! Rigs out of the box: synthetic logs with the definitions of the real messages.

use maveric_domain::Drive;
use maveric_ingest::{
    IngestError, IngestSettings, Ingested, Mapping, WarningKind, inspect, read_log,
};
use mcap::{WriteOptions, Writer, records::MessageHeader};
use std::{collections::BTreeMap, io::Cursor, path::Path};

pub(super) const ODOMETRY: (&str, &str) = (
    "nav_msgs/msg/Odometry",
    include_str!("definitions/odometry.txt"),
);
const POSE: (&str, &str) = (
    "geometry_msgs/msg/PoseStamped",
    include_str!("definitions/posestamped.txt"),
);
const TWIST: (&str, &str) = (
    "geometry_msgs/msg/TwistStamped",
    include_str!("definitions/twiststamped.txt"),
);
const FIX: (&str, &str) = (
    "sensor_msgs/msg/NavSatFix",
    include_str!("definitions/navsatfix.txt"),
);
pub(super) const OBJECTS: (&str, &str) = (
    "derived_object_msgs/msg/ObjectArray",
    include_str!("definitions/objectarray.txt"),
);
const TRACKED: (&str, &str) = (
    "autoware_perception_msgs/msg/TrackedObjects",
    include_str!("definitions/trackedobjects.txt"),
);
const VELOCITY: (&str, &str) = (
    "autoware_vehicle_msgs/msg/VelocityReport",
    include_str!("definitions/velocityreport.txt"),
);

/// Half a minute at 20 Hz.
pub(super) const ROWS: usize = 600;
pub(super) const SPEED: f64 = 20.0;

/// Bytes of a message, little-endian; `packed` is ROS 1.
pub(super) struct Bytes {
    bytes: Vec<u8>,
    packed: bool,
}

impl Bytes {
    fn put(&mut self, value: &[u8]) -> &mut Self {
        let head = if self.packed { 0 } else { 4 };
        while !self.packed && !(self.bytes.len() - head).is_multiple_of(value.len()) {
            self.bytes.push(0);
        }
        self.bytes.extend(value);
        self
    }
    fn u8(&mut self, value: u8) -> &mut Self {
        self.put(&[value])
    }
    fn u16(&mut self, value: u16) -> &mut Self {
        self.put(&value.to_le_bytes())
    }
    fn u32(&mut self, value: u32) -> &mut Self {
        self.put(&value.to_le_bytes())
    }
    fn f32(&mut self, value: f64) -> &mut Self {
        self.put(&(value as f32).to_le_bytes())
    }
    fn f64s(&mut self, values: &[f64]) -> &mut Self {
        for v in values {
            self.put(&v.to_le_bytes());
        }
        self
    }
    pub(super) fn string(&mut self, text: &str) -> &mut Self {
        let end = if self.packed { "" } else { "\0" };
        self.u32((text.len() + end.len()) as u32);
        self.bytes.extend(text.bytes().chain(end.bytes()));
        self
    }
    pub(super) fn header(&mut self, t: f64, frame: &str) -> &mut Self {
        if self.packed {
            self.u32(7);
        }
        let ns = (t * 1e9).round() as u64;
        self.u32((ns / 1_000_000_000) as u32)
            .u32((ns % 1_000_000_000) as u32);
        self.string(frame)
    }
    pub(super) fn pose(&mut self, (x, y, yaw): Place) -> &mut Self {
        self.f64s(&[x, y, 0.0, 0.0, 0.0, (yaw / 2.0).sin(), (yaw / 2.0).cos()])
    }
    pub(super) fn covariance(&mut self) -> &mut Self {
        self.f64s(&[0.0; 36])
    }
    pub(super) fn twist(&mut self, vx: f64, vy: f64) -> &mut Self {
        self.f64s(&[vx, vy, 0.0, 0.0, 0.0, 0.0])
    }
}

pub(super) fn cdr() -> Bytes {
    Bytes {
        bytes: vec![0, 1, 0, 0],
        packed: false,
    }
}

/// x, y and heading.
pub(super) type Place = (f64, f64, f64);

pub(super) struct Rig {
    pub(super) out: Writer<Cursor<Vec<u8>>>,
    pub(super) channels: BTreeMap<String, u16>,
}

impl Rig {
    pub(super) fn new() -> Self {
        Self {
            out: WriteOptions::new().create(Cursor::new(Vec::new())).unwrap(),
            channels: BTreeMap::new(),
        }
    }

    pub(super) fn send(&mut self, topic: &str, (name, text): (&str, &str), t: f64, bytes: &Bytes) {
        let encodings = if bytes.packed {
            ("ros1msg", "ros1")
        } else {
            ("ros2msg", "cdr")
        };
        self.send_as(
            topic,
            (name, encodings.0, text.as_bytes()),
            encodings.1,
            t,
            &bytes.bytes,
        );
    }

    pub(super) fn send_as(
        &mut self,
        topic: &str,
        schema: (&str, &str, &[u8]),
        encoding: &str,
        t: f64,
        bytes: &[u8],
    ) {
        let out = &mut self.out;
        let channel_id = *self.channels.entry(topic.to_owned()).or_insert_with(|| {
            let id = out.add_schema(schema.0, schema.1, schema.2).unwrap();
            out.add_channel(id, topic, encoding, &BTreeMap::new())
                .unwrap()
        });
        let log_time = ((t + 0.01) * 1e9) as u64;
        let head = MessageHeader {
            channel_id,
            sequence: 0,
            log_time,
            publish_time: log_time,
        };
        out.write_to_known_channel(&head, bytes).unwrap();
    }

    pub(super) fn log(mut self) -> Vec<u8> {
        self.out.finish().unwrap();
        self.out.into_inner().into_inner()
    }
}

pub(super) fn times() -> impl Iterator<Item = f64> {
    (0..ROWS).map(|i| 100.0 + i as f64 / 20.0)
}

/// Along a straight road that points to `yaw`: a place `along` and `left` of its start.
pub(super) fn road(yaw: f64, along: f64, left: f64) -> Place {
    let (sin, cos) = yaw.sin_cos();
    (
        500.0 + along * cos - left * sin,
        -300.0 + along * sin + left * cos,
        yaw,
    )
}

pub(super) fn ego_at(yaw: f64, t: f64) -> Place {
    road(yaw, SPEED * (t - 100.0), 0.0)
}

pub(super) fn odometry(t: f64, place: Place, vx: f64, vy: f64) -> Bytes {
    let mut bytes = cdr();
    bytes.header(t, "map").string("ego_vehicle");
    bytes.pose(place).covariance().twist(vx, vy).covariance();
    bytes
}

/// Number, place, length, class; velocity is along the heading, in the frame of the map.
pub(super) fn objects(bytes: Bytes, t: f64, all: &[(u32, Place, f64, u8)]) -> Bytes {
    objects_in("map", bytes, t, all)
}

/// The same in some frame.
pub(super) fn objects_in(
    frame: &str,
    mut bytes: Bytes,
    t: f64,
    all: &[(u32, Place, f64, u8)],
) -> Bytes {
    bytes.header(t, frame).u32(all.len() as u32);
    for &(id, place, length, class) in all {
        bytes.header(t, frame).u32(id).u8(0).u8(1).pose(place);
        bytes
            .twist(SPEED * place.2.cos(), SPEED * place.2.sin())
            .f64s(&[0.0; 6]);
        bytes
            .u32(0)
            .u8(1)
            .u32(3)
            .f64s(&[length, 2.0, 1.5])
            .u32(0)
            .u8(class)
            .u8(255)
            .u32(1);
    }
    bytes
}

pub(super) fn read(log: &[u8], mapping: Option<&str>) -> Ingested {
    try_read(log, mapping).unwrap()
}

pub(super) fn try_read(log: &[u8], mapping: Option<&str>) -> Result<Ingested, IngestError> {
    let file = tempfile::Builder::new().suffix(".mcap").tempfile().unwrap();
    std::fs::write(file.path(), log).unwrap();
    assert!(
        inspect(file.path())
            .unwrap()
            .channels
            .iter()
            .all(|c| c.decodable)
    );
    let settings = IngestSettings {
        mapping: mapping.map(|text| Mapping::from_toml(text, Path::new("given.toml")).unwrap()),
        ..IngestSettings::default()
    };
    read_log(file.path(), &settings).map(|mut drives| drives.remove(0))
}

/// Gap to the lead vehicle at every row where there is one.
pub(super) fn gaps(found: &Ingested) -> Vec<f64> {
    let drive = Drive::from_recording(found.meta.clone(), &found.recording).unwrap();
    let rows = drive.rows();
    let present = rows.lead_present.iter().zip(&rows.lead_dx_m);
    present.filter(|p| *p.0).map(|p| *p.1).collect()
}

pub(super) fn close(found: &[f64], expected: f64, rows: usize) {
    assert!(found.len() >= rows, "{} of {rows} rows", found.len());
    let worst = found
        .iter()
        .map(|v| (v - expected).abs())
        .fold(0.0, f64::max);
    assert!(worst < 1e-3, "{worst} off {expected}");
}

pub(super) fn said(found: &Ingested, what: &str) -> bool {
    found.warnings.iter().any(|w| w.what.contains(what))
}

pub(super) const CAR: u8 = 6;

#[test]
fn carla_with_ego_among_all_objects_in_any_direction() {
    for yaw in [0.0, 2.5, -1.2] {
        let mut rig = Rig::new();
        for t in times() {
            let along = SPEED * (t - 100.0);
            rig.send(
                "/carla/hero/odometry",
                ODOMETRY,
                t,
                &odometry(t, ego_at(yaw, t), SPEED, 0.0),
            );
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
fn twists_in_either_frame_give_the_speed() {
    let yaw = 3.0_f64;
    for in_map in [false, true] {
        let mut rig = Rig::new();
        for t in times() {
            let (vx, vy) = if in_map {
                (SPEED * yaw.cos(), SPEED * yaw.sin())
            } else {
                (SPEED, 0.0)
            };
            rig.send("/odom", ODOMETRY, t, &odometry(t, ego_at(yaw, t), vx, vy));
        }
        let found = read(&rig.log(), None);
        close(&found.recording.ego().speed_mps, SPEED, ROWS - 1);
        assert_eq!(said(&found, "frame of the map"), in_map);
    }
}

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
        for (uuid, place, label) in [
            (0xab, road(yaw, along + 30.0, 0.0), 1),
            (0xac, road(yaw, along + 9.0, 0.0), 7),
        ] {
            (0..16).for_each(|i| {
                bytes.u8(uuid ^ i);
            });
            bytes.f32(0.9).u32(1).u8(label).f32(1.0);
            bytes
                .pose(place)
                .covariance()
                .twist(SPEED, 0.0)
                .covariance();
            bytes.twist(0.0, 0.0).covariance().u8(2).u8(0);
            bytes.u8(0).u32(0).f64s(&[5.0, 2.0, 1.5]);
        }
        rig.send(
            "/perception/object_recognition/tracking/objects",
            TRACKED,
            t,
            &bytes,
        );
    }
    let found = read(&rig.log(), None);
    assert_eq!(
        found.recording.others().len(),
        1,
        "the pedestrian is no vehicle"
    );
    let lead = &found.recording.others()[0];
    close(&lead.speed_mps, SPEED, ROWS - 1);
    // Autoware does not say how long ego is.
    close(&gaps(&found), 30.0 - 2.5 - 4.7 / 2.0, ROWS - 1);
    assert!(said(&found, "ego's length is not known"));
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
                bytes
                    .u8(0)
                    .u16(1)
                    .f64s(&[0.0, degrees, 30.0])
                    .f64s(&[0.0; 9])
                    .u8(0);
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
        assert!(
            (x[200] - x[0] - SPEED * 10.0).abs() < 1e-3,
            "{}",
            x[200] - x[0]
        );
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
        assert!(
            !said(&found, "differentiated"),
            "{case}: {:?}",
            found.warnings
        );
        let ego = found.recording.ego();
        assert!(ego.speed_mps.len() > ROWS - 5, "{case}");
        for (time, v) in found.recording.time_s().iter().zip(&ego.speed_mps) {
            let expected = speed_at(100.0 + time);
            assert!(
                (v - expected).abs() < 0.05,
                "{case}: {v} at {time}, expected {expected}"
            );
        }
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
            if packed {
                "time"
            } else {
                "builtin_interfaces/Time"
            }
        );
        let name = if packed {
            "tf2_msgs/TFMessage"
        } else {
            "tf2_msgs/msg/TFMessage"
        };
        let mut rig = Rig::new();
        for t in times() {
            let all = [
                ("base_link", "camera", (1.0, 0.0, 0.0)),
                // Drifts: passed over once a frame of the map is there.
                ("odom", "base_link", (0.9 * SPEED * (t - 100.0), 0.0, 0.0)),
                ("/map", "ego/base_link", ego_at(0.4, t)),
            ];
            let mut bytes = if packed {
                Bytes {
                    bytes: Vec::new(),
                    packed,
                }
            } else {
                cdr()
            };
            bytes.u32(all.len() as u32);
            for (parent, child, place) in all {
                bytes.header(t, parent).string(child).pose(place);
            }
            rig.send("/tf", (name, &text), t, &bytes);
        }
        let found = read(&rig.log(), None);
        assert!(
            said(&found, "from `map` to `base_link`"),
            "{:?}",
            found.warnings
        );
        assert!(said(&found, "differentiated"), "{:?}", found.warnings);
        close(&found.recording.ego().speed_mps, SPEED, ROWS - 1);
        assert!(found.recording.ego().y_m.iter().all(|y| y.abs() < 1e-6));
    }
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
        let packed = || Bytes {
            bytes: Vec::new(),
            packed: true,
        };
        let mut ego = packed();
        ego.header(t, "map")
            .string("ego")
            .pose((SPEED * (t - 100.0), 0.0, 0.0));
        ego.covariance().twist(SPEED, 0.0).covariance();
        rig.send(
            "/carla/ego_vehicle/odometry",
            ("nav_msgs/Odometry", &of_ego),
            t,
            &ego,
        );
        let list = objects(packed(), t, &lead(t, 0.0));
        rig.send(
            "/carla/ego_vehicle/objects",
            ("derived_object_msgs/ObjectArray", &of_objects),
            t,
            &list,
        );
    }
    close(
        &gaps(&read(&rig.log(), None)),
        25.0 - 2.5 - 4.7 / 2.0,
        ROWS - 1,
    );

    // JSON of a rig's own types, which a mapping explains; the frame is left-handed.
    let mut rig = Rig::new();
    for t in times() {
        let x = SPEED * (t - 100.0);
        let ego = format!(r#"{{"t":{t},"at":{{"x":{x},"y":-2.0}},"heading":0.0,"speed":{SPEED}}}"#);
        rig.send_as(
            "/me",
            ("my/Ego", "jsonschema", b"{}"),
            "json",
            t,
            ego.as_bytes(),
        );
        let cars = format!(
            r#"{{"cars":[{{"id":5,"x":{},"y":-2.0,"v":{SPEED},"len":5}},{{"id":6,"x":{x},"y":-5.7,"v":1,"len":5}}],"t":{t}}}"#,
            x + 25.0
        );
        rig.send_as(
            "/cars",
            ("my/Cars", "jsonschema", b"{}"),
            "json",
            t,
            cars.as_bytes(),
        );
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
    let beside = found
        .recording
        .others()
        .iter()
        .find(|o| o.id.0 == 6)
        .unwrap();
    // At its right in the left-handed frame's sense of y: in lane 1 after the turn.
    assert!((beside.y_m[0] - 3.7).abs() < 1e-9, "{}", beside.y_m[0]);
}

#[test]
fn ego_is_told_from_the_objects_where_a_mapping_names_it() {
    let mut rig = Rig::new();
    for t in times() {
        let x = SPEED * (t - 100.0);
        let all = [
            (24, (x, 0.0, 0.0), 4.0, CAR),
            (31, (x + 40.0, 0.0, 0.0), 6.0, CAR),
        ];
        rig.send("/carla/objects", OBJECTS, t, &objects(cdr(), t, &all));
    }
    let found = read(&rig.log(), Some("[mcap]\nego_object = 24"));
    close(&gaps(&found), 40.0 - 3.0 - 2.0, ROWS - 1);
    assert!(found.warnings.iter().any(|w| w.kind == WarningKind::Choice));
}

#[test]
fn one_drive_of_a_recording_that_was_split() {
    let whole = super::bytes_of(&super::recording(false));
    let expected = read(&whole, None);
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("run");
    std::fs::create_dir(&folder).unwrap();
    let minute = 60_000_000_000_u64;
    for part in 0..3_u64 {
        let within = part * minute / 3..(part + 1) * minute / 3;
        let bytes = super::rewritten(&whole, WriteOptions::new(), |mut message| {
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
    let found = read_log(&folder, &IngestSettings::default())
        .unwrap()
        .remove(0);
    assert_eq!(found.meta, expected.meta);
    assert_eq!(found.recording, expected.recording);
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    // A part that is damaged refuses the whole, or is salvaged by itself.
    let second = folder.join("run_1.mcap");
    let bytes = std::fs::read(&second).unwrap();
    std::fs::write(&second, &bytes[..bytes.len() / 2]).unwrap();
    assert!(read_log(&folder, &IngestSettings::default()).is_err());
    let recover = IngestSettings {
        recover: true,
        ..IngestSettings::default()
    };
    let found = read_log(&folder, &recover).unwrap().remove(0);
    assert!(found.recording.rows() > 800 && found.recording.rows() < 1200);
    assert!(
        found
            .warnings
            .iter()
            .any(|w| w.file == second && w.kind == WarningKind::Damage)
    );
}
