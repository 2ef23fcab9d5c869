//! Synthetic participants as a table: demographics first, then the latents behind their driving and answers.

use super::{Table, TableBuilder};
use crate::error::StudyError;
use maveric_domain::{ConditionId, LatentTraits, ParticipantId, Study};
use maveric_participants::{Gender, Participant, Personality, Population};
use std::{collections::BTreeSet, path::Path};

/// Writes `participants.csv`; every `latent_` column exists only because these people are made up.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::BadTable`].
pub fn write_participants(path: &Path, people: &[Participant]) -> Result<(), StudyError> {
    let numbers = |of: fn(&Participant) -> f64| people.iter().map(move |p| Some(of(p)));
    let order = |p: &Participant| {
        p.order
            .iter()
            .map(ConditionId::as_str)
            .collect::<Vec<_>>()
            .join(" ")
    };
    TableBuilder::default()
        .text("participant", people.iter().map(|p| p.id.as_str()))
        .text("study", people.iter().map(|p| p.study.as_str()))
        .text("population", people.iter().map(|p| p.population.as_str()))
        .integers("age", people.iter().map(|p| Some(i64::from(p.age_years))))
        .text("gender", people.iter().map(|p| p.gender.as_str()))
        .flags("professional", people.iter().map(|p| p.professional))
        .text("order", people.iter().map(order))
        .flags("synthetic", people.iter().map(|_| true))
        .numbers(
            "latent_aggressiveness",
            numbers(|p| p.traits.aggressiveness),
        )
        .numbers("latent_spacing", numbers(|p| p.traits.spacing))
        .numbers("latent_pace", numbers(|p| p.traits.pace))
        .numbers(
            "latent_extraversion",
            numbers(|p| p.personality.extraversion),
        )
        .numbers(
            "latent_agreeableness",
            numbers(|p| p.personality.agreeableness),
        )
        .numbers(
            "latent_conscientiousness",
            numbers(|p| p.personality.conscientiousness),
        )
        .numbers("latent_neuroticism", numbers(|p| p.personality.neuroticism))
        .numbers("latent_openness", numbers(|p| p.personality.openness))
        .numbers("latent_high_velocity", numbers(|p| p.high_velocity))
        .write(path)
}

/// Somebody who takes part, made up or real: what a report says of the sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Enrolled {
    /// Such as `S2P07`.
    pub id: ParticipantId,
    /// Which study.
    pub study: Study,
    /// Where they were recruited; `None` where it does not matter.
    pub population: Option<Population>,
    /// Age in years; the middle of the band where the table has bands (`30-39`). `None` where it was not given.
    pub age_years: Option<f64>,
    /// Gender in the table's own word; `None` where it was not given.
    pub gender: Option<String>,
    /// Whether they drive for a living and demonstrated roles.
    pub professional: bool,
    /// The AV conditions in the order of the trials; empty where the table does not say.
    pub order: Vec<ConditionId>,
}

/// Reads who takes part. Needed are the columns `participant` and `study`; `population`, `age`, `gender`, `professional` and
/// `order` may be missing, or empty in places.
///
/// # Errors
/// As [`Table`] does; [`StudyError::BadCell`] for a participant listed twice, an age that is neither a number nor a band such as
/// `30-39`, or a word that is none of the study's.
pub fn read_enrolled(path: &Path) -> Result<Vec<Enrolled>, StudyError> {
    let table = Table::read(path)?;
    let id: Vec<ParticipantId> = table.ids("participant")?;
    let study: Vec<Study> = table.parsed("study")?;
    let optional = |name: &str| {
        if table.has(name) {
            table.text(name)
        } else {
            Ok(vec![None; table.rows()])
        }
    };
    let (population, age, gender) = (
        optional("population")?,
        optional("age")?,
        optional("gender")?,
    );
    let (professional, order) = (optional("professional")?, optional("order")?);
    let mut seen = BTreeSet::new();
    (0..table.rows())
        .map(|i| {
            if !seen.insert(&id[i]) {
                return Err(table.bad_cell(
                    i,
                    "participant",
                    id[i].as_str(),
                    "each participant once",
                ));
            }
            let cell = |cells: &[Option<String>]| {
                cells[i]
                    .as_deref()
                    .map(str::trim)
                    .unwrap_or_default()
                    .to_owned()
            };
            let bad =
                |column, found: &str, expected: String| table.bad_cell(i, column, found, expected);
            let (population, age, professional) =
                (cell(&population), cell(&age), cell(&professional));
            Ok(Enrolled {
                id: id[i].clone(),
                study: study[i],
                population: match population.as_str() {
                    "" => None,
                    word => Some(word.parse().map_err(|e: maveric_domain::DomainError| {
                        bad("population", word, e.to_string())
                    })?),
                },
                age_years: match age.as_str() {
                    "" | "NA" => None,
                    text => Some(years(text).ok_or_else(|| {
                        bad(
                            "age",
                            text,
                            "years from 0 to 130, or a band such as 30-39".to_owned(),
                        )
                    })?),
                },
                gender: Some(cell(&gender)).filter(|g| !g.is_empty()),
                professional: match professional.as_str() {
                    "" | "false" => false,
                    "true" => true,
                    other => return Err(bad("professional", other, "true or false".to_owned())),
                },
                order: conditions(&table, i, &cell(&order))?,
            })
        })
        .collect()
}

