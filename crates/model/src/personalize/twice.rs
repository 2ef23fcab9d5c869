//! A model that knows how far one person's drives differ, from people who drove twice.

use super::{Personalizer, Shown};
use crate::{
    days::{Days, Pair},
    epochs::TrainingDrive,
    error::ModelError,
    heads::{Posterior, ScoredStyle, StyleHead},
    model::{Heads, Model, ModelParts},
    on_range::points_on,
};
use maveric_domain::{Drive, Embedding};

/// The model with standard errors that are of the person and not of the drive alone.
///
/// `twice` holds two drives each of people who drove as themselves on two days; heads and networks do not learn from them. `training` are
/// the drives that the model was trained on, of which this first share was used, with their scores: linear heads read the score from
/// the person's style, which a drive tells less well than its own. With fewer people than numbers of a style, the model stays as it is.
///
/// # Errors
/// [`ModelError::BadSetting`] for a share that is not above 0, up to 1; [`ModelError::DriveTooShort`] and
/// [`ModelError::OtherScale`] as [`Personalizer::fit`].
pub fn learn_days(
    model: &Model,
    training: &[TrainingDrive<'_>],
    share: f64,
    twice: &[[&Drive; 2]],
    seed: u64,
) -> Result<Model, ModelError> {
    let d = model.embedding_size();
    let whole = Personalizer::new(model);
    let posterior = |drive: &Drive| whole.of_drive(&whole.shown(drive, 1.0)?);
    let pairs: Result<Vec<Pair>, ModelError> =
        twice.iter().map(|[first, again]| Ok([posterior(first)?, posterior(again)?])).collect();
    let prior = matches!(model.heads(), Heads::Linear(_));
    let Some(days) = Days::learn(&pairs?, prior, d) else {
        return Ok(model.clone());
    };
    let mut parts = ModelParts::from(model.clone());
    if let Heads::Linear(linear) = &mut parts.heads {
        let first = Personalizer::of_first(model, share)?;
        let mut scored = Vec::new();
        for place in &mut parts.training {
            let Some(drive) = training.iter().find(|t| t.drive.meta().drive == place.drive) else {
                continue;
            };
            let shown = first.shown(drive.drive, share)?;
            let Some(person) = days.of_person(&first.of_drive(&shown)?, None) else {
                continue;
            };
            place.embedding = Embedding::new(person.mean.clone())?;
            if let Some(adb) = drive.adb {
                scored.push(ScoredStyle {
                    participant: drive.drive.meta().participant.clone(),
                    style: person,
                    points: points_on(parts.score_range, adb)?,
                });
            }
        }
        linear.style = StyleHead::fit(&scored, d, seed);
    }
    parts.days = Some(days);
    Model::try_from(parts)
}

impl Personalizer<'_> {
    /// What is shown says of the drive's own style, without a score.
    fn of_drive(&self, shown: &Shown) -> Result<Posterior, ModelError> {
        self.posterior(shown, None, None).map(|(posterior, _)| posterior)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        model_file,
        personalize::{personalize, tests::linear_model},
        test_drives::{Habits, drive_apart, drivers_apart},
    };

    #[test]
    fn a_person_whose_days_differ_is_known_less_well_and_the_model_file_keeps_it() {
        let drives = drivers_apart(12, 300.0);
        let given = drives.iter().map(TrainingDrive::from);
        let given: Vec<TrainingDrive<'_>> = given.collect();
        let model = linear_model();
        // On the other day everybody drives as somebody else: by turns faster and slower.
        let other = |i: usize| Habits {
            speed_mps: 26.0 + 2.0 * ((5 * i) % 4) as f64,
            time_gap_s: 1.2 + 0.3 * ((7 * i) % 3) as f64,
            passes: true,
        };
        let again: Vec<Drive> =
            (0..12).map(|i| drive_apart(&format!("again{i}"), &other(i), 300.0)).collect();
        let twice: Vec<[&Drive; 2]> = drives.iter().zip(&again).map(|((a, _), b)| [a, b]).collect();
        let knowing = learn_days(&model, &given, 1.0, &twice, 1).unwrap();
        let days = knowing.days().unwrap();
        assert_eq!(days.people, 12);
        assert!(days.sd().iter().all(|sd| sd.is_finite()));
        assert!(days.sd().iter().any(|sd| *sd > 0.3), "{:?}", days.sd());
        let habits = Habits { speed_mps: 33.0, time_gap_s: 1.2, passes: true };
        let new = drive_apart("new", &habits, 300.0);
        let [drive, person] = [&model, &knowing].map(|m| personalize(m, &new, None).unwrap());
        let errors = [&drive, &person].map(|p| p.standard_error().unwrap());
        let each = || errors[0].iter().zip(&errors[1]);
        assert!(each().all(|(drive, person)| *person > drive - 1e-6), "{errors:?}");
        assert!(each().any(|(drive, person)| *person > 1.2 * drive), "{errors:?}");
        let length = |p: &crate::Personalized| -> f64 {
            p.embedding.coordinates().iter().map(|x| x * x).sum()
        };
        assert!(length(&person) < length(&drive));
        let bytes = model_file::to_bytes(&knowing).unwrap();
        assert_eq!(model_file::from_bytes(&bytes).unwrap(), knowing);
        // Two people are too few for three numbers.
        let few = learn_days(&model, &given, 1.0, &twice[..2], 1).unwrap();
        assert_eq!(few, model);
    }
}
