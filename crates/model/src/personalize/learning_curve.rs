//! How much driving it takes: fits to the first minutes of a drive, judged on its last part.

use super::Personalizer;
use crate::{
    error::ModelError,
    linear_algebra::moments,
    model::Model,
    params::{check, part},
};
use maveric_domain::{Drive, DriveId, Embedding};
use serde::Serialize;

/// What can be set about a learning curve.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveSettings {
    /// Minutes of driving to fit to, rising.
    pub minutes: Vec<f64>,
    /// Share of the drive, at its end, that no fit sees and every fit is judged on.
    pub held_out: f64,
}

impl Default for CurveSettings {
    fn default() -> Self {
        Self { minutes: vec![1.0, 2.0, 5.0, 10.0], held_out: 0.2 }
    }
}

impl CurveSettings {
    fn check(&self) -> Result<(), ModelError> {
        let mut last = 0.0;
        for &minutes in &self.minutes {
            check("minutes", minutes, minutes > last, "finite numbers above 0, rising")?;
            last = minutes;
        }
        part("held_out", self.held_out)
    }
}

/// How good an embedding is after some minutes of driving.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CurvePoint {
    /// Minutes fitted to; 0: nothing was, the embedding is the mean of the training embeddings.
    pub minutes: f64,
    /// Whether these are all the minutes that are not held out.
    pub all: bool,
    /// The embedding fitted to those minutes alone.
    pub embedding: Embedding,
    /// Mean loss of what the part held out shows: −ln likelihood of an event for linear heads, the weighted sum of L1 to L3 for
    /// the paper's networks; `None` where it shows nothing.
    pub held_out: Option<f64>,
    /// Distance to the embedding fitted to the whole drive, in SDs of the training embeddings.
    pub distance_to_full_sd: f64,
    /// Standard error of each coordinate; `None` before there is enough driving to tell.
    pub standard_error: Option<Vec<f64>>,
}

/// The learning curve of one drive.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LearningCurve {
    /// The drive whose start is fitted to and whose end is held out.
    pub drive: DriveId,
    /// Driving that is held out, in minutes.
    pub held_out_minutes: f64,
    /// Without driving, after each of the minutes asked for, and after all that is not held out.
    pub points: Vec<CurvePoint>,
    /// Minutes that were asked for and that the drive does not have before its held-out part.
    pub beyond: Vec<f64>,
}

/// Fits an embedding to the first minutes of `drive` and judges it on the drive's last part.
///
/// The score takes no part: the question is what driving tells. Minutes count driving: a hole in the
/// recording adds nothing.
///
/// # Errors
/// [`ModelError::BadSetting`], [`ModelError::DriveTooShort`] if there is nothing to fit to or to judge by.
///
/// # Source
/// Method section 3; the paper takes ten minutes and shows no curve (ours).
pub fn learning_curve(
    personalizer: &Personalizer<'_>,
    drive: &Drive,
    settings: &CurveSettings,
) -> Result<LearningCurve, ModelError> {
    settings.check()?;
    let model = personalizer.model();
    let per_minute = 60.0 * drive.rate_hz();
    let row_count = drive.len();
    let seen = ((1.0 - settings.held_out) * row_count as f64).floor() as usize;
    let short = |_| ModelError::DriveTooShort {
        drive: drive.meta().drive.clone(),
        found_s: row_count as f64 / drive.rate_hz(),
        expected_s: 2.0 / settings.held_out.min(1.0 - settings.held_out) / drive.rate_hz(),
    };
    let rest = drive.slice(seen, row_count).map_err(short)?;
    let judge = personalizer.shown(&rest, 1.0);
    let full = personalizer.fit(drive, None)?.embedding;
    let sd = training_sd(model);
    let point = |minutes: f64, embedding: Embedding, standard_error| {
        let w = embedding.coordinates();
        let difference = w.iter().zip(full.coordinates()).zip(&sd);
        CurvePoint {
            minutes,
            all: false,
            held_out: judge.as_ref().ok().and_then(|j| personalizer.loss(j, w)),
            distance_to_full_sd: difference
                .map(|((a, b), sd)| ((a - b) / sd).powi(2))
                .sum::<f64>()
                .sqrt(),
            standard_error,
            embedding,
        }
    };
    let first = |rows: usize| -> Result<CurvePoint, ModelError> {
        let known = drive.slice(0, rows).map_err(short)?;
        let minutes = rows as f64 / per_minute;
        let fit = personalizer.fit(&known, None)?;
        let standard_error = fit.standard_error();
        Ok(point(minutes, fit.embedding, standard_error))
    };
    let mut points = vec![point(0.0, model.mean_embedding().clone(), None)];
    let mut beyond = Vec::new();
    for &minutes in &settings.minutes {
        let rows = (minutes * per_minute).round() as usize;
        if rows > seen {
            beyond.push(minutes);
        } else {
            points.push(CurvePoint { minutes, ..first(rows)? });
        }
    }
    points.push(CurvePoint { all: true, ..first(seen)? });
    Ok(LearningCurve {
        drive: drive.meta().drive.clone(),
        held_out_minutes: (row_count - seen) as f64 / per_minute,
        points,
        beyond,
    })
}

/// SD of the training embeddings along each coordinate; 1 where they do not differ.
fn training_sd(model: &Model) -> Vec<f64> {
    let (_, covariance) = moments(&model.points(), model.embedding_size());
    let sds = covariance.diagonal().map(f64::sqrt);
    sds.iter().map(|&sd| if sd > 1e-9 { sd } else { 1.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        personalize::tests::linear_model,
        test_drives::{Habits, drive_apart},
    };

    const HABITS: Habits = Habits { speed_mps: 32.0, time_gap_s: 1.2, passes: true };

    #[test]
    fn more_driving_comes_nearer_than_none() {
        let model = linear_model();
        let new = drive_apart("new", &HABITS, 400.0);
        let personalizer = Personalizer::new(&model);
        let curve = learning_curve(&personalizer, &new, &CurveSettings::default()).unwrap();
        let minutes: Vec<f64> = curve.points.iter().map(|p| p.minutes).collect();
        assert_eq!(minutes[..4], [0.0, 1.0, 2.0, 5.0]);
        assert_eq!(curve.beyond, [10.0]);
        let [none, .., all] = curve.points.as_slice() else {
            panic!("two points at least");
        };
        assert!(all.all && !none.all);
        assert!((all.minutes + curve.held_out_minutes - 400.0 / 60.0).abs() < 0.05);
        assert!(none.standard_error.is_none() && all.standard_error.is_some());
        assert!(all.distance_to_full_sd < 0.5 * none.distance_to_full_sd, "{curve:?}");
        assert!(all.held_out.unwrap() < none.held_out.unwrap(), "{curve:?}");
    }

    #[test]
    fn minutes_have_to_rise_and_something_has_to_be_held_out() {
        let model = linear_model();
        let personalizer = Personalizer::new(&model);
        let drive = drive_apart("new", &HABITS, 60.0);
        let refused = |minutes: Vec<f64>, held_out: f64| {
            let settings = CurveSettings { minutes, held_out };
            learning_curve(&personalizer, &drive, &settings).unwrap_err()
        };
        assert!(matches!(refused(vec![2.0, 1.0], 0.2), ModelError::BadSetting { .. }));
        assert!(matches!(refused(vec![1.0], 0.0), ModelError::BadSetting { .. }));
        assert!(matches!(refused(vec![1.0], 1e-6), ModelError::DriveTooShort { .. }));
    }
}
