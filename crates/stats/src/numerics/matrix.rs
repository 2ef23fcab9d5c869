//! Small dense matrices, by rows.

/// `rows` × `columns` numbers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Matrix {
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    values: Vec<f64>,
}

impl std::ops::Index<(usize, usize)> for Matrix {
    type Output = f64;
    fn index(&self, (i, j): (usize, usize)) -> &f64 {
        &self.values[i * self.columns + j]
    }
}

impl std::ops::IndexMut<(usize, usize)> for Matrix {
    fn index_mut(&mut self, (i, j): (usize, usize)) -> &mut f64 {
        &mut self.values[i * self.columns + j]
    }
}

impl Matrix {
    pub(crate) fn zeros(rows: usize, columns: usize) -> Self {
        Self { rows, columns, values: vec![0.0; rows * columns] }
    }

    pub(crate) fn identity(size: usize) -> Self {
        Self::diagonal(size, |_| 1.0)
    }

    pub(crate) fn diagonal(size: usize, entry: impl Fn(usize) -> f64) -> Self {
        Self::from(size, size, |i, j| if i == j { entry(i) } else { 0.0 })
    }

    pub(crate) fn from(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
        let mut matrix = Self::zeros(rows, columns);
        for i in 0..rows {
            for j in 0..columns {
                matrix[(i, j)] = entry(i, j);
            }
        }
        matrix
    }

    pub(crate) fn row(&self, i: usize) -> &[f64] {
        &self.values[i * self.columns..(i + 1) * self.columns]
    }

    pub(crate) fn transposed(&self) -> Self {
        Self::from(self.columns, self.rows, |i, j| self[(j, i)])
    }

    /// self · other.
    pub(crate) fn times(&self, other: &Self) -> Self {
        let mut product = Self::zeros(self.rows, other.columns);
        for i in 0..self.rows {
            for k in 0..self.columns {
                let factor = self[(i, k)];
                let from = k * other.columns;
                let to = i * other.columns;
                for j in 0..other.columns {
                    product.values[to + j] += factor * other.values[from + j];
                }
            }
        }
        product
    }

    /// selfᵀ · other.
    pub(crate) fn transposed_times(&self, other: &Self) -> Self {
        self.transposed().times(other)
    }

    pub(crate) fn add(&mut self, other: &Self, factor: f64) {
        for (to, from) in self.values.iter_mut().zip(&other.values) {
            *to += factor * from;
        }
    }

    /// Trace of self · other, both square and of one size.
    pub(crate) fn trace_of_product(&self, other: &Self) -> f64 {
        (0..self.rows)
            .flat_map(|i| (0..self.columns).map(move |j| (i, j)))
            .map(|(i, j)| self[(i, j)] * other[(j, i)])
            .sum()
    }

    /// aᵀ · self · b.
    pub(crate) fn between(&self, a: &[f64], b: &[f64]) -> f64 {
        (0..self.rows)
            .map(|i| {
                let row: f64 = self.row(i).iter().zip(b).map(|(m, b)| m * b).sum();
                a[i] * row
            })
            .sum()
    }

    /// The lower Cholesky factor; `None` if the matrix is not positive definite to working precision.
    pub(crate) fn cholesky(&self) -> Option<Cholesky> {
        let n = self.rows;
        let mut l = Self::zeros(n, n);
        for j in 0..n {
            for i in j..n {
                let known: f64 = (0..j).map(|k| l[(i, k)] * l[(j, k)]).sum();
                let rest = self[(i, j)] - known;
                if i == j {
                    // Also refuses NaN.
                    if !(rest > 1e-13 * self[(j, j)].abs() && rest.is_finite()) {
                        return None;
                    }
                    l[(j, j)] = rest.sqrt();
                } else {
                    l[(i, j)] = rest / l[(j, j)];
                }
            }
        }
        Some(Cholesky(l))
    }
}

/// L with L·Lᵀ = A.
#[derive(Debug, Clone)]
pub(crate) struct Cholesky(Matrix);

impl Cholesky {
    pub(crate) fn lower(self) -> Matrix {
        self.0
    }

    pub(crate) fn ln_determinant(&self) -> f64 {
        (0..self.0.rows).map(|i| 2.0 * libm::log(self.0[(i, i)])).sum()
    }

    /// L⁻¹ · b.
    pub(crate) fn half_solve(&self, b: &Matrix) -> Matrix {
        let l = &self.0;
        let mut x = b.clone();
        for c in 0..b.columns {
            for i in 0..l.rows {
                let known: f64 = (0..i).map(|k| l[(i, k)] * x[(k, c)]).sum();
                x[(i, c)] = (x[(i, c)] - known) / l[(i, i)];
            }
        }
        x
    }

    /// A⁻¹ · b.
    pub(crate) fn solve(&self, b: &Matrix) -> Matrix {
        let l = &self.0;
        let mut x = self.half_solve(b);
        for c in 0..b.columns {
            for i in (0..l.rows).rev() {
                let known: f64 = (i + 1..l.rows).map(|k| l[(k, i)] * x[(k, c)]).sum();
                x[(i, c)] = (x[(i, c)] - known) / l[(i, i)];
            }
        }
        x
    }

    pub(crate) fn inverse(&self) -> Matrix {
        self.solve(&Matrix::identity(self.0.rows))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_inverse_undoes_its_matrix_and_a_singular_one_has_none() {
        let a =
            Matrix::from(3, 3, |i, j| [[4.0, 1.0, 0.5], [1.0, 3.0, -1.0], [0.5, -1.0, 2.0]][i][j]);
        let factor = a.cholesky().unwrap();
        let one = a.times(&factor.inverse());
        for i in 0..3 {
            for j in 0..3 {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((one[(i, j)] - expected).abs() < 1e-14);
            }
        }
        // 4 (3·2 − 1) − 1 (2 + .5) + .5 (−1 − 1.5)
        assert!((factor.ln_determinant() - 16.25_f64.ln()).abs() < 1e-14);
        assert!(Matrix::from(2, 2, |_, _| 1.0).cholesky().is_none());
    }
}
