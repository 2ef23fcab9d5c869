//! Numbers as cells of a table.

use maveric_report::tables::{Cell, Table, TableOf};
use maveric_stats::{Interval, apa};

/// A table of these rows, named by its title: the columns that are told come after. Headers with marks.
pub(super) fn table<T>(title: &str, rows: impl IntoIterator<Item = T>) -> TableOf<T> {
    let name: String = title
        .split(|sign: char| !sign.is_ascii_alphanumeric())
        .filter(|word| !word.is_empty())
        .take(4)
        .collect::<Vec<_>>()
        .join("-")
        .to_lowercase();
    Table::of(name, title, rows)
}

/// A number with four significant digits, or with `e` where that needs too many places.
pub(super) fn number(value: f64) -> Cell {
    let size = value.abs();
    if !(1e-4..1e7).contains(&size) && size > 0.0 {
        return Cell::Text(format!("{value:.3e}").replace('-', "−"));
    }
    // Of the number as it is written: .99999 becomes 1.
    let written = format!("{size:.3e}");
    let exponent = written.split_once('e');
    let exponent = exponent.and_then(|(_, exponent)| exponent.parse::<i32>().ok());
    let decimals = 3 - exponent.unwrap_or(0);
    Cell::Number { value, decimals: usize::try_from(decimals).unwrap_or(0) }
}

/// An estimate with as many decimals as its interval needs to be told from it.
pub(super) fn estimate(value: f64, ci: Interval) -> Cell {
    let inside = apa::decimals_inside(ci);
    let width = ci.ends().map_or(0.0, |(low, high)| high - low);
    match number(value) {
        Cell::Number { value, decimals } => Cell::Number { value, decimals: decimals.max(inside) },
        // Four digits are the same at both ends of so narrow an interval.
        _ if width > 0.0 && width < 0.01 * value.abs() && value.abs() < 1e15 => {
            Cell::Number { value, decimals: inside }
        }
        other => other,
    }
}

/// `[12033.81, 12034.42]`: the ends of an interval as [`estimate`] writes what is inside it.
pub(super) fn ends(ci: Interval) -> Cell {
    interval_by(ci, |end| end.map_or(Cell::Missing, |end| estimate(end, ci)))
}

/// The same, or a dash.
pub(super) fn optional(value: Option<f64>) -> Cell {
    value.map_or(Cell::Missing, number)
}

/// A standardised difference: two decimals.
pub(super) fn effect(value: Option<f64>) -> Cell {
    Cell::number(value, 2)
}

/// Degrees of freedom: whole if they are, else two decimals.
pub(super) fn degrees(value: Option<f64>) -> Cell {
    value.map_or(Cell::Missing, |v| Cell::Text(apa::degrees(v)))
}

/// A share or correlation, without the zero before the point.
pub(super) fn share(value: Option<f64>) -> Cell {
    Cell::bounded(value, 3)
}

/// `< .001`, `.024`.
pub(super) fn p(value: Option<f64>) -> Cell {
    value.map_or(Cell::Missing, |p| Cell::Text(apa::p_cell(p)))
}

/// A number in words of its cell.
pub(super) fn shown(cell: &Cell) -> String {
    match cell {
        Cell::Text(text) => text.clone(),
        other => other.marked(),
    }
}

/// `[.38, .62]` with the way in which the ends are written.
pub(super) fn interval(ci: Interval, write: fn(Option<f64>) -> Cell) -> Cell {
    interval_by(ci, write)
}

fn interval_by(Interval { low, high }: Interval, write: impl Fn(Option<f64>) -> Cell) -> Cell {
    match (low, high) {
        (None, None) => Cell::Missing,
        _ => Cell::Text(format!("[{}, {}]", shown(&write(low)), shown(&write(high)))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_four_digits_at_any_size() {
        let written =
            [0.0, 12.3456, -0.012_345, 123_456.7, 1.2e-9, 3e12].map(|v| shown(&number(v)));
        assert_eq!(written, ["0.000", "12.35", "−0.01235", "123457", "1.200e−9", "3.000e12"]);
        assert_eq!(shown(&p(Some(1e-9))), "< .001");
        assert_eq!(shown(&interval(Interval { low: Some(0.1), high: None }, share)), "[.100, –]");
    }

    #[test]
    fn a_number_that_is_rounded_up_has_four_digits_too() {
        let written = [0.999_99, 9.999_96, 99_999.6].map(|v| shown(&number(v)));
        assert_eq!(written, ["1.000", "10.00", "100000"]);
    }

    #[test]
    fn an_interval_is_told_from_its_estimate_far_from_zero() {
        let ci = Interval::from((12_033.812, 12_034.42));
        assert_eq!(shown(&estimate(12_034.116, ci)), "12034.12");
        assert_eq!(shown(&ends(ci)), "[12033.81, 12034.42]");
        let ci = Interval::from((12_034_566.7, 12_034_567.3));
        assert_eq!(shown(&estimate(12_034_567.0, ci)), "12034567.00");
        assert_eq!(shown(&ends(ci)), "[12034566.70, 12034567.30]");
        // Elsewhere four digits are enough.
        let ci = Interval::from((1.1e7, 1.3e7));
        assert_eq!(shown(&ends(ci)), "[1.100e7, 1.300e7]");
        let ci = Interval::from((4.0581, 7.0441));
        assert_eq!(shown(&estimate(5.5511, ci)), "5.551");
        assert_eq!(shown(&ends(ci)), "[4.058, 7.044]");
        assert_eq!(shown(&estimate(5.5511, Interval::default())), "5.551");
        assert_eq!(ends(Interval::default()), Cell::Missing);
    }

    #[test]
    fn a_table_is_named_by_its_title() {
        let made = table::<()>("Pairs by paired t (A minus B; Holm)", []).done();
        assert_eq!(made.name, "pairs-by-paired-t");
    }
}
