//! The record of a drive: what it was given, a line of JSON a piece.
//!
//! The first line is a [`Header`], each further one a [`Chunk`] as the page sends it once a second, the last an [`End`]. A drive that
//! was cut short has no end; what was kept of it drives again all the same.

use crate::{error::SeatPageError, input::Input};
use maveric_domain::{DrivenBy, Embedding, LaneWish, Setpoints, When};
use maveric_simulator::{ControllerSettings, Scenario};
use serde::{Deserialize, Serialize};

/// What a drive begins with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// Version of the record: 1.
    pub maveric_seat_drive: u32,
    /// `human`, `scripted`, or `automated` for a ride.
    pub driven_by: DrivenBy,
    /// Root of every random choice of the world.
    pub seed: u64,
    pub scenario: Scenario,
    /// The controllers of a ride; none of one that shows a drive by hand again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub controllers: Option<ControllerSettings>,
    /// The style in which a ride begins; none of a drive by hand, and of one that shows it again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub style: Option<Embedding>,
}

impl Header {
    pub const VERSION: u32 = 1;

    /// Whether its pieces hold inputs: of a drive by hand, and of a ride that shows one again.
    pub fn holds_inputs(&self) -> bool {
        self.controllers.is_none()
    }
}

/// An input that was held for some steps, as `[steps, steering, throttle, brake, signal]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "HeldRow", into = "HeldRow")]
pub struct Held {
    pub steps: u32,
    pub input: Input,
}

/// [`Held`] as it is written.
type HeldRow = (u32, i16, u16, u16, i8);

impl TryFrom<HeldRow> for Held {
    type Error = String;
    fn try_from((steps, steering, throttle, brake, signal): HeldRow) -> Result<Self, String> {
        let input = Input { steering, throttle, brake, signal: signal.try_into()? };
        if input.possible() {
            Ok(Self { steps, input })
        } else {
            Err(format!(
                "steering {steering}, throttle {throttle}, brake {brake}: expected -30000 to 30000 and 0 to 10000"
            ))
        }
    }
}

impl From<Held> for HeldRow {
    fn from(held: Held) -> Self {
        let i = held.input;
        (held.steps, i.steering, i.throttle, i.brake, i.signal.into())
    }
}

/// Set-points that were asked for some rows running, as `[rows, speed_mps, following_distance_m, wish]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "AskedRow", into = "AskedRow")]
pub struct Asked {
    /// For how many rows of the recording.
    pub rows: u32,
    pub setpoints: Setpoints,
}

/// [`Asked`] as it is written.
type AskedRow = (u32, f64, f64, u8);

/// Wishes, by the number that stands for them.
const WISHES: [LaneWish; 5] = [
    LaneWish::Stay,
    LaneWish::MoveOut(When::NotYet),
    LaneWish::MoveOut(When::Now),
    LaneWish::MoveBack(When::NotYet),
    LaneWish::MoveBack(When::Now),
];

impl TryFrom<AskedRow> for Asked {
    type Error = String;
    fn try_from((rows, speed_mps, following_distance_m, wish): AskedRow) -> Result<Self, String> {
        let wish = *WISHES
            .get(usize::from(wish))
            .ok_or_else(|| format!("wish {wish}, expected 0 to 4"))?;
        Ok(Self { rows, setpoints: Setpoints { speed_mps, following_distance_m, wish } })
    }
}

impl From<Asked> for AskedRow {
    fn from(asked: Asked) -> Self {
        let s = asked.setpoints;
        let wish = WISHES.iter().position(|w| *w == s.wish).unwrap_or(0) as u8;
        (asked.rows, s.speed_mps, s.following_distance_m, wish)
    }
}

/// Something that the person did beside driving.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// Step of the drive at which it happened.
    pub tick: u64,
    /// What: `uncomfortable`, `dial`, `hidden`, …
    pub what: String,
    /// Where it was turned to, in points, for `dial`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub points: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frames {
    pub drawn: u32,
    /// Pictures that came more than 50 ms after the one before.
    pub late: u32,
    /// Steps that were left out because the machine could not keep up.
    pub dropped_steps: u32,
    /// Longest time from one picture to the next, in ms.
    pub longest_ms: u32,
    /// Longest time from a key going down to the end of drawing the first picture that shows what it did, in ms.
    pub input_ms: u32,
}

/// A piece of a drive: what was given since the piece before.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Chunk {
    /// First step of the piece.
    pub from_tick: u64,
    pub ticks: u64,
    /// A person's inputs; they add up to `ticks`. Nothing in a ride.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub held: Vec<Held>,
    /// A ride's set-points, a row of the recording each. Nothing in a drive by hand.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub asked: Vec<Asked>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub events: Vec<Event>,
    #[serde(default)]
    pub frames: Frames,
}

