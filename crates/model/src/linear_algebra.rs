//! Small symmetric matrices: eigenvectors, roots, mean and covariance. Matrices are row by row.

use nalgebra::{DMatrix, SymmetricEigen};

/// Eigenvalues, largest first, and eigenvectors (one a row) of a symmetric `(n, n)` matrix. Each vector's largest component is
/// positive.
pub(crate) fn symmetric_eigen(matrix: &[f64], n: usize) -> (Vec<f64>, Vec<Vec<f64>>) {
    let found = SymmetricEigen::new(DMatrix::from_row_slice(n, n, matrix));
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| found.eigenvalues[j].total_cmp(&found.eigenvalues[i]));
    let vector = |&i: &usize| {
        let vector = found.eigenvectors.column(i);
        let sign = vector[vector.iamax()].signum();
        vector.iter().map(|x| x * sign).collect()
    };
    let values = order.iter().map(|&i| found.eigenvalues[i]).collect();
    (values, order.iter().map(vector).collect())
}

/// Σ f(λ) v vᵀ: a function of a symmetric matrix.
pub(crate) fn of_symmetric(
    values: &[f64],
    vectors: &[Vec<f64>],
    f: impl Fn(f64) -> f64,
) -> Vec<f64> {
    let n = values.len();
    let mut result = vec![0.0; n * n];
    for (&value, vector) in values.iter().zip(vectors) {
        for i in 0..n {
            for j in 0..n {
                result[i * n + j] += f(value) * vector[i] * vector[j];
            }
        }
    }
    result
}

/// Matrix `(n, n)` times vector.
pub(crate) fn times(matrix: &[f64], vector: &[f64]) -> Vec<f64> {
    matrix
        .chunks_exact(vector.len())
        .map(|row| dot(row, vector))
        .collect()
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

pub(crate) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Mean `(d,)` and covariance `(d, d)` of points, divided by their number.
pub(crate) fn mean_and_covariance(points: &[&[f64]], d: usize) -> (Vec<f64>, Vec<f64>) {
    let n = points.len().max(1) as f64;
    let mut mean = vec![0.0; d];
    for point in points {
        for (m, x) in mean.iter_mut().zip(*point) {
            *m += x / n;
        }
    }
    let mut covariance = vec![0.0; d * d];
    for point in points {
        for i in 0..d {
            for j in 0..d {
                covariance[i * d + j] += (point[i] - mean[i]) * (point[j] - mean[j]) / n;
            }
        }
    }
    (mean, covariance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvectors_rebuild_their_matrix() {
        let a = [4.0, 1.0, -2.0, 1.0, 3.0, 0.5, -2.0, 0.5, 5.0];
        let (values, vectors) = symmetric_eigen(&a, 3);
        assert!(values[0] >= values[1] && values[1] >= values[2]);
        let rebuilt = of_symmetric(&values, &vectors, |x| x);
        for (x, y) in rebuilt.iter().zip(a) {
            assert!((x - y).abs() < 1e-12);
        }
        let root = of_symmetric(&values, &vectors, f64::sqrt);
        let image = times(&root, &times(&root, &[1.0, 2.0, 3.0]));
        for (x, y) in image.iter().zip(times(&a, &[1.0, 2.0, 3.0])) {
            assert!((x - y).abs() < 1e-12);
        }
    }
}
