//! One log in, its drives out.

use crate::{
    assemble::assemble,
    error::IngestError,
    foreign::{self, foreign, foreign_text},
    lane_centres::LaneShape,
    mapping::{FrameKind, names::meta_of},
    parquet::is_parquet,
    quality::{Warning, WarningKind},
    raw::{
        self,
        mcap::read::{Collected, collect},
    },
    read_table::read_table,
    settings::{IngestSettings, Ingested},
    source::Source,
    split::parts,
    target::Target,
};
use maveric_bag::{Parts, is_split};
use std::{
    fs::File,
    io::{Read, Seek, SeekFrom},
    path::Path,
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
/// A folder that rosbag2 wrote is one recording, however many files it was split over; so are files that `parts` of the mapping's
/// `[names]` says to be parts of one, whichever of them is named.
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
    let format = format_of(path)?;
    if mapping.is_some_and(|m| m.skips(path)) {
        return Ok(Vec::new());
    }
    let parts = parts(path, mapping)?;
    // Whichever part was named, the recording has the name of its first.
    let path = match parts.files.as_slice() {
        [first, ..] if path.is_file() => first,
        _ => path,
    };
    let has_to_be_whole = !settings.recover || parts.files.is_empty();
    if let Some(part) = parts.missing.first().filter(|_| has_to_be_whole) {
        return Err(IngestError::MissingPart { path: path.to_owned(), part: part.clone() });
    }
    if format == Format::Table {
        let mut drives = read_table(path, &parts.files, settings)?;
        for drive in &mut drives {
            drive.warnings.extend(without_parts(path, &parts));
        }
        return Ok(drives);
    }
    let topics = mapping.and_then(|m| m.mcap.as_ref());
    let collected = collect(path, &parts.files, topics, settings.recover)?;
    Ok(vec![read_recording(path, &parts, collected, settings)?])
}

/// The drive of a recording of which everything was collected.
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
    let sources = sources.map(|(file, blake3)| Source::new(file, blake3)).collect();
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
    Ok(Ingested { meta, recording, warnings, sources })
}

/// A word on each part of a recording that is not there.
pub(crate) fn without_parts(path: &Path, parts: &Parts) -> Vec<Warning> {
    let without = |part: &String| {
        let what = format!("its part `{part}` is not there");
        Warning::new(path, WarningKind::Damage, 1, what)
    };
    parts.missing.iter().map(without).collect()
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
            Err(IngestError::IsDirectory { path: path.to_owned() })
        };
    }
    let mut head = Vec::new();
    Read::by_ref(&mut file).take(4096).read_to_end(&mut head).map_err(wrong)?;
    if head.is_empty() {
        return Err(IngestError::Empty { path: path.to_owned() });
    }
    let magic = maveric_bag::MAGIC;
    if head.starts_with(magic) || head.len() < magic.len() && magic.starts_with(&head) {
        return Ok(Format::Mcap);
    }
    let not_a_log =
        |found: String, advice| IngestError::NotALog { path: path.to_owned(), found, advice };
    if let Some((what, advice)) = foreign(&head) {
        return Err(not_a_log(what.to_owned(), advice));
    }
    let text = match std::str::from_utf8(&head) {
        Ok(_) => true,
        // A character may be cut by the end of what was read.
        Err(e) => e.error_len().is_none() && e.valid_up_to() > 0,
    };
    // A file that calls itself MCAP and is text is a mistake, not a table.
    let named_mcap = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("mcap"));
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
        let what = "it is a text, though its name ends in `.mcap`".to_owned();
        let advice = "give a table the name that it should have (`.csv`), and a mapping";
        return Err(not_a_log(what, advice));
    }
    // What begins as a text.
    let printed = |b: &u8| !b.is_ascii_control() || b.is_ascii_whitespace();
    if head.iter().take(8).all(printed)
        && let Some((what, advice)) = foreign_text(&head)
    {
        return Err(not_a_log(what, advice));
    }
    let first = head.iter().take(8).map(|b| format!("{b:02x}"));
    let first = first.collect::<Vec<String>>().join(" ");
    Err(not_a_log(format!("it starts with {first}"), foreign::PLAIN))
}
