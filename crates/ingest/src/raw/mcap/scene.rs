//! A scene beside the recording, for Foxglove and Lichtblick: cars, lanes, planned path, interventions, signals.
//!
//! Messages are JSON with Foxglove's own schemas. What stays is written once, on a topic of its own, and each message of
//! the other topics holds all that its topic shows, so that a viewer that jumps in time is right at once.

mod messages;

use super::decisions::DecisionKind;
use maveric_domain::{Drive, LaneActivity, Recording, Road, Scene, TraceRow};
use messages::{
    Color, Cube, Deletion, Entity, FrameTransform, Line, Log, Point, Pose, SceneUpdate, Signals,
    Text, Time, short,
};

pub(super) const STATIC: Channel = Channel::scene("/maveric/scene/road");
pub(super) const CARS: Channel = Channel::scene("/maveric/scene/cars");
pub(super) const PLAN: Channel = Channel::scene("/maveric/scene/plan");
pub(super) const FRAMES: Channel = Channel {
    topic: "/maveric/frames",
    schema: (
        "foxglove.FrameTransform",
        include_str!("scene/schemas/FrameTransform.json"),
    ),
};
pub(super) const SIGNALS: Channel = Channel {
    topic: "/maveric/signals",
    schema: (
        "maveric.Signals",
        include_str!("scene/schemas/Signals.json"),
    ),
};
pub(super) const DECISIONS: Channel = Channel {
    topic: super::decisions::TOPIC,
    schema: ("foxglove.Log", include_str!("scene/schemas/Log.json")),
};

/// A channel of JSON messages.
#[derive(Debug, Clone, Copy)]
pub(super) struct Channel {
    pub(super) topic: &'static str,
    /// Name and text.
    pub(super) schema: (&'static str, &'static str),
}

impl Channel {
    const fn scene(topic: &'static str) -> Self {
        let schema = (
            "foxglove.SceneUpdate",
            include_str!("scene/schemas/SceneUpdate.json"),
        );
        Self { topic, schema }
    }
}

/// The road's frame, and the one that moves with ego.
pub(super) const MAP: &str = "map";
pub(super) const EGO: &str = "ego_vehicle";
/// Cars further away are not shown, in m.
const SIGHT_M: f64 = 250.0;
/// Rows a second at which things that move are written, at most.
pub(super) const SCENE_RATE_HZ: f64 = 10.0;
/// Lane markings: a dash of 3 m every 12 m.
const DASH_M: (f64, f64) = (3.0, 12.0);
const ROAD_AHEAD_M: f64 = 500.0;
/// Width and height that vehicles are given, in m: recordings do not say them.
pub(super) const WIDTH_M: f64 = 1.9;
pub(super) const HEIGHT_M: f64 = 1.5;

const EGO_COLOUR: Color = Color::rgb(0.53, 0.18, 0.45);
const REFERENCE_COLOUR: Color = Color::rgb(0.35, 0.35, 0.35);
const CAR_COLOUR: Color = Color::rgb(0.75, 0.75, 0.75);
const LANE_COLOUR: Color = Color::rgb(0.6, 0.6, 0.6);
const ALARM_COLOUR: Color = Color::rgb(0.85, 0.15, 0.1);

fn json(message: &impl serde::Serialize) -> Vec<u8> {
    // Structs of numbers and strings: there is nothing that JSON could refuse.
    serde_json::to_vec(message).unwrap_or_default()
}

/// A vehicle whose centre is at a place in its entity's frame.
fn cube(x_m: f64, y_m: f64, length_m: f64, color: Color) -> Cube {
    Cube {
        pose: Pose::at(x_m, y_m, 0.5 * HEIGHT_M),
        size: Point::new(length_m, WIDTH_M, HEIGHT_M),
        color,
    }
}

/// The lanes and ego itself.
pub(super) fn road(recording: &Recording, time_ns: u64) -> Vec<u8> {
    let (road, ego) = (recording.road(), recording.ego());
    let from_m = ego.x_m.iter().copied().fold(f64::MAX, f64::min) - ROAD_AHEAD_M;
    let to_m = ego.x_m.iter().copied().fold(f64::MIN, f64::max) + ROAD_AHEAD_M;
    let mut lanes = Entity::new(Time::from_nanos(time_ns), MAP, "lanes");
    lanes.lines = lane_lines(road, from_m, to_m);
    let mut car = Entity::new(Time::from_nanos(time_ns), EGO, "ego");
    car.frame_locked = true;
    car.cubes.push(cube(0.0, 0.0, ego.length_m, EGO_COLOUR));
    json(&SceneUpdate {
        deletions: Vec::new(),
        entities: vec![lanes, car],
    })
}

fn lane_lines(road: &Road, from_m: f64, to_m: f64) -> Vec<Line> {
    let across = |line: u8| (f64::from(line) - 0.5) * road.lane_width_m;
    (0..=road.lanes)
        .map(|line| {
            let y_m = across(line);
            let edge = line == 0 || line == road.lanes;
            let points = if edge {
                vec![Point::new(from_m, y_m, 0.0), Point::new(to_m, y_m, 0.0)]
            } else {
                let dashes = ((to_m - from_m) / DASH_M.1).ceil() as usize;
                let dash = |i: usize| {
                    let x_m = from_m + i as f64 * DASH_M.1;
                    [x_m, x_m + DASH_M.0].map(|x| Point::new(x, y_m, 0.0))
                };
                (0..dashes).flat_map(dash).collect()
            };
            Line::new(!edge, 0.15, points, LANE_COLOUR)
        })
        .collect()
}

