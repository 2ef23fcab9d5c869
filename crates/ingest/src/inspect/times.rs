//! Which column of a table is the time.

use super::{
    columns::TableColumn,
    reader::{Reader, steps},
    units::{Guessed, Reason, seconds, time_unit},
    words::{What, Whose, words},
};
use crate::{median::median, raw::table::time::written};
use std::borrow::Cow;

/// Slowest speed, in the table's unit, that tells how a position moves.
pub(super) const MOVING: f64 = 2.0;

/// The time of a table.
pub(super) struct Time<'a> {
    pub(super) column: Option<&'a TableColumn>,
    /// Its unit, and why.
    pub(super) unit: Guessed,
    /// How times are written, where that is not ISO 8601.
    pub(super) pattern: Option<&'static str>,
    /// In s, shape `(rows,)`; empty without a column.
    pub(super) times_s: Vec<f64>,
    /// The usual step between two rows of a vehicle, in s.
    pub(super) step_s: Option<f64>,
}

impl<'a> Time<'a> {
    /// The time of a table whose rows are of vehicles: by its name, else by its cells.
    pub(super) fn find(reader: &Reader<'a>, series: &[u32]) -> Self {
        let by_name = named(reader, series);
        let is_named = by_name.is_some();
        let (column, (times, pattern)) = match by_name.or_else(|| by_cells(reader, series)) {
            Some((column, times)) => (Some(column), times),
            None => (None, (Cow::default(), None)),
        };
        let step = column.and_then(|_| step(&times, series));
        let named_unit = column.and_then(|c| words(&c.name).unit);
        let mut unit = time_unit(column, pattern, named_unit, step);
        if let Some(column) = column.filter(|c| !is_named && c.numbers.is_some()) {
            let why = format!(
                "the cells of `{}` rise evenly as times do; {}",
                column.name, unit.1.why
            );
            unit.1 = Reason { why, doubt: true };
        }
        let in_s = seconds(unit.0);
        Self {
            column,
            pattern,
            times_s: times.iter().map(|t| t * in_s).collect(),
            step_s: step.map(|s| s * in_s),
            unit,
        }
    }
}

/// The cells of a column as numbers, or the times that they are, and how those are written where that is not ISO 8601.
type Times<'a> = (Cow<'a, [f64]>, Option<&'static str>);

fn times(column: &TableColumn) -> Option<Times<'_>> {
    if let Some(numbers) = &column.numbers {
        return Some((numbers.into(), None));
    }
    let written = written(&column.words)?;
    Some((written.seconds.into(), written.pattern))
}

/// The usual step of numbers between two rows of a vehicle.
fn step(numbers: &[f64], series: &[u32]) -> Option<f64> {
    let changes = steps(series).map(|(a, b)| numbers[b] - numbers[a]);
    median(&mut changes.filter(|d| *d > 0.0).collect::<Vec<f64>>())
}

/// The times of a column that rises along the rows of a vehicle.
fn rising<'a>(column: &'a TableColumn, series: &[u32]) -> Option<(&'a TableColumn, Times<'a>)> {
    let times = times(column)?;
    let numbers = &times.0;
    // Rows may come in bursts of one time, but hardly ever go back.
    let (mut up, mut down, mut count) = (0, 0, 0);
    for (a, b) in steps(series) {
        up += usize::from(numbers[b] > numbers[a]);
        down += usize::from(numbers[b] < numbers[a]);
        count += 1;
    }
    (up * 10 >= count && up > 0 && down * 20 <= count).then_some((column, times))
}

/// The column that rises along the rows of a vehicle, and its times; times go before frames.
fn named<'a>(reader: &Reader<'a>, series: &[u32]) -> Option<(&'a TableColumn, Times<'a>)> {
    let times = reader.all(Whose::Ego, What::Time);
    let frames = reader.all(Whose::Ego, What::Frame);
    times
        .chain(frames)
        .find_map(|column| rising(column, series))
}

/// The column that is a time by its cells, where no name is known to say so: clock times or dates, else the numbers that rise most
/// evenly. What moves as the speed says is a way.
fn by_cells<'a>(reader: &Reader<'a>, series: &[u32]) -> Option<(&'a TableColumn, Times<'a>)> {
    let named = reader.table.columns.iter().zip(&reader.words);
    let unknown = named.filter(|(_, words)| words.what.is_none());
    let rising: Vec<(&TableColumn, Times)> = unknown
        .filter_map(|(column, _)| rising(column, series))
        .collect();
    if let Some(written) = rising.iter().find(|(column, _)| column.numbers.is_none()) {
        return Some(written.clone());
    }
    let speed = reader
        .number(Whose::Ego, What::Speed)
        .and_then(|c| c.numbers.as_deref());
    let even = rising.into_iter().filter_map(|(column, times)| {
        let changes = || {
            steps(series)
                .map(|(a, b)| (a, times.0[b] - times.0[a]))
                .filter(|(_, d)| *d > 0.0)
        };
        let spread = spread(changes().map(|(_, d)| d))?;
        let by_speed = speed.and_then(|v| spread_of_ways(changes(), v));
        // A way at one speed throughout would be as even, but then a time is too.
        let way = by_speed.is_some_and(|by_speed| by_speed < spread);
        // Numbers of rows rise by one.
        let counter = column.whole() && changes().all(|(_, d)| (d - 1.0).abs() < 1e-9);
        (spread <= MOST_SPREAD && !way).then_some((counter, spread, column, times))
    });
    let first = even.min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)))?;
    Some((first.2, first.3))
}

/// Greatest spread of the steps of a time.
const MOST_SPREAD: f64 = 0.2;

/// How much steps differ: half of what lies between a tenth and nine tenths of them, over the median one.
fn spread(steps: impl Iterator<Item = f64>) -> Option<f64> {
    let mut steps: Vec<f64> = steps.filter(|d| d.is_finite()).collect();
    steps.sort_by(f64::total_cmp);
    let quantile = |tenths: usize| {
        steps
            .get(tenths * steps.len().saturating_sub(1) / 10)
            .copied()
    };
    let (low, middle, high) = (quantile(1)?, quantile(5)?, quantile(9)?);
    (middle > 0.0).then(|| 0.5 * (high - low) / middle)
}

/// The spread of steps over the speed at each; none where ego hardly moves.
fn spread_of_ways(steps: impl Iterator<Item = (usize, f64)>, speed: &[f64]) -> Option<f64> {
    spread(
        steps
            .filter(|(row, _)| speed[*row] > MOVING)
            .map(|(row, d)| d / speed[row]),
    )
}
