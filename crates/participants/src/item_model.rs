//! Items whose answers have a given mean, spread and correlation.

use crate::error::ParticipantError;
use maveric_domain::{Scale, Subscale, survey::Scoring};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// A graded-response item: the latent answer `mean + sd · y`, y ~ N(0, 1), ticks the nearest box within the range of the scale.
///
/// # Source
/// Samejima (1969), normal ogive, with equally spaced thresholds halfway between the boxes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ItemModel {
    /// Mean latent answer after reversal, in points.
    pub(crate) mean: f64,
    /// Its standard deviation, in points.
    pub(crate) sd: f64,
    /// Correlation of y with the subscale's factor.
    pub(crate) loading: f64,
    /// Lowest and highest box, and from one to the next.
    min: i32,
    max: i32,
    step: i32,
    /// Standard deviation of the mean of the subscale's items, in points.
    score_sd: f64,
}

impl ItemModel {
    /// The items of a subscale that give its norms: mean and standard deviation of the score, and alpha.
    ///
    /// All items are alike. With alpha = k r / (1 + (k − 1) r) the norms say how two of them correlate, r, and with the variance
    /// of their mean how much each varies; what latent answers do that once they are ticked is solved for, so that boxes
    /// at the ends of the range cost nothing.
    ///
    /// # Errors
    /// [`ParticipantError::NoNorms`]; [`ParticipantError::BadNorms`] where no item of this range can have them.
    pub(crate) fn from_norms(scale: &Scale, subscale: &Subscale) -> Result<Self, ParticipantError> {
        let Some(norms) = &subscale.norms else {
            return Err(ParticipantError::NoNorms {
                scale: scale.id.clone(),
                subscale: subscale.id.clone(),
            });
        };
        let bad = |problem| ParticipantError::BadNorms {
            scale: scale.id.clone(),
            subscale: subscale.id.clone(),
            problem,
        };
        let first = subscale.items.first().and_then(|first| scale.item(*first));
        let Some(first_item) = first else {
            return Err(bad("a sum of others, which the answers to its parts make"));
        };
        let k = subscale.items.len() as f64;
        let unit = subscale.weight * if scale.scoring == Scoring::Sum { k } else { 1.0 };
        let (mean, score_sd) = (norms.mean / unit, norms.sd / unit);
        let r = if k > 1.0 { norms.alpha / (k - norms.alpha * (k - 1.0)) } else { norms.alpha };
        let variance = k * score_sd * score_sd / (1.0 + (k - 1.0) * r);
        let mut item = Self {
            mean,
            sd: variance.sqrt(),
            loading: 0.0,
            min: first_item.min,
            max: first_item.max,
            step: first_item.step,
            score_sd,
        };
        item.fit_moments(mean, variance)
            .ok_or_else(|| bad("mean and sd that no answers within the range have"))?;
        let latent = item.latent_correlation(&item, r * variance);
        item.loading =
            latent.ok_or_else(|| bad("alpha that no answers within the range have"))?.sqrt();
        Ok(item)
    }

    /// Sets latent mean and standard deviation so that the ticked answers have these moments.
    fn fit_moments(&mut self, mean: f64, variance: f64) -> Option<()> {
        let (width, middle) =
            (f64::from(self.max - self.min), f64::from(self.max + self.min) / 2.0);
        let centred = |sd: f64| {
            let ticked = |m: f64| Self { mean: m, sd, ..*self };
            let m = crossing(middle - 50.0 * width, middle + 50.0 * width, |m| {
                ticked(m).moments().0 - mean
            });
            ticked(m)
        };
        let sd = crossing(1e-3, 20.0 * width, |sd| centred(sd).moments().1 - variance);
        *self = centred(sd);
        let moments = self.moments();
        let met = (moments.0 - mean).abs() < 1e-6 && (moments.1 - variance).abs() < 1e-6;
        met.then_some(())
    }

    /// Thresholds between the boxes, in standard deviations of the latent answer.
    fn thresholds(&self) -> impl Iterator<Item = f64> + Clone + use<> {
        let item = *self;
        let half = 0.5 * f64::from(item.step);
        (item.min..item.max)
            .step_by(item.step as usize)
            .map(move |box_below| (f64::from(box_below) + half - item.mean) / item.sd)
    }

    /// Mean and variance of the ticked answer.
    fn moments(&self) -> (f64, f64) {
        let (mut mean, mut square) = (0.0, 0.0);
        // From the lowest box upwards: answer = number of thresholds passed.
        for (passed, t) in self.thresholds().enumerate() {
            // The upper tail of the normal distribution.
            let above = 0.5 * libm::erfc(t * FRAC_1_SQRT_2);
            mean += above;
            square += (2.0 * passed as f64 + 1.0) * above;
        }
        let step = f64::from(self.step);
        let variance = step * step * (square - mean * mean);
        (f64::from(self.min) + step * mean, variance)
    }

