//! How people turned the dial while riding: a file a ride.

use super::Table;
use crate::error::StudyError;
use maveric_analysis::Turns;
use maveric_domain::ParticipantId;
use std::path::Path;

/// How the files end.
pub const ENDING: &str = ".dial.csv";

/// Reads every file of turns in a folder, in the order of their names: `participant`, `time_s`, `points`, `step`, `duration_s`, a row a turn.
/// A folder that is not there has none.
///
/// # Errors
/// As [`Table`] does; [`StudyError::BadCell`] for a number that is missing.
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
    let table = Table::read(path)?;
    let ids: Vec<ParticipantId> = table.ids("participant")?;
    let whole = |column: &str| -> Result<Vec<f64>, StudyError> {
        let cells = table.numbers(column)?.into_iter().enumerate();
        cells
            .map(|(row, cell)| {
                cell.ok_or_else(|| table.bad_cell(row, column, "nothing", "a number"))
            })
            .collect()
    };
    let (times, points) = (whole("time_s")?, whole("points")?);
    let (steps, durations) = (whole("step")?, whole("duration_s")?);
    let Some(participant) = ids.first() else {
        return Ok(None);
    };
    Ok(Some(Turns {
        participant: participant.clone(),
        turned: times.into_iter().zip(points).collect(),
        duration_s: durations[0],
        step: steps[0],
    }))
}
