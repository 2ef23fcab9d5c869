//! `rate`: synthetic participants rate what each condition did.

use crate::{
    design::DesignFile,
    error::StudyError,
    once::count,
    outcome::{Outcome, Watch},
    outputs::spare_inputs,
    run_folder::{read_effects_on, read_scales},
    tables::{
        measurements::{MeasuredDrive, one_drive_a_condition, read_measurements},
        participants::read_participants,
        surveys::write_answers,
    },
};
use maveric_domain::{ConditionId, MeasureValues, spread};
use path_slash::PathExt as _;
use serde::Serialize;
use std::path::PathBuf;

/// What to rate.
#[derive(Debug, Clone)]
pub struct RateOptions {
    /// The study's design; `study.toml` of the folder one stands in without, else the paper's.
    pub design: Option<PathBuf>,
    /// Measurements of own and AV drives.
    pub measures: PathBuf,
    /// The synthetic participants.
    pub participants: PathBuf,
    /// Sizes of the effects.
    pub effects: PathBuf,
    /// Folder of questionnaire definitions.
    pub scales: PathBuf,
    /// Answers to write.
    pub out: PathBuf,
    /// Root of every random choice.
    pub seed: u64,
}

/// What was rated.
#[derive(Debug, Clone, Serialize)]
pub struct Ratings {
    /// Participants who rated.
    pub participants: usize,
    /// Their answers.
    pub answers: usize,
}

/// Lets each synthetic participant who is tested rate the conditions that they sat through and that the car drove; a condition
/// that was recorded elsewhere has no made-up ratings.
///
/// # Errors
/// [`StudyError`] if a table cannot be read, and for participants without an own drive.
pub fn rate(options: &RateOptions, watch: Watch<'_>) -> Result<Outcome<Ratings>, StudyError> {
    let inputs = [
        &*options.measures,
        &options.participants,
        &options.effects,
        &options.scales,
    ];
    spare_inputs(
        inputs.into_iter().chain(options.design.as_deref()),
        [&*options.out],
    )?;
    let drives = read_measurements(&options.measures)?;
    one_drive_a_condition(&options.measures, &drives)?;
    let study = DesignFile::find(options.design.as_deref())?;
    let design = &study.design;
    let tested = study.people(Some(&options.participants))?.tested();
    let people = read_participants(&options.participants, design)?;
    let Some(baseline) = design.baseline_id() else {
        return Err(study.wrong(
            "`baseline`: found none, expected a drive by hand that people compare the car with",
            Some("add [baseline] with the id of that drive, such as id = \"own\"".to_owned()),
        ));
    };
    let driven: Vec<ConditionId> = design
        .conditions()
        .iter()
        .filter(|c| c.simulated())
        .map(|c| c.id)
        .collect();
    let scales = read_scales(&options.scales)?;
    let effects = read_effects_on(&options.effects, &scales)?;
    let own = |d: &&MeasuredDrive| d.meta.condition == baseline;
    let by_hand: Vec<&MeasureValues> = drives.iter().filter(own).map(|d| &d.values).collect();
    let spread = spread(&by_hand);
    let mut answers = Vec::new();
    let mut warnings = Vec::new();
    let mut raters = 0;
    for person in people.iter().filter(|p| tested.contains(&p.id)) {
        watch.check()?;
        let mine: Vec<&MeasuredDrive> = drives
            .iter()
            .filter(|d| d.meta.participant == person.id)
            .collect();
        let Some(own_drive) = mine.iter().copied().find(|d| own(d)) else {
            warnings.push(format!(
                "participant {}: no own drive, so no ratings",
                person.id
            ));
            continue;
        };
        let trial = |c: &ConditionId| {
            mine.iter()
                .find(|d| d.meta.condition == *c)
                .map(|d| (*c, d.values.clone()))
        };
        let mut asked = person.order.clone();
        asked.retain(|c| driven.contains(c));
        let trials: Vec<(ConditionId, MeasureValues)> = asked.iter().filter_map(trial).collect();
        if trials.len() < asked.len() {
            let missing = asked.len() - trials.len();
            warnings.push(format!(
                "participant {}: {} not driven, so not rated",
                person.id,
                count(missing, "condition was", "conditions were")
            ));
        }
        let rated = maveric_participants::rate(
            person,
            &own_drive.values,
            &trials,
            &spread,
            &scales,
            &effects,
            options.seed,
        )?;
        warnings.extend(rated.warnings.iter().map(ToString::to_string));
        answers.extend(rated.answers);
        raters += 1;
    }
    if raters == 0 {
        return Err(StudyError::NotPossible {
            problem: format!(
                "no participant of {} has an own drive in {}",
                options.participants.to_slash_lossy(),
                options.measures.to_slash_lossy()
            ),
            help: Some(
                "measure the drives of the same study: --drives drives/study2 --drives av/drives"
                    .to_owned(),
            ),
        });
    }
    write_answers(&options.out, &answers)?;
    let summary = vec![format!(
        "{raters} synthetic participants rated their conditions: {}",
        options.out.to_slash_lossy()
    )];
    Ok(Outcome {
        value: Ratings {
            participants: raters,
            answers: answers.len(),
        },
        summary,
        warnings,
    })
}
