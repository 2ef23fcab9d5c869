//! What is believed of some numbers, and what an observation would add.

use crate::{StatsError, numerics::matrix::Matrix};

/// A normal distribution over `k` numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Belief {
    mean: Vec<f64>,
    /// k × k, row by row.
    covariance: Vec<Vec<f64>>,
}

impl Belief {
    /// Mean of shape `(k,)`, covariance of shape `(k, k)`.
    ///
    /// # Errors
    /// [`StatsError::LengthMismatch`] if the shapes differ; [`StatsError::NotFinite`].
    pub fn new(mean: Vec<f64>, covariance: Vec<Vec<f64>>) -> Result<Self, StatsError> {
        let size = mean.len();
        StatsError::same_length("covariance", covariance.len(), size)?;
        for (row, values) in std::iter::once(&mean).chain(&covariance).enumerate() {
            StatsError::same_length("covariance", values.len(), size)?;
            if let Some(&value) = values.iter().find(|v| !v.is_finite()) {
                return Err(StatsError::NotFinite { name: "belief".to_owned(), row, value });
            }
        }
        Ok(Self { mean, covariance })
    }

    pub(crate) fn from_matrix(mean: Vec<f64>, covariance: &Matrix) -> Self {
        Self {
            mean,
            covariance: (0..covariance.rows).map(|i| covariance.row(i).to_vec()).collect(),
        }
    }

    /// How many numbers.
    pub fn len(&self) -> usize {
        self.mean.len()
    }

    /// Whether it is about nothing.
    pub fn is_empty(&self) -> bool {
        self.mean.is_empty()
    }

    /// Mean of each number, shape `(k,)`.
    pub fn mean(&self) -> &[f64] {
        &self.mean
    }

    /// Mean of the sum of `weights` · numbers, shape `(k,)`; weights that are left off at the end count as 0.
    pub fn mean_of(&self, weights: &[f64]) -> f64 {
        self.mean.iter().zip(weights).map(|(m, w)| m * w).sum()
    }

    /// Covariance of two such sums.
    pub fn covariance_of(&self, a: &[f64], b: &[f64]) -> f64 {
        let with_b = |row: &Vec<f64>| row.iter().zip(b).map(|(c, b)| c * b).sum::<f64>();
        self.covariance.iter().zip(a).map(|(row, a)| a * with_b(row)).sum()
    }

    /// The same belief with further numbers, each N(0, sd²) and independent of all others, behind those there are.
    #[must_use]
    pub fn extended(&self, sds: &[f64]) -> Self {
        let (size, more) = (self.len(), sds.len());
        let mut wider = self.clone();
        wider.mean.resize(size + more, 0.0);
        for row in &mut wider.covariance {
            row.resize(size + more, 0.0);
        }
        for (i, sd) in sds.iter().enumerate() {
            let mut row = vec![0.0; size + more];
            row[size + i] = sd * sd;
            wider.covariance.push(row);
        }
        wider
    }

    /// Takes in y = `row` · numbers + ε with the variance of ε given: Bayes' rule, in closed form.
    pub fn observe(&mut self, row: &[f64], y: f64, variance: f64) {
        let along: Vec<f64> =
            self.covariance.iter().map(|c| c.iter().zip(row).map(|(c, r)| c * r).sum()).collect();
        let expected = self.mean_of(row);
        let spread: f64 = variance + along.iter().zip(row).map(|(a, r)| a * r).sum::<f64>();
        if spread.is_nan() || spread <= 0.0 {
            return; // known already
        }
        let surprise = (y - expected) / spread;
        for (i, a) in along.iter().enumerate() {
            self.mean[i] += a * surprise;
            for (j, b) in along.iter().enumerate() {
                self.covariance[i][j] -= a * b / spread;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_observations_average_with_the_prior() {
        let mut belief = Belief::new(vec![0.0, 5.0], vec![vec![1.0, 0.0], vec![0.0, 1.0]]).unwrap();
        belief.observe(&[1.0, 0.0], 3.0, 1.0);
        belief.observe(&[1.0, 0.0], 3.0, 1.0);
        assert!((belief.mean()[0] - 2.0).abs() < 1e-12);
        assert!((belief.mean()[1] - 5.0).abs() < 1e-12);
        assert!((belief.covariance_of(&[1.0, 0.0], &[1.0, 0.0]) - 1.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn a_shared_error_makes_a_repetition_worth_less() {
        let belief = Belief::new(vec![0.0], vec![vec![1.0]]).unwrap().extended(&[1.0, 1.0]);
        let mut seen = belief.clone();
        seen.observe(&[1.0, 1.0, 0.0], 0.3, 0.1);
        let (again, elsewhere) = ([1.0, 1.0, 0.0], [1.0, 0.0, 1.0]);
        let variance_after = |row: &[f64]| {
            let mut after = seen.clone();
            after.observe(row, 0.3, 0.1);
            after.covariance_of(&[1.0], &[1.0])
        };
        assert!(variance_after(&elsewhere) < 0.9 * variance_after(&again));
    }

    #[test]
    fn shapes_that_do_not_fit_are_refused() {
        assert!(Belief::new(vec![0.0], vec![]).is_err());
        assert!(Belief::new(vec![0.0], vec![vec![f64::NAN]]).is_err());
    }
}
