//! Straight lines, and directions, fitted by least squares.

use serde::{Deserialize, Serialize};

use crate::{
    Reasons, StatsError, complete,
    numerics::{
        distributions::{f_upper, t_quantile_two_sided, t_two_sided},
        moments::{centred, is_constant, mean_and_square_sum},
    },
};

/// y = intercept + slope x.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LinearFit {
    /// Complete pairs.
    pub n: usize,
    /// Pairs left out because a member is missing.
    pub missing: usize,
    /// Change of y for one unit of x.
    pub slope: f64,
    /// y at x = 0.
    pub intercept: f64,
    /// Standard error of the slope.
    pub slope_se: Option<f64>,
    /// Standard error of the intercept.
    pub intercept_se: Option<f64>,
    /// Two-sided p of the slope, n-2 degrees of freedom.
    pub slope_p: Option<f64>,
    /// Standard deviation of the residuals, over n-2.
    pub residual_sd: Option<f64>,
    /// Share of the variance of y that the line explains.
    pub r2: Option<f64>,
    /// Mean of x over the complete pairs.
    pub mean_x: f64,
    /// Σ (x - mean)².
    pub ss_x: f64,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

impl LinearFit {
    /// y on the line.
    pub fn predict(&self, x: f64) -> f64 {
        self.intercept + self.slope * x
    }

    /// The pointwise interval of the line at `x`, with the given confidence (0.95).
    pub fn band(&self, x: f64, confidence: f64) -> Option<(f64, f64)> {
        let n = self.n as f64;
        let t = t_quantile_two_sided(1.0 - confidence, n - 2.0)?;
        let distance = x - self.mean_x;
        let error = self.residual_sd? * (1.0 / n + distance * distance / self.ss_x).sqrt();
        Some((self.predict(x) - t * error, self.predict(x) + t * error))
    }
}

/// Fits a line to pairs, columns of shape `(rows,)`; incomplete pairs are left out.
///
/// # Errors
/// [`StatsError::LengthMismatch`]; [`StatsError::NotFinite`]; [`StatsError::TooFew`] below
/// two complete pairs; [`StatsError::BadParameter`] if x does not vary.
///
/// # Example
/// ```
/// let x = [1.0, 2.0, 3.0, 4.0].map(Some);
/// let y = [2.1, 3.9, 6.2, 7.8].map(Some);
/// let fit = maveric_stats::linear_fit(&x, &y)?;
/// assert!((fit.slope - 1.94).abs() < 1e-12 && (fit.intercept - 0.15).abs() < 1e-12);
/// let (low, high) = fit.band(2.5, 0.95).unwrap();
/// assert!(low < 5.0 && 5.0 < high);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn linear_fit(x: &[Option<f64>], y: &[Option<f64>]) -> Result<LinearFit, StatsError> {
    let complete = complete::rows(&[("x", x), ("y", y)], "pair", 2)?;
    let (x, y) = (&complete.columns[0], &complete.columns[1]);
    let (mean_x, ss_x) = mean_and_square_sum(x.iter().copied());
    if is_constant(x) || ss_x <= 0.0 {
        let expected = "at least two different values";
        return Err(StatsError::parameter("x", expected, x[0]));
    }
    let n = x.len() as f64;
    let (mean_y, ss_y) = mean_and_square_sum(y.iter().copied());
    let (dx, dy) = (centred(x), centred(y));
    let slope = dx.iter().zip(&dy).map(|(a, b)| a * b).sum::<f64>() / ss_x;
    let rest: f64 = dx.iter().zip(&dy).map(|(a, b)| (b - slope * a).powi(2)).sum();
    let mut undefined = Reasons::default();
    let sd = (n > 2.0).then(|| (rest / (n - 2.0)).sqrt());
    let slope_se = sd.map(|sd| sd / ss_x.sqrt());
    if sd.is_none() {
        let names = ["residual_sd", "slope_se", "intercept_se", "slope_p"];
        undefined.note_all(&names, "two pairs leave no degrees of freedom");
    }
    let slope_p = slope_se.filter(|se| *se > 0.0).map(|se| t_two_sided(slope / se, n - 2.0));
    if slope_p.is_none() {
        let reason = "the pairs lie on the line, so the slope has no error";
        undefined.note("slope_p", reason);
    }
    let r2 = (!is_constant(y)).then(|| 1.0 - rest / ss_y);
    if r2.is_none() {
        undefined.note("r2", "y does not vary");
    }
    Ok(LinearFit {
        n: x.len(),
        missing: complete.missing,
        slope,
        intercept: mean_y - slope * mean_x,
        slope_se,
        intercept_se: sd.map(|sd| sd * (1.0 / n + mean_x * mean_x / ss_x).sqrt()),
        slope_p,
        residual_sd: sd,
        r2,
        mean_x,
        ss_x,
        undefined,
    })
}

/// The multiple correlation of y with the direction of an angle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CircularLinear {
    /// Complete pairs.
    pub n: usize,
    /// Pairs left out because a member is missing.
    pub missing: usize,
    /// Multiple R of y on cosine and sine of the angle, from 0 to 1.
    pub r: Option<f64>,
    /// (R²/2) / ((1 - R²)/(n-3)).
    #[serde(rename = "F")]
    pub f: Option<f64>,
    /// 2.
    pub df1: usize,
    /// n - 3.
    pub df2: Option<usize>,
    /// P(F' ≥ F).
    pub p: Option<f64>,
    /// The angle at which y is largest, in radians from -π to π.
    pub direction_rad: Option<f64>,
    /// Why numbers do not exist, by name.
    pub undefined: Reasons,
}

