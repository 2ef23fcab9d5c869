//! Who and what of a study is not given away.

use super::{material::Material, sources::RESULTS};
use crate::{
    deciding::hash_of_file,
    design::{DESIGN_FILE, DesignFile},
    error::StudyError,
    gate::{Gate, counted},
};
use maveric_analysis::{Driven, Why};
use maveric_domain::{DriveMeta, Moment, ParticipantId, Recording};
use maveric_pipeline::{FactKind, Ledger};
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

/// Where runs of a study's folder are recorded: of a pipeline of its own, else of the one that follows from its design.
const RECORDS: [&str; 2] = ["pipelines/study.lock", ".maveric/study.lock"];
/// What the rules made of the people and drives, among the results.
const ANALYSIS: &str = "analysis.json";

/// Whether the analysis among the results was made by the design as it stands; none where no run is recorded that made it.
fn is_of_this_design(study: &DesignFile) -> Option<bool> {
    let now = hash_of_file(study.path.as_deref()?).ok()?;
    let analysis = format!("{RESULTS}/{ANALYSIS}");
    let made = hash_of_file(&study.resolve(Path::new(&analysis))).ok()?;
    let hash_then = |file: &str| {
        let record = Ledger::read_any(&study.resolve(Path::new(file))).ok()?;
        let mut runs = record.run.values();
        let run = runs.find(|run| run.outputs.get(&analysis) == Some(&made))?;
        let mut inputs = run.made_from.facts(FactKind::Input);
        let (_, hash) = inputs.find(|(input, _)| *input == DESIGN_FILE)?;
        Some(hash.to_owned())
    };
    let then = RECORDS.into_iter().find_map(hash_then)?;
    Some(now == then)
}

/// What to know of rules that look at all that somebody did: they hold as the last analysis applied them.
fn doubts(study: &DesignFile) -> Option<String> {
    let rules = study.design.exclude();
    let needs_analysis = rules.judges_answers() || rules.fewer_conditions_than.is_some();
    let analysis = study.resolve(&Path::new(RESULTS).join(ANALYSIS));
    let changed = |path: &Path| path.metadata().and_then(|m| m.modified()).ok();
    let by_time = || {
        let declared = study.path.as_deref().and_then(changed);
        changed(&analysis) >= declared
    };
    let problem = if !analysis.is_file() {
        needs_analysis.then_some("is not there")?
    } else if is_of_this_design(study).unwrap_or_else(by_time) {
        return None;
    } else {
        "is older than the design"
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
    /// [`StudyError`] for a drive that is let in and whose log cannot be read; for a table or an analysis that cannot be read.
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
            names: named.chain(forgotten.ids().map(ToString::to_string)).collect(),
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
        material.probes.retain(|p| keeps(&p.participant, Moment::Probe(p.ride)));
        material.drives.retain(|(meta, recording)| match gate.drive(meta, duration_s(recording)) {
            None => true,
            Some(why) => {
                left_out.person(&gate, &meta.participant);
                left_out.names.insert(meta.drive.to_string());
                left_out.drives.push(why);
                false
            }
        });
        for (meta, error) in material.unread.drain(..) {
            let Some(why) = gate.drive(&meta, f64::INFINITY) else {
                return Err(error);
            };
            // Where the log's name is that of the drive and no more, nobody is known.
            if meta.participant.as_str() != meta.drive.as_str() {
                left_out.person(&gate, &meta.participant);
            }
            left_out.names.insert(meta.drive.to_string());
            left_out.drives.push(why);
        }
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
    use maveric_pipeline::{Manifest, Record};

    #[test]
    fn a_drive_whose_log_cannot_be_read_is_counted_where_it_is_left_out_and_refused_where_it_is_not()
     {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("participants.csv"), "participant\nP-1\n").unwrap();
        let file = folder.path().join("study.toml");
        let taken = |who: &str, exclude: &str| {
            let design =
                format!("[study]\ntitle = \"t\"\n[[condition]]\nid = \"15\"\n[exclude]\n{exclude}");
            std::fs::write(&file, design).unwrap();
            let meta = DriveMeta::named("run7", who, "15", DrivenBy::Human).unwrap();
            let mut material = Material {
                unread: vec![(meta, StudyError::not_possible("damaged"))],
                ..Material::default()
            };
            let study = DesignFile::read(&file).unwrap();
            let left_out = LeftOut::take_from(&study, None, &mut material);
            left_out.map_or_else(
                |e| e.to_string(),
                |left_out| format!("{}; {:?}", left_out.lines().join("; "), left_out.names),
            )
        };
        assert_eq!(
            taken("P-1", "drives = { P-1-15 = \"the rig failed\" }"),
            "1 drive left out by exclude.drives; {\"P-1-15\", \"run7\"}"
        );
        assert_eq!(
            taken("P-1", "people = { P-1 = \"withdrew\" }"),
            "1 person left out by exclude.people; 1 drive left out by exclude.people; {\"P-1\", \"run7\"}"
        );
        let stranger = taken("P-9", "");
        assert!(stranger.ends_with("{\"P-9\", \"run7\"}"), "{stranger}");
        assert_eq!(taken("P-1", ""), "damaged");
    }

    #[test]
    fn an_analysis_is_older_than_a_design_that_says_something_else_and_not_than_one_that_was_only_saved_again()
     {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        let save = |rules: &str| {
            let text =
                format!("[study]\ntitle = \"t\"\n[[condition]]\nid = \"calm\"\n[exclude]\n{rules}");
            std::fs::write(file("study.toml"), text).unwrap();
            DesignFile::read(&file("study.toml")).unwrap()
        };
        let rules = "straight_lined = true\n";
        assert_eq!(doubts(&save("")), None, "no rule needs an analysis");
        let doubt = doubts(&save(rules)).unwrap();
        assert!(doubt.contains("analysis.json is not there"), "{doubt}");
        std::fs::create_dir(file("results")).unwrap();
        std::fs::write(file("results/analysis.json"), "{}").unwrap();
        let hash = hash_of_file(&file("study.toml")).unwrap();
        let made_from: Manifest =
            toml::from_str(&format!("[input]\n\"study.toml\" = \"{hash}\"\n")).unwrap();
        let analysis = "results/analysis.json".to_owned();
        let made = hash_of_file(&file("results/analysis.json")).unwrap();
        let mut ledger = Ledger::empty("study");
        let run = Record {
            stage: "stats".to_owned(),
            variant: None,
            digest: made_from.digest(),
            seconds: 1.0,
            peak_memory: None,
            row: None,
            set: BTreeMap::new(),
            made_from,
            outputs: BTreeMap::from([(analysis.clone(), made)]),
            files: BTreeMap::new(),
        };
        ledger.run.insert(analysis, run);
        std::fs::create_dir(file(".maveric")).unwrap();
        let ledger = toml::to_string(&ledger).unwrap();
        std::fs::write(file(".maveric/study.lock"), ledger).unwrap();
        assert_eq!(doubts(&save(rules)), None);
        let doubt = doubts(&save("straight_lined = true\ndrive_shorter_than_s = 300\n")).unwrap();
        assert!(doubt.contains("analysis.json is older than the design"), "{doubt}");
        // What came later in its place, the ledger knows nothing of.
        std::fs::write(file("results/analysis.json"), "{ }").unwrap();
        assert_eq!(doubts(&DesignFile::read(&file("study.toml")).unwrap()), None);
    }

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
