//! Errors of combinations of coefficients that take people as they are, where the model takes all differences between them to vary alike.

use super::{Fit, blocks::Blocks};
use crate::numerics::{
    matrix::{Cholesky, Matrix},
    moments::{dot, is_rounding},
    spectrum::principal_axes,
};

/// The standard error of any combination of coefficients from what the fit leaves of each subject, with its degrees of freedom.
///
/// Of one factor of complete subjects the difference of two levels has the error of the paired t test, and that of two groups Welch's.
///
/// # Source
/// Bell and McCaffrey (2002); Pustejovsky and Tipton (2018), CR2 and Satterthwaite's degrees of freedom, with the model's own covariance as
/// the working one.
pub(super) struct OwnErrors {
    /// L, the Cholesky factor of the information of all subjects.
    factor: Cholesky,
    people: Vec<Person>,
    /// The largest value.
    scale: f64,
}

/// A subject's part in Lᵀβ, of which all subjects together have the information 1.
struct Person {
    /// Its information C.
    share: Matrix,
    /// What the fit leaves of its rows, times their columns.
    pull: Vec<f64>,
    /// (1 - C)^(-1/2); none where the other subjects leave a coefficient open.
    root: Option<Matrix>,
}

impl OwnErrors {
    /// None where the sums have no factor.
    pub(super) fn new(blocks: &Blocks, fit: &Fit, scale: f64) -> Option<Self> {
        let sums = blocks.weighted(&fit.l)?;
        let factor = sums.xx.cholesky()?;
        let person = |(information, pull): (Matrix, Matrix)| {
            let half = factor.half_solve(&information).transposed();
            let share = factor.half_solve(&half);
            let mut others = Matrix::identity(share.rows);
            others.add(&share, -1.0);
            Person { root: inverse_root(&others), pull: column(&factor.half_solve(&pull)), share }
        };
        let people = blocks.by_subject(&sums, &fit.beta).into_iter().map(person);
        let people = people.collect();
        Some(Self { factor, people, scale })
    }

    /// Standard error and degrees of freedom of a combination; none where a subject alone tells a part of it, or nobody differs in it.
    pub(super) fn error_of(&self, weights: &[f64]) -> Option<(f64, f64)> {
        let count = weights.len();
        let weights = Matrix::from(count, 1, |j, _| weights[j]);
        let direction = column(&self.factor.half_solve(&weights));
        let size = dot(&direction, &direction);
        let (mut variance, mut trace, mut squares) = (0.0, 0.0, 0.0);
        let mut products = Matrix::zeros(count, count);
        for person in &self.people {
            let part = times(&person.share, &direction);
            if dot(&part, &part) <= 1e-20 * size {
                // A group or a level that is not in the combination.
                continue;
            }
            let turned = times(person.root.as_ref()?, &direction);
            variance += dot(&turned, &person.pull).powi(2);
            // Of the covariance of what the fit leaves of two subjects, δᵢⱼ ‖tᵢ‖² − gᵢᵀ gⱼ: its trace, and the sum of its squares. The
            // squares of the second part alone add up to the trace of (Σ g gᵀ)².
            let shared = times(&person.share, &turned);
            let (square_norm, common) = (dot(&turned, &shared), dot(&shared, &shared));
            trace += square_norm - common;
            squares += square_norm * (square_norm - 2.0 * common);
            let product = Matrix::from(count, count, |i, j| shared[i] * shared[j]);
            products.add(&product, 1.0);
        }
        squares += products.trace_of_product(&products);
        let (se, df) = (variance.sqrt(), trace * trace / squares);
        (!is_rounding(se, self.scale) && df.is_finite() && df > 0.0).then_some((se, df))
    }
}

fn column(matrix: &Matrix) -> Vec<f64> {
    (0..matrix.rows).map(|i| matrix[(i, 0)]).collect()
}

fn times(matrix: &Matrix, vector: &[f64]) -> Vec<f64> {
    (0..matrix.rows).map(|i| dot(matrix.row(i), vector)).collect()
}

/// The symmetric matrix whose square is the inverse; none of what is singular but for rounding, where 1 is the largest that there can be.
fn inverse_root(matrix: &Matrix) -> Option<Matrix> {
    let n = matrix.rows;
    let mut root = Matrix::zeros(n, n);
    for axis in principal_axes(matrix)? {
        let value = dot(&axis, &axis);
        if value < 1e-9 {
            return None;
        }
        root.add(&Matrix::from(n, n, |i, j| axis[i] * axis[j]), 1.0 / (value * value.sqrt()));
    }
    Some(root)
}
