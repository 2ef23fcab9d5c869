//! One synthetic study at the level of measures and ratings.

use crate::{
    error::RehearsalError,
    population::{CarSetting, PopulationModel},
};
use maveric_analysis::{StudyData, Tables};
use maveric_domain::{
    ConditionId, ConditionRow, Design, DriveId, DriveMeta, DrivenBy, Embedding, EmbeddingRow,
    MeasureValues, MeasuredDrive, Moment, Scale, Score,
    design::{Car, Condition},
    spread,
};
use maveric_participants::{Cohort, CohortSettings, Effects, Participant, answer_before, rate};

/// Points of the ADB score in one step of the population model.
const POINTS: f64 = 15.0;

/// Everything that a synthetic study is drawn from.
#[derive(Debug, Clone)]
pub struct World {
    /// Who is tested in which conditions.
    pub design: Design,
    /// What drives look like.
    pub population: PopulationModel,
    /// Sizes of the effects in answers and ratings.
    pub effects: Effects,
    /// The questionnaires.
    pub scales: Vec<Scale>,
    /// Points of the design's dial in one step of the population.
    pub points: f64,
}

/// A study that was never driven.
pub struct Rehearsed {
    /// Who they are.
    pub people: Vec<Participant>,
    /// What a run would have left.
    pub data: StudyData,
}

impl World {
    /// The world of a design. `points_a_point` is how many ADB points one point of the design's dial is worth.
    ///
    /// # Errors
    /// [`RehearsalError::UnknownCar`] for a condition whose drives cannot be made up: of a car that was recorded elsewhere, that the
    /// person turns, or whose style stands in a file, nobody knows what it will do.
    pub fn new(
        design: Design,
        population: PopulationModel,
        mut effects: Effects,
        scales: Vec<Scale>,
        points_a_point: f64,
    ) -> Result<Self, RehearsalError> {
        let unknown = |c: &&Condition| !matches!(c.car, Some(Car::Dial(_) | Car::Across));
        if let Some(condition) = design.conditions().iter().find(unknown) {
            return Err(RehearsalError::UnknownCar {
                condition: condition.id,
            });
        }
        // What is not asked is not answered.
        let is_asked = |id: &String| scales.iter().any(|s| s.id == *id);
        effects.ratings.retain(|id, _| is_asked(id));
        effects.answers.retain(|id, _| is_asked(id));
        Ok(Self {
            design,
            population,
            effects,
            scales,
            points: POINTS / points_a_point,
        })
    }

    /// The same world with every effect times `factor`; 0 has none at all, order and halo included.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
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
    ///
    /// # Errors
    /// [`RehearsalError`] where effects and questionnaires do not fit, or the design has no baseline.
    pub fn study(&self, n: usize, seed: u64) -> Result<Rehearsed, RehearsalError> {
        let cohort = Cohort::draw(0, n, seed, &CohortSettings::default(), &self.design)?;
        let answers = answer_before(&cohort, &self.scales, &self.effects, seed)?;
        let pre = maveric_measures::score(&self.scales, &answers, None)?.scores;
        let people = cohort.participants;
        let conditions = self.design.conditions();
        let Some(baseline) = self.design.baseline_id() else {
            return Err(RehearsalError::NoBaseline);
        };
        let mut own = Vec::with_capacity(n);
        let mut trials = Vec::with_capacity(n);
        let mut angles = Vec::with_capacity(n);
        for person in &people {
            let angle = PopulationModel::angle(person, seed);
            let settings: Vec<(&str, CarSetting)> = conditions
                .iter()
                .map(|c| (c.id.as_str(), CarSetting::of(c, angle, self.points)))
                .collect();
            let drives = self.population.drives(person, &settings, seed);
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
                    counted_s: None,
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
) -> Result<DriveMeta, RehearsalError> {
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
) -> Result<EmbeddingRow, RehearsalError> {
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
) -> Result<ConditionRow, RehearsalError> {
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
