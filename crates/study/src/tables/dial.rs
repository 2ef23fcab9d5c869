//! How people turned the dial while riding: a file a ride.

use super::read_rows;
use crate::error::StudyError;
use maveric_analysis::Turns;
use maveric_domain::ParticipantId;
use serde::{Deserialize, Serialize};
use std::path::Path;

pub const ENDING: &str = ".dial.csv";

/// One turn of the dial: a row of such a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Turn {
    pub participant: ParticipantId,
    pub time_s: f64,
    pub points: f64,
    pub step: f64,
    pub duration_s: f64,
}

/// Reads every file of turns in a folder, in the order of their names.
/// A folder that is not there has none.
///
/// # Errors
/// As [`read_rows`]; [`StudyError::BadCell`] for a number that is missing.
pub fn read_turns(folder: &Path) -> Result<Vec<Turns>, StudyError> {
    let Ok(found) = std::fs::read_dir(folder) else {
        return Ok(Vec::new());
    };
    let mut paths: Vec<_> = found.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| path.to_string_lossy().ends_with(ENDING));
    paths.sort();
    let mut turns = Vec::new();
    for path in paths {
        turns.extend(read(&path)?);
    }
    Ok(turns)
}

fn read(path: &Path) -> Result<Option<Turns>, StudyError> {
    let turns: Vec<Turn> = read_rows(path)?;
    let Some(first) = turns.first() else {
        return Ok(None);
    };
    Ok(Some(Turns {
        participant: first.participant.clone(),
        duration_s: first.duration_s,
        step: first.step,
        turned: turns.iter().map(|t| (t.time_s, t.points)).collect(),
    }))
}
