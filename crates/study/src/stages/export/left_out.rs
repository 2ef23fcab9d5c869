//! Who and what of a study is not given away.

use super::{material::Material, sources::RESULTS};
use crate::{
    design::DesignFile,
    error::StudyError,
    gate::{Gate, counted},
};
use maveric_analysis::Why;
use maveric_domain::{Moment, ParticipantId};
use path_slash::PathExt as _;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

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

/// What to know of rules that look at all that somebody did: they hold as the last analysis applied them.
fn doubts(study: &DesignFile) -> Option<String> {
    let rules = study.design.exclude();
    let asked = rules.judges_answers() || rules.fewer_conditions_than.is_some();
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
        material: &mut Material,
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
        material.people.retain(|p| found.person(&gate, &p.id));
        let mut keeps = |who: &ParticipantId, moment: Moment| match gate.answer(who, moment) {
            None => true,
            Some(why) => {
                found.person(&gate, who);
                found.answers.push(why);
                false
            }
        };
        material.answers.retain(|a| keeps(&a.participant, a.moment));
        material
            .probes
            .retain(|p| keeps(&p.participant, Moment::Probe(p.condition)));
        material.drives.retain(|(meta, recording)| {
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
        material.own.retain(|row| {
            let moment = Moment::After(row.condition);
            found.person(&gate, &row.participant) && gate.answer(&row.participant, moment).is_none()
        });
        if let Some(data) = &mut material.outcomes {
            data.participants.retain(|id| found.person(&gate, id));
        }
        let stays = |id: &ParticipantId| gate.person(id).is_none();
        for id in material.collected.without(stays) {
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
