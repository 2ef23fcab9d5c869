//! How many degrees of freedom the error of a coefficient has.

use super::blocks::Blocks;
use crate::numerics::matrix::Matrix;

/// Satterthwaite's degrees of freedom of each coefficient; `None` if the variances have no information at all.
///
/// With C = (XᵀV⁻¹X)⁻¹ and the variances ω (the entries of Ψ σ², and σ²): 2 C²ⱼⱼ / (gᵀ I⁻¹ g), g the derivative of Cⱼⱼ by ω, I the
/// expected information ½ tr(P V̇ P V̇) of the restricted likelihood.
///
/// # Source
/// Giesbrecht and Burns (1985); Searle, Casella and McCulloch (1992), section 6.6 for the information.
pub(super) fn degrees_of_freedom(
    blocks: &Blocks,
    psi: &Matrix,
    variance: f64,
) -> Option<Vec<Option<f64>>> {
    let (p, q) = (blocks.p, blocks.q);
    let pairs: Vec<(usize, usize)> = (0..q).flat_map(|i| (0..=i).map(move |j| (i, j))).collect();
    let count = pairs.len() + 1;
    let mut information = Matrix::zeros(count, count);
    let mut first = vec![Matrix::zeros(p, p); count];
    let mut second = vec![Matrix::zeros(p, p); count * count];
    let mut xx = Matrix::zeros(p, p);
    for block in &blocks.subjects {
        let rows = block.y.rows;
        let mut v = block.z.times(psi).times(&block.z.transposed());
        v.add(&Matrix::identity(rows), 1.0);
        let mut inverse = Matrix::zeros(rows, rows);
        inverse.add(&v.cholesky()?.inverse(), 1.0 / variance);
        let xv = block.x.transposed_times(&inverse);
        xx.add(&xv.times(&block.x), 1.0);
        let derivative = |k: usize| match pairs.get(k) {
            Some(&(i, j)) => Matrix::from(rows, rows, |a, b| {
                let product = block.z[(a, i)] * block.z[(b, j)];
                if i == j {
                    product
                } else {
                    product + block.z[(a, j)] * block.z[(b, i)]
                }
            }),
            None => Matrix::identity(rows),
        };
        // V⁻¹ V̇ and Xᵀ V⁻¹ V̇ V⁻¹.
        let turned: Vec<Matrix> = (0..count).map(|k| inverse.times(&derivative(k))).collect();
        let sides: Vec<Matrix> = (0..count)
            .map(|k| xv.times(&derivative(k)).times(&inverse))
            .collect();
        for j in 0..count {
            first[j].add(&sides[j].times(&block.x), 1.0);
            for k in 0..=j {
                information[(j, k)] += 0.5 * turned[j].trace_of_product(&turned[k]);
                let whole = sides[j].times(&derivative(k)).times(&xv.transposed());
                second[j * count + k].add(&whole, 1.0);
            }
        }
    }
    let c = xx.cholesky()?.inverse();
    let cq: Vec<Matrix> = first.iter().map(|m| c.times(m)).collect();
    for j in 0..count {
        for k in 0..=j {
            let inner = c.trace_of_product(&second[j * count + k]);
            information[(j, k)] += 0.5 * cq[j].trace_of_product(&cq[k]) - inner;
            information[(k, j)] = information[(j, k)];
        }
    }
    let covariance = scaled_inverse(&information)?;
    let one = |j: usize| {
        // ∂C/∂ω = C Q C
        let g: Vec<f64> = cq.iter().map(|m| m.times(&c)[(j, j)]).collect();
        let spread = covariance.between(&g, &g);
        Some(2.0 * c[(j, j)].powi(2) / spread).filter(|df| df.is_finite() && *df > 0.0)
    };
    Some((0..p).map(one).collect())
}

/// The inverse, taken of the matrix with ones on its diagonal: variances of slopes and intercepts have different units.
fn scaled_inverse(matrix: &Matrix) -> Option<Matrix> {
    let size: Vec<f64> = (0..matrix.rows).map(|i| matrix[(i, i)].sqrt()).collect();
    if size.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
        return None;
    }
    let scaled = Matrix::from(matrix.rows, matrix.rows, |i, j| {
        matrix[(i, j)] / (size[i] * size[j])
    });
    let inverse = scaled.cholesky()?.inverse();
    Some(Matrix::from(matrix.rows, matrix.rows, |i, j| {
        inverse[(i, j)] / (size[i] * size[j])
    }))
}
