//! What is in a log, and what would become of it.

mod columns;
mod guess;
mod reader;
mod suggest;
mod survey;
mod table;
mod words;

use crate::{
    error::IngestError,
    quality::{Warning, WarningKind},
    raw::mcap::{
        choice::{Choice, choose},
        metadata,
        read::{Collected, collect_all, damage_warnings},
        samples::candidate,
        slots::Role,
    },
    read_log::{Format, format_of, read_recording, without_parts},
    settings::IngestSettings,
    split::parts,
};
use maveric_domain::Sees;
use serde::Serialize;
use std::{collections::BTreeMap, path::Path};
pub use suggest::suggest_mapping;
use survey::{gaps, summary};

/// What kind of file a log is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LogFormat {
    /// An MCAP recording.
    #[default]
    Mcap,
    /// A table, as text or as Parquet.
    Table,
}

/// What is in a log.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
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
    /// What the rig sees, where a drive can be made.
    pub sees: Option<Sees>,
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
    /// As the recording names it, such as `/ego/odometry`.
    pub topic: String,
    /// The type of its messages.
    pub type_name: String,
    /// Encoding of its messages.
    pub encoding: String,
    /// Such as `ros2msg`; empty without a schema.
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
    /// As in the header.
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
    match format_of(path)? {
        Format::Mcap => inspect_mcap(path, settings),
        Format::Table => table::inspect_table(path, settings),
    }
}

fn inspect_mcap(path: &Path, given: &IngestSettings) -> Result<LogSummary, IngestError> {
    let parts = parts(path, given.mapping.as_ref())?;
    let topics = given.mapping.as_ref().and_then(|m| m.mcap.as_ref());
    let collected = collect_all(&parts.files, topics)?;
    let streams = &collected.streams;
    let with_times = || streams.iter().filter_map(|s| Some((s, s.taken.times.as_ref()?)));
    let receipts_ns = || with_times().flat_map(|(_, times)| times.log_ns.iter().copied());
    let (first, last) = (receipts_ns().min(), receipts_ns().max());
    let mut channels: Vec<ChannelSummary> = with_times().map(|(s, t)| summary(s, t)).collect();
    channels.sort_by(|a, b| a.topic.cmp(&b.topic));
    let start = first.unwrap_or(0);
    let mut log_summary = LogSummary {
        writer: collected.writer.clone(),
        drive: collected.metadata.get(metadata::NAME).cloned(),
        channels,
        rows: receipts_ns().count(),
        duration_s: first.zip(last).map(|(a, b)| (b - a) as f64 / 1e9),
        gaps: with_times().flat_map(|(s, t)| gaps(&s.channel.topic, &t.log_ns, start)).collect(),
        ..LogSummary::default()
    };
    let damaged =
        !parts.missing.is_empty() || collected.walked.iter().any(|w| !w.damage.is_empty());
    let settings = IngestSettings { recover: true, ..given.clone() };
    let candidates: Vec<_> = streams.iter().map(candidate).collect();
    let what = match choose(path, topics, &candidates) {
        Ok(choice) => describe(&collected, &choice, damaged),
        Err(_) => String::new(),
    };
    let damage = parts.files.iter().zip(&collected.walked);
    log_summary.damage = damage
        .flat_map(|(part, walked)| damage_warnings(part, &walked.damage, first))
        .chain(without_parts(path, &parts))
        .collect();
    // The only sure way to know what reading makes of it is to do it, with what was read.
    log_summary.would_ingest = match read_recording(path, &parts, collected, &settings) {
        Ok(drive) => {
            let rows = drive.recording.rows();
            let warnings = drive.warnings.into_iter();
            log_summary.warnings.extend(warnings.filter(|w| w.kind != WarningKind::Damage));
            let sees = drive.recording.sees();
            log_summary.sees = Some(sees);
            format!("one drive of {rows} rows {what}{}", seen_in_words(sees))
        }
        Err(error) => format!("nothing: {error}"),
    };
    Ok(log_summary)
}

/// What a rig sees, as the end of a sentence; nothing where it sees everything.
pub(super) fn seen_in_words(sees: Sees) -> String {
    if sees == Sees::ALL {
        return String::new();
    }
    format!("; the rig sees: {sees}")
}

/// From which channels a drive would be, and on which terms.
fn describe(collected: &Collected, choice: &Choice, damaged: bool) -> String {
    let stream = |i: usize| candidate(&collected.streams[i]);
    let ego = stream(choice.ego);
    let speed = match ego.role {
        Ok(Some(Role::Pose | Role::Frames)) if choice.speed.is_none() => {
            ", its speed differentiated"
        }
        _ => "",
    };
    let others = match choice.objects.map(stream) {
        Some(objects) => format!("the others from `{}`", objects.topic),
        None => "no other vehicles, so no lead vehicle".to_owned(),
    };
    let caution = if damaged { "; with --recover only, because the file is damaged" } else { "" };
    format!(
        "at {} Hz: ego from `{}` ({}){speed}; {others}{caution}",
        IngestSettings::RATE_HZ,
        ego.topic,
        ego.type_name
    )
}
