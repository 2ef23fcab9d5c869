//! Whom a page counts and does not name: who is left out by name, was forgotten or is nobody of the study's people.

use crate::{
    design::DesignFile,
    error::StudyError,
    missing::{Missing, MissingRow},
    named::{is_number, without},
    once::count,
    run_folder::lists,
    stages::score::of_answers,
    tables::drives::exclusions,
};
use maveric_analysis::{Flow, Rule};
use maveric_domain::{DriveId, Moment, ParticipantId, Ride};
use maveric_report::{html::ParameterFile, tables::Exclusion};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// Rules that leave a drive out for who drove it, or by its own name.
const BY_NAME: [&str; 4] = ["exclude.people", "exclude.drives", "forgotten", "unknown participant"];

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
    /// What is left out with the drives among them.
    rides: BTreeSet<(ParticipantId, Ride)>,
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
        let mut rides = BTreeSet::new();
        for list in lists(folder) {
            for row in exclusions(list.parent().unwrap_or(folder))? {
                if row.rule == "exclude.drives" {
                    let who = ParticipantId::new(row.participant.as_str()).ok();
                    rides.extend(who.zip(row.ride().ok()));
                }
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
        // Also where no log came of the drive.
        let design = &study.design;
        let conditions = design.condition_ids().chain(design.baseline_id());
        for ride in conditions.flat_map(|id| design.rides(id)) {
            let is_named = |who: &ParticipantId| {
                let drive = DriveId::in_condition(who, ride);
                drive.is_ok_and(|drive| exclude.drives.contains_key(&drive))
            };
            let people = people.iter().filter(|p| is_named(&p.id));
            rides.extend(people.map(|p| (p.id.clone(), ride)));
        }
        known.extend(people.into_iter().map(|p| p.id));
        Ok(Self { ids, rides, known })
    }

    /// What is missing, with no reason where a drive is left out by its name.
    pub(super) fn missing(&self, missing: Missing) -> Missing {
        let hidden = |row: MissingRow| {
            let ride = row.moment.ride();
            let cell = ride.map(|ride| (row.participant.clone(), ride));
            if !cell.is_some_and(|cell| self.rides.contains(&cell)) {
                return row;
            }
            let why = |why: Option<String>| why.map(|_| "left out".to_owned());
            MissingRow {
                log: why(row.log),
                drive: why(row.drive),
                answers: why(row.answers),
                measures: why(row.measures),
                ..row
            }
        };
        Missing { rows: missing.rows.into_iter().map(hidden).collect(), ..missing }
    }

    /// What was left out: of those who are not named how many, by what from which and why.
    pub(super) fn counted(&self, rows: impl IntoIterator<Item = Exclusion>) -> Vec<Exclusion> {
        let mut named = Vec::new();
        let mut counted: BTreeMap<(String, String), BTreeSet<String>> = BTreeMap::new();
        for row in rows {
            let (hidden, shown): (Vec<&str>, Vec<&str>) =
                row.who.split(BETWEEN).partition(|who| self.hides(who, &row.what));
            if !hidden.is_empty() {
                let why = without(&row.why, hidden.iter().copied());
                let why = without(&why, self.ids.iter().map(String::as_str));
                let why = self.without_anybody(&why);
                let who = hidden.iter().map(|who| (*who).to_owned());
                counted.entry((row.what.clone(), why)).or_default().extend(who);
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

    /// Takes every id out of the reasons that somebody typed.
    pub(super) fn clear(&self, flow: &mut Flow) {
        let lists = [&mut flow.left_out, &mut flow.not_learned_from, &mut flow.drives];
        let typed = [Rule::People, Rule::Drives, Rule::Stopped];
        for row in lists.into_iter().flatten() {
            if typed.contains(&row.rule) {
                row.why = self.without_anybody(&row.why);
            }
        }
    }

    /// Words with `…` for the id of anybody, be it no mere number.
    fn without_anybody(&self, text: &str) -> String {
        let known = self.known.iter().map(ParticipantId::as_str);
        let ids = self.ids.iter().map(String::as_str).chain(known);
        let mut ids: Vec<&str> = ids.filter(|id| !is_number(id)).collect();
        ids.sort_by_key(|id| std::cmp::Reverse(id.len()));
        without(text, ids)
    }

    fn hides(&self, who: &str, what: &str) -> bool {
        let is_stranger = || {
            // Of the lists those of answers name people, all others drives.
            let of_people = what.starts_with("answers")
                || ["questionnaires", Exclusion::NOTHING].contains(&what);
            let id = ParticipantId::new(who.trim());
            of_people && id.is_ok_and(|id| !self.known.contains(&id))
        };
        let of_ride = |(person, ride): &(ParticipantId, Ride)| {
            let moments = [Moment::After(*ride), Moment::Probe(*ride)];
            person.as_str() == who && moments.map(of_answers).iter().any(|of| of == what)
        };
        self.ids.iter().any(|id| id == who) || self.rides.iter().any(of_ride) || is_stranger()
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
    use maveric_analysis::LeftOutFor;

    #[test]
    fn reasons_that_were_typed_name_nobody_and_those_of_the_program_stay() {
        let nameless = Nameless {
            ids: vec!["S2P05".to_owned()],
            rides: BTreeSet::new(),
            known: ["S2P08", "S2P08-own", "12"].map(|id| ParticipantId::new(id).unwrap()).into(),
        };
        let row = |rule: Rule, why: &str| LeftOutFor {
            rule,
            why: why.to_owned(),
            who: vec!["S2P08-own".to_owned()],
        };
        let mut flow = Flow {
            drives: vec![
                row(Rule::Drives, "S2P08 was sick after 12 minutes of S2P08-own"),
                row(Rule::Short, "drive shorter than 300 s"),
            ],
            not_learned_from: vec![row(Rule::People, "went with S2P05")],
            ..Flow::default()
        };
        nameless.clear(&mut flow);
        assert_eq!(flow.drives[0].why, "… was sick after 12 minutes of …");
        assert_eq!(flow.drives[1].why, "drive shorter than 300 s");
        assert_eq!(flow.not_learned_from[0].why, "went with …");
        assert_eq!(flow.drives[0].who, ["S2P08-own"]);
    }

    #[test]
    fn who_is_not_named_is_counted_as_drives_or_as_people() {
        let nameless = Nameless {
            ids: ["P1-calm", "P1-own", "P1"].map(str::to_owned).to_vec(),
            rides: BTreeSet::new(),
            known: BTreeSet::new(),
        };
        let row = |who: &str, what: &str| Exclusion {
            who: who.to_owned(),
            what: what.to_owned(),
            why: "withdrew".to_owned(),
        };
        let rows = [row("P1-calm", "ingest"), row("P1-own", "ingest"), row("P1", "everything")];
        let counted = nameless.counted(rows);
        let who: Vec<&str> = counted.iter().map(|row| row.who.as_str()).collect();
        assert_eq!(who, ["1 person, not named", "2 drives, not named"]);
    }

    #[test]
    fn what_is_left_out_with_a_drive_that_is_not_named_names_nobody_either() {
        let who = ParticipantId::new("P1").unwrap();
        let ride = |text: &str| text.parse::<Ride>().unwrap();
        let nameless = Nameless {
            ids: vec!["P1-calm".to_owned()],
            rides: [(who.clone(), ride("calm"))].into(),
            known: [who.clone()].into(),
        };
        let why = "left out by exclude.drives: simulator sickness";
        let row = |what: &str| Exclusion {
            who: "P1".to_owned(),
            what: what.to_owned(),
            why: why.to_owned(),
        };
        let counted = nameless.counted([row("answers (calm)"), row("answers (sporty)")]);
        let who_is_told: Vec<&str> = counted.iter().map(|row| row.who.as_str()).collect();
        assert_eq!(who_is_told, ["1 person, not named", "P1"]);
        let row = |condition: &str| MissingRow {
            participant: who.clone(),
            moment: Moment::After(ride(condition)),
            log: None,
            drive: Some(why.to_owned()),
            answers: None,
            measures: None,
        };
        let missing = nameless.missing(Missing {
            rows: vec![row("calm"), row("sporty")],
            people: 1,
            counts: Vec::new(),
        });
        let reasons: Vec<_> = missing.rows.iter().map(|row| row.drive.as_deref()).collect();
        assert_eq!(reasons, [Some("left out"), Some(why)]);
    }
}
