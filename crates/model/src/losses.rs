//! L1 to L5 and the bound on the mutual information, each with its equation.
//!
//! Every function takes one row, a weight `c` and returns the loss without `c` and its derivatives times
//! `c`; the mean over rows and the loss weights are in `c`.

use serde::{Deserialize, Serialize};
use std::ops::{Add, Mul, Neg, Sub};

/// The two number types of the losses: `f32` to train, `f64` to personalise.
pub(crate) trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> + Into<f64>
{
    fn from_f64(value: f64) -> Self;

    fn f64(self) -> f64 {
        self.into()
    }
}

impl Real for f32 {
    fn from_f64(value: f64) -> Self {
        value as Self
    }
}

impl Real for f64 {
    fn from_f64(value: f64) -> Self {
        value
    }
}

/// The five losses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Loss {
    /// L1, of F.
    FollowingDistance,
    /// L2, of C.
    LaneChange,
    /// L3, of V.
    Velocity,
    /// L4, of S.
    Aggression,
    /// L5, of M.
    MutualInformation,
}

impl std::fmt::Display for Loss {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::FollowingDistance => "L1 (following distance)",
            Self::LaneChange => "L2 (lane change)",
            Self::Velocity => "L3 (velocity)",
            Self::Aggression => "L4 (aggression)",
            Self::MutualInformation => "L5 (mutual information)",
        })
    }
}

/// What each loss counts for in the sum, on standardised targets; 0 leaves it out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LossWeights {
    /// Weight of L1.
    pub following_distance: f64,
    /// Weight of L2.
    pub lane_change: f64,
    /// Weight of L3.
    pub velocity: f64,
    /// Weight of L4.
    pub aggression: f64,
    /// Weight of L5.
    pub mutual_information: f64,
}

impl LossWeights {
    /// The paper's plain sum.
    pub const PAPER: Self = Self {
        following_distance: 1.0,
        lane_change: 1.0,
        velocity: 1.0,
        aggression: 1.0,
        mutual_information: 1.0,
    };

    /// Name and value of each, in order.
    pub(crate) fn named(&self) -> [(&'static str, f64); 5] {
        [
            ("loss_weights.following_distance", self.following_distance),
            ("loss_weights.lane_change", self.lane_change),
            ("loss_weights.velocity", self.velocity),
            ("loss_weights.aggression", self.aggression),
            ("loss_weights.mutual_information", self.mutual_information),
        ]
    }
}

/// Calibration section 3: with L2 and L3 at 1 drivers are told apart less well, and L4 at 1 makes ADB
/// drift into a dimension that behaviour hardly uses.
impl Default for LossWeights {
    fn default() -> Self {
        Self {
            following_distance: 1.0,
            lane_change: 10.0,
            velocity: 2.0,
            aggression: 0.3,
            mutual_information: 1.0,
        }
    }
}

/// How L5 compares M's normal with `w`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MutualInformationLoss {
    /// The paper's mean squared error of a sample; its SD shrinks towards zero.
    #[default]
    MeanSquared,
    /// The full Gaussian negative log-likelihood.
    GaussianLikelihood,
}

/// Each loss before weighting; `None` where there was nothing to take it over.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct LossTerms {
    /// L1, mean over following rows, in squared standard deviations.
    pub following_distance: Option<f64>,
    /// L2, mean cross-entropy in nats with the classes weighted as in training.
    pub lane_change: Option<f64>,
    /// L3, mean over rows, in squared standard deviations.
    pub velocity: Option<f64>,
    /// L4, mean over drives, in squared standard deviations.
    pub aggression: Option<f64>,
    /// L5, mean over rows and coordinates.
    pub mutual_information: Option<f64>,
    /// Lower bound on I(w; X, P), in nats.
    pub mutual_information_bound: Option<f64>,
}

impl LossTerms {
    /// The weighted sum of the terms that exist.
    pub fn total(&self, weights: &LossWeights) -> f64 {
        let terms = [
            self.following_distance,
            self.lane_change,
            self.velocity,
            self.aggression,
            self.mutual_information,
        ];
        let weighted = terms.iter().zip(weights.named());
        weighted
            .map(|(term, (_, weight))| weight * term.unwrap_or(0.0))
            .sum()
    }
}

/// A loss summed over rows, and the weights of those rows.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Sum {
    pub(crate) loss: f64,
    pub(crate) weight: f64,
}

impl Sum {
    pub(crate) fn add(&mut self, loss: f64, weight: f64) {
        self.loss += loss * weight;
        self.weight += weight;
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        self.loss += other.loss;
        self.weight += other.weight;
    }

    pub(crate) fn mean(&self) -> Option<f64> {
        (self.weight > 0.0).then(|| self.loss / self.weight)
    }
}

