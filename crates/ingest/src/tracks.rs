//! The others on ego's rows.

use crate::{
    mapping::TableMapping,
    quality::{Warning, WarningKind, report},
    raw::ObjectSamples,
    resample::{Grid, grid, seconds, speeds},
    target::Target,
};
use maveric_domain::{ObjectTrack, VehicleId};
use std::{
    borrow::Cow,
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// Length of a vehicle whose log does not say it, in m.
pub(crate) const CAR_LENGTH_M: f64 = TableMapping::CAR_LENGTH_M;
/// Mean speed against the road above which a vehicle comes towards ego, in m/s: some car reverses more slowly.
const BACKWARDS_MPS: f64 = 2.0;

/// The samples of one vehicle, column by column.
#[derive(Default)]
struct Columns<'a> {
    stamp_ns: Cow<'a, [i64]>,
    x_m: Cow<'a, [f64]>,
    y_m: Cow<'a, [f64]>,
    speed_mps: Cow<'a, [f64]>,
    /// From which sample on which length is known, in m: a number may be used again for another vehicle.
    lengths_m: Vec<(usize, f64)>,
}

impl<'a> Columns<'a> {
    /// Those that follow each other in the columns of all.
    fn stretch(objects: &'a ObjectSamples, first: usize, end: usize) -> Self {
        let mut columns = Self {
            stamp_ns: objects.stamp_ns[first..end].into(),
            x_m: objects.x_m[first..end].into(),
            y_m: objects.y_m[first..end].into(),
            speed_mps: objects.speed_mps[first..end].into(),
            lengths_m: Vec::new(),
        };
        for (sample, &length_m) in objects.length_m[first..end].iter().enumerate() {
            columns.note_length(sample, length_m);
        }
        columns
    }

    fn push(&mut self, objects: &ObjectSamples, i: usize) {
        self.note_length(self.stamp_ns.len(), objects.length_m[i]);
        self.stamp_ns.to_mut().push(objects.stamp_ns[i]);
        self.x_m.to_mut().push(objects.x_m[i]);
        self.y_m.to_mut().push(objects.y_m[i]);
        self.speed_mps.to_mut().push(objects.speed_mps[i]);
    }

    fn note_length(&mut self, sample: usize, length_m: f64) {
        let last = self.lengths_m.last().map(|l| l.1.to_bits());
        if !length_m.is_nan() && last != Some(length_m.to_bits()) {
            self.lengths_m.push((sample, length_m));
        }
    }

    /// The length of whoever is seen from a sample on: as it is known then, else the first one that is.
    fn length_m(&self, sample: usize) -> Option<f64> {
        let known = self.lengths_m.partition_point(|(from, _)| *from <= sample);
        let known = self.lengths_m.get(known.saturating_sub(1));
        known.map(|l| l.1)
    }
}

