//! Rows of a long table, vehicle by vehicle, in the frame of the road.

use super::columns::LongRow;
use crate::{
    differentiate::fill_speeds,
    mapping::{Directions, GapKind, Point, RoadMapping, Side, TableMapping},
    raw::EgoSample,
};
use std::collections::BTreeMap;

/// Largest offset from a lane's centre, in lanes, that keeps a vehicle in the lane that its row names.
const WITHIN_LANE: f64 = 0.49;

/// How the table's frame lies to the road.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    /// 1 where y grows to the left of x, -1 where it grows to the right.
    pub(super) y_left: f64,
    pub(super) road: RoadMapping,
}

/// What a row says of the vehicle ahead; positions in the frame of the road.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lead {
    /// Place among the names of vehicles.
    pub(super) id: Option<u32>,
    pub(super) x_m: f64,
    pub(super) speed_mps: f64,
    pub(super) length_m: f64,
    pub(super) length_known: bool,
}

/// One vehicle.
#[derive(Debug, Clone)]
pub(super) struct Vehicle {
    pub(super) group: u32,
    /// Place among the names of vehicles.
    pub(super) id: u32,
    /// Number of vehicles that had this name before.
    pub(super) generation: u32,
    /// 1 along the table's x, -1 against it.
    pub(super) sign: f64,
    pub(super) length_m: f64,
    pub(super) length_known: bool,
    /// Rising in time.
    pub(super) samples: Vec<EgoSample>,
    /// What each sample's row says of the vehicle ahead.
    pub(super) leads: Vec<Option<Lead>>,
    /// Its place among the names of vehicles, which a row may say alone.
    pub(super) lead_ids: Vec<Option<u32>>,
}

/// All vehicles, ordered by group, name and time.
#[derive(Debug)]
pub(super) struct Fleet {
    pub(super) vehicles: Vec<Vehicle>,
    /// Whether y comes from numbers of lanes alone and so moves in steps.
    pub(super) lane_steps: bool,
}

/// Sorts rows into vehicles.
pub(super) fn vehicles(
    mut rows: Vec<LongRow>,
    mapping: &TableMapping,
    frame: &Frame,
    max_gap_s: f64,
) -> Fleet {
    let lane_y = LaneCentres::of(&rows, mapping, frame);
    // Stable: of two rows at one time the first stays first.
    rows.sort_by_key(|r| (r.group, r.id, r.stamp_ns));
    let mut vehicles = Vec::new();
    for same in rows.chunk_by(|a, b| (a.group, a.id) == (b.group, b.id)) {
        let renewed = |a: &LongRow, b: &LongRow| {
            let hole_s = b.stamp_ns.saturating_sub(a.stamp_ns) as f64 / 1e9;
            mapping
                .new_vehicle_after_s
                .is_some_and(|most| hole_s > most)
        };
        for (generation, rows) in (0..).zip(same.chunk_by(|a, b| !renewed(a, b))) {
            vehicles.push(vehicle(
                rows, generation, mapping, frame, &lane_y, max_gap_s,
            ));
        }
    }
    Fleet {
        vehicles,
        lane_steps: matches!(lane_y, LaneCentres::Steps { .. }),
    }
}

fn vehicle(
    rows: &[LongRow],
    generation: u32,
    mapping: &TableMapping,
    frame: &Frame,
    lane_y: &LaneCentres,
    max_gap_s: f64,
) -> Vehicle {
    let known = rows.iter().map(|r| r.length_m).find(|l| *l > 0.0);
    let length_m = known.unwrap_or(mapping.ego_length_m);
    let width_m = rows
        .iter()
        .map(|r| r.width_m)
        .find(|w| *w > 0.0)
        .unwrap_or(0.0);
    let sign = sign(rows, mapping);
    let headed = mapping.columns.heading.is_some();
    // With headings the frame is the world's, and is turned to the road later on.
    let turn = if headed { 1.0 } else { sign };
    let sample = |row: &LongRow| {
        let yaw = frame.y_left * row.yaw_rad;
        let (cos, sin) = if headed && yaw.is_finite() {
            (libm::cos(yaw), libm::sin(yaw))
        } else {
            (1.0, 0.0)
        };
        let (mut x, mut y) = (turn * row.x_m, turn * frame.y_left * row.y_m);
        match mapping.point {
            Some(Point::Front) => (x, y) = (x - 0.5 * length_m * cos, y - 0.5 * length_m * sin),
            Some(Point::Rear) => (x, y) = (x + 0.5 * length_m * cos, y + 0.5 * length_m * sin),
            Some(Point::Corner) => {
                x = turn * (row.x_m + 0.5 * length_m);
                y = turn * frame.y_left * (row.y_m + 0.5 * width_m);
            }
            Some(Point::Reference) => {
                let ahead = Some(row.centre_ahead_m).filter(|a| a.is_finite());
                let ahead = ahead.or(mapping.centre_ahead_m).unwrap_or(0.0);
                (x, y) = (x + ahead * cos, y + ahead * sin);
            }
            Some(Point::Centre) | None => {}
        }
        let speed = row.speed_mps.is_finite().then_some(row.speed_mps.abs());
        EgoSample {
            stamp_ns: row.stamp_ns,
            log_ns: row.stamp_ns,
            nth: 0,
            x_m: x,
            y_m: lane_y.place(row, y, frame),
            yaw_rad: if headed {
                yaw.is_finite().then_some(yaw)
            } else {
                Some(0.0)
            },
            speed_mps: speed,
        }
    };
    let mut samples: Vec<EgoSample> = rows.iter().map(sample).collect();
    if samples.iter().any(|s| s.speed_mps.is_none()) {
        fill_speeds(&mut samples, max_gap_s);
    }
    let leads = rows
        .iter()
        .zip(&samples)
        .map(|(row, sample)| lead(row, sample, sign, length_m, mapping));
    Vehicle {
        group: rows[0].group,
        id: rows[0].id,
        generation,
        sign,
        length_m,
        length_known: known.is_some(),
        leads: leads.collect(),
        lead_ids: rows.iter().map(|r| r.lead_id).collect(),
        samples,
    }
}

