//! The rows of all training drives, standardised and weighted.

use crate::{
    error::{ModelError, ModelWarning},
    losses::{Loss, LossWeights},
    paper::Learned,
    params::TrainSettings,
    rows::{Row, RowSettings, RowWeights, left_out, now, rows_of},
    scaling::{Scaling, Standardization},
    train::TrainingDrive,
    windows::SIGNALS,
};
use maveric_domain::{AdbScore, DriveId};
use rayon::prelude::*;

/// Rows of all drives, standardised.
#[derive(Debug, Default)]
pub(crate) struct RowSet {
    /// Drive of each row, shape `(n,)`.
    pub(crate) drive_of: Vec<u32>,
    /// Shape `(n, 4 × steps)`.
    pub(crate) windows: Vec<f32>,
    /// v_lead, then the targets of F, C and V; shape `(n, 4)`.
    pub(crate) values: Vec<[f32; 4]>,
    /// Weights in L1, L2, L3 and L5; over the training rows those in L3 have mean 1. Shape `(n, 4)`.
    pub(crate) weights: Vec<[f32; 4]>,
    /// Time each row stands for in L2, in s; 0 where nobody asks whether a change is being started.
    pub(crate) seconds: Vec<f32>,
}

impl RowSet {
    fn push(&mut self, drive: usize, row: &Row, scaling: &Scaling, weights: [f64; 4]) {
        let [ego, lead, ..] = scaling.signals;
        let steps = row.window.len() / SIGNALS;
        let signals = row.window.chunks_exact(steps).zip(&scaling.signals);
        let values = signals.flat_map(|(v, s)| v.iter().map(|&v| s.apply(v) as f32));
        self.drive_of.push(drive as u32);
        self.windows.extend(values);
        let distance = row.following_distance_m;
        self.values.push([
            lead.apply(row.lead_speed_mps) as f32,
            distance.map_or(0.0, |d| scaling.following_distance.apply(d)) as f32,
            f32::from(u8::from(row.lane_change == Some(true))),
            ego.apply(row.ego_speed_mps) as f32,
        ]);
        self.weights.push(weights.map(|w| w as f32));
        let seconds = row.lane_change.map_or(0.0, |_| row.stands_for_s);
        self.seconds.push(seconds as f32);
    }

    pub(crate) fn len(&self) -> usize {
        self.drive_of.len()
    }

    /// Numbers in a window, 4 × steps.
    pub(crate) fn window_numbers(&self) -> usize {
        self.windows.len() / self.len().max(1)
    }
}

/// The training rows, those kept back, and what is known of each drive.
pub(crate) struct Data {
    pub(crate) drives: Vec<DriveId>,
    /// Standardised ADB.
    pub(crate) adb: Vec<Option<f32>>,
    pub(crate) mean_speed_mps: Vec<f64>,
    pub(crate) training: RowSet,
    /// The last rows of every drive, where some are kept back; means and SDs know nothing of them.
    pub(crate) validation: RowSet,
    pub(crate) scaling: Scaling,
    pub(crate) row_weights: RowWeights,
    pub(crate) speed_range_mps: [f64; 2],
    pub(crate) learned: Learned,
    pub(crate) warnings: Vec<ModelWarning>,
    pub(crate) left_out: Vec<(Loss, &'static str)>,
    pub(crate) following_rows: usize,
    pub(crate) lane_change_rows: usize,
}

impl Data {
    /// The rows of the drives; the last `kept_back` of each are for validation.
    pub(crate) fn new(
        given: &[TrainingDrive<'_>],
        settings: &TrainSettings,
        kept_back: f64,
    ) -> Result<Self, ModelError> {
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
        let mut data = Self::standardized(&used, kept_back);
        data.warnings = warnings;
        let participants = || used.iter().map(|(d, _)| &d.drive.meta().participant);
        if let Some(participant) = participants().next()
            && participants().all(|p| p == participant)
        {
            data.warnings.push(ModelWarning::OneDriver {
                participant: participant.clone(),
            });
        }
        data.note_losses_without_data(&settings.loss_weights);
        Ok(data)
    }

    fn standardized(used: &[(&TrainingDrive<'_>, Vec<Row>)], kept_back: f64) -> Self {
        // At least one row of every drive is learned from.
        let learned = |rows: &[Row]| {
            let kept = (kept_back * rows.len() as f64).round() as usize;
            rows.len() - kept.min(rows.len().saturating_sub(1))
        };
        let all = || used.iter().flat_map(|(_, rows)| &rows[..learned(rows)]);
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
        // Over all rows, grid or not, the mean weight in L3 is 1: a batch is drawn from them all.
        let level = all().count() as f64 / grid().count().max(1) as f64;
        let mut training = RowSet::default();
        let mut validation = RowSet::default();
        for (index, (_, rows)) in used.iter().enumerate() {
            let first_kept = learned(rows);
            for (at, row) in rows.iter().enumerate() {
                let to = if at < first_kept {
                    &mut training
                } else {
                    &mut validation
                };
                let weights = row_weights.of_row(row).map(|w| w * level);
                to.push(index, row, &scaling, weights);
            }
        }
        let speeds = || grid().map(|row| row.ego_speed_mps);
        let mean_speed = |rows: &[Row]| {
            Standardization::of(rows.iter().filter(|r| r.on_grid).map(|r| r.ego_speed_mps)).mean
        };
        let mut first_score = None;
        let scores_differ =
            scores().any(|s| (s - *first_score.get_or_insert(s)).abs() > f64::EPSILON);
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
            speed_range_mps: [
                speeds().fold(f64::INFINITY, f64::min),
                speeds().fold(f64::NEG_INFINITY, f64::max),
            ],
            learned: Learned {
                following_distance: row_weights.following > 0.0,
                lane_change: row_weights.changing > 0.0,
                aggression: scores_differ,
            },
            following_rows: all().filter(|r| r.following_distance_m.is_some()).count(),
            lane_change_rows: all().filter(|r| r.lane_change == Some(true)).count(),
            training,
            validation,
            scaling,
            row_weights,
            warnings: Vec::new(),
            left_out: Vec::new(),
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
                "no two drives have different ADB scores",
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
}
