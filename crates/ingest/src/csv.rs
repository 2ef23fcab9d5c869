//! Tables whose cells stay words, so that whoever asks for numbers can name the row of one that is none: answers, measurements, results.

use crate::{
    foreign::no_table,
    parquet::first_line,
    raw::table::{
        open::{BYTE_ORDER_MARK, parse},
        text::{Style, flaw, header, separator_of},
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
    /// Whether numbers may have a comma before their decimals: cells are separated by semicolons.
    pub decimal_comma: bool,
}

/// Reads a table of words: CSV separated by commas, semicolons or tabs, whichever its header has most of.
///
/// # Errors
/// A sentence that names the row of a quote that is never closed or of too many cells, or says what the bytes are instead of a table.
pub fn read_csv(bytes: &[u8]) -> Result<Csv, String> {
    if let Some((found, advice)) = no_table(bytes) {
        return Err(format!("{found}: {advice}"));
    }
    let text = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    let mut lines = text.split(|&b| b == b'\n');
    let first = lines.find(|line| !line.trim_ascii().is_empty());
    let separator = separator_of(first.unwrap_or_default(), SEPARATORS);
    let style = Style {
        separator: Some(separator),
        ..Style::default()
    };
    let header = header(text, style, None);
    if let Some(flaw) = flaw(text, &header) {
        return Err(flaw.sentence(header.names.len()));
    }
    let frame = parse(text, &header, |_| DataType::String, None, false);
    Ok(Csv {
        frame: frame.map_err(|e| first_line(&e))?,
        decimal_comma: separator == b';',
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_says_what_separates_and_semicolons_what_is_decimal() {
        for (text, decimal_comma) in [
            ("a,b\n1,2\n", false),
            ("a;b\n1,5;2\n", true),
            ("a\tb\n1\t2\n", false),
        ] {
            let csv = read_csv(text.as_bytes()).unwrap();
            assert_eq!(csv.decimal_comma, decimal_comma, "{text}");
            assert_eq!((csv.frame.width(), csv.frame.height()), (2, 1), "{text}");
        }
        for (bytes, what) in [
            (&b"a,b\n1,2,3\n"[..], "row 1 has 3 cells"),
            (b"a,b\n1,\"2\n", "row 1 opens a quote"),
            (b"\x1f\x8b\x08\0", "gzip"),
            (b"a,b\n\xe9,2\n", "line 2 holds the byte e9"),
        ] {
            let error = read_csv(bytes).unwrap_err();
            assert!(error.contains(what), "{error}");
        }
    }
}