/// An age, or the middle of a band of ages: 30-39 are those from 30 to below 40.
fn years(text: &str) -> Option<f64> {
    let possible = |text: &str| {
        text.trim()
            .parse::<f64>()
            .ok()
            .filter(|y| (0.0..=130.0).contains(y))
    };
    match text.split_once('-') {
        None => possible(text),
        Some((low, high)) => {
            let (low, high) = (possible(low)?, possible(high)?);
            (low <= high).then_some(0.5 * (low + high + 1.0))
        }
    }
}

fn conditions(table: &Table, row: usize, words: &str) -> Result<Vec<ConditionId>, StudyError> {
    let parse = |word: &str| {
        let condition = word.parse::<ConditionId>();
        condition.map_err(|e| table.bad_cell(row, "order", word, e.to_string()))
    };
    words.split_whitespace().map(parse).collect()
}

/// Reads synthetic participants back.
///
/// # Errors
/// As [`Table`] does; [`StudyError::NoColumn`] for real participants, who have no latents.
pub fn read_participants(path: &Path) -> Result<Vec<Participant>, StudyError> {
    let table = Table::read(path)?;
    let id: Vec<ParticipantId> = table.ids("participant")?;
    let study: Vec<Study> = table.parsed("study")?;
    let population: Vec<Population> = table.parsed("population")?;
    let age: Vec<u32> = table.parsed("age")?;
    let gender: Vec<Gender> = table.parsed("gender")?;
    let professional: Vec<bool> = table.parsed("professional")?;
    let order = table.text("order")?;
    let latent = |name: &str| table.all_numbers(&format!("latent_{name}"));
    let (aggressiveness, spacing, pace) = (
        latent("aggressiveness")?,
        latent("spacing")?,
        latent("pace")?,
    );
    let (extraversion, agreeableness) = (latent("extraversion")?, latent("agreeableness")?);
    let (conscientiousness, neuroticism) = (latent("conscientiousness")?, latent("neuroticism")?);
    let (openness, high_velocity) = (latent("openness")?, latent("high_velocity")?);
    (0..table.rows())
        .map(|i| {
            Ok(Participant {
                id: id[i].clone(),
                study: study[i],
                population: population[i],
                age_years: age[i],
                gender: gender[i],
                professional: professional[i],
                order: conditions(&table, i, order[i].as_deref().unwrap_or_default())?,
                traits: LatentTraits {
                    aggressiveness: aggressiveness[i],
                    spacing: spacing[i],
                    pace: pace[i],
                },
                personality: Personality {
                    extraversion: extraversion[i],
                    agreeableness: agreeableness[i],
                    conscientiousness: conscientiousness[i],
                    neuroticism: neuroticism[i],
                    openness: openness[i],
                },
                high_velocity: high_velocity[i],
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<Enrolled>, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("participants.csv");
        std::fs::write(&path, text).unwrap();
        read_enrolled(&path).map_err(|e| e.to_string())
    }

    #[test]
    fn real_people_have_no_latents_and_may_keep_things_to_themselves() {
        let people = read("participant,study,age,gender,order\nA,1,41,female,\nB,2,30-39,,mimic cautious\nC,2,,other,\n").unwrap();
        assert_eq!(people[0].age_years, Some(41.0));
        assert_eq!(
            (people[1].age_years, people[1].gender.as_deref()),
            (Some(35.0), None)
        );
        assert_eq!(people[1].order, [ConditionId::MIMIC, ConditionId::CAUTIOUS]);
        assert_eq!(
            (people[2].age_years, people[2].gender.as_deref()),
            (None, Some("other"))
        );
        assert_eq!(read("participant,study\nA,1\n").unwrap().len(), 1);
    }

    #[test]
    fn a_fault_in_the_list_is_named() {
        for (text, said) in [
            (
                "participant,study\nA,1\nA,2\n",
                "row 2, column `participant`: found `A`, expected each participant once",
            ),
            (
                "participant,study,age\nA,1,forty\n",
                "row 1, column `age`: found `forty`",
            ),
            ("participant,study,age\nA,1,39-30\n", "39-30"),
            ("participant,study,order\nA,2,mimic mimick\n", "mimick"),
            (
                "participant,study,population\nA,2,public\n",
                "internal, external",
            ),
            ("participant,age\nA,2\n", "no column `study`"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(said), "{error}");
        }
    }
}
