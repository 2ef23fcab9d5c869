//! Whether all differences of conditions vary alike, and what to do if not.

use serde::{Deserialize, Serialize};

use crate::{
    Reasons, RmAnova, WithinSubjects,
    numerics::{
        distributions::{chi2_upper, f_upper},
        moments::centred,
        spectrum::squared_singular_values,
    },
};

/// Mauchly's test of sphericity.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Mauchly {
    /// Determinant of the contrast covariance over the (k-1)th power of its mean eigenvalue.
    #[serde(rename = "W")]
    pub w: Option<f64>,
    /// -(n-1) ρ ln W, with ρ = 1 - (2q² + q + 2) / (6 q (n-1)), q = k-1; with groups n less their number in place of n-1.
    pub chi2: Option<f64>,
    /// q (q+1) / 2 - 1.
    pub df: Option<usize>,
    /// With the second-order term, which uses k where Anderson has k-1: as R and pingouin.
    pub p: Option<f64>,
    /// What other programs print for the same data.
    #[serde(flatten)]
    pub compat: MauchlyCompat,
}

/// Values that only other programs print, to compare with.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct MauchlyCompat {
    /// With the second-order term as Anderson (2003) gives it, k-1 in the place of k.
    pub p_anderson: Option<f64>,
    /// First order only.
    pub p_chi2: Option<f64>,
}

/// Corrections of the degrees of freedom of F for a lack of sphericity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sphericity {
    /// Greenhouse and Geisser's ε: (Σλ)² / ((k-1) Σλ²), from 1/(k-1) to 1.
    pub gg: Option<f64>,
    /// Huynh and Feldt's ε as the formula gives it; it may pass 1.
    pub hf_raw: Option<f64>,
    /// The same cut at 1, and 1 where the formula has no positive value.
    pub hf: Option<f64>,
    /// 1 / (k-1).
    pub lower_bound: f64,
    /// p of F with both degrees of freedom times `gg`.
    pub p_gg: Option<f64>,
    /// p of F with both degrees of freedom times `hf`.
    pub p_hf: Option<f64>,
    /// p of F with both degrees of freedom times `lower_bound`.
    pub p_lb: Option<f64>,
    /// df1 times `gg`.
    pub df1_gg: Option<f64>,
    /// df2 times `gg`.
    pub df2_gg: Option<f64>,
    /// df1 times `hf`.
    pub df1_hf: Option<f64>,
    /// df2 times `hf`.
    pub df2_hf: Option<f64>,
}

/// The correction of the degrees of freedom of F.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum SphericityCorrection {
    /// None: Huynh and Feldt's ε is 1, or sphericity cannot fail.
    None,
    /// Greenhouse and Geisser's ε.
    GreenhouseGeisser,
    /// Huynh and Feldt's ε.
    HuynhFeldt,
}

impl Sphericity {
    /// The correction that an F is reported with: Huynh and Feldt's where Greenhouse and Geisser's ε is above .75, which is then too strict.
    ///
    /// # Source
    /// Girden (1992), as in Field's textbooks.
    pub fn correction(&self) -> SphericityCorrection {
        let gg = self.gg.unwrap_or(self.lower_bound);
        if gg <= 0.75 {
            SphericityCorrection::GreenhouseGeisser
        } else if self.hf.is_some_and(|hf| hf >= 1.0) {
            SphericityCorrection::None
        } else {
            SphericityCorrection::HuynhFeldt
        }
    }

    /// The ε of a correction, and p with it; `p` is that without one.
    pub fn corrected(
        &self,
        correction: SphericityCorrection,
        p: Option<f64>,
    ) -> (Option<f64>, Option<f64>) {
        match correction {
            SphericityCorrection::None => (Some(1.0), p),
            SphericityCorrection::GreenhouseGeisser => (self.gg, self.p_gg),
            SphericityCorrection::HuynhFeldt => (self.hf, self.p_hf),
        }
    }
}

/// Residuals of Helmert's contrasts; the residuals of the design are centred both ways already.
fn contrasts(residuals: &[f64], k: usize) -> Vec<Vec<f64>> {
    let contrast = |j: usize| {
        let norm = ((j * (j + 1)) as f64).sqrt();
        let contrast: Vec<f64> = residuals
            .chunks_exact(k)
            .map(|row| (row[..j].iter().sum::<f64>() - j as f64 * row[j]) / norm)
            .collect();
        centred(&contrast)
    };
    (1..k).map(contrast).collect()
}

pub(crate) fn tests(
    data: &WithinSubjects,
    residuals: &[f64],
    anova: &RmAnova,
) -> (Mauchly, Sphericity, Reasons) {
    let mut reasons = Reasons::default();
    let spectrum = Spectrum::new(contrasts(residuals, data.k()), data.n() - 1, data.k());
    let mauchly = reasons.result("mauchly", spectrum.mauchly());
    let corrections = spectrum.corrections(anova.f, anova.df1, anova.df2);
    let sphericity = reasons.result("sphericity", corrections);
    (mauchly, sphericity, reasons)
}

