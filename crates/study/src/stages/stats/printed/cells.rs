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
    let before = if size < 1.0 {
        1
    } else {
        libm::log10(size).floor() as usize + 1
    };
    let decimals = if size < 1.0 && size > 0.0 {
        (3 - libm::log10(size).floor() as i32).clamp(3, 7) as usize
    } else {
        4_usize.saturating_sub(before)
    };
    Cell::Number { value, decimals }
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
pub(super) fn interval(Interval { low, high }: Interval, write: fn(Option<f64>) -> Cell) -> Cell {
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
        assert_eq!(
            written,
            [
                "0.000",
                "12.35",
                "−0.01235",
                "123457",
                "1.200e−9",
                "3.000e12"
            ]
        );
        assert_eq!(shown(&p(Some(1e-9))), "< .001");
        assert_eq!(
            shown(&interval(
                Interval {
                    low: Some(0.1),
                    high: None
                },
                share
            )),
            "[.100, –]"
        );
    }

    #[test]
    fn a_table_is_named_by_its_title() {
        let made = table::<()>("Pairs by paired t (A minus B; Holm)", []).done();
        assert_eq!(made.name, "pairs-by-paired-t");
    }
}
