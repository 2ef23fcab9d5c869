//! What can be wrong with a log.

use maveric_bag::BagError;
use path_slash::PathExt as _;
use std::path::{Path, PathBuf};

/// A log, a mapping or a setting that cannot be used, or a log that cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IngestError {
    /// Nothing there.
    #[error("no file {}", path.to_slash_lossy())]
    NotFound {
        /// What was asked for.
        path: PathBuf,
    },
    /// A folder where a file is needed.
    #[error("{} is a folder, expected one log", path.to_slash_lossy())]
    IsDirectory {
        /// The folder.
        path: PathBuf,
    },
    /// A file without a byte.
    #[error("{} is empty (0 bytes), expected an MCAP recording or a table", path.to_slash_lossy())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// The operating system refused.
    #[error("could not read {}", path.to_slash_lossy())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: std::io::Error,
    },
    /// Neither MCAP nor text.
    #[error("{} is neither an MCAP recording nor a table: {found}", path.to_slash_lossy())]
    NotALog {
        /// The file.
        path: PathBuf,
        /// What it is, or its first bytes, as a sentence.
        found: String,
        /// What to do with it.
        advice: &'static str,
    },
    /// A recording that was split over several files, and one of them is not there.
    #[error("recording {} lacks its part `{part}`", path.to_slash_lossy())]
    MissingPart {
        /// The folder.
        path: PathBuf,
        /// The file.
        part: String,
    },
    /// A recording that is damaged, or cannot be read for another reason.
    #[error(transparent)]
    Bag(#[from] BagError),
    /// No channel that says where ego was.
    #[error("no channel of {} says where ego was: {found}", path.to_slash_lossy())]
    NoEgo {
        /// The file.
        path: PathBuf,
        /// The channels and why each was not taken.
        found: String,
    },
    /// A topic that the mapping names and the log lacks.
    #[error("no usable topic `{topic}` in {}", path.to_slash_lossy())]
    UnknownTopic {
        /// The file.
        path: PathBuf,
        /// The first of those that the mapping names.
        topic: String,
        /// The most similar topic there is.
        nearest: Option<String>,
    },
    /// A drive's metadata with a value that makes no sense.
    #[error("metadata `{key}` of {} is `{found}`, expected {expected}", path.to_slash_lossy())]
    BadMetadata {
        /// The file.
        path: PathBuf,
        /// Its key; of decisions, their topic.
        key: &'static str,
        /// What was found.
        found: String,
        /// What was expected.
        expected: &'static str,
    },
    /// A table, and nothing that says what its columns mean.
    #[error("{} is a table, and no mapping says what its columns mean", path.to_slash_lossy())]
    NoMapping {
        /// The file.
        path: PathBuf,
    },
    /// A table for which no mapping can be proposed.
    #[error("no mapping can be proposed for {}: {reason}", path.to_slash_lossy())]
    NoProposal {
        /// The table.
        path: PathBuf,
        /// The signal that was not found, or why no drive could be read.
        reason: String,
    },
    /// A mapping that cannot be used.
    #[error("mapping {}: {reason}", path.to_slash_lossy())]
    BadMapping {
        /// The mapping file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A column that the mapping names and the table lacks.
    #[error("no column `{column}` in {}, whose columns are {found}", path.to_slash_lossy())]
    UnknownColumn {
        /// The table.
        path: PathBuf,
        /// As the mapping names it.
        column: String,
        /// The most similar column there is.
        nearest: Option<String>,
        /// The columns there are.
        found: String,
        /// Whether the name stands in that of another column, between characters that may separate cells.
        unseparated: bool,
    },
    /// A cell that is not what its column holds.
    #[error("{} row {row} column `{column}` holds `{found}`, expected {expected}", path.to_slash_lossy())]
    BadCell {
        /// The table.
        path: PathBuf,
        /// Data row, counted from 1 below the header.
        row: usize,
        /// Its name in the header.
        column: String,
        /// What was found.
        found: String,
        /// What was expected, in words.
        expected: String,
    },
    /// A text that is no table.
    #[error("{} cannot be read as a table: {reason}", path.to_slash_lossy())]
    BadTable {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// Samples too far apart for a single step of the result.
    #[error(
        "{} has {samples} samples of ego, none of them followed by another within {max_gap_s} s; expected a drive",
        path.to_slash_lossy()
    )]
    TooSparse {
        /// The file.
        path: PathBuf,
        /// Samples of ego.
        samples: usize,
        /// The longest hole that is bridged, in s.
        max_gap_s: f64,
    },
    /// The others were looked for too seldom for a single step of the result.
    #[error(
        "{} has {sightings} lists of the others, none of them followed by another within {max_gap_s} s: the others are seen too \
         rarely to say whether the road is free",
        path.to_slash_lossy()
    )]
    SeldomSeen {
        /// The file.
        path: PathBuf,
        /// Times at which somebody looked.
        sightings: usize,
        /// The longest hole that is bridged, in s.
        max_gap_s: f64,
    },
    /// Values that no car can have, too many of them for chance.
    #[error("{}: in {count} of {of} samples {what}", path.to_slash_lossy())]
    Implausible {
        /// The file.
        path: PathBuf,
        /// Samples with such a value.
        count: usize,
        /// Samples there are.
        of: usize,
        /// What they are, as a sentence.
        what: String,
    },
    /// A rate far above what the log holds.
    #[error(
        "{} would have {rows:.0} rows at {rate_hz} Hz from {samples} samples of ego: expected at most 100 rows a sample",
        path.to_slash_lossy()
    )]
    TooManyRows {
        /// The file.
        path: PathBuf,
        /// Rows of the result.
        rows: f64,
        /// The rate asked for, in Hz.
        rate_hz: f64,
        /// Samples of ego.
        samples: usize,
    },
    /// A setting outside its range.
    #[error("`{name}` is {found}, expected {expected}")]
    BadSetting {
        /// The setting.
        name: &'static str,
        /// What was found.
        found: f64,
        /// The range in words.
        expected: &'static str,
    },
    /// Values that make no recording or no name.
    #[error("{} gives no recording", path.to_slash_lossy())]
    Refused {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: maveric_domain::DomainError,
    },
    /// A drive that could not be written.
    #[error("could not write drive {drive}: {reason}")]
    WriteDrive {
        /// Its id.
        drive: String,
        /// Why.
        reason: String,
    },
    /// Parquet that this program did not write as a drive.
    #[error("{} has no `maveric.version` in its metadata, so it is not a drive of this program", path.to_slash_lossy())]
    NotADrive {
        /// The file.
        path: PathBuf,
    },
    /// A file that is no drive.
    #[error("{} {problem}", path.to_slash_lossy())]
    BadDrive {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// A recording that could not be written.
    #[error("could not write the recording")]
    Write {
        /// Why.
        #[source]
        source: BagError,
    },
}

