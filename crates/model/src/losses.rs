//! L1 to L5 and the bound on the mutual information, each with its equation.
//!
//! Those of one row take a weight `c` and return the loss without `c` and its derivatives times `c`; the mean over rows and the loss
//! weights are in `c`.

use serde::{Deserialize, Serialize};
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
        weighted.map(|(term, (_, weight))| weight * term.unwrap_or(0.0)).sum()
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
    pub(crate) fn weighted(&self, weights: &LossWeights) -> f64 {
        weights.following_distance * self.following_distance.loss
            + weights.lane_change * self.lane_change.loss
            + weights.velocity * self.velocity.loss
            + weights.mutual_information * self.mutual_information.loss
    }

    /// [`LossTerms::mutual_information_bound`] over the rows of many drivers.
    ///
    /// Any normal gives a lower bound: the mean log-likelihood of `w` under it plus H(w) of the prior N(0, I), `d/2 · ln(2πe)` (Chen et
    /// al. 2016). M's own SD is none under the mean squared error, which drives it to zero; one SD for all rows, the root of the mean
    /// squared error itself, is as good a normal: the higher bound counts.
    fn bound(&self, embedding_size: usize) -> Option<f64> {
        let half_d = 0.5 * embedding_size as f64;
        let by_likelihood =
            self.log_likelihood.mean()? + half_d * (1.0 + libm::log(std::f64::consts::TAU));
        let error = self.reading.mean()?.max(f64::MIN_POSITIVE);
        Some(by_likelihood.max(-half_d * libm::log(error)))
    }

    pub(crate) fn terms(&self, aggression: Option<f64>, embedding_size: usize) -> LossTerms {
        LossTerms {
            following_distance: self.following_distance.mean(),
            lane_change: self.lane_change.mean(),
            velocity: self.velocity.mean(),
            aggression,
            mutual_information: self.mutual_information.mean(),
            mutual_information_bound: self.bound(embedding_size),
        }
    }
}

/// L1, L3, L4: `(ŷ − y)²`, and its derivative by ŷ.
pub(crate) fn squared_error(predicted: f32, target: f32, c: f32) -> (f64, f32) {
    let error = predicted - target;
    (f64::from(error * error), c * (error + error))
}

/// L2: `−ln p(class)` for a softmax over two logits with probability `p` of the second class; derivatives
/// by the logits `{keep, change}`.
pub(crate) fn cross_entropy(
    keep: f32,
    change: f32,
    p: f32,
    target: f32,
    c: f32,
) -> (f64, [f32; 2]) {
    let against = f64::from(if target > 0.5 { keep - change } else { change - keep });
    let slope = c * (p - target);
    (surprise(against), [-slope, slope])
}

/// `ln(1 + e^x)`, the surprise at what had log-odds of x against it, from whichever end does not overflow.
pub(crate) fn surprise(against: f64) -> f64 {
    against.max(0.0) + libm::log1p(libm::exp(-against.abs()))
}

/// L4, the mean of `(S(w) − s)²` over the drives with a score `s`; `None` without any.
///
/// `parameters` are the weights of S, shape `(d,)`, and its bias; `embeddings` has shape `(drives, d)`. Adds `weight`
/// times the gradients to those of the parameters and of the embeddings.
pub(crate) fn aggression(
    (parameters, embeddings): (&[f32], &[f32]),
    scores: &[Option<f32>],
    weight: f64,
    gradient: &mut [f32],
    embedding_gradient: &mut [f32],
) -> Option<f64> {
    let scored = scores.iter().flatten().count();
    let d = parameters.len() - 1;
    let share = (weight / scored as f64) as f32;
    let mut sum = 0.0;
    for (index, score) in scores.iter().enumerate() {
        let Some(score) = *score else { continue };
        let w = &embeddings[index * d..(index + 1) * d];
        let pairs = parameters.iter().zip(w);
        let predicted = pairs.fold(parameters[d], |sum, (&by, &w)| sum + by * w);
        let (loss, slope) = squared_error(predicted, score, share);
        sum += loss;
        for i in 0..d {
            gradient[i] += slope * w[i];
            embedding_gradient[index * d + i] += slope * parameters[i];
        }
        gradient[d] += slope;
    }
    (scored > 0).then(|| sum / scored as f64)
}

/// Derivatives of L5 by μ, ln σ and `w`, for one coordinate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NormalGradient {
    pub(crate) mean: f32,
    pub(crate) log_sd: f32,
    pub(crate) embedding: f32,
}

/// M's ln σ is kept within these limits: outside, e^(ln σ) would leave the numbers of an `f32` behind.
const LOG_SD_LIMITS: [f64; 2] = [-6.0, 3.0];

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

