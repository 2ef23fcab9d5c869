//! A follower and its leader: the columns of a file of pairs, or two neighbours of a platoon.

use super::{TableDrive, TableLog, ids, lane::Lanes, open::Kind, parts::stamps};
use crate::{
    error::IngestError,
    mapping::{GapKind, Pair, Point},
    quality::{WarningKind, report},
    raw::{EgoSample, EgoSamples, LEADER, ObjectSample, PairRows, RawDrive, Sighting},
    speed_limits::MOVING_MPS,
};
use maveric_domain::Sees;
use std::{collections::BTreeMap, path::Path};

/// Gaps and speeds of less are 0, in m and m/s.
const NOTHING: f64 = 1e-9;
/// Leaders without a number whose lengths differ by less are of one length, in m.
const SAME_LENGTH_M: f64 = 1.0;

/// What columns say of the lane that ego is in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Lane {
    /// Nothing: a place in it at most.
    Unknown,
    /// Its number alone, so that ego steps from centre to centre.
    Number,
    /// Ego's place across the road.
    Place,
}

impl Lane {
    /// By the columns that there are: of a position across the road, of the lane's number, and of the place in it.
    pub(super) fn known_by(across: bool, number: bool, place: bool) -> Self {
        match (across, number, place) {
            (true, ..) | (_, true, true) => Self::Place,
            (_, true, false) => Self::Number,
            (_, false, _) => Self::Unknown,
        }
    }
}

/// A follower and its leader in SI units, one entry a row; NaN stands for an empty cell.
pub(super) struct Couple {
    pub(super) stamp_ns: Vec<Option<i64>>,
    /// Without it the speed is integrated.
    pub(super) ego_x_m: Option<Vec<f64>>,
    pub(super) ego_speed_mps: Vec<f64>,
    pub(super) ego_length: Length,
    pub(super) ego_y_m: Option<Vec<f64>>,
    pub(super) lane: Lane,
    /// From bumper to bumper; if `signed`, negative where the other vehicle is behind.
    pub(super) gap_m: Vec<f64>,
    pub(super) signed: bool,
    /// Who is ahead, none for nobody; without it always the same.
    pub(super) lead_id: Option<Vec<Option<u32>>>,
    pub(super) lead_dy_m: Option<Vec<f64>>,
    /// Without it the leader's position is differentiated.
    pub(super) lead_speed_mps: Option<Vec<f64>>,
    pub(super) lead_length_m: Vec<f64>,
    /// Whether the length in each row is the mapping's, since the column holds none; empty if it is in no row.
    pub(super) stands_in: Vec<bool>,
    /// Whether it is always the same leader although no number says so.
    pub(super) one_leader: bool,
}

