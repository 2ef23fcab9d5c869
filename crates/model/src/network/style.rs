//! S_θ: the ADB score, from `w` by one linear layer, so that its gradient is one direction everywhere.
//!
//! `w (d) → ŝ (1)`, standardised. Trained by L4, one row a drive.

use super::{
    Architecture,
    mlp::{Dense, Mlp},
};
use crate::losses::{Real, squared_error};

/// The sub-network S_θ.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Style {
    pub(crate) layer: Mlp,
}

impl Style {
    pub(crate) fn new(offset: &mut usize, architecture: &Architecture) -> Self {
        Self {
            layer: Mlp::new(offset, &[architecture.embedding_size, 1]),
        }
    }

    /// The one layer.
    pub(crate) fn dense(&self) -> Dense {
        self.layer.first()
    }
}

/// L4, the mean of `(S(w) − s)²` over the drives with a score `s`; `None` without any.
///
/// `parameters` are the weights of S, shape `(d,)`, and its bias; `embeddings` has shape `(drives, d)`. Adds `weight`
/// times the gradients to those of the parameters and of the embeddings.
pub(crate) fn aggression<T: Real>(
    (parameters, embeddings): (&[T], &[T]),
    scores: &[Option<T>],
    weight: f64,
    gradient: &mut [T],
    embedding_gradient: &mut [T],
) -> Option<f64> {
    let scored = scores.iter().flatten().count();
    if scored == 0 {
        return None;
    }
    let d = parameters.len() - 1;
    let share = T::from_f64(weight / scored as f64);
    let mut sum = 0.0;
    for (index, score) in scores.iter().enumerate() {
        let Some(score) = *score else { continue };
        let w = &embeddings[index * d..(index + 1) * d];
        let pairs = parameters.iter().zip(w);
        let found = pairs.fold(parameters[d], |sum, (&by, &w)| sum + by * w);
        let (loss, slope) = squared_error(found, score, share);
        sum += loss;
        for i in 0..d {
            gradient[i] = gradient[i] + slope * w[i];
            let to = &mut embedding_gradient[index * d + i];
            *to = *to + slope * parameters[i];
        }
        gradient[d] = gradient[d] + slope;
    }
    Some(sum / scored as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn l4_has_its_gradient_by_s_and_by_w() {
        let scores = [Some(0.7), None, Some(-1.1)];
        let parameters = vec![0.9, -0.4, 0.3, 0.2];
        let w = vec![0.3, -0.5, 1.0, 0.2, 0.1, -0.9, 1.4, 0.6, -0.2];
        let value = |p: &[f64], w: &[f64]| {
            let (mut by_p, mut by_w) = (vec![0.0; 4], vec![0.0; 9]);
            let l4 = aggression((p, w), &scores, 0.3, &mut by_p, &mut by_w);
            (0.3 * l4.unwrap(), by_p, by_w)
        };
        let (_, by_p, by_w) = value(&parameters, &w);
        let slope = |values: &[f64], i: usize, f: &dyn Fn(&[f64]) -> f64| {
            let at = |step: f64| {
                let mut values = values.to_vec();
                values[i] += step;
                f(&values)
            };
            (at(1e-6) - at(-1e-6)) / 2e-6
        };
        for (i, found) in by_w.iter().enumerate() {
            let numeric = slope(&w, i, &|w| value(&parameters, w).0);
            assert!((found - numeric).abs() < 1e-7);
        }
        for (i, found) in by_p.iter().enumerate() {
            let numeric = slope(&parameters, i, &|p| value(p, &w).0);
            assert!((found - numeric).abs() < 1e-7);
        }
    }
}
