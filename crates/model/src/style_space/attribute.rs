//! Attribute heads: any score a driver has, as a direction in style space.

use super::LinearHead;
use crate::{error::ModelError, linear_algebra::moments, model::Model};
use maveric_domain::DriveId;
use nalgebra::DVector;
use std::collections::BTreeMap;

/// Share of the largest variance below which the embeddings count as not differing in a direction.
const LEAST_VARIANCE: f64 = 1e-8;

/// A linear head fitted to a score of the training drivers, and what it is worth.
///
/// Least squares in closed form. Ridge regression is not offered: with whitened embeddings it shrinks g by the one factor
/// `n/(n + λ)` and leaves its direction as it is, and a move by points undoes the factor.
///
/// # Source
/// Paper, "Modulating Aggression": "other characteristics could be modulated by following a similar
/// procedure". Leave-one-out residuals from the leverages: Allen 1974 (PRESS).
#[derive(Debug, Clone, PartialEq)]
pub struct AttributeHead {
    /// g and its offset: the score at a point of style space.
    pub head: LinearHead,
    /// Drives fitted to.
    pub drives: usize,
    /// Training drives without this score.
    pub without_score: Vec<DriveId>,
    /// Scored drives that are not among the training drives.
    pub unknown: Vec<DriveId>,
    /// Share of the score's variance explained.
    pub r_squared: f64,
    /// The same for drives left out of the fit one at a time; negative where the mean of the others says more. `None` if
    /// a drive cannot be left out, being alone in some direction.
    pub r_squared_leave_one_out: Option<f64>,
    /// Standard error of each component of g, shape `(d,)`.
    pub gradient_se: Vec<f64>,
    /// Root mean square angle by which g's direction is uncertain, in rad; 0 for an embedding of one number.
    pub direction_se_rad: f64,
}

impl AttributeHead {
    /// Fits a head to the scores of a model's training drives.
    ///
    /// # Errors
    /// [`ModelError::TooFewScores`] for fewer than `d + 2` scored training drives, [`ModelError::ConstantScore`],
    /// [`ModelError::NotFinite`] for a score, or [`ModelError::FlatEmbeddings`] if the scored drives do not differ in some
    /// direction of style space.
    pub fn fit(
        model: &Model,
        name: &str,
        scores: &BTreeMap<DriveId, f64>,
    ) -> Result<Self, ModelError> {
        let training = model.training();
        let points: Vec<(DVector<f64>, f64)> =
            training.iter().filter_map(|t| Some((t.point(), *scores.get(&t.drive)?))).collect();
        let unknown = scores.keys().filter(|id| !training.iter().any(|t| t.drive == **id));
        let without_score =
            training.iter().filter(|t| !scores.contains_key(&t.drive)).map(|t| t.drive.clone());
        Ok(Self {
            without_score: without_score.collect(),
            unknown: unknown.cloned().collect(),
            ..Self::of_points(name, &points, model.embedding_size())?
        })
    }

