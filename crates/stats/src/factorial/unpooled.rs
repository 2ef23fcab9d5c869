//! F of every effect with the covariance of each group on its own.

use super::{Effect, FactorialDesign, cells::Cells};
use crate::numerics::{distributions::f_upper, moments::dot};

/// F of one effect without the assumption that groups vary alike, or cells within subjects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Unpooled {
    pub(crate) f: f64,
    pub(crate) df1: f64,
    pub(crate) df2: f64,
    pub(crate) p: f64,
}

/// F of an effect's sum of squares over what the groups' own covariances let it be: none where that is 0 or a group has one subject.
///
/// With θ the effect's contrasts of cells in each group, P the projection of the groups' contrasts, Sg the covariance of the contrasts
/// in group g and V = diag(Sg / ng): F = θᵀ(P ⊗ I)θ / tr((P ⊗ I)V), with tr²/tr(((P ⊗ I)V)²) and tr²/Σ Pgg² tr(Sg²)/(ng² (ng - 1))
/// degrees of freedom. Of two groups and one contrast it is the square of Welch's t, of one group Greenhouse and Geisser's test.
///
/// # Source
/// Box (1954); Brunner, Dette and Munk (1997), whose second degrees of freedom are these.
pub(super) fn test(effect: Effect, cells: &Cells) -> Option<Unpooled> {
    let (groups, within) = effect.rows(cells);
    let count = cells.design.groups();
    // Contrasts within subjects are orthonormal, those of groups orthogonal.
    let projection = |g: usize, h: usize| -> f64 {
        let entry = |row: &Vec<f64>| row[g] * row[h] / dot(row, row);
        groups.iter().map(entry).sum()
    };
    let mean = |g: usize, row: &[f64]| {
        let only: Vec<f64> = (0..count).map(|h| f64::from(u8::from(h == g))).collect();
        cells.mean(&only, row)
    };
    let theta: Vec<Vec<f64>> =
        (0..count).map(|g| within.iter().map(|row| mean(g, row)).collect()).collect();
    let errors: Vec<Vec<f64>> = within.iter().map(|row| cells.error(row)).collect();
    let mut sizes = vec![0.0; count];
    for &g in &cells.design.group {
        sizes[g] += 1.0;
    }
    if sizes.iter().any(|n| *n < 2.0) {
        return None;
    }
    // Sg / ng
    let d = within.len();
    let mut spread = vec![vec![0.0; d * d]; count];
    for (person, &g) in cells.design.group.iter().enumerate() {
        for a in 0..d {
            for b in 0..d {
                spread[g][a * d + b] +=
                    errors[a][person] * errors[b][person] / ((sizes[g] - 1.0) * sizes[g]);
            }
        }
    }
    let trace = |g: usize| (0..d).map(|a| spread[g][a * d + a]).sum::<f64>();
    let (mut square, mut expected, mut twice, mut uncertain) = (0.0, 0.0, 0.0, 0.0);
    for g in 0..count {
        expected += projection(g, g) * trace(g);
        uncertain += projection(g, g).powi(2) * dot(&spread[g], &spread[g]) / (sizes[g] - 1.0);
        for h in 0..count {
            square += projection(g, h) * dot(&theta[g], &theta[h]);
            twice += projection(g, h).powi(2) * dot(&spread[g], &spread[h]);
        }
    }
    if expected <= 0.0 {
        return None;
    }
    let (f, df1, df2) =
        (square / expected, expected * expected / twice, expected * expected / uncertain);
    Some(Unpooled { f, df1, df2, p: f_upper(f, df1, df2) })
}

/// The test of each effect, by its name.
pub(crate) fn unpooled(design: &FactorialDesign) -> Vec<(String, Option<Unpooled>)> {
    let cells = Cells::new(design, &design.values);
    Effect::all(design)
        .into_iter()
        .map(|effect| (effect.name(design), test(effect, &cells)))
        .collect()
}
