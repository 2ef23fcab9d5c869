//! What was left out or doubted on the way from a log to a recording.

use path_slash::PathExt as _;
use serde::Serialize;
use std::{
    fmt,
    path::{Path, PathBuf},
};

/// What a warning is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum WarningKind {
    /// A damaged part of the file, left out under `recover`.
    Damage,
    /// A channel that was refused by itself.
    RefusedChannel,
    /// A message that its channel's definition does not fit.
    BadMessage,
    /// A sample with a missing or infinite value.
    MissingValue,
    /// Samples that came out of order and were sorted.
    OutOfOrder,
    /// The clock was set back within the recording: each part between is a segment of its own.
    ClockRestart,
    /// A second sample of the same time, left out.
    DuplicateTime,
    /// A hole in time too long to bridge: a new segment starts behind it.
    Hole,
    /// Header stamps and times of receipt that differ.
    ReceiveSkew,
    /// No header stamps: times of receipt were used.
    ReceiveTime,
    /// A channel chosen among several.
    Choice,
    /// The others, none of whose samples falls on a row of ego.
    NoOverlap,
    /// Vehicles aside of the only lane that is known, or ego aside of it.
    OtherLane,
    /// Values that can hardly be in the unit that was declared.
    Unit,
    /// A signal that contradicts another one for a while.
    Contradiction,
    /// A value that the log lacks and a default stands in for.
    Default,
    /// What whoever made the log has to say of it.
    Noted,
}

/// Something in a log that was left out, filled in or doubted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Warning {
    /// The log.
    pub file: PathBuf,
    /// What it is about.
    pub kind: WarningKind,
    /// What happened, as a sentence.
    pub what: String,
    /// How often.
    pub count: usize,
    /// Where, from and to, in s since the log's first message; at most [`Warning::MOST_SPANS`] of them.
    pub spans_s: Vec<(f64, f64)>,
    /// Whether it is about a whole file of several drives, the first of which has it.
    #[serde(skip)]
    pub of_file: bool,
}

impl Warning {
    /// Number of spans that a warning lists at most.
    pub const MOST_SPANS: usize = 20;

    pub(crate) fn new(
        file: &Path,
        kind: WarningKind,
        count: usize,
        what: impl Into<String>,
    ) -> Self {
        Self {
            file: file.to_owned(),
            kind,
            what: what.into(),
            count,
            spans_s: Vec::new(),
            of_file: false,
        }
    }

    pub(crate) fn with_spans(mut self, spans_s: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.spans_s = spans_s.into_iter().take(Self::MOST_SPANS).collect();
        self
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.file.to_slash_lossy(), self.what)?;
        if self.count > 1 {
            write!(f, " ({} times)", self.count)?;
        }
        for (i, (from, to)) in self.spans_s.iter().take(3).enumerate() {
            let lead = if i == 0 { "; at" } else { "," };
            write!(f, "{lead} {from:.2}-{to:.2} s")?;
        }
        Ok(())
    }
}

/// Adds a warning if it happened at all.
pub(crate) fn report(
    warnings: &mut Vec<Warning>,
    file: &Path,
    kind: WarningKind,
    count: usize,
    what: &str,
) {
    if count > 0 {
        warnings.push(Warning::new(file, kind, count, what));
    }
}
