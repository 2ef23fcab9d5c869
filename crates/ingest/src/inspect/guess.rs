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
    /// Least and greatest number of a lane.
    pub(super) lanes: Option<(i64, i64)>,
    /// Columns that mean nothing here.
    pub(super) unused: Vec<String>,
}

/// Guesses.
pub(super) fn guess(table: &Sheet) -> Guess {
    let reader = Reader::new(table);
    let platoon = platoon(&reader);
    let id = reader.first(Whose::Ego, What::Id);
    let groups: Vec<&TableColumn> = match id {
        Some(_) if platoon.is_none() => reader.all(Whose::Ego, What::Group).collect(),
        _ => Vec::new(),
    };
    let series = series(table, id.filter(|_| platoon.is_none()), &groups);
    let time = Time::find(&reader, &series);
    let step_s = time.step_s;
    let speed = platoon.map(|[speed, _]| speed).or_else(|| {
        let speed = reader.number(Whose::Ego, What::Speed);
        speed.or(reader.number(Whose::Ego, What::SpeedX))
    });
    // A position that does not move as the speed says is another thing's.
    let position = along(&reader, speed, step_s, &series);
    let position = position.filter(|p| p.1.is_none_or(|ratio| known_ratio(ratio).1 < SURE));
    let ratio = position.and_then(|p| p.1);
    let position = position.map(|p| p.0);
    let lengths = [Whose::Ego, Whose::Lead].map(|w| reader.number(w, What::Length));
    let gap = platoon.map(|[_, gap]| gap).or_else(|| {
        let gap = reader.number(Whose::Ego, What::Gap);
        gap.or(reader.number(Whose::Lead, What::Gap))
    });
    let unit_of = |column: Option<&TableColumn>| words(&column?.name).unit;
    let harshest = speed.and_then(|c| harshest(c, step_s, &series));
    let named_length = unit_of(position)
        .or(unit_of(gap))
        .filter(|u| LENGTHS.contains(u));
    let length_unit = length_unit(named_length, lengths, unit_of(speed), ratio, harshest);
    let speed_unit = speed_unit(unit_of(speed), length_unit.0, ratio, speed);

    let lateral = lateral(&reader, position, platoon.is_some());
    let ngsim = lateral.is_some_and(|(y, _)| y.name.eq_ignore_ascii_case("Local_X"));
    let lateral = lateral.map(|(column, named)| {
        let in_lane = place_in_lane(column, named, length_unit.0, &time.times_s, &series);
        (column, in_lane)
    });
    let lane = reader.number(Whose::Ego, What::Lane);
    let lead_x = position.and_then(|p| lead_position(&reader, p));
    let chosen = Chosen {
        reader: &reader,
        platoon,
        id,
        position,
        speed,
        lengths,
        gap,
        lead_x,
        lateral,
        lane,
    };
    let (shape, Keys { columns, offset }) = chosen.named(time.column);
    let uses_gap = columns.iter().any(|(key, _)| *key == "gap");
    let gap_kind = gap
        .filter(|_| uses_gap)
        .map(|gap| super::units::gap_kind(gap, position, lead_x, lengths[1], length_unit.0));
    let speed_x = reader.number(Whose::Ego, What::SpeedX);
    let both_ways = speed_x
        .and_then(TableColumn::range)
        .is_some_and(|(least, most)| least < -MOVING && most > MOVING);
    Guess {
        shape,
        unused: unused(table, &columns, &groups),
        groups: groups.iter().map(|g| g.name.clone()).collect(),
        time: time.unit,
        time_pattern: time.pattern,
        length: length_unit,
        speed: speed_unit,
        rate_hz: step_s.filter(|s| *s > 0.0).map(|s| 1.0 / s),
        gap_kind,
        both_ways,
        ngsim,
        offset,
        lanes: lane
            .and_then(TableColumn::range)
            .map(|(least, most)| (least.round() as i64, most.round() as i64)),
        columns,
    }
}

/// Speed and gap of the first vehicle of a platoon, where the columns of two are numbered.
fn platoon<'a>(reader: &Reader<'a>) -> Option<[&'a TableColumn; 2]> {
    let numbered = |what: What, n: u32| {
        let mut columns = reader.table.columns.iter().zip(&reader.words);
        let column = columns.find(|(_, w)| w.what == Some(what) && w.number == Some(n));
        column.map(|(c, _)| c)
    };
    numbered(What::Speed, 2)?;
    Some([numbered(What::Speed, 1)?, numbered(What::Gap, 1)?])
}

/// A name of a platoon's column without its number.
fn template(name: &str) -> String {
    let stem = name.trim_end_matches(|d: char| d.is_ascii_digit());
    format!("{stem}{{n}}")
}

