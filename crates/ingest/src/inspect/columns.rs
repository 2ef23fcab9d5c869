//! The columns of a table as they are, before anybody says what they mean.

use crate::{
    error::IngestError,
    parquet::is_parquet,
    quality::Warning,
    raw::table::{
        open::{Kind, Table},
        parse::BYTE_ORDER_MARK,
        text::{SEPARATORS, Style, blanks_to_tabs, header},
    },
};
use std::path::Path;

/// Rows by whose cells a column of text is told from one of numbers.
const SAMPLE: usize = 200;

#[derive(Debug, Clone)]
pub(super) struct TableColumn {
    pub(super) name: String,
    /// Numbers, NaN where a cell is empty; none for a column of text.
    pub(super) numbers: Option<Vec<f64>>,
    /// Words, for columns of text.
    pub(super) words: Vec<Option<String>>,
}

/// All columns of a table.
#[derive(Debug, Clone)]
pub(super) struct Sheet {
    pub(super) rows: usize,
    pub(super) separator: Option<u8>,
    pub(super) decimal_comma: bool,
    pub(super) columns: Vec<TableColumn>,
    /// What is to be told of its rows.
    pub(super) warnings: Vec<Warning>,
}

/// Reads all columns, finding out which are numbers; `written` is what a mapping says of header and blanks, where there is one.
///
/// # Errors
/// [`IngestError::BadTable`] for what is no table.
pub(super) fn read(path: &Path, mut bytes: Vec<u8>, written: Style) -> Result<Sheet, IngestError> {
    let parquet = is_parquet(&bytes);
    if written.is_blank() && !parquet {
        bytes = blanks_to_tabs(&bytes);
    }
    let mut unreadable = Vec::new();
    let (preamble, separator, names) = if parquet {
        let columns = Table::parquet_columns(path, &bytes)?;
        let lists = columns.iter().filter(|(_, kind)| kind.is_some());
        unreadable.extend(lists.map(|(name, _)| name.clone()));
        let names = columns.into_iter().map(|(name, _)| name).collect();
        (0, None, names)
    } else {
        let text = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(&bytes);
        let headless = written.headless;
        let preamble = if headless { 0 } else { likely_header(text) };
        let rest = line(text, preamble);
        let plain = Style { headless, ..Style::default() };
        let first_line = header(rest, plain, None);
        (preamble, Some(first_line.separator), first_line.names)
    };
    let decimal_comma = !parquet && separator == Some(b';') && has_decimal_commas(&bytes, preamble);
    let style = Style {
        separator,
        decimal_comma,
        // They cannot be asked for; their first column stands for both.
        doubled_names: true,
        headless: written.headless,
    };
    let mut once: Vec<&str> = Vec::new();
    for name in &names {
        if !once.contains(&name.as_str()) && !unreadable.contains(name) {
            once.push(name);
        }
    }
    let wanted: Vec<(&str, Kind)> = once.iter().map(|n| (*n, Kind::Word)).collect();
    let table = Table::open(path, bytes, style, &wanted)?;
    let mut columns = Vec::new();
    for name in once {
        let numbers = table.numbers(name).ok();
        columns.push(TableColumn {
            name: name.to_owned(),
            words: match numbers {
                Some(_) => Vec::new(),
                None => table.words(name)?,
            },
            numbers,
        });
    }
    Ok(Sheet {
        rows: table.rows(),
        separator,
        decimal_comma,
        columns,
        warnings: table.warnings().to_vec(),
    })
}

/// Number of lines above the header: it is the first line as wide as the lines after it, and of words.
fn likely_header(text: &[u8]) -> usize {
    let lines: Vec<&[u8]> = text.split(|&b| b == b'\n').take(40).collect();
    let width = |line: &[u8], separator: u8| line.split(|&b| b == separator).count();
    let numeric = |line: &&[u8]| {
        let text = String::from_utf8_lossy(line);
        let mut cells = text
            .split(|c: char| u8::try_from(c).is_ok_and(|c| SEPARATORS.contains(&c)))
            .map(str::trim)
            .filter(|c| !c.is_empty());
        cells.next().is_some_and(|c| c.parse::<f64>().is_ok())
    };
    let first_numbers =
        lines.iter().position(|l| numeric(l) && SEPARATORS.iter().any(|&c| width(l, c) > 1));
    let Some(data) = first_numbers.filter(|&i| i > 0) else {
        return 0;
    };
    let above = lines[..data].iter().rposition(|l| !l.trim_ascii().is_empty());
    // Commas may be decimal ones: widths are compared by one separator at a time.
    let as_wide = |i: usize| {
        let by = |&c: &u8| (2..=width(lines[i], c)).contains(&width(lines[data], c));
        SEPARATORS.iter().any(by)
    };
    above.filter(|&i| as_wide(i)).unwrap_or(0)
}

/// A text from one of its lines on.
fn line(text: &[u8], number: usize) -> &[u8] {
    let above = text.split_inclusive(|&b| b == b'\n').take(number);
    &text[above.map(<[u8]>::len).sum()..]
}

fn has_decimal_commas(text: &[u8], preamble: usize) -> bool {
    let rest = line(text, preamble + 1);
    let cells = || rest.split(|&b| b == b';' || b == b'\n').take(SAMPLE);
    let decimal = |cell: &&[u8]| {
        let cell = String::from_utf8_lossy(cell);
        let cell = cell.trim();
        cell.contains(',') && cell.replace(',', ".").parse::<f64>().is_ok()
    };
    cells().filter(decimal).count() * 4 > cells().count()
}

impl TableColumn {
    /// Numbers without the empty cells.
    pub(super) fn filled(&self) -> impl Iterator<Item = f64> + '_ {
        let numbers = self.numbers.iter().flatten().copied();
        numbers.filter(|v| v.is_finite())
    }

    /// Cells that hold something.
    pub(super) fn count(&self) -> usize {
        self.filled().count() + self.words.iter().flatten().count()
    }

    /// Whether all numbers are whole.
    pub(super) fn whole(&self) -> bool {
        self.numbers.is_some() && self.filled().all(|v| v.fract().abs() < 1e-9)
    }

    /// Least and greatest number.
    pub(super) fn range(&self) -> Option<(f64, f64)> {
        let least = self.filled().min_by(f64::total_cmp)?;
        Some((least, self.filled().max_by(f64::total_cmp)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_below_a_preamble_and_decimal_commas_are_found() {
        let text = "Freq;10;Hz\nCars;Audi;BMW\nTime;Speed1;IVS1\n0,1;2,5;3,5\n0,2;2,6;\n";
        let found = read(Path::new("t.csv"), text.into(), Style::default()).unwrap();
        assert!(found.decimal_comma);
        let names: Vec<&str> = found.columns.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["Time", "Speed1", "IVS1"]);
        assert_eq!(found.columns[1].range(), Some((2.5, 2.6)));
        assert_eq!(found.columns[2].count(), 1);
    }
}
