//! What the automated car decided, as log messages: written beside the recording, read back for whoever shows a drive.

use crate::error::IngestError;
use maveric_bag::{Message, Take, Walk, read_streams};
use maveric_domain::{LaneActivity, TraceRow, drive::Direction};
use serde::Serialize;
use std::path::Path;

/// Topic of the decisions, type `foxglove.Log`.
pub(crate) const TOPIC: &str = "/maveric/decisions";
/// Name and text of their schema.
pub(super) const SCHEMA: (&str, &str) = ("foxglove.Log", include_str!("schemas/log.json"));

/// Something that the automated car decided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decision {
    /// When, in s since the start of the drive.
    pub time_s: f64,
    /// What.
    pub kind: DecisionKind,
}

/// What the automated car can decide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum DecisionKind {
    /// A lane change starts.
    ChangeStarts(Direction),
    /// The lane is kept again.
    ChangeEnds,
    /// A lane change is due and waits for a safe gap.
    ChangeWaits,
    /// A lane change is undone because a gap became unsafe.
    ChangeGivenUp,
    /// The safety layer brakes harder than the controllers ask.
    SafetyBrakes,
    /// It lets go again.
    SafetyReleases,
}

impl DecisionKind {
    const ALL: [Self; 7] = [
        Self::ChangeStarts(Direction::Left),
        Self::ChangeStarts(Direction::Right),
        Self::ChangeEnds,
        Self::ChangeWaits,
        Self::ChangeGivenUp,
        Self::SafetyBrakes,
        Self::SafetyReleases,
    ];

    /// The message in the log.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::ChangeStarts(Direction::Left) => "lane change to the left starts",
            Self::ChangeStarts(Direction::Right) => "lane change to the right starts",
            Self::ChangeEnds => "lane change ends",
            Self::ChangeWaits => "lane change is due and waits for a safe gap",
            Self::ChangeGivenUp => "lane change is given up: a gap became unsafe",
            Self::SafetyBrakes => "safety layer brakes",
            Self::SafetyReleases => "safety layer lets go",
        }
    }

    /// The message of a drive at a time, as JSON.
    pub(super) fn message(self, drive: &str, time_ns: u64) -> Vec<u8> {
        let log = Log {
            timestamp: Time {
                sec: time_ns / 1_000_000_000,
                nsec: (time_ns % 1_000_000_000) as u32,
            },
            level: self.level(),
            message: self.as_str(),
            name: self.node(),
            file: drive,
            line: 0,
        };
        // Numbers and strings: there is nothing that JSON could refuse.
        serde_json::to_vec(&log).unwrap_or_default()
    }

    /// Who decides: the `name` of the message.
    fn node(self) -> &'static str {
        match self {
            Self::SafetyBrakes | Self::SafetyReleases => "safety_layer",
            _ => "lane_change",
        }
    }

    /// The message's level: 2 is information, 3 a warning.
    fn level(self) -> u8 {
        match self {
            Self::SafetyBrakes | Self::ChangeGivenUp => 3,
            _ => 2,
        }
    }
}

/// A message, field for field as Foxglove's schema has it.
#[derive(Serialize)]
struct Log<'a> {
    timestamp: Time,
    level: u8,
    message: &'static str,
    name: &'static str,
    file: &'a str,
    line: u32,
}

#[derive(Serialize)]
struct Time {
    sec: u64,
    nsec: u32,
}

/// Decisions at the rows at which something changes; each row's with the row's number.
pub(crate) fn decisions(trace: &[TraceRow]) -> Vec<(usize, DecisionKind)> {
    let mut out = Vec::new();
    let (mut lane, mut braked) = (LaneActivity::Keeping, false);
    for (row, now) in trace.iter().enumerate() {
        if now.lane != lane {
            out.push((row, change(now)));
            // A wish that passes is no end of a change.
            if lane == LaneActivity::Waiting && now.lane == LaneActivity::Keeping {
                out.pop();
            }
            lane = now.lane;
        }
        if now.braked != braked {
            braked = now.braked;
            let kind =
                if braked { DecisionKind::SafetyBrakes } else { DecisionKind::SafetyReleases };
            out.push((row, kind));
        }
    }
    out
}

fn change(row: &TraceRow) -> DecisionKind {
    match row.lane {
        LaneActivity::Keeping => DecisionKind::ChangeEnds,
        LaneActivity::Waiting => DecisionKind::ChangeWaits,
        LaneActivity::GoingBack => DecisionKind::ChangeGivenUp,
        LaneActivity::Changing => {
            let left = row.path_m.is_some_and(|path| path[3].1 > path[0].1);
            DecisionKind::ChangeStarts(if left { Direction::Left } else { Direction::Right })
        }
    }
}

/// Reads the decisions out of a log; none where the log keeps none.
///
/// A log that is cut off gives what stands before the cut.
///
/// # Errors
/// [`IngestError::Io`] if the file cannot be read; [`IngestError::BadMetadata`] naming a message that no automated car
/// of ours writes.
pub fn read_decisions(path: &Path) -> Result<Option<Vec<Decision>>, IngestError> {
    let how = Walk { recover: true, ..Walk::default() };
    let read = read_streams(&[path.to_owned()], how, |channel, _| Texts {
        wanted: channel.topic == TOPIC,
        ..Texts::default()
    })?;
    // A quiet drive has the channel, and no message on it.
    let mut of_topic = read.streams.into_iter().filter(|s| s.taken.wanted).peekable();
    if of_topic.peek().is_none() {
        return Ok(None);
    }
    let mut messages: Vec<(u64, String)> = of_topic.flat_map(|s| s.taken.messages).collect();
    messages.sort_by_key(|message| message.0);
    let mut decisions = Vec::new();
    for (time_ns, text) in messages {
        let kind = DecisionKind::ALL.into_iter().find(|k| k.as_str() == text);
        let kind = kind.ok_or_else(|| IngestError::BadMetadata {
            path: path.to_owned(),
            key: TOPIC,
            found: text,
            expected: "a decision of the automated car",
        })?;
        decisions.push(Decision { time_s: time_ns as f64 / 1e9, kind });
    }
    Ok(Some(decisions))
}

/// The texts of a stream of logs, if they are wanted.
#[derive(Debug, Default)]
struct Texts {
    wanted: bool,
    messages: Vec<(u64, String)>,
    mark: usize,
}

impl Take for Texts {
    fn take(&mut self, message: Message<'_>, _: u32) {
        #[derive(serde::Deserialize)]
        struct Log {
            message: String,
        }
        if self.wanted {
            let text = serde_json::from_slice::<Log>(message.data).map(|log| log.message);
            let text = text.unwrap_or_else(|_| String::from_utf8_lossy(message.data).into_owned());
            self.messages.push((message.log_ns, text));
        }
    }

    fn mark(&mut self) {
        self.mark = self.messages.len();
    }

    fn roll_back(&mut self) {
        self.messages.truncate(self.mark);
    }
}
