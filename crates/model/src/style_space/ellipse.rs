//! Perpendicular: across the direction of aggression, where S does not change.

use super::LinearHead;
use crate::{
    error::ModelError,
    linear_algebra::{moments, norm, symmetric_eigen},
    model::Model,
};
use maveric_domain::Embedding;
use nalgebra::{DMatrix, DVector};
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::PI;

/// Relative difference below which two variances count as one: the ellipse is a circle there.
const ROUND: f64 = 1e-3;

/// The ellipse around an embedding in the `(d − 1)`-dimensional complement of g, half-axes one standard
/// deviation of the training embeddings along the complement's principal axes.
///
/// A whitened space has the same deviation everywhere, and so no principal axes of its own; an angle then needs
/// a zero and a sign from elsewhere. **Convention**: within axes of one variance, the first points where the training
/// drivers' mean speed rises most (by least squares on the complement's coordinates). Every axis with a
/// variance of its own is turned so that mean speed does not fall along it. What is left open is the sense of the
/// angle: in three dimensions g, first and second axis are right-handed; in more, a further axis's largest component
/// is positive. So the zero means the same in every training run, the sense does not: fit cosine and sine.
///
/// # Source
/// Method section 4; calibration section 5 on the angle's missing zero.
#[derive(Debug, Clone, PartialEq)]
pub struct PerpendicularEllipse {
    axes: Vec<Vec<f64>>,
    half_axes: Vec<f64>,
}

/// An embedding moved across the direction of aggression.
#[derive(Debug, Clone, PartialEq)]
pub struct Perpendicular {
    /// Where it is now.
    pub embedding: Embedding,
    /// Angle between the first two axes, in rad, from −π to π; 0 or π where there is one axis only.
    pub angle_rad: f64,
    /// Point on the unit sphere that was scaled by the half-axes, shape `(d − 1,)`: `[cos, sin]` of the angle for an
    /// embedding of three.
    pub unit: Vec<f64>,
}

impl PerpendicularEllipse {
    /// The ellipse of a model.
    ///
    /// # Errors
    /// [`ModelError::NoAggressionAxis`], or [`ModelError::NoPerpendicular`] for an embedding of one number.
    pub fn of(model: &Model) -> Result<Self, ModelError> {
        let direction = DVector::from_vec(LinearHead::aggression(model)?.direction());
        let d = direction.len();
        if d < 2 {
            return Err(ModelError::NoPerpendicular { found: d });
        }
        let speeds: Vec<f64> = model.training().iter().map(|t| t.mean_speed_mps).collect();
        Ok(Self::around(&direction, &model.points(), &speeds))
    }

    pub(super) fn around(
        direction: &DVector<f64>,
        points: &[DVector<f64>],
        speeds: &[f64],
    ) -> Self {
        let basis = complement(direction);
        let inside: Vec<DVector<f64>> = points.iter().map(|p| basis.tr_mul(p)).collect();
        let (mean, covariance) = moments(&inside, basis.ncols());
        let (values, mut vectors) = symmetric_eigen(&covariance);
        let rise = speed_rise(&inside, &mean, speeds, &values, &vectors);
        turn_round_parts(&values, &mut vectors, &rise);
        for mut vector in vectors.column_iter_mut() {
            if vector.dot(&rise) < -1e-9 * rise.norm() {
                vector.neg_mut();
            }
        }
        let mut axes = basis * vectors;
        if values.len() == 2 && (values[0] - values[1]).abs() <= ROUND * values[0] {
            // Right-handed: direction, first and second axis.
            let cross = direction.cross(&axes.column(0));
            if cross.dot(&axes.column(1)) < 0.0 {
                axes.column_mut(1).neg_mut();
            }
        }
        Self {
            axes: axes.column_iter().map(|a| a.iter().copied().collect()).collect(),
            half_axes: values.iter().map(|v| v.max(0.0).sqrt()).collect(),
        }
    }

    /// Unit vectors along the half-axes, shape `(d − 1, d)`.
    pub fn axes(&self) -> &[Vec<f64>] {
        &self.axes
    }

    /// Lengths of the half-axes, shape `(d − 1,)`.
    pub fn half_axes(&self) -> &[f64] {
        &self.half_axes
    }