/// What a drive ends with.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct End {
    pub end_tick: u64,
    /// [`Digest`](crate::Digest) of all states.
    pub states: String,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    pub header: Header,
    /// Its pieces, in order, none missing.
    pub chunks: Vec<Chunk>,
    /// Its last line; none where the drive was cut short.
    pub end: Option<End>,
}

impl Chunk {
    /// Whether its inputs add up to its steps.
    fn check(&self, by_hand: bool) -> Result<(), String> {
        let given: u64 = self.held.iter().map(|h| u64::from(h.steps)).sum();
        match (by_hand, given) {
            (true, given) if given != self.ticks => {
                Err(format!("inputs for {given} steps, expected {}", self.ticks))
            }
            (true, _) if !self.asked.is_empty() => {
                Err("set-points in a drive by hand, expected inputs alone".to_owned())
            }
            (false, given) if given != 0 => {
                Err("inputs in a ride, expected set-points alone".to_owned())
            }
            _ => Ok(()),
        }
    }
}

impl Record {
    /// Reads a record from its lines. A last line that was cut off in the middle is left out, as by a crash.
    ///
    /// # Errors
    /// [`SeatPageError::Line`] or [`SeatPageError::Gap`], naming the line.
    pub fn from_lines(text: &str) -> Result<Self, SeatPageError> {
        let whole = text.ends_with('\n');
        let lines: Vec<&str> = text.lines().collect();
        let last = lines.len();
        let bad = |line: usize, problem: String| SeatPageError::Line { line, problem };
        let header: Header = match lines.first() {
            None => return Err(bad(1, "empty, expected the head of a drive".to_owned())),
            Some(first) => serde_json::from_str(first)
                .map_err(|e| bad(1, format!("not the head of a drive: {e}")))?,
        };
        if header.maveric_seat_drive != Header::VERSION {
            let version = header.maveric_seat_drive;
            return Err(bad(1, format!("version {version}, expected {}", Header::VERSION)));
        }
        let mut record = Self { header, chunks: Vec::new(), end: None };
        let mut next_tick = 0;
        for (line, text) in (2..).zip(&lines[1..]) {
            if record.end.is_some() {
                return Err(bad(line, "more after the end of the drive".to_owned()));
            }
            if let Ok(end) = serde_json::from_str::<End>(text) {
                record.end = Some(end);
                continue;
            }
            let chunk: Chunk = match serde_json::from_str(text) {
                Ok(chunk) => chunk,
                Err(_) if line == last && !whole => break,
                Err(e) => return Err(bad(line, format!("not a piece of a drive: {e}"))),
            };
            if chunk.from_tick != next_tick {
                return Err(SeatPageError::Gap {
                    line,
                    found: chunk.from_tick,
                    expected: next_tick,
                });
            }
            chunk.check(record.header.holds_inputs()).map_err(|problem| bad(line, problem))?;
            next_tick = next_tick.saturating_add(chunk.ticks);
            record.chunks.push(chunk);
        }
        Ok(record)
    }

    /// The record as lines.
    ///
    /// # Errors
    /// [`SeatPageError::Record`] if a number in it is none.
    pub fn to_lines(&self) -> Result<String, SeatPageError> {
        let bad = |e: serde_json::Error| SeatPageError::Record { problem: e.to_string() };
        let mut lines = serde_json::to_string(&self.header).map_err(bad)? + "\n";
        for chunk in &self.chunks {
            lines += &(serde_json::to_string(chunk).map_err(bad)? + "\n");
        }
        if let Some(end) = &self.end {
            lines += &(serde_json::to_string(end).map_err(bad)? + "\n");
        }
        Ok(lines)
    }

    /// What hands and feet did, one after the other.
    pub fn held(&self) -> impl Iterator<Item = Held> + '_ {
        self.chunks.iter().flat_map(|chunk| chunk.held.iter().copied())
    }

    /// Whether the car was given the same inputs as in `driven`, as far as this one goes; where `driven` went on, this was left before its end.
    pub fn shows(&self, driven: &Self) -> bool {
        let [ours, theirs] = [self, driven].map(|r| {
            r.held().flat_map(|held| std::iter::repeat_n(held.input, held.steps as usize))
        });
        self.header.holds_inputs()
            && self.ticks() <= driven.ticks()
            && ours.zip(theirs).all(|(our, their)| our == their)
    }

    pub fn ticks(&self) -> u64 {
        self.chunks.iter().map(|c| c.ticks).sum()
    }
}
