//! One log in, its drives out.

use crate::{
    assemble::{Target, assemble},
    error::IngestError,
    foreign::{self, foreign, foreign_text},
    lane_centres::LaneShape,
    mapping::{FrameKind, Mapping, Signals, names::meta_of},
    parquet::is_parquet,
    quality::{Warning, WarningKind},
    raw::{
        self,
        mcap::read::{Collected, collect},
    },
    read_table::read_table,
    settings::{IngestSettings, Ingested},
    source::Source,
};
use maveric_bag::{Parts, is_split, parts_of};
use std::{
    fs::File,
    io::{Read, Seek, SeekFrom},
    path::{Path, PathBuf},
};

/// What a file is, by its first bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    Mcap,
    /// A text table, or Parquet.
    Table,
}

/// Reads the drives of one log: an MCAP recording, or a table with its mapping. The content decides, not the name.
///
/// A folder that rosbag2 wrote is one recording, however many files it was split over.
///
/// A file that the mapping skips gives no drives. A recording by [`crate::write_mcap`] says whose it is and on which
/// road; others are named by the mapping's pattern or by their file, and their road is the mapping's, else one
/// lane along ego's drive ([`FrameKind::Auto`]), with vehicles beside it left out. Times are header stamps, rows are even
/// at the settings' rate, and a hole longer than `max_gap_s` starts a segment.
///
/// # Errors
/// [`IngestError::NotFound`], [`IngestError::IsDirectory`], [`IngestError::Empty`], [`IngestError::Io`] or
/// [`IngestError::NotALog`] for what is no log; [`IngestError::Bag`] and [`IngestError::MissingPart`] for a damaged
/// recording without `recover`;
/// [`IngestError::NoEgo`] or [`IngestError::UnknownTopic`] where no channel tells ego's way;
/// [`IngestError::NoMapping`], [`IngestError::UnknownColumn`], [`IngestError::BadCell`] or
/// [`IngestError::BadTable`] for tables; [`IngestError::TooSparse`], [`IngestError::BadMetadata`],
/// [`IngestError::Refused`] and [`IngestError::BadSetting`].
pub fn read_log(path: &Path, settings: &IngestSettings) -> Result<Vec<Ingested>, IngestError> {
    let mapping = settings.mapping.as_ref();
    if let Some(mapping) = mapping {
        // One that was built in code has not been looked at yet.
        let checked = mapping.check();
        checked.map_err(|why| IngestError::bad_mapping(path, why))?;
    }
    settings.rate_hz()?;
    settings.max_gap_s()?;
    if mapping.is_some_and(Mapping::takes_folders) && path.is_dir() {
        return read_table(path, settings);
    }
    let format = format_of(path)?;
    if mapping.is_some_and(|m| m.skips(path)) {
        return Ok(Vec::new());
    }
    if format == Format::Table {
        return read_table(path, settings);
    }
    let parts = parts_of(path)?;
    if let Some(part) = parts
        .missing
        .first()
        .filter(|_| !settings.recover || parts.files.is_empty())
    {
        return Err(IngestError::MissingPart {
            path: path.to_owned(),
            part: part.clone(),
        });
    }
    let topics = mapping.and_then(|m| m.mcap.as_ref());
    let collected = collect(path, &parts.files, topics, settings.recover)?;
    Ok(vec![read_recording(path, &parts, collected, settings)?])
}