    /// Covariance of the ticked answers of two items whose latent answers correlate by `r`, −1 to 1.
    ///
    /// # Source
    /// Plackett (1954): the derivative of a bivariate normal probability with respect to r is the density.
    fn covariance(&self, other: &Self, r: f64) -> f64 {
        const STEPS: usize = 24;
        let end = libm::asin(r);
        let density = |theta: f64| -> f64 {
            let (sine, square) = (libm::sin(theta), 2.0 * libm::cos(theta).powi(2));
            let with = |h: f64| -> f64 {
                other
                    .thresholds()
                    .map(|k| libm::exp(-(h * h + k * k - 2.0 * h * k * sine) / square))
                    .sum()
            };
            self.thresholds().map(with).sum()
        };
        // Simpson's rule; the integrand is smooth away from |r| = 1.
        let step = end / STEPS as f64;
        let inner: f64 =
            (1..STEPS).map(|i| density(step * i as f64) * if i % 2 == 1 { 4.0 } else { 2.0 }).sum();
        let boxes = f64::from(self.step) * f64::from(other.step);
        boxes * ((density(0.0) + inner + density(end)) * step / 3.0 / (2.0 * PI))
    }

    /// The latent correlation that gives ticked answers this covariance.
    fn latent_correlation(&self, other: &Self, covariance: f64) -> Option<f64> {
        const LARGEST: f64 = 0.995;
        let r = crossing(-LARGEST, LARGEST, |r| self.covariance(other, r) - covariance);
        let met = (self.covariance(other, r) - covariance).abs() < 1e-6;
        met.then_some(r)
    }

    /// The correlation of two subscales' factors that makes their scores correlate by `r`.
    pub(crate) fn factor_correlation(&self, other: &Self, r: f64) -> Option<f64> {
        let latent = self.latent_correlation(other, r * self.score_sd * other.score_sd)?;
        Some(latent / (self.loading * other.loading)).filter(|r| r.abs() <= 1.0)
    }
}

/// Where a rising function crosses zero between `low` and `high`; the nearer end where it does not.
///
/// Regula falsi in the Illinois variant (Dowell and Jarratt 1971), which halves the value at an end that stays.
fn crossing(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    const CLOSE: f64 = 1e-11;
    let (mut below, mut above) = (f(low), f(high));
    if below >= 0.0 {
        return low;
    }
    if above <= 0.0 {
        return high;
    }
    let mut stayed = 0;
    for _ in 0..100 {
        let middle = (low * above - high * below) / (above - below);
        let value = f(middle);
        if value.abs() < CLOSE || high - low < CLOSE {
            return middle;
        }
        if value < 0.0 {
            (low, below) = (middle, value);
            if stayed < 0 {
                above *= 0.5;
            }
            stayed = -1;
        } else {
            (high, above) = (middle, value);
            if stayed > 0 {
                below *= 0.5;
            }
            stayed = 1;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::scales;

    fn scale(id: &str) -> Scale {
        scales().into_iter().find(|s| s.id == id).unwrap()
    }

    #[test]
    fn ticked_answers_have_the_moments_and_the_correlation_asked_for() {
        let scale = scale("mdsi");
        for subscale in &scale.subscales {
            let item = ItemModel::from_norms(&scale, subscale).unwrap();
            let norms = subscale.norms.as_ref().unwrap();
            let (mean, variance) = item.moments();
            assert!((mean - norms.mean).abs() < 1e-6);
            let k = subscale.items.len() as f64;
            let covariance = item.covariance(&item, item.loading * item.loading);
            let score = (variance + (k - 1.0) * covariance) / k;
            assert!((score.sqrt() - norms.sd).abs() < 1e-5, "{score}");
            let alpha = k / (k - 1.0) * (1.0 - variance / (k * score));
            assert!((alpha - norms.alpha).abs() < 1e-5, "{alpha}");
        }
    }

    #[test]
    fn norms_of_a_sum_are_those_of_a_mean_times_the_items() {
        let mut scale = scale("mdsi");
        let mean = ItemModel::from_norms(&scale, &scale.subscales[0]).unwrap();
        scale.scoring = Scoring::Sum;
        let k = scale.subscales[0].items.len() as f64;
        let norms = scale.subscales[0].norms.as_mut().unwrap();
        (norms.mean, norms.sd) = (k * norms.mean, k * norms.sd);
        let sum = ItemModel::from_norms(&scale, &scale.subscales[0]).unwrap();
        for (one, other) in [(mean.mean, sum.mean), (mean.sd, sum.sd), (mean.loading, sum.loading)]
        {
            assert!((one - other).abs() < 1e-9, "{one} {other}");
        }
    }

    #[test]
    fn a_covariance_without_ends_is_the_latent_one() {
        // Many boxes, far apart ends: ticking only adds Sheppard's twelfth to the variance.
        let item = ItemModel {
            mean: 0.0,
            sd: 8.0,
            loading: 0.5,
            min: -60,
            max: 60,
            step: 1,
            score_sd: 1.0,
        };
        assert!((item.moments().1 - 64.0 - 1.0 / 12.0).abs() < 1e-6);
        assert!((item.covariance(&item, -0.4) + 0.4 * 64.0).abs() < 1e-6);
    }

    #[test]
    fn norms_that_no_answers_can_have_are_refused() {
        let mut scale = scale("mini_ipip");
        let norms = scale.subscales[0].norms.as_mut().unwrap();
        (norms.mean, norms.sd) = (1.1, 1.5);
        let error = ItemModel::from_norms(&scale, &scale.subscales[0]).unwrap_err().to_string();
        assert!(
            error.contains("`mini_ipip.extraversion`") && error.contains("mean and sd"),
            "{error}"
        );
        scale.subscales[1].norms = None;
        let error = ItemModel::from_norms(&scale, &scale.subscales[1]).unwrap_err().to_string();
        assert!(error.contains("agreeableness") && error.contains("no norms"), "{error}");
    }
}