    /// The point of the ellipse around `embedding` at an angle between the first two axes, in rad; with one
    /// axis only, the sign of its cosine decides.
    ///
    /// # Errors
    /// [`ModelError::EmbeddingSize`], or [`ModelError::NotFinite`] for the angle.
    pub fn at_angle(
        &self,
        embedding: &Embedding,
        angle_rad: f64,
    ) -> Result<Perpendicular, ModelError> {
        if !angle_rad.is_finite() {
            return Err(ModelError::NotFinite { signal: "angle_rad", found: angle_rad });
        }
        let mut unit = vec![0.0; self.axes.len()];
        match unit.as_mut_slice() {
            [only] => *only = 1.0_f64.copysign(libm::cos(angle_rad)),
            [first, second, ..] => (*first, *second) = (libm::cos(angle_rad), libm::sin(angle_rad)),
            [] => {}
        }
        self.at(embedding, unit)
    }

    /// A point of the ellipse around `embedding` at an angle drawn evenly; beyond three dimensions a direction
    /// drawn evenly from the sphere.
    ///
    /// # Errors
    /// [`ModelError::EmbeddingSize`] if the embedding is not of the model's size.
    pub fn sample(
        &self,
        embedding: &Embedding,
        rng: &mut impl rand::Rng,
    ) -> Result<Perpendicular, ModelError> {
        let mut unit: Vec<f64> = self.axes.iter().map(|_| StandardNormal.sample(rng)).collect();
        let length = norm(&unit);
        if length > 0.0 {
            for u in &mut unit {
                *u /= length;
            }
        } else {
            unit[0] = 1.0;
        }
        self.at(embedding, unit)
    }

    fn at(&self, embedding: &Embedding, unit: Vec<f64>) -> Result<Perpendicular, ModelError> {
        let mut w = embedding.coordinates().to_vec();
        ModelError::check_size(w.len(), self.axes.len() + 1)?;
        for ((u, half), axis) in unit.iter().zip(&self.half_axes).zip(&self.axes) {
            for (to, a) in w.iter_mut().zip(axis) {
                *to += u * half * a;
            }
        }
        let angle_rad = match unit.as_slice() {
            [first, second, ..] => libm::atan2(*second, *first),
            [only] if *only < 0.0 => PI,
            _ => 0.0,
        };
        Ok(Perpendicular { embedding: Embedding::new(w)?, angle_rad, unit })
    }
}

/// An orthonormal basis of what is perpendicular to a unit vector, one vector a column: the mirror that takes the nearest coordinate
/// axis there takes the others to it.
fn complement(direction: &DVector<f64>) -> DMatrix<f64> {
    let d = direction.len();
    let nearest = direction.iamax();
    let mut between = direction.clone();
    between[nearest] += direction[nearest].signum();
    let square = between.norm_squared();
    (DMatrix::identity(d, d) - &between * between.transpose() * (2.0 / square))
        .remove_column(nearest)
}

/// Slope of mean speed by least squares on the points: C⁺ cov(x, speed).
fn speed_rise(
    points: &[DVector<f64>],
    mean: &DVector<f64>,
    speeds: &[f64],
    values: &[f64],
    vectors: &DMatrix<f64>,
) -> DVector<f64> {
    let n = points.len().max(1) as f64;
    let mean_speed = speeds.iter().sum::<f64>() / n;
    let pairs = points.iter().zip(speeds);
    let covariance = pairs.fold(DVector::zeros(mean.len()), |sum, (x, speed)| {
        sum + (x - mean) * (speed - mean_speed) / n
    });
    let along = vectors.tr_mul(&covariance);
    let least = 1e-9 * values[0].abs();
    let slopes = along.iter().zip(values);
    let slopes = slopes.map(|(a, v)| if *v > least { a / v } else { 0.0 });
    vectors * DVector::from_iterator(values.len(), slopes)
}