/// Correlates y with an angle in radians, both of shape `(rows,)`.
///
/// # Errors
/// [`StatsError::LengthMismatch`]; [`StatsError::NotFinite`]; [`StatsError::TooFew`] below
/// three complete pairs.
///
/// # Source
/// Mardia and Jupp (2000), section 11.2.1; here with p by F, which is exact for normal
/// errors where their χ² = n R² is not.
///
/// # Example
/// ```
/// let angle: Vec<_> = (0..12).map(|i| Some(f64::from(i) * 0.5)).collect();
/// let y: Vec<_> = (0..12).map(|i| Some((f64::from(i) * 0.5 - 1.0).cos() + f64::from(i % 2) * 0.1)).collect();
/// let result = maveric_stats::circular_linear(&angle, &y)?;
/// assert!(result.r.unwrap() > 0.99 && (result.direction_rad.unwrap() - 1.0).abs() < 0.05);
/// # Ok::<(), maveric_stats::StatsError>(())
/// ```
pub fn circular_linear(
    angle_rad: &[Option<f64>],
    y: &[Option<f64>],
) -> Result<CircularLinear, StatsError> {
    let complete = complete::rows(&[("angle", angle_rad), ("y", y)], "pair", 3)?;
    let (angles, y) = (&complete.columns[0], &complete.columns[1]);
    let mut undefined = Reasons::default();
    let waves = Waves::new(angles, y);
    let coefficients = waves.coefficients().filter(|_| !is_constant(y));
    let fitted = coefficients.map(|(a, b)| {
        let explained = (a * waves.cy + b * waves.sy) / waves.yy;
        (explained.clamp(0.0, 1.0), libm::atan2(b, a))
    });
    if fitted.is_none() {
        let reason = "y does not vary, or all angles lie on one line through the centre";
        undefined.note_all(&["r", "F", "p", "df2", "direction_rad"], reason);
    }
    let df2 = y.len() - 3;
    let f = fitted
        .filter(|(r2, _)| df2 > 0 && *r2 < 1.0)
        .map(|(r2, _)| 0.5 * r2 / ((1.0 - r2) / df2 as f64));
    if f.is_none() {
        undefined.note_all(&["F", "p"], "no variance is left after the fit");
    }
    Ok(CircularLinear {
        n: y.len(),
        missing: complete.missing,
        r: fitted.map(|(r2, _)| r2.sqrt()),
        f,
        df1: 2,
        df2: fitted.map(|_| df2),
        p: f.map(|f| f_upper(f, 2.0, df2 as f64)),
        direction_rad: fitted.map(|(_, direction)| direction),
        undefined,
    })
}

/// Least squares of y on 1, the cosine and the sine of an angle in radians, both of one length: the three coefficients;
/// `None` if the pairs do not determine them.
///
/// # Example
/// ```
/// let angles: Vec<f64> = (0..12).map(|i| f64::from(i) * 0.5).collect();
/// let y: Vec<f64> = angles.iter().map(|a| 2.0 + 3.0 * a.cos() - a.sin()).collect();
/// let [level, cosine, sine] = maveric_stats::circular_fit(&angles, &y).unwrap();
/// assert!((level - 2.0).abs() < 1e-9 && (cosine - 3.0).abs() < 1e-9 && (sine + 1.0).abs() < 1e-9);
/// assert_eq!(maveric_stats::circular_fit(&[0.0; 3], &[1.0, 2.0, 3.0]), None);
/// ```
pub fn circular_fit(angles_rad: &[f64], y: &[f64]) -> Option<[f64; 3]> {
    if angles_rad.len() != y.len() || y.len() < 3 {
        return None;
    }
    let (a, b) = Waves::new(angles_rad, y).coefficients()?;
    let mean = |value: &dyn Fn(usize) -> f64| (0..y.len()).map(value).sum::<f64>() / y.len() as f64;
    let wave = mean(&|i| a * libm::cos(angles_rad[i]) + b * libm::sin(angles_rad[i]));
    Some([mean(&|i| y[i]) - wave, a, b])
}

/// Sums of products of the centred cosine, sine and y.
struct Waves {
    cc: f64,
    ss: f64,
    cs: f64,
    cy: f64,
    sy: f64,
    yy: f64,
}

impl Waves {
    fn new(angles: &[f64], y: &[f64]) -> Self {
        let wave = |f: fn(f64) -> f64| centred(&angles.iter().map(|a| f(*a)).collect::<Vec<_>>());
        let (cosine, sine, dy) = (wave(libm::cos), wave(libm::sin), centred(y));
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        Self {
            cc: dot(&cosine, &cosine),
            ss: dot(&sine, &sine),
            cs: dot(&cosine, &sine),
            cy: dot(&cosine, &dy),
            sy: dot(&sine, &dy),
            yy: dot(&dy, &dy),
        }
    }

    /// Of cosine and sine; `None` if all angles lie on one line through the centre.
    fn coefficients(&self) -> Option<(f64, f64)> {
        let determinant = self.cc * self.ss - self.cs * self.cs;
        (determinant > 1e-12 * self.cc * self.ss).then(|| {
            (
                (self.cy * self.ss - self.sy * self.cs) / determinant,
                (self.sy * self.cc - self.cy * self.cs) / determinant,
            )
        })
    }
}
