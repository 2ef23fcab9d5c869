//! Guesses what the columns of a table mean by their names and the units in them.

use super::{
    columns::{Sheet, TableColumn},
    reader::Reader,
    words::{What, Whose, words},
};
use crate::raw::table::time::{Form, form_of};

/// Slower than this in a table's unit a velocity says little about the direction.
const MOVING: f64 = 2.0;
/// Columns that are tried as the position along the road, at most.
const MOST_POSITIONS: usize = 3;
/// Units of length and of speed that names may say; the first is taken where no name does.
const LENGTHS: [&str; 2] = ["m", "ft"];
const SPEEDS: [&str; 4] = ["m/s", "km/h", "mph", "ft/s"];
const TIMES: [&str; 4] = ["s", "ms", "us", "ns"];

/// What a file and a row are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    Pair,
    Long,
    Platoon,
}

/// A signal that a drive needs and that no column is named like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Missing {
    Time,
    Speed,
    Along,
    Leader,
}

impl Missing {
    /// The signal, and names that it may have.
    pub(super) fn as_str(self) -> &'static str {
        match self {
            Self::Time => {
                "a time was not found: no column of numbers, or of dates or clock times in one known form, has a name such as `time`, \
                 `t`, `timestamp`, `Zeit` or `frame`"
            }
            Self::Speed => {
                "a speed was not found: no column of numbers has a name such as `speed`, `v`, `velocity` or `Geschwindigkeit`"
            }
            Self::Along => {
                "a position along the road was not found: no column of numbers has a name such as `x`, `position` or `station`"
            }
            Self::Leader => {
                "a vehicle ahead was not found: no column of numbers has a name such as `gap`, `spacing`, `lead_x` or `Abstand`, and \
                 none such as `vehicle_id` tells vehicles apart"
            }
        }
    }
}

/// What the names of a table's columns say.
pub(super) struct Guess<'a> {
    reader: Reader<'a>,
    pub(super) shape: Result<Shape, Missing>,
    time: Option<&'a TableColumn>,
    id: Option<&'a TableColumn>,
    groups: Vec<&'a TableColumn>,
    /// Speed and gap of the first vehicle of a platoon.
    platoon: Option<[&'a TableColumn; 2]>,
    speed: Option<&'a TableColumn>,
    gap: Option<&'a TableColumn>,
    lane: Option<&'a TableColumn>,
    /// Of ego and of its leader.
    lengths: [Option<&'a TableColumn>; 2],
    /// Columns that may be the position along the road, the likeliest first.
    along: Vec<&'a TableColumn>,
}

/// What names leave open, as one proposal takes it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Choice<'a> {
    pub(super) along: Option<&'a TableColumn>,
    /// Whether a column of the place to the side is one in the lane.
    pub(super) in_lane: bool,
    /// Unit of times, and how they are written where that is not ISO 8601.
    pub(super) time: (&'static str, Option<&'static str>),
    pub(super) speed: &'static str,
}

/// Guesses.
pub(super) fn guess(table: &Sheet) -> Guess<'_> {
    let reader = Reader::new(table);
    let number = |what| reader.number(Whose::Ego, what);
    let platoon = platoon(&reader);
    let id = reader.first(Whose::Ego, What::Id).filter(|_| platoon.is_none());
    let speed =
        platoon.map(|[speed, _]| speed).or_else(|| number(What::Speed).or(number(What::SpeedX)));
    let gap = platoon
        .map(|[_, gap]| gap)
        .or_else(|| number(What::Gap).or(reader.number(Whose::Lead, What::Gap)));
    let along = along(&reader);
    let time = time(&reader);
    let leads = gap.is_some() || along.iter().any(|x| lead_position(&reader, x).is_some());
    let shape = match (id, speed) {
        _ if platoon.is_some() => Ok(Shape::Platoon),
        (Some(_), _) if !along.is_empty() => Ok(Shape::Long),
        (_, Some(_)) if leads => Ok(Shape::Pair),
        (_, None) => Err(Missing::Speed),
        (Some(_), _) => Err(Missing::Along),
        _ => Err(Missing::Leader),
    };
    Guess {
        shape: shape.and_then(|shape| time.map(|_| shape).ok_or(Missing::Time)),
        groups: if shape == Ok(Shape::Long) {
            reader.all(Whose::Ego, What::Group).collect()
        } else {
            Vec::new()
        },
        lane: number(What::Lane),
        lengths: [Whose::Ego, Whose::Lead].map(|w| reader.number(w, What::Length)),
        reader,
        time,
        id,
        platoon,
        speed,
        gap,
        along,
    }
}

