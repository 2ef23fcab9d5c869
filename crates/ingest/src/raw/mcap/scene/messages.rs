//! The messages, field for field as Foxglove's schemas have them.

use serde::Serialize;

/// Lengths, speeds and shares with four decimals: a tenth of a millimetre, and short text.
pub(super) fn short(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}

#[derive(Debug, Clone, Copy, Default, Serialize)]
pub(super) struct Time {
    sec: u64,
    nsec: u32,
}

impl Time {
    pub(super) fn from_nanos(time_ns: u64) -> Self {
        Self {
            sec: time_ns / 1_000_000_000,
            nsec: (time_ns % 1_000_000_000) as u32,
        }
    }
}

#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Point {
    x: f64,
    y: f64,
    z: f64,
}

impl Point {
    pub(super) fn new(x: f64, y: f64, z: f64) -> Self {
        let [x, y, z] = [x, y, z].map(short);
        Self { x, y, z }
    }
}

#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Quaternion {
    x: f64,
    y: f64,
    // Six decimals: over 18 km of road four would move what is far ahead by a metre.
    z: f64,
    w: f64,
}

#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Pose {
    pub(super) position: Point,
    pub(super) orientation: Quaternion,
}

impl Pose {
    pub(super) fn at(x: f64, y: f64, z: f64) -> Self {
        Self::turned(x, y, z, 0.0)
    }

    pub(super) fn turned(x: f64, y: f64, z: f64, yaw_rad: f64) -> Self {
        let short = |value: f64| (value * 1e6).round() / 1e6;
        Self {
            position: Point::new(x, y, z),
            orientation: Quaternion {
                x: 0.0,
                y: 0.0,
                z: short(libm::sin(0.5 * yaw_rad)),
                w: short(libm::cos(0.5 * yaw_rad)),
            },
        }
    }
}

#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Color {
    r: f64,
    g: f64,
    b: f64,
    a: f64,
}

impl Color {
    pub(super) const fn rgb(r: f64, g: f64, b: f64) -> Self {
        Self { r, g, b, a: 1.0 }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct Cube {
    pub(super) pose: Pose,
    pub(super) size: Point,
    pub(super) color: Color,
}

#[derive(Debug, Serialize)]
pub(super) struct Line {
    /// 0 is a strip, 2 a list of pieces.
    r#type: u8,
    pose: Pose,
    thickness: f64,
    scale_invariant: bool,
    points: Vec<Point>,
    color: Color,
    colors: [Color; 0],
    indices: [u32; 0],
}

impl Line {
    pub(super) fn new(pieces: bool, thickness: f64, points: Vec<Point>, color: Color) -> Self {
        Self {
            r#type: if pieces { 2 } else { 0 },
            pose: Pose::at(0.0, 0.0, 0.0),
            thickness,
            scale_invariant: false,
            points,
            color,
            colors: [],
            indices: [],
        }
    }
}

#[derive(Debug, Serialize)]
#[expect(clippy::struct_field_names, reason = "the schema's name")]
pub(super) struct Text {
    pose: Pose,
    billboard: bool,
    font_size: f64,
    scale_invariant: bool,
    color: Color,
    text: &'static str,
}

impl Text {
    /// A text that hovers over the origin of its frame and faces the viewer.
    pub(super) fn above(text: &'static str, height_m: f64, color: Color) -> Self {
        Self {
            pose: Pose::at(0.0, 0.0, height_m),
            billboard: true,
            font_size: 1.5,
            scale_invariant: false,
            color,
            text,
        }
    }
}

#[derive(Debug, Default, Serialize)]
pub(super) struct Entity {
    timestamp: Time,
    frame_id: &'static str,
    id: &'static str,
    lifetime: Time,
    pub(super) frame_locked: bool,
    metadata: [u8; 0],
    arrows: [u8; 0],
    pub(super) cubes: Vec<Cube>,
    spheres: [u8; 0],
    cylinders: [u8; 0],
    pub(super) lines: Vec<Line>,
    triangles: [u8; 0],
    pub(super) texts: Vec<Text>,
    models: [u8; 0],
}

impl Entity {
    /// An entity without anything in it, that stays until it is replaced.
    pub(super) fn new(timestamp: Time, frame_id: &'static str, id: &'static str) -> Self {
        Self {
            timestamp,
            frame_id,
            id,
            ..Self::default()
        }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct Deletion {
    timestamp: Time,
    /// 1 is everything on the topic.
    r#type: u8,
    id: &'static str,
}

impl Deletion {
    pub(super) fn all(timestamp: Time) -> Self {
        Self {
            timestamp,
            r#type: 1,
            id: "",
        }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct SceneUpdate {
    pub(super) deletions: Vec<Deletion>,
    pub(super) entities: Vec<Entity>,
}

#[derive(Debug, Serialize)]
pub(super) struct FrameTransform {
    pub(super) timestamp: Time,
    pub(super) parent_frame_id: &'static str,
    pub(super) child_frame_id: &'static str,
    pub(super) translation: Point,
    pub(super) rotation: Quaternion,
}

#[derive(Debug, Serialize)]
pub(super) struct Log<'a> {
    pub(super) timestamp: Time,
    pub(super) level: u8,
    pub(super) message: &'static str,
    pub(super) name: &'static str,
    pub(super) file: &'a str,
    pub(super) line: u32,
}

#[derive(Debug, Serialize)]
pub(super) struct Signals {
    pub(super) timestamp: Time,
    pub(super) speed_mps: f64,
    pub(super) lane: u8,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) gap_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) lead_speed_mps: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) asked_speed_mps: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) asked_gap_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) lane_wish: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) acceleration_mps2: Option<f64>,
}
