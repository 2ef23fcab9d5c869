//! From samples as recorded to a recording: one clock, road frame, even rows.

use crate::{
    centre_line::CentreLine,
    differentiate::{fill_speeds, fill_speeds_of_others},
    error::IngestError,
    join_speeds::join_speeds,
    lane_centres::{LaneShape, into_lanes},
    lanes::{EgoPath, place},
    mapping::{FrameKind, Mapping, RoadMapping, SeesMapping},
    pair_rows,
    plausible::{doubts, leave_out_impossible, on_the_road},
    quality::{Warning, WarningKind},
    raw::{EgoSample, ObjectSample, RawDrive, Sighting},
    resample::{Grid, grid, speeds},
    settings::IngestSettings,
    synchronise::synchronise,
};
use maveric_domain::{EgoTrack, ObjectTrack, Recording, Road, Sees, VehicleId};
use std::{collections::BTreeMap, path::Path};

/// Rows from which a rate far above that of the log is refused: an hour at 1000 Hz is more than anybody looks at.
const MOST_ROWS: f64 = 1e6;
/// Rows a sample that are still a rate and no mistake.
const MOST_ROWS_A_SAMPLE: f64 = 100.0;

/// Length of a vehicle whose log does not say it: a middle-sized car, in m.
const CAR_LENGTH_M: f64 = 4.7;
/// Mean distance from ego below which an object is ego itself, in m.
const EGO_ITSELF_M: f64 = 1.0;

/// Mean speed against the road above which a vehicle comes towards ego, in m/s: some car reverses more slowly.
const BACKWARDS_MPS: f64 = 2.0;

/// How the samples of a drive become a recording.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Target<'a> {
    /// The road.
    pub(crate) road: Road,
    /// How the log's frame lies to it.
    pub(crate) frame: FrameKind,
    /// Points along the right lane in the log's frame, by which the road is straightened; none where it is straight.
    pub(crate) centre_line: &'a [[f64; 2]],
    /// How lanes lie across the road.
    pub(crate) lane_shape: LaneShape<'a>,
    /// Lateral position of lane 0's centre in the log's frame, in m.
    pub(crate) right_lane_centre_y_m: f64,
    /// Whether vehicles beside ego's lane are left out, because the only lane known is ego's.
    pub(crate) own_lane_only: bool,
    /// Whether y comes from numbers of lanes: its steps are held, not interpolated.
    pub(crate) lane_steps: bool,
    /// What the mapping says of the rig's sight.
    pub(crate) sees: SeesMapping,
    /// Rows a second.
    pub(crate) rate_hz: f64,
    /// Longest hole that is bridged, in s.
    pub(crate) max_gap_s: f64,
}

impl<'a> Target<'a> {
    /// The target for a log that does not describe its own road.
    ///
    /// # Errors
    /// [`IngestError::BadSetting`].
    pub(crate) fn mapped(settings: &'a IngestSettings) -> Result<Self, IngestError> {
        let mapping = settings.mapping.as_ref();
        let road = mapping.and_then(|m| m.road).unwrap_or(RoadMapping::UNKNOWN);
        let centre_line = mapping.map_or(&[][..], |m| &m.centre_line);
        Ok(Self {
            road: road.road(),
            frame: if centre_line.is_empty() {
                road.frame
            } else {
                FrameKind::Map
            },
            centre_line,
            lane_shape: mapping.map_or(LaneShape::Even, Mapping::lane_shape),
            right_lane_centre_y_m: road.right_lane_centre_y_m,
            own_lane_only: road.lanes == 1,
            lane_steps: false,
            sees: mapping.map(|m| m.sees).unwrap_or_default(),
            rate_hz: settings.rate_hz()?,
            max_gap_s: settings.max_gap_s()?,
        })
    }
}

