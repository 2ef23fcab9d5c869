//! Writes a recording as a CARLA rig would have recorded it.

use super::{
    decisions::{self, DecisionKind, decisions},
    metadata,
};
use crate::error::IngestError;
use maveric_bag::{BagError, CdrWriter, Writer};
use maveric_domain::{DriveMeta, Recording, Scene, TraceRow, VehicleState};
use std::{io::Write, iter::Peekable};

/// Topic of ego's odometry.
pub(crate) const EGO_TOPIC: &str = "/carla/ego_vehicle/odometry";
/// Topic of the other vehicles.
pub(crate) const OBJECTS_TOPIC: &str = "/carla/ego_vehicle/objects";

/// Type name and full `ros2msg` text of ego's odometry, and of the list of the others.
const ODOMETRY: (&str, &str) = ("nav_msgs/msg/Odometry", include_str!("schemas/odometry.txt"));
const OBJECT_ARRAY: (&str, &str) =
    ("derived_object_msgs/msg/ObjectArray", include_str!("schemas/object_array.txt"));

/// The road's frame, and the one that moves with ego.
const MAP: &str = "map";
const EGO: &str = "ego_vehicle";
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
    out: impl Write,
) -> Result<(), IngestError> {
    write_mcap_with(recording, meta, &Beside::default(), out)
}

/// What a log holds beside the recording. Nothing of it but the note is read by `ingest`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Beside<'a> {
    /// What the automated car decided, a row for each of the recording's; empty for people. Becomes `foxglove.Log`
    /// messages on `/maveric/decisions`.
    pub trace: &'a [TraceRow],
    /// A file that belongs to the recording, by name and content; `application/octet-stream`.
    pub attached: Option<(&'a str, &'a [u8])>,
    /// What is to be said of the recording wherever it is read: a warning of [`crate::read_log`].
    pub note: Option<&'a str>,
}

/// Writes a recording as [`write_mcap`] does, with more beside it.
///
/// # Errors
/// [`IngestError::Write`] if `out` cannot be written; [`IngestError::WriteDrive`] if the trace is not the recording's.
pub fn write_mcap_with(
    recording: &Recording,
    meta: &DriveMeta,
    beside: &Beside<'_>,
    mut out: impl Write,
) -> Result<(), IngestError> {
    let (found, rows) = (beside.trace.len(), recording.rows());
    let refused =
        |reason: String| IngestError::WriteDrive { drive: meta.drive.to_string(), reason };
    if found != 0 && found != rows {
        return Err(refused(format!("its trace has {found} rows, its recording {rows}")));
    }
    write(recording, meta, beside, &mut out).map_err(|source| IngestError::Write { source })
}

/// A file under way.
struct File<'a> {
    writer: Writer<&'a mut dyn Write>,
    row: usize,
    time_ns: u64,
}

impl File<'_> {
    fn message(&mut self, channel_id: u16, bytes: &[u8]) -> Result<(), BagError> {
        self.writer.message(channel_id, self.row as u32, self.time_ns, bytes)
    }
}

fn write(
    recording: &Recording,
    meta: &DriveMeta,
    &Beside { trace, attached, note }: &Beside<'_>,
    out: &mut dyn Write,
) -> Result<(), BagError> {
    let mut file = File {
        writer: Writer::new(out, concat!("maveric ", env!("CARGO_PKG_VERSION")))?,
        row: 0,
        time_ns: 0,
    };
    file.writer.metadata(metadata::NAME, metadata::values(meta, recording, note))?;
    let mut channel = |topic: &str, (name, text): (&str, &str)| {
        file.writer.channel(topic, "cdr", (name, "ros2msg", text))
    };
    let ego_channel = channel(EGO_TOPIC, ODOMETRY)?;
    let objects_channel = channel(OBJECTS_TOPIC, OBJECT_ARRAY)?;
    let mut decisions = Decisions::new(&mut file, trace)?;
    let ego_yaw_rad = headings(recording);
    let mut bytes = CdrWriter::new();
    for ((row, yaw), scene) in ego_yaw_rad.into_iter().enumerate().zip(recording.scenes()) {
        let time_ns = (scene.time_s * 1e9).round() as i64;
        (file.row, file.time_ns) = (row, time_ns.max(0) as u64);
        bytes.restart();
        header(&mut bytes, time_ns);
        odometry(&mut bytes, &scene, yaw);
        file.message(ego_channel, bytes.bytes())?;
        bytes.restart();
        header(&mut bytes, time_ns);
        objects(&mut bytes, &scene, time_ns);
        file.message(objects_channel, bytes.bytes())?;
        decisions.row(&mut file, meta)?;
    }
    if let Some((name, content)) = attached {
        file.writer.attach(name, "application/octet-stream", content)?;
    }
    file.writer.finish()?;
    Ok(())
}

