//! The paper's losses over one driver's rows as a function of `w`, by the training kernel with its weights at rest.
//!
//! Every block of time is a driver of its own to the kernel, all at the same `w`: its gradients by the embeddings are then the slopes
//! of the blocks, of whose disagreement the covariance is made.

use crate::{
    bfgs::{Evaluated, minimise},
    dataset::RowSet,
    fused::{
        batch::{At, Batches},
        matrix::Aligned,
    },
    heads::Posterior,
    held_out::Said,
    linear_algebra::{dot, of_symmetric},
    losses::{Reading, Sums},
    paper::PaperNetworks,
    rows::Row,
};
use nalgebra::{DMatrix, DVector};
use pulp::Arch;

/// Length of the blocks of time that the covariance takes as independent, in s.
const BLOCK_S: f64 = 30.0;
/// Steps of BFGS at most; it takes about ten.
const STEPS: usize = 60;
/// Half the distance over which slopes are compared for the curvature, in SDs of drivers.
const HALF: f64 = 0.1;
/// Least curvature in a direction, as a share of the largest: between kinks of ReLUs it may seem to be less.
const FLAT: f64 = 1e-3;
/// Variance of styles over drivers: no direction is left more open by a drive than before it.
const AMONG_DRIVERS: f64 = 1.0;
/// Log-odds of a probability that an `f32` cannot tell from 0 or 1.
const SUREST: f64 = 30.0;

/// One driver's rows as the kernel reads them.
#[derive(Debug)]
pub(crate) struct NetworkRows<'a> {
    paper: &'a PaperNetworks,
    kernel: Batches,
    packed: Aligned,
    rows: RowSet,
    blocks: usize,
    grid_rows: f64,
    /// A score to read too, in points.
    points: Option<f64>,
}