/// The drive of a recording of which everything was collected.
///
/// # Errors
/// As [`read_log`].
pub(crate) fn read_recording(
    path: &Path,
    parts: &Parts,
    collected: Collected,
    settings: &IngestSettings,
) -> Result<Ingested, IngestError> {
    let mapping = settings.mapping.as_ref();
    let mapped = Target::mapped(settings)?;
    let topics = mapping.and_then(|m| m.mcap.as_ref());
    let hashes = collected.walked.iter().filter_map(|w| w.blake3.clone());
    let sources = parts.files.iter().zip(hashes);
    let sources = sources
        .map(|(file, blake3)| Source::new(file, blake3))
        .collect();
    let (drive, record, mut warnings) =
        raw::mcap::read::drive(path, &parts.files, collected, topics, settings.recover)?;
    warnings.extend(without_parts(path, parts));
    let names = mapping.and_then(|m| m.names.as_ref());
    let (meta, target) = match record {
        Some(record) => {
            let noted = |note| Warning::new(path, WarningKind::Noted, 1, note);
            warnings.extend(record.note.map(noted));
            let target = Target {
                road: record.road,
                frame: FrameKind::Map,
                lane_shape: LaneShape::Even,
                right_lane_centre_y_m: 0.0,
                own_lane_only: false,
                ..mapped
            };
            (record.meta, target)
        }
        None => (meta_of(path, names, &[], &mut warnings)?, mapped),
    };
    let (recording, more) = assemble(path, drive, &target)?;
    warnings.extend(more);
    Ok(Ingested {
        meta,
        recording,
        warnings,
        sources,
    })
}

/// A word on each part of a recording that is not there.
pub(crate) fn without_parts(path: &Path, parts: &Parts) -> Vec<Warning> {
    let without = |part: &String| {
        let what = format!("its part `{part}` is not there");
        Warning::new(path, WarningKind::Damage, 1, what)
    };
    parts.missing.iter().map(without).collect()
}

/// The logs at `path`: itself if it is a file or one recording split over a folder, else the files of the folder that end
/// in `.mcap`, `.csv`, `.tsv`, `.txt` or `.parquet` and the split recordings in it, sorted by name. Those that the mapping
/// skips are not among them. Where the mapping says that signals have their own files, a log is a folder: this one
/// if it has one of the files, else those below it that do.
///
/// # Errors
/// [`IngestError::NotFound`] or [`IngestError::Io`]; [`IngestError::NotALog`] for a folder that holds no log but a file
/// that can be made one, such as a ROS 1 bag.
pub fn log_files(path: &Path, mapping: Option<&Mapping>) -> Result<Vec<PathBuf>, IngestError> {
    let wrong = |e| IngestError::io(path, e);
    if !std::fs::metadata(path).map_err(wrong)?.is_dir() || is_split(path) {
        return Ok(vec![path.to_owned()]);
    }
    if let Some(mapping) = mapping.filter(|m| m.takes_folders()) {
        let signals = mapping.table.as_ref().and_then(|t| t.signals.as_ref());
        let files = signals.map(Signals::files).unwrap_or_default();
        return folders_with(path, &files, DEEPEST);
    }
    let of_kind = |file: &PathBuf, kinds: &[&str]| {
        let extension = file.extension().unwrap_or_default().to_ascii_lowercase();
        kinds.iter().any(|kind| extension == *kind) && file.is_file()
    };
    let tables_and_logs = ["mcap", "csv", "tsv", "txt", "parquet"];
    let (mut files, mut others) = (entries_of(path)?, Vec::new());
    files.retain(|file| {
        let log = of_kind(file, &tables_and_logs) || is_split(file);
        let taken = log && !mapping.is_some_and(|m| m.skips(file));
        if !taken && of_kind(file, &foreign::EXTENSIONS) {
            others.push(file.clone());
        }
        taken
    });
    if let (true, Some(other)) = (files.is_empty(), others.first()) {
        format_of(other)?;
    }
    Ok(files)
}

/// What a folder holds, sorted by name.
pub(crate) fn entries_of(folder: &Path) -> Result<Vec<PathBuf>, IngestError> {
    let entries = std::fs::read_dir(folder).and_then(|entries| {
        let paths = entries.map(|entry| entry.map(|e| e.path()));
        paths.collect::<Result<Vec<PathBuf>, _>>()
    });
    let mut entries = entries.map_err(|e| IngestError::io(folder, e))?;
    entries.sort();
    Ok(entries)
}

