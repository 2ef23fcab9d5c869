//! One model a person, learned from everybody else.

use crate::{
    error::StudyError,
    outcome::{Watch, for_each_on},
    stages::validate::examine::with_covariance,
};
use maveric_domain::{ConditionId, Drive, ParticipantId, ScoreRange, StyleScore};
use maveric_model::{
    HeadsKind, Model, ModelError, Personalized, TrainSettings, TrainingDrive, personalize,
    score_line, style_space::LinearHead, train,
};
use maveric_rehearsal::leave_out::{Drove, Line, Styles, people};
use std::ops::ControlFlow;

/// Drives, and by what each person's model is learned from those of the others.
pub(super) struct Learning<'a> {
    pub(super) drives: Vec<&'a Drive>,
    /// The same as they were told and measured.
    pub(super) drove: Vec<Drove>,
    /// The labels of the drives that are learned from.
    pub(super) learn: &'a [ConditionId],
    pub(super) settings: &'a TrainSettings,
    /// The scale of the points.
    pub(super) range: ScoreRange,
    pub(super) seed: u64,
    pub(super) jobs: usize,
    pub(super) watch: Watch<'a>,
}

/// One person's model, which has not met them, and every drive as it reads it without a score.
pub(super) struct Fold {
    pub(super) person: ParticipantId,
    pub(super) model: Model,
    /// In the order of the drives; none where a drive shows nothing.
    pub(super) fitted: Vec<Option<Personalized>>,
}

impl Learning<'_> {
    fn teaches(&self, drive: usize, but: &ParticipantId) -> bool {
        let meta = self.drives[drive].meta();
        meta.participant != *but && self.learn.contains(&meta.condition)
    }

    /// Learns all models with these points of the drives.
    pub(super) fn folds(&self, points: &[Option<f64>]) -> Result<Vec<Fold>, StudyError> {
        let everybody = people(&self.drove);
        let scores: Vec<Option<StyleScore>> = points
            .iter()
            .map(|p| p.map(|p| self.range.score(p)).transpose())
            .collect::<Result<_, _>>()?;
        let one = |person: &ParticipantId| {
            let teaching = (0..self.drives.len()).filter(|&i| self.teaches(i, person));
            let given: Vec<TrainingDrive<'_>> =
                teaching.map(|i| TrainingDrive { drive: self.drives[i], adb: scores[i] }).collect();
            let mut observe = |_: &_| match self.watch.check() {
                Ok(()) => ControlFlow::Continue(()),
                Err(_) => ControlFlow::Break(()),
            };
            let model = match train(&given, self.settings, self.seed, &mut observe) {
                Err(ModelError::Cancelled { .. }) => return Err(StudyError::Interrupted),
                other => other?.model,
            };
            let drives = self.drives.iter();
            let fitted = drives.map(|drive| read_alone(&model, drive));
            let fitted = fitted.collect::<Result<_, _>>()?;
            Ok(Fold { person: person.clone(), model, fitted })
        };
        for_each_on(self.jobs, &everybody, self.watch, "models", one)
    }

    /// The line of each model with these points of the drives. Linear heads do not see the score, so only the line is learned again
    /// and the styles stay, exactly; networks learn all of it again.
    pub(super) fn lines(
        &self,
        folds: &[Fold],
        points: &[Option<f64>],
    ) -> Result<Vec<Option<Line>>, StudyError> {
        if self.settings.heads == HeadsKind::Linear {
            return folds.iter().map(|fold| self.line_again(fold, points)).collect();
        }
        let same = self.drove.iter().map(|d| d.points).eq(points.iter().copied());
        let learned = if same { None } else { Some(self.folds(points)?) };
        let folds = learned.as_deref().unwrap_or(folds);
        folds.iter().map(line_of_model).collect()
    }

    fn line_again(&self, fold: &Fold, points: &[Option<f64>]) -> Result<Option<Line>, StudyError> {
        let (mut styles, mut scores): (Vec<&[f64]>, Vec<f64>) = (Vec::new(), Vec::new());
        for (drive, known) in fold.fitted.iter().enumerate() {
            let teaches = self.teaches(drive, &fold.person);
            if let (true, Some(known), Some(points)) = (teaches, known, points[drive]) {
                styles.push(known.embedding.coordinates());
                scores.push(points);
            }
        }
        let Some((gradient, offset)) = score_line(&styles, &scores)? else {
            return Ok(None);
        };
        let length = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
        if length < 1e-9 {
            return Ok(None);
        }
        let along = |w: &[f64]| gradient.iter().zip(w).map(|(g, w)| g * w).sum::<f64>();
        let each = |value: &dyn Fn(&Personalized) -> Option<f64>| -> Vec<Option<f64>> {
            fold.fitted.iter().map(|k| value(k.as_ref()?)).collect()
        };
        Ok(Some(Line {
            position: each(&|k| Some(along(k.embedding.coordinates()) / length)),
            se: each(&|k| k.sd_along(&gradient)),
            score: each(&|k| Some(offset + along(k.embedding.coordinates()))),
        }))
    }
}

fn line_of_model(fold: &Fold) -> Result<Option<Line>, StudyError> {
    let Ok(axis) = LinearHead::aggression(&fold.model) else {
        return Ok(None);
    };
    let direction = axis.direction();
    let mut line = Line::default();
    for known in &fold.fitted {
        let reading = |value: fn(&LinearHead, &Personalized) -> Result<f64, ModelError>| {
            known.as_ref().map(|k| value(&axis, k)).transpose()
        };
        line.position.push(reading(|axis, k| axis.position(&k.embedding))?);
        line.score.push(reading(|axis, k| axis.read(&k.embedding))?);
        line.se.push(known.as_ref().and_then(|k| k.sd_along(&direction)));
    }
    Ok(Some(line))
}

/// A drive as a model reads it without a score; none where it shows nothing.
pub(super) fn read_alone(model: &Model, drive: &Drive) -> Result<Option<Personalized>, ModelError> {
    match personalize(model, drive, None) {
        Ok(known) => Ok((known.readings > 0).then_some(known)),
        Err(ModelError::DriveTooShort { .. }) => Ok(None),
        Err(other) => Err(other),
    }
}

/// The place of somebody's first drive in a role.
pub(super) fn first_in(drove: &[Drove], who: &ParticipantId, role: ConditionId) -> Option<usize> {
    let theirs = |d: &Drove| d.participant == *who && d.role == role;
    drove.iter().position(theirs)
}

/// The styles of each model with their covariances; none where a drive shows nothing or leaves no covariance.
pub(super) fn styles(folds: &[Fold]) -> Vec<Styles> {
    let fold_styles = |fold: &Fold| {
        let fitted = fold.fitted.iter();
        fitted.map(|k| with_covariance(k.as_ref()?)).collect()
    };
    folds.iter().map(fold_styles).collect()
}