/// Makes the recording of a drive and says what was left out of it.
///
/// # Errors
/// [`IngestError::TooSparse`] where no two rows belong together, [`IngestError::Implausible`], [`IngestError::Refused`].
pub(crate) fn assemble(
    path: &Path,
    mut drive: RawDrive,
    target: &Target<'_>,
) -> Result<(Recording, Vec<Warning>), IngestError> {
    if !target.centre_line.is_empty() {
        CentreLine::new(target.centre_line).straighten(&mut drive);
    }
    let mut warnings = synchronise(path, &mut drive, target.max_gap_s);
    warnings.extend(leave_out_impossible(path, &mut drive)?);
    warnings.extend(join_speeds(path, &mut drive));
    pair_rows::in_order(&mut drive);
    warnings.extend(doubts(path, &drive));
    if drive.ego.iter().any(|s| s.speed_mps.is_none()) {
        let without = drive.ego.iter().filter(|s| s.speed_mps.is_none()).count();
        fill_speeds(&mut drive.ego, target.max_gap_s);
        drive.ego.retain(|s| s.speed_mps.is_some());
        let what = "no speed was recorded: it is differentiated from the positions";
        warnings.push(Warning::new(path, WarningKind::Default, without, what));
    }
    warnings.extend(fill_speeds_of_others(
        path,
        &mut drive.objects,
        target.max_gap_s,
    ));
    if drive.ego_among_objects {
        warnings.extend(drop_ego(path, &mut drive));
    }
    let lane_y_m = target.right_lane_centre_y_m;
    place(&mut drive, target.frame, lane_y_m, target.max_gap_s);
    into_lanes(path, &mut drive, &target.road, target.lane_shape)?;
    if target.frame == FrameKind::Map && !target.own_lane_only {
        warnings.extend(on_the_road(path, &drive.ego, &target.road)?);
    }
    if target.own_lane_only {
        warnings.extend(keep_own_lane(path, &mut drive, target.road.lane_width_m));
    }

    let stamp_ns: Vec<i64> = drive.ego.iter().map(|s| s.stamp_ns).collect();
    let time_s = seconds(&stamp_ns);
    let span_s = time_s
        .last()
        .zip(time_s.first())
        .map_or(0.0, |(b, a)| b - a);
    let wanted = span_s * target.rate_hz;
    if wanted > MOST_ROWS && wanted > MOST_ROWS_A_SAMPLE * time_s.len() as f64 {
        return Err(IngestError::TooManyRows {
            path: path.to_owned(),
            rows: wanted,
            rate_hz: target.rate_hz,
            samples: time_s.len(),
        });
    }
    let mut rows = grid(&time_s, target.rate_hz, target.max_gap_s);
    if !rows.holes_s.is_empty() {
        let what = format!(
            "holes of more than {} s are not bridged: a segment starts after each",
            target.max_gap_s
        );
        let warning = Warning::new(path, WarningKind::Hole, rows.holes_s.len(), what);
        warnings.push(warning.with_spans(rows.holes_s.iter().copied()));
    }
    // Rows that stand alone, each in its own segment, are no drive either.
    let is_drive = |rows: &Grid| rows.rows.windows(2).any(|w| w[0].segment == w[1].segment);
    if !is_drive(&rows) {
        return Err(IngestError::TooSparse {
            path: path.to_owned(),
            samples: drive.ego.len(),
            max_gap_s: target.max_gap_s,
        });
    }
    if !drive.sightings.is_empty() {
        warnings.extend(keep_seen(path, &drive.sightings, &mut rows, target));
        if !is_drive(&rows) {
            return Err(IngestError::SeldomSeen {
                path: path.to_owned(),
                sightings: drive.sightings.len(),
                max_gap_s: target.max_gap_s,
            });
        }
    }
    let ego_length_m = drive.ego_length_m.unwrap_or_else(|| {
        let what = format!("ego's length is not known: {CAR_LENGTH_M} m stands in");
        warnings.push(Warning::new(path, WarningKind::Default, 1, what));
        CAR_LENGTH_M
    });
    let ego = ego_track(&drive.ego, &stamp_ns, &rows, ego_length_m, target);
    let objects = drive.objects.len();
    let others = tracks(path, &drive.objects, &rows, target, &mut warnings);
    if objects > 0 && others.is_empty() {
        let what = "no sample of the others falls on a row of ego: their clocks may differ";
        warnings.push(Warning::new(path, WarningKind::NoOverlap, objects, what));
    }
    let first = rows.rows[0].tick;
    let row_time = |r: &crate::resample::Row| (r.tick - first) as f64 / target.rate_hz;
    let recording = Recording::new(
        target.road,
        target.rate_hz,
        rows.rows.iter().map(row_time).collect(),
        rows.rows.iter().map(|r| r.segment).collect(),
        ego,
        others,
    )
    .map_err(|source| IngestError::Refused {
        path: path.to_owned(),
        source,
    })?
    .seen_by(target.sees.of(Sees {
        // Of an only lane the vehicles beside are left out.
        beside: drive.sees.beside && !target.own_lane_only,
        lanes: drive.sees.lanes && !target.own_lane_only,
        ..drive.sees
    }));
    if drive.without_lateral {
        let what = "nothing says who is beside ego: passing cannot be told from following, and has no measures";
        warnings.push(Warning::new(path, WarningKind::Default, 1, what));
        return Ok((recording.without_lateral(), warnings));
    }
    Ok((recording, warnings))
}

