//! Who took part: groups, ages, scores.

use crate::{
    atomic_write::if_there,
    error::StudyError,
    mean::{mean, sd},
    tables::{
        measurements::MeasuredDrive,
        participants::{Enrolled, read_enrolled},
        surveys::read_scores,
    },
};
use maveric_analysis::Flow;
use maveric_domain::{Design, DrivenBy, Moment, ParticipantId, Score, design::ScoreName};
use maveric_participants::{Gender, Part};
use maveric_report::tables::ParticipantGroup;
use std::{collections::BTreeMap, path::Path};

/// Everybody who takes part and is not left out.
pub(super) struct People {
    participants: Vec<Enrolled>,
    scores: Vec<Score>,
    /// What the dial turns.
    score: Option<ScoreName>,
    /// Drives of each person that the program did not drive.
    drives: BTreeMap<ParticipantId, usize>,
}

/// Whether somebody takes part in this.
fn takes(person: &Enrolled, part: Part) -> bool {
    match part {
        Part::Learn => person.learned_from,
        Part::Test => person.tested,
    }
}

impl People {
    pub(super) fn read(
        folder: &Path,
        participants: &Path,
        drives: &[MeasuredDrive],
        (design, flow): (&Design, &Flow),
    ) -> Result<Self, StudyError> {
        let mut enrolled = read_enrolled(participants, design)?;
        let out = |id: &str| {
            flow.left_out
                .iter()
                .any(|l| l.who.iter().any(|who| who == id))
        };
        enrolled.retain(|p| p.excluded.is_none() && !out(p.id.as_str()));
        let mut recorded: BTreeMap<ParticipantId, usize> = BTreeMap::new();
        for drive in drives
            .iter()
            .filter(|d| d.meta.driven_by != DrivenBy::Automated)
        {
            *recorded.entry(drive.meta.participant.clone()).or_default() += 1;
        }
        Ok(Self {
            scores: if_there(&folder.join("scores.csv"), read_scores)?,
            score: design.style().map(|s| s.score.clone()),
            drives: recorded,
            participants: enrolled,
        })
    }

    fn of(&self, part: Part, population: Option<&str>) -> Vec<&Enrolled> {
        let fits = |p: &&Enrolled| {
            takes(p, part) && population.is_none_or(|g| p.population.as_deref() == Some(g))
        };
        self.participants.iter().filter(fits).collect()
    }

    fn style(&self, people: &[&Enrolled]) -> Vec<f64> {
        let score = |p: &&Enrolled| {
            let name = self.score.as_ref()?;
            let mine = |s: &&Score| {
                s.participant == p.id
                    && s.moment == Moment::Pre
                    && s.scale == name.scale
                    && s.subscale == name.subscale
            };
            self.scores.iter().find(mine)?.value
        };
        people.iter().filter_map(score).collect()
    }

    fn group(&self, name: &str, part: Part, population: Option<&str>) -> ParticipantGroup {
        let people = self.of(part, population);
        let ages: Vec<f64> = people.iter().filter_map(|p| p.age_years).collect();
        let genders: Vec<&str> = people.iter().filter_map(|p| p.gender.as_deref()).collect();
        let women = genders
            .iter()
            .filter(|g| **g == Gender::Female.as_str())
            .count();
        let scored = self.style(&people);
        let drives = people.iter().filter_map(|p| self.drives.get(&p.id)).sum();
        ParticipantGroup {
            group: name.to_owned(),
            n: people.len(),
            drives,
            mean_age: mean(&ages),
            sd_age: sd(&ages),
            female: (!genders.is_empty()).then(|| women as f64 / genders.len() as f64),
            mean_score: mean(&scored),
            sd_score: sd(&scored),
        }
    }

    /// The rows of the participants table: who is learned from, then who is tested, divided where the table divides them.
    pub(super) fn groups(&self) -> Vec<ParticipantGroup> {
        let mut groups = Vec::new();
        for (name, part) in [("Learned from", Part::Learn), ("Tested", Part::Test)] {
            let people = self.of(part, None);
            if people.is_empty() {
                continue;
            }
            let mut populations: Vec<&str> = Vec::new();
            for person in &people {
                let population = person.population.as_deref();
                populations.extend(population.filter(|p| !populations.contains(p)));
            }
            if populations.len() < 2 {
                groups.push(self.group(name, part, None));
                continue;
            }
            for population in populations {
                groups.push(self.group(&format!("{name}, {population}"), part, Some(population)));
            }
        }
        groups
    }

    /// What the claims ledger asks about the participants.
    pub(super) fn results(&self) -> Vec<(String, Option<f64>)> {
        let mut found = Vec::new();
        for (key, part, population) in [
            ("study1", Part::Learn, None),
            ("study2", Part::Test, None),
            ("study2.internal", Part::Test, Some("internal")),
            ("study2.external", Part::Test, Some("external")),
        ] {
            let group = self.group(key, part, population);
            found.push((format!("participants.{key}.n"), Some(group.n as f64)));
            found.push((format!("participants.{key}.mean_age"), group.mean_age));
            found.push((
                format!("participants.{key}.female_percent"),
                group.female.map(|f| 100.0 * f),
            ));
        }
        found.push((
            "participants.n".to_owned(),
            Some(self.participants.len() as f64),
        ));
        let professionals = self
            .of(Part::Learn, None)
            .iter()
            .filter(|p| p.professional)
            .count();
        found.push((
            "participants.study1.professionals".to_owned(),
            Some(professionals as f64),
        ));
        found.push((
            "participants.study1.drives".to_owned(),
            Some(self.group("study1", Part::Learn, None).drives as f64),
        ));
        found
    }
}
