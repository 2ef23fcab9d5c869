//! What is in a log, and what would become of it.

mod columns;
mod guess;
mod suggest;
mod survey;
mod table;
mod units;
mod words;

use crate::{
    error::IngestError,
    mapping::{Mapping, Signals},
    quality::{Warning, WarningKind},
    raw::mcap::{
        choice::{Choice, Found, choose},
        read::damage_warnings,
        roles::Role,
    },
    read_log::{Format, format_of, read_log, without_parts},
    settings::{IngestSettings, Ingested},
};
use maveric_bag::parts_of;
use serde::Serialize;
use std::{collections::BTreeMap, path::Path};
pub use suggest::suggest_mapping;
use survey::{Survey, Surveyed};

/// What kind of file a log is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LogFormat {
    /// An MCAP recording.
    Mcap,
    /// A table, as text or as Parquet, or a folder of them.
    Table,
}

/// What is in a log.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LogSummary {
    /// What kind of file it is.
    pub format: LogFormat,
    /// Who wrote it, where it says so.
    pub writer: Option<String>,
    /// Whose drive it is, where it says so.
    pub drive: Option<BTreeMap<String, String>>,
    /// Channels of a recording, by topic.
    pub channels: Vec<ChannelSummary>,
    /// Columns of a table, in its order.
    pub columns: Vec<ColumnSummary>,
    /// Rows of a table, or messages of a recording.
    pub rows: usize,
    /// From the first to the last time of receipt, in s.
    pub duration_s: Option<f64>,
    /// Holes in channels that come at a rate.
    pub gaps: Vec<Gap>,
    /// What is damaged.
    pub damage: Vec<Warning>,
    /// What reading it left out, filled in or doubted.
    pub warnings: Vec<Warning>,
    /// What [`crate::read_log`] makes of it with the default settings and `recover`, in a sentence.
    pub would_ingest: String,
}

/// One channel of a recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelSummary {
    /// Its topic.
    pub topic: String,
    /// The type of its messages.
    pub type_name: String,
    /// Encoding of its messages.
    pub encoding: String,
    /// Encoding of its schema.
    pub schema_encoding: String,
    /// Number of messages.
    pub messages: usize,
    /// Messages a second, from the median interval; none below two different times.
    pub rate_hz: Option<f64>,
    /// First time of receipt, in s.
    pub first_s: Option<f64>,
    /// Last time of receipt, in s.
    pub last_s: Option<f64>,
    /// Whether its messages can be decoded; the first one was.
    pub decodable: bool,
    /// Why not.
    pub reason: Option<String>,
}

/// One column of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColumnSummary {
    /// Its name.
    pub name: String,
    /// `numbers`, `whole numbers` or `text`.
    pub kind: &'static str,
    /// Cells that hold something.
    pub filled: usize,
    /// Least number; none where some cell is no number.
    pub least: Option<f64>,
    /// Greatest number; none where some cell is no number.
    pub greatest: Option<f64>,
    /// Key of the mapping that it is; with a question mark where it is guessed.
    pub meaning: Option<String>,
}

/// A hole in a channel that comes at a rate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Gap {
    /// The channel.
    pub topic: String,
    /// Last message before it, in s since the log's first message.
    pub from_s: f64,
    /// First message after it, in s since the log's first message.
    pub to_s: f64,
}

/// Says what is in a log without making a drive of it; damage is listed, never an error.
///
/// # Errors
/// [`IngestError::NotFound`], [`IngestError::IsDirectory`], [`IngestError::Empty`], [`IngestError::Io`],
/// [`IngestError::NotALog`]; [`IngestError::BadTable`] for a text that is no table.
pub fn inspect(path: &Path) -> Result<LogSummary, IngestError> {
    inspect_with(path, &IngestSettings::default())
}

/// The same by the settings that it would be read with: their mapping says what the columns of a table mean.
///
/// # Errors
/// As [`inspect`].
pub fn inspect_with(path: &Path, settings: &IngestSettings) -> Result<LogSummary, IngestError> {
    let folders = settings
        .mapping
        .as_ref()
        .is_some_and(Mapping::takes_folders);
    if folders && path.is_dir() {
        return inspect_folder(path, settings);
    }
    match format_of(path)? {
        Format::Mcap => inspect_mcap(path, settings),
        Format::Table => table::inspect_table(path, settings),
    }
}

