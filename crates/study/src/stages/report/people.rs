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
use maveric_pages::study::ParticipantGroup;
use maveric_participants::{Gender, Part};
use std::{collections::BTreeMap, path::Path};

/// Everybody who takes part and is not left out.
pub(super) struct People {
    participants: Vec<Enrolled>,
    scores: Vec<Score>,
    score: Option<ScoreName>,
    /// Drives of each person: those that the car did not drive, and those that it did.
    drives: BTreeMap<ParticipantId, [usize; 2]>,
}

/// Whether somebody takes part in this.
fn takes(person: &Enrolled, part: Part) -> bool {
    match part {
        Part::Learn => person.learned_from,
        Part::Test => person.tested,
    }
}

/// The share who are female of all who said, and every other word with how many said it; no share where no word is female or male, in
/// which case nobody knows what the words mean.
fn counted(genders: &[&str]) -> (Option<f64>, Vec<(String, usize)>) {
    let mut others: BTreeMap<String, usize> = BTreeMap::new();
    let mut known = 0;
    let mut women = 0;
    for word in genders {
        match word.parse() {
            Ok(Gender::Female) => (known, women) = (known + 1, women + 1),
            Ok(Gender::Male) => known += 1,
            Err(_) => *others.entry((*word).to_owned()).or_default() += 1,
        }
    }
    let share = (known > 0).then(|| f64::from(women) / genders.len() as f64);
    (share, others.into_iter().collect())
}

impl People {
    pub(super) fn read(
        folder: &Path,
        participants: &Path,
        drives: &[MeasuredDrive],
        (design, flow): (&Design, &Flow),
    ) -> Result<Self, StudyError> {
        let mut enrolled = read_enrolled(participants, design)?;
        let out = |id: &str| flow.left_out.iter().any(|l| l.who.iter().any(|who| who == id));
        enrolled.retain(|p| p.excluded.is_none() && !out(p.id.as_str()));
        let mut recorded: BTreeMap<ParticipantId, [usize; 2]> = BTreeMap::new();
        for drive in drives {
            let theirs = recorded.entry(drive.meta.participant.clone()).or_default();
            theirs[usize::from(drive.meta.driven_by == DrivenBy::Automated)] += 1;
        }
        Ok(Self {
            scores: if_there(&folder.join("scores.csv"), read_scores)?,
            score: design.style().map(|s| s.score.clone()),
            drives: recorded,
            participants: enrolled,
        })
    }

    fn members(&self, part: Part, population: Option<&str>) -> Vec<&Enrolled> {
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
        let people = self.members(part, population);
        let ages: Vec<f64> = people.iter().filter_map(|p| p.age_years).collect();
        let genders: Vec<&str> = people.iter().filter_map(|p| p.gender.as_deref()).collect();
        let (female, other_genders) = counted(&genders);
        let scored = self.style(&people);
        let drives = |by: usize| {
            let theirs = people.iter().filter_map(|p| self.drives.get(&p.id));
            theirs.map(|drives| drives[by]).sum()
        };
        ParticipantGroup {
            group: name.to_owned(),
            n: people.len(),
            drives: drives(0),
            // The car drives those who are tested.
            driven: if part == Part::Test { drives(1) } else { 0 },
            mean_age: mean(&ages),
            sd_age: sd(&ages),
            female,
            other_genders,
            mean_score: mean(&scored),
            sd_score: sd(&scored),
        }
    }

    /// The rows of the participants table: who is learned from, then who is tested, divided where the table divides them.
    pub(super) fn groups(&self) -> Vec<ParticipantGroup> {
        let mut groups = Vec::new();
        for (name, part) in [("Learned from", Part::Learn), ("Tested", Part::Test)] {
            let people = self.members(part, None);
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
        let mut results = Vec::new();
        let mut set = |key: &str, value: Option<f64>| {
            results.push((format!("participants.{key}"), value));
        };
        for (key, part, population) in [
            ("study1", Part::Learn, None),
            ("study2", Part::Test, None),
            ("study2.internal", Part::Test, Some("internal")),
            ("study2.external", Part::Test, Some("external")),
        ] {
            let group = self.group(key, part, population);
            let female_percent = group.female.map(|f| 100.0 * f);
            set(&format!("{key}.n"), Some(group.n as f64));
            set(&format!("{key}.mean_age"), group.mean_age);
            set(&format!("{key}.female_percent"), female_percent);
        }
        set("n", Some(self.participants.len() as f64));
        let professionals =
            self.members(Part::Learn, None).iter().filter(|p| p.professional).count();
        set("study1.professionals", Some(professionals as f64));
        let learned_from = self.group("study1", Part::Learn, None);
        set("study1.drives", Some(learned_from.drives as f64));
        results
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn women_are_counted_in_small_and_large_letters_and_other_words_are_named() {
        let all = ["Female", "male", "FEMALE", "f", "other", "M", "woman", "m"];
        assert_eq!(counted(&all), (Some(0.5), vec![("other".to_owned(), 1)]));
        assert_eq!(counted(&["male", "Male"]), (Some(0.0), Vec::new()));
        assert_eq!(counted(&[]), (None, Vec::new()));
    }

    #[test]
    fn words_of_which_none_is_known_are_no_share_of_0_percent() {
        let (share, others) = counted(&["weiblich", "weiblich", "divers"]);
        assert_eq!(share, None);
        let others: Vec<&str> = others.iter().map(|(word, _)| word.as_str()).collect();
        assert_eq!(others, ["divers", "weiblich"]);
    }
}
