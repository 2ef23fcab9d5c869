//! `rate`: synthetic participants rate what each condition did.

use crate::{
    design::DesignFile,
    error::StudyError,
    once::count,
    outcome::{Outcome, Watch},
    run_folder::{read_effects_on, read_scales},
    stage::{Files, Stage},
    tables::{
        measurements::{MeasuredDrive, one_drive_a_condition, read_measurements},
        participants::read_participants,
        surveys::write_answers,
    },
};
use maveric_domain::{
    ConditionId, MeasureValues, Moment, Ride, Scale, design::Probe, occasion::is_first, spread,
};
use maveric_measures::survey::ProbeAnswer;
use maveric_participants::{answer_at_random, probes_at_random};
use path_slash::PathExt as _;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Let the synthetic participants rate what each condition did
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example: maveric rate --measures measurements.parquet --participants participants.csv --out ratings.csv"
)]
pub struct Rate {
    /// Design of the study (TOML); study.toml of the folder one stands in when not given, else the paper's
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// Measurements of own and AV drives
    #[arg(long)]
    pub measures: PathBuf,
    /// The synthetic participants
    #[arg(long)]
    pub participants: PathBuf,
    /// Sizes of the effects (TOML)
    #[arg(long, default_value = "study_data/effects.toml")]
    pub effects: PathBuf,
    /// Folder of questionnaire definitions
    #[arg(long, default_value = "study_data/scales")]
    pub scales: PathBuf,
    /// Answers to write
    #[arg(long)]
    pub out: PathBuf,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
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

impl Stage for Rate {
    const NAME: &'static str = "rate";
    const FAILURE: &'static str = "could not rate";
    type Result = Ratings;

    fn files(&self, _root: &Path) -> Result<Files, StudyError> {
        Ok(Files::default()
            .reads([
                &self.measures,
                &self.participants,
                &self.effects,
                &self.scales,
            ])
            .reads_design(self.design.as_deref())
            .writes([&self.out]))
    }

    /// Lets each synthetic participant who is tested rate the conditions that they sat through and that the car drove; a condition
    /// that was recorded elsewhere has no made-up ratings.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Ratings>, StudyError> {
        let drives = read_measurements(&self.measures)?;
        one_drive_a_condition(&self.measures, &drives)?;
        let study = DesignFile::find(self.design.as_deref())?;
        let design = &study.design;
        let tested = study.people(Some(&self.participants))?.tested();
        let people = read_participants(&self.participants, design)?;
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
        let scales = read_scales(&self.scales)?;
        let effects = read_effects_on(&self.effects, &scales)?;
        let without_effects = |scale: &&Scale| {
            design.protocol().after.contains(&scale.id) && !effects.ratings.contains_key(&scale.id)
        };
        // What a ride is held against is how the person drove first.
        let own = |d: &&MeasuredDrive| d.meta.condition == baseline && is_first(&d.meta.session);
        let by_hand: Vec<&MeasureValues> = drives.iter().filter(own).map(|d| &d.values).collect();
        let spread = spread(&by_hand);
        let probe = design.protocol().probe.as_ref();
        let probe = probe.map(|probe| {
            let scale = scales.iter().find(|scale| scale.id == probe.scale);
            let no_scale = || {
                study.wrong(
                    format!(
                        "`protocol.probe.scale`: `{}`, and no scale has that id",
                        probe.scale
                    ),
                    Some("write it into the folder of --scales".to_owned()),
                )
            };
            Ok::<_, StudyError>((scale.ok_or_else(no_scale)?, probe.every_s))
        });
        let probe = probe.transpose()?;
        let mut probes = Vec::new();
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
            let trial = |ride: &Ride| {
                mine.iter()
                    .find(|d| d.meta.ride() == *ride)
                    .map(|d| (*ride, d.values.clone()))
            };
            let order = person.order.iter().filter(|c| driven.contains(c));
            let mut asked: Vec<Ride> = order
                .flat_map(|&condition| {
                    let occasions = design.occasions(condition).into_iter();
                    occasions.map(move |occasion| Ride {
                        condition,
                        occasion,
                    })
                })
                .collect();
            // Each session and each round of rides in the person's order.
            asked.sort_by_key(|ride| ride.occasion);
            if let Some((scale, every_s)) = probe {
                let ridden = mine.iter().filter(|d| asked.contains(&d.meta.ride()));
                for ridden in ridden {
                    // Made-up rides are as long as the design says that a ride is.
                    let length_s = ridden.counted_s.unwrap_or(design.protocol().ride_s);
                    let (who, missing) = (&person.id, effects.missing_rate);
                    let asked = Probe::asked_s(every_s, length_s);
                    let ride = ridden.meta.ride();
                    let given = probes_at_random(who, ride, scale, asked, missing, self.seed);
                    probes.extend(given.into_iter().map(|(at_s, answer)| ProbeAnswer {
                        participant: who.clone(),
                        ride,
                        scale: scale.id.clone(),
                        at_s,
                        answer,
                    }));
                }
            }
            let trials: Vec<(Ride, MeasureValues)> = asked.iter().filter_map(trial).collect();
            if trials.len() < asked.len() {
                let missing = asked.len() - trials.len();
                let what = if design.repeats() {
                    ["ride was", "rides were"]
                } else {
                    ["condition was", "conditions were"]
                };
                warnings.push(format!(
                    "participant {}: {} not driven, so not rated",
                    person.id,
                    count(missing, what[0], what[1])
                ));
            }
            let rated = maveric_participants::rate(
                person,
                &own_drive.values,
                &trials,
                &spread,
                &scales,
                &effects,
                self.seed,
            )?;
            warnings.extend(rated.warnings.iter().map(ToString::to_string));
            answers.extend(rated.answers);
            for (ride, _) in &trials {
                let scales = scales.iter().filter(without_effects);
                let (moment, rate) = (Moment::After(*ride), effects.missing_rate);
                answers.extend(answer_at_random(
                    &person.id, moment, scales, rate, self.seed,
                ));
            }
            raters += 1;
        }
        if raters == 0 {
            return Err(StudyError::NotPossible {
            problem: format!(
                "no participant of {} has an own drive in {}",
                self.participants.to_slash_lossy(),
                self.measures.to_slash_lossy()
            ),
            help: Some(
                "measure the drives of the same study: --drives drives/study2 --drives av/drives"
                    .to_owned(),
            ),
        });
        }
        write_answers(&self.out, &answers, &probes)?;
        let summary = vec![format!(
            "{raters} synthetic participants rated their conditions: {}",
            self.out.to_slash_lossy()
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
}
