//! What each part of the model is worth on drivers that it has not seen, beside what needs no network.
//!
//! Cross-validation by driver: networks learn from all other drivers; an unseen driver's embedding is fitted to the
//! first part of the drive and judged on the rest, in the units of the signals.

mod baselines;
mod linear;

use crate::{
    error::ModelError,
    model::{Habits, HeadsKind, Model},
    params::{PersonalizeParams, TrainParams, TrainSettings},
    personalize::{NetworkRows, Personalizer, Shown},
    rows::{Row, RowSettings, rows_of},
    train::{TrainingDrive, train},
};
use baselines::{ConstantTimeGap, DriverMeans};
use linear::LinearModel;
use maveric_domain::{DriveId, ParticipantId, stream_seed};
use rand::{SeedableRng, seq::SliceRandom};
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};
use std::{collections::BTreeSet, ops::ControlFlow};

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
    /// The linear heads, trained with these settings: a driver's own free speed and following gap. They say when somebody changes
    /// lane by a gap, not by a probability a second.
    Heads(Box<TrainSettings>),
    /// The networks, trained with these settings. With an `embedding_learning_rate` of 0 every embedding stays at
    /// zero: the same networks without `w`.
    Networks(Box<TrainSettings>),
    /// The driver's own mean speed, mean gap and rate of lane changes.
    DriverMeans,
    /// The driver's own time gap, times the lead vehicle's speed; nothing else is predicted.
    ConstantTimeGap,
    /// Linear (and logistic) in the windows and in three numbers a driver, one for each output.
    Linear,
}

/// The comparison that the paper and the method ask for: embedding sizes, without M, without S, the Gaussian
/// likelihood, window lengths, without `w`, and the baselines. The first is `base` as it is.
///
/// # Source
/// Paper, "Embedding size"; method section 3. Losses cannot choose the size alone: calibration section 3.
pub fn variants(base: &TrainSettings, sizes: &[usize], windows_s: &[f64]) -> Vec<Variant> {
    let networks = |name: String, change: &dyn Fn(&mut TrainSettings)| {
        let mut settings = TrainSettings {
            heads: HeadsKind::Paper,
            ..base.clone()
        };
        change(&mut settings);
        Variant {
            name,
            kind: VariantKind::Networks(Box::new(settings)),
        }
    };
    let mut all = vec![networks(format!("size {}", base.embedding_size), &|_| {})];
    for &size in sizes.iter().filter(|&&s| s != base.embedding_size) {
        all.push(networks(format!("size {size}"), &|s| {
            s.embedding_size = size;
        }));
    }
    all.push(networks("without M (no L5)".to_owned(), &|s| {
        s.loss_weights.mutual_information = 0.0;
    }));
    all.push(networks("without S (no L4)".to_owned(), &|s| {
        s.loss_weights.aggression = 0.0;
    }));
    all.push(networks("Gaussian L5".to_owned(), &|s| {
        s.mutual_information_loss = crate::MutualInformationLoss::GaussianLikelihood;
    }));
    for &window_s in windows_s {
        all.push(networks(format!("window {window_s} s"), &|s| {
            s.window_s = window_s;
        }));
    }
    all.push(networks("without w".to_owned(), &|s| {
        s.embedding_learning_rate = 0.0;
    }));
    let baseline = |name: &str, kind| Variant {
        name: name.to_owned(),
        kind,
    };
    let linear = TrainSettings {
        heads: HeadsKind::Linear,
        ..base.clone()
    };
    all.push(baseline(
        "linear heads",
        VariantKind::Heads(Box::new(linear)),
    ));
    all.push(baseline("linear with w", VariantKind::Linear));
    all.push(baseline("own means", VariantKind::DriverMeans));
    all.push(baseline("own time gap", VariantKind::ConstantTimeGap));
    all
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
        Self {
            folds: 5,
            known_fraction: 2.0 / 3.0,
        }
    }
}

/// What a variant gets wrong on the unseen part of one drive; `None` where it predicts nothing of the kind or the
/// drive has no such row.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct HeldOut {
    /// Root-mean-square error of the following distance, in m, over following rows.
    pub following_distance_m: Option<f64>,
    /// Cross-entropy of starting a lane change, in nats, both classes weighted to one half over the other drivers.
    pub lane_change: Option<f64>,
    /// Root-mean-square error of ego's speed, in m/s.
    pub speed_mps: Option<f64>,
}