/// The error matrix of orthonormal contrasts.
pub(crate) struct Spectrum {
    /// Its eigenvalues times the degrees of freedom, largest first.
    values: Vec<f64>,
    /// Subjects less groups.
    freedom: usize,
    /// Conditions.
    cells: usize,
}

impl Spectrum {
    /// `errors`: the residuals of each contrast, a number a subject. The eigenvalues are their squared singular values.
    pub(crate) fn new(errors: Vec<Vec<f64>>, freedom: usize, cells: usize) -> Self {
        let mut values = squared_singular_values(errors);
        values.sort_by(|a, b| b.total_cmp(a));
        Self { values, freedom, cells }
    }

    pub(crate) fn mauchly(&self) -> (Mauchly, Reasons) {
        let values = &self.values;
        let none = |reason: &str| {
            let mut reasons = Reasons::default();
            reasons.note("", reason);
            (Mauchly::default(), reasons)
        };
        let (q, freedom) = (values.len() as f64, self.freedom as f64);
        if values.len() == 1 {
            return none("two conditions have a single difference, so sphericity cannot fail");
        }
        let (largest, smallest) = (values[0], values[values.len() - 1]);
        if largest <= 0.0 {
            return none("the error sum of squares is zero");
        }
        // Squared singular values: relative rounding of the values themselves, squared.
        let size = (self.freedom + 1).max(self.cells);
        let floor = (size as f64 * f64::EPSILON).powi(2);
        if self.freedom < values.len() || smallest <= floor * largest {
            return none(
                "the error matrix is singular (fewer subjects than conditions, or one condition is determined by the others)",
            );
        }
        let ln_mean = libm::log(values.iter().sum::<f64>() / q);
        let ln_w = values.iter().map(|v| libm::log(*v) - ln_mean).sum::<f64>().min(0.0);
        let rho = 1.0 - (2.0 * q * q + q + 2.0) / (6.0 * q * freedom);
        let df = values.len() * (values.len() + 1) / 2 - 1;
        let chi2 = (-freedom * rho * ln_w).max(0.0);
        let first = chi2_upper(chi2, df as f64);
        let second = chi2_upper(chi2, df as f64 + 4.0);
        let with_term = |third: f64| {
            let numerator = (q + 2.0)
                * (q - 1.0)
                * (q - 2.0)
                * (2.0 * q.powi(3) + 6.0 * q * q + 3.0 * third + 2.0);
            let weight = numerator / (288.0 * (freedom * q * rho).powi(2));
            (first + weight * (second - first)).clamp(0.0, 1.0)
        };
        let test = Mauchly {
            w: Some(libm::exp(ln_w)),
            chi2: Some(chi2),
            df: Some(df),
            p: Some(with_term(self.cells as f64)),
            compat: MauchlyCompat { p_anderson: Some(with_term(q)), p_chi2: Some(first) },
        };
        (test, Reasons::default())
    }

    /// Corrections of an F with that many degrees of freedom.
    pub(crate) fn corrections(
        &self,
        f: Option<f64>,
        df1: usize,
        df2: usize,
    ) -> (Sphericity, Reasons) {
        let mut reasons = Reasons::default();
        let (q, freedom) = (self.values.len() as f64, self.freedom as f64);
        let (sum, squares) = self.values.iter().fold((0.0, 0.0), |(s, q), v| (s + v, q + v * v));
        let lower_bound = 1.0 / q;
        let gg = (squares > 0.0).then(|| (sum * sum / (q * squares)).clamp(lower_bound, 1.0));
        let (hf_raw, hf) = match gg {
            Some(gg) => {
                let denominator = q * (freedom - q * gg);
                let raw = ((freedom + 1.0) * q * gg - 2.0) / denominator;
                let raw =
                    (denominator.abs() > 1e-12 * freedom).then_some(raw).filter(|r| r.is_finite());
                let cut = raw.filter(|&raw| raw > 0.0).map_or(1.0, |raw| raw.min(1.0));
                (raw, Some(cut))
            }
            None => (None, None),
        };
        if gg.is_none() {
            let reason =
                "the error sum of squares is zero, so the differences have no variances to compare";
            reasons.note_all(&["gg", "hf_raw", "hf", "p_gg", "p_hf", "p_lb"], reason);
            reasons.note_all(&["df1_gg", "df2_gg", "df1_hf", "df2_hf"], reason);
        } else if hf_raw.is_none() {
            let reason = "the denominator of Huynh and Feldt's formula is zero";
            reasons.note("hf_raw", reason);
        }
        let (d1, d2) = (df1 as f64, df2 as f64);
        let corrected = |epsilon: Option<f64>| Some(f_upper(f?, d1 * epsilon?, d2 * epsilon?));
        let sphericity = Sphericity {
            gg,
            hf_raw,
            hf,
            lower_bound,
            p_gg: corrected(gg),
            p_hf: corrected(hf),
            p_lb: gg.and_then(|_| corrected(Some(lower_bound))),
            df1_gg: gg.map(|e| e * d1),
            df2_gg: gg.map(|e| e * d2),
            df1_hf: hf.map(|e| e * d1),
            df2_hf: hf.map(|e| e * d2),
        };
        (sphericity, reasons)
    }
}