/// Whether a cell is a number with a comma before its decimals.
fn has_decimal_comma(cell: &str) -> bool {
    let (whole, decimals) = cell.split_once(',').unwrap_or_default();
    let is_number = || format!("{whole}.{decimals}").parse::<f64>().is_ok();
    !whole.contains('.') && !decimals.is_empty() && is_number()
}

impl IngestError {
    /// What to try next, where we know it.
    pub fn suggestion(&self) -> Option<String> {
        Some(match self {
            Self::NotFound { .. } => "check the path; `maveric ingest` takes log files".to_owned(),
            Self::IsDirectory { path } => {
                format!("name the files in it, such as {}", path.join("*.mcap").to_slash_lossy())
            }
            Self::Empty { .. } => "record or copy it again; nothing can be recovered".to_owned(),
            Self::NotALog { advice, .. } => (*advice).to_owned(),
            Self::MissingPart { .. } => {
                "copy it into the folder, use --recover to do without it, or name the files one by one".to_owned()
            }
            Self::Bag(BagError::Damaged { .. }) => "use --recover to keep what is readable".to_owned(),
            Self::NoEgo { .. } => {
                "ego needs odometry, a pose, a fix or transforms to `base_link`; a mapping says what other messages mean (`[[mcap.messages]]`)"
                    .to_owned()
            }
            Self::UnknownTopic { nearest, .. } => match nearest {
                Some(nearest) => format!("did you mean `{nearest}`? see `maveric inspect`"),
                None => "see `maveric inspect` for the topics".to_owned(),
            },
            Self::NoMapping { .. } => {
                "give --mapping FILE.toml: study_data/mappings has some, and `maveric inspect --suggest-mapping` writes one"
                    .to_owned()
            }
            Self::NoProposal { .. } => {
                "write the mapping by hand: study_data/README.md has its keys, and study_data/mappings has some".to_owned()
            }
            Self::UnknownColumn { column, unseparated: true, .. } => format!(
                "`{column}` stands in the name of one of them: another character separates the cells of this table; correct `separator` in the mapping, or leave it out to have it found"
            ),
            Self::UnknownColumn { nearest, .. } => match nearest {
                Some(nearest) => format!("did you mean `{nearest}`? correct it in the mapping"),
                None => "correct the mapping, or give the one made for this table".to_owned(),
            },
            Self::BadCell { found, .. } if has_decimal_comma(found) => {
                "write `decimal_comma = true` in the mapping's `[table]` where a comma stands before the decimals".to_owned()
            }
            Self::BadCell { .. } => {
                "correct the cell or empty it: rows with an empty cell are left out and counted"
                    .to_owned()
            }
            Self::TooSparse { .. } => {
                "the log is sampled too rarely for a drive; where its samples come evenly, `max_gap_s` of the mapping may be 1.5 times their distance"
                    .to_owned()
            }
            Self::SeldomSeen { .. } => {
                "record the others more often than that: between sightings further apart nobody knows whether the road is free"
                    .to_owned()
            }
            Self::TooManyRows { .. } => {
                "its times may be in another unit than `time` of `[table.units]` says, or times of day over several days: those need the date"
                    .to_owned()
            }
            Self::Implausible { .. } => {
                "correct units, kinds of gaps or lanes in the mapping; `maveric inspect` shows what is in the log".to_owned()
            }
            Self::BadDrive { .. } | Self::NotADrive { .. } => "make drives from logs with `maveric ingest LOG… --out DIR`".to_owned(),
            Self::BadTable { .. } => "see what is in it with `maveric inspect`".to_owned(),
            _ => return None,
        })
    }

    pub(crate) fn bad_table(path: &Path, reason: impl Into<String>) -> Self {
        Self::BadTable { path: path.to_owned(), reason: reason.into() }
    }

    pub(crate) fn bad_mapping(path: &Path, reason: impl Into<String>) -> Self {
        Self::BadMapping { path: path.to_owned(), reason: reason.into() }
    }

    /// Names the file in an operating-system error, giving the common ones their own kind.
    pub(crate) fn io(path: &Path, source: std::io::Error) -> Self {
        let path = path.to_owned();
        match source.kind() {
            std::io::ErrorKind::NotFound => Self::NotFound { path },
            std::io::ErrorKind::IsADirectory => Self::IsDirectory { path },
            _ => Self::Io { path, source },
        }
    }
}
