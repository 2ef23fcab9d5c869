//! What is told of logs and drives: what was repaired or left out, what rigs do not see, and why there is nothing.

use super::{FailedLog, LeftOutDrive, Written, parts};
use crate::{
    error::StudyError,
    gate::Gate,
    once::{count, names, together, told_once},
};
use maveric_analysis::Rule;
use maveric_domain::Sees;
use maveric_ingest::{IngestError, Warning};
use path_slash::PathExt as _;
use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
    path::PathBuf,
};

/// What was left out, repaired or is doubtful, in sentences; the drives by name.
pub(super) fn warnings(
    drives: &[Written],
    left_out: &[LeftOutDrive],
    failed: &[FailedLog],
    gate: Option<&Gate>,
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
    warnings.extend(unknown_people(left_out, gate));
    let out = left_out.iter().filter(|out| out.why.rule != Rule::UnknownParticipant);
    let out = out.map(|out| (out.meta.drive.to_string(), out.why.to_string()));
    warnings.extend(told_once("drive", out));
    let parts = parts::maybe_parts(&drives.iter().map(|d| &d.meta), left_out);
    warnings.extend(told_once("drive", parts));
    warnings
}

/// The ids of left out drives that the table of people lacks, each with its logs.
fn unknown_people(left_out: &[LeftOutDrive], gate: Option<&Gate>) -> Vec<String> {
    let log = |out: &LeftOutDrive| {
        let name = out.log.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    };
    let found = left_out.iter().map(|out| (&out.meta.participant, log(out)));
    gate.map_or_else(Vec::new, |gate| gate.unknown_people(found))
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
            let times =
                if times > logs.len() { format!(" ({times} times)") } else { String::new() };
            vec![format!("{} logs ({}): {what}{times}", logs.len(), names(&logs))]
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

/// Why no drive was made: each rule that left drives out with its first drive, and the first log that could not be ingested.
pub(super) fn none_ingested(
    left_out: &[LeftOutDrive],
    mut failed: Vec<(PathBuf, IngestError)>,
    gate: Option<&Gate>,
) -> StudyError {
    if left_out.is_empty()
        && failed.len() == 1
        && let Some((_, error)) = failed.pop()
    {
        return error.into();
    }
    let logs = failed.len();
    let first = failed.into_iter().next();
    let mut help = unknown_people(left_out, gate);
    help.extend(let_one_in(left_out));
    help.extend(first.as_ref().and_then(|(_, error)| error.suggestion()));
    let first = first.map(|log| FailedLog::from(log).why);
    let problem = match (left_out.is_empty(), first) {
        (true, None) => "the logs hold no drive".to_owned(),
        (true, Some(first)) => format!("none of {logs} logs could be ingested; the first: {first}"),
        (false, first) => {
            let mut reasons = reasons(left_out);
            reasons.extend(first.map(|first| {
                let logs = count(logs, "log", "logs");
                format!("{logs} could not be ingested, the first: {first}")
            }));
            format!("no drive is let in; {}", reasons.join("; "))
        }
    };
    let help = (!help.is_empty()).then(|| help.join("; "));
    StudyError::NotPossible { problem, help }
}

/// The first drive of each rule with its reason, and how many more the rule leaves out.
fn reasons(left_out: &[LeftOutDrive]) -> Vec<String> {
    let mut by_rule: Vec<(&LeftOutDrive, usize)> = Vec::new();
    for out in left_out {
        match by_rule.iter_mut().find(|(first, _)| first.why.rule == out.why.rule) {
            Some((_, more)) => *more += 1,
            None => by_rule.push((out, 0)),
        }
    }
    let reason = |(first, more): (&LeftOutDrive, usize)| {
        let reason = format!("{}: {}", first.meta.drive, first.why);
        match more {
            0 => reason,
            more => format!("{reason} (and {} more)", count(more, "drive", "drives")),
        }
    };
    by_rule.into_iter().map(reason).collect()
}

/// What to do about the drives that are left out.
fn let_one_in(left_out: &[LeftOutDrive]) -> Vec<String> {
    let unknown = [Rule::UnknownParticipant, Rule::UnknownCondition, Rule::UnknownOccasion];
    let rules: BTreeSet<Rule> = left_out.iter().map(|out| out.why.rule).collect();
    let (named_otherwise, rules): (Vec<Rule>, Vec<Rule>) =
        rules.into_iter().partition(|rule| unknown.contains(rule));
    let mut help = Vec::new();
    if !named_otherwise.is_empty() {
        help.push("say whose drives these are under [names] of the mapping, or add people and conditions to the study".to_owned());
    }
    if !rules.is_empty() {
        let rules: Vec<&str> = rules.iter().map(|rule| rule.key()).collect();
        help.push(format!(
            "change the rule in the study ({}), or add drives that it lets in",
            rules.join(", ")
        ));
    }
    help
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_analysis::Why;
    use maveric_domain::{DriveMeta, DrivenBy};

    #[test]
    fn every_reason_is_named_where_no_drive_is_let_in() {
        let out = |who: &str, rule: Rule, why: &str| LeftOutDrive {
            log: format!("{who}.csv").into(),
            meta: DriveMeta::named(format!("{who}-own"), who, "own", DrivenBy::Human).unwrap(),
            duration_s: 60.0,
            why: Why::by(rule, why),
        };
        let broken = |who: &str| {
            let path = PathBuf::from(format!("{who}.csv"));
            (path.clone(), IngestError::NotFound { path })
        };
        let short = out("P1", Rule::Short, "60 s");
        let said = |left_out: &[LeftOutDrive], failed| {
            let error = none_ingested(left_out, failed, None);
            (error.to_string(), error.suggestion().unwrap_or_default())
        };
        let (problem, help) = said(&[short], vec![broken("P2"), broken("P3")]);
        assert!(problem.contains("P1-own: left out by "), "{problem}");
        let logs = "; 2 logs could not be ingested, the first: ";
        assert!(problem.contains(logs) && problem.contains("P2.csv"), "{problem}");
        assert!(help.contains("drive_shorter_than_s") && help.contains("check the path"), "{help}");
        let both = [
            out("P1", Rule::Short, "60 s"),
            out("P2", Rule::UnknownCondition, "`own` is none"),
            out("P3", Rule::UnknownCondition, "`own` is none"),
        ];
        let (problem, help) = said(&both, Vec::new());
        assert!(
            problem.contains("P2-own: ") && problem.contains("(and 1 drive more)"),
            "{problem}"
        );
        assert!(help.contains("[names]") && help.contains("drive_shorter_than_s"), "{help}");
    }
}
