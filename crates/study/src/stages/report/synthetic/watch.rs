//! One participant's drives, to be watched side by side.

use super::{Run, embedding::shown_participant};
use crate::error::StudyError;
use maveric_domain::{Condition, Drive, DrivenBy};
use maveric_ingest::{IngestSettings, read_log};
use maveric_report::html::{Live, LiveContent, PlayerDrive, PlayerMeta, WatchPlayer};
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
    let mut whose = String::new();
    for log in logs {
        for found in read_log(log, &IngestSettings::default())? {
            whose = found.meta.participant.to_string();
            let drive = Drive::from_recording(found.meta.clone(), &found.recording)?;
            let condition = found.meta.condition;
            let note = match found.meta.driven_by {
                DrivenBy::Human => "by hand",
                DrivenBy::Synthetic => "by hand, synthetic participant",
                DrivenBy::Automated => "automated",
            };
            let meta = PlayerMeta {
                label: super::capital(condition.as_str()),
                note: note.to_owned(),
                condition,
                interventions: None,
                centre_line: None,
            };
            drives.push(PlayerDrive::from_recording(&found.recording, &drive, meta));
        }
    }
    Ok((!drives.is_empty()).then(|| Live {
        below: "difference-panels".to_owned(),
        content: LiveContent::Player(WatchPlayer {
            name: "watch".to_owned(),
            title: format!("Drives of {whose}"),
            drives,
        }),
    }))
}
