//! What each part of the model is worth on drivers that it has not seen, beside what needs no network.
//!
//! Cross-validation by driver: networks learn from all other drivers; an unseen driver's embedding is fitted to the
//! first part of the drive and judged on the rest, in the units of the signals.

mod linear;

use crate::{
    epochs::{TrainingDrive, shuffled_drivers},
    error::ModelError,
    heads_kind::HeadsKind,
    held_out::{HeldOut, Said, cut},
    model::{Habits, Model},
    own_means::OwnMeans,
    params::{TrainSettings, part},
    personalize::{NetworkRows, Personalizer},
    rows::{Row, RowWeights, rows_of},
    train::train,
};
use linear::LinearWindows;
use maveric_domain::{Drive, DriveId};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// One way to predict a driver.
#[derive(Debug, Clone, PartialEq)]
pub struct Variant {
    /// What it is called in tables: `size 2`.
    pub name: String,
    /// What it is.
    pub kind: VariantKind,
}

/// What predicts.
#[derive(Debug, Clone, PartialEq)]
pub enum VariantKind {
    /// Heads trained with these settings: the paper's networks, without `w` where the `embedding_learning_rate` is 0 and every
    /// embedding stays at zero; or linear ones, which say a driver's own free speed and following gap, and when somebody changes
    /// lane by a gap, not by a probability a second.
    Learned(Box<TrainSettings>),
    /// The driver's own mean speed, mean gap and rate of lane changes.
    OwnMeans,
    /// The driver's own time gap, times the lead vehicle's speed; nothing else is predicted.
    OwnTimeGap,
    /// Linear (and logistic) in the windows and in three numbers a driver, one for each output.
    LinearWindows,
}

/// The comparison that the paper and the method ask for: embedding sizes, without M, without S, the Gaussian
/// likelihood, window lengths, without `w`, and the baselines. The first is `base` as it is.
///
/// # Source
/// Paper, "Embedding size"; method section 3. Losses cannot choose the size alone: calibration section 3.
pub fn variants(base: &TrainSettings, sizes: &[usize], windows_s: &[f64]) -> Vec<Variant> {
    let learned = |name: String, heads: HeadsKind, change: &dyn Fn(&mut TrainSettings)| {
        let mut settings = TrainSettings { heads, ..base.clone() };
        change(&mut settings);
        Variant { name, kind: VariantKind::Learned(Box::new(settings)) }
    };
    let networks =
        |name: String, change: &dyn Fn(&mut TrainSettings)| learned(name, HeadsKind::Paper, change);
    let mut variants = vec![networks(format!("size {}", base.embedding_size), &|_| {})];
    for &size in sizes.iter().filter(|&&s| s != base.embedding_size) {
        variants.push(networks(format!("size {size}"), &|s| {
            s.embedding_size = size;
        }));
    }
    variants.push(networks("without M (no L5)".to_owned(), &|s| {
        s.loss_weights.mutual_information = 0.0;
    }));
    variants.push(networks("without S (no L4)".to_owned(), &|s| {
        s.loss_weights.aggression = 0.0;
    }));
    variants.push(networks("Gaussian L5".to_owned(), &|s| {
        s.mutual_information_loss = crate::MutualInformationLoss::GaussianLikelihood;
    }));
    for &window_s in windows_s {
        variants.push(networks(format!("window {window_s} s"), &|s| {
            s.window_s = window_s;
        }));
    }
    variants.push(networks("without w".to_owned(), &|s| {
        s.embedding_learning_rate = 0.0;
    }));
    variants.push(learned("linear heads".to_owned(), HeadsKind::Linear, &|_| {}));
    let baselines = [
        ("linear with w", VariantKind::LinearWindows),
        ("own means", VariantKind::OwnMeans),
        ("own time gap", VariantKind::OwnTimeGap),
    ];
    variants.extend(baselines.map(|(name, kind)| Variant { name: name.to_owned(), kind }));
    variants
}

/// How the drivers are split.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AblationSettings {
    /// Parts into which the drivers are split.
    pub folds: usize,
    /// Share of an unseen drive, from its start, that its driver is known by; the rest judges.
    pub known_fraction: f64,
}

impl Default for AblationSettings {
    fn default() -> Self {
        Self { folds: 5, known_fraction: 2.0 / 3.0 }
    }
}

/// One variant on every drive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VariantResult {
    /// Name of the [`Variant`].
    pub name: String,
    /// Drives in the order given; `None`: too short to be known and judged.
    pub of_each: Vec<Option<HeldOut>>,
}

/// Every variant on the same unseen drives.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Ablated {
    /// The drives, in the order given.
    pub drives: Vec<DriveId>,
    /// Folds of drivers, and which share of an unseen drive is known.
    pub settings: AblationSettings,
    /// The variants; the first is the one that the others are compared with.
    pub variants: Vec<VariantResult>,
}