/// Which way a vehicle drives along the table's x.
fn sign(rows: &[LongRow], mapping: &TableMapping) -> f64 {
    if mapping.directions == Directions::Along {
        return 1.0;
    }
    let velocity: f64 = rows
        .iter()
        .map(|r| r.speed_x_mps)
        .filter(|v| v.is_finite())
        .sum();
    let moved = rows[rows.len() - 1].x_m - rows[0].x_m;
    let way = if velocity.abs() > 0.0 {
        velocity
    } else {
        moved
    };
    if way < 0.0 { -1.0 } else { 1.0 }
}

/// What a row says of the vehicle ahead, if it says where it is and how fast.
fn lead(
    row: &LongRow,
    ego: &EgoSample,
    sign: f64,
    ego_length_m: f64,
    mapping: &TableMapping,
) -> Option<Lead> {
    let nobody = mapping.columns.lead_id.is_some() && row.lead_id.is_none();
    if nobody || !row.lead_speed_mps.is_finite() {
        return None;
    }
    let known = row.lead_length_m > 0.0;
    let length_m = if known {
        row.lead_length_m
    } else {
        mapping.lead_length_m
    };
    let x_m = if row.lead_x_m.is_finite() {
        let x = sign * row.lead_x_m;
        match mapping.point {
            Some(Point::Front) => x - 0.5 * length_m,
            Some(Point::Rear) => x + 0.5 * length_m,
            Some(Point::Corner) => x + 0.5 * sign * length_m,
            Some(Point::Reference) => x + mapping.centre_ahead_m.unwrap_or(0.0),
            Some(Point::Centre) | None => x,
        }
    } else {
        // 0 stands for no leader in tables of headways.
        let gap = Some(row.gap_m).filter(|g| g.is_finite() && *g > 0.0)?;
        let front_m = match mapping.gap_kind {
            Some(GapKind::FrontToFront) => -length_m,
            Some(GapKind::CentreToCentre) => -0.5 * (ego_length_m + length_m),
            _ => 0.0,
        };
        ego.x_m + gap + front_m + 0.5 * (ego_length_m + length_m)
    };
    Some(Lead {
        id: row.lead_id,
        x_m,
        speed_mps: row.lead_speed_mps.abs(),
        length_m,
        length_known: known,
    })
}

/// Where lanes lie across the road.
#[derive(Debug)]
enum LaneCentres {
    /// y alone says it.
    Unknown,
    /// The number of the lane alone says it.
    Steps { mapping: Numbering },
    /// Both do: the median y of each group's lanes is its centre.
    Measured {
        mapping: Numbering,
        medians: BTreeMap<(u32, i64), f64>,
    },
}

/// How lanes are numbered.
#[derive(Debug, Clone, Copy)]
struct Numbering {
    from: Side,
    first: i64,
}

impl Numbering {
    /// The centre of a lane in the frame of the road before its right lane is taken off.
    fn centre_m(self, lane: i64, frame: &Frame) -> f64 {
        let from_edge = lane - self.first;
        let lane = match self.from {
            Side::Right => from_edge,
            Side::Left => i64::from(frame.road.lanes) - 1 - from_edge,
        };
        frame.road.right_lane_centre_y_m + lane as f64 * frame.road.lane_width_m
    }
}

impl LaneCentres {
    fn of(rows: &[LongRow], mapping: &TableMapping, frame: &Frame) -> Self {
        let lanes = rows.iter().any(|r| r.lane.is_finite());
        let (Some(from), true) = (mapping.lanes_from, lanes) else {
            return Self::Unknown;
        };
        let numbering = Numbering {
            from,
            first: mapping.first_lane,
        };
        if mapping.columns.y.is_none() {
            return Self::Steps { mapping: numbering };
        }
        let mut ys: BTreeMap<(u32, i64), Vec<f64>> = BTreeMap::new();
        for row in rows.iter().filter(|r| r.lane.is_finite()) {
            let y = frame.y_left * row.y_m;
            ys.entry((row.group, row.lane as i64)).or_default().push(y);
        }
        let median = |(lane, mut ys): ((u32, i64), Vec<f64>)| {
            ys.sort_by(f64::total_cmp);
            (lane, ys[ys.len() / 2])
        };
        Self::Measured {
            mapping: numbering,
            medians: ys.into_iter().map(median).collect(),
        }
    }

    fn place(&self, row: &LongRow, y_m: f64, frame: &Frame) -> f64 {
        let lane = row.lane as i64;
        match self {
            Self::Unknown => y_m,
            _ if !row.lane.is_finite() => y_m,
            Self::Steps { mapping } => mapping.centre_m(lane, frame),
            Self::Measured { mapping, medians } => {
                let median = medians.get(&(row.group, lane)).copied().unwrap_or(y_m);
                let most = WITHIN_LANE * frame.road.lane_width_m;
                mapping.centre_m(lane, frame) + (y_m - median).clamp(-most, most)
            }
        }
    }
}
