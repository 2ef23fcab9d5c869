//! Tables whose cells stay words, so that whoever asks for numbers can name the row of one that is none: answers, measurements, results.

use crate::{
    foreign::no_table,
    parquet::first_line,
    raw::table::{
        cells::parse_number,
        parse::{BYTE_ORDER_MARK, parse},
        text::{self, Header, cells, separator_of},
    },
};
use polars::prelude::{DataFrame, DataType};

/// Characters between the cells of such a table; of two that are as frequent the last counts.
const SEPARATORS: &[u8] = b"\t;,";

/// A table of words.
#[derive(Debug, Clone)]
pub struct Csv {
    /// Its columns, all of text; a name that stands twice has the number of its column behind it the second time.
    pub frame: DataFrame,
    /// Whether numbers have a comma before their decimals: cells are separated by semicolons, and one of them is such a number.
    pub decimal_comma: bool,
}

/// Reads a table of words, separated by `separator`; without it by commas, semicolons or tabs, whichever its header has most of.
///
/// # Errors
/// A sentence that names the row of a quote that is never closed or of too many cells, or says what the bytes are instead of a table.
pub fn read_csv(bytes: &[u8], separator: Option<u8>) -> Result<Csv, String> {
    let (text, header) = headed(bytes, separator)?;
    text::short_rows(text, &header).map_err(|flaw| flaw.sentence(header.names.len()))?;
    let frame = parse(text, &header, |_| DataType::String, None, false);
    let frame = frame.map_err(|e| first_line(&e))?;
    let decimal_comma = header.separator == b';' && has_decimal_comma(&frame);
    Ok(Csv { frame, decimal_comma })
}

/// Whether a cell is a number with a comma before its decimals.
fn has_decimal_comma(frame: &DataFrame) -> bool {
    let is_one = |cell: &str| cell.contains(',') && parse_number(cell.trim(), true).is_ok();
    let texts = frame.columns().iter().filter_map(|column| column.str().ok());
    texts.flat_map(|text| text.iter().flatten()).any(is_one)
}

/// Rows of such a table, from 0, that end before its header does, each with its number of cells: the others of such a row are empty in
/// [`Csv::frame`].
///
/// # Errors
/// As [`read_csv`].
pub fn short_rows(bytes: &[u8], separator: Option<u8>) -> Result<Vec<(usize, usize)>, String> {
    let (text, header) = headed(bytes, separator)?;
    let short = text::short_rows(text, &header);
    let short = short.map_err(|flaw| flaw.sentence(header.names.len()))?;
    Ok(short.iter().map(|row| (row.row, row.cells)).collect())
}

/// A text without its mark, and its header.
fn headed(bytes: &[u8], separator: Option<u8>) -> Result<(&[u8], Header), String> {
    if let Some((found, advice)) = no_table(bytes) {
        return Err(format!("{found}: {advice}"));
    }
    let text = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    let blank = |line: &&[u8]| line.trim_ascii().is_empty();
    let above = || text.split_inclusive(|&b| b == b'\n').take_while(blank);
    let rest = &text[above().map(<[u8]>::len).sum()..];
    // A name in quotes may go on in the next line.
    let mut quoted = false;
    let ends = |b: &u8| {
        quoted ^= *b == b'"';
        *b == b'\n' && !quoted
    };
    let line = &rest[..rest.iter().position(ends).unwrap_or(rest.len())];
    let separator = separator.unwrap_or_else(|| separator_of(line, SEPARATORS));
    let header = Header {
        preamble: above().count(),
        separator,
        names: cells(line, separator),
        headless: false,
    };
    Ok((text, header))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_says_what_separates_and_semicolons_what_is_decimal() {
        for (text, decimal_comma) in [
            ("a,b\n1,2\n", false),
            ("a;b\n1,5;2\n", true),
            ("a;b\n1.5;2\n", false),
            ("a\tb\n1\t2\n", false),
        ] {
            let csv = read_csv(text.as_bytes(), None).unwrap();
            assert_eq!(csv.decimal_comma, decimal_comma, "{text}");
            assert_eq!((csv.frame.width(), csv.frame.height()), (2, 1), "{text}");
        }
        let long = read_csv(b"\n\"a\nb\",c\n1,2\n", None).unwrap().frame;
        assert_eq!(long.get_column_names(), ["a\nb", "c"]);
        assert_eq!(long.height(), 1);
        let cut = b"\na,\"b\nb\",c\n1,2,\n\n1\n\"x\n,\",2\n1,2,3";
        assert_eq!(read_csv(cut, None).unwrap().frame.height(), 5);
        assert_eq!(short_rows(cut, None).unwrap(), [(2, 1), (3, 2)]);
        for (bytes, what) in [
            (&b"a,b\n1,2,3\n"[..], "row 1 has 3 cells"),
            (b"a,b\n1,\"2\n", "row 1 opens a quote"),
            (b"\x1f\x8b\x08\0", "gzip"),
            (b"a,b\n\xe9,2\n", "line 2 holds the byte e9"),
        ] {
            let error = read_csv(bytes, None).unwrap_err();
            assert!(error.contains(what), "{error}");
        }
    }
}
