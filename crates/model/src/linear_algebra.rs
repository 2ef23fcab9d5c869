//! Small symmetric matrices: eigenvectors, roots, mean and covariance. Matrices are row by row.

/// Eigenvalues, largest first, and eigenvectors (one a row) of a symmetric `(n, n)` matrix, by Jacobi's
/// rotations. Each vector's largest component is positive.
pub(crate) fn symmetric_eigen(matrix: &[f64], n: usize) -> (Vec<f64>, Vec<Vec<f64>>) {
    let mut a = matrix.to_vec();
    let mut v = vec![0.0; n * n];
    for i in 0..n {
        v[i * n + i] = 1.0;
    }
    let scale: f64 = a.iter().map(|x| x * x).sum();
    for _ in 0..100 {
        let off: f64 = (0..n)
            .flat_map(|i| (0..i).map(move |j| (i, j)))
            .map(|(i, j)| a[i * n + j] * a[i * n + j])
            .sum();
        if off <= 1e-30 * scale {
            break;
        }
        for p in 0..n {
            for q in p + 1..n {
                rotate(&mut a, &mut v, n, p, q);
            }
        }
    }
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| a[j * n + j].total_cmp(&a[i * n + i]));
    let values = order.iter().map(|&i| a[i * n + i]).collect();
    let vectors = order.iter().map(|&i| {
        let vector: Vec<f64> = (0..n).map(|k| v[k * n + i]).collect();
        let largest = vector
            .iter()
            .copied()
            .max_by(|x, y| x.abs().total_cmp(&y.abs()));
        let sign = largest.unwrap_or(1.0).signum();
        vector.into_iter().map(|x| x * sign).collect()
    });
    (values, vectors.collect())
}

fn rotate(a: &mut [f64], v: &mut [f64], n: usize, p: usize, q: usize) {
    let apq = a[p * n + q];
    if apq.abs() < f64::MIN_POSITIVE {
        return;
    }
    let theta = (a[q * n + q] - a[p * n + p]) / (2.0 * apq);
    let t = 1.0_f64.copysign(theta) / (theta.abs() + theta.hypot(1.0));
    let c = 1.0 / t.hypot(1.0);
    let s = t * c;
    for k in 0..n {
        let (x, y) = (a[k * n + p], a[k * n + q]);
        a[k * n + p] = c * x - s * y;
        a[k * n + q] = s * x + c * y;
    }
    for k in 0..n {
        let (x, y) = (a[p * n + k], a[q * n + k]);
        a[p * n + k] = c * x - s * y;
        a[q * n + k] = s * x + c * y;
        let (x, y) = (v[k * n + p], v[k * n + q]);
        v[k * n + p] = c * x - s * y;
        v[k * n + q] = s * x + c * y;
    }
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