fn seconds(stamp_ns: &[i64]) -> Vec<f64> {
    stamp_ns.iter().map(|ns| *ns as f64 / 1e9).collect()
}

/// Leaves out the rows at which nobody looked who else is there: a road is not free because it was not seen.
fn keep_seen(
    path: &Path,
    sightings: &[Sighting],
    rows: &mut Grid,
    target: &Target<'_>,
) -> Option<Warning> {
    let stamp_ns: Vec<i64> = sightings.iter().map(|s| s.stamp_ns).collect();
    let seen = grid(&seconds(&stamp_ns), target.rate_hz, target.max_gap_s);
    let before = rows.rows.len();
    rows.keep(&seen);
    let left_out = before - rows.rows.len();
    (left_out > 0).then(|| {
        let what = "rows of ego at which the others are not seen are left out: a segment starts after each such hole";
        let warning = Warning::new(path, WarningKind::Hole, left_out, what);
        warning.with_spans(seen.holes_s)
    })
}

fn ego_track(
    samples: &[EgoSample],
    stamp_ns: &[i64],
    grid: &Grid,
    length_m: f64,
    target: &Target<'_>,
) -> EgoTrack {
    let column = |value: fn(&EgoSample) -> f64| -> Vec<f64> {
        grid.rows.iter().map(|r| r.of(samples, value)).collect()
    };
    // Samples without a speed were left out above.
    let speed: Vec<f64> = samples.iter().map(|s| s.speed_mps.unwrap_or(0.0)).collect();
    EgoTrack {
        length_m,
        x_m: column(|s| s.x_m),
        y_m: if target.lane_steps {
            let held = grid.rows.iter().map(|r| r.held(samples, |s| s.y_m));
            held.collect()
        } else {
            column(|s| s.y_m)
        },
        speed_mps: speeds(stamp_ns, &speed, grid, target.rate_hz, target.max_gap_s),
    }
}

/// The samples of one vehicle, column by column.
#[derive(Default)]
struct Columns {
    stamp_ns: Vec<i64>,
    x_m: Vec<f64>,
    y_m: Vec<f64>,
    speed_mps: Vec<f64>,
    /// From which sample on which length is known, in m: a number may be used again for another vehicle.
    lengths_m: Vec<(usize, f64)>,
}

impl Columns {
    fn push(&mut self, sample: &ObjectSample) {
        self.stamp_ns.push(sample.stamp_ns);
        self.x_m.push(sample.x_m);
        self.y_m.push(sample.y_m);
        self.speed_mps.push(sample.speed_mps);
        let last = self.lengths_m.last().map(|l| l.1.to_bits());
        if let Some(length_m) = sample
            .known_length_m()
            .filter(|l| last != Some(l.to_bits()))
        {
            self.lengths_m.push((self.stamp_ns.len() - 1, length_m));
        }
    }

    /// The length of whoever is seen from a sample on: as it is known then, else the first one that is.
    fn length_m(&self, sample: usize) -> Option<f64> {
        let known = self.lengths_m.partition_point(|(from, _)| *from <= sample);
        let known = self.lengths_m.get(known.saturating_sub(1));
        known.map(|l| l.1)
    }
}

