//! A fit, and the estimate of any combination of its coefficients.

use super::{
    Fit,
    blocks::Blocks,
    columns::Columns,
    components::{AtZero, Components},
    satterthwaite::{Information, Satterthwaite},
};
use crate::numerics::moments::dot;

/// A fit and what its combinations of coefficients need.
pub(super) struct Described<'a> {
    pub(super) blocks: &'a Blocks,
    pub(super) fit: &'a Fit,
    pub(super) columns: &'a Columns<'a>,
    pub(super) offset: f64,
    pub(super) freedom: Option<Satterthwaite>,
}

impl<'a> Described<'a> {
    pub(super) fn new(
        blocks: &'a Blocks,
        fit: &'a Fit,
        columns: &'a Columns<'a>,
        offset: f64,
        components: &Components,
        at_zero: AtZero,
    ) -> Self {
        let psi = fit.l.times(&fit.l.transposed());
        let kind = match at_zero {
            AtZero::Strata if components.some_is_zero(&fit.l) => Information::Expected,
            _ => Information::Observed(&fit.beta),
        };
        Self {
            blocks,
            fit,
            columns,
            offset,
            freedom: Satterthwaite::new(blocks, &psi, fit.variance, kind, &components.entries()),
        }
    }

    /// Estimate (its share of the offset counted), standard error and degrees of freedom.
    pub(super) fn estimate(&self, weights: &[f64]) -> (f64, f64, Option<f64>) {
        let beta: Vec<f64> = (0..weights.len()).map(|j| self.fit.beta[(j, 0)]).collect();
        let variance = self.fit.variance * self.fit.xx_inverse.between(weights, weights);
        let df = self.freedom.as_ref().and_then(|s| s.df(weights));
        (
            dot(weights, &beta) + weights[0] * self.offset,
            variance.sqrt(),
            df,
        )
    }
}