/// Reads a file of one pair.
pub(super) fn read(log: &mut TableLog<'_>, pair: &Pair) -> Result<TableDrive, IngestError> {
    let (mapping, names, clock) = (log.mapping, &pair.columns, log.clock());
    let given = mapping.layout.columns();
    let mut wanted = vec![(names.time.as_str(), clock.kind())];
    let of_rows = given.iter().filter(|(key, _)| key != "time");
    wanted.extend(of_rows.map(|(key, name)| {
        let word = key == "lead_id";
        (name.as_str(), if word { Kind::Word } else { Kind::Number })
    }));
    let table = log.open(&wanted)?;
    let column = |name: &Option<String>, unit| table.scaled(name.as_ref(), unit);
    let length = mapping.units.length.metres();
    let speed = mapping.units.speed.metres_per_second();
    let ego_length = first_length(column(&names.ego_length, length)?, mapping.ego_length_m);
    let ego_length_m = ego_length.length_m;
    let along = pair.forward.sign() * length;
    let ego_x_m = column(&names.ego_x, along)?;
    let lead_id: Option<Vec<Option<u32>>> = match &names.lead_id {
        Some(name) if table.has(name) => {
            let (codes, names) = table.codes(name)?;
            let numbers = ids::numbers(&names);
            let number = |code: u32| numbers[code as usize];
            Some(codes.into_iter().map(|c| c.map(number)).collect())
        }
        _ => None,
    };
    let (lead_length_m, stands_in) = match column(&names.lead_length, length)? {
        Some(lengths) => leaders_lengths(lengths, lead_id.as_deref(), mapping.lead_length_m),
        None => (vec![mapping.lead_length_m; table.rows()], Vec::new()),
    };
    let gap_m: Vec<f64> = if let Some(gap) = column(&names.gap, length)? {
        let gap = gap.into_iter().zip(&lead_length_m);
        gap.map(|(g, lead_m)| bumper_gap_m(g, mapping.gap_kind, ego_length_m, *lead_m)).collect()
    } else {
        let lead = column(&names.lead_x, along)?.unwrap_or_default();
        let ego = ego_x_m.as_deref().unwrap_or_default();
        let taken_m = |lead_length_m: f64| match pair.point {
            Some(Point::Rear) => ego_length_m,
            Some(Point::Front) => lead_length_m,
            _ => 0.5 * (ego_length_m + lead_length_m),
        };
        let rows = lead.iter().zip(ego).zip(&lead_length_m);
        rows.map(|((l, e), length)| l - e - taken_m(*length)).collect()
    };
    let lanes = Lanes::new(mapping, log.road, pair.offset_grows);
    let (lane, offset) = (column(&names.lane, 1.0)?, column(&names.offset, 1.0)?);
    let numbers = lane.iter().flatten().copied();
    let places = offset.iter().flatten().copied();
    log.warnings.extend(lanes.doubts(log.path, numbers, places)?);
    let couple = Couple {
        stamp_ns: stamps(&table, &names.time, clock)?,
        ego_x_m,
        ego_y_m: match column(&names.ego_y, along)? {
            None => lanes.across_m(lane.as_deref(), offset.as_deref()),
            across => across,
        },
        lane: Lane::known_by(names.ego_y.is_some(), lane.is_some(), offset.is_some()),
        signed: mapping.gap_kind == Some(GapKind::Signed),
        lead_id,
        lead_dy_m: column(&names.lead_dy, along)?,
        ego_speed_mps: table.times(&names.ego_speed, speed)?,
        ego_length,
        gap_m,
        lead_speed_mps: column(&names.lead_speed, speed)?,
        lead_length_m,
        stands_in,
        one_leader: false,
    };
    if couple.gap_m.len() != couple.stamp_ns.len() {
        let what = "neither `gap` nor `ego_x` with `lead_x` is a column of this table";
        return Err(IngestError::bad_mapping(log.path, what));
    }
    Ok(drive(log.path, couple))
}

/// The length of a vehicle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Length {
    pub(super) length_m: f64,
    /// Whether it is the mapping's, since a column of it holds none.
    pub(super) stands_in: bool,
}

/// A vehicle does not grow: its length is the first that is known.
pub(super) fn first_length(lengths: Option<Vec<f64>>, otherwise_m: f64) -> Length {
    let has_column = lengths.is_some();
    let known = lengths.into_iter().flatten().find(|l| *l > 0.0);
    Length { length_m: known.unwrap_or(otherwise_m), stands_in: has_column && known.is_none() }
}

/// The leader's length in each row, in m: the first that is known of each leader, or of those without a number the one that
/// stands in the row, as long as it stays about the same. With it, in which rows the mapping's stands in.
fn leaders_lengths(
    mut lengths: Vec<f64>,
    lead_id: Option<&[Option<u32>]>,
    otherwise_m: f64,
) -> (Vec<f64>, Vec<bool>) {
    if let Some(ids) = lead_id {
        let mut first: BTreeMap<u32, f64> = BTreeMap::new();
        for (id, length) in ids.iter().zip(&lengths) {
            if let Some(id) = id.filter(|_| *length > 0.0) {
                first.entry(id).or_insert(*length);
            }
        }
        let length_of = |id: &Option<u32>| id.and_then(|id| first.get(&id)).copied();
        let known: Vec<Option<f64>> = ids.iter().map(length_of).collect();
        let lengths = known.iter().map(|length| length.unwrap_or(otherwise_m)).collect();
        return (lengths, known.iter().map(Option::is_none).collect());
    }
    let known = lengths.iter().copied().find(|l| *l > 0.0);
    let mut now = known.unwrap_or(otherwise_m);
    for length in &mut lengths {
        if *length > 0.0 && (*length - now).abs() > SAME_LENGTH_M {
            now = *length;
        }
        *length = now;
    }
    let stands_in = if known.is_none() { vec![true; lengths.len()] } else { Vec::new() };
    (lengths, stands_in)
}