/// Tracks of the others on ego's rows: one for every unbroken stay of a vehicle.
fn tracks(
    path: &Path,
    objects: &[ObjectSample],
    ego: &Grid,
    target: &Target<'_>,
    warnings: &mut Vec<Warning>,
) -> Vec<ObjectTrack> {
    let mut vehicles: Vec<(u32, Columns)> = Vec::new();
    let mut place_of: BTreeMap<u32, usize> = BTreeMap::new();
    let mut place = 0;
    for object in objects {
        // Often it is whose sample was the last.
        if vehicles.get(place).is_none_or(|v| v.0 != object.id) {
            place = *place_of.entry(object.id).or_insert(vehicles.len());
            if place == vehicles.len() {
                vehicles.push((object.id, Columns::default()));
            }
        }
        vehicles[place].1.push(object);
    }
    let mut without_length = 0;
    let mut tracks: Vec<ObjectTrack> = Vec::new();
    for (id, samples) in vehicles {
        without_length += usize::from(samples.lengths_m.is_empty());
        let (rate_hz, max_gap_s) = (target.rate_hz, target.max_gap_s);
        let own = grid(&seconds(&samples.stamp_ns), rate_hz, max_gap_s);
        let (stamp_ns, speed) = (&samples.stamp_ns, &samples.speed_mps);
        let speed_mps = speeds(stamp_ns, speed, &own, rate_hz, max_gap_s);
        let mut current: Option<(ObjectTrack, u32)> = None;
        let mut at = 0;
        for (i, (row, speed_mps)) in own.rows.iter().zip(speed_mps).enumerate() {
            // Ego's rows and the vehicle's are both rising: walk them side by side.
            while ego.rows.get(at).is_some_and(|e| e.tick < row.tick) {
                at += 1;
            }
            if ego.rows.get(at).is_none_or(|e| e.tick != row.tick) {
                continue;
            }
            let goes_on = current
                .as_ref()
                .is_some_and(|(t, s)| *s == row.segment && t.first_row + t.x_m.len() == at);
            if !goes_on {
                let rest = own.rows[i..].partition_point(|r| r.segment == row.segment);
                let rows = rest.min(ego.rows.len() - at);
                let fresh = ObjectTrack {
                    id: VehicleId(id),
                    length_m: samples.length_m(row.before).unwrap_or(CAR_LENGTH_M),
                    first_row: at,
                    x_m: Vec::with_capacity(rows),
                    y_m: Vec::with_capacity(rows),
                    speed_mps: Vec::with_capacity(rows),
                };
                tracks.extend(current.replace((fresh, row.segment)).map(|(t, _)| t));
            }
            if let Some((track, _)) = &mut current {
                track.x_m.push(row.of(&samples.x_m, |x| *x));
                track.y_m.push(if target.lane_steps {
                    row.held(&samples.y_m, |y| *y)
                } else {
                    row.of(&samples.y_m, |y| *y)
                });
                track.speed_mps.push(speed_mps);
            }
        }
        tracks.extend(current.map(|(t, _)| t));
    }
    if without_length > 0 {
        let what = format!("vehicles without dimensions are taken to be {CAR_LENGTH_M} m long");
        warnings.push(Warning::new(
            path,
            WarningKind::Default,
            without_length,
            what,
        ));
    }
    let before = tracks.len();
    tracks.retain(|track| !comes_towards(track, target.rate_hz));
    if tracks.len() < before {
        let what = "vehicles that drive the other way are left out";
        let count = before - tracks.len();
        warnings.push(Warning::new(path, WarningKind::OtherLane, count, what));
    }
    tracks.sort_by_key(|t| (t.first_row, t.id));
    tracks
}

/// Whether a vehicle drives against the road: nobody follows it, and nobody merges back before it.
fn comes_towards(track: &ObjectTrack, rate_hz: f64) -> bool {
    let (first, last) = (track.x_m.first(), track.x_m.last());
    let moved_m = last.zip(first).map_or(0.0, |(last, first)| last - first);
    let time_s = track.x_m.len().saturating_sub(1) as f64 / rate_hz;
    moved_m < -BACKWARDS_MPS * time_s
}

/// Leaves out the object that is ego: `/carla/objects` holds it too.
fn drop_ego(path: &Path, drive: &mut RawDrive) -> Option<Warning> {
    let mut distance: BTreeMap<u32, (f64, f64)> = BTreeMap::new();
    let mut ego = EgoPath::new(&drive.ego);
    for object in &drive.objects {
        if let Some((x, y)) = ego.at(object.stamp_ns) {
            let sum = distance.entry(object.id).or_default();
            sum.0 += libm::hypot(object.x_m - x, object.y_m - y);
            sum.1 += 1.0;
        }
    }
    let near = distance
        .into_iter()
        .find(|(_, (sum, n))| sum / n < EGO_ITSELF_M);
    let (id, _) = near?;
    let its_length = |o: &ObjectSample| o.known_length_m().filter(|_| o.id == id);
    let length_m = drive.objects.iter().find_map(its_length);
    drive.ego_length_m = drive.ego_length_m.or(length_m);
    drive.objects.retain(|o| o.id != id);
    let what = format!("object {id} is ego itself: it is left out, and its length is ego's");
    Some(Warning::new(path, WarningKind::Choice, 1, what))
}