/// One variant on every drive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VariantResult {
    /// Its name.
    pub name: String,
    /// Drives in the order given; `None`: too short to be known and judged.
    pub of_each: Vec<Option<HeldOut>>,
}

/// Every variant on the same unseen drives.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Ablated {
    /// The drives, in the order given.
    pub drives: Vec<DriveId>,
    /// The settings.
    pub settings: AblationSettings,
    /// The variants; the first is the one that the others are compared with.
    pub variants: Vec<VariantResult>,
}

/// Holds out each fold of drivers in turn, for every variant.
///
/// All drives of a participant are in one fold, and the folds are the same for all variants. ADB scores teach
/// the networks, but no unseen driver's score is used. `observe` is told how many trainings are done, and of how many.
///
/// # Errors
/// [`ModelError::TooFewDrivers`] unless there are 2 folds or more and a driver for each; [`ModelError::BadSetting`];
/// [`ModelError::Cancelled`] where `observe` broke off; else whatever training or personalising says.
pub fn ablate(
    drives: &[TrainingDrive<'_>],
    variants: &[Variant],
    settings: &AblationSettings,
    personalizing: &PersonalizeParams,
    seed: u64,
    observe: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
) -> Result<Ablated, ModelError> {
    let known = settings.known_fraction;
    if !(known > 0.0 && known < 1.0) {
        return Err(ModelError::BadSetting {
            name: "known_fraction",
            found: known,
            expected: "above 0, below 1",
        });
    }
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
            let judge = Judge::of(&variant.kind, &seen, personalizing, seed)?;
            for ((drive, of_fold), found) in with_folds().zip(&mut of_each) {
                if *of_fold == fold {
                    *found = judge.held_out(drive, known)?;
                }
            }
        }
        results.push(VariantResult {
            name: variant.name.clone(),
            of_each,
        });
    }
    Ok(Ablated {
        drives: drives
            .iter()
            .map(|d| d.drive.meta().drive.clone())
            .collect(),
        settings: settings.clone(),
        variants: results,
    })
}

/// The fold of each drive.
fn folds(drives: &[TrainingDrive<'_>], folds: usize, seed: u64) -> Result<Vec<usize>, ModelError> {
    let participant = |d: &TrainingDrive<'_>| d.drive.meta().participant.clone();
    let drivers: BTreeSet<ParticipantId> = drives.iter().map(participant).collect();
    let mut drivers: Vec<ParticipantId> = drivers.into_iter().collect();
    if folds < 2 || folds > drivers.len() {
        return Err(ModelError::TooFewDrivers {
            drivers: drivers.len(),
            folds,
        });
    }
    let shuffle = stream_seed(seed, &["cross-validate", "folds"]);
    drivers.shuffle(&mut Pcg64Mcg::seed_from_u64(shuffle));
    let place = |d| {
        drivers
            .iter()
            .position(|p| *p == participant(d))
            .unwrap_or(0)
    };
    Ok(drives.iter().map(|d| place(d) % folds).collect())
}

/// What a baseline says of one row: following distance in m, log-odds of a change with the classes balanced, speed in
/// m/s.
#[derive(Debug, Clone, Copy, Default)]
struct Said {
    following_distance_m: Option<f64>,
    log_odds: Option<f64>,
    speed_mps: Option<f64>,
}

/// A baseline that has learned from other drivers.
trait Baseline {
    /// What it says of `unseen` rows of a driver whose `known` rows it has met.
    fn say(&self, known: &[Row], unseen: &[Row]) -> Vec<Said>;
}

/// A variant that has learned from the drivers of the other folds.
enum Judge<'a> {
    Heads {
        model: Box<Model>,
        personalizing: &'a PersonalizeParams,
        rows: RowSettings,
        weights: crate::rows::RowWeights,
    },
    Networks {
        model: Box<Model>,
        personalizing: &'a PersonalizeParams,
        with_embedding: bool,
    },
    Baseline {
        baseline: Box<dyn Baseline>,
        rows: RowSettings,
        weights: crate::rows::RowWeights,
    },
}