/// The samples of each vehicle, in the order in which they were first seen.
fn vehicles(objects: &ObjectSamples) -> Vec<(u32, Columns<'_>)> {
    // Of a table of leaders each is there once, and its columns need no copy.
    let mut seen = BTreeSet::new();
    let mut stretches = objects.id.chunk_by(|a, b| a == b);
    if stretches.all(|ids| seen.insert(ids[0])) {
        let mut end = 0;
        let stretch = |ids: &[u32]| {
            let first = end;
            end += ids.len();
            (ids[0], Columns::stretch(objects, first, end))
        };
        return objects.id.chunk_by(|a, b| a == b).map(stretch).collect();
    }
    let mut vehicles: Vec<(u32, Columns<'_>)> = Vec::new();
    let mut place_of: BTreeMap<u32, usize> = BTreeMap::new();
    let mut place = 0;
    for (i, &id) in objects.id.iter().enumerate() {
        // Often it is whose sample was the last.
        if vehicles.get(place).is_none_or(|v| v.0 != id) {
            place = *place_of.entry(id).or_insert(vehicles.len());
            if place == vehicles.len() {
                vehicles.push((id, Columns::default()));
            }
        }
        vehicles[place].1.push(objects, i);
    }
    vehicles
}

/// Tracks of the others on ego's rows: one for every unbroken stay of a vehicle.
pub(crate) fn tracks(
    path: &Path,
    objects: &ObjectSamples,
    ego: &Grid,
    target: &Target<'_>,
    warnings: &mut Vec<Warning>,
) -> Vec<ObjectTrack> {
    let mut without_length = 0;
    let mut tracks: Vec<ObjectTrack> = Vec::new();
    for (id, samples) in vehicles(objects) {
        without_length += usize::from(samples.lengths_m.is_empty());
        stays(id, &samples, ego, target, &mut tracks);
    }
    let what = format!("vehicles without dimensions are taken to be {CAR_LENGTH_M} m long");
    report(warnings, path, WarningKind::Default, without_length, &what);
    let before = tracks.len();
    tracks.retain(|track| !comes_towards(track, target.rate_hz));
    let left_out = before - tracks.len();
    let what = "vehicles that drive the other way are left out";
    report(warnings, path, WarningKind::OtherLane, left_out, what);
    tracks.sort_by_key(|t| (t.first_row, t.id));
    tracks
}

/// Adds the unbroken stays of one vehicle.
fn stays(
    id: u32,
    samples: &Columns<'_>,
    ego: &Grid,
    target: &Target<'_>,
    tracks: &mut Vec<ObjectTrack>,
) {
    let (rate_hz, max_gap_s) = (target.rate_hz, target.max_gap_s);
    let vehicle_grid = grid(&seconds(&samples.stamp_ns), rate_hz, max_gap_s);
    let (stamp_ns, speed) = (&samples.stamp_ns, &samples.speed_mps);
    let speed_mps = speeds(stamp_ns, speed, &vehicle_grid, rate_hz, max_gap_s);
    let mut current: Option<(ObjectTrack, u32)> = None;
    let mut ego_row = 0;
    for (i, (row, speed_mps)) in vehicle_grid.rows.iter().zip(speed_mps).enumerate() {
        // Ego's rows and the vehicle's are both rising: walk them side by side.
        while ego.rows.get(ego_row).is_some_and(|e| e.tick < row.tick) {
            ego_row += 1;
        }
        if ego.rows.get(ego_row).is_none_or(|e| e.tick != row.tick) {
            continue;
        }
        let goes_on = current
            .as_ref()
            .is_some_and(|(t, s)| *s == row.segment && t.first_row + t.x_m.len() == ego_row);
        if !goes_on {
            let rest = vehicle_grid.rows[i..].partition_point(|r| r.segment == row.segment);
            let rows = rest.min(ego.rows.len() - ego_row);
            let fresh = ObjectTrack {
                id: VehicleId(id),
                length_m: samples.length_m(row.before).unwrap_or(CAR_LENGTH_M),
                first_row: ego_row,
                x_m: Vec::with_capacity(rows),
                y_m: Vec::with_capacity(rows),
                speed_mps: Vec::with_capacity(rows),
            };
            tracks.extend(current.replace((fresh, row.segment)).map(|(t, _)| t));
        }
        if let Some((track, _)) = &mut current {
            track.x_m.push(row.interpolated(&samples.x_m));
            let y_m = row.across(&samples.y_m, target.lane_steps);
            track.y_m.push(y_m);
            track.speed_mps.push(speed_mps);
        }
    }
    tracks.extend(current.map(|(t, _)| t));
}

/// Whether a vehicle drives against the road: nobody follows it, and nobody merges back before it.
fn comes_towards(track: &ObjectTrack, rate_hz: f64) -> bool {
    let (first, last) = (track.x_m.first(), track.x_m.last());
    let moved_m = last.zip(first).map_or(0.0, |(last, first)| last - first);
    let time_s = track.x_m.len().saturating_sub(1) as f64 / rate_hz;
    moved_m < -BACKWARDS_MPS * time_s
}