/// The decisions that are still to be written.
struct Decisions {
    channel: Option<u16>,
    rest: Peekable<std::vec::IntoIter<(usize, DecisionKind)>>,
}

impl Decisions {
    fn new(file: &mut File<'_>, trace: &[TraceRow]) -> Result<Self, BagError> {
        let channel = (!trace.is_empty()).then(|| {
            let (name, text) = decisions::SCHEMA;
            let schema = (name, "jsonschema", text);
            file.writer.channel(decisions::TOPIC, "json", schema)
        });
        Ok(Self { channel: channel.transpose()?, rest: decisions(trace).into_iter().peekable() })
    }

    fn row(&mut self, file: &mut File<'_>, meta: &DriveMeta) -> Result<(), BagError> {
        let Some(channel) = self.channel else {
            return Ok(());
        };
        while let Some((_, kind)) = self.rest.next_if(|next| next.0 == file.row) {
            let bytes = kind.message(meta.drive.as_str(), file.time_ns);
            file.message(channel, &bytes)?;
        }
        Ok(())
    }
}

/// Ego's direction of movement at each row, from the rows before and after; 0 at standstill.
fn headings(recording: &Recording) -> Vec<f64> {
    let ego = recording.ego();
    let last = recording.rows() - 1;
    let heading = |row: usize| {
        let (a, b) = (row.saturating_sub(1), (row + 1).min(last));
        let (dx, dy) = (ego.x_m[b] - ego.x_m[a], ego.y_m[b] - ego.y_m[a]);
        if ego.speed_mps[row].abs() < STILL_MPS { 0.0 } else { libm::atan2(dy, dx) }
    };
    (0..=last).map(heading).collect()
}

fn header(bytes: &mut CdrWriter, time_ns: i64) {
    bytes.u32(time_ns.div_euclid(1_000_000_000) as i32 as u32);
    bytes.u32(time_ns.rem_euclid(1_000_000_000) as u32);
    bytes.string(MAP);
}

fn pose(bytes: &mut CdrWriter, x_m: f64, y_m: f64, yaw_rad: f64) {
    bytes.f64s(&[x_m, y_m, 0.0]);
    bytes.f64s(&[0.0, 0.0, libm::sin(0.5 * yaw_rad), libm::cos(0.5 * yaw_rad)]);
}

fn odometry(bytes: &mut CdrWriter, scene: &Scene, yaw_rad: f64) {
    bytes.string(EGO);
    pose(bytes, scene.ego.x_m, scene.ego.y_m, yaw_rad);
    bytes.f64s(&[0.0; 36]);
    bytes.f64s(&[scene.ego.speed_mps, 0.0, 0.0, 0.0, 0.0, 0.0]);
    bytes.f64s(&[0.0; 36]);
}

fn objects(bytes: &mut CdrWriter, scene: &Scene, time_ns: i64) {
    bytes.u32(scene.vehicles.len() as u32);
    for vehicle in &scene.vehicles {
        object(bytes, vehicle, time_ns);
    }
}

fn object(bytes: &mut CdrWriter, vehicle: &VehicleState, time_ns: i64) {
    const TRACKED: u8 = 1;
    const BOX: u8 = 1;
    const CAR: u8 = 6;
    header(bytes, time_ns);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heading_is_where_ego_moves_from_the_row_before_to_the_row_after_and_none_at_standstill() {
        let recording = Recording::new(
            maveric_domain::Road::PAPER,
            20.0,
            (0..5).map(|i| f64::from(i) / 20.0).collect(),
            vec![0; 5],
            maveric_domain::EgoTrack {
                length_m: 4.8,
                x_m: vec![100.0, 103.0, 104.0, 104.5, 104.6],
                y_m: vec![0.0, 0.5, 1.5, 1.75, 1.8],
                speed_mps: vec![20.0, 20.0, 20.0, 20.0, STILL_MPS - 0.01],
            },
            Vec::new(),
        )
        .unwrap();
        let expected =
            [0.5_f64.atan2(3.0), 1.5_f64.atan2(4.0), 1.25_f64.atan2(1.5), 0.3_f64.atan2(0.6), 0.0];
        for (found, expected) in headings(&recording).iter().zip(expected) {
            assert!((found - expected).abs() < 1e-9, "{found} instead of {expected}");
        }
    }
}
