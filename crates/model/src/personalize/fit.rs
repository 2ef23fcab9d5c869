//! An embedding fitted to a drive, from several starts.

use super::{frozen::Frozen, objective::Fit, uncertainty::Uncertainty};
use crate::{
    damped_newton::{Minimum, minimise},
    error::{ModelError, ModelWarning},
    losses::{Loss, LossTerms, Sums},
    model::Model,
    params::PersonalizeParams,
    quasi_newton::polish,
    rows::{Row, rows_of},
};
use maveric_domain::{AdbScore, Drive, DriveId, Embedding, stream_seed};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

/// Share of the objective that a further step must promise for a start to go on: some hundredths of an SD of drivers, well below
/// any standard error. The best start is then polished.
const NEAR: f64 = 1e-4;

/// Where one start led.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Start {
    /// Where it began; the first is the mean of the training embeddings.
    pub from: Embedding,
    /// Where it ended.
    pub to: Embedding,
    /// What it reached.
    pub objective: f64,
    /// Steps it took.
    pub iterations: usize,
}

/// A driver in style space.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Personalized {
    /// The best of the starts.
    pub embedding: Embedding,
    /// How well the drive determines it; `None` if it does not, for the reason among the warnings.
    pub uncertainty: Option<Uncertainty>,
    /// The weighted sum there: the training objective over this driver's rows.
    pub objective: f64,
    /// Each loss there, a mean over the rows it concerns.
    pub losses: LossTerms,
    /// Root mean square distance of the starts' ends from the embedding, in SDs of the training embeddings. Starts end some
    /// hundredths of an SD from a minimum; only the best is taken all the way.
    pub start_spread: f64,
    /// The same along each coordinate, shape `(d,)`.
    pub start_spread_by_coordinate: Vec<f64>,
    /// Every start.
    pub starts: Vec<Start>,
    /// M's mean over the drive, read at the mean training embedding; `None` if M was not trained. M reads outputs
    /// that were made with `w`, so this follows the fitted embedding weakly, and with any sign.
    pub amortized_guess: Option<Embedding>,
    /// S's reading at the embedding, in ADB points; `None` if the model has no aggression axis.
    pub aggression_hat: Option<f64>,
    /// Rows fitted to.
    pub rows: usize,
    /// Rows among them at which ego follows.
    pub following_rows: usize,
    /// Rows among them at which a lane change is being started.
    pub lane_change_rows: usize,
    /// Whether an ADB score was fitted too. With it, position on the aggression line and ADB agree by
    /// construction.
    pub used_adb: bool,
    /// Losses that had no rows, and why an uncertainty is missing.
    pub warnings: Vec<ModelWarning>,
}

/// Fits embeddings to drives with the networks of one model frozen.
///
/// It holds the model's weights and nothing of any drive: fitting the next one takes what the last one took. To fit many
/// drives, share one between threads.
#[derive(Debug)]
pub struct Personalizer<'a> {
    model: &'a Model,
    frozen: Frozen,
    params: PersonalizeParams,
}

/// Fits an embedding to one drive; see [`Personalizer::fit`].
///
/// # Errors
/// As [`Personalizer::fit`].
pub fn personalize(
    model: &Model,
    drive: &Drive,
    adb: Option<AdbScore>,
    params: &PersonalizeParams,
    seed: u64,
) -> Result<Personalized, ModelError> {
    Personalizer::new(model, params.clone()).fit(drive, adb, seed)
}

impl<'a> Personalizer<'a> {
    /// Reads the weights out of `model`.
    pub fn new(model: &'a Model, params: PersonalizeParams) -> Self {
        Self {
            frozen: Frozen::of(model),
            model,
            params,
        }
    }

    /// The model it fits with.
    pub fn model(&self) -> &Model {
        self.model
    }

    /// Fits an embedding to `drive`.
    ///
    /// Windows are encoded once, up to what the first layers make of them; then Gauss-Newton steps, damped
    /// where the losses bend otherwise, lead from the mean of the training embeddings and from draws of the
    /// prior N(0, I) to near a minimum, and BFGS from the best of these to the minimum. L5 is taken in expectation over M's sample, so that the
    /// objective has no noise. L4 is fitted where `adb` is given and [`crate::PersonalizeSettings::use_adb`] is set.
    ///
    /// # Errors
    /// [`ModelError::DriveTooShort`] if the drive lasts less than one window.
    ///
    /// # Source
    /// Method section 3, "Personalising".
    pub fn fit(
        &self,
        drive: &Drive,
        adb: Option<AdbScore>,
        seed: u64,
    ) -> Result<Personalized, ModelError> {
        let fraction = self.params.settings().fit_fraction;
        let rows = self.rows(drive, fraction)?;
        self.fit_rows(&drive.meta().drive, &rows, adb, seed)
    }

    pub(crate) fn rows(&self, drive: &Drive, fraction: f64) -> Result<Vec<Row>, ModelError> {
        rows_of(drive, &self.model.row_settings(), fraction)
    }

    /// Rows of the grid a second.
    pub(super) fn row_rate_hz(&self) -> f64 {
        self.model.row_settings().row_rate_hz
    }

