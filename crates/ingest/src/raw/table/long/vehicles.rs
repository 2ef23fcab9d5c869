//! Rows of a long table, vehicle by vehicle, in the frame of the road.

use super::columns::LongRow;
use crate::{
    differentiate::fill_speeds,
    mapping::{Directions, Forward, GapKind, Long, Point, TableMapping},
    median::median,
    raw::{EgoSample, EgoSamples, table::lane::Lanes},
};
use std::collections::BTreeMap;

/// What the columns mean, and how the table's frame lies to the road.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame<'a> {
    /// 1 where y grows to the left of x, -1 where it grows to the right.
    pub(super) y_left: f64,
    pub(super) lanes: Lanes,
    pub(super) mapping: &'a TableMapping,
    pub(super) long: &'a Long,
}

impl Frame<'_> {
    /// A speed the way that a vehicle points: below zero it reverses. Where the table's vehicles drive against its x, the sign may be
    /// that of x, and none reverses.
    fn forwards(&self, speed_mps: f64) -> f64 {
        let all_along_x =
            self.long.directions == Directions::Along && self.long.forward == Forward::AlongX;
        if all_along_x { speed_mps } else { speed_mps.abs() }
    }
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

/// How a vehicle is placed in the drives of others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AsOther {
    pub(super) length_m: f64,
    /// How far ahead of its samples its centre is, in m.
    pub(super) ahead_m: f64,
}

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
    /// The vehicle as another one sees it, whose length may be another one if its own is unknown.
    pub(super) as_other: AsOther,
    /// Rising in time.
    pub(super) samples: EgoSamples,
    /// How many of them have no speed of their own, but that of their positions.
    pub(super) differentiated: usize,
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
pub(super) fn vehicles(mut rows: Vec<LongRow>, frame: &Frame<'_>, max_gap_s: f64) -> Fleet {
    let lane_y = LaneCentres::from_rows(&rows, frame);
    // Stable: of two rows at one time the first stays first.
    rows.sort_by_key(|r| (r.group, r.id, r.stamp_ns));
    let most_s = frame.long.new_vehicle_after_s;
    let mut vehicles = Vec::new();
    for same in rows.chunk_by(|a, b| (a.group, a.id) == (b.group, b.id)) {
        let renewed = |a: &LongRow, b: &LongRow| {
            let hole_s = b.stamp_ns.saturating_sub(a.stamp_ns) as f64 / 1e9;
            most_s.is_some_and(|most_s| hole_s > most_s)
        };
        for (generation, rows) in (0..).zip(same.chunk_by(|a, b| !renewed(a, b))) {
            vehicles.push(vehicle(rows, generation, frame, lane_y.as_ref(), max_gap_s));
        }
    }
    Fleet { vehicles, lane_steps: matches!(lane_y, Some(LaneCentres::Number)) }
}

fn vehicle(
    rows: &[LongRow],
    generation: u32,
    frame: &Frame<'_>,
    lane_y: Option<&LaneCentres>,
    max_gap_s: f64,
) -> Vehicle {
    let (mapping, long) = (frame.mapping, frame.long);
    let known = rows.iter().map(|r| r.length_m).find(|l| *l > 0.0);
    let length_m = known.unwrap_or(mapping.ego_length_m);
    let width_m = rows.iter().map(|r| r.width_m).find(|w| *w > 0.0);
    let width_m = width_m.unwrap_or(0.0);
    let sign = sign(rows, long);
    let headed = long.columns.heading.is_some();
    // With headings the frame is the world's, and is turned to the road later on.
    let turn = if headed { 1.0 } else { sign };
    let sample = |row: &LongRow| {
        let yaw = frame.y_left * row.yaw_rad;
        let (cos, sin) =
            if headed && yaw.is_finite() { (libm::cos(yaw), libm::sin(yaw)) } else { (1.0, 0.0) };
        let (mut x, mut y) = (turn * row.x_m, turn * frame.y_left * row.y_m);
        match long.point {
            Point::Front => (x, y) = (x - 0.5 * length_m * cos, y - 0.5 * length_m * sin),
            Point::Rear => (x, y) = (x + 0.5 * length_m * cos, y + 0.5 * length_m * sin),
            Point::Corner => {
                // The smallest x and y of the table are the greatest if both axes are turned round.
                let along = long.forward.sign();
                x = turn * (row.x_m + along * 0.5 * length_m);
                y = turn * frame.y_left * (row.y_m + along * 0.5 * width_m);
            }
            Point::Reference => {
                let ahead = Some(row.centre_ahead_m).filter(|a| a.is_finite());
                let ahead = ahead.or(long.centre_ahead_m).unwrap_or(0.0);
                (x, y) = (x + ahead * cos, y + ahead * sin);
            }
            Point::Centre => {}
        }
        let speed = Some(frame.forwards(row.speed_mps)).filter(|v| v.is_finite());
        EgoSample {
            stamp_ns: row.stamp_ns,
            log_ns: row.stamp_ns,
            nth: 0,
            x_m: x,
            y_m: lane_y.map_or(y, |lanes| lanes.place(row, y, &frame.lanes)),
            yaw_rad: if headed { yaw.is_finite().then_some(yaw) } else { Some(0.0) },
            speed_mps: speed,
        }
    };
    let mut samples: EgoSamples = rows.iter().map(sample).collect();
    let unknown = |samples: &EgoSamples| samples.speed_mps.iter().filter(|v| v.is_nan()).count();
    let mut differentiated = unknown(&samples);
    if differentiated > 0 {
        fill_speeds(&mut samples, max_gap_s);
        differentiated -= unknown(&samples);
    }
    let other_length_m = known.unwrap_or(mapping.lead_length_m);
    let ahead = match long.point {
        Point::Front => -0.5,
        Point::Rear => 0.5,
        Point::Corner => 0.5 * turn * long.forward.sign(),
        Point::Reference | Point::Centre => 0.0,
    };
    let as_other =
        AsOther { length_m: other_length_m, ahead_m: ahead * (other_length_m - length_m) };
    let leads = rows
        .iter()
        .zip(samples.iter())
        .map(|(row, sample)| lead(row, &sample, sign, length_m, frame));
    Vehicle {
        group: rows[0].group,
        id: rows[0].id,
        generation,
        sign,
        length_m,
        length_known: known.is_some(),
        as_other,
        leads: leads.collect(),
        lead_ids: rows.iter().map(|r| r.lead_id).collect(),
        differentiated,
        samples,
    }
}

