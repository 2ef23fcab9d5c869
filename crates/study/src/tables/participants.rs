//! People as a table: demographics first, then, for made-up people, the latents behind their driving and answers.

use super::{Table, TableName, write_rows};
use crate::error::StudyError;
use maveric_domain::{ConditionId, Design, LatentTraits, ParticipantId, nearest};
use maveric_participants::{Cohort, Gender, Participant, Personality, Population};
use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// A synthetic person's row, but for the columns by which the design tells people apart.
#[derive(Serialize, Deserialize)]
struct Made {
    participant: ParticipantId,
    population: Population,
    age: u32,
    gender: Gender,
    professional: bool,
    order: String,
    synthetic: bool,
    latent_aggressiveness: f64,
    latent_spacing: f64,
    latent_pace: f64,
    latent_extraversion: f64,
    latent_agreeableness: f64,
    latent_conscientiousness: f64,
    latent_neuroticism: f64,
    latent_openness: f64,
    latent_high_velocity: f64,
}

impl Made {
    fn from_person(person: &Participant) -> Self {
        let words: Vec<&str> = person.order.iter().map(ConditionId::as_str).collect();
        let (traits, personality) = (&person.traits, &person.personality);
        Self {
            participant: person.id.clone(),
            population: person.population,
            age: person.age_years,
            gender: person.gender,
            professional: person.professional,
            order: words.join(" "),
            synthetic: true,
            latent_aggressiveness: traits.aggressiveness,
            latent_spacing: traits.spacing,
            latent_pace: traits.pace,
            latent_extraversion: personality.extraversion,
            latent_agreeableness: personality.agreeableness,
            latent_conscientiousness: personality.conscientiousness,
            latent_neuroticism: personality.neuroticism,
            latent_openness: personality.openness,
            latent_high_velocity: person.high_velocity,
        }
    }

    fn person(self, order: Vec<ConditionId>) -> Participant {
        Participant {
            id: self.participant,
            population: self.population,
            age_years: self.age,
            gender: self.gender,
            professional: self.professional,
            order,
            traits: LatentTraits {
                aggressiveness: self.latent_aggressiveness,
                spacing: self.latent_spacing,
                pace: self.latent_pace,
            },
            personality: Personality {
                extraversion: self.latent_extraversion,
                agreeableness: self.latent_agreeableness,
                conscientiousness: self.latent_conscientiousness,
                neuroticism: self.latent_neuroticism,
                openness: self.latent_openness,
            },
            high_velocity: self.latent_high_velocity,
        }
    }
}

/// Writes `participants.csv`; every `latent_` column exists only because these people are made up. The columns that tell who is
/// learned from and who is tested are the design's.
pub fn write_participants(path: &Path, cohort: &Cohort, design: &Design) -> Result<(), StudyError> {
    let parts = design.people();
    let rows = cohort.participants.iter().enumerate().map(|(at, person)| {
        let wanted = if at < cohort.learners { &parts.learn } else { &parts.test };
        let word = |column: &str| {
            let word = wanted.as_ref().and_then(|w| w.get(column));
            (column.to_owned(), word.cloned().unwrap_or_default())
        };
        let telling: Vec<(String, String)> = parts.columns().into_iter().map(word).collect();
        (Made::from_person(person), telling)
    });
    write_rows(TableName::Participants, path, rows)
}

/// Somebody who takes part, made up or real: what a report says of the sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Enrolled {
    /// Such as `S2P07`.
    pub id: ParticipantId,
    /// Whether the networks learn from their drives, by the design.
    pub learned_from: bool,
    /// Whether they sat through the conditions, by the design.
    pub tested: bool,
    /// Why the design leaves them out by name.
    pub excluded: Option<String>,
    /// Where they were recruited; `None` where it does not matter.
    pub population: Option<String>,
    /// Age in years; the middle of the band where the table has bands (`30-39`). `None` where it was not given.
    pub age_years: Option<f64>,
    /// Gender in the table's own word; `None` where it was not given.
    pub gender: Option<String>,
    /// Whether they drive for a living and demonstrated roles.
    pub professional: bool,
    /// The conditions in the order of the trials; empty where the table does not say.
    pub order: Vec<ConditionId>,
    /// Every cell of their row that is not empty, by column: factors and covariates are taken from here.
    pub cells: BTreeMap<String, String>,
}

