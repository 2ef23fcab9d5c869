//! The rows of all training drives, standardised and weighted.

use crate::{
    epochs::{TrainingDrive, check_drivers},
    error::{ModelError, ModelWarning},
    fused::tile::{Known, Tile},
    losses::{Loss, LossWeights},
    on_range::range_of,
    paper::Learned,
    params::TrainSettings,
    rows::{Row, RowWeights, left_out, now, rows_of},
    scaling::{Scaling, Standardization},
    windows::SIGNALS,
};
use maveric_domain::{DriveId, ScoreRange, StyleScore};
use rayon::prelude::*;

/// Rows of drives, standardised.
#[derive(Debug, Default)]
pub(crate) struct RowSet {
    /// Drive of each row, shape `(n,)`.
    pub(crate) drive_of: Vec<u32>,
    /// Shape `(n, 4 × steps)`.
    windows: Vec<f32>,
    known: Vec<Known>,
}

impl RowSet {
    /// Adds a row of the drive with that number; `weights` are those in L1, L2, L3 and L5.
    pub(crate) fn push(&mut self, drive: usize, row: &Row, scaling: &Scaling, weights: [f64; 4]) {
        let [ego, lead, ..] = scaling.signals;
        let steps = row.window.len() / SIGNALS;
        let signals = row.window.chunks_exact(steps).zip(&scaling.signals);
        let values = signals.flat_map(|(v, s)| v.iter().map(|&v| s.apply(v) as f32));
        self.drive_of.push(drive as u32);
        self.windows.extend(values);
        let distance = row.following_distance_m;
        self.known.push(Known {
            values: [
                lead.apply(row.lead_speed_mps) as f32,
                distance.map_or(0.0, |d| scaling.following_distance.apply(d)) as f32,
                f32::from(u8::from(row.lane_change == Some(true))),
                ego.apply(row.ego_speed_mps) as f32,
            ],
            weights: weights.map(|w| w as f32),
        });
    }

    pub(crate) fn len(&self) -> usize {
        self.drive_of.len()
    }

    /// Numbers in a window, 4 × steps.
    pub(crate) fn window_numbers(&self) -> usize {
        self.windows.len() / self.len().max(1)
    }

    /// Brings rows into a tile as they are.
    pub(crate) fn fill(&self, rows: impl Iterator<Item = usize>, tile: &mut Tile) {
        let numbers = self.window_numbers();
        for (index, row) in rows.enumerate() {
            let window = &self.windows[row * numbers..][..numbers];
            tile.windows.row_mut(index)[..numbers].copy_from_slice(window);
            tile.known[index] = self.known[row];
        }
    }
}