/// What a set of rows contributes to the losses that are taken over rows.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Sums {
    pub(crate) following_distance: Sum,
    pub(crate) lane_change: Sum,
    pub(crate) velocity: Sum,
    pub(crate) mutual_information: Sum,
    pub(crate) log_likelihood: Sum,
    /// `(μ − w)²`, mean over the coordinates.
    pub(crate) reading: Sum,
}

impl Sums {
    pub(crate) fn merge(&mut self, other: &Self) {
        self.following_distance.merge(&other.following_distance);
        self.lane_change.merge(&other.lane_change);
        self.velocity.merge(&other.velocity);
        self.mutual_information.merge(&other.mutual_information);
        self.log_likelihood.merge(&other.log_likelihood);
        self.reading.merge(&other.reading);
    }

    /// The weighted sum of L1, L2, L3 and L5, before dividing by the number of rows.
    #[cfg(test)]
    pub(crate) fn weighted(&self, weights: &LossWeights) -> f64 {
        weights.following_distance * self.following_distance.loss
            + weights.lane_change * self.lane_change.loss
            + weights.velocity * self.velocity.loss
            + weights.mutual_information * self.mutual_information.loss
    }

    /// [`LossTerms::mutual_information_bound`] over the rows of many drivers.
    ///
    /// Any normal gives a lower bound. M's own SD is none under the mean squared error, which drives it to zero; one
    /// SD for all rows, the root of the mean squared error itself, is as good a normal: the higher bound counts.
    pub(crate) fn bound(&self, embedding_size: usize) -> Option<f64> {
        let own = self.log_likelihood.mean()? + prior_entropy(embedding_size);
        let error = self.reading.mean()?.max(f64::MIN_POSITIVE);
        Some(own.max(-0.5 * embedding_size as f64 * error.ln()))
    }

    pub(crate) fn terms(&self, aggression: Option<f64>, embedding_size: usize) -> LossTerms {
        LossTerms {
            following_distance: self.following_distance.mean(),
            lane_change: self.lane_change.mean(),
            velocity: self.velocity.mean(),
            aggression,
            mutual_information: self.mutual_information.mean(),
            mutual_information_bound: self
                .log_likelihood
                .mean()
                .map(|ll| ll + prior_entropy(embedding_size)),
        }
    }
}

/// L1, L3, L4: `(ŷ − y)²`, and its derivative by ŷ.
pub(crate) fn squared_error<T: Real>(predicted: T, target: T, c: T) -> (f64, T) {
    let error = predicted - target;
    ((error * error).f64(), c * (error + error))
}

/// L2: `−ln p(class)` for a softmax over two logits with probability `p` of the second class; derivatives
/// by the logits `{keep, change}`.
pub(crate) fn cross_entropy<T: Real>(keep: T, change: T, p: T, target: T, c: T) -> (f64, [T; 2]) {
    // ln(1 + e^(other - own)), from whichever end does not overflow.
    let difference = if target.f64() > 0.5 {
        (keep - change).f64()
    } else {
        (change - keep).f64()
    };
    let loss = difference.max(0.0) + (-difference.abs()).exp().ln_1p();
    let slope = c * (p - target);
    (loss, [-slope, slope])
}

/// Derivatives of L5 by μ, ln σ and `w`, for one coordinate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NormalGradient<T> {
    pub(crate) mean: T,
    pub(crate) log_sd: T,
    pub(crate) embedding: T,
}

/// M's ln σ is kept within these limits: outside, e^(ln σ) would leave the numbers of an `f32` behind.
pub(crate) const LOG_SD_LIMITS: [f64; 2] = [-6.0, 3.0];

/// ln σ within its limits, and whether it may move.
pub(crate) fn limited_log_sd(log_sd: f64) -> (f64, f64) {
    let [low, high] = LOG_SD_LIMITS;
    let moves = (low..=high).contains(&log_sd);
    (log_sd.clamp(low, high), f64::from(u8::from(moves)))
}

/// How L5 is taken over one row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Reading {
    /// `(ŵ − w)²` with `ŵ = μ + σ ε`.
    Sample,
    /// Its mean over ε: `(μ − w)² + σ²`.
    Expected,
    /// `(w − μ)²/2σ² + ln σ`.
    Likelihood,
}

