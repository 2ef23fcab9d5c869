//! One participant's drives, to be watched side by side.

use super::{Run, embedding::shown_participant};
use crate::{
    error::StudyError,
    watching::{read_watched, watch_player},
};
use maveric_domain::Condition;
use maveric_ingest::IngestSettings;
use maveric_report::html::{Live, LiveContent};
use std::path::{Path, PathBuf};

/// The logs of the shown participant that are there: the own drive, then the conditions.
pub(super) fn logs(folder: &Path, run: &Run) -> Vec<PathBuf> {
    let Some(shown) = shown_participant(run) else {
        return Vec::new();
    };
    let who = &shown.participant;
    let own = folder.join(format!("logs/study2/{who}-{}.mcap", Condition::Own));
    let driven = Condition::AV.map(|c| folder.join(format!("av/logs/{who}-{c}.mcap")));
    let mut logs: Vec<PathBuf> = std::iter::once(own).chain(driven).collect();
    logs.retain(|log| log.is_file());
    logs
}

/// The player of these logs, below the six panels; `None` without a log.
pub(super) fn player(logs: &[PathBuf]) -> Result<Option<Live>, StudyError> {
    let mut drives = Vec::new();
    for log in logs {
        drives.extend(read_watched(log, &IngestSettings::default())?);
    }
    Ok((!drives.is_empty()).then(|| Live {
        below: "difference-panels".to_owned(),
        content: LiveContent::Player(watch_player(drives)),
    }))
}