    /// The losses of `rows` as a function of `w`.
    pub(crate) fn objective(&self, rows: &[Row], adb: Option<AdbScore>) -> Fit<'_> {
        let in_block = self.params.settings().block_s * self.row_rate_hz();
        Fit::with_blocks(&self.frozen, rows, adb, (in_block.round() as usize).max(1))
    }

    pub(crate) fn fit_rows(
        &self,
        drive: &DriveId,
        rows: &[Row],
        adb: Option<AdbScore>,
        seed: u64,
    ) -> Result<Personalized, ModelError> {
        let settings = self.params.settings();
        let d = self.model.embedding_size();
        let adb = adb.filter(|_| settings.use_adb && self.model.learned().aggression);
        let fit = self.objective(rows, adb);

        let stream = stream_seed(seed, &["personalize", drive.as_str()]);
        let mut rng = Pcg64Mcg::seed_from_u64(stream);
        let prior = |_| -> Vec<f64> { (0..d).map(|_| StandardNormal.sample(&mut rng)).collect() };
        let mean = self.model.mean_embedding().coordinates().to_vec();
        let points: Vec<Vec<f64>> = std::iter::once(mean.clone())
            .chain((1..settings.starts).map(prior))
            .collect();
        let steps = settings.iterations;
        let ends: Vec<Minimum> = points
            .par_iter()
            .map(|from| minimise(|w| fit.value(w), from.clone(), NEAR, steps))
            .collect();
        let better = |a: &&Minimum, b: &&Minimum| a.there.value.total_cmp(&b.there.value);
        // There is a start at least; a NaN sorts last.
        let Some(nearest) = ends.iter().min_by(better) else {
            return Err(ModelError::BadSetting {
                name: "starts",
                found: settings.starts as f64,
                expected: "1 to 64",
            });
        };
        let best = polish(
            |w| fit.slope(w),
            nearest.at.clone(),
            nearest.there.clone(),
            steps,
        );

        let spread = spread(&ends, &best.at, &training_sd(self.model));
        let close = fit.close(&best.at);
        let sums = &close.sums;
        let mut warnings = empty_losses(sums);
        let uncertainty = Uncertainty::of(&close).map_err(|reason| {
            warnings.push(ModelWarning::NoStandardError {
                drive: drive.clone(),
                reason,
            });
        });
        let has_m = fit.frozen().weights.mutual_information > 0.0;
        let guess = has_m
            .then(|| Embedding::new(fit.reading(&mean)))
            .transpose()?;
        let starts = points.into_iter().zip(&ends).map(|(from, end)| {
            Ok(Start {
                from: Embedding::new(from)?,
                to: Embedding::new(end.at.clone())?,
                objective: end.there.value,
                iterations: end.iterations,
            })
        });
        let embedding = Embedding::new(best.at)?;
        let axis = crate::style_space::AggressionAxis::of(self.model).ok();
        let count = |which: fn(&&Row) -> bool| rows.iter().filter(which).count();
        Ok(Personalized {
            objective: best.there.value,
            losses: sums.terms(close.l4, d),
            uncertainty: uncertainty.ok(),
            start_spread: spread.iter().map(|s| s * s).sum::<f64>().sqrt(),
            start_spread_by_coordinate: spread,
            starts: starts.collect::<Result<_, ModelError>>()?,
            amortized_guess: guess,
            aggression_hat: axis.map(|axis| axis.points(embedding.coordinates())),
            rows: rows.len(),
            following_rows: count(|r| r.following_distance_m.is_some()),
            lane_change_rows: count(|r| r.lane_change == Some(true)),
            used_adb: adb.is_some(),
            warnings,
            embedding,
        })
    }
}

/// Root mean square distance of the ends from the best along each coordinate, in SDs.
fn spread(ends: &[Minimum], best: &[f64], sd: &[f64]) -> Vec<f64> {
    let n = ends.len() as f64;
    let along = |i: usize| -> f64 {
        let squares = ends.iter().map(|e| ((e.at[i] - best[i]) / sd[i]).powi(2));
        (squares.sum::<f64>() / n).sqrt()
    };
    (0..best.len()).map(along).collect()
}

/// SD of the training embeddings along each coordinate; 1 where they do not differ, as when there is one.
pub(super) fn training_sd(model: &Model) -> Vec<f64> {
    let d = model.embedding_size();
    let training = model.training();
    let points: Vec<&[f64]> = training.iter().map(|t| t.embedding.coordinates()).collect();
    let (_, covariance) = crate::linear_algebra::mean_and_covariance(&points, d);
    (0..d)
        .map(|i| covariance[i * d + i].sqrt())
        .map(|sd| if sd > 1e-6 { sd } else { 1.0 })
        .collect()
}

