//! Small systems of equations: a Cholesky factor, distances by a covariance, least squares.

/// The lower factor L of a positive definite matrix, A = L Lᵀ.
#[derive(Debug, Clone)]
pub(super) struct Cholesky {
    /// Row by row, up to the diagonal.
    lower: Vec<Vec<f64>>,
}

/// A pivot below this share of its diagonal counts as zero.
const SINGULAR: f64 = 1e-10;

impl Cholesky {
    /// Factors `matrix`, shape `(d, d)`; `None` if it is not positive definite.
    pub(super) fn of(matrix: &[Vec<f64>]) -> Option<Self> {
        let mut lower: Vec<Vec<f64>> = Vec::with_capacity(matrix.len());
        for (i, line) in matrix.iter().enumerate() {
            let mut row = vec![0.0; i + 1];
            for j in 0..=i {
                let before: f64 = if j < i {
                    (0..j).map(|k| row[k] * lower[j][k]).sum()
                } else {
                    row[..j].iter().map(|x| x * x).sum()
                };
                let rest = line[j] - before;
                row[j] = if j < i {
                    rest / lower[j][j]
                } else if rest > SINGULAR * line[i].abs() {
                    rest.sqrt()
                } else {
                    return None;
                };
            }
            lower.push(row);
        }
        Some(Self { lower })
    }

    /// L⁻¹ b: in these coordinates the covariance A is the identity.
    pub(super) fn whiten(&self, b: &[f64]) -> Vec<f64> {
        let mut x: Vec<f64> = Vec::with_capacity(b.len());
        for (row, b) in self.lower.iter().zip(b) {
            let done = x.len();
            let before: f64 = row.iter().zip(&x).map(|(l, x)| l * x).sum();
            x.push((b - before) / row[done]);
        }
        x
    }

    /// ln of the determinant of A.
    pub(super) fn ln_determinant(&self) -> f64 {
        let diagonal = self.lower.iter().enumerate().map(|(i, row)| row[i]);
        2.0 * diagonal.map(f64::ln).sum::<f64>()
    }

    /// A⁻¹ b.
    pub(super) fn solve(&self, b: &[f64]) -> Vec<f64> {
        let mut x = self.whiten(b);
        for i in (0..x.len()).rev() {
            let after: f64 = (i + 1..x.len()).map(|k| self.lower[k][i] * x[k]).sum();
            x[i] = (x[i] - after) / self.lower[i][i];
        }
        x
    }
}

/// Intercept, then a slope a column, of y on the columns of `x`, shape `(n, d)`; `None` if they do not determine it.
pub(super) fn least_squares(x: &[Vec<f64>], y: &[f64]) -> Option<Vec<f64>> {
    let rows: Vec<Vec<f64>> = x
        .iter()
        .map(|row| std::iter::once(1.0).chain(row.iter().copied()).collect())
        .collect();
    let d = rows.first()?.len();
    let product = |i: usize, j: usize| rows.iter().map(|r| r[i] * r[j]).sum::<f64>();
    let normal: Vec<Vec<f64>> = (0..d)
        .map(|i| (0..d).map(|j| product(i, j)).collect())
        .collect();
    let right: Vec<f64> = (0..d)
        .map(|i| rows.iter().zip(y).map(|(r, y)| r[i] * y).sum())
        .collect();
    Some(Cholesky::of(&normal)?.solve(&right))
}

/// What `coefficients` of [`least_squares`] say of one row.
pub(super) fn predicted(coefficients: &[f64], row: &[f64]) -> f64 {
    let slopes = coefficients.iter().skip(1).zip(row);
    coefficients[0] + slopes.map(|(b, x)| b * x).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factored_matrix_solves_and_whitens() {
        let a = [vec![4.0, 2.0], vec![2.0, 3.0]];
        let factor = Cholesky::of(&a).unwrap();
        let x = factor.solve(&[2.0, 5.0]);
        assert!(
            (x[0] + 0.5).abs() < 1e-12 && (x[1] - 2.0).abs() < 1e-12,
            "{x:?}"
        );
        let white = factor.whiten(&[2.0, 1.0]);
        // |L⁻¹ b|² = bᵀ A⁻¹ b = 1.
        assert!((white.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(Cholesky::of(&[vec![1.0, 1.0], vec![1.0, 1.0]]).is_none());
    }

    #[test]
    fn least_squares_finds_the_plane_it_was_given() {
        let x: Vec<Vec<f64>> = (0..6)
            .map(|i| vec![f64::from(i), f64::from(i * i % 5)])
            .collect();
        let y: Vec<f64> = x.iter().map(|r| 2.0 - r[0] + 0.5 * r[1]).collect();
        let b = least_squares(&x, &y).unwrap();
        for (found, wanted) in b.iter().zip([2.0, -1.0, 0.5]) {
            assert!((found - wanted).abs() < 1e-9, "{b:?}");
        }
        assert!((predicted(&b, &[3.0, 2.0])).abs() < 1e-9);
    }
}