/// The training rows, and what is known of each drive.
pub(crate) struct Data {
    pub(crate) drives: Vec<DriveId>,
    /// The same as they are, drive by drive.
    pub(crate) rows_of_each: Vec<Vec<Row>>,
    pub(crate) score_range: ScoreRange,
    /// The standardised score.
    pub(crate) adb: Vec<Option<f32>>,
    pub(crate) mean_speed_mps: Vec<f64>,
    pub(crate) rows: RowSet,
    pub(crate) scaling: Scaling,
    pub(crate) row_weights: RowWeights,
    pub(crate) speed_range_mps: [f64; 2],
    pub(crate) learned: Learned,
    pub(crate) warnings: Vec<ModelWarning>,
    pub(crate) left_out: Vec<(Loss, &'static str)>,
}

impl Data {
    /// The rows of the drives.
    pub(crate) fn new(
        given: &[TrainingDrive<'_>],
        settings: &TrainSettings,
    ) -> Result<Self, ModelError> {
        let row_settings = settings.row_settings();
        let rows_of_each: Vec<_> = given
            .par_iter()
            .map(|d| rows_of(d.drive, &row_settings, settings.fit_fraction))
            .collect();
        let mut warnings = Vec::new();
        let (mut used, mut rows_used) = (Vec::new(), Vec::new());
        for (drive, rows) in given.iter().zip(rows_of_each) {
            match rows {
                Ok(rows) => {
                    used.push(drive);
                    rows_used.push(rows);
                }
                Err(error) => warnings.push(left_out(&error).ok_or(error)?),
            }
        }
        check_drivers(&used, given.len(), &mut warnings)?;
        let mut data = Self::standardized(&used, rows_used, range_of(given)?, warnings);
        data.note_losses_without_data(&settings.loss_weights);
        Ok(data)
    }

    fn standardized(
        used: &[&TrainingDrive<'_>],
        rows_of_each: Vec<Vec<Row>>,
        score_range: ScoreRange,
        warnings: Vec<ModelWarning>,
    ) -> Self {
        let all_rows = || rows_of_each.iter().flatten();
        let grid = || all_rows().filter(|row| row.on_grid);
        let scores = || used.iter().filter_map(|d| d.adb.map(StyleScore::points));
        let scaling = Scaling {
            signals: std::array::from_fn(|s| {
                Standardization::from_values(grid().map(|row| now(row, s)))
            }),
            following_distance: Standardization::from_values(
                all_rows().filter_map(|row| row.following_distance_m),
            ),
            aggression: Standardization::from_values(scores()),
        };
        let row_weights = RowWeights::from_rows(all_rows());
        // Over all rows, grid or not, the mean weight in L3 is 1: a batch is drawn from them all.
        let level = all_rows().count() as f64 / grid().count().max(1) as f64;
        let mut rows = RowSet::default();
        for (index, of_drive) in rows_of_each.iter().enumerate() {
            for row in of_drive {
                rows.push(index, row, &scaling, row_weights.of_row(row).map(|w| w * level));
            }
        }
        let speeds = || grid().map(|row| row.ego_speed_mps);
        let mean_speed = |rows: &Vec<Row>| {
            Standardization::from_values(rows.iter().filter(|r| r.on_grid).map(|r| r.ego_speed_mps))
                .mean
        };
        let first = scores().next();
        let scores_differ =
            scores().any(|s| first.is_some_and(|first| (s - first).abs() > f64::EPSILON));
        Self {
            drives: used.iter().map(|d| d.drive.meta().drive.clone()).collect(),
            score_range,
            adb: used
                .iter()
                .map(|d| Some(scaling.aggression.apply(d.adb?.points()) as f32))
                .collect(),
            mean_speed_mps: rows_of_each.iter().map(mean_speed).collect(),
            speed_range_mps: [
                speeds().fold(f64::INFINITY, f64::min),
                speeds().fold(f64::NEG_INFINITY, f64::max),
            ],
            learned: Learned {
                following_distance: row_weights.following > 0.0,
                lane_change: row_weights.changing > 0.0,
                aggression: scores_differ,
            },
            rows,
            rows_of_each,
            scaling,
            row_weights,
            warnings,
            left_out: Vec::new(),
        }
    }

    /// How many rows are as asked.
    pub(crate) fn count(&self, which: impl Fn(&Row) -> bool) -> usize {
        self.rows_of_each.iter().flatten().filter(|r| which(r)).count()
    }

    /// The weights, 0 where a loss has no data.
    pub(crate) fn active_weights(&self, weights: &LossWeights) -> LossWeights {
        let keep = |weight: f64, learned: bool| if learned { weight } else { 0.0 };
        let learned = self.learned;
        LossWeights {
            following_distance: keep(weights.following_distance, learned.following_distance),
            lane_change: keep(weights.lane_change, learned.lane_change),
            aggression: keep(weights.aggression, learned.aggression),
            ..*weights
        }
    }

    fn note_losses_without_data(&mut self, weights: &LossWeights) {
        let known = [
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
            (Loss::Velocity, true, ""),
            (
                Loss::Aggression,
                self.learned.aggression,
                "no two drives have different scores of the style",
            ),
            (Loss::MutualInformation, true, ""),
        ];
        for ((loss, learned, reason), (_, weight)) in known.into_iter().zip(weights.named()) {
            if !learned {
                self.left_out.push((loss, reason));
            } else if weight <= 0.0 {
                self.left_out.push((loss, "its weight is 0"));
            }
        }
        let warnings = self.left_out.iter();
        self.warnings
            .extend(warnings.map(|&(loss, reason)| ModelWarning::LossLeftOut { loss, reason }));
    }
}
