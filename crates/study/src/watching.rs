//! Drives as the watch player wants them.

use crate::{
    atomic_write::{atomic_write_bytes, if_there},
    error::StudyError,
};
use maveric_domain::{Drive, DriveMeta, DrivenBy, Recording, TraceRow};
use maveric_ingest::{Decision, DecisionKind, IngestSettings, read_decisions, read_log};
use maveric_report::{
    Context,
    html::{CentreLine, InterventionSpan, PlayerDrive, PlayerMeta, WatchPlayer, watch_page},
    markup::capital,
};
use std::path::Path;

/// A drive to watch and whose it is.
#[derive(Debug, Clone, PartialEq)]
pub struct WatchedDrive {
    pub meta: DriveMeta,
    /// What the player shows of it.
    pub drive: PlayerDrive,
}

impl WatchedDrive {
    /// Makes a drive to watch of a recording; `interventions` as far as they are known, `centre_line` of a
    /// road that is not straight.
    ///
    /// # Errors
    /// [`StudyError::Domain`] where the recording makes no drive.
    pub fn new(
        meta: DriveMeta,
        recording: &Recording,
        interventions: Option<Vec<InterventionSpan>>,
        centre_line: Option<CentreLine>,
    ) -> Result<Self, StudyError> {
        let drive = Drive::from_recording(meta.clone(), recording)?;
        Ok(Self {
            drive: PlayerDrive::from_recording(
                recording,
                &drive,
                PlayerMeta {
                    label: capital(meta.condition.as_str()),
                    note: driven(meta.driven_by).to_owned(),
                    condition: meta.condition,
                    interventions,
                    centre_line,
                },
            ),
            meta,
        })
    }
}

fn driven(by: DrivenBy) -> &'static str {
    match by {
        DrivenBy::Human => "by hand",
        DrivenBy::Scripted => "by a script at the wheel",
        DrivenBy::Synthetic => "by hand, synthetic participant",
        DrivenBy::Automated => "automated",
    }
}

/// Reads the drives of a log, and when the safety layer stepped in if the log keeps that.
///
/// # Errors
/// [`StudyError::Ingest`] if the log cannot be read.
pub fn read_watched(
    log: &Path,
    settings: &IngestSettings,
) -> Result<Vec<WatchedDrive>, StudyError> {
    let drives = read_log(log, settings)?;
    let decisions = if_there(log, |log| Ok(read_decisions(log)?))?;
    let watched = drives.into_iter().map(|logged| {
        let end_s = logged.recording.time_s().last().copied().unwrap_or(0.0);
        let interventions = decisions.as_ref().map(|list| interventions(list, end_s));
        // A log is in the road frame, in which every road is straight.
        WatchedDrive::new(logged.meta, &logged.recording, interventions, None)
    });
    watched.collect()
}

/// From each braking of the safety layer to its release; the last may last to the end.
fn interventions(decisions: &[Decision], end_s: f64) -> Vec<InterventionSpan> {
    let mut out: Vec<InterventionSpan> = Vec::new();
    for decision in decisions {
        match decision.kind {
            DecisionKind::SafetyBrakes => {
                out.push(InterventionSpan { start_s: decision.time_s, end_s });
            }
            DecisionKind::SafetyReleases => {
                if let Some(last) = out.last_mut() {
                    last.end_s = decision.time_s;
                }
            }
            _ => {}
        }
    }
    out
}

/// When the safety layer braked, from the trace of the drive.
pub fn braking(trace: &[TraceRow]) -> Vec<InterventionSpan> {
    let mut out: Vec<InterventionSpan> = Vec::new();
    let mut before = false;
    for row in trace {
        match out.last_mut() {
            Some(last) if before => last.end_s = row.time_s,
            _ if row.braked => {
                out.push(InterventionSpan { start_s: row.time_s, end_s: row.time_s });
            }
            _ => {}
        }
        before = row.braked;
    }
    out
}

/// The player of some drives, in the order given. Where they are several participants', the rows say whose each is.
pub fn watch_player(drives: Vec<WatchedDrive>) -> WatchPlayer {
    let first = drives.first().map(|d| d.meta.participant.clone());
    let one = drives.iter().all(|d| Some(&d.meta.participant) == first.as_ref());
    let mut labels = std::collections::BTreeSet::new();
    let twice = drives.iter().any(|d| !labels.insert(d.drive.label.clone()));
    WatchPlayer {
        name: "watch".to_owned(),
        title: match first {
            Some(participant) if one => format!("Drives of {participant}"),
            _ => "Drives".to_owned(),
        },
        drives: drives
            .into_iter()
            .map(|watched| PlayerDrive {
                label: if one && !twice {
                    watched.drive.label
                } else {
                    watched.meta.drive.to_string()
                },
                ..watched.drive
            })
            .collect(),
    }
}

/// Writes the page that plays some drives; it says so where one of them is a synthetic participant's.
///
/// # Errors
/// [`StudyError::Report`] where a drive cannot be shown, [`StudyError::Io`] if the file cannot be written.
pub fn write_watch_page(
    out: &Path,
    drives: Vec<WatchedDrive>,
    seed: Option<u64>,
    provenance: &[(String, String)],
) -> Result<(), StudyError> {
    let context = Context {
        synthetic: drives.iter().any(|d| d.meta.driven_by == DrivenBy::Synthetic),
        seed,
        ..Context::real()
    };
    let page = watch_page(&watch_player(drives), &context, provenance)?;
    atomic_write_bytes(out, page.as_bytes())
}