/// Which way a vehicle drives along the table's x.
fn sign(rows: &[LongRow], long: &Long) -> f64 {
    if long.directions == Directions::Along {
        return 1.0;
    }
    let along_x = rows.iter().map(|r| r.speed_x_mps);
    let velocity: f64 = along_x.filter(|v| v.is_finite()).sum();
    let moved = rows[rows.len() - 1].x_m - rows[0].x_m;
    let way = if velocity.abs() > 0.0 { velocity } else { moved };
    if way < 0.0 { -1.0 } else { 1.0 }
}

/// What a row says of the vehicle ahead, if it says where it is and how fast.
fn lead(
    row: &LongRow,
    ego: &EgoSample,
    sign: f64,
    ego_length_m: f64,
    frame: &Frame<'_>,
) -> Option<Lead> {
    let (mapping, long) = (frame.mapping, frame.long);
    let nobody = long.columns.lead_id.is_some() && row.lead_id.is_none();
    if nobody || !row.lead_speed_mps.is_finite() {
        return None;
    }
    let known = row.lead_length_m > 0.0;
    let length_m = if known { row.lead_length_m } else { mapping.lead_length_m };
    let x_m = if row.lead_x_m.is_finite() {
        let x = sign * row.lead_x_m;
        match long.point {
            Point::Front => x - 0.5 * length_m,
            Point::Rear => x + 0.5 * length_m,
            Point::Corner => x + 0.5 * sign * long.forward.sign() * length_m,
            Point::Reference => x + long.centre_ahead_m.unwrap_or(0.0),
            Point::Centre => x,
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
        speed_mps: frame.forwards(row.lead_speed_mps),
        length_m,
        length_known: known,
    })
}

/// Where vehicles are in numbered lanes.
#[derive(Debug)]
enum LaneCentres {
    /// In their lane's centre: its number alone says where a vehicle is.
    Number,
    /// As far from their lane's centre as a column says.
    Offset,
    /// As far from the median y of each group's lanes, which is their centre, as their y.
    Medians(BTreeMap<(u32, i64), f64>),
}

impl LaneCentres {
    /// None where y alone says it.
    fn from_rows(rows: &[LongRow], frame: &Frame<'_>) -> Option<Self> {
        let mut ys: BTreeMap<(u32, i64), Vec<f64>> = BTreeMap::new();
        for row in rows.iter().filter(|r| r.lane.is_finite()) {
            let y = frame.y_left * row.y_m;
            ys.entry((row.group, row.lane as i64)).or_default().push(y);
        }
        frame.mapping.lanes_from.filter(|_| !ys.is_empty())?;
        let median = |(lane, mut ys): (_, Vec<f64>)| Some((lane, median(&mut ys)?));
        let columns = &frame.long.columns;
        Some(match (columns.y.is_some(), columns.offset.is_some()) {
            (true, _) => Self::Medians(ys.into_iter().filter_map(median).collect()),
            (false, true) => Self::Offset,
            (false, false) => Self::Number,
        })
    }

    /// Across the road before its right lane is taken off, in m.
    fn place(&self, row: &LongRow, y_m: f64, lanes: &Lanes) -> f64 {
        if !row.lane.is_finite() {
            return y_m;
        }
        let in_lane_m = match self {
            Self::Number => 0.0,
            Self::Offset => lanes.within_m(row.offset),
            Self::Medians(medians) => {
                let median = medians.get(&(row.group, row.lane as i64));
                lanes.kept_m(y_m - median.copied().unwrap_or(y_m))
            }
        };
        lanes.at_m(row.lane, in_lane_m)
    }
}