/// Turns axes of one variance among themselves, so that the first takes all of `rise` that lies in their space.
fn turn_round_parts(values: &[f64], vectors: &mut DMatrix<f64>, rise: &DVector<f64>) {
    let scale = values[0].abs().max(f64::MIN_POSITIVE);
    let mut start = 0;
    while start < values.len() {
        let alike = |v: &&f64| (values[start] - **v).abs() <= ROUND * scale;
        let many = values[start..].iter().take_while(alike).count().max(1);
        let part = vectors.columns(start, many).into_owned();
        let shares = part.tr_mul(rise);
        let length = shares.norm();
        if many > 1 && length > 0.0 {
            let first = shares / length;
            let others = complement(&first);
            let turn =
                DMatrix::from_fn(
                    many,
                    many,
                    |i, j| {
                        if j == 0 { first[i] } else { others[(i, j - 1)] }
                    },
                );
            vectors.columns_mut(start, many).copy_from(&(part * turn));
        }
        start += many;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::SeedableRng;

    fn cloud(d: usize, scales: &[f64]) -> Vec<DVector<f64>> {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(7);
        let mut point = || {
            DVector::from_fn(d, |i, _| {
                let z: f64 = StandardNormal.sample(&mut rng);
                scales[i] * z
            })
        };
        (0..500).map(|_| point()).collect()
    }

    fn ellipse(direction: &[f64], points: &[DVector<f64>], speeds: &[f64]) -> PerpendicularEllipse {
        PerpendicularEllipse::around(&DVector::from_column_slice(direction), points, speeds)
    }

    proptest! {
        #[test]
        fn a_perpendicular_move_keeps_predicted_aggression(
            g in prop::collection::vec(-5.0..5.0_f64, 2..7),
            seed in 0_u64..1000,
        ) {
            prop_assume!(norm(&g) > 0.1);
            let d = g.len();
            let direction: Vec<f64> = g.iter().map(|x| x / norm(&g)).collect();
            let points = cloud(d, &[1.0, 2.0, 0.5, 1.0, 1.0, 3.0]);
            let speeds: Vec<f64> = points.iter().map(|p| 20.0 + p[0]).collect();
            let ellipse = ellipse(&direction, &points, &speeds);
            let axis = LinearHead::for_tests("s", &g, 30.0, [11.0, 55.0]);
            let w = Embedding::new(vec![0.3; d]).unwrap();
            let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
            let moved = ellipse.sample(&w, &mut rng).unwrap();
            let before = axis.read(&w).unwrap();
            prop_assert!((axis.read(&moved.embedding).unwrap() - before).abs() < 1e-5);
            prop_assert!((norm(&moved.unit) - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn half_axes_are_the_deviations_across_g() {
        let points = cloud(3, &[5.0, 2.0, 1.0]);
        let speeds: Vec<f64> = points.iter().map(|p| 20.0 - p[1]).collect();
        let ellipse = ellipse(&[1.0, 0.0, 0.0], &points, &speeds);
        assert!((ellipse.half_axes()[0] - 2.0).abs() < 0.2);
        assert!((ellipse.half_axes()[1] - 1.0).abs() < 0.1);
        // Speed falls along y, so the first axis points to −y.
        assert!(ellipse.axes()[0][1] < -0.9);
    }

    #[test]
    fn on_a_circle_angle_zero_is_where_speed_rises_most() {
        let points: Vec<DVector<f64>> = (0..200)
            .map(|i| {
                let a = f64::from(i) * PI / 100.0;
                DVector::from_vec(vec![0.0, a.cos(), a.sin()])
            })
            .collect();
        let speeds: Vec<f64> = points.iter().map(|p| 25.0 + 3.0 * p[1] - 4.0 * p[2]).collect();
        let ellipse = ellipse(&[1.0, 0.0, 0.0], &points, &speeds);
        let axis = &ellipse.axes()[0];
        assert!((axis[1] - 0.6).abs() < 1e-6 && (axis[2] + 0.8).abs() < 1e-6);
        let w = Embedding::new(vec![0.0; 3]).unwrap();
        let quarter = ellipse.at_angle(&w, PI / 2.0).unwrap();
        // g × first axis: right-handed.
        let at = quarter.embedding.coordinates();
        let half = ellipse.half_axes()[1];
        assert!((at[1] - 0.8 * half).abs() < 1e-6 && (at[2] - 0.6 * half).abs() < 1e-6);
    }

    #[test]
    fn two_dimensions_have_two_sides() {
        let points = cloud(2, &[1.0, 2.0]);
        let speeds: Vec<f64> = points.iter().map(|p| p[1]).collect();
        let ellipse = ellipse(&[1.0, 0.0], &points, &speeds);
        let w = Embedding::new(vec![0.0, 0.0]).unwrap();
        let back = ellipse.at_angle(&w, 3.0).unwrap();
        assert!(back.embedding.coordinates()[1] < -1.5);
        assert!((back.angle_rad - PI).abs() < 1e-12);
    }
}
