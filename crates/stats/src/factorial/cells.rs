//! Means of groups and cells, residuals, and linear combinations of both.

use super::design::FactorialDesign;
use crate::numerics::{
    matrix::Matrix,
    moments::{dot, largest},
};

/// Rows of weights over the cells of several factors.
pub(super) type Rows = Vec<Vec<f64>>;

/// The mean over the levels of a factor.
pub(super) fn average(levels: usize) -> Rows {
    vec![vec![1.0 / levels as f64; levels]]
}

/// The same, of length 1.
pub(super) fn unit_average(levels: usize) -> Rows {
    vec![vec![1.0 / (levels as f64).sqrt(); levels]]
}

/// Weight 1 on the level at position `at`, 0 on the others.
pub(super) fn level(levels: usize, at: usize) -> Rows {
    vec![(0..levels).map(|i| if i == at { 1.0 } else { 0.0 }).collect()]
}

/// One level less another.
pub(super) fn difference(levels: usize, a: usize, b: usize) -> Rows {
    let mut row = vec![0.0; levels];
    (row[a], row[b]) = (1.0, -1.0);
    vec![row]
}

/// Helmert's contrasts, orthogonal and of length 1.
pub(crate) fn contrasts(levels: usize) -> Rows {
    (1..levels)
        .map(|j| {
            let norm = ((j * (j + 1)) as f64).sqrt();
            let weight = |i: usize| match i.cmp(&j) {
                std::cmp::Ordering::Less => 1.0 / norm,
                std::cmp::Ordering::Equal => -(j as f64) / norm,
                std::cmp::Ordering::Greater => 0.0,
            };
            (0..levels).map(weight).collect()
        })
        .collect()
}

/// Every product of a row of each factor, over the cells of all; one row of one cell without factors.
pub(super) fn products(parts: &[Rows]) -> Rows {
    parts.iter().fold(vec![vec![1.0]], |rows, part| {
        let product = |row: &Vec<f64>, weights: &Vec<f64>| {
            row.iter().flat_map(|r| weights.iter().map(move |w| r * w)).collect()
        };
        rows.iter().flat_map(|row| part.iter().map(move |weights| product(row, weights))).collect()
    })
}

/// The sums that all tests of one table are made of.
pub(super) struct Cells<'a> {
    pub(super) design: &'a FactorialDesign,
    /// Subjects of each group.
    sizes: Vec<f64>,
    /// Groups by cells, less [`pivot`](Self::pivot).
    means: Matrix,
    /// Subjects by cells, less the mean of group and cell.
    residuals: Matrix,
    pub(super) pivot: f64,
    /// The largest magnitude of a value, whose rounding is that of the data.
    scale: f64,
    /// n - groups.
    pub(super) freedom: usize,
}

impl<'a> Cells<'a> {
    /// `values` has the shape of those of the design and stands in their place.
    pub(super) fn new(design: &'a FactorialDesign, values: &[f64]) -> Self {
        let (n, groups, width) = (design.n(), design.groups(), design.cells());
        let pivot = values[0];
        let mut sizes = vec![0.0; groups];
        let mut means = Matrix::zeros(groups, width);
        let mut residuals = Matrix::from(n, width, |i, j| values[i * width + j] - pivot);
        for (i, &g) in design.group.iter().enumerate() {
            sizes[g] += 1.0;
            for j in 0..width {
                means[(g, j)] += residuals[(i, j)];
            }
        }
        for (g, size) in sizes.iter().enumerate() {
            for j in 0..width {
                means[(g, j)] /= size;
            }
        }
        for (i, &g) in design.group.iter().enumerate() {
            for j in 0..width {
                residuals[(i, j)] -= means[(g, j)];
            }
        }
        Self { design, sizes, means, residuals, pivot, scale: largest(values), freedom: n - groups }
    }

    /// The residuals of a combination of cells, a number a subject; exactly 0 if all are no more than rounding of the data.
    pub(super) fn error(&self, cells: &[f64]) -> Vec<f64> {
        let column: Vec<f64> =
            (0..self.residuals.rows).map(|i| dot(self.residuals.row(i), cells)).collect();
        let weight: f64 = cells.iter().map(|w| w.abs()).sum();
        let rounding = 8.0 * f64::EPSILON * self.scale * weight;
        if column.iter().all(|e| e.abs() <= rounding) {
            return vec![0.0; column.len()];
        }
        column
    }

    /// Sum of squares of [`error`](Self::error).
    pub(super) fn error_square(&self, cells: &[f64]) -> f64 {
        let error = self.error(cells);
        dot(&error, &error)
    }

    /// The mean of a combination of groups and cells.
    pub(super) fn mean(&self, groups: &[f64], cells: &[f64]) -> f64 {
        let weighted_mean = |(g, weight): (usize, &f64)| weight * dot(self.means.row(g), cells);
        groups.iter().enumerate().map(weighted_mean).sum()
    }

    /// Σ w² / n: how far the mean of a combination of groups varies.
    pub(super) fn spread(&self, groups: &[f64]) -> f64 {
        groups.iter().zip(&self.sizes).map(|(w, n)| w * w / n).sum()
    }

    /// θᵀ (L D⁻¹ Lᵀ)⁻¹ θ of each combination of cells, summed; θ = L M, with L the rows of weights of the groups.
    ///
    /// This is the sum of squares of the hypothesis L M = 0, whatever the sizes of the groups: type III.
    pub(super) fn hypothesis(&self, groups: &Rows, cells: &Rows) -> f64 {
        let r = groups.len();
        let spread = Matrix::from(r, r, |i, j| {
            let parts = groups[i].iter().zip(&groups[j]).zip(&self.sizes);
            parts.map(|((a, b), n)| a * b / n).sum()
        });
        let Some(factor) = spread.cholesky() else {
            // Independent rows over groups that all have subjects.
            return 0.0;
        };
        let theta = Matrix::from(r, cells.len(), |i, j| self.mean(&groups[i], &cells[j]));
        let half = factor.half_solve(&theta);
        (0..r).map(|i| dot(half.row(i), half.row(i))).sum()
    }
}
