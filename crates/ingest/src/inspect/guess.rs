//! Guesses what the columns of a table mean, by their names and by what the numbers do.

use super::{
    beside::{lateral, place_in_lane},
    columns::{Sheet, TableColumn},
    reader::{Reader, series, steps},
    times::{MOVING, Time},
    units::{Guessed, LENGTHS, known_ratio, length_unit, speed_unit},
    words::{What, Whose, words},
};
use crate::median::median;

/// How far the ratio of speed and movement may be off a known one, as a logarithm: a tenth.
const SURE: f64 = 0.1;
/// What a file and a row are, as guessed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    Pair,
    Long,
    Platoon,
    /// Neither: what is missing.
    Unknown(&'static str),
}

/// A guess at a mapping.
#[derive(Debug, Clone)]
pub(super) struct Guess {
    pub(super) shape: Shape,
    /// Key of the mapping and column.
    pub(super) columns: Vec<(&'static str, String)>,
    pub(super) groups: Vec<String>,
    pub(super) time: Guessed,
    /// How times are written, where that is not ISO 8601.
    pub(super) time_pattern: Option<&'static str>,
    pub(super) length: Guessed,
    pub(super) speed: Guessed,
    /// Samples a second of one vehicle.
    pub(super) rate_hz: Option<f64>,
    pub(super) gap_kind: Option<(&'static str, String)>,
    pub(super) both_ways: bool,
    /// Why the lateral position is a place in the lane, where it is one.
    pub(super) offset: Option<String>,
    /// Names are those of NGSIM, whose frame is documented.
    pub(super) ngsim: bool,
    /// Greatest number of a lane.
    pub(super) lanes: Option<u8>,
    /// Columns that mean nothing here.
    pub(super) unused: Vec<String>,
}

/// Guesses.
pub(super) fn guess(table: &Sheet) -> Guess {
    let reader = Reader::new(table);
    let numbered = |what: What, n: u32| {
        let columns = table.columns.iter().zip(&reader.words);
        let mut found = columns.filter(|(_, w)| w.what == Some(what) && w.number == Some(n));
        found.next().map(|(c, _)| c)
    };
    let platoon = [
        numbered(What::Speed, 1),
        numbered(What::Speed, 2),
        numbered(What::Gap, 1),
    ];
    let id = reader.first(Whose::Ego, What::Id);
    let platoon = platoon.iter().all(Option::is_some).then_some(platoon);

    let groups: Vec<&TableColumn> = match id {
        Some(_) if platoon.is_none() => reader.all(Whose::Ego, What::Group).collect(),
        _ => Vec::new(),
    };
    let series = series(table, id.filter(|_| platoon.is_none()), &groups);
    let time = Time::of(&reader, &series);
    let step_s = time.step_s;
    let speed_column = match &platoon {
        Some([speed, ..]) => *speed,
        None => reader
            .number(Whose::Ego, What::Speed)
            .or(reader.number(Whose::Ego, What::SpeedX)),
    };
    // A position that does not move as the speed says is another thing's.
    let position = along(&reader, speed_column, step_s, &series);
    let position = position.filter(|p| p.1.is_none_or(|ratio| known_ratio(ratio).1 < SURE));
    let lengths = [Whose::Ego, Whose::Lead].map(|w| reader.number(w, What::Length));
    let unit_of = |column: Option<&TableColumn>| words(&column?.name).unit;
    let named = [speed_column, position.map(|p| p.0)].map(unit_of);
    let gap_column = match &platoon {
        Some([_, _, gap]) => *gap,
        None => reader
            .number(Whose::Ego, What::Gap)
            .or(reader.number(Whose::Lead, What::Gap)),
    };
    let ratio = position.and_then(|p| p.1);
    let harshest = speed_column.and_then(|c| harshest(c, step_s, &series));
    let named_length = named[1]
        .or(unit_of(gap_column))
        .filter(|u| LENGTHS.contains(u));
    let length = length_unit(named_length, lengths, named[0], ratio, harshest);
    let speed = speed_unit(named[0], length.0, ratio, speed_column);

    let lateral = lateral(&reader, position.map(|p| p.0), platoon.is_some());
    let ngsim = lateral.is_some_and(|(y, _)| y.name.eq_ignore_ascii_case("Local_X"));
    let lateral = lateral.map(|(column, named)| {
        let in_lane = place_in_lane(column, named, length.0, &time.times_s, &series);
        (column, in_lane)
    });
    let mut columns: Vec<(&'static str, String)> = Vec::new();
    let mut put = |key: &'static str, column: Option<&TableColumn>| {
        if let Some(column) = column {
            columns.push((key, column.name.clone()));
        }
    };
    put("time", time.column);
    let lead_x = position.and_then(|(p, _)| lead_position(&reader, p));
    let lead_speed = reader.number(Whose::Lead, What::Speed);
    let lead_length = lengths[1];
    let lane = reader.number(Whose::Ego, What::Lane);
    let mut offset = None;
    let shape = if let Some([Some(speed), _, Some(gap)]) = platoon {
        let numbered = |c: &TableColumn| {
            let stem = c.name.trim_end_matches(|d: char| d.is_ascii_digit());
            format!("{stem}{{n}}")
        };
        columns.push(("speed", numbered(speed)));
        columns.push(("gap", numbered(gap)));
        Shape::Platoon
    } else if let (Some(id), Some((x, _))) = (id, position) {
        put("id", Some(id));
        put("x", Some(x));
        match lateral {
            Some((column, Some(why))) if lane.is_some() => {
                put("offset", Some(column));
                offset = Some(why);
            }
            Some((column, _)) => put("y", Some(column)),
            None => {}
        }
        put("lane", lane);
        let speed = reader.number(Whose::Ego, What::Speed);
        put("speed", speed);
        if speed.is_none() {
            put("speed_x", reader.number(Whose::Ego, What::SpeedX));
            put("speed_y", reader.number(Whose::Ego, What::SpeedY));
        }
        put("length", lengths[0]);
        put("lead_id", reader.first(Whose::Lead, What::Id));
        if lead_x.is_some() || gap_column.is_some() && lead_speed.is_some() {
            put("lead_x", lead_x);
            put("gap", gap_column.filter(|_| lead_x.is_none()));
            put("lead_speed", lead_speed);
            put("lead_length", lead_length);
        }
        Shape::Long
    } else if let (Some(speed), true) = (speed_column, gap_column.is_some() || lead_x.is_some()) {
        put("ego_x", position.map(|p| p.0));
        put("ego_speed", Some(speed));
        put("ego_length", lengths[0]);
        put("gap", gap_column);
        put("lead_x", lead_x.filter(|_| gap_column.is_none()));
        put("lead_speed", lead_speed);
        put("lead_length", lead_length);
        match lateral {
            Some((column, None)) => put("ego_y", Some(column)),
            Some((column, Some(why))) => {
                put("offset", Some(column));
                put("lane", lane);
                offset = Some(why);
            }
            None => put("lane", lane),
        }
        Shape::Pair
    } else if speed_column.is_none() {
        Shape::Unknown("no column looks like a speed")
    } else if id.is_some() {
        Shape::Unknown(
            "no position moves as the speed says, so which one is along the road is not sure",
        )
    } else {
        Shape::Unknown("no column looks like a gap, a leader's position, or a vehicle's number")
    };
    let shape = match (time.column, shape) {
        (None, Shape::Pair | Shape::Long | Shape::Platoon) => {
            Shape::Unknown("no column looks like a time")
        }
        (_, shape) => shape,
    };
    let uses_gap = columns.iter().any(|(key, _)| *key == "gap");
    let gap_kind = gap_column.filter(|_| uses_gap).map(|gap| {
        let x = position.map(|p| p.0);
        super::units::gap_kind(gap, x, lead_x, lead_length, length.0)
    });
    let used = |name: &String| {
        let stem = name.trim_end_matches(|d: char| d.is_ascii_digit());
        let platoon = format!("{stem}{{n}}");
        columns.iter().any(|(_, c)| c == name || *c == platoon)
            || groups.iter().any(|g| g.name == *name)
    };
    let unused = table
        .columns
        .iter()
        .map(|c| c.name.clone())
        .filter(|n| !used(n))
        .collect();
    let both_ways = reader
        .number(Whose::Ego, What::SpeedX)
        .and_then(TableColumn::range)
        .is_some_and(|(least, most)| least < -MOVING && most > MOVING);
    Guess {
        shape,
        unused,
        groups: groups.iter().map(|g| g.name.clone()).collect(),
        time: time.unit,
        time_pattern: time.pattern,
        length,
        speed,
        rate_hz: step_s.filter(|s| *s > 0.0).map(|s| 1.0 / s),
        gap_kind,
        both_ways,
        ngsim,
        offset,
        lanes: lane.and_then(TableColumn::range).map(|r| r.1 as u8),
        columns,
    }
}

/// The position that moves as the speed says, with the speed's ratio to that movement.
fn along<'a>(
    reader: &Reader<'a>,
    speed: Option<&TableColumn>,
    step_s: Option<f64>,
    series: &[u32],
) -> Option<(&'a TableColumn, Option<f64>)> {
    let positions = reader
        .all(Whose::Ego, What::Position)
        .filter(|c| c.numbers.is_some());
    let judged = positions.map(|position| {
        let ratios = speed.and_then(|v| ratio(position, v, step_s?, series));
        (position, ratios)
    });
    let error = |ratio: &Option<f64>| ratio.map_or(f64::INFINITY, |r| known_ratio(r).1);
    judged.min_by(|a, b| error(&a.1).total_cmp(&error(&b.1)))
}

/// The median ratio of a speed to what a position changes in a second.
fn ratio(position: &TableColumn, speed: &TableColumn, step_s: f64, series: &[u32]) -> Option<f64> {
    let (x, v) = (position.numbers.as_ref()?, speed.numbers.as_ref()?);
    let moving = steps(series).filter(|&(a, _)| v[a].abs() > MOVING);
    let ratios = moving.map(|(a, b)| (v[a] * step_s / (x[b] - x[a])).abs());
    median(&mut ratios.filter(|r| r.is_finite()).collect::<Vec<f64>>())
}

/// The position of the leader along the same axis as ego's.
fn lead_position<'a>(reader: &Reader<'a>, ego: &TableColumn) -> Option<&'a TableColumn> {
    let ego = ego.name.to_ascii_lowercase();
    let mut leads = reader.all(Whose::Lead, What::Position);
    let mut same = reader.all(Whose::Lead, What::Position);
    let stem = ego.replace("follower", "").replace("ego", "");
    let stem = stem.trim_matches('_');
    same.find(|c| c.name.to_ascii_lowercase().contains(stem))
        .or_else(|| leads.next())
}

/// How hard the speed changes, in its unit a second, over about a second: the greatest but for one in a hundred.
fn harshest(speed: &TableColumn, step_s: Option<f64>, series: &[u32]) -> Option<f64> {
    let v = speed.numbers.as_ref()?;
    let step_s = step_s.filter(|s| *s > 0.0)?;
    let lag = ((1.0 / step_s).round() as usize).clamp(1, 1000);
    let same = (lag..v.len()).filter(|&i| series[i] == series[i - lag]);
    let mut changes: Vec<f64> = same
        .map(|i| ((v[i] - v[i - lag]) / (lag as f64 * step_s)).abs())
        .filter(|c| c.is_finite())
        .collect();
    changes.sort_by(f64::total_cmp);
    changes.get(changes.len() * 99 / 100).copied()
}
