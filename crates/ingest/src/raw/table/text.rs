//! The text of a table: where its header stands, how its cells are separated, and what is wrong with its rows.

use crate::mapping::TableMapping;
use rayon::prelude::*;
use std::cmp::Ordering;

/// Lines that may stand above the header.
const MOST_PREAMBLE: usize = 64;
/// Columns that a table may have: a header of commas must not cost more memory than its file.
pub(super) const MOST_COLUMNS: usize = 4096;

/// How the text of a table is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Style {
    /// Character between cells; none to find it out.
    pub(crate) separator: Option<u8>,
    /// Whether a comma stands before the decimals.
    pub(crate) decimal_comma: bool,
    /// Whether names may stand twice: the first such column is taken.
    pub(crate) doubled_names: bool,
    /// Whether the first line holds cells already: columns are named by their numbers, from 1.
    pub(crate) headless: bool,
}

impl Style {
    /// Whether any number of blanks and tabs stands between cells.
    pub(crate) fn is_blank(self) -> bool {
        self.separator == Some(b' ')
    }
}

impl From<&TableMapping> for Style {
    fn from(mapping: &TableMapping) -> Self {
        Self {
            separator: mapping.separator.map(|c| c as u8),
            decimal_comma: mapping.decimal_comma,
            doubled_names: false,
            headless: !mapping.header,
        }
    }
}

/// Where the header of a text stands and what it holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Header {
    /// Lines above it.
    pub(crate) preamble: usize,
    /// Character between cells.
    pub(crate) separator: u8,
    /// Names of the columns.
    pub(crate) names: Vec<String>,
    /// Whether there is none: the names are numbers, and every row has as many cells as the first.
    pub(crate) headless: bool,
}

/// Cells that any number of blanks and tabs separate, by one tab each; blank lines at the end are left out.
pub(crate) fn blanks_to_tabs(text: &[u8]) -> Vec<u8> {
    let mut tabbed = Vec::with_capacity(text.len());
    for line in text.trim_ascii_end().split(|&b| b == b'\n') {
        let cells = line.split(u8::is_ascii_whitespace);
        for (i, cell) in cells.filter(|c| !c.is_empty()).enumerate() {
            if i > 0 {
                tabbed.push(b'\t');
            }
            tabbed.extend_from_slice(cell);
        }
        tabbed.push(b'\n');
    }
    tabbed
}

/// Finds the header of a text: the first line with a cell `anchor`, else the first line; without one, numbers of columns.
pub(crate) fn header(text: &[u8], style: Style, anchor: Option<&str>) -> Header {
    let separator = |line: &[u8]| {
        let given = style.separator;
        given.unwrap_or_else(|| separator_of(line, SEPARATORS))
    };
    if style.headless {
        let first = text.split(|&b| b == b'\n').next().unwrap_or_default();
        let separator = separator(first);
        let cells = cells(first, separator);
        return Header {
            preamble: 0,
            separator,
            names: (1..=cells.len()).map(|n| n.to_string()).collect(),
            headless: true,
        };
    }
    let read = |(preamble, line): (usize, &[u8])| {
        let separator = separator(line);
        Header { preamble, separator, names: cells(line, separator), headless: false }
    };
    let lines = || text.split(|&b| b == b'\n').take(MOST_PREAMBLE).enumerate();
    let anchored = anchor.and_then(|anchor| {
        let holds = |h: &Header| h.names.iter().any(|n| same_name(n, anchor));
        lines().map(read).find(holds)
    });
    let first = || {
        let filled = lines().find(|(_, line)| !line.trim_ascii().is_empty());
        read(filled.unwrap_or_default())
    };
    anchored.unwrap_or_else(first)
}

/// Characters that may stand between cells; of two that are as frequent the last counts, so the comma stands there.
pub(crate) const SEPARATORS: &[u8] = b"#|\t;,";

/// The most frequent of some separators, outside quotes.
pub(crate) fn separator_of(line: &[u8], separators: &[u8]) -> u8 {
    let likely = separators.iter().copied();
    let likely = likely.max_by_key(|&c| cells(line, c).len());
    likely.unwrap_or(b',')
}

pub(crate) fn cells(line: &[u8], separator: u8) -> Vec<String> {
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    let mut quoted = false;
    let cells = line.split(|&b| {
        quoted ^= b == b'"';
        b == separator && !quoted
    });
    // One more than are allowed tells that there are too many.
    let cells = cells.take(MOST_COLUMNS + 1);
    cells.map(|c| String::from_utf8_lossy(c).trim().trim_matches('"').to_owned()).collect()
}