/// The gap between bumpers behind a gap of some kind, in m.
pub(super) fn bumper_gap_m(
    gap_m: f64,
    kind: Option<GapKind>,
    ego_length_m: f64,
    lead_length_m: f64,
) -> f64 {
    match kind {
        Some(GapKind::FrontToFront) => gap_m - lead_length_m,
        Some(GapKind::CentreToCentre) => gap_m - 0.5 * (ego_length_m + lead_length_m),
        Some(GapKind::BumperToBumper | GapKind::Signed) | None => gap_m,
    }
}

/// The drive of a follower: the leader's centre is put where its bumper is as far from ego's as the table says.
pub(super) fn drive(path: &Path, couple: Couple) -> TableDrive {
    let rows = couple.stamp_ns.len();
    let beside = couple.lane != Lane::Unknown || couple.lead_dy_m.is_some();
    let mut drive = TableDrive {
        raw: RawDrive {
            ego_length_m: Some(couple.ego_length.length_m),
            pair: Some(PairRows {
                x_from_speed: couple.ego_x_m.is_none(),
                unnumbered: couple.lead_id.is_none() && !couple.one_leader,
            }),
            sees: Sees {
                // Whose leader may be behind keeps in sight whom it passes.
                beside: couple.signed && couple.lead_dy_m.is_some(),
                behind: couple.signed,
                lanes: couple.lane != Lane::Unknown,
                ..Sees::LEAD
            },
            ..RawDrive::default()
        },
        lane_steps: couple.lane == Lane::Number,
        ..TableDrive::default()
    };
    let with_leader = leader(&couple, &mut drive);
    let ego_length = couple.ego_length;
    let ego = ego(couple);
    if !with_leader.lost_rows.is_empty() {
        let is_lost = |nth: &u32| with_leader.lost_rows.binary_search(nth).is_ok();
        let seen = ego.iter().filter(|s| !is_lost(&s.nth));
        let sighting =
            |s: EgoSample| Sighting { stamp_ns: s.stamp_ns, log_ns: s.log_ns, nth: s.nth };
        drive.raw.sightings = Some(seen.map(sighting).collect());
    }
    let without_ego = rows - ego.len();
    let objects = &drive.raw.objects;
    let several = objects.id.windows(2).any(|w| w[0] != w[1]);
    drive.raw.without_lateral = !beside && (several || with_leader.passed);
    drive.raw.ego = ego;
    let what = format!("ego's length is not known: {} m stands in", ego_length.length_m);
    let count = usize::from(ego_length.stands_in);
    report(&mut drive.warnings, path, WarningKind::Default, count, &what);
    let what = "rows whose leader's length is not known: the mapping's `lead_length_m` stands in";
    report(&mut drive.warnings, path, WarningKind::Default, with_leader.without_length, what);
    let kind = WarningKind::MissingValue;
    let what = "rows without time, position or speed of ego are left out";
    report(&mut drive.warnings, path, kind, without_ego, what);
    let what = "rows without gap or speed of the leader have no leader";
    report(&mut drive.warnings, path, kind, with_leader.without, what);
    let what = "rows hold a leader without its gap or speed: whether the road is free is unknown";
    report(&mut drive.warnings, path, kind, with_leader.lost_rows.len(), what);
    let what = "rows with a gap and a speed of the leader of 0 have no leader: ego drives in some of them, so that 0 stands for nobody ahead";
    report(&mut drive.warnings, path, kind, with_leader.nobody, what);
    drive
}

impl Couple {
    /// Who is ahead in a row, by its number.
    fn lead_id(&self, row: usize) -> Option<u32> {
        self.lead_id.as_ref().map_or(Some(LEADER), |ids| ids[row])
    }

    /// Whether gap and speed of the leader are 0 in a row: it stands at ego's bumper, or is nobody.
    fn is_zero(&self, row: usize) -> bool {
        let is_nothing = |column: &[f64]| column[row].abs() < NOTHING;
        let speed_mps = self.lead_speed_mps.as_deref();
        let is_there = !self.signed && self.lead_id(row).is_some();
        is_there && is_nothing(&self.gap_m) && speed_mps.is_some_and(is_nothing)
    }

