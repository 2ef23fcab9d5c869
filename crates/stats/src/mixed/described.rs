//! A fit, and the estimate of any combination of its coefficients.

use super::{
    Fit, FixedEffect,
    blocks::Blocks,
    columns::Columns,
    components::{AtZero, Components},
    satterthwaite::{Information, Satterthwaite},
};
use crate::Interval;
use crate::numerics::{
    distributions::{t_quantile_two_sided, t_two_sided},
    moments::dot,
};

/// A fit and what its combinations of coefficients need.
pub(super) struct Estimates<'a> {
    pub(super) fit: &'a Fit,
    /// What y was less by: the share of the intercept.
    pub(super) offset: f64,
    freedom: Option<Satterthwaite>,
}

impl<'a> Estimates<'a> {
    /// Of a fit whose Ψ is unrestricted.
    pub(super) fn unrestricted(blocks: &Blocks, fit: &'a Fit, offset: f64) -> Self {
        let entries: Vec<Vec<(usize, usize)>> =
            (0..blocks.q).flat_map(|i| (0..=i).map(move |j| vec![(i, j)])).collect();
        Self::new(blocks, fit, offset, Information::Expected, &entries)
    }

    fn new(
        blocks: &Blocks,
        fit: &'a Fit,
        offset: f64,
        kind: Information,
        entries: &[Vec<(usize, usize)>],
    ) -> Self {
        Self {
            fit,
            offset,
            freedom: Satterthwaite::new(blocks, &fit.psi(), fit.variance, kind, entries),
        }
    }

    /// Estimate (its share of the offset counted), standard error and degrees of freedom.
    pub(super) fn estimate(&self, weights: &[f64]) -> (f64, f64, Option<f64>) {
        let beta: Vec<f64> = (0..weights.len()).map(|j| self.fit.beta[(j, 0)]).collect();
        let df = self.freedom.as_ref().and_then(|s| s.df(weights));
        (
            dot(weights, &beta) + weights[0] * self.offset,
            self.covariance(weights, weights).sqrt(),
            df,
        )
    }

    /// Covariance of two combinations.
    pub(super) fn covariance(&self, a: &[f64], b: &[f64]) -> f64 {
        self.fit.variance * self.fit.xx_inverse.between(a, b)
    }

    /// The same with its test against 0.
    pub(super) fn effect(&self, weights: &[f64]) -> FixedEffect {
        let (estimate, se, df) = self.estimate(weights);
        let se = Some(se).filter(|se| se.is_finite() && *se > 0.0);
        let t = se.map(|se| estimate / se);
        let half = df.and_then(|df| t_quantile_two_sided(0.05, df)).zip(se).map(|(t, se)| t * se);
        FixedEffect {
            estimate,
            se,
            df,
            t,
            p: t.zip(df).map(|(t, df)| t_two_sided(t, df)),
            ci: Interval::around(estimate, half),
        }
    }
}

/// Estimates by the columns of a formula.
pub(super) struct Described<'a> {
    pub(super) estimates: Estimates<'a>,
    pub(super) columns: &'a Columns<'a>,
}

impl<'a> Described<'a> {
    pub(super) fn new(
        blocks: &Blocks,
        fit: &'a Fit,
        columns: &'a Columns<'a>,
        offset: f64,
        components: &Components,
        at_zero: AtZero,
    ) -> Self {
        let kind = match at_zero {
            AtZero::Strata if components.some_is_zero(&fit.l) => Information::Expected,
            _ => Information::Observed(&fit.beta),
        };
        Self {
            estimates: Estimates::new(blocks, fit, offset, kind, &components.entries()),
            columns,
        }
    }
}