/// The other cars at one instant; `reference` is the one that ego follows.
pub(super) fn cars(scene: &Scene, reference: Option<u32>, time_ns: u64) -> Vec<u8> {
    let mut entity = Entity::new(Time::from_nanos(time_ns), MAP, "cars");
    let near = scene
        .vehicles
        .iter()
        .filter(|v| (v.x_m - scene.ego.x_m).abs() < SIGHT_M);
    for vehicle in near {
        let color = if reference == Some(vehicle.id.0) {
            REFERENCE_COLOUR
        } else {
            CAR_COLOUR
        };
        let cube = cube(vehicle.x_m, vehicle.y_m, vehicle.length_m, color);
        entity.cubes.push(cube);
    }
    json(&SceneUpdate {
        deletions: Vec::new(),
        entities: vec![entity],
    })
}

/// Where ego's frame is.
pub(super) fn frame(scene: &Scene, yaw_rad: f64, time_ns: u64) -> Vec<u8> {
    let pose = Pose::turned(scene.ego.x_m, scene.ego.y_m, 0.0, yaw_rad);
    json(&FrameTransform {
        timestamp: Time::from_nanos(time_ns),
        parent_frame_id: MAP,
        child_frame_id: EGO,
        translation: pose.position,
        rotation: pose.orientation,
    })
}

/// The planned path and the safety layer's mark, if either changed since the row before.
pub(super) fn plan(trace: &[TraceRow], row: usize, time_ns: u64) -> Option<Vec<u8>> {
    let now = trace.get(row)?;
    let before = row.checked_sub(1).and_then(|row| trace.get(row));
    let shown = |row: &TraceRow| (row.path_m, row.braked, row.lane == LaneActivity::Waiting);
    match before {
        Some(before) if shown(before) == shown(now) => return None,
        None if now.path_m.is_none() && !now.braked => return None,
        _ => {}
    }
    let time = Time::from_nanos(time_ns);
    let mut entities = Vec::new();
    if let Some(path) = now.path_m {
        let mut entity = Entity::new(time, MAP, "planned path");
        entity
            .lines
            .push(Line::new(false, 0.3, bezier(&path), EGO_COLOUR));
        entities.push(entity);
    }
    let marks = [
        (now.braked, "safety layer brakes", ALARM_COLOUR),
        (
            now.lane == LaneActivity::Waiting,
            "waits for a gap",
            EGO_COLOUR,
        ),
    ];
    for (_, text, color) in marks.into_iter().filter(|(on, ..)| *on) {
        let mut entity = Entity::new(time, EGO, text);
        entity.frame_locked = true;
        entity.texts.push(Text::above(text, 4.0, color));
        entities.push(entity);
    }
    json(&SceneUpdate {
        deletions: vec![Deletion::all(time)],
        entities,
    })
    .into()
}

/// A cubic Bezier curve in 16 straight pieces.
fn bezier(p: &[(f64, f64); 4]) -> Vec<Point> {
    let value = |a: [f64; 4], s: f64| {
        let r = 1.0 - s;
        r * r * r * a[0] + 3.0 * r * r * s * a[1] + 3.0 * r * s * s * a[2] + s * s * s * a[3]
    };
    let (x, y) = (p.map(|p| p.0), p.map(|p| p.1));
    (0..=16)
        .map(|i| f64::from(i) / 16.0)
        .map(|s| Point::new(value(x, s), value(y, s), 0.05))
        .collect()
}

/// Speed, gap and what was asked, at a row.
pub(super) fn signals(
    drive: &Drive,
    trace: Option<&TraceRow>,
    row: usize,
    time_ns: u64,
) -> Vec<u8> {
    let rows = drive.rows();
    let of_lead = |column: &[f64]| rows.lead_present[row].then(|| short(column[row]));
    json(&Signals {
        timestamp: Time::from_nanos(time_ns),
        speed_mps: short(rows.ego_speed_mps[row]),
        lane: rows.lane[row],
        gap_m: of_lead(&rows.lead_dx_m),
        lead_speed_mps: of_lead(&rows.lead_speed_mps),
        asked_speed_mps: trace.map(|t| short(t.asked.speed_mps)),
        asked_gap_m: trace.map(|t| short(t.asked.following_distance_m)),
        lane_wish: trace.map(|t| t.asked.wish.as_str()),
        acceleration_mps2: trace.map(|t| short(t.acceleration_mps2)),
    })
}

pub(super) fn decision(kind: DecisionKind, drive: &str, time_ns: u64) -> Vec<u8> {
    json(&Log {
        timestamp: Time::from_nanos(time_ns),
        level: kind.level(),
        message: kind.as_str(),
        name: kind.node(),
        file: drive,
        line: 0,
    })
}