/// What is wrong with the rows of a text: polars would read on.
pub(crate) enum Flaw {
    /// A cell's quote is never closed: what stands behind it would be one cell, its last character lost.
    OpenQuote { row: usize },
    /// More cells than the header has, and something in the last of them.
    TooWide { row: usize, found: usize },
    /// Fewer cells than the first row of a text without a header.
    TooNarrow { row: usize, found: usize },
}

impl Flaw {
    /// A sentence, for a header of so many names.
    pub(crate) fn sentence(&self, width: usize) -> String {
        match self {
            Self::OpenQuote { row } => format!("row {row} opens a quote that is never closed"),
            Self::TooWide { row, found } => {
                format!("row {row} has {found} cells, expected {width} as in its header")
            }
            Self::TooNarrow { row, found } => {
                let cells = if *found == 1 { "cell" } else { "cells" };
                format!("row {row} has {found} {cells}, expected {width} as in its first row")
            }
        }
    }
}

/// A row of a text, as it ends.
struct RowEnd<'a> {
    /// Rows above it, the header among them.
    nth: usize,
    /// Lines above its end: a quoted cell may have several.
    lines: usize,
    /// How many cells it has.
    cells: usize,
    /// All of it, and its last cell.
    whole: &'a [u8],
    last: &'a [u8],
    /// Whether the text ends here without a line's end.
    is_cut: bool,
}

/// Looks at the rows of a text, from the header on, until `look` finds something.
///
/// # Errors
/// The lines above a quoted cell that is never closed.
fn look_at_rows<T>(
    text: &[u8],
    separator: u8,
    mut look: impl FnMut(&RowEnd<'_>) -> Option<T>,
) -> Result<Option<T>, usize> {
    // Where row and cell begin, whether the cell began with a quote, and whether that is still open.
    let (mut begin, mut cell, mut quoted, mut inside) = (0, 0, false, false);
    let (mut nth, mut lines, mut cells, mut opened) = (0, 0, 1, 0);
    for at in memchr::memchr3_iter(separator, b'\n', b'"', text) {
        match text[at] {
            b'"' if at == cell => (quoted, inside, opened) = (true, true, lines),
            b'"' => inside ^= quoted,
            _ if inside => lines += usize::from(text[at] == b'\n'),
            b'\n' => {
                let row = RowEnd {
                    nth,
                    lines,
                    cells,
                    whole: &text[begin..at],
                    last: &text[cell..at],
                    is_cut: false,
                };
                if let Some(found) = look(&row) {
                    return Ok(Some(found));
                }
                (nth, lines, cells, quoted) = (nth + 1, lines + 1, 1, false);
                (begin, cell) = (at + 1, at + 1);
            }
            _ => (cells, cell, quoted) = (cells + 1, at + 1, false),
        }
    }
    if inside {
        return Err(opened);
    }
    Ok(look(&RowEnd {
        nth,
        lines,
        cells,
        whole: &text[begin..],
        last: &text[cell..],
        is_cut: true,
    }))
}

/// A text from its header on.
fn below_preamble<'a>(text: &'a [u8], header: &Header) -> &'a [u8] {
    let mut lines = text.split_inclusive(|&b| b == b'\n');
    let above: usize = lines.by_ref().take(header.preamble).map(<[u8]>::len).sum();
    &text[above..]
}

/// A row that ends before the header does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ShortRow {
    /// Rows between it and the header.
    pub(crate) row: usize,
    /// How many cells it has.
    pub(crate) cells: usize,
    /// Whether the text ends in it without a line's end, and the row above has more cells: its last cell may be cut.
    pub(crate) is_cut: bool,
}

/// The rows of a text that end before its header does; a line without anything is none that ends. In a text without a header all are as
/// wide as the first.
///
/// # Errors
/// The first flaw; its rows are counted from 1 below the header, or from the first line where there is none.
pub(crate) fn short_rows(text: &[u8], header: &Header) -> Result<Vec<ShortRow>, Flaw> {
    let text = below_preamble(text, header);
    let width = header.names.len();
    if !header.headless && is_plain(text, header.separator, width) {
        return Ok(Vec::new());
    }
    let first = usize::from(header.headless);
    let (mut short, mut cells_above) = (Vec::new(), width);
    let look = |end: &RowEnd<'_>| {
        let (row, found) = (end.lines + first, end.cells);
        // A single cell too many that is empty is a separator at the end of the line.
        let is_more = found > width + 1 || !end.last.trim_ascii().is_empty();
        if row > 0 && found > width && is_more {
            return Some(Flaw::TooWide { row, found });
        }
        let is_row = !end.is_cut || !end.whole.is_empty();
        if header.headless && found < width && is_row {
            return Some(Flaw::TooNarrow { row, found });
        }
        if end.whole.trim_ascii().is_empty() {
            return None;
        }
        if let (true, Some(row)) = (found < width, end.nth.checked_sub(1)) {
            let is_cut = end.is_cut && found < cells_above;
            short.push(ShortRow { row, cells: found, is_cut });
        }
        cells_above = found;
        None
    };
    match look_at_rows(text, header.separator, look) {
        Ok(None) => Ok(short),
        Ok(Some(flaw)) => Err(flaw),
        Err(lines) => Err(Flaw::OpenQuote { row: lines + first }),
    }
}