/// L5 for one coordinate.
pub(crate) fn normal<T: Real>(
    reading: Reading,
    [mean, log_sd, noise, w]: [T; 4],
    c: T,
) -> (f64, NormalGradient<T>) {
    let (log_sd, moves) = limited_log_sd(log_sd.f64());
    let (mean, noise, w, c) = (mean.f64(), noise.f64(), w.f64(), c.f64());
    let sd = log_sd.exp();
    let (loss, by_mean, by_log_sd) = match reading {
        Reading::Sample => {
            let error = mean + sd * noise - w;
            (error * error, 2.0 * error, 2.0 * error * sd * noise)
        }
        Reading::Expected => {
            let error = mean - w;
            (error * error + sd * sd, 2.0 * error, 2.0 * sd * sd)
        }
        Reading::Likelihood => {
            let z = (w - mean) / sd;
            (0.5 * z * z + log_sd, -z / sd, 1.0 - z * z)
        }
    };
    let gradient = NormalGradient {
        mean: T::from_f64(c * by_mean),
        log_sd: T::from_f64(c * by_log_sd * moves),
        embedding: T::from_f64(-c * by_mean),
    };
    (loss, gradient)
}

/// `ln N(w; μ, σ²)` for one coordinate, in nats.
pub(crate) fn log_likelihood<T: Real>(mean: T, log_sd: T, w: T) -> f64 {
    let (log_sd, _) = limited_log_sd(log_sd.f64());
    let z = (w.f64() - mean.f64()) / log_sd.exp();
    -0.5 * z * z - log_sd - 0.5 * std::f64::consts::TAU.ln()
}

/// H(w) under the prior N(0, I): `d/2 · ln(2πe)`, in nats. The bound of the paper's first equation is the mean
/// log-likelihood of `w` under M plus this (Chen et al. 2016).
pub(crate) fn prior_entropy(embedding_size: usize) -> f64 {
    0.5 * embedding_size as f64 * (1.0 + std::f64::consts::TAU.ln())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slope(f: impl Fn(f64) -> f64, x: f64) -> f64 {
        (f(x + 1e-6) - f(x - 1e-6)) / 2e-6
    }

    #[test]
    fn squared_error_has_its_slope() {
        let (loss, gradient) = squared_error(1.5, 0.5, 3.0);
        assert!((loss - 1.0).abs() < 1e-12);
        let numeric = slope(|y| 3.0 * squared_error(y, 0.5, 3.0).0, 1.5);
        assert!((gradient - numeric).abs() < 1e-6);
    }

    #[test]
    fn cross_entropy_has_its_slopes_and_never_overflows() {
        let p = |k: f64, c: f64| 1.0 / (1.0 + (k - c).exp());
        for target in [0.0, 1.0] {
            let f = |k: f64, c: f64| cross_entropy(k, c, p(k, c), target, 2.0);
            let (_, [by_keep, by_change]) = f(0.3, -0.8);
            assert!((by_keep - slope(|k| 2.0 * f(k, -0.8).0, 0.3)).abs() < 1e-6);
            assert!((by_change - slope(|c| 2.0 * f(0.3, c).0, -0.8)).abs() < 1e-6);
            assert!(f(900.0, -900.0).0.is_finite());
        }
    }

    #[test]
    fn every_reading_of_m_has_its_slopes() {
        for reading in [Reading::Sample, Reading::Expected, Reading::Likelihood] {
            let f = |x: [f64; 4]| normal(reading, x, 1.0);
            let at = [0.4, -0.3, 0.9, -0.6];
            let (_, gradient) = f(at);
            let vary = |i: usize| {
                slope(
                    |v| {
                        let mut x = at;
                        x[i] = v;
                        f(x).0
                    },
                    at[i],
                )
            };
            assert!((gradient.mean - vary(0)).abs() < 1e-5, "{reading:?}");
            assert!((gradient.log_sd - vary(1)).abs() < 1e-5, "{reading:?}");
            assert!((gradient.embedding - vary(3)).abs() < 1e-5, "{reading:?}");
        }
    }

    #[test]
    fn the_bound_of_a_reading_without_sd_is_that_of_its_error() {
        // M knows w but for a tenth, and says it knew it exactly.
        let mut sums = Sums::default();
        for (w, error) in [(0.5, 0.1), (-1.0, -0.1)] {
            sums.log_likelihood
                .add(log_likelihood(w + error, -6.0, w), 1.0);
            sums.reading.add(error * error, 1.0);
        }
        let found = sums.bound(1).unwrap();
        assert!((found - 10.0_f64.ln()).abs() < 1e-9, "{found}");
        assert!(sums.log_likelihood.mean().unwrap() < -100.0);
        assert_eq!(Sums::default().bound(1), None);
    }

    #[test]
    fn the_bound_is_zero_when_m_knows_only_the_prior() {
        // Mean log-likelihood of N(0, 1) samples under N(0, 1) is minus its entropy.
        let mean_log_likelihood = -0.5 - 0.5 * std::f64::consts::TAU.ln();
        assert!((mean_log_likelihood + prior_entropy(1)).abs() < 1e-12);
        assert!((log_likelihood(0.0, 0.0, 1.0) - mean_log_likelihood).abs() < 1e-12);
    }
}
