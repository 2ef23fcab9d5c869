//! Times of a table as nanoseconds.

use super::open::{Kind, Table};
use crate::{
    error::IngestError,
    mapping::{TimeUnit, patterned},
};
use chrono::{DateTime, NaiveDateTime};

/// How the times of a table are written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Clock<'a> {
    pub(crate) unit: TimeUnit,
    /// How times are written, where they have a pattern.
    pub(crate) pattern: Option<&'a str>,
    /// Where times are numbers of frames; checked to be above 0.
    pub(crate) frames_per_s: f64,
    /// Time that is put before a part of a recording whose clock begins anew, in ns.
    pub(crate) hole_ns: i64,
}

impl Clock<'_> {
    /// What a cell of such times should hold, in words.
    fn expected(self) -> String {
        match (self.pattern, self.unit) {
            (Some(pattern), _) => format!("a time written as `{pattern}`"),
            (None, TimeUnit::Iso8601) => {
                "a date and time such as `2026-03-04T10:21:33.1`".to_owned()
            }
            (None, TimeUnit::Frames) => "the number of a frame".to_owned(),
            (None, TimeUnit::Seconds) => "a time in s".to_owned(),
            (None, TimeUnit::Milliseconds) => "a time in ms".to_owned(),
            (None, TimeUnit::Microseconds) => "a time in us".to_owned(),
            (None, TimeUnit::Nanoseconds) => "a time in ns".to_owned(),
            (None, TimeUnit::Pattern) => "a time".to_owned(),
        }
    }

    /// What a column of such times is read as.
    pub(crate) fn kind(self) -> Kind {
        match self.unit {
            TimeUnit::Iso8601 | TimeUnit::Pattern => Kind::Word,
            _ => Kind::Number,
        }
    }
}

/// A column as nanoseconds, shape `(rows,)`, as its clock says them; an empty cell is none.
///
/// # Errors
/// [`IngestError::BadCell`] for what is no time, or a time that does not fit.
pub(super) fn as_written(
    table: &Table,
    name: &str,
    clock: Clock<'_>,
) -> Result<Vec<Option<i64>>, IngestError> {
    if clock.kind() == Kind::Word {
        let words = table.words(name)?.into_iter().enumerate();
        let stamp = |(row, word): (usize, Option<String>)| match word {
            None => Ok(None),
            Some(word) => match time_in(&word, clock.pattern) {
                None => Err(table.bad_cell_of(row, name, word, &clock.expected())),
                stamp_ns => Ok(stamp_ns),
            },
        };
        let mut stamps_ns = words.map(stamp).collect::<Result<Vec<_>, _>>()?;
        over_midnight(&mut stamps_ns);
        return Ok(stamps_ns);
    }
    let stamp = |(row, value): (usize, f64)| {
        if value.is_nan() {
            return Ok(None);
        }
        let ns = match clock.unit.nanoseconds() {
            // Whole units apart: milliseconds since 1970 in nanoseconds are more than a float holds exactly.
            Some(unit) if value.abs() < 9e18 / unit as f64 => {
                let whole = value.trunc();
                (whole as i64 * unit) + ((value - whole) * unit as f64).round() as i64
            }
            None if value.abs() / clock.frames_per_s < 9e9 => {
                (value / clock.frames_per_s * 1e9).round() as i64
            }
            _ => return Err(table.bad_cell_of(row, name, value.to_string(), &clock.expected())),
        };
        Ok(Some(ns))
    };
    let numbers = table.numbers_of(name, &clock.expected())?;
    // Into room for all: a collection that may fail does not know how many come.
    let mut stamps_ns = Vec::with_capacity(numbers.len());
    for cell in numbers.into_iter().enumerate() {
        stamps_ns.push(stamp(cell)?);
    }
    over_midnight(&mut stamps_ns);
    Ok(stamps_ns)
}

/// A day, in ns.
const DAY_NS: i64 = 86_400_000_000_000;

