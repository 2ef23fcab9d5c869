//! How near the car comes to its driver, beside how near the driver comes to themselves.

use super::{MEASURES, Values, mean};
use maveric_measures::{mean_accuracy, objective};
use serde::Serialize;

/// Mimic accuracy that the paper printed, in the order of the first five measures.
///
/// # Source
/// Paper, "Results"; method section 10.
const PAPER: [f64; 5] = [0.936, 0.802, 0.924, 0.810, 0.818];

/// One measure: accuracies (1 − |found − own| / own, mean over drivers) and signed errors relative to own.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Fidelity {
    pub measure: &'static str,
    pub title: &'static str,
    /// Drivers with a value in their own and in the car's drive.
    pub n: usize,
    /// The car in the own style against the driver's own drive.
    pub mimic: Option<f64>,
    /// Mean of (car − own) / own: systematic error, which scatter averages out of.
    pub mimic_bias: Option<f64>,
    /// The driver's second drive against the first.
    pub test_retest: Option<f64>,
    /// Mean of (second − first) / first.
    pub test_retest_bias: Option<f64>,
    /// The car on another road against the car: the car's own scatter.
    pub car_again: Option<f64>,
    /// The mean of the training drivers as guess for everybody.
    pub population_mean: Option<f64>,
    /// What the paper printed; the last two measures it did not.
    pub paper: Option<f64>,
    /// `mimic` as a share of `test_retest`.
    pub of_test_retest: Option<f64>,
}

fn accuracy(driven: &[Values], own: &[Values], measure: usize) -> (Option<f64>, usize) {
    let pairs: Vec<_> = driven.iter().zip(own).map(|(f, o)| (f[measure], o[measure])).collect();
    let result = mean_accuracy(&pairs);
    (result.mean, result.n)
}

fn bias(driven: &[Values], own: &[Values], measure: usize) -> Option<f64> {
    let errors: Vec<f64> = driven
        .iter()
        .zip(own)
        .filter_map(|(f, o)| Some((f[measure]? - o[measure]?) / o[measure]?))
        .filter(|e| e.is_finite())
        .collect();
    mean(&errors)
}

/// Every measure; all slices but `training` in the same order of drivers.
pub fn fidelity(
    own: &[Values],
    again: &[Values],
    mimic: &[Values],
    mimic_again: &[Values],
    training: &[Values],
) -> Vec<Fidelity> {
    let row = |(k, measure): (usize, &&'static str)| {
        let (drive_accuracy, n) = accuracy(mimic, own, k);
        let test_retest = accuracy(again, own, k).0;
        let known: Vec<f64> = training.iter().filter_map(|v| v[k]).collect();
        let mut guess = own.to_vec();
        for values in &mut guess {
            values[k] = mean(&known);
        }
        Fidelity {
            measure,
            title: objective::find(measure).map_or(measure, |m| m.title),
            n,
            mimic: drive_accuracy,
            mimic_bias: bias(mimic, own, k),
            test_retest,
            test_retest_bias: bias(again, own, k),
            car_again: accuracy(mimic_again, mimic, k).0,
            population_mean: accuracy(&guess, own, k).0,
            paper: PAPER.get(k).copied(),
            of_test_retest: drive_accuracy.zip(test_retest).map(|(m, t)| m / t),
        }
    };
    MEASURES.iter().enumerate().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(velocity: f64) -> Values {
        let mut values = Values::default();
        values[0] = Some(velocity);
        values
    }

    #[test]
    fn accuracy_ignores_the_sign_of_an_error_and_bias_does_not() {
        let own = [values(10.0), values(20.0)];
        let mimic = [values(11.0), values(18.0)];
        let rows = fidelity(&own, &[values(12.0), values(20.0)], &mimic, &mimic, &own);
        let velocity = &rows[0];
        assert!((velocity.mimic.unwrap() - 0.9).abs() < 1e-12);
        assert!(velocity.mimic_bias.unwrap().abs() < 1e-12);
        assert!((velocity.test_retest.unwrap() - 0.9).abs() < 1e-12);
        assert!((velocity.test_retest_bias.unwrap() - 0.1).abs() < 1e-12);
        assert!((velocity.of_test_retest.unwrap() - 1.0).abs() < 1e-12);
        assert!((velocity.car_again.unwrap() - 1.0).abs() < 1e-12);
        // 15 for 10 and for 20.
        assert!((velocity.population_mean.unwrap() - f64::midpoint(0.5, 0.75)).abs() < 1e-12);
        assert_eq!((rows[1].n, rows[1].mimic), (0, None));
    }
}