    /// Whether 0 stands for nobody ahead: in some row the leader would stand at the bumper of a car that drives.
    fn has_zero_for_nobody(&self) -> bool {
        let drives = |row: usize| self.ego_speed_mps[row] > MOVING_MPS;
        (0..self.stamp_ns.len()).any(|row| drives(row) && self.is_zero(row))
    }

    /// Ego's time in a row, where it has time, position and speed.
    fn ego_ns(&self, row: usize) -> Option<i64> {
        let x_m = self.ego_x_m.as_ref().map_or(0.0, |x| x[row]);
        self.stamp_ns[row].filter(|_| x_m.is_finite() && self.ego_speed_mps[row].is_finite())
    }
}

/// What the rows of a leader say of it.
#[derive(Default)]
struct WithLeader {
    /// Rows of ego without gap and speed of a leader.
    without: usize,
    /// Rows of ego with a leader whose gap or speed is unknown, rising.
    lost_rows: Vec<u32>,
    /// Rows of ego in which 0 stands for nobody.
    nobody: usize,
    /// Rows whose leader has the mapping's length, since its column holds none.
    without_length: usize,
    /// Whether it was behind ego once.
    passed: bool,
}

/// Takes the leader's rows, in which ego is too, into a drive.
fn leader(couple: &Couple, drive: &mut TableDrive) -> WithLeader {
    let mut with_leader = WithLeader::default();
    let zero_is_nobody = couple.has_zero_for_nobody();
    let objects = &mut drive.raw.objects;
    objects.reserve_exact(couple.stamp_ns.len());
    for row in 0..couple.stamp_ns.len() {
        let (Some(stamp_ns), Some(id)) = (couple.ego_ns(row), couple.lead_id(row)) else {
            continue;
        };
        let (gap_m, length_m) = (couple.gap_m[row], couple.lead_length_m[row]);
        let centres_m = 0.5 * (couple.ego_length.length_m + length_m);
        let behind = couple.signed && gap_m < 0.0;
        let of_row = |column: &Option<Vec<f64>>| column.as_ref().map_or(0.0, |c| c[row]);
        let x_m = of_row(&couple.ego_x_m) + gap_m + if behind { -centres_m } else { centres_m };
        let speed_mps = couple.lead_speed_mps.as_ref().map(|s| s[row]);
        if !x_m.is_finite() || speed_mps.is_some_and(f64::is_nan) {
            // Who has a number or a gap is there.
            if couple.lead_id.is_some() || gap_m.is_finite() {
                with_leader.lost_rows.push(row as u32);
            } else {
                with_leader.without += 1;
            }
            continue;
        }
        if zero_is_nobody && couple.is_zero(row) {
            with_leader.nobody += 1;
            continue;
        }
        with_leader.passed |= behind;
        with_leader.without_length += usize::from(couple.stands_in.get(row) == Some(&true));
        if !couple.signed {
            drive.gaps.note(stamp_ns, gap_m);
        }
        objects.push(ObjectSample {
            stamp_ns,
            log_ns: stamp_ns,
            nth: row as u32,
            id,
            x_m,
            y_m: of_row(&couple.ego_y_m) + of_row(&couple.lead_dy_m),
            speed_mps: speed_mps.unwrap_or(f64::NAN),
            length_m,
        });
    }
    with_leader
}

/// Ego's samples: the columns themselves, where ego is in every row.
fn ego(couple: Couple) -> EgoSamples {
    let rows: Vec<usize> =
        (0..couple.stamp_ns.len()).filter(|&row| couple.ego_ns(row).is_some()).collect();
    let taken = |column: Vec<f64>| {
        if rows.len() == column.len() {
            column
        } else {
            rows.iter().map(|&row| column[row]).collect()
        }
    };
    let zeros = || vec![0.0; rows.len()];
    let stamps = rows.iter().filter_map(|&row| couple.stamp_ns[row]);
    let stamp_ns: Vec<i64> = stamps.collect();
    EgoSamples {
        log_ns: stamp_ns.clone(),
        nth: rows.iter().map(|&row| row as u32).collect(),
        x_m: couple.ego_x_m.map_or_else(zeros, taken),
        y_m: couple.ego_y_m.map_or_else(zeros, taken),
        yaw_rad: zeros(),
        speed_mps: taken(couple.ego_speed_mps),
        stamp_ns,
    }
}
