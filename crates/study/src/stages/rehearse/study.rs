//! One synthetic study at the level of measures and ratings.

use super::population::{Asked, PopulationModel};
use crate::{
    design::DesignFile,
    error::StudyError,
    stages::{
        rate::{effects_of, read_effects},
        score::read_scales,
    },
    style_scale::StyleScale,
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
use std::path::Path;

/// Points of the ADB score in one step of the population model.
const POINTS: f64 = 15.0;

/// Everything that a synthetic study is drawn from.
#[derive(Debug, Clone)]
pub(crate) struct World {
    /// Who is tested in which conditions.
    pub(crate) design: Design,
    pub(crate) population: PopulationModel,
    pub(crate) effects: Effects,
    pub(crate) scales: Vec<Scale>,
    /// Points of the design's dial in one step of the population.
    pub(crate) points: f64,
}

/// Sizes of the effects, as shipped.
const EFFECTS: &str = include_str!("../../../../../study_data/effects.toml");

/// A study that was never driven.
pub(crate) struct Rehearsed {
    pub(crate) people: Vec<Participant>,
    pub(crate) data: StudyData,
}

impl World {
    /// The world of a design; population, effects and questionnaires are those given, else the design's, else as shipped.
    ///
    /// # Errors
    /// [`StudyError`] if a file cannot be read, or the design has a condition whose drives cannot be made up: of a car that was recorded
    /// elsewhere, that the person turns, or whose style stands in a file, nobody knows what it will do.
    pub(crate) fn of(
        study: &DesignFile,
        [population, effects, scales]: [Option<&Path>; 3],
    ) -> Result<Self, StudyError> {
        let unknown = |c: &&Condition| !matches!(c.car, Some(Car::Dial(_) | Car::Across));
        if let Some(condition) = study.design.conditions().iter().find(unknown) {
            return Err(study.wrong(
                format!(
                    "`condition.{}.car`: what this car will do cannot be made up, expected {{ dial = POINTS }} or {{ across = true }} to rehearse",
                    condition.id
                ),
                Some("maveric stats power gives the power of a test for an effect that you assume".to_owned()),
            ));
        }
        let files = study.design.files();
        let own = || files.effects.as_ref().map(|path| study.resolve(path));
        let effects = match effects
            .map(Path::to_owned)
            .or_else(own)
            .filter(|p| p.is_file())
        {
            Some(path) => read_effects(&path)?,
            None => effects_of(Path::new("effects.toml"), EFFECTS)?,
        };
        let own = study.resolve(&files.scales);
        let scales = read_scales(scales.unwrap_or(&own))?;
        let mut world = Self {
            population: match population {
                Some(path) => PopulationModel::read(path)?,
                None => PopulationModel::shipped()?,
            },
            points: POINTS / StyleScale::of(study)?.stretch(),
            design: study.design.clone(),
            effects,
            scales,
        };
        // What is not asked is not answered.
        let asked = |id: &String| world.scales.iter().any(|s| s.id == *id);
        world.effects.ratings.retain(|id, _| asked(id));
        world.effects.answers.retain(|id, _| asked(id));
        Ok(world)
    }

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
            points: self.points,
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
                .map(|c| (c.id.as_str(), Asked::of(c, angle, self.points)))
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
