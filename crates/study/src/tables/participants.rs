//! Synthetic participants as a table: demographics first, then the latents behind their driving and answers.

use super::{Table, TableBuilder};
use crate::error::StudyError;
use maveric_domain::{Condition, LatentTraits, ParticipantId, Study};
use maveric_participants::{Gender, Participant, Personality, Population};
use std::path::Path;

/// Writes `participants.csv`; every `latent_` column exists only because these people are made up.
///
/// # Errors
/// [`StudyError::Io`], [`StudyError::BadTable`].
pub fn write_participants(path: &Path, people: &[Participant]) -> Result<(), StudyError> {
    let numbers = |of: fn(&Participant) -> f64| people.iter().map(move |p| Some(of(p)));
    let order = |p: &Participant| {
        p.order
            .iter()
            .map(|c| c.as_str())
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
            let words = order[i].clone().unwrap_or_default();
            let parse = |word: &str| {
                word.parse::<Condition>()
                    .map_err(|e| table.bad_cell(i, "order", word, e.to_string()))
            };
            Ok(Participant {
                id: id[i].clone(),
                study: study[i],
                population: population[i],
                age_years: age[i],
                gender: gender[i],
                professional: professional[i],
                order: words
                    .split_whitespace()
                    .map(parse)
                    .collect::<Result<_, _>>()?,
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