/// Reads who takes part. Needed are the columns `participant` and those by which the design tells who is learned from and who is
/// tested; `population`, `age`, `gender`, `professional` and `order` may be missing, or empty in places.
///
/// # Errors
/// As [`Table`] does; [`StudyError::BadCell`] for a participant listed twice, an age that is neither a number nor a band such as
/// `30-39`, or a condition that is none of the design's.
pub fn read_enrolled(path: &Path, design: &Design) -> Result<Vec<Enrolled>, StudyError> {
    let table = Table::read(path)?;
    let id: Vec<ParticipantId> = table.ids("participant")?;
    let people = design.people();
    for column in people.columns().into_iter().chain(design.tested_columns()) {
        table.text(column)?;
    }
    table.one_case("participant")?;
    let telling = design.factors().iter().map(|factor| factor.name.as_str());
    for column in telling.filter(|column| table.has(column)) {
        table.one_case(column)?;
    }
    let mut columns = Vec::new();
    for name in table.columns() {
        columns.push((name.clone(), trimmed(table.text(&name)?)));
    }
    let mut seen = BTreeSet::new();
    (0..table.rows())
        .map(|i| {
            let bad = |column: &str, found: &str, expected: &str| {
                table.bad_cell(i, column, found, expected)
            };
            if !seen.insert(&id[i]) {
                return Err(bad("participant", id[i].as_str(), "each participant once"));
            }
            let mut cells: BTreeMap<String, String> = columns
                .iter()
                .filter_map(|(name, cells)| Some((name.clone(), cells[i].clone()?)))
                .collect();
            for covariate in design.covariates() {
                let column = &covariate.column;
                if let Some(cell) = cells.get_mut(column).filter(|cell| table.is_number(cell)) {
                    let number = table.number(cell);
                    *cell = number.map_err(|expected| bad(column, cell, expected))?.to_string();
                }
            }
            let cell = |name: &str| cells.get(name).map(String::as_str);
            for (column, values) in people.values() {
                let Some(found) = cell(column).filter(|found| !values.contains(found)) else {
                    continue;
                };
                // Another part is none of the study's; the same word in other capitals is meant to be.
                let meant = values.iter().find(|v| v.eq_ignore_ascii_case(found));
                if let Some(meant) = meant {
                    let expected = format!("`{meant}`, as [people] of the study's design has it");
                    return Err(bad(column, found, &expected));
                }
            }
            Ok(Enrolled {
                id: id[i].clone(),
                learned_from: people.learns_from(cell),
                tested: people.tests(cell),
                excluded: design.exclude().person(&id[i]).map(str::to_owned),
                population: cell("population").map(str::to_owned),
                age_years: match cell("age") {
                    None | Some("NA") => None,
                    Some(text) => {
                        let expected = "years from 0 to 130, or a band such as 30-39";
                        Some(years(&table, text).ok_or_else(|| bad("age", text, expected))?)
                    }
                },
                gender: cell("gender").map(str::to_owned),
                professional: match cell("professional") {
                    None | Some("false") => false,
                    Some("true") => true,
                    Some(other) => return Err(bad("professional", other, "true or false")),
                },
                order: conditions(&table, i, cell("order").unwrap_or_default(), design)?,
                cells,
            })
        })
        .collect()
}

/// Cells without blanks around them; an empty one is missing.
fn trimmed(cells: Vec<Option<String>>) -> Vec<Option<String>> {
    let trim = |cell: String| Some(cell.trim().to_owned()).filter(|c| !c.is_empty());
    cells.into_iter().map(|cell| cell.and_then(trim)).collect()
}

