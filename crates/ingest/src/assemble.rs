//! From samples as recorded to a recording: one clock, road frame, even rows.

use crate::{
    centre_line::CentreLine,
    differentiate::{fill_speeds, fill_speeds_of_others},
    error::IngestError,
    join_speeds::join_speeds,
    lane_centres::{LaneShape, into_lanes},
    lanes::{EgoPath, place},
    mapping::FrameKind,
    pair_rows,
    plausible::{doubts, in_the_only_lane, leave_out_impossible, on_the_road},
    quality::{Warning, WarningKind},
    raw::{EgoSamples, ObjectSample, RawDrive, Sightings},
    resample::{Grid, Row, grid, seconds, speeds},
    synchronise::synchronise,
    target::Target,
    tracks::{CAR_LENGTH_M, tracks},
};
use maveric_domain::{EgoTrack, Recording, Sees};
use std::{collections::BTreeMap, path::Path};

/// Rows from which a rate far above that of the log is refused: an hour at 1000 Hz is more than anybody looks at.
const MOST_ROWS: f64 = 1e6;
/// Rows a sample that are still a rate and no mistake.
const MOST_ROWS_A_SAMPLE: f64 = 100.0;

/// Mean distance from ego below which an object is ego itself, in m.
const EGO_ITSELF_M: f64 = 1.0;