/// Lets times of day go on over midnight: each is on the day on which it is nearest to the one in the row before.
///
/// Times of day are those of which all are within one day; a date or a stamp since 1970 is none. A table that is longer than half a
/// day then is left as it is written.
fn over_midnight(stamps_ns: &mut [Option<i64>]) {
    let half_ns = DAY_NS / 2;
    let known = || stamps_ns.iter().flatten().copied();
    let jumps = || known().zip(known().skip(1)).any(|(a, b)| a.abs_diff(b) > half_ns as u64);
    if !known().all(|ns| (0..DAY_NS).contains(&ns)) || !jumps() {
        return;
    }
    let mut before: Option<i64> = None;
    let go_on = |ns: i64| {
        let days = before.map_or(0, |before| (before - ns + half_ns).div_euclid(DAY_NS));
        let on_its_day = ns + days * DAY_NS;
        before = Some(on_its_day);
        on_its_day
    };
    let days: Vec<i64> = known().map(go_on).collect();
    let ends = days.iter().min().zip(days.iter().max());
    if ends.is_some_and(|(first, last)| last - first < half_ns) {
        for (stamp_ns, on_its_day) in stamps_ns.iter_mut().flatten().zip(days) {
            *stamp_ns = on_its_day;
        }
    }
}

/// Patterns that leave no doubt which number is what: of two before a year, between slashes, either may be the month.
const PATTERNS: [&str; 10] = [
    "%H:%M:%S",
    "%H:%M:%S.%f",
    "%H:%M:%S:%f",
    "%H:%M:%S,%f",
    "%Y%m%d %H:%M:%S.%f",
    "%Y%m%d %H:%M:%S:%f",
    "%Y/%m/%d %H:%M:%S",
    "%Y/%m/%d %H:%M:%S.%f",
    "%d.%m.%Y %H:%M:%S",
    "%d.%m.%Y %H:%M:%S.%f",
];

/// How times are written as words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    Iso8601,
    Pattern(&'static str),
}

/// Returns how words are written, if all of them are times of one form.
pub(crate) fn form_of(words: &[Option<String>]) -> Option<Form> {
    words.iter().flatten().next()?;
    let fits = |form: &Form| {
        let pattern = match form {
            Form::Iso8601 => None,
            Form::Pattern(pattern) => Some(*pattern),
        };
        let mut words = words.iter().flatten();
        words.all(|word| time_in(word, pattern).is_some())
    };
    [Form::Iso8601].into_iter().chain(PATTERNS.map(Form::Pattern)).find(fits)
}

/// The time that a word is, by a pattern or as ISO 8601, in ns.
fn time_in(word: &str, pattern: Option<&str>) -> Option<i64> {
    pattern.map_or_else(|| date(word), |pattern| patterned(word, pattern))
}

/// A date and a time of day in ns since 1970; without an offset it is UTC.
fn date(text: &str) -> Option<i64> {
    if let Ok(time) = DateTime::parse_from_rfc3339(text) {
        return time.timestamp_nanos_opt();
    }
    let formats = ["%Y-%m-%dT%H:%M:%S%.f", "%Y-%m-%d %H:%M:%S%.f"];
    let parsed =
        formats.iter().find_map(|format| NaiveDateTime::parse_from_str(text, format).ok())?;
    parsed.and_utc().timestamp_nanos_opt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raw::table::text::Style;
    use std::path::Path;

    fn of(cells: &str, unit: TimeUnit) -> Result<Vec<Option<i64>>, IngestError> {
        let clock = Clock { unit, pattern: None, frames_per_s: 25.0, hole_ns: 1_000_000_000 };
        let wanted = [("t", clock.kind())];
        let text = format!("t\n{cells}\n").into();
        let table = Table::open(Path::new("t.csv"), text, Style::default(), &wanted)?;
        as_written(&table, "t", clock)
    }

    #[test]
    fn milliseconds_since_1970_are_exact_and_frames_have_a_rate() {
        let ms = of("1118848685100", TimeUnit::Milliseconds).unwrap();
        assert_eq!(ms, [Some(1_118_848_685_100_000_000)]);
        assert_eq!(of("0.3", TimeUnit::Seconds).unwrap(), [Some(300_000_000)]);
        assert_eq!(of("5", TimeUnit::Frames).unwrap(), [Some(200_000_000)]);
        assert!(of("1e300", TimeUnit::Seconds).is_err());
    }

    #[test]
    fn dates_are_read_with_and_without_an_offset() {
        let expected = [Some(1_562_235_693_100_000_000)];
        for text in
            ["2019-07-04T10:21:33.1Z", "2019-07-04T12:21:33.1+02:00", "2019-07-04 10:21:33.1"]
        {
            assert_eq!(of(text, TimeUnit::Iso8601).unwrap(), expected, "{text}");
        }
        let error = of("yesterday", TimeUnit::Iso8601).unwrap_err();
        assert!(error.to_string().contains("`yesterday`"), "{error}");
    }
}