/// Holds out each fold of drivers in turn, for every variant.
///
/// All drives of a participant are in one fold, and the folds are the same for all variants. Scores teach
/// the networks, but no unseen driver's score is used. `observe` is told how many trainings are done, and of how many.
///
/// # Errors
/// [`ModelError::TooFewDrivers`] unless there are 2 folds or more and a driver for each; [`ModelError::BadSetting`];
/// [`ModelError::Cancelled`] where `observe` broke off; else whatever training or personalising says.
pub fn ablate(
    drives: &[TrainingDrive<'_>],
    variants: &[Variant],
    settings: &AblationSettings,
    seed: u64,
    observe: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) -> Result<Ablated, ModelError> {
    part("known_fraction", settings.known_fraction)?;
    let fold_of = folds(drives, settings.folds, seed)?;
    let trainings = variants.len() * settings.folds;
    let mut results = Vec::with_capacity(variants.len());
    for (index, variant) in variants.iter().enumerate() {
        let mut of_each = vec![None; drives.len()];
        for fold in 0..settings.folds {
            if observe(index * settings.folds + fold, trainings).is_break() {
                return Err(ModelError::Cancelled { epoch: 0 });
            }
            let with_folds = || drives.iter().zip(&fold_of);
            let seen = with_folds().filter(|(_, f)| **f != fold);
            let seen: Vec<TrainingDrive<'_>> = seen.map(|(d, _)| *d).collect();
            let judge = Judge::train(&variant.kind, &seen, seed)?;
            for ((drive, of_fold), result) in with_folds().zip(&mut of_each) {
                if *of_fold == fold {
                    *result = judge.held_out(drive.drive, settings.known_fraction)?;
                }
            }
        }
        results.push(VariantResult { name: variant.name.clone(), of_each });
    }
    Ok(Ablated {
        drives: drives.iter().map(|d| d.drive.meta().drive.clone()).collect(),
        settings: settings.clone(),
        variants: results,
    })
}

/// The fold of each drive.
fn folds(drives: &[TrainingDrive<'_>], folds: usize, seed: u64) -> Result<Vec<usize>, ModelError> {
    let drivers = shuffled_drivers(drives, seed, &["cross-validate", "folds"]);
    if folds < 2 || folds > drivers.len() {
        return Err(ModelError::TooFewDrivers { drivers: drivers.len(), folds });
    }
    let fold = |drive: &TrainingDrive<'_>| {
        let driver = &drive.drive.meta().participant;
        drivers.iter().position(|p| *p == driver).unwrap_or(0) % folds
    };
    Ok(drives.iter().map(fold).collect())
}

/// What has learned from the drivers of the other folds.
struct Judge {
    settings: TrainSettings,
    weights: RowWeights,
    learned: Knows,
}

enum Knows {
    Model(Box<Model>),
    Linear(LinearWindows),
    Means(OwnMeans),
    TimeGap(OwnMeans),
}

impl Judge {
    fn train(
        kind: &VariantKind,
        seen: &[TrainingDrive<'_>],
        seed: u64,
    ) -> Result<Self, ModelError> {
        let settings = match kind {
            VariantKind::Learned(settings) => (**settings).clone(),
            _ => TrainSettings::default(),
        };
        let mut of_each: Vec<Vec<Row>> = Vec::new();
        for drive in seen {
            of_each.extend(long_enough(drive.drive, &settings)?);
        }
        let weights = RowWeights::from_rows(of_each.iter().flatten());
        let own_means = || OwnMeans::learn(&of_each, &weights);
        let learned = match kind {
            VariantKind::Learned(settings) => {
                let go_on = &mut |_: &_| ControlFlow::Continue(());
                Knows::Model(Box::new(train(seen, settings, seed, go_on)?.model))
            }
            VariantKind::LinearWindows => Knows::Linear(LinearWindows::learn(&of_each, &weights)),
            VariantKind::OwnMeans => Knows::Means(own_means()),
            VariantKind::OwnTimeGap => Knows::TimeGap(own_means()),
        };
        Ok(Self { settings, weights, learned })
    }

    /// The errors on the part of the drive after the known share; `None` if there is nothing to know or to judge by.
    fn held_out(&self, drive: &Drive, known_share: f64) -> Result<Option<HeldOut>, ModelError> {
        let rows = long_enough(drive, &self.settings)?.unwrap_or_default();
        let Some((known, unseen)) = cut(&rows, known_share) else {
            return Ok(None);
        };
        let predictions = match &self.learned {
            Knows::Model(model) => match model.kind() {
                HeadsKind::Linear => {
                    let fit = Personalizer::of_first(model, known_share)?.fit(drive, None)?;
                    let habits = Habits::new(model, &fit.embedding)?;
                    predict(&habits, drive.road().posted_speed_mps, unseen)
                }
                HeadsKind::Paper => {
                    let (paper, mean) = (model.paper()?, model.mean_embedding().coordinates());
                    let w = if self.settings.embedding_learning_rate > 0.0 {
                        NetworkRows::new(paper, known, None).minimum(mean)
                    } else {
                        nalgebra::DVector::from_column_slice(mean)
                    };
                    NetworkRows::new(paper, unseen, None).say(w.as_slice()).1
                }
            },
            Knows::Linear(linear) => linear.say(known, unseen),
            Knows::Means(means) => vec![means.say(known); unseen.len()],
            Knows::TimeGap(means) => unseen.iter().map(|r| means.by_time_gap(known, r)).collect(),
        };
        Ok(Some(HeldOut::from_predictions(predictions.into_iter().zip(unseen), &self.weights)))
    }
}

/// The rows of a drive; `None` of one that is shorter than a window.
fn long_enough(drive: &Drive, settings: &TrainSettings) -> Result<Option<Vec<Row>>, ModelError> {
    match rows_of(drive, &settings.row_settings(), 1.0) {
        Err(ModelError::DriveTooShort { .. }) => Ok(None),
        rows => rows.map(Some),
    }
}

/// What a driver's habits say of rows: the own gap while following, and the own free speed or, behind somebody nearer than that
/// gap, theirs.
fn predict(habits: &Habits, posted_mps: f64, rows: &[Row]) -> Vec<Said> {
    let free_mps = habits.free_speed_mps(Some(posted_mps));
    let gap_m = |lead_mps: f64| Some(habits.following_gap_s(free_mps?, lead_mps)? * lead_mps);
    let prediction = |row: &Row| Said {
        following_distance_m: gap_m(row.lead_speed_mps),
        log_odds: None,
        speed_mps: free_mps.map(|v| match row.following_distance_m {
            Some(_) => v.min(row.lead_speed_mps),
            None => v,
        }),
    };
    rows.iter().map(prediction).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_drives::drivers;

    #[test]
    fn every_drive_is_unseen_once_and_own_means_know_the_driver() {
        let drives = drivers(6, 150.0);
        let given: Vec<_> = drives.iter().map(TrainingDrive::from).collect();
        let base = TrainSettings {
            epochs: 6,
            batch_size: 128,
            validation_fraction: 0.0,
            ..TrainSettings::default()
        };
        let all = variants(&base, &[2], &[]);
        let names: Vec<&str> = all.iter().map(|v| v.name.as_str()).collect();
        assert_eq!(names[..2], ["size 3", "size 2"]);
        let chosen: Vec<Variant> =
            ["size 3", "without w", "linear with w", "own means", "own time gap", "linear heads"]
                .iter()
                .map(|name| all.iter().find(|v| v.name == *name).unwrap().clone())
                .collect();
        let settings = AblationSettings { folds: 3, ..AblationSettings::default() };
        let mut steps = Vec::new();
        let mut observe = |done, all| {
            steps.push((done, all));
            ControlFlow::Continue(())
        };
        let found = ablate(&given, &chosen, &settings, 1, &mut observe).unwrap();
        assert_eq!(steps, (0..18).map(|k| (k, 18)).collect::<Vec<_>>());
        let mean = |variant: usize, of: fn(&HeldOut) -> Option<f64>| {
            let values: Vec<f64> = found.variants[variant]
                .of_each
                .iter()
                .map(|h| of(h.as_ref().unwrap()).unwrap())
                .collect();
            values.iter().sum::<f64>() / 6.0
        };
        let speed: Vec<f64> = [0, 1, 2, 3].map(|v| mean(v, |h| h.speed_mps)).to_vec();
        // Knowing who drives is worth something, and so is seeing the road.
        assert!(speed[0] < speed[1] && speed[2] < speed[3], "{speed:?}");
        assert!(mean(4, |h| h.following_distance_m) < mean(1, |h| h.following_distance_m));
        for held_out in found.variants[4].of_each.iter().flatten() {
            assert!(held_out.speed_mps.is_none() && held_out.lane_change.is_none());
        }
        let mut none = |_, _| ControlFlow::Break(());
        let stopped = ablate(&given, &chosen, &settings, 1, &mut none);
        assert!(matches!(stopped, Err(ModelError::Cancelled { .. })));
        let settings = AblationSettings { folds: 7, ..settings };
        let refused = ablate(&given, &chosen, &settings, 1, &mut none);
        assert!(matches!(refused, Err(ModelError::TooFewDrivers { .. })));
    }
}
