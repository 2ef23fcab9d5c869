//! Whom a page counts and does not name: who is left out by name, was forgotten or is nobody of the study's people.

use crate::{
    design::DesignFile, error::StudyError, named::without, once::count, run_folder::lists,
    tables::drives::exclusions,
};
use maveric_domain::ParticipantId;
use maveric_report::{html::ParameterFile, tables::Exclusion};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// Rules that leave a drive out for who drove it, or by its own name.
const BY_NAME: [&str; 4] = [
    "exclude.people",
    "exclude.drives",
    "forgotten",
    "unknown participant",
];

/// What single drives are left out of that the design lets in.
pub(super) const WITH_WHAT_WAS_SAID: &str = "everything, with what was said of it";

/// What drives are left out of; people are left out of all else.
const OF_DRIVES: [&str; 4] = ["ingest", "simulate", "personalize", WITH_WHAT_WAS_SAID];

/// How many drives or people are left out of this.
fn how_many(n: usize, what: &str) -> String {
    if OF_DRIVES.contains(&what) {
        count(n, "drive", "drives")
    } else {
        count(n, "person", "people")
    }
}

/// Between the names of a row.
const BETWEEN: &str = ", ";

/// Ids that stand on no page.
pub(super) struct Nameless {
    /// Of people and drives, longer ones first: a drive's holds its person's.
    ids: Vec<String>,
    /// Everybody whom the table of people names, and drives that were let in.
    known: BTreeSet<ParticipantId>,
}

impl Nameless {
    /// Reads them from the results of a run.
    pub(super) fn read(
        study: &DesignFile,
        folder: &Path,
        participants: &Path,
    ) -> Result<Self, StudyError> {
        let exclude = study.design.exclude();
        let people = exclude.people.keys().map(ToString::to_string);
        let drives = exclude.drives.keys().map(ToString::to_string);
        let mut ids: BTreeSet<String> = people.chain(drives).collect();
        let mut known = BTreeSet::new();
        for list in lists(folder) {
            for row in exclusions(list.parent().unwrap_or(folder))? {
                if BY_NAME.contains(&row.rule.as_str()) {
                    ids.insert(row.drive);
                    ids.extend(Some(row.participant).filter(|_| row.rule != "exclude.drives"));
                } else if row.is_kept() {
                    known.extend(ParticipantId::new(row.drive).ok());
                }
            }
        }
        ids.remove("");
        let mut ids: Vec<String> = ids.into_iter().collect();
        ids.sort_by_key(|id| std::cmp::Reverse(id.len()));
        let people = study.people_of(folder, Some(participants))?.enrolled;
        known.extend(people.into_iter().map(|p| p.id));
        Ok(Self { ids, known })
    }

    /// What was left out: of those who are not named how many, by what from which and why.
    pub(super) fn counted(&self, rows: impl IntoIterator<Item = Exclusion>) -> Vec<Exclusion> {
        let mut named = Vec::new();
        let mut counted: BTreeMap<(String, String), BTreeSet<String>> = BTreeMap::new();
        for row in rows {
            let (hidden, shown): (Vec<&str>, Vec<&str>) = row
                .who
                .split(BETWEEN)
                .partition(|who| self.hides(who, &row.what));
            if !hidden.is_empty() {
                let why = without(&row.why, hidden.iter().copied());
                let why = without(&why, self.ids.iter().map(String::as_str));
                let who = hidden.iter().map(|who| (*who).to_owned());
                counted
                    .entry((row.what.clone(), why))
                    .or_default()
                    .extend(who);
            }
            if !shown.is_empty() {
                let who = shown.join(BETWEEN);
                named.push(Exclusion { who, ..row });
            }
        }
        let counted = counted.into_iter().map(|((what, why), who)| Exclusion {
            who: format!("{}, not named", how_many(who.len(), &what)),
            what,
            why,
        });
        counted.chain(named).collect()
    }

    fn hides(&self, who: &str, what: &str) -> bool {
        let is_stranger = || {
            // Of the lists those of answers name people, all others drives.
            let of_people = what.starts_with("answers")
                || ["questionnaires", Exclusion::NOTHING].contains(&what);
            let id = ParticipantId::new(who.trim());
            of_people && id.is_ok_and(|id| !self.known.contains(&id))
        };
        self.ids.iter().any(|id| id == who) || is_stranger()
    }

    /// Files that are shown whole, without the names.
    pub(super) fn files(&self, files: Vec<ParameterFile>) -> Vec<ParameterFile> {
        let hidden = |file: ParameterFile| ParameterFile {
            text: without(&file.text, self.ids.iter().map(String::as_str)),
            ..file
        };
        files.into_iter().map(hidden).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_is_not_named_is_counted_as_drives_or_as_people() {
        let nameless = Nameless {
            ids: ["P1-calm", "P1-own", "P1"].map(str::to_owned).to_vec(),
            known: BTreeSet::new(),
        };
        let row = |who: &str, what: &str| Exclusion {
            who: who.to_owned(),
            what: what.to_owned(),
            why: "withdrew".to_owned(),
        };
        let rows = [
            row("P1-calm", "ingest"),
            row("P1-own", "ingest"),
            row("P1", "everything"),
        ];
        let counted = nameless.counted(rows);
        let who: Vec<&str> = counted.iter().map(|row| row.who.as_str()).collect();
        assert_eq!(who, ["1 person, not named", "2 drives, not named"]);
    }
}