/// The column of the time: of numbers, or of times that are all written in one form.
fn time<'a>(reader: &Reader<'a>) -> Option<&'a TableColumn> {
    let named = reader.all(Whose::Ego, What::Time);
    let mut named = named.chain(reader.all(Whose::Ego, What::Frame));
    named.find(|c| match &c.numbers {
        Some(_) => c.filled().next().is_some(),
        None => form_of(&c.words).is_some(),
    })
}

/// Speed and gap of the first vehicle of a platoon, where the columns of two are numbered.
fn platoon<'a>(reader: &Reader<'a>) -> Option<[&'a TableColumn; 2]> {
    let numbered = |what: What, n: u32| {
        let mut columns = reader.table.columns.iter().zip(&reader.words);
        let is = |c: &TableColumn| c.filled().next().is_some();
        let column = columns.find(|(c, w)| w.what == Some(what) && w.number == Some(n) && is(c));
        column.map(|(c, _)| c)
    };
    numbered(What::Speed, 2)?;
    Some([numbered(What::Speed, 1)?, numbered(What::Gap, 1)?])
}

/// Columns that may be the position along the road: that of NGSIM, then along x, then others.
fn along<'a>(reader: &Reader<'a>) -> Vec<&'a TableColumn> {
    let positions = reader.all(Whose::Ego, What::Position);
    let mut positions: Vec<&TableColumn> =
        positions.filter(|c| c.filled().next().is_some()).collect();
    positions.sort_by_key(|c| (!is_of_ngsim(c), words(&c.name).is_y));
    positions.truncate(MOST_POSITIONS);
    positions
}

/// Whether it is the position along the road in NGSIM, whose frame is documented.
fn is_of_ngsim(column: &TableColumn) -> bool {
    column.name.eq_ignore_ascii_case("Local_Y")
}

/// The position of the leader along the same axis as ego's.
fn lead_position<'a>(reader: &Reader<'a>, ego: &TableColumn) -> Option<&'a TableColumn> {
    let ego = ego.name.to_ascii_lowercase();
    let leads = || {
        let leads = reader.all(Whose::Lead, What::Position);
        leads.filter(|c| c.filled().next().is_some())
    };
    let stem = ego.replace("follower", "").replace("ego", "");
    let stem = stem.trim_matches('_');
    leads().find(|c| c.name.to_ascii_lowercase().contains(stem)).or_else(|| leads().next())
}

/// The position across the road: the other one.
fn across<'a>(reader: &Reader<'a>, along: &TableColumn) -> Option<&'a TableColumn> {
    let swap = |c: char| match c {
        'x' => 'y',
        'y' => 'x',
        'X' => 'Y',
        'Y' => 'X',
        c => c,
    };
    let swapped: String = along.name.chars().map(swap).collect();
    reader
        .all(Whose::Ego, What::Position)
        .find(|c| c.name == swapped && c.name != along.name && c.filled().next().is_some())
}

/// A name of a platoon's column without its number.
fn template(name: &str) -> String {
    let stem = name.trim_end_matches(|d: char| d.is_ascii_digit());
    format!("{stem}{{n}}")
}

