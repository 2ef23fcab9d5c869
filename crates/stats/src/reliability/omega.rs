//! McDonald's omega of one factor.

/// ω = (Σ loadings)² / ((Σ loadings)² + Σ uniquenesses) of the one-factor model of the
/// correlations, fitted by least squares (iterated principal axis, the minimum-residual
/// solution). `None` with fewer than three items or an improper solution.
///
/// # Source
/// McDonald (1999); fitted like `psych::fa(fm = "minres")`.
pub(super) fn total(covariances: &[Vec<f64>]) -> Option<f64> {
    let k = covariances.len();
    if k < 3 || (0..k).any(|i| covariances[i][i] <= 0.0) {
        return None;
    }
    let r = |i: usize, j: usize| {
        covariances[i][j] / (covariances[i][i].sqrt() * covariances[j][j].sqrt())
    };
    // Minimising Σ over i ≠ j of (r - l_i l_j)² one loading at a time converges to the
    // minimum-residual solution and needs no eigenvalues.
    let start = |i: usize| {
        let sum: f64 = (0..k).filter(|&j| j != i).map(|j| r(i, j)).sum();
        (sum / (k - 1) as f64).abs().sqrt().copysign(sum)
    };
    let mut loadings: Vec<f64> = (0..k).map(start).collect();
    for _ in 0..20_000 {
        let mut change = 0.0_f64;
        for i in 0..k {
            let (mut product, mut square) = (0.0, 0.0);
            for j in (0..k).filter(|&j| j != i) {
                product += r(i, j) * loadings[j];
                square += loadings[j] * loadings[j];
            }
            if square <= 0.0 {
                return None;
            }
            let next = product / square;
            change = change.max((next - loadings[i]).abs());
            loadings[i] = next;
        }
        if change < 1e-13 {
            break;
        }
    }
    let common = loadings.iter().sum::<f64>().powi(2);
    let unique: f64 = loadings.iter().map(|l| 1.0 - l * l).sum();
    let proper = loadings.iter().all(|l| l.is_finite() && l.abs() <= 1.0);
    proper.then(|| common / (common + unique))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loadings_of_an_exact_one_factor_model_are_recovered() {
        let l = [0.9, 0.7, 0.5, 0.6];
        let matrix: Vec<Vec<f64>> = (0..4)
            .map(|i| (0..4).map(|j| if i == j { 1.0 } else { l[i] * l[j] }).collect())
            .collect();
        let common = 2.7_f64.powi(2);
        let unique: f64 = l.iter().map(|l| 1.0 - l * l).sum();
        assert!((total(&matrix).unwrap() - common / (common + unique)).abs() < 1e-9);
    }
}