impl<'a> Judge<'a> {
    fn of(
        kind: &VariantKind,
        seen: &[TrainingDrive<'_>],
        personalizing: &'a PersonalizeParams,
        seed: u64,
    ) -> Result<Self, ModelError> {
        if let VariantKind::Networks(settings) = kind {
            let mut settings = (**settings).clone();
            // A run that only measures would change nothing here.
            if settings.patience == 0 && settings.refit {
                settings.validation_fraction = 0.0;
            }
            let with_embedding = settings.embedding_learning_rate > 0.0;
            let params = TrainParams::new(settings)?;
            let trained = train(seen, &params, seed, &mut |_| ControlFlow::Continue(()))?;
            return Ok(Self::Networks {
                model: Box::new(trained.model),
                personalizing,
                with_embedding,
            });
        }
        let settings = TrainSettings::default();
        let rows = RowSettings {
            row_rate_hz: settings.row_rate_hz,
            windows: settings.windows(),
        };
        let mut of_each: Vec<Vec<Row>> = Vec::new();
        for drive in seen {
            match rows_of(drive.drive, &rows, 1.0) {
                Ok(rows) => of_each.push(rows),
                Err(ModelError::DriveTooShort { .. }) => {}
                Err(other) => return Err(other),
            }
        }
        let weights = crate::rows::RowWeights::of(of_each.iter().flatten());
        if let VariantKind::Heads(settings) = kind {
            let params = TrainParams::new((**settings).clone())?;
            let trained = train(seen, &params, seed, &mut |_| ControlFlow::Continue(()))?;
            return Ok(Self::Heads {
                model: Box::new(trained.model),
                personalizing,
                rows,
                weights,
            });
        }
        let baseline: Box<dyn Baseline> = match kind {
            VariantKind::ConstantTimeGap => Box::new(ConstantTimeGap::of(&of_each)),
            VariantKind::Linear => Box::new(LinearModel::of(&of_each, weights)),
            VariantKind::DriverMeans | VariantKind::Networks(_) | VariantKind::Heads(_) => {
                Box::new(DriverMeans::of(&of_each, weights))
            }
        };
        Ok(Self::Baseline {
            baseline,
            rows,
            weights,
        })
    }

    /// The errors on the part of the drive after the known share; `None` if there is nothing to know or to judge by.
    fn held_out(
        &self,
        drive: &TrainingDrive<'_>,
        known: f64,
    ) -> Result<Option<HeldOut>, ModelError> {
        let drive = drive.drive;
        let settings = match self {
            Self::Networks { model, .. } => model.paper()?.row_settings(),
            Self::Heads { rows, .. } | Self::Baseline { rows, .. } => *rows,
        };
        let rows = match rows_of(drive, &settings, 1.0) {
            Err(ModelError::DriveTooShort { .. }) => return Ok(None),
            other => other?,
        };
        let grid: Vec<usize> = (0..rows.len()).filter(|&i| rows[i].on_grid).collect();
        let first = (known * grid.len() as f64).floor() as usize;
        if first == 0 || first >= grid.len() {
            return Ok(None);
        }
        let known_share = known;
        let (known, unseen) = rows.split_at(grid[first]);
        Ok(Some(match self {
            Self::Heads {
                model,
                personalizing,
                weights,
                ..
            } => {
                let personalizer = Personalizer::new(model, (*personalizing).clone());
                let shown = personalizer.shown(drive, known_share)?;
                let id = &drive.meta().drive;
                let embedding = match personalizer.fit_shown(id, &shown, None) {
                    Ok(fit) => fit.embedding,
                    Err(ModelError::NoHabits { .. }) => model.mean_embedding().clone(),
                    Err(other) => return Err(other),
                };
                judged(
                    &said(&Habits::new(model, &embedding)?, unseen),
                    unseen,
                    weights,
                )
            }
            Self::Networks {
                model,
                personalizing,
                with_embedding,
            } => {
                let paper = model.paper()?;
                let embedding = if *with_embedding {
                    Personalizer::new(model, (*personalizing).clone())
                        .fit_shown(&drive.meta().drive, &Shown::Rows(known.to_vec()), None)?
                        .embedding
                } else {
                    model.mean_embedding().clone()
                };
                let unseen = NetworkRows::new(paper, unseen, None);
                let [distance, change, speed] = unseen.losses(embedding.coordinates());
                let root = |loss: Option<f64>, sd: f64| loss.map(|l| l.sqrt() * sd);
                let scaling = paper.scaling();
                HeldOut {
                    following_distance_m: root(distance, scaling.following_distance.sd),
                    lane_change: change,
                    speed_mps: root(speed, scaling.signals[0].sd),
                }
            }
            Self::Baseline {
                baseline, weights, ..
            } => judged(&baseline.say(known, unseen), unseen, weights),
        }))
    }
}

/// What a driver's habits say of rows: the own gap while following, and the own free speed or, behind somebody nearer than that
/// gap, theirs.
fn said(habits: &Habits, rows: &[Row]) -> Vec<Said> {
    let free_mps = habits.free_speed_mps();
    let gap_m = |lead_mps: f64| Some(habits.following_gap_s(free_mps?, lead_mps)? * lead_mps);
    let of = |row: &Row| Said {
        following_distance_m: gap_m(row.lead_speed_mps),
        log_odds: None,
        speed_mps: free_mps.map(|v| match row.following_distance_m {
            Some(_) => v.min(row.lead_speed_mps),
            None => v,
        }),
    };
    rows.iter().map(of).collect()
}

/// The errors of what was said of `rows`.
fn judged(said: &[Said], rows: &[Row], weights: &crate::rows::RowWeights) -> HeldOut {
    let mut sums = [(0.0, 0.0); 3];
    for (said, row) in said.iter().zip(rows) {
        let [following, change, grid, _] = weights.of_row(row);
        let squared = |a: Option<f64>, b: Option<f64>| Some((a? - b?).powi(2));
        let surprise = said.log_odds.zip(row.lane_change).map(|(odds, change)| {
            let against = if change { -odds } else { odds };
            against.max(0.0) + (-against.abs()).exp().ln_1p()
        });
        let losses = [
            (
                squared(said.following_distance_m, row.following_distance_m),
                following,
            ),
            (surprise, change),
            (squared(said.speed_mps, Some(row.ego_speed_mps)), grid),
        ];
        for (sum, (loss, weight)) in sums.iter_mut().zip(losses) {
            if let Some(loss) = loss.filter(|_| weight > 0.0) {
                sum.0 += weight * loss;
                sum.1 += weight;
            }
        }
    }
    let [following, change, speed] =
        sums.map(|(loss, weight)| (weight > 0.0).then(|| loss / weight));
    HeldOut {
        following_distance_m: following.map(f64::sqrt),
        lane_change: change,
        speed_mps: speed.map(f64::sqrt),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_drives::drivers;

    #[test]
    fn every_drive_is_unseen_once_and_own_means_know_the_driver() {
        let drives = drivers(6, 150.0);
        let given: Vec<_> = drives
            .iter()
            .map(|(drive, adb)| TrainingDrive {
                drive,
                adb: Some(*adb),
            })
            .collect();
        let base = TrainSettings {
            epochs: 6,
            batch_size: 128,
            validation_fraction: 0.0,
            ..TrainSettings::default()
        };
        let all = variants(&base, &[2], &[]);
        let names: Vec<&str> = all.iter().map(|v| v.name.as_str()).collect();
        assert_eq!(names[..2], ["size 3", "size 2"]);
        let chosen: Vec<Variant> = [
            "size 3",
            "without w",
            "linear with w",
            "own means",
            "own time gap",
            "linear heads",
        ]
        .iter()
        .map(|name| all.iter().find(|v| v.name == *name).unwrap().clone())
        .collect();
        let settings = AblationSettings {
            folds: 3,
            ..AblationSettings::default()
        };
        let mut steps = Vec::new();
        let mut observe = |done, all| {
            steps.push((done, all));
            ControlFlow::Continue(())
        };
        let params = PersonalizeParams::default();
        let found = ablate(&given, &chosen, &settings, &params, 1, &mut observe).unwrap();
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
        let stopped = ablate(&given, &chosen, &settings, &params, 1, &mut none);
        assert!(matches!(stopped, Err(ModelError::Cancelled { .. })));
        let settings = AblationSettings {
            folds: 7,
            ..settings
        };
        let refused = ablate(&given, &chosen, &settings, &params, 1, &mut none);
        assert!(matches!(refused, Err(ModelError::TooFewDrivers { .. })));
    }
}
