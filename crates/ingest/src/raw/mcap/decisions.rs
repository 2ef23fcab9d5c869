//! What the automated car decided, as log messages: written beside the recording, read back for whoever shows a drive.

use crate::error::IngestError;
use maveric_bag::{Record, Visitor, Walk, walk};
use maveric_domain::{LaneActivity, TraceRow, drive::Direction};
use std::path::Path;

/// Topic of the decisions, type `foxglove.Log`.
pub(crate) const TOPIC: &str = "/maveric/decisions";

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

    /// Who decides: the `name` of the message.
    pub(crate) fn node(self) -> &'static str {
        match self {
            Self::SafetyBrakes | Self::SafetyReleases => "safety_layer",
            _ => "lane_change",
        }
    }

    /// The message's level: 2 is information, 3 a warning.
    pub(crate) fn level(self) -> u8 {
        match self {
            Self::SafetyBrakes | Self::ChangeGivenUp => 3,
            _ => 2,
        }
    }
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
            let kind = if braked {
                DecisionKind::SafetyBrakes
            } else {
                DecisionKind::SafetyReleases
            };
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
            DecisionKind::ChangeStarts(if left {
                Direction::Left
            } else {
                Direction::Right
            })
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
    let mut reading = Reading::default();
    let how = Walk {
        recover: true,
        ..Walk::default()
    };
    walk(path, how, &mut reading)?;
    let Some(messages) = reading.messages else {
        return Ok(None);
    };
    let mut found = Vec::new();
    for (time_ns, text) in messages {
        let kind = DecisionKind::ALL.into_iter().find(|k| k.as_str() == text);
        let kind = kind.ok_or_else(|| IngestError::BadMetadata {
            path: path.to_owned(),
            key: TOPIC,
            found: text,
            expected: "a decision of the automated car",
        })?;
        found.push(Decision {
            time_s: time_ns as f64 / 1e9,
            kind,
        });
    }
    Ok(Some(found))
}

/// The messages of the decisions' channel.
#[derive(Debug, Default)]
struct Reading {
    channels: Vec<u16>,
    /// None without such a channel: a quiet drive has it, and no message on it.
    messages: Option<Vec<(u64, String)>>,
    mark: usize,
}

impl Visitor for Reading {
    fn record(&mut self, record: Record<'_>) {
        #[derive(serde::Deserialize)]
        struct Log {
            message: String,
        }
        match record {
            Record::Channel(channel) if channel.topic == TOPIC => {
                self.channels.push(channel.id);
                self.messages.get_or_insert_default();
            }
            Record::Message(message) if self.channels.contains(&message.channel) => {
                let text = serde_json::from_slice::<Log>(message.data).map(|log| log.message);
                let text =
                    text.unwrap_or_else(|_| String::from_utf8_lossy(message.data).into_owned());
                let messages = self.messages.get_or_insert_default();
                messages.push((message.log_ns, text));
            }
            _ => {}
        }
    }

    fn passed_over(&mut self) {}

    fn mark(&mut self) {
        self.mark = self.messages.as_ref().map_or(0, Vec::len);
    }

    fn roll_back(&mut self) {
        if let Some(messages) = &mut self.messages {
            messages.truncate(self.mark);
        }
    }
}
