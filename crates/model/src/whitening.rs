//! Whitening: coordinates in which the training embeddings have mean 0 and covariance I.
//!
//! `w' = C^(-1/2) (w − mean)`. The gradient of S depends on how `w` is scaled; with identity covariance moving
//! along it is the population's regression on ADB. The change is folded into the first layers that read `w`, so
//! no prediction moves. M keeps the coordinates it was trained in, and `w'` is taken back to them before L5:
//! folding it into M's outputs as well would change L5, a squared distance, and its diagonal normal.
//!
//! # Source
//! Method section 3, calibration section 3.

use crate::{
    linear_algebra::{mean_and_covariance, of_symmetric, symmetric_eigen, times},
    network::{Networks, mlp::Dense},
};
use serde::{Deserialize, Serialize};

/// Share of the largest variance below which a direction counts as empty: its scale is left alone.
const LEAST_VARIANCE: f64 = 1e-8;

/// From the coordinates of training to whitened ones and back.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Whitening {
    /// Mean of the training embeddings before, shape `(d,)`.
    pub mean: Vec<f64>,
    /// C^(1/2), shape `(d, d)` row by row.
    pub root: Vec<f64>,
    /// C^(-1/2), shape `(d, d)` row by row.
    pub inverse_root: Vec<f64>,
}

impl Whitening {
    /// No change.
    pub fn identity(d: usize) -> Self {
        let mut root = vec![0.0; d * d];
        for i in 0..d {
            root[i * d + i] = 1.0;
        }
        Self {
            mean: vec![0.0; d],
            inverse_root: root.clone(),
            root,
        }
    }

    /// Whitening of these embeddings; a direction in which they do not differ keeps its scale.
    pub fn of(embeddings: &[&[f64]], d: usize) -> Self {
        let (mean, covariance) = mean_and_covariance(embeddings, d);
        let (values, vectors) = symmetric_eigen(&covariance, d);
        let least = LEAST_VARIANCE * values[0].max(f64::MIN_POSITIVE);
        let variance = |value: f64| if value > least { value } else { 1.0 };
        Self {
            mean,
            root: of_symmetric(&values, &vectors, |v| variance(v).sqrt()),
            inverse_root: of_symmetric(&values, &vectors, |v| 1.0 / variance(v).sqrt()),
        }
    }

    /// To whitened coordinates.
    pub fn apply(&self, raw: &[f64]) -> Vec<f64> {
        let centred: Vec<f64> = raw.iter().zip(&self.mean).map(|(x, m)| x - m).collect();
        times(&self.inverse_root, &centred)
    }

    /// Back to the coordinates of training.
    pub fn undo(&self, whitened: &[f64]) -> Vec<f64> {
        let scaled = times(&self.root, whitened);
        scaled.iter().zip(&self.mean).map(|(x, m)| x + m).collect()
    }

    /// Rewrites the layers that read `w` so that they read `w'`.
    pub(crate) fn fold(&self, networks: &Networks, parameters: &mut [f32]) {
        let readers = [
            networks.following_distance.head.first(),
            networks.lane_change.encoded.head.first(),
            networks.velocity.encoded.head.first(),
            networks.style.dense(),
        ];
        for layer in readers {
            self.fold_layer(layer, parameters);
        }
    }

    /// `w` is the first `d` inputs: `W w + b = (W C^½) w' + (b + W mean)`.
    fn fold_layer(&self, layer: Dense, parameters: &mut [f32]) {
        let d = self.mean.len();
        for output in 0..layer.outputs {
            let line = layer.offset + output * layer.inputs;
            let old: Vec<f64> = parameters[line..line + d]
                .iter()
                .map(|&w| f64::from(w))
                .collect();
            // The root is symmetric, so rows and columns are one.
            for (to, new) in parameters[line..line + d]
                .iter_mut()
                .zip(times(&self.root, &old))
            {
                *to = new as f32;
            }
            let shift: f64 = old.iter().zip(&self.mean).map(|(w, m)| w * m).sum();
            let bias = &mut parameters[layer.biases_at() + output];
            *bias = (f64::from(*bias) + shift) as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whitened_points_have_identity_covariance() {
        let points = [[1.0, 2.0], [2.0, 5.0], [-1.0, 0.5], [0.3, -3.0]];
        let refs: Vec<&[f64]> = points.iter().map(<[f64; 2]>::as_slice).collect();
        let whitening = Whitening::of(&refs, 2);
        let white: Vec<Vec<f64>> = points.iter().map(|p| whitening.apply(p)).collect();
        let refs: Vec<&[f64]> = white.iter().map(Vec::as_slice).collect();
        let (mean, covariance) = mean_and_covariance(&refs, 2);
        for (found, expected) in mean
            .iter()
            .chain(&covariance)
            .zip([0.0, 0.0, 1.0, 0.0, 0.0, 1.0])
        {
            assert!((found - expected).abs() < 1e-12);
        }
        for (a, b) in whitening.undo(&white[1]).iter().zip(points[1]) {
            assert!((a - b).abs() < 1e-12);
        }
    }

    #[test]
    fn one_driver_is_only_shifted() {
        let whitening = Whitening::of(&[&[3.0, -1.0]], 2);
        assert_eq!(whitening.apply(&[3.0, -1.0]), [0.0, 0.0]);
        assert_eq!(whitening.apply(&[4.0, -1.0]), [1.0, 0.0]);
    }
}
