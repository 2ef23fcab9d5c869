//! Who and what of a study is not given away.

use super::seat::Collected;
use crate::{
    design::DesignFile,
    error::StudyError,
    gate::{Gate, counted},
    tables::participants::Enrolled,
};
use maveric_analysis::Why;
use maveric_domain::{Answer, DriveMeta, ParticipantId, Recording};
use path_slash::PathExt as _;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// Where `maveric run` writes in a study's folder.
pub(super) const RESULTS: &str = "results";

/// What was left out, and whatever would name somebody who was.
#[derive(Default)]
pub(super) struct LeftOut {
    people: BTreeMap<ParticipantId, Why>,
    drives: Vec<Why>,
    answers: Vec<Why>,
    /// Ids of people and of drives.
    pub(super) names: BTreeSet<String>,
    /// What to know of the rules as they were applied.
    pub(super) doubts: Vec<String>,
}

/// People, answers and drives of a study.
type Study<'a> = (
    &'a mut Vec<Enrolled>,
    &'a mut Vec<Answer>,
    &'a mut Vec<(DriveMeta, Recording)>,
    &'a mut Collected,
);

/// What to know of rules that look at all that somebody did: they hold as the last analysis applied them.
fn doubts(study: &DesignFile) -> Option<String> {
    let rules = study.design.exclude();
    let asked = rules.straight_lined || rules.fewer_conditions_than.is_some();
    let analysis = study.resolve(&Path::new(RESULTS).join("analysis.json"));
    let changed = |path: &Path| path.metadata().and_then(|m| m.modified()).ok();
    let problem = match (changed(&analysis), study.path.as_deref().and_then(changed)) {
        (None, _) if asked => "is not there",
        (Some(analysed), Some(declared)) if analysed < declared => "is older than the design",
        _ => return None,
    };
    let shown = analysis.to_slash_lossy();
    Some(format!(
        "{shown} {problem}: rules for sheets and for conditions leave out nobody who is not in it; `maveric run` makes it"
    ))
}

impl LeftOut {
    /// Takes out what the study does not let in.
    ///
    /// # Errors
    /// As [`Gate::where_listed`].
    pub(super) fn of(
        study: &DesignFile,
        participants: Option<&Path>,
        (people, answers, drives, collected): Study<'_>,
    ) -> Result<Self, StudyError> {
        let gate = Gate::where_listed(study, participants)?
            .with_analysis(&study.resolve(Path::new(RESULTS)))?;
        let exclude = study.design.exclude();
        let named = exclude.people.keys().map(ToString::to_string);
        let named = named.chain(exclude.drives.keys().map(ToString::to_string));
        let forgotten = study.forgotten()?;
        let mut found = Self {
            doubts: doubts(study).into_iter().collect(),
            names: named
                .chain(forgotten.ids().map(ToString::to_string))
                .collect(),
            ..Self::default()
        };
        people.retain(|p| found.person(&gate, &p.id));
        answers.retain(|a| match gate.answer(&a.participant, a.moment) {
            None => true,
            Some(why) => {
                found.person(&gate, &a.participant);
                found.answers.push(why);
                false
            }
        });
        drives.retain(|(meta, recording)| {
            let time = recording.time_s();
            let duration_s = time.last().zip(time.first()).map_or(0.0, |(b, a)| b - a);
            match gate.drive(meta, duration_s) {
                None => true,
                Some(why) => {
                    found.person(&gate, &meta.participant);
                    found.names.insert(meta.drive.to_string());
                    found.drives.push(why);
                    false
                }
            }
        });
        for id in collected.without(|id| gate.person(id).is_none()) {
            found.person(&gate, &id);
        }
        Ok(found)
    }

    /// Whether somebody is let in; who is not is noted.
    fn person(&mut self, gate: &Gate, id: &ParticipantId) -> bool {
        let Some(why) = gate.person(id) else {
            return true;
        };
        self.names.insert(id.to_string());
        self.people.insert(id.clone(), why);
        false
    }

    /// How much each rule left out.
    pub(super) fn lines(&self) -> Vec<String> {
        let people = counted(["person", "people"], self.people.values());
        let drives = counted(["drive", "drives"], &self.drives);
        [
            people,
            drives,
            counted(["answer", "answers"], &self.answers),
        ]
        .concat()
    }
}
