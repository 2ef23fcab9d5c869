//! `seat replay`: the same drive again, here.

use crate::{error::SeatError, files::RECORD};
use maveric_bag::{MAGIC, attachment};
use maveric_domain::DrivenBy;
use maveric_seat_page::Record;
use serde::Serialize;
use std::path::Path;

/// What became of a drive that was driven again.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Repeated {
    /// Who drove: `human`, `scripted`, `automated`.
    pub driven_by: DrivenBy,
    /// Steps of 0.01 s.
    pub ticks: u64,
    /// Digest of all states, now.
    pub states: String,
    /// The digest that the record holds; none where the drive was cut short.
    pub recorded: Option<String>,
    /// Whether the states are the same, to the byte; none where there is nothing to hold them against.
    pub same: Option<bool>,
}

/// Drives a record again: of a file of its own, or attached to a drive's log.
///
/// # Errors
/// [`SeatError::Io`], [`SeatError::Record`] naming the file and the line; [`SeatError::Log`], [`SeatError::NoRecord`].
pub fn repeat(path: &Path) -> Result<Repeated, SeatError> {
    let io = |source| SeatError::io(path, source);
    let mut bytes = std::fs::read(path).map_err(io)?;
    if bytes.starts_with(MAGIC) {
        let record = attachment(path, RECORD)?;
        bytes = record.ok_or_else(|| SeatError::NoRecord(path.to_owned()))?;
    }
    let text = String::from_utf8(bytes).map_err(|e| io(std::io::Error::other(e)))?;
    let bad = |source| SeatError::Record { path: path.to_owned(), source };
    let record = Record::from_lines(&text).map_err(bad)?;
    let again = maveric_seat_page::replay(&record).map_err(bad)?;
    Ok(Repeated {
        driven_by: record.header.driven_by,
        ticks: again.end.end_tick,
        same: again.recorded.as_ref().map(|_| again.same()),
        recorded: again.recorded.map(|end| end.states),
        states: again.end.states,
    })
}