/// An age, or the middle of a band of ages: 30-39 are those from 30 to below 40.
fn years(table: &Table, text: &str) -> Option<f64> {
    let possible = |text: &str| table.number(text).ok().filter(|y| (0.0..=130.0).contains(y));
    match text.split_once('-') {
        None => possible(text),
        Some((low, high)) => {
            let (low, high) = (possible(low)?, possible(high)?);
            (low <= high).then_some(0.5 * (low + high + 1.0))
        }
    }
}

fn conditions(
    table: &Table,
    row: usize,
    words: &str,
    design: &Design,
) -> Result<Vec<ConditionId>, StudyError> {
    let mut order: Vec<ConditionId> = Vec::new();
    for word in words.split_whitespace() {
        let bad = |expected: String| table.bad_cell(row, "order", word, expected);
        let id = word.parse::<ConditionId>().ok();
        let Some(id) = id.filter(|id| design.condition(*id).is_some()) else {
            let ids: Vec<ConditionId> = design.condition_ids().collect();
            let meant = nearest(word, ids.iter().map(ConditionId::as_str));
            let meant = meant.map_or_else(String::new, |id| format!("; did you mean `{id}`?"));
            let ids = ConditionId::listed(&ids);
            return Err(bad(format!("conditions of the design: {ids}{meant}")));
        };
        if order.contains(&id) {
            return Err(bad("each condition once".to_owned()));
        }
        order.push(id);
    }
    Ok(order)
}

/// Reads synthetic participants back.
///
/// # Errors
/// As [`Table`] does; [`StudyError::NoColumn`] for real participants, who have no latents; [`StudyError::BadCell`] for a condition
/// that is none of the design's.
pub fn read_participants(path: &Path, design: &Design) -> Result<Vec<Participant>, StudyError> {
    let table = Table::read(path)?;
    table.each_once(&["participant"])?;
    let rows = table.records::<Made>()?.into_iter().enumerate();
    rows.map(|(row, made)| {
        let order = conditions(&table, row, &made.order, design)?;
        Ok(made.person(order))
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paper() -> Design {
        let text = maveric_data::DESIGNS_PAPER;
        Design::from_toml(text).unwrap()
    }

    fn read(text: &str) -> Result<Vec<Enrolled>, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("participants.csv");
        std::fs::write(&path, text).unwrap();
        read_enrolled(&path, &paper()).map_err(|e| e.to_string())
    }

    #[test]
    fn real_people_have_no_latents_and_may_keep_things_to_themselves() {
        let people = read("participant,study,age,gender,order,hours\nA,1,41,female,,3.5\nB,2,30-39,,mimic cautious,\nC,2,,other,,\n").unwrap();
        assert_eq!(people[0].age_years, Some(41.0));
        assert!(people[0].learned_from && !people[0].tested && people[1].tested);
        assert_eq!(people[0].cells["hours"], "3.5");
        assert_eq!((people[1].age_years, people[1].gender.as_deref()), (Some(35.0), None));
        assert_eq!(
            people[1].order,
            ["mimic", "cautious"].map(|c| c.parse::<ConditionId>().unwrap())
        );
        assert_eq!((people[2].age_years, people[2].gender.as_deref()), (None, Some("other")));
        assert_eq!(read("participant,study\nA,1\n").unwrap().len(), 1);
    }

    #[test]
    fn a_fault_in_the_list_is_named() {
        for (text, said) in [
            (
                "participant,study\nA,1\nA,2\n",
                "row 2, column `participant`: found `A`, expected each participant once",
            ),
            ("participant,study,age\nA,1,forty\n", "row 1, column `age`: found `forty`"),
            ("participant,study,age\nA,1,39-30\n", "39-30"),
            (
                "participant,study,order\nA,2,mimic mimick\n",
                "found `mimick`, expected conditions of the design: mimic, aggressive, cautious, perpendicular; did you mean `mimic`?",
            ),
            (
                "participant,study,order\nA,2,mimic cautious mimic\n",
                "row 1, column `order`: found `mimic`, expected each condition once",
            ),
            ("participant,age\nA,2\n", "no column `study`"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(said), "{error}");
        }
    }
}
