//! A ratio of combinations of coefficients, tested against bounds and enclosed without dividing.

use serde::{Deserialize, Serialize};

use super::described::Estimates;
use crate::numerics::{
    distributions::{t_quantile_two_sided, t_upper},
    roots::{brent, upwards},
};

/// The level of each one-sided test.
pub(super) const LEVEL: f64 = 0.05;

/// The values that the data do not exclude at the two-sided level of .10: with a curvature that may be 0 they have no end.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "region", rename_all = "snake_case")]
pub enum Region {
    /// Those between the ends.
    Between {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// All but those between the ends.
    Outside {
        /// Upper end of the lower part.
        low: f64,
        /// Lower end of the upper part.
        high: f64,
    },
    /// All there are.
    Everywhere,
}

/// A number of points that is a ratio of coefficients, tested against a bound on each side without dividing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RatioTest {
    /// The estimate; none where the curvature is 0.
    pub estimate: Option<f64>,
    /// What is not excluded, by Fieller's argument.
    pub region: Option<Region>,
    /// One-sided p against all but a top with this at or above the lower bound.
    pub p_lower: Option<f64>,
    /// One-sided p against all but a top with this at or below the upper bound.
    pub p_upper: Option<f64>,
}

/// A combination a + x b of coefficients, whose root in x is asked for.
pub(super) struct Ratio<'a> {
    pub(super) estimates: &'a Estimates<'a>,
    pub(super) a: Vec<f64>,
    pub(super) b: Vec<f64>,
}

impl Ratio<'_> {
    fn weights(&self, x: f64) -> Vec<f64> {
        let pairs = self.a.iter().zip(&self.b);
        pairs.map(|(a, b)| a + x * b).collect()
    }

    /// The root, and the tests that the combination is above 0 at -`bound` and below it at `bound`: with both, b is below 0.
    pub(super) fn test(&self, bound: f64) -> RatioTest {
        let one_sided = |x: f64, sign: f64| {
            let (estimate, se, df) = self.estimates.estimate(&self.weights(x));
            df.map(|df| t_upper(sign * estimate / se, df))
        };
        let [a, b] = [&self.a, &self.b].map(|side| self.estimates.estimate(side).0);
        let root = Some(-a / b).filter(|root| root.is_finite());
        RatioTest {
            estimate: root,
            region: root.and_then(|root| self.region(root, bound)),
            p_lower: one_sided(-bound, 1.0),
            p_upper: one_sided(bound, -1.0),
        }
    }

    /// |t| less its critical value, which depends on the weights by the degrees of freedom.
    fn excess(&self, weights: &[f64]) -> Option<f64> {
        let (estimate, se, df) = self.estimates.estimate(weights);
        let critical = t_quantile_two_sided(2.0 * LEVEL, df?)?;
        Some((estimate / se).abs() - critical)
    }

    /// Where the combination may be 0; the search begins with steps of `width`.
    fn region(&self, root: f64, width: f64) -> Option<Region> {
        let excess = |x: f64| self.excess(&self.weights(x)).unwrap_or(f64::NAN);
        let outwards = |start: f64, way: f64| {
            let distance = upwards(|distance| excess(start + way * distance), 0.0, width);
            distance.map(|distance| start + way * distance)
        };
        // Far away the combination is b alone.
        if self.excess(&self.b)? > 0.0 {
            return Some(Region::Between {
                low: outwards(root, -1.0)?,
                high: outwards(root, 1.0)?,
            });
        }
        // The derivative of |t| is 0 at its root and once more, where it is largest.
        let Self { estimates, a, b } = self;
        let [estimate_a, estimate_b] = [a, b].map(|side| estimates.estimate(side).0);
        let [aa, ab, bb] = [(a, a), (a, b), (b, b)].map(|(x, y)| estimates.covariance(x, y));
        let surest = (estimate_b * aa - estimate_a * ab) / (estimate_a * bb - estimate_b * ab);
        if !(surest.is_finite() && excess(surest) > 0.0) {
            return Some(Region::Everywhere);
        }
        let near = brent(excess, surest, root)?;
        let far = outwards(surest, (surest - root).signum())?;
        Some(Region::Outside { low: near.min(far), high: near.max(far) })
    }
}