    fn of_points(name: &str, points: &[(DVector<f64>, f64)], d: usize) -> Result<Self, ModelError> {
        let n = points.len();
        if n < d + 2 {
            return Err(ModelError::TooFewScores {
                score: name.to_owned(),
                found: n,
                expected: d + 2,
            });
        }
        if let Some((_, found)) = points.iter().find(|(_, y)| !y.is_finite()) {
            return Err(ModelError::NotFinite { signal: "score", found: *found });
        }
        let count = n as f64;
        let mean_score = points.iter().map(|(_, y)| y).sum::<f64>() / count;
        let total: f64 = points.iter().map(|(_, y)| (y - mean_score).powi(2)).sum();
        if total <= 1e-18 * count * (1.0 + mean_score * mean_score) {
            return Err(ModelError::ConstantScore { score: name.to_owned(), found: mean_score });
        }
        let embeddings: Vec<DVector<f64>> = points.iter().map(|(x, _)| x.clone()).collect();
        let (mean, covariance) = moments(&embeddings, d);
        let variances = covariance.symmetric_eigenvalues();
        let flat = variances.min() <= LEAST_VARIANCE * variances.max().max(f64::MIN_POSITIVE);
        let Some(inverse) = covariance.try_inverse().filter(|_| !flat) else {
            return Err(ModelError::FlatEmbeddings { score: name.to_owned(), drives: n });
        };
        let slope = points
            .iter()
            .fold(DVector::zeros(d), |sum, (x, y)| sum + (x - &mean) * (y - mean_score) / count);
        let gradient = &inverse * slope;
        let (mut left, mut left_out, mut total_left_out) = (0.0, Some(0.0), 0.0);
        for (x, y) in points {
            let x = x - &mean;
            let residual = y - mean_score - gradient.dot(&x);
            let leverage = (1.0 + x.dot(&(&inverse * &x))) / count;
            left += residual * residual;
            total_left_out += ((y - mean_score) * count / (count - 1.0)).powi(2);
            left_out = left_out
                .filter(|_| leverage < 1.0 - 1e-9)
                .map(|sum: f64| sum + (residual / (1.0 - leverage)).powi(2));
        }
        let variance = left / (count - d as f64 - 1.0);
        let covariance = inverse * (variance / count);
        // What of g's scatter lies across it turns it; in the units of its length that is an angle.
        let length = gradient.norm();
        let along = if length > 0.0 {
            gradient.dot(&(&covariance * &gradient)) / (length * length)
        } else {
            0.0
        };
        let across = if d > 1 { covariance.trace() - along } else { 0.0 };
        let scores = points.iter().map(|(_, y)| *y);
        Ok(Self {
            head: LinearHead {
                name: name.to_owned(),
                offset: mean_score - gradient.dot(&mean),
                range: [
                    scores.clone().fold(f64::INFINITY, f64::min),
                    scores.fold(f64::NEG_INFINITY, f64::max),
                ],
                gradient: gradient.iter().copied().collect(),
                covariance: Some(covariance.iter().copied().collect()),
            },
            drives: n,
            without_score: Vec::new(),
            unknown: Vec::new(),
            r_squared: 1.0 - left / total,
            r_squared_leave_one_out: left_out.map(|sum| 1.0 - sum / total_left_out),
            gradient_se: covariance.diagonal().iter().map(|v| v.sqrt()).collect(),
            // Atan: for a g lost in its scatter the angle is a right one, not endless.
            direction_se_rad: libm::atan2(across.max(0.0).sqrt(), length),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear_algebra::{dot, norm};
    use maveric_domain::Embedding;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    fn made_up(n: usize, noise: f64, seed: u64) -> (Vec<Vec<f64>>, Vec<f64>) {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let points: Vec<Vec<f64>> = (0..n).map(|_| (0..3).map(|_| normal()).collect()).collect();
        let score = |p: &Vec<f64>| 20.0 + 4.0 * p[0] - 2.0 * p[1] + 0.5 * p[2];
        let scores = points.iter().map(score).collect::<Vec<f64>>();
        (points, scores.iter().map(|s| s + noise * normal()).collect())
    }

    fn head(points: &[Vec<f64>], scores: &[f64]) -> Result<AttributeHead, ModelError> {
        let points: Vec<(DVector<f64>, f64)> = points
            .iter()
            .map(|p| DVector::from_column_slice(p))
            .zip(scores.iter().copied())
            .collect();
        AttributeHead::of_points("made_up", &points, 3)
    }

    #[test]
    fn a_linear_score_is_found_again() {
        let (points, scores) = made_up(12, 0.0, 1);
        let found = head(&points, &scores).unwrap();
        for (g, expected) in found.head.gradient().iter().zip([4.0, -2.0, 0.5]) {
            assert!((g - expected).abs() < 1e-9);
        }
        assert!((found.r_squared - 1.0).abs() < 1e-9);
        assert!((found.r_squared_leave_one_out.unwrap() - 1.0).abs() < 1e-9);
        assert!(found.direction_se_rad < 1e-6);
        let w = Embedding::new(points[3].clone()).unwrap();
        assert!((found.head.read(&w).unwrap() - scores[3]).abs() < 1e-9);
        let [low, high] = found.head.range();
        assert!(scores.iter().all(|s| (low..=high).contains(s)));
    }

    #[test]
    fn leave_one_out_is_what_refitting_without_each_gives() {
        let (points, scores) = made_up(15, 3.0, 2);
        let found = head(&points, &scores).unwrap();
        let (mut left, mut total) = (0.0, 0.0);
        for i in 0..points.len() {
            let (mut x, mut y) = (points.clone(), scores.clone());
            let (x_i, y_i) = (Embedding::new(x.remove(i)).unwrap(), y.remove(i));
            let others = head(&x, &y).unwrap();
            left += (y_i - others.head.read(&x_i).unwrap()).powi(2);
            total += (y_i - y.iter().sum::<f64>() / y.len() as f64).powi(2);
        }
        let expected = 1.0 - left / total;
        assert!((found.r_squared_leave_one_out.unwrap() - expected).abs() < 1e-9);
        assert!(found.r_squared > expected);
    }

    #[test]
    fn standard_errors_are_the_scatter_over_samples() {
        let found: Vec<AttributeHead> = (0..400)
            .map(|seed| {
                let (points, scores) = made_up(40, 3.0, 100 + seed);
                head(&points, &scores).unwrap()
            })
            .collect();
        let n = found.len() as f64;
        let of = |f: &dyn Fn(&AttributeHead) -> f64| found.iter().map(f).sum::<f64>() / n;
        for i in 0..3 {
            let mean = of(&|h| h.head.gradient()[i]);
            let scatter = of(&|h| (h.head.gradient()[i] - mean).powi(2)).sqrt();
            let said = of(&|h| h.gradient_se[i].powi(2)).sqrt();
            assert!((0.8..1.25).contains(&(said / scatter)), "{said} {scatter}");
        }
        let truth = [4.0, -2.0, 0.5];
        let angle = |h: &AttributeHead| {
            let g = h.head.gradient();
            let cosine = dot(g, &truth) / (norm(g) * norm(&truth));
            cosine.clamp(-1.0, 1.0).acos().powi(2)
        };
        let (scatter, said) = (of(&angle).sqrt(), of(&|h| h.direction_se_rad.powi(2)).sqrt());
        assert!((0.8..1.25).contains(&(said / scatter)), "{said} {scatter}");
    }

    #[test]
    fn scores_that_say_nothing_are_refused() {
        let (points, scores) = made_up(12, 1.0, 3);
        let few = head(&points[..4], &scores[..4]).unwrap_err();
        assert!(matches!(few, ModelError::TooFewScores { found: 4, expected: 5, .. }));
        let constant = head(&points, &[7.0; 12]).unwrap_err();
        assert!(matches!(constant, ModelError::ConstantScore { .. }));
        let flat: Vec<Vec<f64>> = points.iter().map(|p| vec![p[0], p[1], 0.0]).collect();
        let flat = head(&flat, &scores).unwrap_err();
        assert!(matches!(flat, ModelError::FlatEmbeddings { drives: 12, .. }));
        let mut broken = scores;
        broken[2] = f64::NAN;
        assert!(matches!(head(&points, &broken), Err(ModelError::NotFinite { .. })));
    }
}
