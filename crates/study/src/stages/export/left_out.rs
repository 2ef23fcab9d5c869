//! Who and what of a study is not given away.

use super::{material::Material, sources::RESULTS};
use crate::{
    design::DesignFile,
    error::StudyError,
    gate::{Gate, counted},
};
use maveric_analysis::{Driven, Why};
use maveric_domain::{DriveMeta, Moment, ParticipantId, Recording};
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
    let needs_analysis = rules.judges_answers() || rules.fewer_conditions_than.is_some();
    let analysis = study.resolve(&Path::new(RESULTS).join("analysis.json"));
    let changed = |path: &Path| path.metadata().and_then(|m| m.modified()).ok();
    let problem = match (changed(&analysis), study.path.as_deref().and_then(changed)) {
        (None, _) if needs_analysis => "is not there",
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
    pub(super) fn take_from(
        study: &DesignFile,
        participants: Option<&Path>,
        material: &mut Material,
    ) -> Result<Self, StudyError> {
        let duration_s = |recording: &Recording| {
            let time = recording.time_s();
            time.last().zip(time.first()).map_or(0.0, |(b, a)| b - a)
        };
        let driven = |(meta, recording): &(DriveMeta, Recording)| Driven {
            drive: meta.drive.clone(),
            participant: meta.participant.clone(),
            ride: meta.ride(),
            duration_s: Some(duration_s(recording)),
        };
        // Whatever their logs are called, what was answered after a drive that is left out goes with it.
        let drives: Vec<Driven> = material.drives.iter().map(driven).collect();
        let gate = Gate::where_listed(study, participants)?
            .with_analysis(&study.resolve(Path::new(RESULTS)))?
            .with_sheets(&[], &[], &drives);
        let exclude = study.design.exclude();
        let named = exclude.people.keys().map(ToString::to_string);
        let named = named.chain(exclude.drives.keys().map(ToString::to_string));
        let forgotten = study.forgotten()?;
        let mut left_out = Self {
            doubts: doubts(study).into_iter().collect(),
            names: named
                .chain(forgotten.ids().map(ToString::to_string))
                .collect(),
            ..Self::default()
        };
        material.people.retain(|p| left_out.person(&gate, &p.id));
        let mut keeps = |who: &ParticipantId, moment: Moment| match gate.answer(who, moment) {
            None => true,
            Some(why) => {
                left_out.person(&gate, who);
                left_out.answers.push(why);
                false
            }
        };
        material.answers.retain(|a| keeps(&a.participant, a.moment));
        material
            .probes
            .retain(|p| keeps(&p.participant, Moment::Probe(p.ride)));
        material.drives.retain(
            |(meta, recording)| match gate.drive(meta, duration_s(recording)) {
                None => true,
                Some(why) => {
                    left_out.person(&gate, &meta.participant);
                    left_out.names.insert(meta.drive.to_string());
                    left_out.drives.push(why);
                    false
                }
            },
        );
        material.own.retain(|row| {
            let moment = Moment::after(row.condition);
            left_out.person(&gate, &row.participant)
                && gate.answer(&row.participant, moment).is_none()
        });
        if let Some(data) = &mut material.outcomes {
            data.participants.retain(|id| left_out.person(&gate, id));
        }
        let stays = |id: &ParticipantId| gate.person(id).is_none();
        for id in material.collected.without(stays) {
            left_out.person(&gate, &id);
        }
        Ok(left_out)
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
        let answers = counted(["answer", "answers"], &self.answers);
        [people, drives, answers].concat()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::{Answer, DriveId, DrivenBy, Road, recording::EgoTrack};

    #[test]
    fn what_was_answered_after_a_drive_goes_with_it_by_the_name_of_its_log_and_by_person_and_condition()
     {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("participants.csv"), "participant\nP-1\n").unwrap();
        let who = ParticipantId::new("P-1").unwrap();
        let answer = |condition: &str| Answer {
            participant: who.clone(),
            moment: Moment::After(condition.parse().unwrap()),
            scale: "trust".to_owned(),
            item: 1,
            answer: Some(3),
        };
        let ego = EgoTrack {
            x_m: vec![0.0, 1.0],
            y_m: vec![0.0, 0.0],
            speed_mps: vec![20.0, 20.0],
            length_m: 4.5,
        };
        let (road, time_s) = (Road::PAPER, vec![0.0, 0.05]);
        let recording = Recording::new(road, 20.0, time_s, vec![0, 0], ego, Vec::new()).unwrap();
        let drive = |name: &str, condition: &str| {
            let meta = DriveMeta::new(
                DriveId::new(name).unwrap(),
                who.clone(),
                condition.parse().unwrap(),
                DrivenBy::Human,
            );
            (meta, recording.clone())
        };
        let kept = |excluded: &str| {
            let design = format!(
                "[study]\ntitle = \"t\"\n[[condition]]\nid = \"plus-15\"\n[[condition]]\nid = \"15\"\n\
                 [exclude]\ndrives = {{ {excluded} = \"the rig failed\" }}"
            );
            let file = folder.path().join("study.toml");
            std::fs::write(&file, design).unwrap();
            let mut material = Material {
                answers: vec![answer("plus-15"), answer("15")],
                drives: vec![drive("run7", "plus-15"), drive("run8", "15")],
                ..Material::default()
            };
            LeftOut::take_from(&DesignFile::read(&file).unwrap(), None, &mut material).unwrap();
            let drives = material.drives.iter().map(|d| d.0.drive.to_string());
            let answered = material.answers.iter().map(|a| a.moment.to_string());
            drives.chain(answered).collect::<Vec<_>>()
        };
        let without = ["run8", "15"];
        assert_eq!(kept("run7"), without);
        assert_eq!(kept("P-1-plus-15"), without);
        assert_eq!(kept("P-1-15"), ["run7", "plus-15"]);
        assert_eq!(kept("run9").len(), 4);
    }
}
