//! Singular values of a tall matrix, by Householder reduction and one-sided Jacobi.
//!
//! The covariance matrix is never formed: squaring would lose half of the digits of the
//! smallest value, which is what Mauchly's W hangs on.

use super::{matrix::Matrix, moments::dot};

/// Squared singular values of the matrix with these columns (each of the same length), in
/// no order; as many as there are columns.
pub(crate) fn squared_singular_values(mut columns: Vec<Vec<f64>>) -> Vec<f64> {
    let width = columns.len();
    let height = columns.first().map_or(0, Vec::len);
    if height > width {
        reduce_to_triangle(&mut columns);
    }
    orthogonalised(columns).iter().map(|c| dot(c, c)).collect()
}

/// Eigenvectors of a symmetric matrix, each times the root of its eigenvalue; `None` if it is not positive definite to working precision.
pub(crate) fn principal_axes(matrix: &Matrix) -> Option<Vec<Vec<f64>>> {
    let lower = matrix.cholesky()?.lower();
    let rows = 0..lower.rows;
    let column = |j: usize| -> Vec<f64> { rows.clone().map(|i| lower[(i, j)]).collect() };
    Some(orthogonalised(rows.clone().map(column).collect()))
}

/// Columns turned among themselves until they are orthogonal: with G their matrix, eigenvectors of G Gᵀ times the root of their eigenvalue.
fn orthogonalised(mut columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let width = columns.len();
    for _ in 0..60 {
        let mut turned = false;
        for p in 0..width {
            for q in p + 1..width {
                turned |= rotate(&mut columns, p, q);
            }
        }
        if !turned {
            break;
        }
    }
    columns
}

/// Householder reflections; afterwards only the upper triangle is kept.
fn reduce_to_triangle(columns: &mut [Vec<f64>]) {
    let width = columns.len();
    for step in 0..width {
        let (done, rest) = columns.split_at_mut(step + 1);
        let pivot = &mut done[step];
        let norm = dot(&pivot[step..], &pivot[step..]).sqrt();
        if norm > 0.0 {
            let diagonal = -norm.copysign(pivot[step]);
            pivot[step] -= diagonal;
            let half = 0.5 * dot(&pivot[step..], &pivot[step..]);
            for column in rest {
                let factor = dot(&pivot[step..], &column[step..]) / half;
                for (c, v) in column[step..].iter_mut().zip(&pivot[step..]) {
                    *c -= factor * v;
                }
            }
            pivot[step] = diagonal;
        }
        pivot.truncate(step + 1);
        pivot.resize(width, 0.0);
    }
}

/// Makes two columns orthogonal; false if they already are.
fn rotate(columns: &mut [Vec<f64>], p: usize, q: usize) -> bool {
    let (left, right) = columns.split_at_mut(q);
    let (a, b) = (&mut left[p], &mut right[0]);
    let (aa, bb, ab) = (dot(a, a), dot(b, b), dot(a, b));
    if ab.abs() <= 1e-15 * (aa * bb).sqrt() || ab.abs() < f64::MIN_POSITIVE {
        return false;
    }
    let zeta = (bb - aa) / (2.0 * ab);
    let tangent = 1.0_f64.copysign(zeta) / (zeta.abs() + libm::hypot(zeta, 1.0));
    let cosine = 1.0 / libm::hypot(tangent, 1.0);
    let sine = cosine * tangent;
    for (x, y) in a.iter_mut().zip(b.iter_mut()) {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trace_and_determinant_are_kept() {
        let columns = vec![
            vec![1.0, 2.0, -1.0, 0.5, 3.0],
            vec![0.0, 1.0, 4.0, -2.0, 1.0],
            vec![2.0, 2.5, 1.0, 0.0, 1.5],
        ];
        let trace: f64 = columns.iter().map(|c| dot(c, c)).sum();
        let g = |i: usize, j: usize| dot(&columns[i], &columns[j]);
        let det = g(0, 0) * (g(1, 1) * g(2, 2) - g(1, 2) * g(2, 1))
            - g(0, 1) * (g(1, 0) * g(2, 2) - g(1, 2) * g(2, 0))
            + g(0, 2) * (g(1, 0) * g(2, 1) - g(1, 1) * g(2, 0));
        let values = squared_singular_values(columns);
        assert!((values.iter().sum::<f64>() - trace).abs() < 1e-12);
        assert!((values.iter().product::<f64>() / det - 1.0).abs() < 1e-12);
    }
}
