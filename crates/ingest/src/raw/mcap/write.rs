//! Writes a recording as a CARLA rig would have recorded it.

use super::metadata;
use crate::{
    error::IngestError,
    raw::ros2::{cdr, schemas},
};
use maveric_domain::{DriveMeta, Recording, Scene, VehicleState};
use mcap::{Compression, WriteOptions, records};
use std::{
    collections::BTreeMap,
    io::{Seek, Write},
};

/// Topic of ego's odometry.
pub(crate) const EGO_TOPIC: &str = "/carla/ego_vehicle/odometry";
/// Topic of the other vehicles.
pub(crate) const OBJECTS_TOPIC: &str = "/carla/ego_vehicle/objects";

/// Width and height that vehicles are given, in m: recordings do not say them.
const WIDTH_M: f64 = 1.9;
const HEIGHT_M: f64 = 1.5;
/// Speed below which a movement has no direction, in m/s.
const STILL_MPS: f64 = 0.5;

/// Writes a recording as ROS 2 MCAP: `nav_msgs/Odometry` of ego and `derived_object_msgs/ObjectArray` of the others.
///
/// Messages are plain little-endian CDR with full `ros2msg` schemas in zstd chunks; header stamp and time of
/// receipt are the recording's time. Poses are of vehicle centres in the frame `map`, which is the road frame; ego's
/// twist is in its own frame, that of the others in the map's. Headings follow the positions. The drive
/// (ids, condition, road, rate) is in a metadata record `maveric.drive` ahead of the messages, so that a recording
/// that is cut off still knows whose it is. The same recording gives the same bytes.
///
/// # Errors
/// [`IngestError::Write`] if `out` cannot be written.
pub fn write_mcap(
    recording: &Recording,
    meta: &DriveMeta,
    out: impl Write + Seek,
) -> Result<(), IngestError> {
    write(recording, meta, out).map_err(|source| IngestError::Write { source })
}

fn write(
    recording: &Recording,
    meta: &DriveMeta,
    out: impl Write + Seek,
) -> Result<(), mcap::McapError> {
    let mut file = WriteOptions::new()
        .profile("ros2")
        .library(concat!("maveric ", env!("CARGO_PKG_VERSION")))
        .compression(Some(Compression::Zstd))
        // More threads would be faster, but the bytes would depend on them.
        .compression_threads(0)
        .create(out)?;
    file.write_metadata(&records::Metadata {
        name: metadata::NAME.to_owned(),
        metadata: metadata::values(meta, recording),
    })?;
    let mut channel = |topic: &str, (name, text): (&str, &str)| {
        let schema = file.add_schema(name, "ros2msg", text.as_bytes())?;
        file.add_channel(schema, topic, "cdr", &BTreeMap::new())
    };
    let channels = [
        channel(EGO_TOPIC, schemas::ODOMETRY)?,
        channel(OBJECTS_TOPIC, schemas::OBJECT_ARRAY)?,
    ];
    let ego_yaw_rad = headings(recording);
    let mut bytes = cdr::Writer::new();
    for (row, yaw) in ego_yaw_rad.into_iter().enumerate() {
        // Every row has a scene.
        let Some(scene) = recording.scene(row) else {
            break;
        };
        let time_ns = (scene.time_s * 1e9).round() as i64;
        for channel_id in channels {
            bytes.restart();
            header(&mut bytes, time_ns, "map");
            if channel_id == channels[0] {
                odometry(&mut bytes, &scene, yaw);
            } else {
                objects(&mut bytes, &scene, time_ns);
            }
            let head = records::MessageHeader {
                channel_id,
                sequence: row as u32,
                log_time: time_ns.max(0) as u64,
                publish_time: time_ns.max(0) as u64,
            };
            file.write_to_known_channel(&head, bytes.bytes())?;
        }
    }
    file.finish()?;
    Ok(())
}

/// Ego's direction of movement at each row, from the rows before and after; 0 at standstill.
fn headings(recording: &Recording) -> Vec<f64> {
    let ego = recording.ego();
    let last = recording.rows() - 1;
    let heading = |row: usize| {
        let (a, b) = (row.saturating_sub(1), (row + 1).min(last));
        let (dx, dy) = (ego.x_m[b] - ego.x_m[a], ego.y_m[b] - ego.y_m[a]);
        if ego.speed_mps[row].abs() < STILL_MPS {
            0.0
        } else {
            dy.atan2(dx)
        }
    };
    (0..=last).map(heading).collect()
}

fn header(bytes: &mut cdr::Writer, time_ns: i64, frame: &str) {
    bytes.u32(time_ns.div_euclid(1_000_000_000) as i32 as u32);
    bytes.u32(time_ns.rem_euclid(1_000_000_000) as u32);
    bytes.string(frame);
}

fn pose(bytes: &mut cdr::Writer, x_m: f64, y_m: f64, yaw_rad: f64) {
    bytes.f64s(&[x_m, y_m, 0.0]);
    bytes.f64s(&[0.0, 0.0, (0.5 * yaw_rad).sin(), (0.5 * yaw_rad).cos()]);
}

fn odometry(bytes: &mut cdr::Writer, scene: &Scene, yaw_rad: f64) {
    bytes.string("ego_vehicle");
    pose(bytes, scene.ego.x_m, scene.ego.y_m, yaw_rad);
    bytes.f64s(&[0.0; 36]);
    bytes.f64s(&[scene.ego.speed_mps, 0.0, 0.0, 0.0, 0.0, 0.0]);
    bytes.f64s(&[0.0; 36]);
}

fn objects(bytes: &mut cdr::Writer, scene: &Scene, time_ns: i64) {
    bytes.u32(scene.vehicles.len() as u32);
    for vehicle in &scene.vehicles {
        object(bytes, vehicle, time_ns);
    }
}

fn object(bytes: &mut cdr::Writer, vehicle: &VehicleState, time_ns: i64) {
    const TRACKED: u8 = 1;
    const BOX: u8 = 1;
    const CAR: u8 = 6;
    header(bytes, time_ns, "map");
    bytes.u32(vehicle.id.0);
    bytes.u8(TRACKED);
    bytes.u8(1);
    pose(bytes, vehicle.x_m, vehicle.y_m, 0.0);
    bytes.f64s(&[vehicle.speed_mps, 0.0, 0.0, 0.0, 0.0, 0.0]);
    bytes.f64s(&[0.0; 6]);
    bytes.u32(0);
    bytes.u8(BOX);
    bytes.u32(3);
    bytes.f64s(&[vehicle.length_m, WIDTH_M, HEIGHT_M]);
    bytes.u32(0);
    bytes.u8(CAR);
    bytes.u8(255);
    bytes.u32(1);
}
