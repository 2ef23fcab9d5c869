//! One synthetic study at the level of measures and ratings.

use super::population::{Asked, PopulationModel};
use crate::{
    error::StudyError,
    tables::{conditions::ConditionRow, embeddings::EmbeddingRow, measurements::MeasuredDrive},
};
use maveric_analysis::{StudyData, Tables};
use maveric_domain::{
    ConditionId, Design, DriveId, DriveMeta, DrivenBy, Embedding, MeasureValues, Moment, Scale,
    Score,
    design::{Car, Condition},
    spread,
};
use maveric_participants::{Cohort, CohortSettings, Effects, Participant, answer_before, rate};

/// Points of the dial in one step of the population model.
pub(crate) const POINTS: f64 = 15.0;

/// Everything that a synthetic study is drawn from.
#[derive(Debug, Clone)]
pub(crate) struct World {
    /// Who is tested in which conditions.
    pub(crate) design: Design,
    pub(crate) population: PopulationModel,
    pub(crate) effects: Effects,
    pub(crate) scales: Vec<Scale>,
}

/// A study that was never driven.
pub(crate) struct Rehearsed {
    pub(crate) people: Vec<Participant>,
    pub(crate) data: StudyData,
}

impl World {
    /// The same world with every effect times `factor`; 0 has none at all, order and halo included.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self {
            design: self.design.clone(),
            population: self.population.scaled(factor),
            effects: if factor == 0.0 {
                self.effects.without_effects()
            } else {
                self.effects.scaled(factor)
            },
            scales: self.scales.clone(),
        }
    }

    /// Draws a study of `n` people, their drives, answers and ratings.
    pub(crate) fn study(&self, n: usize, seed: u64) -> Result<Rehearsed, StudyError> {
        let cohort = Cohort::draw(0, n, seed, &CohortSettings::default(), &self.design)?;
        let answers = answer_before(&cohort, &self.scales, &self.effects, seed)?;
        let pre = maveric_measures::score(&self.scales, &answers, None)?.scores;
        let people = cohort.participants;
        let conditions = self.design.conditions();
        let Some(baseline) = self.design.baseline_id() else {
            return Err(StudyError::NotPossible {
                problem: "a rehearsal needs a design with a baseline".to_owned(),
                help: None,
            });
        };
        let mut own = Vec::with_capacity(n);
        let mut trials = Vec::with_capacity(n);
        let mut angles = Vec::with_capacity(n);
        for person in &people {
            let angle = PopulationModel::angle(person, seed);
            let asked: Vec<(&str, Asked)> = conditions
                .iter()
                .map(|c| (c.id.as_str(), Asked::of(c, angle, POINTS)))
                .collect();
            let drives = self.population.drives(person, &asked, seed);
            own.push(drives.own);
            let by_condition = conditions.iter().map(|c| c.id).zip(drives.trials);
            trials.push(by_condition.collect::<Vec<(ConditionId, MeasureValues)>>());
            angles.push(angle);
        }
        let unit = spread(&own.iter().collect::<Vec<_>>());
        let mut ratings = Vec::new();
        for (i, person) in people.iter().enumerate() {
            let rated = rate(
                person,
                &own[i],
                &trials[i],
                &unit,
                &self.scales,
                &self.effects,
                seed,
            )?;
            ratings.extend(rated.answers);
        }
        let post = maveric_measures::score(&self.scales, &ratings, None)?.scores;
        let mut tables = Tables {
            scales: self.scales.clone(),
            pre,
            post,
            ..Tables::default()
        };
        for (i, person) in people.iter().enumerate() {
            let drives = std::iter::once((baseline, &own[i]));
            for (condition, values) in drives.chain(trials[i].iter().map(|(c, v)| (*c, v))) {
                tables.measurements.push(MeasuredDrive {
                    meta: meta(person, condition, condition == baseline)?,
                    values: values.clone(),
                });
            }
            let adb = adb_of(&tables.pre, person);
            let z = adb.map_or(0.0, |a| {
                (a - self.effects.adb.mean_points) / self.effects.adb.sd_points
            });
            let (without, with) = self.population.positions(person, z, seed);
            for (adb_used, position) in [(false, without), (true, with)] {
                tables
                    .embeddings
                    .push(embedding((person, baseline), adb_used, adb, position)?);
            }
            for condition in conditions {
                tables
                    .conditions
                    .push(condition_row(person, condition, angles[i])?);
            }
        }
        Ok(Rehearsed {
            people,
            data: StudyData::new(&self.design, tables)?,
        })
    }
}

fn adb_of(pre: &[Score], person: &Participant) -> Option<f64> {
    let of = |s: &&Score| {
        s.participant == person.id
            && s.moment == Moment::Pre
            && s.scale == "adb"
            && s.subscale == "total"
    };
    pre.iter().find(of)?.value
}

fn meta(
    person: &Participant,
    condition: ConditionId,
    by_hand: bool,
) -> Result<DriveMeta, StudyError> {
    Ok(DriveMeta {
        drive: DriveId::new(format!("{}-{condition}", person.id))?,
        participant: person.id.clone(),
        condition,
        driven_by: if by_hand {
            DrivenBy::Synthetic
        } else {
            DrivenBy::Automated
        },
    })
}

fn embedding(
    (person, baseline): (&Participant, ConditionId),
    adb_used: bool,
    adb: Option<f64>,
    position: f64,
) -> Result<EmbeddingRow, StudyError> {
    Ok(EmbeddingRow {
        drive: DriveId::new(format!("{}-{baseline}", person.id))?,
        participant: person.id.clone(),
        condition: baseline,
        adb_used,
        adb,
        adb_hat: None,
        line_position: Some(position),
        readings: None,
        covariance: None,
        line_position_se: None,
        embedding: Embedding::new(vec![position])?,
    })
}

fn condition_row(
    person: &Participant,
    condition: &Condition,
    angle: f64,
) -> Result<ConditionRow, StudyError> {
    Ok(ConditionRow {
        participant: person.id.clone(),
        condition: condition.id,
        adb_hat: None,
        moved_points: condition.dial().or(Some(0.0)),
        moved_points_sd: None,
        clamped: false,
        angle_rad: (condition.car == Some(Car::Across)).then_some(angle),
        beyond_training: false,
        sweep: None,
        embedding: Embedding::new(vec![0.0])?,
    })
}
