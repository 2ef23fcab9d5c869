//! What style space needs beside nalgebra: eigenvectors in a stated order and sense, and moments of points.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Eigenvalues of a symmetric matrix, largest first, and their vectors, one a column, each with its largest component positive.
pub(crate) fn symmetric_eigen(matrix: &DMatrix<f64>) -> (Vec<f64>, DMatrix<f64>) {
    if matrix.is_empty() {
        return (Vec::new(), matrix.clone());
    }
    let eigen = SymmetricEigen::new(matrix.clone());
    let mut order: Vec<usize> = (0..matrix.nrows()).collect();
    order.sort_by(|&i, &j| eigen.eigenvalues[j].total_cmp(&eigen.eigenvalues[i]));
    let columns: Vec<DVector<f64>> = order
        .iter()
        .map(|&i| {
            let vector = eigen.eigenvectors.column(i);
            vector * vector[vector.iamax()].signum()
        })
        .collect();
    let values = order.iter().map(|&i| eigen.eigenvalues[i]).collect();
    (values, DMatrix::from_columns(&columns))
}

/// Σ f(λ) v vᵀ: a function of a symmetric matrix.
pub(crate) fn of_symmetric(matrix: &DMatrix<f64>, f: impl Fn(f64) -> f64) -> DMatrix<f64> {
    let (values, vectors) = symmetric_eigen(matrix);
    let scaled =
        DMatrix::from_diagonal(&DVector::from_iterator(values.len(), values.iter().map(|&v| f(v))));
    &vectors * scaled * vectors.transpose()
}

/// Mean `(d,)` and covariance `(d, d)` of points, divided by their number.
pub(crate) fn moments(points: &[DVector<f64>], d: usize) -> (DVector<f64>, DMatrix<f64>) {
    let n = points.len().max(1) as f64;
    let mean = points.iter().fold(DVector::zeros(d), |sum, p| sum + p / n);
    let covariance = points.iter().fold(DMatrix::zeros(d, d), |sum, p| {
        let away = p - &mean;
        sum + &away * away.transpose() / n
    });
    (mean, covariance)
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

pub(crate) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// aᵀ C a, C row by row.
pub(crate) fn spread(a: &[f64], covariance: &[f64]) -> f64 {
    let lines = covariance.chunks_exact(a.len().max(1)).zip(a);
    lines.map(|(line, x)| dot(line, a) * x).sum::<f64>().max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvectors_rebuild_their_matrix_and_roots_square_to_it() {
        let a = DMatrix::from_row_slice(3, 3, &[4.0, 1.0, -2.0, 1.0, 3.0, 0.5, -2.0, 0.5, 5.0]);
        let (values, _) = symmetric_eigen(&a);
        assert!(values[0] >= values[1] && values[1] >= values[2]);
        assert!((of_symmetric(&a, |x| x) - &a).norm() < 1e-12);
        let root = of_symmetric(&a, f64::sqrt);
        assert!((&root * &root - &a).norm() < 1e-12);
    }
}
