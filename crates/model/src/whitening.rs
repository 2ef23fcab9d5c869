//! Whitening: coordinates in which the training embeddings have mean 0 and covariance I.
//!
//! `w' = C^(-1/2) (w − mean)`. The gradient of S depends on how `w` is scaled; with identity covariance moving
//! along it is the population's regression on the score. The networks read `w`, everybody else `w'`.
//!
//! # Source
//! Method section 3, calibration section 3.

use crate::linear_algebra::{moments, of_symmetric};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Share of the largest variance below which a direction counts as empty: its scale is left alone.
const LEAST_VARIANCE: f64 = 1e-8;

/// From the coordinates of training to whitened ones and back.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Whitening {
    /// Mean of the training embeddings before, shape `(d,)`.
    mean: Vec<f64>,
    /// C^(1/2), shape `(d, d)`, symmetric.
    root: Vec<f64>,
}

impl Whitening {
    /// Whitening of these embeddings, and they whitened; a direction in which they do not differ keeps its scale.
    pub(crate) fn from_embeddings(
        embeddings: &[DVector<f64>],
        d: usize,
    ) -> (Self, Vec<DVector<f64>>) {
        let (mean, covariance) = moments(embeddings, d);
        let largest = covariance.symmetric_eigenvalues().max().max(f64::MIN_POSITIVE);
        let sd = |v: f64| {
            if v > LEAST_VARIANCE * largest { v.sqrt() } else { 1.0 }
        };
        let inverse = of_symmetric(&covariance, |v| 1.0 / sd(v));
        let white = embeddings.iter().map(|w| &inverse * (w - &mean)).collect();
        let whitening = Self {
            root: of_symmetric(&covariance, sd).iter().copied().collect(),
            mean: mean.iter().copied().collect(),
        };
        (whitening, white)
    }

    /// Whether it is of that size.
    pub(crate) fn is_of(&self, d: usize) -> bool {
        self.mean.len() == d && self.root.len() == d * d
    }

    /// Back to the coordinates of training.
    pub(crate) fn undo(&self, whitened: &[f64]) -> DVector<f64> {
        DVector::from_column_slice(&self.mean) + self.root() * DVector::from_column_slice(whitened)
    }

    /// C^(1/2): takes derivatives by `w` to those by `w'`.
    pub(crate) fn root(&self) -> DMatrix<f64> {
        let d = self.mean.len();
        DMatrix::from_row_slice(d, d, &self.root)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whitened_points_have_identity_covariance_and_go_back() {
        let points = [[1.0, 2.0], [2.0, 5.0], [-1.0, 0.5], [0.3, -3.0]];
        let points = points.map(|p| DVector::from_column_slice(&p));
        let (whitening, white) = Whitening::from_embeddings(&points, 2);
        let (mean, covariance) = moments(&white, 2);
        assert!(mean.norm() < 1e-9);
        assert!((covariance - DMatrix::identity(2, 2)).norm() < 1e-9);
        for (point, white) in points.iter().zip(&white) {
            assert!((whitening.undo(white.as_slice()) - point).norm() < 1e-9);
        }
    }

    #[test]
    fn a_direction_without_variance_keeps_its_scale() {
        let points = [[1.0, 3.0], [2.0, 3.0]].map(|p| DVector::from_column_slice(&p));
        let (whitening, white) = Whitening::from_embeddings(&points, 2);
        assert!(white.iter().all(|w| w.iter().all(|x| x.is_finite())));
        assert!((whitening.undo(&[0.0, 1.0])[1] - 4.0).abs() < 1e-9);
    }
}
