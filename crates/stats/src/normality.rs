//! Shape of a sample, and Shapiro and Wilk's test of normality.

use serde::{Deserialize, Serialize};

use crate::{
    Reasons, StatsError,
    numerics::{
        distributions::{normal_quantile, normal_upper},
        moments::{centred, is_constant, largest, mean_and_square_sum},
    },
};

/// Location, spread and shape of a sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SampleShape {
    /// Arithmetic mean.
    pub mean: f64,
    /// Standard deviation, over n-1.
    pub sd: Option<f64>,
    /// R's type 7, as the quartiles.
    pub median: f64,
    /// Lower quartile, R's type 7.
    pub q1: f64,
    /// Upper quartile, R's type 7.
    pub q3: f64,
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// g1 = m3 / m2^(3/2), moments over n.
    pub skew_g1: Option<f64>,
    /// g2 = m4 / m2² - 3, moments over n.
    pub kurtosis_g2: Option<f64>,
}

/// Shapiro and Wilk's test.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShapiroWilk {
    /// Squared correlation of the ordered values with approximate normal scores.
    #[serde(rename = "W")]
    pub w: Option<f64>,
    /// P(W' ≤ W) for a normal sample.
    pub p: Option<f64>,
}

/// Whether one sample looks normal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Normality {
    /// Number of values.
    pub n: usize,
    /// Number of missing values left out.
    pub missing: usize,
    /// Location, spread and shape.
    pub desc: SampleShape,
    /// Shapiro and Wilk's test.
    pub shapiro: ShapiroWilk,
    /// Why numbers do not exist.
    pub undefined: Reasons,
}

/// Describes a sample of shape `(n,)` and tests it for normality; missing values are left
/// out and counted.
///
/// # Errors
/// [`StatsError::NotFinite`]; [`StatsError::TooFew`] without any value.
///
/// # Source
/// Royston (1995), algorithm AS R94, as R's `shapiro.test`, for n from 3 to 5000.
///
/// # Example
/// ```
/// // Royston's weights; R: shapiro.test(c(1, 2, 4)) gives W = 0.96429, p = 0.6369.
/// let result = maveric_stats::normality(&[Some(1.0), Some(2.0), Some(4.0)])?;
/// assert!((result.shapiro.w.unwrap() - 0.964_285_714).abs() < 1e-8);
/// assert!((result.shapiro.p.unwrap() - 0.636_886_8).abs() < 1e-6);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn normality(values: &[Option<f64>]) -> Result<Normality, StatsError> {
    let sample = crate::complete::values(values, "value", 1)?;
    let mut undefined = Reasons::default();
    let desc = undefined.result("desc", shape(&sample));
    let shapiro = undefined.result("shapiro", shapiro_wilk(&sample));
    Ok(Normality {
        n: sample.len(),
        missing: values.len() - sample.len(),
        desc,
        shapiro,
        undefined,
    })
}

fn shape(sample: &[f64]) -> (SampleShape, Reasons) {
    let mut reasons = Reasons::default();
    let n = sample.len() as f64;
    let (mean, _) = mean_and_square_sum(sample.iter().copied());
    let (deviations, scale) = scaled(&centred(sample));
    let moment = |power: i32| deviations.iter().map(|d| d.powi(power)).sum::<f64>() / n;
    let m2 = moment(2);
    let varies = !is_constant(sample);
    if sample.len() < 2 {
        reasons.note("sd", "one value has no spread");
    }
    if !varies {
        reasons.note_all(&["skew_g1", "kurtosis_g2"], "the values do not vary");
    }
    let mut sorted = sample.to_vec();
    sorted.sort_by(f64::total_cmp);
    let result = SampleShape {
        mean,
        sd: (sample.len() > 1).then(|| scale * (m2 * n / (n - 1.0)).sqrt()),
        median: quantile(&sorted, 0.5),
        q1: quantile(&sorted, 0.25),
        q3: quantile(&sorted, 0.75),
        min: sorted[0],
        max: sorted[sorted.len() - 1],
        skew_g1: varies.then(|| moment(3) / libm::pow(m2, 1.5)),
        kurtosis_g2: varies.then(|| moment(4) / (m2 * m2) - 3.0),
    };
    (result, reasons)
}

/// Deviations over the largest of them, and that scale (1 if all are zero): their powers
/// then neither overflow nor vanish.
fn scaled(deviations: &[f64]) -> (Vec<f64>, f64) {
    let largest = largest(deviations);
    let scale = if largest > 0.0 { largest } else { 1.0 };
    (deviations.iter().map(|d| d / scale).collect(), scale)
}

/// The `p` quantile of sorted values by linear interpolation (R's type 7).
pub(crate) fn quantile(sorted: &[f64], p: f64) -> f64 {
    let place = p * (sorted.len() - 1) as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (place - place.floor()) * (sorted[above] - sorted[below])
}

/// Royston's weights, kept for the next sample of the same size.
#[derive(Default)]
pub(crate) struct RoystonWeights {
    n: usize,
    half: Vec<f64>,
}

