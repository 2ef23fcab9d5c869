//! One participant's drives: played side by side, and one of them as a time-space diagram.

use super::{
    Run,
    embedding::{av_log, shown_participant},
};
use crate::{
    design::DesignFile,
    error::StudyError,
    watching::{WatchedDrive, read_watched, watch_player},
};
use maveric_domain::drive::Direction;
use maveric_ingest::IngestSettings;
use maveric_report::{
    figures::time_space::{Decision, DecisionKind, TimeSpace, Track},
    html::{self, Live, LiveContent},
};
use std::path::{Path, PathBuf};

/// The logs of the shown participant that are there: the own drive, then the conditions.
pub(super) fn logs(folder: &Path, study: &DesignFile, run: &Run) -> Vec<PathBuf> {
    let Some(shown) = shown_participant(folder, run) else {
        return Vec::new();
    };
    let who = &shown.participant;
    let baseline = run.design.baseline_id().into_iter();
    let mut places = baseline.flat_map(|b| {
        // Of a run by stages, and of a study's own folder.
        let roots = [folder.join("logs"), study.resolve(&study.design.files().logs)];
        roots.into_iter().flat_map(move |root| {
            let log_in = |part: &str| root.join(format!("{part}{who}-{b}.mcap"));
            [log_in("study2/"), log_in("test/"), log_in("")]
        })
    });
    let own_log = places.find(|log| log.is_file()).into_iter();
    let conditions = run.design.conditions().iter();
    let driven = conditions.map(|c| av_log(folder, who, c.id));
    let mut logs: Vec<PathBuf> = own_log.chain(driven).collect();
    logs.retain(|log| log.is_file());
    logs
}

/// The drives in these logs.
pub(super) fn drives(logs: &[PathBuf]) -> Result<Vec<WatchedDrive>, StudyError> {
    let mut drives = Vec::new();
    for log in logs {
        drives.extend(read_watched(log, &IngestSettings::default())?);
    }
    Ok(drives)
}

/// The player, below the panels, its rows called as the page calls them; `None` without a drive.
pub(super) fn player(run: &Run, mut drives: Vec<WatchedDrive>) -> Option<Live> {
    for watched in &mut drives {
        watched.drive.label = run.design.label(watched.meta.condition);
    }
    (!drives.is_empty()).then(|| Live {
        below: "difference-panels".to_owned(),
        content: LiveContent::Player(watch_player(drives)),
    })
}

/// A drive as a time-space diagram; `None` for one with holes.
pub(super) fn diagram(watched: &WatchedDrive) -> Option<TimeSpace> {
    let drive = &watched.drive;
    if drive.segment.windows(2).any(|s| s[0] != s[1]) {
        return None;
    }
    let track = |t: &html::Track| {
        let end = (t.first_row + t.x_m.len()).min(drive.time_s.len());
        let lane = |y_m: &f64| (y_m / drive.lane_width_m).round().clamp(0.0, 255.0) as u8;
        Track {
            time_s: drive.time_s[t.first_row.min(end)..end].to_vec(),
            x_m: t.x_m.iter().map(|x| x + 0.5 * t.length_m).collect(),
            lane: t.y_m.iter().map(lane).collect(),
        }
    };
    let led = |t: &&html::Track| drive.reference.contains(&Some(t.id));
    let changes = drive.lane_changes.iter().map(|c| Decision {
        time_s: c.start_s,
        kind: match c.direction {
            Direction::Left => DecisionKind::LaneChange,
            Direction::Right => DecisionKind::MergeBack,
        },
    });
    let braked = drive
        .interventions
        .iter()
        .flatten()
        .map(|i| Decision { time_s: i.start_s, kind: DecisionKind::Safety });
    Some(TimeSpace {
        drive: watched.meta.drive.to_string(),
        condition: watched.meta.condition,
        ego: track(&drive.ego),
        leads: drive.others.iter().filter(led).map(track).collect(),
        others: drive.others.iter().filter(|t| !led(t)).map(track).collect(),
        decisions: changes.chain(braked).collect(),
    })
}