/// The files of the signals, one after another, and the drive that they make.
fn inspect_folder(path: &Path, settings: &IngestSettings) -> Result<LogSummary, IngestError> {
    let mapping = settings.mapping.as_ref().and_then(|m| m.table.as_ref());
    let signals = mapping.and_then(|t| t.signals.as_ref());
    let files = signals.map(Signals::files).unwrap_or_default();
    let mut found: Option<LogSummary> = None;
    for file in files {
        let mut part = table::inspect_table(&path.join(file), &IngestSettings::default())?;
        for column in &mut part.columns {
            column.name = format!("{file}: {}", column.name);
            column.meaning = None;
        }
        match &mut found {
            Some(found) => {
                found.rows += part.rows;
                found.columns.extend(part.columns);
            }
            None => found = Some(part),
        }
    }
    let mut found = found.ok_or_else(|| IngestError::NoMapping {
        path: path.to_owned(),
    })?;
    table::with_mapping(path, settings, &mut found);
    Ok(found)
}

fn inspect_mcap(path: &Path, given: &IngestSettings) -> Result<LogSummary, IngestError> {
    let parts = parts_of(path)?;
    let (survey, damage) = Survey::of(&parts.files)?;
    let all = || {
        survey
            .channels
            .iter()
            .flat_map(|c| c.log_ns.iter().copied())
    };
    let (first, last) = (all().min(), all().max());
    let mut damage: Vec<Warning> = parts
        .files
        .iter()
        .zip(&damage)
        .flat_map(|(part, damage)| damage_warnings(part, damage, first))
        .collect();
    damage.extend(without_parts(path, &parts));
    let found: Vec<Found<'_>> = survey.channels.iter().map(Surveyed::found).collect();
    // The only sure way to know what reading makes of it is to read it.
    let settings = IngestSettings {
        recover: true,
        ..given.clone()
    };
    let topics = given.mapping.as_ref().and_then(|m| m.mcap.as_ref());
    let mut warnings = Vec::new();
    let would_ingest = match (choose(path, topics, &found), read_log(path, &settings)) {
        (Ok(choice), Ok(drives)) => {
            let what = describe(&found, &choice, &drives, !damage.is_empty());
            let said = drives.into_iter().flat_map(|d| d.warnings);
            warnings.extend(said.filter(|w| w.kind != WarningKind::Damage));
            what
        }
        (Err(error), _) | (_, Err(error)) => format!("nothing: {error}"),
    };
    let start = first.unwrap_or(0);
    let gaps = survey.channels.iter().flat_map(|c| c.gaps(start)).collect();
    let rows = all().count();
    let mut channels: Vec<ChannelSummary> =
        survey.channels.into_iter().map(Surveyed::summary).collect();
    channels.sort_by(|a, b| a.topic.cmp(&b.topic));
    Ok(LogSummary {
        format: LogFormat::Mcap,
        writer: survey.writer,
        drive: survey.drive,
        channels,
        columns: Vec::new(),
        rows,
        duration_s: first.zip(last).map(|(a, b)| (b - a) as f64 / 1e9),
        gaps,
        damage,
        warnings,
        would_ingest,
    })
}

fn describe(found: &[Found<'_>], choice: &Choice, drives: &[Ingested], damaged: bool) -> String {
    let ego = &found[choice.ego];
    let speed = match ego.role {
        Ok(Some(Role::Pose | Role::Frames)) if choice.speed.is_none() => {
            ", its speed differentiated"
        }
        _ => "",
    };
    let others = match choice.objects.map(|i| &found[i]) {
        Some(objects) => format!("the others from `{}`", objects.topic),
        None => "no other vehicles, so no lead vehicle".to_owned(),
    };
    let caution = if damaged {
        "; with --recover only, because the file is damaged"
    } else {
        ""
    };
    let rows: usize = drives.iter().map(|d| d.recording.rows()).sum();
    format!(
        "one drive of {rows} rows at {} Hz: ego from `{}` ({}){speed}; {others}{caution}",
        IngestSettings::RATE_HZ,
        ego.topic,
        ego.type_name
    )
}