/// Names of columns that mean nothing here.
fn unused(
    table: &Sheet,
    columns: &[(&'static str, String)],
    groups: &[&TableColumn],
) -> Vec<String> {
    let used = |name: &String| {
        let template = template(name);
        columns.iter().any(|(_, c)| c == name || *c == template)
            || groups.iter().any(|g| g.name == *name)
    };
    let names = table.columns.iter().map(|c| c.name.clone());
    names.filter(|n| !used(n)).collect()
}

/// What columns tell of a drive.
struct Chosen<'a> {
    reader: &'a Reader<'a>,
    platoon: Option<[&'a TableColumn; 2]>,
    id: Option<&'a TableColumn>,
    position: Option<&'a TableColumn>,
    speed: Option<&'a TableColumn>,
    /// Of ego and of its leader.
    lengths: [Option<&'a TableColumn>; 2],
    gap: Option<&'a TableColumn>,
    lead_x: Option<&'a TableColumn>,
    /// With the reason why it is a place in the lane, where it is one.
    lateral: Option<(&'a TableColumn, Option<String>)>,
    lane: Option<&'a TableColumn>,
}

/// Keys of a mapping with their columns.
#[derive(Default)]
struct Keys {
    columns: Vec<(&'static str, String)>,
    /// Why the lateral column is a place in the lane, where it is one.
    offset: Option<String>,
}

impl Keys {
    fn put(&mut self, key: &'static str, column: Option<&TableColumn>) {
        self.columns.extend(column.map(|c| (key, c.name.clone())));
    }
}

impl Chosen<'_> {
    /// The shape of a table and the columns that it needs.
    fn named(&self, time: Option<&TableColumn>) -> (Shape, Keys) {
        let mut keys = Keys::default();
        keys.put("time", time);
        let leads = self.gap.is_some() || self.lead_x.is_some();
        let shape = if let Some([speed, gap]) = self.platoon {
            keys.columns.push(("speed", template(&speed.name)));
            keys.columns.push(("gap", template(&gap.name)));
            Shape::Platoon
        } else if self.id.is_some() && self.position.is_some() {
            self.long(&mut keys);
            Shape::Long
        } else if self.speed.is_some() && leads {
            self.pair(&mut keys);
            Shape::Pair
        } else {
            if self.speed.is_some() && self.id.is_none() {
                // What is known of a pair stays for whoever fills in the rest.
                keys.put("ego_x", self.position);
                keys.put("ego_speed", self.speed);
            }
            Shape::Unknown(match (self.speed, self.id) {
                (None, _) => "no column looks like a speed",
                (_, Some(_)) => {
                    "no position moves as the speed says, so which one is along the road is not sure"
                }
                _ => "no column looks like a gap, a leader's position, or a vehicle's number",
            })
        };
        let shape = match (time, shape) {
            (None, Shape::Pair | Shape::Long | Shape::Platoon) => {
                Shape::Unknown("no column looks like a time")
            }
            (_, shape) => shape,
        };
        (shape, keys)
    }

    /// Of a table of many vehicles.
    fn long(&self, keys: &mut Keys) {
        keys.put("id", self.id);
        keys.put("x", self.position);
        match &self.lateral {
            Some((column, Some(why))) if self.lane.is_some() => {
                keys.put("offset", Some(column));
                keys.offset = Some(why.clone());
            }
            Some((column, _)) => keys.put("y", Some(column)),
            None => {}
        }
        keys.put("lane", self.lane);
        let number = |what| self.reader.number(Whose::Ego, what);
        let speed = number(What::Speed);
        keys.put("speed", speed);
        if speed.is_none() {
            keys.put("speed_x", number(What::SpeedX));
            keys.put("speed_y", number(What::SpeedY));
        }
        keys.put("length", self.lengths[0]);
        keys.put("lead_id", self.reader.first(Whose::Lead, What::Id));
        let lead_speed = self.reader.number(Whose::Lead, What::Speed);
        if self.lead_x.is_some() || self.gap.is_some() && lead_speed.is_some() {
            keys.put("lead_x", self.lead_x);
            keys.put("gap", self.gap.filter(|_| self.lead_x.is_none()));
            keys.put("lead_speed", lead_speed);
            keys.put("lead_length", self.lengths[1]);
        }
    }

    /// Of a table of a follower and its leader.
    fn pair(&self, keys: &mut Keys) {
        keys.put("ego_x", self.position);
        keys.put("ego_speed", self.speed);
        keys.put("ego_length", self.lengths[0]);
        keys.put("gap", self.gap);
        keys.put("lead_x", self.lead_x.filter(|_| self.gap.is_none()));
        keys.put("lead_speed", self.reader.number(Whose::Lead, What::Speed));
        keys.put("lead_length", self.lengths[1]);
        match &self.lateral {
            Some((column, None)) => keys.put("ego_y", Some(column)),
            Some((column, Some(why))) => {
                keys.put("offset", Some(column));
                keys.put("lane", self.lane);
                keys.offset = Some(why.clone());
            }
            None => keys.put("lane", self.lane),
        }
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
