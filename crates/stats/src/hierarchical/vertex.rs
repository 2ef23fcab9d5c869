//! Where a parabola is highest, when its coefficients are only believed.

use super::Belief;
use crate::numerics::distributions::normal_quantile;

/// Quantiles of the curvature that are combined with those of the slope.
const CURVATURES: usize = 41;
/// Quantiles of the slope: with fewer, an interval of 95% would end at the second of them, well inside.
const SLOPES: usize = 161;
/// The largest share of beliefs in which the parabola has no top, for the rest to be of use.
const MOST_WITHOUT_TOP: f64 = 0.5;

impl Belief {
    /// Equally likely values, ascending, of −b / (2 g): the top of b x + g x², with b and g the sums of `linear` and `square` · numbers.
    ///
    /// Beliefs in which g is not below zero have no top and are left out; `None` if they are half of all or more.
    /// The values are a grid of quantiles, not draws: the same every time.
    ///
    /// # Example
    /// ```
    /// let belief = maveric_stats::Belief::new(vec![1.0, -2.0], vec![vec![0.01, 0.0], vec![0.0, 0.01]])?;
    /// let values = belief.top_of_parabola(&[1.0, 0.0], &[0.0, 1.0]).unwrap();
    /// assert!((values[values.len() / 2] - 0.25).abs() < 0.01);
    /// # Ok::<(), maveric_stats::StatsError>(())
    /// ```
    pub fn top_of_parabola(&self, linear: &[f64], square: &[f64]) -> Option<Vec<f64>> {
        let (b, g) = (self.mean_of(linear), self.mean_of(square));
        let g_variance = self.covariance_of(square, square).max(0.0);
        let shared = self.covariance_of(linear, square);
        let slope = if g_variance > 0.0 { shared / g_variance } else { 0.0 };
        let rest = (self.covariance_of(linear, linear) - slope * shared).max(0.0).sqrt();
        let quantiles = |n: usize| {
            let share = move |i| (i as f64 + 0.5) / n as f64;
            (0..n).map(move |i| normal_quantile(share(i)))
        };
        let slopes: Vec<f64> = quantiles(SLOPES).collect();
        let mut values = Vec::with_capacity(CURVATURES * SLOPES);
        for zg in quantiles(CURVATURES) {
            let step = g_variance.sqrt() * zg;
            let curvature = g + step;
            if curvature < 0.0 {
                let middle = b + slope * step;
                values.extend(slopes.iter().map(|zb| -(middle + rest * zb) / (2.0 * curvature)));
            }
        }
        let with_top = values.len() as f64 / (CURVATURES * SLOPES) as f64;
        if with_top <= 1.0 - MOST_WITHOUT_TOP {
            return None;
        }
        values.sort_by(f64::total_cmp);
        Some(values)
    }
}

#[cfg(test)]
mod tests {
    use crate::Belief;

    #[test]
    fn a_parabola_that_opens_upwards_has_no_top() {
        let belief = Belief::new(vec![1.0, 2.0], vec![vec![0.1, 0.0], vec![0.0, 0.1]]).unwrap();
        assert!(belief.top_of_parabola(&[1.0, 0.0], &[0.0, 1.0]).is_none());
    }

    #[test]
    fn the_spread_of_the_top_follows_that_of_the_slope() {
        let spread = |variance: f64| {
            let belief = Belief::new(vec![0.0, -1.0], vec![vec![variance, 0.0], vec![0.0, 1e-9]]);
            let values = belief.unwrap().top_of_parabola(&[1.0, 0.0], &[0.0, 1.0]).unwrap();
            values[values.len() - 1 - values.len() / 40] - values[values.len() / 40]
        };
        // b has SD 1, so the top has SD 1/2: 95 % lie within 1.96 of them.
        assert!((spread(1.0) - 1.96).abs() < 0.1, "{}", spread(1.0));
        assert!((spread(4.0) / spread(1.0) - 2.0).abs() < 1e-6);
    }
}