/// Leaves out vehicles more than half a lane aside of ego: on a road of one known lane they would count as ahead.
fn keep_own_lane(path: &Path, drive: &mut RawDrive, lane_width_m: f64) -> Option<Warning> {
    let before = drive.objects.len();
    let mut ego = EgoPath::new(&drive.ego);
    drive.objects.retain(|o| {
        let there = ego.at(o.stamp_ns);
        there.is_none_or(|(_, y)| (o.y_m - y).abs() <= 0.5 * lane_width_m)
    });
    let count = before - drive.objects.len();
    (count > 0).then(|| {
        let what =
            "vehicles beside ego's lane are left out: give the road in a mapping to keep them";
        Warning::new(path, WarningKind::OtherLane, count, what)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive(objects: Vec<ObjectSample>) -> RawDrive {
        let ego = (0..100).map(|i| EgoSample {
            stamp_ns: i * 100_000_000,
            log_ns: i * 100_000_000,
            nth: i as u32,
            x_m: i as f64,
            y_m: 0.0,
            yaw_rad: Some(0.0),
            speed_mps: Some(10.0),
        });
        RawDrive {
            ego: ego.collect(),
            objects,
            ego_length_m: Some(4.0),
            ego_among_objects: true,
            ..RawDrive::default()
        }
    }

    fn object(i: i64, id: u32, dx_m: f64, y_m: f64) -> ObjectSample {
        ObjectSample {
            stamp_ns: i * 100_000_000,
            log_ns: i * 100_000_000,
            nth: i as u32,
            id,
            x_m: i as f64 + dx_m,
            y_m,
            speed_mps: 10.0,
            length_m: 5.0,
        }
    }

    fn assembled(objects: Vec<ObjectSample>) -> (Recording, Vec<Warning>) {
        let settings = IngestSettings::default();
        let target = Target::mapped(&settings).unwrap();
        assemble(Path::new("log"), drive(objects), &target).unwrap()
    }

    #[test]
    fn ego_among_the_objects_and_vehicles_of_other_lanes_are_left_out() {
        let objects = (0..100).flat_map(|i| {
            [
                object(i, 1, 0.1, 0.0),
                object(i, 2, 30.0, 0.3),
                object(i, 3, 20.0, 3.6),
            ]
        });
        let (recording, warnings) = assembled(objects.collect());
        let ids: Vec<u32> = recording.others().iter().map(|t| t.id.0).collect();
        assert_eq!(ids, [2]);
        let kinds: Vec<WarningKind> = warnings.iter().map(|w| w.kind).collect();
        assert_eq!(kinds, [WarningKind::Choice, WarningKind::OtherLane]);
    }

    #[test]
    fn ego_beside_the_road_is_refused_where_the_log_says_where_its_lanes_are() {
        let refused = |frame, lanes| {
            let settings = IngestSettings::default();
            let unknown = Target::mapped(&settings).unwrap();
            let road = Road {
                lanes,
                ..unknown.road
            };
            let target = Target {
                road,
                frame,
                own_lane_only: lanes == 1,
                ..unknown
            };
            let mut beside = drive(Vec::new());
            beside.ego.iter_mut().for_each(|s| s.y_m = 40.0);
            assemble(Path::new("log"), beside, &target).is_err()
        };
        assert!(refused(FrameKind::Map, 3));
        // Of one lane nothing but ego says where it is, and along ego's own path or line ego is never beside it.
        assert!(!refused(FrameKind::Map, 1));
        assert!(!refused(FrameKind::Path, 3));
        assert!(!refused(FrameKind::Auto, 1));
    }

    #[test]
    fn a_vehicle_that_returns_has_two_tracks_and_none_bridges_its_absence() {
        let objects = (0..100)
            .filter(|i| !(40..60).contains(i))
            .map(|i| object(i, 7, 30.0, 0.0));
        let (recording, _) = assembled(objects.collect());
        let found: Vec<(usize, usize)> = recording
            .others()
            .iter()
            .map(|t| (t.first_row, t.x_m.len()))
            .collect();
        assert_eq!(found, [(0, 79), (120, 79)]);
    }
}
