//! What is in a table, and what its mapping, or a guess, makes of it.

use super::{
    ColumnSummary, Gap, LogFormat, LogSummary,
    columns::{self, Sheet, TableColumn},
    guess::{Guess, Shape, guess},
    seen_in_words,
    suggest::look,
    words::words,
};
use crate::{
    error::IngestError,
    quality::WarningKind,
    raw::table::text::Style,
    read_log::read_log,
    settings::{IngestSettings, Ingested},
};
use std::path::Path;

/// Looks into a table: by the settings' mapping if they have one, else by guesses.
pub(super) fn inspect_table(
    path: &Path,
    settings: &IngestSettings,
) -> Result<LogSummary, IngestError> {
    let table_mapping = settings.mapping.as_ref().and_then(|m| m.table.as_ref());
    let written = table_mapping.map(Style::from).unwrap_or_default();
    let table = columns::read(path, look(path)?, written)?;
    let guess = guess(&table);
    let mapped: Vec<Mapped> = if let Some(mapping) = table_mapping {
        mapping.layout.columns()
    } else {
        let keys = guess.columns(&guess.first_choice()).into_iter();
        keys.map(|(key, name)| (key.to_owned(), name)).collect()
    };
    let columns = table.columns.iter();
    let columns = columns.map(|c| summary(c, &mapped, table_mapping.is_some()));
    let mut log_summary = LogSummary {
        format: LogFormat::Table,
        columns: columns.collect(),
        rows: table.rows,
        ..LogSummary::default()
    };
    if table_mapping.is_some() {
        with_mapping(path, settings, &mut log_summary);
    } else {
        log_summary.would_ingest = without_mapping(&table, &guess);
        log_summary.warnings.extend(table.warnings);
    }
    Ok(log_summary)
}

/// Reads the table, the only sure way to know what becomes of it.
fn with_mapping(path: &Path, settings: &IngestSettings, log_summary: &mut LogSummary) {
    match read_log(path, settings) {
        Ok(drives) => {
            let rows: usize = drives.iter().map(|d| d.recording.rows()).sum();
            let rate = drives.first().map_or(0.0, |d| d.recording.rate_hz());
            let drives_word = if drives.len() == 1 { "drive" } else { "drives" };
            log_summary.sees = drives.first().map(|d| d.recording.sees());
            log_summary.would_ingest = format!(
                "{} {drives_word} of {rows} rows at {rate} Hz, by the mapping{}",
                drives.len(),
                log_summary.sees.map(seen_in_words).unwrap_or_default()
            );
            let last = |d: &Ingested| d.recording.time_s().last().copied().unwrap_or(0.0);
            log_summary.duration_s = drives.iter().map(last).max_by(f64::total_cmp);
            for drive in drives {
                let holes = drive.warnings.iter().filter(|w| w.kind == WarningKind::Hole);
                log_summary.gaps.extend(holes.flat_map(|w| &w.spans_s).map(|&(from_s, to_s)| {
                    Gap { topic: drive.meta.drive.to_string(), from_s, to_s }
                }));
                log_summary.warnings.extend(drive.warnings);
            }
        }
        Err(error) => log_summary.would_ingest = format!("nothing: {error}"),
    }
}

fn without_mapping(table: &Sheet, guess: &Guess<'_>) -> String {
    let what = match guess.shape {
        Ok(Shape::Pair) => "it looks like one pair a file",
        Ok(Shape::Long) => "it looks like one vehicle a row",
        Ok(Shape::Platoon) => "it looks like a platoon side by side",
        Err(missing) => {
            return format!(
                "nothing, even by a mapping: {} (in {} columns)",
                missing.as_str(),
                table.columns.len()
            );
        }
    };
    format!(
        "nothing without a mapping that says what columns mean and in which units; {what}: see `--suggest-mapping`"
    )
}

/// A key of a mapping and its column.
type Mapped = (String, String);

/// A column with the key that it has in a mapping, or with one that is guessed by its name.
fn summary(column: &TableColumn, mapped: &[Mapped], is_mapped: bool) -> ColumnSummary {
    let range = column.range();
    let stem = column.name.trim_end_matches(|d: char| d.is_ascii_digit());
    let is =
        |name: &str| name == column.name || name.strip_suffix("{n}").is_some_and(|s| s == stem);
    let named = mapped.iter().find(|m| is(m.1.trim_end_matches('?')));
    let meaning = |key: &String| {
        let unit = words(&column.name).unit;
        match unit {
            _ if is_mapped => key.clone(),
            Some(unit) => format!("{key}, in {unit}?"),
            None => format!("{key}?"),
        }
    };
    ColumnSummary {
        name: column.name.clone(),
        kind: match (&column.numbers, column.whole()) {
            (None, _) => "text",
            (Some(_), true) => "whole numbers",
            (Some(_), false) => "numbers",
        },
        filled: column.count(),
        least: range.map(|r| r.0),
        greatest: range.map(|r| r.1),
        meaning: named.map(|m| meaning(&m.0)),
    }
}