fn empty_losses(sums: &Sums) -> Vec<ModelWarning> {
    let checks = [
        (
            Loss::FollowingDistance,
            sums.following_distance.weight,
            "no row at which this driver follows, or F was not trained",
        ),
        (
            Loss::LaneChange,
            sums.lane_change.weight,
            "no row to judge lane changes by, or C was not trained",
        ),
    ];
    let empty = checks.into_iter().filter(|(_, weight, _)| *weight <= 0.0);
    empty
        .map(|(loss, _, reason)| ModelWarning::LossLeftOut { loss, reason })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        params::PersonalizeSettings,
        personalize::reference::{Problem, Reference},
        test_drives::{Habits, RATE_HZ, drive},
    };

    fn fit(problem: &Problem, starts: usize) -> Personalized {
        let settings = PersonalizeSettings {
            starts,
            ..PersonalizeSettings::default()
        };
        let params = PersonalizeParams::new(settings).unwrap();
        let id = DriveId::new("P00-own").unwrap();
        Personalizer::new(&problem.model, params)
            .fit_rows(&id, &problem.rows, problem.adb, 7)
            .unwrap()
    }

    #[test]
    fn the_minimum_is_that_of_plain_loops_in_double_precision() {
        let problem = Problem::new("defaults", true, |_| {});
        let found = fit(&problem, 4);
        let reference = Reference::new(&problem.model, &problem.rows, problem.adb);
        let frozen = Frozen::of(&problem.model);
        let curvature = Fit::new(&frozen, &problem.rows, problem.adb)
            .value(found.embedding.coordinates())
            .curvature;
        let value = |w: &[f64]| crate::damped_newton::Evaluated {
            value: reference.value(w),
            gradient: (0..w.len()).map(|i| reference.slope(w, i)).collect(),
            curvature: curvature.clone(),
        };
        let nearby = found.embedding.coordinates().iter().map(|w| w + 0.02);
        let nearby: Vec<f64> = nearby.collect();
        let here = value(&nearby);
        let exact = polish(value, nearby, here, 60);
        let off: Vec<f64> = exact
            .at
            .iter()
            .zip(found.embedding.coordinates())
            .map(|(a, b)| a - b)
            .collect();
        // Along a kink of the ReLUs the minimum is flat to rounding; a coordinate's SD is 1.
        assert!(off.iter().all(|x| x.abs() < 2e-3), "{off:?}");
        let off = found.objective - exact.there.value;
        assert!(off.abs() < 1e-4 * exact.there.value, "{off}");
        for start in &found.starts {
            assert!(found.objective <= start.objective + 1e-6);
        }
    }

    #[test]
    fn every_start_ends_near_the_first() {
        let problem = Problem::new("defaults", true, |_| {});
        let found = fit(&problem, 6);
        assert!(found.start_spread < 0.2, "{}", found.start_spread);
        let squares = found.start_spread_by_coordinate.iter().map(|s| s * s);
        assert!((squares.sum::<f64>().sqrt() - found.start_spread).abs() < 1e-12);
        let from_mean = problem.model.mean_embedding();
        assert_eq!(&found.starts[0].from, from_mean);
        assert_eq!(found.starts.len(), 6);
    }

    fn personalized(new: &Drive) -> Result<Personalized, ModelError> {
        let problem = Problem::new("defaults", true, |s| s.epochs = 2);
        personalize(&problem.model, new, None, &PersonalizeParams::default(), 1)
    }

    const HABITS: Habits = Habits {
        speed_mps: 28.0,
        time_gap_s: 1.5,
        passes: true,
    };

    #[test]
    fn a_drive_shorter_than_a_window_is_refused_with_what_to_do() {
        let error = personalized(&drive("short", &HABITS, 2.0)).unwrap_err();
        let text = error.to_string();
        assert!(text.contains("short-own lasts 2 s"), "{text}");
        assert!(error.suggestion().unwrap().contains("longer"));
    }

    #[test]
    fn without_a_lead_vehicle_following_is_left_out_and_said() {
        // The first lead comes after ten seconds.
        let found = personalized(&drive("alone", &HABITS, 9.5)).unwrap();
        assert_eq!((found.following_rows, found.lane_change_rows), (0, 0));
        assert_eq!(found.losses.following_distance, None);
        let said: Vec<String> = found.warnings.iter().map(ToString::to_string).collect();
        assert!(
            said[0].contains("no row at which this driver follows"),
            "{said:?}"
        );
        assert!(said[1].contains("drive longer"), "{said:?}");
        assert!(found.uncertainty.is_none());
    }

    #[test]
    fn without_lane_changes_keeping_lane_is_what_is_learned() {
        let patient = Habits {
            passes: false,
            ..HABITS
        };
        let found = personalized(&drive("patient", &patient, 200.0)).unwrap();
        assert_eq!(found.lane_change_rows, 0);
        assert!(found.following_rows > 0);
        assert!(found.losses.lane_change.unwrap() > 0.0);
        assert!(found.objective.is_finite());
    }

    #[test]
    fn not_a_number_never_gets_as_far_as_a_fit() {
        let whole = drive("whole", &HABITS, 20.0);
        let mut rows = whole.rows().clone();
        rows.lead_speed_mps[3] = f64::NAN;
        let broken = Drive::from_rows(whole.meta().clone(), *whole.road(), RATE_HZ, rows);
        let text = broken.unwrap_err().to_string();
        assert!(text.contains("lead_speed_mps"), "{text}");
    }
}
