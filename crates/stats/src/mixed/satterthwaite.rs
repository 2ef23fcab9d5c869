//! How many degrees of freedom the error of a coefficient has.

use super::blocks::Blocks;
use crate::numerics::matrix::Matrix;

/// Which information of the variances is inverted.
#[derive(Clone, Copy)]
pub(super) enum Information<'a> {
    /// ½ tr(P V̇ P V̇): positive definite at the edge too.
    Expected,
    /// yᵀ P V̇ P V̇ P y - ½ tr(P V̇ P V̇), given β; without the variances of u where all of them are zero, as the likelihood is flat
    /// in their square roots there.
    Observed(&'a Matrix),
}

/// What Satterthwaite's degrees of freedom of any combination of coefficients need.
///
/// With C = (XᵀV⁻¹X)⁻¹ and the variances ω (each shared by some entries of Ψ σ²; and σ²), I the information of the restricted likelihood.
///
/// # Source
/// Giesbrecht and Burns (1985); Searle, Casella and McCulloch (1992), section 6.6 for the information.
pub(super) struct Satterthwaite {
    c: Matrix,
    /// ∂C/∂ω.
    slopes: Vec<Matrix>,
    /// I⁻¹.
    covariance: Matrix,
}

impl Satterthwaite {
    /// `shared` has the entries (i, j), j ≤ i, of Ψ that each variance stands at. `None` if the variances have no information at all.
    pub(super) fn new(
        blocks: &Blocks,
        psi: &Matrix,
        variance: f64,
        kind: Information,
        shared: &[Vec<(usize, usize)>],
    ) -> Option<Self> {
        let p = blocks.p;
        let flat = matches!(kind, Information::Observed(_)) && psi.trace_of_product(psi) <= 0.0;
        let shared = if flat { &[] } else { shared };
        let count = shared.len() + 1;
        let mut information = Matrix::zeros(count, count);
        let mut observed = Matrix::zeros(count, count);
        let mut first = vec![Matrix::zeros(p, p); count];
        let mut second = vec![Matrix::zeros(p, p); count * count];
        let mut pulls = vec![Matrix::zeros(p, 1); count];
        let mut xx = Matrix::zeros(p, p);
        for block in &blocks.subjects {
            let rows = block.y.rows;
            let mut v = block.z.times(psi).times(&block.z.transposed());
            v.add(&Matrix::identity(rows), 1.0);
            let mut inverse = Matrix::zeros(rows, rows);
            inverse.add(&v.cholesky()?.inverse(), 1.0 / variance);
            let xv = block.x.transposed_times(&inverse);
            xx.add(&xv.times(&block.x), 1.0);
            let derivative = |k: usize| match shared.get(k) {
                Some(entries) => Matrix::from(rows, rows, |a, b| {
                    let one = |&(i, j): &(usize, usize)| {
                        let product = block.z[(a, i)] * block.z[(b, j)];
                        if i == j { product } else { product + block.z[(a, j)] * block.z[(b, i)] }
                    };
                    entries.iter().map(one).sum()
                }),
                None => Matrix::identity(rows),
            };
            // V⁻¹ V̇ and Xᵀ V⁻¹ V̇ V⁻¹.
            let turned: Vec<Matrix> = (0..count).map(|k| inverse.times(&derivative(k))).collect();
            let sides: Vec<Matrix> =
                (0..count).map(|k| xv.times(&derivative(k)).times(&inverse)).collect();
            for j in 0..count {
                first[j].add(&sides[j].times(&block.x), 1.0);
                for k in 0..=j {
                    information[(j, k)] += 0.5 * turned[j].trace_of_product(&turned[k]);
                    let whole = sides[j].times(&derivative(k)).times(&xv.transposed());
                    second[j * count + k].add(&whole, 1.0);
                }
            }
            if let Information::Observed(beta) = kind {
                let mut rest = block.y.clone();
                rest.add(&block.x.times(beta), -1.0);
                // V̇ V⁻¹ (y - X β)
                let rest = inverse.times(&rest);
                let pushed: Vec<Matrix> = (0..count).map(|k| derivative(k).times(&rest)).collect();
                for j in 0..count {
                    pulls[j].add(&xv.times(&pushed[j]), 1.0);
                    for k in 0..=j {
                        let inner = inverse.times(&pushed[k]);
                        observed[(j, k)] += pushed[j].transposed_times(&inner)[(0, 0)];
                    }
                }
            }
        }
        let c = xx.cholesky()?.inverse();
        let cq: Vec<Matrix> = first.iter().map(|m| c.times(m)).collect();
        for j in 0..count {
            for k in 0..=j {
                let inner = c.trace_of_product(&second[j * count + k]);
                information[(j, k)] += 0.5 * cq[j].trace_of_product(&cq[k]) - inner;
                if matches!(kind, Information::Observed(_)) {
                    let pulled = pulls[j].transposed_times(&c.times(&pulls[k]))[(0, 0)];
                    information[(j, k)] = observed[(j, k)] - pulled - information[(j, k)];
                }
                information[(k, j)] = information[(j, k)];
            }
        }
        Some(Self {
            // ∂C/∂ω = C Q C
            slopes: cq.iter().map(|m| m.times(&c)).collect(),
            covariance: scaled_inverse(&information)?,
            c,
        })
    }

    /// Degrees of freedom of the combination lᵀβ: 2 (lᵀ C l)² / (gᵀ I⁻¹ g), g the derivative of lᵀ C l by ω.
    pub(super) fn df(&self, l: &[f64]) -> Option<f64> {
        let g: Vec<f64> = self.slopes.iter().map(|slope| slope.between(l, l)).collect();
        let spread = self.covariance.between(&g, &g);
        Some(2.0 * self.c.between(l, l).powi(2) / spread).filter(|df| df.is_finite() && *df > 0.0)
    }
}

/// The inverse, taken of the matrix with ones on its diagonal: variances of slopes and intercepts have different units.
fn scaled_inverse(matrix: &Matrix) -> Option<Matrix> {
    let size: Vec<f64> = (0..matrix.rows).map(|i| matrix[(i, i)].sqrt()).collect();
    if size.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
        return None;
    }
    let scaled =
        Matrix::from(matrix.rows, matrix.rows, |i, j| matrix[(i, j)] / (size[i] * size[j]));
    let inverse = scaled.cholesky()?.inverse();
    Some(Matrix::from(matrix.rows, matrix.rows, |i, j| inverse[(i, j)] / (size[i] * size[j])))
}
