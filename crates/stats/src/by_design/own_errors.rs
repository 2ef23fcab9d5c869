//! Pairs of conditions with an error of their own: the model takes all of them to differ between people alike.

use super::DesignColumns;
use crate::{
    MarginalContrast, Named,
    numerics::{matrix::Matrix, moments::dot, spectrum::principal_axes},
    within_subjects::{Index, pairs},
};

/// Every pair of the levels of one factor within subjects, period taken out, over the spread of that difference between people.
///
/// The estimate is that of the model; its variance is that of the people's own contrasts, each over what the fit leaves of it, with
/// Satterthwaite's degrees of freedom. Without periods this is the paired t test. `None` unless every subject has every level.
///
/// # Source
/// Bell and McCaffrey (2002); Pustejovsky and Tipton (2018), CR2 with subjects absorbed.
pub(super) fn own_errors(
    data: &DesignColumns<'_>,
    conditions: &[String],
) -> Option<Named<MarginalContrast>> {
    let fit = Fit::new(data, conditions)?;
    let of_pair = |(a, b, name): (usize, usize, String)| Some((name, fit.pair(a, b)?));
    let pairs = pairs(&fit.names).into_iter().map(of_pair);
    let pairs: Vec<(String, MarginalContrast)> = pairs.collect::<Option<_>>()?;
    Some(MarginalContrast::family(pairs))
}

/// A subject's rows less their mean.
struct Person {
    x: Matrix,
    residuals: Vec<f64>,
    /// The symmetric root of (I - H)⁻¹, H what the subject's own rows have in their own fit.
    root: Matrix,
}

/// Least squares within subjects.
struct Fit {
    names: Vec<String>,
    people: Vec<Person>,
    inverse: Matrix,
    beta: Matrix,
}

impl Fit {
    fn new(data: &DesignColumns<'_>, conditions: &[String]) -> Option<Self> {
        let levels = Index::from_labels(conditions);
        let k = levels.names.len();
        let by_person = data.filled_rows();
        let complete = |rows: &Vec<usize>| {
            let mut met: Vec<usize> = rows.iter().map(|&row| levels.rows[row]).collect();
            met.sort_unstable();
            met.iter().copied().eq(0..k)
        };
        if by_person.len() < 2 || !by_person.iter().all(complete) {
            return None;
        }
        let mut periods: Vec<usize> = by_person
            .iter()
            .flatten()
            .filter_map(|row| data.periods.get(*row).copied())
            .collect();
        periods.sort_unstable();
        periods.dedup();
        let value = |row: usize, column: usize| {
            let yes = if column < k - 1 {
                levels.rows[row] == column + 1
            } else {
                data.periods[row] == periods[column - (k - 1) + 1]
            };
            f64::from(u8::from(yes))
        };
        let columns = k - 1 + periods.len().saturating_sub(1);
        let mut information = Matrix::zeros(columns, columns);
        let mut pull = Matrix::zeros(columns, 1);
        let mut centred = Vec::new();
        for rows in &by_person {
            let mean =
                |column: usize| rows.iter().map(|&row| value(row, column)).sum::<f64>() / k as f64;
            let x = Matrix::from(k, columns, |i, column| {
                value(rows[i], column) - mean(column)
            });
            let y: Vec<f64> = rows.iter().filter_map(|&row| data.values[row]).collect();
            let level = y[0] + y.iter().map(|v| v - y[0]).sum::<f64>() / k as f64;
            let y = Matrix::from(k, 1, |i, _| y[i] - level);
            information.add(&x.transposed_times(&x), 1.0);
            pull.add(&x.transposed_times(&y), 1.0);
            centred.push((x, y));
        }
        let factor = information.cholesky()?;
        let (beta, inverse) = (factor.solve(&pull), factor.inverse());
        let people = centred.into_iter().map(|(x, y)| {
            let fitted = x.times(&beta);
            let mut left = Matrix::identity(k);
            left.add(&x.times(&inverse).times(&x.transposed()), -1.0);
            Some(Person {
                residuals: (0..k).map(|i| y[(i, 0)] - fitted[(i, 0)]).collect(),
                root: inverse_root(&left)?,
                x,
            })
        });
        Some(Self {
            people: people.collect::<Option<_>>()?,
            names: levels.names,
            inverse,
            beta,
        })
    }

    fn pair(&self, a: usize, b: usize) -> Option<MarginalContrast> {
        let columns = self.beta.rows;
        let indicator = |level: usize, column: usize| f64::from(u8::from(level == column + 1));
        let weights = Matrix::from(columns, 1, |j, _| {
            let factor = if j + 1 < self.names.len() { 1.0 } else { 0.0 };
            factor * (indicator(a, j) - indicator(b, j))
        });
        let direction = self.inverse.times(&weights);
        let estimate = weights.transposed_times(&self.beta)[(0, 0)];
        let (mut variance, mut square_norms, mut shared) = (0.0, Vec::new(), Vec::new());
        for person in &self.people {
            let turned = person.root.times(&person.x.times(&direction));
            let turned: Vec<f64> = (0..turned.rows).map(|i| turned[(i, 0)]).collect();
            variance += dot(&turned, &person.residuals).powi(2);
            square_norms.push(dot(&turned, &turned));
            let q = Matrix::from(columns, 1, |j, _| {
                (0..turned.len())
                    .map(|i| person.x[(i, j)] * turned[i])
                    .sum()
            });
            shared.push(q);
        }
        // The entries δᵢⱼ ‖tᵢ‖² − qᵢᵀ I⁻¹ qⱼ of all pairs of people: their trace, and the sum of their squares; the squares of the second
        // part alone add up to the trace of (I⁻¹ Σ q qᵀ)².
        let (mut trace, mut squares) = (0.0, 0.0);
        let mut products = Matrix::zeros(columns, columns);
        for (square_norm, q) in square_norms.iter().zip(&shared) {
            let common = q.transposed_times(&self.inverse.times(q))[(0, 0)];
            trace += square_norm - common;
            squares += square_norm * (square_norm - 2.0 * common);
            products.add(&q.times(&q.transposed()), 1.0);
        }
        let products = self.inverse.times(&products);
        squares += products.trace_of_product(&products);
        let df = Some(trace * trace / squares).filter(|df| df.is_finite() && *df > 0.0);
        (variance > 0.0).then(|| MarginalContrast::from_estimate(estimate, variance.sqrt(), df))
    }
}

/// The symmetric matrix whose square is the inverse.
fn inverse_root(matrix: &Matrix) -> Option<Matrix> {
    let n = matrix.rows;
    let mut root = Matrix::zeros(n, n);
    for axis in principal_axes(matrix)? {
        let value = dot(&axis, &axis);
        root.add(
            &Matrix::from(n, n, |i, j| axis[i] * axis[j]),
            1.0 / (value * value.sqrt()),
        );
    }
    Some(root)
}
