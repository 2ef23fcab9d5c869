//! How much driving it takes: fits to the first minutes of a drive, judged on its last part.

use super::fit::{Personalizer, training_sd};
use crate::{error::ModelError, losses::LossTerms};
use maveric_domain::{Drive, DriveId, Embedding};
use serde::{Deserialize, Serialize};

/// What can be set about a learning curve; [`CurveParams`] is the checked form.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CurveSettings {
    /// Minutes of driving to fit to, rising.
    pub minutes: Vec<f64>,
    /// Share of the drive, at its end, that no fit sees and every fit is judged on.
    pub held_out: f64,
}

impl Default for CurveSettings {
    fn default() -> Self {
        Self {
            minutes: vec![1.0, 2.0, 5.0, 10.0],
            held_out: 0.2,
        }
    }
}

/// Checked [`CurveSettings`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(try_from = "CurveSettings", into = "CurveSettings")]
pub struct CurveParams(CurveSettings);

impl CurveParams {
    /// Checks the settings.
    ///
    /// # Errors
    /// [`ModelError::BadSetting`] for minutes that are not above 0 and rising, or a share outside 0 to 1.
    pub fn new(settings: CurveSettings) -> Result<Self, ModelError> {
        let bad = |name, found, expected| ModelError::BadSetting {
            name,
            found,
            expected,
        };
        let mut last = 0.0;
        for &found in &settings.minutes {
            if !(found.is_finite() && found > last) {
                return Err(bad("minutes", found, "finite numbers above 0, rising"));
            }
            last = found;
        }
        let found = settings.held_out;
        if !(found > 0.0 && found < 1.0) {
            return Err(bad("held_out", found, "above 0, below 1"));
        }
        Ok(Self(settings))
    }

    /// The settings.
    pub fn settings(&self) -> &CurveSettings {
        &self.0
    }
}

impl TryFrom<CurveSettings> for CurveParams {
    type Error = ModelError;
    fn try_from(settings: CurveSettings) -> Result<Self, ModelError> {
        Self::new(settings)
    }
}

impl From<CurveParams> for CurveSettings {
    fn from(params: CurveParams) -> Self {
        params.0
    }
}

/// How good an embedding is after some minutes of driving.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CurvePoint {
    /// Minutes fitted to; 0: nothing was, the embedding is the mean of the training embeddings.
    pub minutes: f64,
    /// Whether these are all the minutes that are not held out.
    pub all: bool,
    /// The embedding.
    pub embedding: Embedding,
    /// L1, L2 and L3 on the part held out.
    pub held_out: LossTerms,
    /// Distance to the embedding fitted to the whole drive, in SDs of the training embeddings.
    pub distance_to_full_sd: f64,
    /// Standard error of each coordinate; `None` before there is enough driving to tell.
    pub standard_error: Option<Vec<f64>>,
}

