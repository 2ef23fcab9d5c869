//! Aligned columns of text.

use maveric_report::apa;

/// Rows of cells under a header; the first column reads from the left, the others from the right.
pub(super) struct Columns {
    rows: Vec<Vec<String>>,
}

impl Columns {
    pub(super) fn new(header: &[&str]) -> Self {
        Self {
            rows: vec![header.iter().map(|cell| (*cell).to_owned()).collect()],
        }
    }

    pub(super) fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// One line a row; without rows nothing, not even the header.
    pub(super) fn lines(&self) -> Vec<String> {
        if self.rows.len() < 2 {
            return Vec::new();
        }
        let wide = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |j: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(j));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..wide).map(width).collect();
        let line = |row: &Vec<String>| {
            let mut line = String::from(" ");
            for (j, (cell, &width)) in row.iter().zip(&widths).enumerate() {
                let padding = " ".repeat(width - cell.chars().count());
                let (left, right) = if j == 0 {
                    ("", &*padding)
                } else {
                    (&*padding, "")
                };
                line.push_str(if j == 0 { " " } else { "   " });
                line.push_str(left);
                line.push_str(cell);
                line.push_str(right);
            }
            line.trim_end().to_owned()
        };
        self.rows.iter().map(line).collect()
    }
}

/// What stands where a number has no value; the reason is given below the tables.
pub(super) const NONE: &str = "–";

/// A number with four significant digits, or with `e` where that needs too many places.
pub(super) fn number(value: f64) -> String {
    let size = value.abs();
    if !(1e-4..1e7).contains(&size) && size > 0.0 {
        return format!("{value:.3e}").replace('-', "−");
    }
    let before = if size < 1.0 {
        1
    } else {
        size.log10().floor() as usize + 1
    };
    let places = if size < 1.0 && size > 0.0 {
        (3 - size.log10().floor() as i32).clamp(3, 7) as usize
    } else {
        4_usize.saturating_sub(before)
    };
    apa::number(value, places)
}

pub(super) fn optional(value: Option<f64>) -> String {
    value.map_or_else(|| NONE.to_owned(), number)
}

/// A standardised difference: two decimals.
pub(super) fn effect(value: Option<f64>) -> String {
    value.map_or_else(|| NONE.to_owned(), |v| apa::number(v, 2))
}

/// Degrees of freedom: whole if they are, else two decimals.
pub(super) fn degrees(value: Option<f64>) -> String {
    value.map_or_else(
        || NONE.to_owned(),
        |v| apa::number(v, if (v - v.round()).abs() < 1e-9 { 0 } else { 2 }),
    )
}

/// A share or correlation, without the zero before the point.
pub(super) fn share(value: Option<f64>) -> String {
    value.map_or_else(|| NONE.to_owned(), |v| apa::bounded(v, 3))
}

/// `< .001`, `.024`.
pub(super) fn p(value: Option<f64>) -> String {
    match value {
        None => NONE.to_owned(),
        Some(p) if p < 0.001 => "< .001".to_owned(),
        Some(p) => apa::bounded(p, 3),
    }
}

/// `[.38, .62]` with the way in which the ends are written.
pub(super) fn interval(
    low: Option<f64>,
    high: Option<f64>,
    write: impl Fn(Option<f64>) -> String,
) -> String {
    match (low, high) {
        (None, None) => NONE.to_owned(),
        _ => format!("[{}, {}]", write(low), write(high)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up_whatever_the_letters() {
        let mut table = Columns::new(&["", "mean"]);
        table.row(["été".to_owned(), "1.5".to_owned()]);
        table.row(["mimic".to_owned(), "−12.25".to_owned()]);
        assert_eq!(
            table.lines(),
            ["            mean", "  été        1.5", "  mimic   −12.25"]
        );
        assert!(Columns::new(&["a", "b"]).lines().is_empty());
    }

    #[test]
    fn numbers_keep_four_digits_at_any_size() {
        let written: Vec<String> = [0.0, 12.3456, -0.012_345, 123_456.7, 1.2e-9, 3e12]
            .map(number)
            .into();
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
        assert_eq!(p(Some(1e-9)), "< .001");
        assert_eq!(interval(Some(0.1), None, share), "[.100, –]");
    }
}
