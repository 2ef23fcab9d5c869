//! The aggression line against the questionnaire and against what the generator drew.

use super::Values;
use crate::error::RehearsalError;
use maveric_stats::{CorrelationMethod, StatsError, correlate};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(into = "&'static str")]
pub enum Reading {
    /// The position on the line of an embedding that was fitted with the score.
    WithScore,
    /// The same, fitted to the drive alone.
    WithoutScore,
    /// A regression of the score on the seven measures.
    Regression,
}

impl Reading {
    pub fn title(self) -> &'static str {
        match self {
            Self::WithScore => "aggression line, fitted with ADB",
            Self::WithoutScore => "aggression line, fitted without",
            Self::Regression => "regression on the seven measures",
        }
    }
}

impl From<Reading> for &'static str {
    fn from(reading: Reading) -> Self {
        reading.title()
    }
}

/// A reading of aggressiveness, and how it goes with the truth.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Agreement {
    pub reading: Reading,
    pub n: usize,
    /// Pearson's r with the ADB score.
    pub adb: Option<f64>,
    /// Ends of its 95 % interval.
    pub adb_interval: Option<(f64, f64)>,
    /// Pearson's r with the latent aggressiveness that the driver was made from; none for real people.
    pub latent: Option<f64>,
}

/// How `reading` goes with the drivers' scores and latents.
///
/// # Errors
/// [`RehearsalError::Stats`] if a number is not finite.
pub fn agreement(
    reading: Reading,
    values: &[Option<f64>],
    adb: &[Option<f64>],
    latent: &[Option<f64>],
) -> Result<Agreement, RehearsalError> {
    let r = |truth: &[Option<f64>]| match correlate(values, truth, CorrelationMethod::Pearson, None)
    {
        Ok(correlation) => Ok(correlation.pearson),
        Err(StatsError::TooFew { .. }) => Ok(None),
        Err(error) => Err(RehearsalError::from(error)),
    };
    let score = r(adb)?;
    Ok(Agreement {
        reading,
        n: values.iter().zip(adb).filter(|(v, a)| v.is_some() && a.is_some()).count(),
        adb_interval: score.as_ref().and_then(|p| p.ci.ends()),
        adb: score.and_then(|p| p.r),
        latent: r(latent)?.and_then(|p| p.r),
    })
}

/// ADB of the test drivers as a regression on the seven measures, fitted to the training drives, says it; a missing
/// measure is taken at the training mean. `None` for everybody if the training drives do not determine it.
pub fn regression(
    training: &[(Values, Option<f64>)],
    test: &[Values],
    standardise: impl Fn(&Values) -> Vec<f64>,
) -> Vec<Option<f64>> {
    let scored: Vec<(Vec<f64>, f64)> =
        training.iter().filter_map(|(values, adb)| Some((standardise(values), (*adb)?))).collect();
    let d = scored.first().map_or(1, |(row, _)| 1 + row.len());
    let x = DMatrix::from_fn(scored.len(), d, |i, j| match j {
        0 => 1.0,
        j => scored[i].0[j - 1],
    });
    let y = DVector::from_iterator(scored.len(), scored.iter().map(|(_, adb)| *adb));
    let normal = x.tr_mul(&x);
    let Some(inverse) = normal.cholesky() else {
        return vec![None; test.len()];
    };
    let coefficients = inverse.solve(&x.tr_mul(&y));
    test.iter()
        .map(|values| {
            let slopes = coefficients.iter().skip(1).zip(standardise(values));
            Some(coefficients[0] + slopes.map(|(b, x)| b * x).sum::<f64>())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_that_is_the_score_agrees_with_it_and_half_with_the_latent() {
        let score = [1.0, 2.0, 3.0, 4.0].map(Some);
        let found = agreement(Reading::Regression, &score, &score, &[None; 4]).unwrap();
        assert!((found.adb.unwrap() - 1.0).abs() < 1e-12);
        assert_eq!((found.n, found.latent), (4, None));
    }

    #[test]
    fn a_regression_learned_on_some_reads_others() {
        let values = |v: f64, w: f64| {
            let mut values = Values::default();
            (values[0], values[1]) = (Some(v), Some(w));
            values
        };
        let flat = |v: &Values| vec![v[0].unwrap_or(0.0), v[1].unwrap_or(0.0)];
        let training: Vec<_> = (0..8)
            .map(|i| (f64::from(i), f64::from(i * 3 % 7)))
            .map(|(v, w)| (values(v, w), Some(30.0 + v - 2.0 * w)))
            .collect();
        let read = regression(&training, &[values(4.0, 1.0)], flat);
        assert!((read[0].unwrap() - 32.0).abs() < 1e-9);
        assert_eq!(regression(&training[..1], &[values(4.0, 1.0)], flat), [None]);
    }
}
