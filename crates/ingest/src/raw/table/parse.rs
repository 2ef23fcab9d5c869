//! The rows of a text as columns, by polars.

use super::text::Header;
use polars::prelude::{
    CsvParseOptions, CsvReadOptions, DataFrame, DataType, Field, PlSmallStr, PolarsError, Schema,
    SerReader,
};
use std::{io::Cursor, sync::Arc};

/// What some programs begin a text in UTF-8 with.
pub(crate) const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Reads the rows of a text below its header, in which [`super::text::short_rows`] found no flaw: `names` of its columns, or all.
///
/// # Errors
/// What polars says.
pub(crate) fn parse(
    text: &[u8],
    header: &Header,
    kind: impl Fn(&str) -> DataType,
    names: Option<&[&str]>,
    decimal_comma: bool,
) -> Result<DataFrame, PolarsError> {
    // The names are ours: the file's may have blanks around them, or stand twice.
    let field = |(i, name): (usize, &String)| {
        let first = header.names.iter().position(|n| n == name) == Some(i);
        let numbered = (!first).then(|| format!("{name} (column {})", i + 1));
        Field::new(numbered.as_deref().unwrap_or(name).into(), kind(name))
    };
    let schema: Schema = header.names.iter().enumerate().map(field).collect();
    let names = names.map(|names| names.iter().map(|n| PlSmallStr::from_str(n)).collect());
    // What is too wide was refused before; a separator at the end of a line is nothing.
    let options = CsvParseOptions::default()
        .with_separator(header.separator)
        .with_decimal_comma(decimal_comma)
        .with_truncate_ragged_lines(true);
    CsvReadOptions::default()
        .with_infer_schema_length(Some(0))
        .with_has_header(!header.headless)
        .with_skip_lines(header.preamble)
        .with_schema(Some(Arc::new(schema)))
        .with_columns(names)
        .with_parse_options(options)
        .into_reader_with_file_handle(Cursor::new(text))
        .finish()
}

/// A text without the mark that some programs begin it with.
pub(super) fn without_mark(mut text: Vec<u8>) -> Vec<u8> {
    if text.starts_with(BYTE_ORDER_MARK) {
        text.drain(..BYTE_ORDER_MARK.len());
    }
    text
}