/// Keys of a mapping with their columns.
#[derive(Default)]
struct Keys(Vec<(&'static str, String)>);

impl Keys {
    fn put(&mut self, key: &'static str, column: Option<&TableColumn>) {
        self.0.extend(column.map(|c| (key, c.name.clone())));
    }
}

impl<'a> Guess<'a> {
    /// What is taken where nothing was tried.
    pub(super) fn first_choice(&self) -> Choice<'a> {
        Choice {
            along: self.along.first().copied(),
            in_lane: self.lateral(self.along.first().copied()).is_some_and(|l| l.1),
            time: self.times()[0],
            speed: self.named_speed().unwrap_or(SPEEDS[0]),
        }
    }

    /// Every choice with one unit of time, the likeliest first.
    pub(super) fn choices(&self, time: (&'static str, Option<&'static str>)) -> Vec<Choice<'a>> {
        let mut places: Vec<Option<&TableColumn>> = self.along.iter().copied().map(Some).collect();
        // Without a position of ego the way follows from the speed.
        if self.shape != Ok(Shape::Long) && self.gap.is_some() {
            places.push(None);
        }
        let speeds = match self.named_speed() {
            Some(named) => vec![named],
            None => SPEEDS.to_vec(),
        };
        let mut choices = Vec::new();
        for along in places {
            let named = self.lateral(along);
            let sides = match named {
                Some((_, in_lane)) => vec![in_lane, !in_lane],
                None => vec![false],
            };
            for in_lane in sides {
                let choice = |&speed| Choice { along, in_lane, time, speed };
                choices.extend(speeds.iter().map(choice));
            }
        }
        choices
    }

    /// Units that times may have and patterns of how they are written, the likeliest first.
    pub(super) fn times(&self) -> Vec<(&'static str, Option<&'static str>)> {
        let Some(column) = self.time else {
            return vec![(TIMES[0], None)];
        };
        if column.numbers.is_none() {
            return match form_of(&column.words) {
                Some(Form::Pattern(pattern)) => vec![("pattern", Some(pattern))],
                _ => vec![("iso8601", None)],
            };
        }
        let named = words(&column.name);
        if named.what == Some(What::Frame) {
            return vec![("frames", None)];
        }
        let unit = TIMES.into_iter().find(|t| named.unit == Some(*t));
        let others = TIMES.into_iter().filter(|t| unit != Some(*t));
        unit.into_iter().chain(others).map(|t| (t, None)).collect()
    }

    /// Whether the name of the time says its unit, or its cells do.
    pub(super) fn names_time(&self, unit: &str) -> bool {
        let named = self.time.and_then(|c| words(&c.name).unit);
        named == Some(unit) || ["iso8601", "pattern"].contains(&unit)
    }

    /// The unit of speeds, where a name says it.
    pub(super) fn named_speed(&self) -> Option<&'static str> {
        let unit = self.speed.and_then(|c| words(&c.name).unit);
        unit.filter(|u| SPEEDS.contains(u))
    }

    /// The unit of lengths, where a name says it.
    pub(super) fn named_length(&self, choice: &Choice<'_>) -> Option<&'static str> {
        let columns = [choice.along, self.gap, self.lengths[0], self.lengths[1]];
        let mut units = columns.into_iter().flatten().map(|c| words(&c.name).unit);
        units.find_map(|unit| unit.filter(|u| LENGTHS.contains(u)))
    }

    /// The unit of lengths where no name says it.
    pub(super) const LENGTH: &'static str = LENGTHS[0];

    /// The column of the place to the side, and whether its name says that it is one in the lane.
    fn lateral(&self, along: Option<&TableColumn>) -> Option<(&'a TableColumn, bool)> {
        let number = |what| self.reader.number(Whose::Ego, what);
        if self.shape == Ok(Shape::Platoon) {
            return None;
        }
        let beside = along.and_then(|along| across(&self.reader, along));
        let beside = beside.or_else(|| number(What::Lateral));
        let in_lane = || number(What::Offset).map(|c| (c, true));
        beside.map(|c| (c, false)).or_else(in_lane)
    }

    /// What a gap is measured between by its name, and the doubt about it; none where no gap is used.
    pub(super) fn gap_kind(&self) -> Option<(&'static str, &'static str)> {
        let name = self.gap?.name.to_ascii_lowercase();
        Some(if name.contains("headway") || name.contains("dhw") {
            let why = "a headway is usually from front to front; check what yours is";
            ("front_to_front", why)
        } else {
            ("bumper_to_bumper", "no name says what the gap is between")
        })
    }

    /// Whether some vehicles drive along x and some against it.
    pub(super) fn drives_both_ways(&self) -> bool {
        let speed = self.reader.number(Whose::Ego, What::SpeedX);
        let range = speed.and_then(TableColumn::range);
        range.is_some_and(|(least, most)| least < -MOVING && most > MOVING)
    }

    /// Whether positions are those of NGSIM.
    pub(super) fn is_of_ngsim(&self) -> bool {
        self.along.first().is_some_and(|c| is_of_ngsim(c))
    }

    /// Least and greatest number of a lane.
    pub(super) fn lanes(&self) -> Option<(i64, i64)> {
        let (least, most) = self.lane?.range()?;
        Some((least.round() as i64, most.round() as i64))
    }

    /// Names of what a vehicle's number needs to be its own.
    pub(super) fn groups(&self) -> impl Iterator<Item = &'a str> {
        self.groups.iter().map(|c| c.name.as_str())
    }

    /// Keys of a mapping with their columns.
    pub(super) fn columns(&self, choice: &Choice<'_>) -> Vec<(&'static str, String)> {
        let mut keys = Keys::default();
        keys.put("time", self.time);
        match (self.shape, self.platoon) {
            (_, Some([speed, gap])) => {
                keys.0.push(("speed", template(&speed.name)));
                keys.0.push(("gap", template(&gap.name)));
            }
            (Ok(Shape::Long), _) => self.long(choice, &mut keys),
            _ => self.pair(choice, &mut keys),
        }
        keys.0
    }

    /// Of a table of many vehicles.
    fn long(&self, choice: &Choice<'_>, keys: &mut Keys) {
        let number = |what| self.reader.number(Whose::Ego, what);
        keys.put("id", self.id);
        keys.put("x", choice.along);
        let in_lane = choice.in_lane && self.lane.is_some();
        let side = if in_lane { "offset" } else { "y" };
        keys.put(side, self.lateral(choice.along).map(|l| l.0));
        keys.put("lane", self.lane);
        let speed = number(What::Speed);
        keys.put("speed", speed);
        if speed.is_none() {
            keys.put("speed_x", number(What::SpeedX));
            keys.put("speed_y", number(What::SpeedY));
        }
        keys.put("length", self.lengths[0]);
        keys.put("lead_id", self.reader.first(Whose::Lead, What::Id));
        let lead_x = choice.along.and_then(|x| lead_position(&self.reader, x));
        let lead_speed = self.reader.number(Whose::Lead, What::Speed);
        if lead_x.is_some() || self.gap.is_some() && lead_speed.is_some() {
            keys.put("lead_x", lead_x);
            keys.put("gap", self.gap.filter(|_| lead_x.is_none()));
            keys.put("lead_speed", lead_speed);
            keys.put("lead_length", self.lengths[1]);
        }
    }

    /// Of a table of a follower and its leader.
    fn pair(&self, choice: &Choice<'_>, keys: &mut Keys) {
        keys.put("ego_x", choice.along);
        keys.put("ego_speed", self.speed);
        keys.put("ego_length", self.lengths[0]);
        keys.put("gap", self.gap);
        let lead_x = choice.along.and_then(|x| lead_position(&self.reader, x));
        keys.put("lead_x", lead_x.filter(|_| self.gap.is_none()));
        keys.put("lead_speed", self.reader.number(Whose::Lead, What::Speed));
        keys.put("lead_length", self.lengths[1]);
        match self.lateral(choice.along) {
            Some((column, _)) if !choice.in_lane => keys.put("ego_y", Some(column)),
            lateral => {
                keys.put("offset", lateral.map(|l| l.0));
                keys.put("lane", self.lane);
            }
        }
    }

    /// Names of columns that mean nothing here.
    pub(super) fn unused(&self, columns: &[(&'static str, String)]) -> Vec<&'a str> {
        let is_used = |name: &str| {
            let template = template(name);
            let of_key = |(_, c): &(&str, String)| c == name || *c == template;
            columns.iter().any(of_key) || self.groups().any(|g| g == name)
        };
        let names = self.reader.table.columns.iter().map(|c| c.name.as_str());
        names.filter(|n| !is_used(n)).collect()
    }
}
