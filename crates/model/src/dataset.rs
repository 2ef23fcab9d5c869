//! The rows of all training drives, standardised and weighted.

use crate::{
    error::{ModelError, ModelWarning},
    losses::{Loss, LossWeights},
    model::Learned,
    params::TrainSettings,
    rows::{Row, RowSettings, RowWeights, left_out, now, rows_of},
    scaling::{Scaling, Standardization},
    train::{EpochReport, TrainingDrive, TrainingReport},
    windows::SIGNALS,
};
use maveric_domain::{AdbScore, DriveId};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// The training rows, standardised, and what is known of each drive.
pub(crate) struct Data {
    pub(crate) drives: Vec<DriveId>,
    /// Standardised ADB.
    pub(crate) adb: Vec<Option<f32>>,
    pub(crate) mean_speed_mps: Vec<f64>,
    /// Drive of each row, shape `(n,)`.
    pub(crate) drive_of: Vec<u32>,
    /// Shape `(n, 4 × steps)`.
    pub(crate) windows: Vec<f32>,
    /// v_lead, then the targets of F, C and V; shape `(n, 4)`.
    pub(crate) values: Vec<[f32; 4]>,
    /// Weights in L1, L2, L3 and L5, mean 1 over rows in L3; shape `(n, 4)`.
    pub(crate) weights: Vec<[f32; 4]>,
    pub(crate) scaling: Scaling,
    pub(crate) row_weights: RowWeights,
    pub(crate) speed_range_mps: [f64; 2],
    pub(crate) learned: Learned,
    pub(crate) warnings: Vec<ModelWarning>,
    pub(crate) left_out: Vec<(Loss, &'static str)>,
    pub(crate) embedding_size: usize,
    pub(crate) following_rows: usize,
    pub(crate) lane_change_rows: usize,
}

impl Data {
    pub(crate) fn new(
        given: &[TrainingDrive<'_>],
        settings: &TrainSettings,
    ) -> Result<Self, ModelError> {
        let mut seen = BTreeSet::new();
        for drive in given.iter().map(|d| &d.drive.meta().drive) {
            if !seen.insert(drive) {
                return Err(ModelError::DuplicateDrive {
                    drive: drive.clone(),
                });
            }
        }
        let row_settings = RowSettings {
            row_rate_hz: settings.row_rate_hz,
            windows: settings.windows(),
        };
        let rows_of_each: Vec<_> = given
            .par_iter()
            .map(|d| rows_of(d.drive, &row_settings, settings.fit_fraction))
            .collect();
        let mut warnings = Vec::new();
        let mut used: Vec<(&TrainingDrive<'_>, Vec<Row>)> = Vec::new();
        for (drive, rows) in given.iter().zip(rows_of_each) {
            match rows {
                Ok(rows) => used.push((drive, rows)),
                Err(error) => warnings.push(left_out(&error).ok_or(error)?),
            }
        }
        if used.is_empty() {
            return Err(ModelError::NoDrives {
                given: given.len(),
                excluded: warnings.len(),
            });
        }
        let mut data = Self::standardized(&used);
        data.embedding_size = settings.embedding_size;
        data.warnings = warnings;
        data.note_losses_without_data(&settings.loss_weights);
        Ok(data)
    }

    fn standardized(used: &[(&TrainingDrive<'_>, Vec<Row>)]) -> Self {
        let all = || used.iter().flat_map(|(_, rows)| rows);
        let grid = || all().filter(|row| row.on_grid);
        let scores = || used.iter().filter_map(|(d, _)| d.adb.map(AdbScore::points));
        let scaling = Scaling {
            signals: std::array::from_fn(|s| Standardization::of(grid().map(|row| now(row, s)))),
            following_distance: Standardization::of(
                all().filter_map(|row| row.following_distance_m),
            ),
            aggression: Standardization::of(scores()),
        };
        let row_weights = RowWeights::of(all());
        let [ego, lead, ..] = scaling.signals;
        // Over all rows, grid or not, the mean weight in L3 is 1: a batch is drawn from them all.
        let level = all().count() as f64 / grid().count().max(1) as f64;
        let mut windows = Vec::new();
        for row in all() {
            let steps = row.window.len() / SIGNALS;
            let signals = row.window.chunks_exact(steps).zip(&scaling.signals);
            windows.extend(signals.flat_map(|(v, s)| v.iter().map(|&v| s.apply(v) as f32)));
        }
        let values = all().map(|row| {
            let distance = row.following_distance_m;
            [
                lead.apply(row.lead_speed_mps) as f32,
                distance.map_or(0.0, |d| scaling.following_distance.apply(d)) as f32,
                f32::from(u8::from(row.lane_change == Some(true))),
                ego.apply(row.ego_speed_mps) as f32,
            ]
        });
        let weights = all().map(|row| row_weights.of_row(row).map(|w| (w * level) as f32));
        let speeds = || grid().map(|row| row.ego_speed_mps);
        let mean_speed = |rows: &[Row]| {
            Standardization::of(rows.iter().filter(|r| r.on_grid).map(|r| r.ego_speed_mps)).mean
        };
        let drive_of = used
            .iter()
            .enumerate()
            .flat_map(|(index, (_, rows))| std::iter::repeat_n(index as u32, rows.len()));
        Self {
            drives: used
                .iter()
                .map(|(d, _)| d.drive.meta().drive.clone())
                .collect(),
            adb: used
                .iter()
                .map(|(d, _)| Some(scaling.aggression.apply(d.adb?.points()) as f32))
                .collect(),
            mean_speed_mps: used.iter().map(|(_, rows)| mean_speed(rows)).collect(),
            drive_of: drive_of.collect(),
            windows,
            values: values.collect(),
            weights: weights.collect(),
            speed_range_mps: [
                speeds().fold(f64::INFINITY, f64::min),
                speeds().fold(f64::NEG_INFINITY, f64::max),
            ],
            learned: Learned {
                following_distance: row_weights.following > 0.0,
                lane_change: row_weights.changing > 0.0,
                aggression: scores().next().is_some(),
            },
            following_rows: all().filter(|r| r.following_distance_m.is_some()).count(),
            lane_change_rows: all().filter(|r| r.lane_change == Some(true)).count(),
            scaling,
            row_weights,
            warnings: Vec::new(),
            left_out: Vec::new(),
            embedding_size: 0,
        }
    }

    fn note_losses_without_data(&mut self, weights: &LossWeights) {
        let reasons = [
            (
                Loss::FollowingDistance,
                self.learned.following_distance,
                "no row at which a driver follows",
            ),
            (
                Loss::LaneChange,
                self.learned.lane_change,
                "no row at which a lane change is being started, or no other row",
            ),
            (
                Loss::Aggression,
                self.learned.aggression,
                "no drive has an ADB score",
            ),
        ];
        let without_data = reasons.into_iter().filter(|(_, learned, _)| !learned);
        self.left_out
            .extend(without_data.map(|(loss, _, reason)| (loss, reason)));
        let losses = [
            Loss::FollowingDistance,
            Loss::LaneChange,
            Loss::Velocity,
            Loss::Aggression,
            Loss::MutualInformation,
        ];
        for (loss, (_, weight)) in losses.into_iter().zip(weights.named()) {
            if weight <= 0.0 && !self.left_out.iter().any(|(l, _)| *l == loss) {
                self.left_out.push((loss, "its weight is 0"));
            }
        }
        let warnings = self.left_out.iter();
        self.warnings
            .extend(warnings.map(|&(loss, reason)| ModelWarning::LossLeftOut { loss, reason }));
    }

    /// Numbers in a window, 4 × steps.
    pub(crate) fn window_numbers(&self) -> usize {
        self.windows.len() / self.rows().max(1)
    }

    pub(crate) fn rows(&self) -> usize {
        self.drive_of.len()
    }

    pub(crate) fn report(self, epochs: Vec<EpochReport>, parameters: usize) -> TrainingReport {
        TrainingReport {
            epochs,
            rows: self.rows(),
            left_out: self.left_out,
            warnings: self.warnings,
            drives: self.drives.len(),
            drives_with_adb: self.adb.iter().flatten().count(),
            following_rows: self.following_rows,
            lane_change_rows: self.lane_change_rows,
            parameters,
        }
    }
}