/// L5 for one coordinate, its gradient, and `ln N(w; μ, σ²)` in nats.
pub(crate) fn normal(reading: Reading, row: [f32; 4], c: f64) -> (f64, NormalGradient, f64) {
    let [mean, log_sd, noise, w] = row.map(f64::from);
    let [low, high] = LOG_SD_LIMITS;
    let moves = f64::from(u8::from((low..=high).contains(&log_sd)));
    let log_sd = log_sd.clamp(low, high);
    let sd = libm::exp(log_sd);
    let z = (w - mean) / sd;
    let (loss, by_mean, by_log_sd) = match reading {
        Reading::Sample => {
            let error = mean + sd * noise - w;
            (error * error, 2.0 * error, 2.0 * error * sd * noise)
        }
        Reading::Expected => {
            let error = mean - w;
            (error * error + sd * sd, 2.0 * error, 2.0 * sd * sd)
        }
        Reading::Likelihood => (0.5 * z * z + log_sd, -z / sd, 1.0 - z * z),
    };
    let gradient = NormalGradient {
        mean: (c * by_mean) as f32,
        log_sd: (c * by_log_sd * moves) as f32,
        embedding: (-c * by_mean) as f32,
    };
    let log_likelihood = -0.5 * z * z - log_sd - 0.5 * libm::log(std::f64::consts::TAU);
    (loss, gradient, log_likelihood)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slope(f: impl Fn(f32) -> f64, x: f32) -> f64 {
        (f(x + 1e-2) - f(x - 1e-2)) / f64::from((x + 1e-2) - (x - 1e-2))
    }

    #[test]
    fn squared_error_has_its_slope() {
        let (loss, gradient) = squared_error(1.5, 0.5, 3.0);
        assert!((loss - 1.0).abs() < 1e-6);
        let numeric = slope(|y| 3.0 * squared_error(y, 0.5, 3.0).0, 1.5);
        assert!((f64::from(gradient) - numeric).abs() < 1e-4);
    }

    #[test]
    fn cross_entropy_has_its_slopes_and_never_overflows() {
        let p = |k: f32, c: f32| 1.0 / (1.0 + (k - c).exp());
        for target in [0.0, 1.0] {
            let f = |k: f32, c: f32| cross_entropy(k, c, p(k, c), target, 2.0);
            let (_, [by_keep, by_change]) = f(0.3, -0.8);
            assert!((f64::from(by_keep) - slope(|k| 2.0 * f(k, -0.8).0, 0.3)).abs() < 1e-4);
            assert!((f64::from(by_change) - slope(|c| 2.0 * f(0.3, c).0, -0.8)).abs() < 1e-4);
            assert!(f(900.0, -900.0).0.is_finite());
        }
    }

    #[test]
    fn l4_has_its_gradient_by_s_and_by_w() {
        let scores = [Some(0.7), None, Some(-1.1)];
        let parameters = vec![0.9, -0.4, 0.3, 0.2];
        let w = vec![0.3, -0.5, 1.0, 0.2, 0.1, -0.9, 1.4, 0.6, -0.2];
        let value = |p: &[f32], w: &[f32]| {
            let (mut by_p, mut by_w) = (vec![0.0; 4], vec![0.0; 9]);
            let l4 = aggression((p, w), &scores, 0.3, &mut by_p, &mut by_w);
            (0.3 * l4.unwrap(), by_p, by_w)
        };
        let (_, by_p, by_w) = value(&parameters, &w);
        let moved = |values: &[f32], i: usize, to: f32| {
            let mut values = values.to_vec();
            values[i] = to;
            values
        };
        for (i, found) in by_w.iter().enumerate() {
            let numeric = slope(|x| value(&parameters, &moved(&w, i, x)).0, w[i]);
            assert!((f64::from(*found) - numeric).abs() < 1e-4);
        }
        for (i, found) in by_p.iter().enumerate() {
            let numeric = slope(|x| value(&moved(&parameters, i, x), &w).0, parameters[i]);
            assert!((f64::from(*found) - numeric).abs() < 1e-4);
        }
    }

    #[test]
    fn every_reading_of_m_has_its_slopes() {
        for reading in [Reading::Sample, Reading::Expected, Reading::Likelihood] {
            let at = [0.4, -0.3, 0.9, -0.6];
            let (_, gradient, _) = normal(reading, at, 1.0);
            let vary = |i: usize| {
                let moved = |v: f32| {
                    let mut x = at;
                    x[i] = v;
                    normal(reading, x, 1.0).0
                };
                slope(moved, at[i])
            };
            for (found, i) in [(gradient.mean, 0), (gradient.log_sd, 1), (gradient.embedding, 3)] {
                assert!((f64::from(found) - vary(i)).abs() < 3e-3, "{reading:?} {i}");
            }
        }
    }

    #[test]
    fn the_bound_of_a_reading_without_sd_is_that_of_its_error() {
        // M knows w but for a tenth, and says it knew it exactly.
        let mut sums = Sums::default();
        for (w, error) in [(0.5, 0.1_f32), (-1.0, -0.1)] {
            let (.., likelihood) = normal(Reading::Sample, [w + error, -6.0, 0.0, w], 1.0);
            sums.log_likelihood.add(likelihood, 1.0);
            sums.reading.add(f64::from(error * error), 1.0);
        }
        let found = sums.bound(1).unwrap();
        assert!((found - 10.0_f64.ln()).abs() < 1e-6, "{found}");
        assert!(sums.log_likelihood.mean().unwrap() < -100.0);
        assert_eq!(Sums::default().bound(1), None);
    }

    #[test]
    fn the_bound_is_zero_when_m_knows_only_the_prior() {
        // N(0, 1) read as N(0, 1): the mean square distance is 1.
        let mut sums = Sums::default();
        for w in [1.0, -1.0] {
            let (.., likelihood) = normal(Reading::Sample, [0.0, 0.0, 0.0, w], 1.0);
            sums.log_likelihood.add(likelihood, 1.0);
            sums.reading.add(1.0, 1.0);
        }
        assert!(sums.bound(1).unwrap().abs() < 1e-9);
    }
}
