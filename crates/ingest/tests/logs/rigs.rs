//! Rigs out of the box: synthetic logs with the definitions of the real messages.

mod ego;
mod messages;
mod speeds;

use super::mapped::drive_of;
use maveric_ingest::{
    IngestError, IngestSettings, Ingested, Mapping, WarningKind, inspect, read_log,
};
use mcap::{WriteOptions, Writer, records::MessageHeader};
use std::{collections::BTreeMap, io::Cursor, path::Path};

pub(super) const ODOMETRY: (&str, &str) =
    ("nav_msgs/msg/Odometry", include_str!("definitions/odometry.txt"));
const POSE: (&str, &str) =
    ("geometry_msgs/msg/PoseStamped", include_str!("definitions/posestamped.txt"));
const TWIST: (&str, &str) =
    ("geometry_msgs/msg/TwistStamped", include_str!("definitions/twiststamped.txt"));
const FIX: (&str, &str) = ("sensor_msgs/msg/NavSatFix", include_str!("definitions/navsatfix.txt"));
pub(super) const OBJECTS: (&str, &str) =
    ("derived_object_msgs/msg/ObjectArray", include_str!("definitions/objectarray.txt"));
const TRACKED: (&str, &str) =
    ("autoware_perception_msgs/msg/TrackedObjects", include_str!("definitions/trackedobjects.txt"));
const VELOCITY: (&str, &str) =
    ("autoware_vehicle_msgs/msg/VelocityReport", include_str!("definitions/velocityreport.txt"));

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
        self.u32((ns / 1_000_000_000) as u32).u32((ns % 1_000_000_000) as u32);
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
    Bytes { bytes: vec![0, 1, 0, 0], packed: false }
}

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
        let encodings = if bytes.packed { ("ros1msg", "ros1") } else { ("ros2msg", "cdr") };
        self.send_as(topic, (name, encodings.0, text.as_bytes()), encodings.1, t, &bytes.bytes);
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
            out.add_channel(id, topic, encoding, &BTreeMap::new()).unwrap()
        });
        let log_time = ((t + 0.01) * 1e9) as u64;
        let head = MessageHeader { channel_id, sequence: 0, log_time, publish_time: log_time };
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
    (500.0 + along * cos - left * sin, -300.0 + along * sin + left * cos, yaw)
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
        bytes.twist(SPEED * place.2.cos(), SPEED * place.2.sin()).f64s(&[0.0; 6]);
        bytes.u32(0).u8(1).u32(3).f64s(&[length, 2.0, 1.5]).u32(0).u8(class).u8(255).u32(1);
    }
    bytes
}

pub(super) fn read(log: &[u8], mapping: Option<&str>) -> Ingested {
    try_read(log, mapping).unwrap()
}

pub(super) fn try_read(log: &[u8], mapping: Option<&str>) -> Result<Ingested, IngestError> {
    let file = tempfile::Builder::new().suffix(".mcap").tempfile().unwrap();
    std::fs::write(file.path(), log).unwrap();
    assert!(inspect(file.path()).unwrap().channels.iter().all(|c| c.decodable));
    let settings = IngestSettings {
        mapping: mapping.map(|text| Mapping::from_toml(text, Path::new("given.toml")).unwrap()),
        ..IngestSettings::default()
    };
    read_log(file.path(), &settings).map(|mut drives| drives.remove(0))
}

/// Gap to the lead vehicle at every row where there is one.
pub(super) fn gaps(found: &Ingested) -> Vec<f64> {
    let drive = drive_of(found);
    let rows = drive.rows();
    let present = rows.lead_present.iter().zip(&rows.lead_dx_m);
    present.filter(|p| *p.0).map(|p| *p.1).collect()
}

pub(super) fn close(found: &[f64], expected: f64, rows: usize) {
    assert!(found.len() >= rows, "{} of {rows} rows", found.len());
    let worst = found.iter().map(|v| (v - expected).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-3, "{worst} off {expected}");
}

pub(super) fn said(found: &Ingested, what: &str) -> bool {
    found.warnings.iter().any(|w| w.what.contains(what))
}

pub(super) const CAR: u8 = 6;
