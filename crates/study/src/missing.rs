//! What is missing of a study: person by person and time by time, each with the reason, before a run and after it.

mod sources;

use crate::{
    design::DesignFile,
    error::StudyError,
    once::{count, names, together},
    tables::{TableName, surveys::write_moments},
};
use maveric_domain::{Moment, ParticipantId};
use serde::{Deserialize, Serialize};
use sources::{Awaited, Sources};
use std::path::Path;

/// What may be missing, in the order of the columns of `missing.csv`.
pub const KINDS: [&str; 4] = ["log", "drive", "answers", "measures"];

/// Lines that `maveric status` prints before it points at the table.
const MOST_LINES: usize = 60;

/// What is missing of a person at a time: a row of `missing.csv`. What is there, or is not awaited, is `None`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MissingRow {
    pub participant: ParticipantId,
    /// Before the drives, or after the baseline or a condition.
    pub moment: Moment,
    /// Why there is no log.
    pub log: Option<String>,
    /// Why there is no drive.
    pub drive: Option<String>,
    /// Which answers there are not.
    pub answers: Option<String>,
    /// Which of the study's own measures have no value.
    pub measures: Option<String>,
}

impl MissingRow {
    /// The reasons in the order of [`KINDS`].
    pub fn reasons(&self) -> [Option<&str>; 4] {
        [&self.log, &self.drive, &self.answers, &self.measures].map(Option::as_deref)
    }
}

/// Of how many people each kind is there at a time, and of how many it is awaited.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Counted {
    pub moment: Moment,
    /// There and awaited, in the order of [`KINDS`].
    pub kinds: [(usize, usize); 4],
}

/// What is missing of a study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Missing {
    /// A row a person and time of which anything is missing, in the order of the people and of the design.
    pub rows: Vec<MissingRow>,
    /// Of how many people anything is awaited.
    pub people: usize,
    /// A row a time, in the order of the design.
    pub counts: Vec<Counted>,
}

/// Finds what is missing of a study whose runs write into `results`. Nobody is listed whom `[exclude]` names.
///
/// # Errors
/// [`StudyError`] for a table or a mapping that cannot be read.
pub fn missing(
    study: &DesignFile,
    results: &Path,
    participants: Option<&Path>,
) -> Result<Missing, StudyError> {
    let sources = Sources::read(study, results, participants)?;
    let mut moments = vec![Moment::Pre];
    let conditions = study.design.condition_ids();
    for id in study.design.baseline_id().into_iter().chain(conditions) {
        for occasion in study.design.occasions(id) {
            let moment = Moment::after(id).on(occasion);
            if !moments.contains(&moment) {
                moments.push(moment);
            }
        }
    }
    if !study.design.protocol().post.is_empty() {
        moments.push(Moment::Post);
    }
    let mut counts: Vec<Counted> =
        moments.into_iter().map(|moment| Counted { moment, kinds: [(0, 0); 4] }).collect();
    let mut rows = Vec::new();
    for person in sources.people() {
        for time in &mut counts {
            let cells = sources.cells(person, time.moment);
            for (cell, (there, awaited)) in cells.iter().zip(&mut time.kinds) {
                *awaited += usize::from(*cell != Awaited::No);
                *there += usize::from(*cell == Awaited::There);
            }
            let [log, drive, answers, measures] = cells.map(Awaited::reason);
            let row = MissingRow {
                participant: person.id.clone(),
                moment: time.moment,
                log,
                drive,
                answers,
                measures,
            };
            if row.reasons().iter().any(Option::is_some) {
                rows.push(row);
            }
        }
    }
    // A time at which nothing is awaited of anybody is none of the study's.
    counts.retain(|time| time.kinds.iter().any(|(_, awaited)| *awaited > 0));
    Ok(Missing { rows, people: sources.people().len(), counts })
}

impl Missing {
    /// How many people lack each kind at some time, as a sentence; nothing where nothing is missing.
    pub fn summary(&self) -> Option<String> {
        let kind = |(at, kind): (usize, &&str)| {
            let sum = |f: fn(&(usize, usize)) -> usize| -> usize {
                self.counts.iter().map(|time| f(&time.kinds[at])).sum()
            };
            let (there, awaited) = (sum(|c| c.0), sum(|c| c.1));
            (there < awaited).then(|| format!("{kind} {} of {awaited}", awaited - there))
        };
        let kinds: Vec<String> = KINDS.iter().enumerate().filter_map(kind).collect();
        (!kinds.is_empty()).then(|| format!("missing: {}", kinds.join(", ")))
    }

    /// What is missing as lines: the same of several people at a time once.
    pub fn lines(&self) -> Vec<String> {
        let each = self.rows.iter().flat_map(|row| {
            let reasons = KINDS.into_iter().zip(row.reasons());
            reasons.filter_map(|(kind, why)| {
                let what = format!("{}, {kind}: {}", row.moment, why?);
                Some((row.participant.to_string(), what))
            })
        });
        let who = |who: &[String]| match who.len() {
            n if n > 1 && n == self.people => "everybody".to_owned(),
            _ => names(who),
        };
        let lines: Vec<String> = together(each)
            .into_iter()
            .map(|(ids, what)| format!("{what} ({})", who(&ids)))
            .collect();
        let more = lines.len().saturating_sub(MOST_LINES);
        let rest = (more > 0).then(|| {
            let lines = count(more, "line", "lines");
            format!("and {lines} more: `maveric status --missing missing.csv` writes all")
        });
        let shown = lines.into_iter().take(MOST_LINES);
        self.summary().into_iter().chain(shown).chain(rest).collect()
    }

    /// Writes all rows as a table.
    pub fn write(&self, path: &Path) -> Result<(), StudyError> {
        write_moments(TableName::Missing, path, &self.rows, |row| &mut row.moment)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of so many people these have no log before the drives.
    fn without_log(who: &[&str], people: usize) -> Missing {
        let row = |id: &&str| MissingRow {
            participant: ParticipantId::new(*id).unwrap(),
            moment: Moment::Pre,
            log: Some("no log".to_owned()),
            drive: None,
            answers: None,
            measures: None,
        };
        let none = (0, 0);
        Missing {
            rows: who.iter().map(row).collect(),
            people,
            counts: vec![Counted {
                moment: Moment::Pre,
                kinds: [(people - who.len(), people), none, none, none],
            }],
        }
    }

    #[test]
    fn what_all_lack_is_said_of_everybody_and_what_some_lack_of_them_by_name() {
        let lines = |who: &[&str], people: usize| without_log(who, people).lines();
        assert_eq!(
            lines(&["P1", "P2"], 2),
            ["missing: log 2 of 2", "pre, log: no log (everybody)"]
        );
        assert_eq!(lines(&["P1", "P2"], 3), ["missing: log 2 of 3", "pre, log: no log (P1, P2)"]);
        // One who is alone in a study is called by their name.
        assert_eq!(lines(&["P1"], 1), ["missing: log 1 of 1", "pre, log: no log (P1)"]);
        assert!(lines(&[], 3).is_empty());
    }
}
