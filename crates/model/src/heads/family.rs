//! What a head's number η means: the likelihood of what somebody did, and its two derivatives.

use serde::{Deserialize, Serialize};

/// How η gives the distribution of what somebody does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// Normal around η.
    Gaussian,
    /// A positive number whose logarithm is normal around η.
    LogNormal,
    /// Done (1) with probability 1/(1 + e^−η), or not (0).
    Logistic,
}

/// What somebody did, in the head's unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// It was this much.
    Value(f64),
    /// Something kept it from being more: censored from above.
    AtLeast(f64),
}

impl Outcome {
    /// The same in a unit of which `factor` make one.
    pub(crate) fn times(self, factor: f64) -> Self {
        match self {
            Self::Value(value) => Self::Value(factor * value),
            Self::AtLeast(value) => Self::AtLeast(factor * value),
        }
    }
}

/// −ln of a likelihood as a function of η: value, slope, curvature (0 or more).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Loss {
    pub(crate) value: f64,
    pub(crate) slope: f64,
    pub(crate) curvature: f64,
}

const HALF_LN_TAU: f64 = 0.918_938_533_204_672_8;

/// φ(z)/Q(z), the normal density over its upper tail.
pub(crate) fn tail_ratio(z: f64) -> f64 {
    if z > 20.0 {
        // The asymptotic series: Q itself leaves the numbers soon after.
        return z + 1.0 / z - 2.0 / z.powi(3) + 10.0 / z.powi(5);
    }
    let density = libm::exp(-0.5 * z * z - HALF_LN_TAU);
    density / (0.5 * libm::erfc(z * std::f64::consts::FRAC_1_SQRT_2))
}

impl Family {
    /// The number that is normal around η: a logarithm for [`Family::LogNormal`].
    pub(crate) fn linked(self, value: f64) -> f64 {
        match self {
            Self::LogNormal => libm::log(value),
            Self::Gaussian | Self::Logistic => value,
        }
    }

    /// The mean of the distribution that η gives, with the scatter `sd` around η; of [`Family::Logistic`] the probability.
    pub fn mean(self, eta: f64, sd: f64) -> f64 {
        match self {
            Self::Gaussian => eta,
            Self::LogNormal => libm::exp(eta + 0.5 * sd * sd),
            Self::Logistic => 1.0 / (1.0 + libm::exp(-eta)),
        }
    }

    /// The loss of `outcome` at `eta`; `sd` is the scatter around η, in η's unit, of the two normal families.
    pub(crate) fn loss(self, outcome: Outcome, eta: f64, sd: f64) -> Loss {
        match (self, outcome) {
            (Self::Logistic, Outcome::Value(done) | Outcome::AtLeast(done)) => {
                let p = self.mean(eta, sd);
                let towards = if done > 0.5 { -eta } else { eta };
                Loss {
                    value: towards.max(0.0) + libm::log1p(libm::exp(-towards.abs())),
                    slope: p - done,
                    curvature: p * (1.0 - p),
                }
            }
            (_, Outcome::Value(value)) => {
                let z = (eta - self.linked(value)) / sd;
                Loss {
                    value: 0.5 * z * z + libm::log(sd) + HALF_LN_TAU,
                    slope: z / sd,
                    curvature: 1.0 / (sd * sd),
                }
            }
            (_, Outcome::AtLeast(value)) => {
                let z = (self.linked(value) - eta) / sd;
                let ratio = tail_ratio(z);
                Loss {
                    value: 0.5 * z * z + HALF_LN_TAU + libm::log(ratio),
                    slope: -ratio / sd,
                    curvature: (ratio * (ratio - z)).max(0.0) / (sd * sd),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn slopes_and_curvatures_are_those_of_the_value(
            eta in -3.0..3.0_f64,
            value in 0.2..4.0_f64,
            sd in 0.2..2.0_f64,
            which in 0..5_usize,
        ) {
            let (family, outcome) = [
                (Family::Gaussian, Outcome::Value(value)),
                (Family::LogNormal, Outcome::Value(value)),
                (Family::LogNormal, Outcome::AtLeast(value)),
                (Family::Logistic, Outcome::Value(1.0)),
                (Family::Logistic, Outcome::Value(0.0)),
            ][which];
            let at = |eta: f64| family.loss(outcome, eta, sd);
            let h = 1e-5;
            let slope = (at(eta + h).value - at(eta - h).value) / (2.0 * h);
            let curvature = (at(eta + h).slope - at(eta - h).slope) / (2.0 * h);
            prop_assert!((at(eta).slope - slope).abs() < 1e-4 * (1.0 + slope.abs()));
            prop_assert!((at(eta).curvature - curvature).abs() < 1e-4 * (1.0 + curvature.abs()));
        }
    }

    #[test]
    fn far_in_the_tail_the_ratio_stays_a_number_without_a_jump() {
        assert!((tail_ratio(20.0) - tail_ratio(20.0 + 1e-9)).abs() < 1e-3);
        assert!(tail_ratio(1e6).is_finite() && tail_ratio(-40.0) >= 0.0);
    }
}