/// Makes the recording of a drive and says what was left out of it.
///
/// # Errors
/// [`IngestError::TooSparse`] where no two rows belong together, [`IngestError::Implausible`], [`IngestError::Refused`].
pub(crate) fn assemble(
    path: &Path,
    mut drive: RawDrive,
    target: &Target<'_>,
) -> Result<(Recording, Vec<Warning>), IngestError> {
    let mut warnings = on_the_target(path, &mut drive, target)?;
    let rows = rows(path, &drive, target, &mut warnings)?;
    let ego_length_m = drive.ego_length_m.unwrap_or_else(|| {
        let what = format!("ego's length is not known: {CAR_LENGTH_M} m stands in");
        warnings.push(Warning::new(path, WarningKind::Default, 1, what));
        CAR_LENGTH_M
    });
    let ego = ego_track(&drive.ego, &rows, ego_length_m, target);
    let objects = drive.objects.len();
    let others = tracks(path, &drive.objects, &rows, target, &mut warnings);
    if objects > 0 && others.is_empty() {
        let what = "no sample of the others falls on a row of ego: their clocks may differ";
        warnings.push(Warning::new(path, WarningKind::NoOverlap, objects, what));
    }
    let first = rows.rows[0].tick;
    let row_time = |r: &Row| (r.tick - first) as f64 / target.rate_hz;
    let recording = Recording::new(
        target.road,
        target.rate_hz,
        rows.rows.iter().map(row_time).collect(),
        rows.rows.iter().map(|r| r.segment).collect(),
        ego,
        others,
    )
    .map_err(|source| IngestError::Refused { path: path.to_owned(), source })?
    .seen_by(target.sees.or_shown(Sees {
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

/// Puts the samples on one clock, gives them speeds and lays them on the road.
///
/// # Errors
/// [`IngestError::Implausible`]; [`IngestError::BadTable`] where lanes are not found.
fn on_the_target(
    path: &Path,
    drive: &mut RawDrive,
    target: &Target<'_>,
) -> Result<Vec<Warning>, IngestError> {
    if !target.centre_line.is_empty() {
        CentreLine::new(target.centre_line).straighten(drive);
    }
    let max_gap_s = target.max_gap_s;
    let mut warnings = synchronise(path, drive, max_gap_s);
    warnings.extend(leave_out_impossible(path, drive)?);
    warnings.extend(join_speeds(path, drive));
    pair_rows::in_order(drive);
    warnings.extend(doubts(path, drive));
    let without = drive.ego.speed_mps.iter().filter(|v| v.is_nan()).count();
    if without > 0 {
        fill_speeds(&mut drive.ego, max_gap_s);
        drive.ego.retain(|s| s.speed_mps.is_some());
        let what = "no speed was recorded: it is differentiated from the positions";
        warnings.push(Warning::new(path, WarningKind::Default, without, what));
    }
    warnings.extend(fill_speeds_of_others(path, &mut drive.objects, max_gap_s));
    if drive.ego_among_objects {
        warnings.extend(drop_ego(path, drive));
    }
    let lane_y_m = target.right_lane_centre_y_m;
    place(drive, target.frame, lane_y_m, max_gap_s);
    warnings.extend(which_lane(path, target));
    into_lanes(path, drive, &target.road, target.lane_shape)?;
    if target.frame == FrameKind::Map && !target.own_lane_only {
        warnings.extend(on_the_road(path, &drive.ego, &target.road)?);
    }
    if target.own_lane_only {
        warnings.extend(keep_own_lane(path, drive, target.road.lane_width_m));
        warnings.extend(in_the_only_lane(path, &drive.ego, &target.road));
    }
    Ok(warnings)
}

/// Says that ego's own way stands in for the right lane of a road of several, where nothing says where they lie.
fn which_lane(path: &Path, target: &Target<'_>) -> Option<Warning> {
    let lanes = target.road.lanes;
    let is_known = target.frame == FrameKind::Map
        || target.lane_shape != LaneShape::Even
        || target.right_lane_centre_y_m != 0.0;
    (lanes > 1 && !is_known).then(|| {
        let what = format!(
            "nothing says in which of the road's {lanes} lanes ego drives: its way stands in for the right lane. In the mapping, write \
             `frame = \"map\"` with `right_lane_centre_y_m`, or `lanes_driven = true`"
        );
        Warning::new(path, WarningKind::Default, 1, what)
    })
}

/// The even rows that ego's samples reach and at which somebody looked.
///
/// # Errors
/// [`IngestError::TooManyRows`], [`IngestError::TooSparse`], [`IngestError::SeldomSeen`].
fn rows(
    path: &Path,
    drive: &RawDrive,
    target: &Target<'_>,
    warnings: &mut Vec<Warning>,
) -> Result<Grid, IngestError> {
    let time_s = seconds(&drive.ego.stamp_ns);
    let ends = time_s.last().zip(time_s.first());
    let wanted = ends.map_or(0.0, |(b, a)| b - a) * target.rate_hz;
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
    if let Some(sightings) = &drive.sightings {
        if sightings.is_empty() {
            let samples = drive.ego.len();
            return Err(IngestError::Implausible {
                path: path.to_owned(),
                count: samples,
                of: samples,
                what: "the position of the named leader is unknown".to_owned(),
            });
        }
        warnings.extend(keep_seen(path, sightings, &mut rows, target));
        if !is_drive(&rows) {
            return Err(IngestError::SeldomSeen {
                path: path.to_owned(),
                sightings: sightings.len(),
                max_gap_s: target.max_gap_s,
            });
        }
    }
    Ok(rows)
}

/// Leaves out the rows at which nobody looked who else is there: a road is not free because it was not seen.
fn keep_seen(
    path: &Path,
    sightings: &Sightings,
    rows: &mut Grid,
    target: &Target<'_>,
) -> Option<Warning> {
    let time_s = seconds(&sightings.stamp_ns);
    let seen = grid(&time_s, target.rate_hz, target.max_gap_s);
    let before = rows.rows.len();
    rows.keep(&seen);
    let left_out = before - rows.rows.len();
    (left_out > 0).then(|| {
        let what = "rows of ego at which the others are not seen are left out: a segment starts after each such hole";
        let warning = Warning::new(path, WarningKind::Hole, left_out, what);
        warning.with_spans(seen.holes_s)
    })
}

fn ego_track(ego: &EgoSamples, grid: &Grid, length_m: f64, target: &Target<'_>) -> EgoTrack {
    let (rate_hz, max_gap_s) = (target.rate_hz, target.max_gap_s);
    let rows = || grid.rows.iter();
    let across = rows().map(|r| r.across(&ego.y_m, target.lane_steps));
    EgoTrack {
        length_m,
        x_m: rows().map(|r| r.interpolated(&ego.x_m)).collect(),
        y_m: across.collect(),
        // Samples without a speed were left out above.
        speed_mps: speeds(&ego.stamp_ns, &ego.speed_mps, grid, rate_hz, max_gap_s),
    }
}

/// Leaves out the object that is ego: `/carla/objects` holds it too.
fn drop_ego(path: &Path, drive: &mut RawDrive) -> Option<Warning> {
    let mut distance: BTreeMap<u32, (f64, f64)> = BTreeMap::new();
    let mut ego = EgoPath::new(&drive.ego);
    for object in drive.objects.iter() {
        if let Some((x, y)) = ego.at(object.stamp_ns) {
            let sum = distance.entry(object.id).or_default();
            sum.0 += libm::hypot(object.x_m - x, object.y_m - y);
            sum.1 += 1.0;
        }
    }
    let near = distance.into_iter().find(|(_, (sum, n))| sum / n < EGO_ITSELF_M);
    let (id, _) = near?;
    let its_length = |o: ObjectSample| o.known_length_m().filter(|_| o.id == id);
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
    use crate::{raw::EgoSample, settings::IngestSettings};
    use maveric_domain::Road;

    fn drive(objects: impl IntoIterator<Item = ObjectSample>) -> RawDrive {
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
            objects: objects.into_iter().collect(),
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

    fn assembled(objects: impl IntoIterator<Item = ObjectSample>) -> (Recording, Vec<Warning>) {
        let settings = IngestSettings::default();
        let target = Target::mapped(&settings).unwrap();
        assemble(Path::new("log"), drive(objects), &target).unwrap()
    }

    #[test]
    fn ego_among_the_objects_and_vehicles_of_other_lanes_are_left_out() {
        let objects = (0..100).flat_map(|i| {
            [object(i, 1, 0.1, 0.0), object(i, 2, 30.0, 0.3), object(i, 3, 20.0, 3.6)]
        });
        let (recording, warnings) = assembled(objects);
        let ids: Vec<u32> = recording.others().iter().map(|t| t.id.0).collect();
        assert_eq!(ids, [2]);
        let kinds: Vec<WarningKind> = warnings.iter().map(|w| w.kind).collect();
        assert_eq!(kinds, [WarningKind::Choice, WarningKind::OtherLane]);
    }

    #[test]
    fn ego_beside_the_road_is_refused_where_lanes_are_known_and_told_of_an_only_one() {
        // How often it is told, none where it is refused.
        let told = |frame, lanes| {
            let settings = IngestSettings::default();
            let unknown = Target::mapped(&settings).unwrap();
            let road = Road { lanes, ..unknown.road };
            let target = Target { road, frame, own_lane_only: lanes == 1, ..unknown };
            let mut beside = drive(Vec::new());
            beside.ego.y_m.fill(40.0);
            let assembled = assemble(Path::new("log"), beside, &target);
            let only = |w: &&Warning| w.what.contains("the road's only lane");
            let (_, warnings) = assembled.ok()?;
            Some(warnings.iter().find(only).map_or(0, |w| w.count))
        };
        assert_eq!(told(FrameKind::Map, 3), None);
        // Of one lane nothing but ego says where it is, so that it is told; along ego's own path or line ego is never beside it.
        assert_eq!(told(FrameKind::Map, 1), Some(100));
        assert_eq!(told(FrameKind::Path, 3), Some(0));
        assert_eq!(told(FrameKind::Auto, 1), Some(0));
    }

    #[test]
    fn egos_way_stands_in_for_the_right_lane_only_where_nothing_says_where_lanes_lie() {
        let said = |change: fn(&mut Target<'_>)| {
            let settings = IngestSettings::default();
            let mut target = Target::mapped(&settings).unwrap();
            target.road.lanes = 2;
            target.own_lane_only = false;
            change(&mut target);
            let (_, warnings) = assemble(Path::new("log"), drive(Vec::new()), &target).unwrap();
            warnings.iter().any(|w| w.what.contains("road's 2 lanes"))
        };
        assert!(said(|_| ()));
        assert!(said(|target| target.frame = FrameKind::Path));
        assert!(!said(|target| target.frame = FrameKind::Map));
        assert!(!said(|target| target.right_lane_centre_y_m = -3.66));
        assert!(!said(|target| target.lane_shape = LaneShape::Edges(&[-2.0, 2.0, 6.0])));
        assert!(!said(|target| target.road.lanes = 1));
    }

    #[test]
    fn a_vehicle_that_returns_has_two_tracks_and_none_bridges_its_absence() {
        let objects = (0..100).filter(|i| !(40..60).contains(i)).map(|i| object(i, 7, 30.0, 0.0));
        let (recording, _) = assembled(objects);
        let found: Vec<(usize, usize)> =
            recording.others().iter().map(|t| (t.first_row, t.x_m.len())).collect();
        assert_eq!(found, [(0, 79), (120, 79)]);
    }
}
