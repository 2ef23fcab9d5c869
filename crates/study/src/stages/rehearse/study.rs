//! One synthetic study at the level of measures and ratings.

use super::population::{Asked, PopulationModel};
use crate::{
    design::DesignFile,
    error::StudyError,
    tables::{conditions::ConditionRow, embeddings::EmbeddingRow, measurements::MeasuredDrive},
};
use maveric_analysis::{StudyData, Tables};
use maveric_domain::{
    ConditionId, DriveId, DriveMeta, DrivenBy, Embedding, MeasureValues, Moment, Scale, Score,
    spread,
};
use maveric_participants::{Cohort, CohortSettings, Effects, Participant, answer_before, rate};

/// How far Aggressive and Cautious are from Mimic, in ADB points.
pub(crate) const POINTS: f64 = 15.0;

/// Everything that a synthetic study is drawn from.
#[derive(Debug, Clone)]
pub(crate) struct World {
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
        let cohort = Cohort::draw(
            0,
            n,
            seed,
            &CohortSettings::default(),
            &DesignFile::paper()?.design,
        )?;
        let answers = answer_before(&cohort, &self.scales, &self.effects, seed)?;
        let pre = maveric_measures::score(&self.scales, &answers, None)?.scores;
        let people = cohort.participants;
        let mut own = Vec::with_capacity(n);
        let mut trials = Vec::with_capacity(n);
        let mut angles = Vec::with_capacity(n);
        for person in &people {
            let angle = PopulationModel::angle(person, seed);
            let asked = ConditionId::AV
                .each_ref()
                .map(|c| (c.as_str(), Asked::of(*c, angle)));
            let drives = self.population.drives(person, &asked, seed);
            own.push(drives.own);
            let by_condition = ConditionId::AV.into_iter().zip(drives.trials);
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
            tested: people.iter().map(|p| p.id.clone()).collect(),
            pre,
            post,
            ..Tables::default()
        };
        for (i, person) in people.iter().enumerate() {
            let drives = std::iter::once((ConditionId::OWN, &own[i]));
            for (condition, values) in drives.chain(trials[i].iter().map(|(c, v)| (*c, v))) {
                tables.measurements.push(MeasuredDrive {
                    meta: meta(person, condition)?,
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
                    .push(embedding(person, adb_used, adb, position)?);
            }
            for condition in ConditionId::AV {
                tables
                    .conditions
                    .push(condition_row(person, condition, angles[i])?);
            }
        }
        Ok(Rehearsed {
            people,
            data: StudyData::new(tables)?,
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

fn meta(person: &Participant, condition: ConditionId) -> Result<DriveMeta, StudyError> {
    Ok(DriveMeta {
        drive: DriveId::new(format!("{}-{condition}", person.id))?,
        participant: person.id.clone(),
        condition,
        driven_by: if condition == ConditionId::OWN {
            DrivenBy::Synthetic
        } else {
            DrivenBy::Automated
        },
    })
}

fn embedding(
    person: &Participant,
    adb_used: bool,
    adb: Option<f64>,
    position: f64,
) -> Result<EmbeddingRow, StudyError> {
    Ok(EmbeddingRow {
        drive: DriveId::new(format!("{}-own", person.id))?,
        participant: person.id.clone(),
        condition: ConditionId::OWN,
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
    condition: ConditionId,
    angle: f64,
) -> Result<ConditionRow, StudyError> {
    Ok(ConditionRow {
        participant: person.id.clone(),
        condition,
        adb_hat: 0.0,
        moved_points: match condition {
            ConditionId::AGGRESSIVE => POINTS,
            ConditionId::CAUTIOUS => -POINTS,
            _ => 0.0,
        },
        moved_points_sd: None,
        clamped: false,
        angle_rad: (condition == ConditionId::PERPENDICULAR).then_some(angle),
        beyond_training: false,
        sweep: None,
        embedding: Embedding::new(vec![0.0])?,
    })
}
