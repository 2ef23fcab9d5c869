//! What is told of logs and drives: what was repaired or left out, what rigs do not see, and why there is nothing.

use super::{FailedLog, LeftOutDrive, Written, parts};
use crate::{
    error::StudyError,
    once::{count, names, together, told_once},
};
use maveric_domain::Sees;
use maveric_ingest::{IngestError, Warning};
use path_slash::PathExt as _;
use std::{collections::BTreeMap, fmt, path::PathBuf};

/// What was left out, repaired or is doubtful, in sentences; the drives by name.
pub(super) fn warnings(
    drives: &[Written],
    left_out: &[LeftOutDrive],
    failed: &[FailedLog],
) -> Vec<String> {
    let mut warnings: Vec<String> = failed.iter().map(FailedLog::to_string).collect();
    let doubts = drives.iter().flat_map(|d| &d.warnings);
    let doubts = doubts.map(|w| (w.file.to_slash_lossy().into_owned(), w));
    warnings.extend(doubted(doubts));
    let alone = drives.iter().filter(|d| !d.led).map(|d| {
        let why = "no lead vehicle in any row; it cannot teach following or lane changes";
        (d.meta.drive.to_string(), why.to_owned())
    });
    warnings.extend(told_once("drive", alone));
    let out = left_out.iter();
    let out = out.map(|out| (out.meta.drive.to_string(), out.why.to_string()));
    warnings.extend(told_once("drive", out));
    let parts = parts::maybe_parts(&drives.iter().map(|d| &d.meta), left_out);
    warnings.extend(told_once("drive", parts));
    warnings
}

/// What the rigs see that do not see everything, a line each.
pub(super) fn sights(drives: &[Written]) -> Vec<String> {
    let mut rigs: BTreeMap<String, usize> = BTreeMap::new();
    for drive in drives.iter().filter(|d| d.sees != Sees::ALL) {
        *rigs.entry(drive.sees.to_string()).or_default() += 1;
    }
    let line = |(sees, drives): (String, usize)| {
        let how_many = count(drives, "drive", "drives");
        format!("the rig of {how_many} sees: {sees}; habits that need more are not read")
    };
    rigs.into_iter().map(line).collect()
}

/// What is doubtful in logs: of one log as it says itself, the same of several once, with how often it came in all.
fn doubted<'a>(doubts: impl Iterator<Item = (String, &'a Warning)>) -> Vec<String> {
    let doubts: Vec<(String, &Warning)> = doubts.collect();
    let same = together(doubts.iter().map(|(log, w)| (log.clone(), &w.what)));
    same.into_iter()
        .flat_map(|(logs, what)| {
            let mut alike = doubts.iter().filter(|(_, w)| w.what == *what);
            if logs.len() == 1 {
                return alike.map(|(_, w)| w.to_string()).collect();
            }
            let times: usize = alike.by_ref().map(|(_, w)| w.count).sum();
            let times = if times > logs.len() {
                format!(" ({times} times)")
            } else {
                String::new()
            };
            vec![format!(
                "{} logs ({}): {what}{times}",
                logs.len(),
                names(&logs)
            )]
        })
        .collect()
}

impl From<(PathBuf, IngestError)> for FailedLog {
    fn from((log, error): (PathBuf, IngestError)) -> Self {
        let mut why = error.to_string();
        let mut cause = std::error::Error::source(&error);
        while let Some(error) = cause {
            why = format!("{why}: {error}");
            cause = error.source();
        }
        Self { log, why }
    }
}

impl fmt::Display for FailedLog {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "not ingested: {}", self.why)
    }
}

/// Why there is nothing: the one log's own error, or the first of several.
pub(super) fn none_ingested(mut failed: Vec<(PathBuf, IngestError)>) -> StudyError {
    if failed.len() == 1
        && let Some((_, error)) = failed.pop()
    {
        return error.into();
    }
    let count = failed.len();
    let first = failed.into_iter().next();
    let help = first.as_ref().and_then(|(_, error)| error.suggestion());
    let first = first.map(FailedLog::from);
    StudyError::NotPossible {
        problem: match first {
            Some(first) => format!(
                "none of {count} logs could be ingested; the first: {}",
                first.why
            ),
            None => "the logs hold no drive".to_owned(),
        },
        help,
    }
}