impl<'a> NetworkRows<'a> {
    /// Takes `rows`, at least one; `points` is a score to read too.
    pub(crate) fn new(paper: &'a PaperNetworks, rows: &[Row], points: Option<f64>) -> Self {
        let of_block = ((BLOCK_S * paper.row_rate_hz).round() as usize).max(1);
        let (mut set, mut grid) = (RowSet::default(), 0_usize);
        for row in rows {
            grid += usize::from(row.on_grid);
            let block = grid.saturating_sub(1) / of_block;
            set.push(block, row, &paper.scaling, paper.row_weights.of_row(row));
        }
        let blocks = grid.saturating_sub(1) / of_block + 1;
        let kernel = Batches::new(Arch::new(), &paper.networks(), blocks, rows.len());
        Self {
            packed: kernel.layout.pack(&paper.parameters),
            kernel,
            paper,
            rows: set,
            blocks,
            grid_rows: grid.max(1) as f64,
            points,
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    /// The losses of the rows at a style, and what it says of each.
    pub(crate) fn say(&mut self, w: &[f64]) -> (Sums, Vec<Said>) {
        let embeddings = self.everywhere(w);
        let (scaling, learned) = (self.paper.scaling, self.paper.learned);
        let (kernel, rows, point) = self.at(&embeddings);
        let (sums, predicted) = kernel.predict(
            &point,
            rows.len(),
            |row| rows.drive_of[row],
            |tile, range| rows.fill(range, tile),
        );
        let predictions = predicted.iter().map(|p| {
            let distance = scaling.following_distance.undo(f64::from(p.following_distance));
            let odds = libm::log(f64::from(p.probability) / (1.0 - f64::from(p.probability)));
            Said {
                following_distance_m: learned.following_distance.then_some(distance),
                log_odds: learned.lane_change.then(|| odds.clamp(-SUREST, SUREST)),
                speed_mps: Some(scaling.signals[0].undo(f64::from(p.speed))),
            }
        });
        (sums, predictions.collect())
    }

    /// The minimum from `from` on.
    pub(crate) fn minimum(&mut self, from: &[f64]) -> DVector<f64> {
        let start = DVector::from_column_slice(from);
        minimise(|w| self.evaluate(w).0, start, STEPS)
    }

    /// The minimum, with the covariance of its place where the drive is long enough to tell.
    pub(crate) fn solve(&mut self, from: &[f64]) -> Posterior {
        let mean = self.minimum(from);
        let covariance = self.covariance(&mean);
        Posterior {
            mean: mean.iter().copied().collect(),
            covariance: covariance.map_or_else(Vec::new, |c| c.iter().copied().collect()),
        }
    }

    /// Curvature⁻¹ · scatter of the blocks' slopes · curvature⁻¹ at a minimum; of a direction that the drive says nothing of,
    /// what drivers differ by.
    fn covariance(&mut self, minimum: &DVector<f64>) -> Option<DMatrix<f64>> {
        let d = minimum.len();
        let mut curvature = DMatrix::zeros(d, d);
        for i in 0..d {
            let mut slope = |by: f64| {
                let mut moved = minimum.clone();
                moved[i] += by;
                self.evaluate(&moved).0.gradient
            };
            let rise = (slope(HALF) - slope(-HALF)) / (2.0 * HALF);
            curvature.set_column(i, &rise);
        }
        let curvature = 0.5 * (&curvature + curvature.transpose());
        let least = FLAT * curvature.symmetric_eigenvalues().max();
        if self.blocks <= d + 1 || least <= 0.0 {
            return None;
        }
        let inverse = of_symmetric(&curvature, |v| 1.0 / v.max(least));
        let slopes = self.evaluate(minimum).1;
        let covariance = &inverse * &slopes * slopes.transpose() * &inverse;
        Some(of_symmetric(&covariance, |v| v.min(AMONG_DRIVERS)))
    }

    /// The weighted sum of the losses with its slope, and the slope of each block's part, shape `(d, blocks)`.
    pub(crate) fn evaluate(&mut self, w: &DVector<f64>) -> (Evaluated, DMatrix<f64>) {
        let embeddings = self.everywhere(w.as_slice());
        let (grid_rows, blocks) = (self.grid_rows, self.blocks);
        let (kernel, rows, point) = self.at(&embeddings);
        let sums = kernel.evaluate(
            &point,
            rows.len(),
            |row| rows.drive_of[row],
            |tile, range| rows.fill(range, tile),
        );
        let scale = rows.len() as f64 / grid_rows;
        let by_raw = kernel.embedding_gradient.iter().map(|&g| scale * f64::from(g));
        let by_raw = DMatrix::from_iterator(w.len(), blocks, by_raw);
        let slopes = self.paper.whitening.root() * by_raw;
        let weights = &self.paper.loss_weights;
        let mut there =
            Evaluated { value: sums.weighted(weights) / grid_rows, gradient: slopes.column_sum() };
        if let Some(points) = self.points {
            let (gradient, offset) = self.paper.style_points();
            let sd = self.paper.scaling.aggression.sd;
            let error = (offset + dot(&gradient, w.as_slice()) - points) / sd;
            there.value += weights.aggression * error * error;
            there.gradient += DVector::from_vec(gradient) * (2.0 * weights.aggression * error / sd);
        }
        (there, slopes)
    }

    /// The same `w` for every block, in the coordinates of training.
    fn everywhere(&self, w: &[f64]) -> Vec<f32> {
        let raw = self.paper.whitening.undo(w);
        let raw: Vec<f32> = raw.iter().map(|&x| x as f32).collect();
        raw.repeat(self.blocks)
    }

    /// What the kernel is evaluated at; L5 in expectation over M's sample.
    fn at<'s>(&'s mut self, embeddings: &'s [f32]) -> (&'s mut Batches, &'s RowSet, At<'s>) {
        let point = At {
            packed: &self.packed,
            embeddings,
            weights: self.paper.loss_weights,
            reading: Reading::Expected,
        };
        (&mut self.kernel, &self.rows, point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        heads_kind::HeadsKind, params::TrainSettings, rows::rows_of, test_drives::drivers,
        train::tests::trained,
    };

    #[test]
    fn the_slope_is_that_of_the_value_and_the_minimum_is_one() {
        let drives = drivers(3, 180.0);
        let settings = TrainSettings {
            heads: HeadsKind::Paper,
            epochs: 6,
            batch_size: 64,
            validation_fraction: 0.0,
            ..TrainSettings::default()
        };
        let model = trained(&drives, &settings);
        let paper = model.paper().unwrap();
        let rows = rows_of(&drives[0].0, &paper.row_settings(), 1.0).unwrap();
        let mut rows = NetworkRows::new(paper, &rows, Some(30.0));
        let at = DVector::from_vec(vec![0.2, -0.3, 0.4]);
        let h = 1e-3;
        let (there, blocks) = rows.evaluate(&at);
        assert_eq!(blocks.ncols(), 6);
        for i in 0..3 {
            let mut value = |by: f64| {
                let mut w = at.clone();
                w[i] += by;
                rows.evaluate(&w).0.value
            };
            let slope = (value(h) - value(-h)) / (2.0 * h);
            assert!(
                (there.gradient[i] - slope).abs() < 0.02 * (1.0 + slope.abs()),
                "{slope} {there:?}"
            );
        }
        let from = model.mean_embedding().coordinates();
        let found = rows.solve(from);
        let mut value = |w: &[f64]| rows.evaluate(&DVector::from_column_slice(w)).0.value;
        let lowest = value(&found.mean);
        assert!(lowest < value(from));
        for i in 0..3 {
            for by in [-0.05, 0.05] {
                let mut w = found.mean.clone();
                w[i] += by;
                assert!(value(&w) > lowest - 1e-4);
            }
        }
        // Six blocks tell, two do not.
        assert_eq!(found.covariance.len(), 9);
        let covariance = DMatrix::from_column_slice(3, 3, &found.covariance);
        let left_open = covariance.symmetric_eigenvalues();
        assert!(left_open.min() > 0.0 && left_open.max() <= AMONG_DRIVERS + 1e-9);
        let few = rows_of(&drives[0].0, &paper.row_settings(), 0.3).unwrap();
        assert!(NetworkRows::new(paper, &few, None).solve(from).covariance.is_empty());
    }
}