impl RoystonWeights {
    fn half(&mut self, n: usize) -> &[f64] {
        if self.n != n {
            (self.n, self.half) = (n, royston_weights(n));
        }
        &self.half
    }
}

/// Shapiro and Wilk's test of a sample of shape `(n,)`.
pub(crate) fn shapiro_wilk(sample: &[f64]) -> (ShapiroWilk, Reasons) {
    shapiro_wilk_with(sample, &mut RoystonWeights::default())
}

/// The same, for one of several samples.
pub(crate) fn shapiro_wilk_with(
    sample: &[f64],
    weights: &mut RoystonWeights,
) -> (ShapiroWilk, Reasons) {
    let mut reasons = Reasons::default();
    let n = sample.len();
    let reason = if n < 3 {
        Some("it needs at least three values")
    } else if n > 5000 {
        Some("its approximation holds for at most 5000 values")
    } else if is_constant(sample) {
        Some("the values do not vary, so W is 0/0")
    } else {
        None
    };
    if let Some(reason) = reason {
        reasons.note("", reason);
        return (ShapiroWilk { w: None, p: None }, reasons);
    }
    let mut sorted = scaled(&centred(sample)).0;
    sorted.sort_by(f64::total_cmp);
    let half = weights.half(n);
    // 1 - W from a difference of squares, because W itself is close to 1.
    let mean = sorted.iter().sum::<f64>() / n as f64;
    let squares: f64 = sorted.iter().map(|x| (x - mean) * (x - mean)).sum();
    let weights: f64 = 2.0 * half.iter().map(|a| a * a).sum::<f64>();
    let product: f64 =
        half.iter().enumerate().map(|(i, a)| a * (sorted[n - 1 - i] - sorted[i])).sum();
    let root = (weights * squares).sqrt();
    let rest = ((root - product) * (root + product) / (weights * squares)).clamp(0.0, 1.0);
    let result = ShapiroWilk { w: Some(1.0 - rest), p: Some(p_of(n, rest)) };
    (result, reasons)
}

/// Σ c[i] x^i.
fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// The positive weights, from the outermost pair of values inwards.
fn royston_weights(n: usize) -> Vec<f64> {
    const C1: [f64; 6] = [0.0, 0.221_157, -0.147_981, -2.071_19, 4.434_685, -2.706_056];
    const C2: [f64; 6] = [0.0, 0.042_981, -0.293_762, -1.752_461, 5.682_633, -3.582_633];
    if n == 3 {
        return vec![std::f64::consts::FRAC_1_SQRT_2];
    }
    let size = n as f64;
    let mut m: Vec<f64> =
        (1..=n / 2).map(|i| -normal_quantile((i as f64 - 0.375) / (size + 0.25))).collect();
    let square = 2.0 * m.iter().map(|m| m * m).sum::<f64>();
    let (root, rsn) = (square.sqrt(), 1.0 / size.sqrt());
    let first = polynomial(&C1, rsn) + m[0] / root;
    let (fixed, factor) = if n > 5 {
        let second = polynomial(&C2, rsn) + m[1] / root;
        let factor = ((square - 2.0 * m[0] * m[0] - 2.0 * m[1] * m[1])
            / (1.0 - 2.0 * first * first - 2.0 * second * second))
            .sqrt();
        (vec![first, second], factor)
    } else {
        let factor = ((square - 2.0 * m[0] * m[0]) / (1.0 - 2.0 * first * first)).sqrt();
        (vec![first], factor)
    };
    for weight in &mut m {
        *weight /= factor;
    }
    m[..fixed.len()].copy_from_slice(&fixed);
    m
}

/// p of 1 - W = `rest`.
fn p_of(n: usize, rest: f64) -> f64 {
    const G: [f64; 2] = [-2.273, 0.459];
    const C3: [f64; 4] = [0.544, -0.399_78, 0.025_054, -6.714e-4];
    const C4: [f64; 4] = [1.3822, -0.778_57, 0.062_767, -0.002_032_2];
    const C5: [f64; 4] = [-1.5861, -0.310_82, -0.083_751, 0.003_891_5];
    const C6: [f64; 3] = [-0.4803, -0.082_676, 0.003_030_2];
    if n == 3 {
        let w = (1.0 - rest).max(0.75);
        let p = 6.0 / std::f64::consts::PI * (libm::asin(w.sqrt()) - libm::asin(0.75_f64.sqrt()));
        return p.clamp(0.0, 1.0);
    }
    let size = n as f64;
    let y = libm::log(rest.max(f64::MIN_POSITIVE));
    let (y, mean, sd) = if n <= 11 {
        let gamma = polynomial(&G, size);
        if y >= gamma {
            return 1e-99;
        }
        (-libm::log(gamma - y), polynomial(&C3, size), libm::exp(polynomial(&C4, size)))
    } else {
        let ln = libm::log(size);
        (y, polynomial(&C5, ln), libm::exp(polynomial(&C6, ln)))
    };
    normal_upper((y - mean) / sd).max(f64::MIN_POSITIVE)
}