/// Folders of drives lie at most so far below the one that is given: a person's, a day's, a drive's.
const DEEPEST: usize = 4;

/// The folder itself if it has one of these files, else the folders below it that have, sorted by name.
fn folders_with(path: &Path, files: &[&str], deepest: usize) -> Result<Vec<PathBuf>, IngestError> {
    if files.iter().any(|file| path.join(file).is_file()) {
        return Ok(vec![path.to_owned()]);
    }
    let mut found = Vec::new();
    for entry in entries_of(path)? {
        if deepest > 0 && entry.is_dir() {
            found.extend(folders_with(&entry, files, deepest - 1)?);
        }
    }
    Ok(found)
}

/// Tells a recording from a text by the first bytes.
///
/// A recording whose first bytes are damaged is still one: by most of them, or by the last ones.
///
/// # Errors
/// As [`read_log`] for what is no log.
pub(crate) fn format_of(path: &Path) -> Result<Format, IngestError> {
    let wrong = |e| IngestError::io(path, e);
    let mut file = File::open(path).map_err(wrong)?;
    if file.metadata().map_err(wrong)?.is_dir() {
        return if is_split(path) {
            Ok(Format::Mcap)
        } else {
            Err(IngestError::IsDirectory {
                path: path.to_owned(),
            })
        };
    }
    let mut head = Vec::new();
    Read::by_ref(&mut file)
        .take(4096)
        .read_to_end(&mut head)
        .map_err(wrong)?;
    if head.is_empty() {
        return Err(IngestError::Empty {
            path: path.to_owned(),
        });
    }
    let magic = maveric_bag::MAGIC;
    if head.starts_with(magic) || head.len() < magic.len() && magic.starts_with(&head) {
        return Ok(Format::Mcap);
    }
    let not_a_log = |found: String, advice| IngestError::NotALog {
        path: path.to_owned(),
        found,
        advice,
    };
    if let Some((what, advice)) = foreign(&head) {
        return Err(not_a_log(what.to_owned(), advice));
    }
    let text = match std::str::from_utf8(&head) {
        Ok(_) => true,
        // A character may be cut by the end of what was read.
        Err(e) => e.error_len().is_none() && e.valid_up_to() > 0,
    };
    // A file that calls itself MCAP and is text is a mistake, not a table.
    let named_mcap = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("mcap"));
    let parquet = is_parquet(&head);
    if !named_mcap && (parquet || text && !head.contains(&0)) {
        return Ok(Format::Table);
    }
    let same = head.iter().zip(magic).filter(|(a, b)| a == b).count();
    let mut tail = Vec::new();
    let to_tail = file.seek(SeekFrom::End(-8));
    if to_tail.is_ok() {
        file.read_to_end(&mut tail).map_err(wrong)?;
    }
    // Half of it is more than chance gives, and zeros are what a lost first sector holds.
    let lost = named_mcap && head.len() > magic.len() && head[..magic.len()] == [0; 8];
    if 2 * same >= magic.len() || tail == magic || lost {
        return Ok(Format::Mcap);
    }
    if text && !head.contains(&0) {
        let found = "it is a text, though its name ends in `.mcap`".to_owned();
        let advice = "give a table the name that it should have (`.csv`), and a mapping";
        return Err(not_a_log(found, advice));
    }
    // What begins as a text.
    let printed = |b: &u8| !b.is_ascii_control() || b.is_ascii_whitespace();
    if head.iter().take(8).all(printed)
        && let Some((found, advice)) = foreign_text(&head)
    {
        return Err(not_a_log(found, advice));
    }
    let first = head.iter().take(8).map(|b| format!("{b:02x}"));
    let first = first.collect::<Vec<String>>().join(" ");
    Err(not_a_log(format!("it starts with {first}"), foreign::PLAIN))
}