/// Bytes of text that a thread looks through at a time.
const PIECE: usize = 1 << 20;

/// Whether a text has neither quotes nor a line of more or fewer cells than `width`, as almost every table: told without looking at cells.
fn is_plain(text: &[u8], separator: u8, width: usize) -> bool {
    let line_after =
        |at: usize| memchr::memchr(b'\n', &text[at..]).map_or(text.len(), |n| at + n + 1);
    let fits = |line: &[u8]| {
        let cells = memchr::memchr_iter(separator, line).count() + 1;
        let ends = || line.trim_ascii_end().ends_with(&[separator]);
        match cells.cmp(&width) {
            Ordering::Equal => true,
            Ordering::Less => line.trim_ascii().is_empty(),
            Ordering::Greater => cells == width + 1 && ends(),
        }
    };
    // Lines that begin in a piece are its own.
    let piece = |start: usize| {
        let from = start.checked_sub(1).map_or(0, line_after);
        let lines = &text[from..line_after(text.len().min(start + PIECE) - 1)];
        let mut ends = memchr::memchr_iter(b'\n', lines).chain([lines.len()]);
        let mut begin = 0;
        let line = |end| fits(&lines[std::mem::replace(&mut begin, end + 1)..end]);
        memchr::memchr(b'"', lines).is_none() && ends.all(line)
    };
    (0..text.len().div_ceil(PIECE)).into_par_iter().all(|i| piece(i * PIECE))
}

pub(super) fn same_name(a: &str, b: &str) -> bool {
    a.trim().eq_ignore_ascii_case(b.trim())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_without_quotes_are_told_as_with_them() {
        let rows = ["1,2", "1,2,", "1,2, ", "1", "", ",", "1,2,3", "1,2,,", "1,2,\r", ",,x"];
        let told = |text: &str, header: &Header| match short_rows(text.as_bytes(), header) {
            Err(Flaw::TooWide { row, found }) => Err((row, found)),
            Err(Flaw::OpenQuote { .. } | Flaw::TooNarrow { .. }) => Err((0, 0)),
            Ok(short) => Ok(short),
        };
        let (mut flaws, mut short) = (0, 0);
        for (a, b) in rows.iter().flat_map(|a| rows.map(|b| (a, b))) {
            for end in ["", "\n"] {
                let text = format!("a,b\n{a}\n{b}{end}");
                let header = header(text.as_bytes(), Style::default(), None);
                let plain = told(&text, &header);
                // A quote that closes in the header changes nothing of the rows.
                let quoted = text.replacen('a', "\"a\"", 1);
                assert_eq!(plain, told(&quoted, &header), "{text:?}");
                flaws += usize::from(plain.is_err());
                short += plain.map_or(0, |rows| rows.len());
            }
        }
        assert!(flaws > 50, "{flaws}");
        assert!(short > 20, "{short}");
    }

    #[test]
    fn a_last_row_that_ends_early_is_cut_unless_its_line_ends_or_the_row_above_is_as_short() {
        let cut = |text: &str| {
            let header = header(text.as_bytes(), Style::default(), None);
            let Ok(rows) = short_rows(text.as_bytes(), &header) else {
                panic!("{text:?} has a flaw");
            };
            let rows = rows.into_iter();
            rows.map(|row| (row.row, row.cells, row.is_cut)).collect::<Vec<_>>()
        };
        assert_eq!(cut("a,b,c\n1,2,3\n1,2"), [(1, 2, true)]);
        assert_eq!(cut("a,b,c\n1,2,3\n1,2\n"), [(1, 2, false)]);
        assert_eq!(cut("a,b,c\n1,2\n1,2"), [(0, 2, false), (1, 2, false)]);
        assert_eq!(cut("a,b,c\n1,2\n\n1"), [(0, 2, false), (2, 1, true)]);
        assert_eq!(cut("a,b,c\n1,2,3\n\n"), []);
    }
}