/// The learning curve of one drive.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LearningCurve {
    /// The drive.
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
/// The ADB score takes no part: the question is what driving tells. Minutes count driving: a hole in the
/// recording adds nothing.
///
/// # Errors
/// [`ModelError::DriveTooShort`] if there is no row to fit to or none to judge by.
///
/// # Source
/// Method section 3; the paper takes ten minutes and shows no curve (ours).
pub fn learning_curve(
    personalizer: &Personalizer<'_>,
    drive: &Drive,
    params: &CurveParams,
    seed: u64,
) -> Result<LearningCurve, ModelError> {
    let settings = params.settings();
    let model = personalizer.model();
    let id = &drive.meta().drive;
    let rows = personalizer.rows(drive, 1.0)?;
    let per_minute = 60.0 * personalizer.row_rate_hz();
    // Where each row of the grid lies among all rows, and the end.
    let grid: Vec<usize> = (0..rows.len())
        .filter(|&i| rows[i].on_grid)
        .chain([rows.len()])
        .collect();
    let all = grid.len() - 1;
    let seen = ((1.0 - settings.held_out) * all as f64).floor() as usize;
    if seen == 0 || seen == all {
        return Err(ModelError::DriveTooShort {
            drive: id.clone(),
            found_s: all as f64 / personalizer.row_rate_hz(),
            expected_s: model.windows().window_s / settings.held_out,
        });
    }
    let judge = personalizer.objective(&rows[grid[seen]..], None);
    let full = personalizer.fit_rows(id, &rows, None, seed)?.embedding;
    let sd = training_sd(model);
    let point = |minutes: f64, embedding: Embedding, standard_error| {
        let w = embedding.coordinates();
        let (sums, _) = judge.sums(w);
        let difference = w.iter().zip(full.coordinates()).zip(&sd);
        CurvePoint {
            minutes,
            all: false,
            held_out: LossTerms {
                mutual_information: None,
                mutual_information_bound: None,
                ..sums.terms(None, w.len())
            },
            distance_to_full_sd: difference
                .map(|((a, b), sd)| ((a - b) / sd).powi(2))
                .sum::<f64>()
                .sqrt(),
            standard_error,
            embedding,
        }
    };
    let mut points = vec![point(0.0, model.mean_embedding().clone(), None)];
    let mut beyond = Vec::new();
    let lengths = settings
        .minutes
        .iter()
        .map(|&m| (m, (m * per_minute).round() as usize));
    for (minutes, length) in lengths {
        if length > seen {
            beyond.push(minutes);
        } else if length > 0 {
            let fit = personalizer.fit_rows(id, &rows[..grid[length]], None, seed)?;
            let error = fit.uncertainty.map(|u| u.standard_error);
            points.push(point(minutes, fit.embedding, error));
        }
    }
    let fit = personalizer.fit_rows(id, &rows[..grid[seen]], None, seed)?;
    let error = fit.uncertainty.map(|u| u.standard_error);
    points.push(CurvePoint {
        all: true,
        ..point(seen as f64 / per_minute, fit.embedding, error)
    });
    Ok(LearningCurve {
        drive: id.clone(),
        held_out_minutes: (all - seen) as f64 / per_minute,
        points,
        beyond,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        params::PersonalizeParams,
        personalize::reference::Problem,
        test_drives::{Habits, drive},
    };

    #[test]
    fn more_driving_comes_nearer_and_predicts_better_than_none() {
        let problem = Problem::new("defaults", true, |s| s.epochs = 20);
        let habits = Habits {
            speed_mps: 32.0,
            time_gap_s: 1.2,
            passes: true,
        };
        let new = drive("new", &habits, 400.0);
        let personalizer = Personalizer::new(&problem.model, PersonalizeParams::default());
        let curve = learning_curve(&personalizer, &new, &CurveParams::default(), 1).unwrap();
        let minutes: Vec<f64> = curve.points.iter().map(|p| p.minutes).collect();
        assert_eq!(minutes[..4], [0.0, 1.0, 2.0, 5.0]);
        assert_eq!(curve.beyond, [10.0]);
        let [none, .., all] = curve.points.as_slice() else {
            panic!("two points at least");
        };
        assert!(all.all && !none.all);
        assert!((all.minutes + curve.held_out_minutes - 400.0 / 60.0).abs() < 0.05);
        assert!(none.standard_error.is_none() && all.standard_error.is_some());
        assert!(
            all.distance_to_full_sd < 0.5 * none.distance_to_full_sd,
            "{curve:?}"
        );
        let velocity = |p: &CurvePoint| p.held_out.velocity.unwrap();
        assert!(velocity(all) < velocity(none), "{curve:?}");
    }

    #[test]
    fn a_drive_with_nothing_to_hold_out_is_refused() {
        let problem = Problem::new("defaults", true, |s| s.epochs = 1);
        let habits = Habits {
            speed_mps: 32.0,
            time_gap_s: 1.2,
            passes: true,
        };
        let new = drive("new", &habits, 4.0);
        let personalizer = Personalizer::new(&problem.model, PersonalizeParams::default());
        let params = CurveParams::new(CurveSettings {
            held_out: 0.01,
            ..CurveSettings::default()
        });
        let short = CurveParams::new(CurveSettings {
            held_out: 0.99,
            ..CurveSettings::default()
        });
        let run = |p: Result<CurveParams, ModelError>| {
            learning_curve(&personalizer, &new, &p.unwrap(), 1)
        };
        assert!(run(params).is_ok());
        assert!(matches!(run(short), Err(ModelError::DriveTooShort { .. })));
        let falling = CurveSettings {
            minutes: vec![2.0, 1.0],
            ..CurveSettings::default()
        };
        assert!(CurveParams::new(falling).is_err());
    }
}
