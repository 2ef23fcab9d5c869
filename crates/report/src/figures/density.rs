//! How densely values lie: the outline of a half violin.

use maveric_stats::{quantile, standard_deviation};

/// A Gaussian kernel density at `steps` points: (value, density relative to the highest).
///
/// Silverman's bandwidth; reaches two bandwidths beyond the data. Empty if all values are equal.
pub(crate) fn density(sorted: &[f64], steps: usize, range: (f64, f64)) -> Vec<(f64, f64)> {
    if sorted.len() < 3 {
        return Vec::new();
    }
    let sd = standard_deviation(sorted).unwrap_or(0.0);
    let quartiles = quantile(sorted, 0.25).zip(quantile(sorted, 0.75));
    let spread = quartiles.map_or(0.0, |(low, high)| (high - low) / 1.34);
    let scale = if spread > 0.0 { sd.min(spread) } else { sd };
    let width = 0.9 * scale * libm::pow(sorted.len() as f64, -0.2);
    if width <= 1e-12 * sorted[0].abs().max(1.0) {
        return Vec::new();
    }
    let low = (sorted[0] - 2.0 * width).max(range.0);
    let high = (sorted[sorted.len() - 1] + 2.0 * width).min(range.1);
    let bell = |value: f64, x: f64| libm::exp(-0.5 * ((value - x) / width).powi(2));
    let height = |value: f64| sorted.iter().map(|x| bell(value, *x)).sum::<f64>();
    let values = (0..=steps).map(|step| low + (high - low) * step as f64 / steps as f64);
    let curve: Vec<(f64, f64)> = values.map(|value| (value, height(value))).collect();
    let top = curve.iter().map(|point| point.1).fold(f64::MIN_POSITIVE, f64::max);
    curve.into_iter().map(|(value, height)| (value, height / top)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_density_never_leaves_the_range_of_its_scale() {
        let curve = density(&[1.0, 1.0, 2.0, 6.5, 7.0], 20, (1.0, 7.0));
        assert!(curve.iter().all(|(value, _)| (1.0..=7.0).contains(value)));
    }

    #[test]
    fn equal_values_have_no_density() {
        assert!(density(&[2.0; 8], 20, (f64::NEG_INFINITY, f64::INFINITY)).is_empty());
    }

    #[test]
    fn a_density_is_a_sum_of_bells_of_silverman_s_width() {
        let sorted = [0.0, 1.0, 2.0, 3.0, 10.0];
        let all = (f64::NEG_INFINITY, f64::INFINITY);
        // The quartiles are 1 and 3, so the spread is 2 / 1.34, less than the standard deviation.
        let width = 0.9 * (2.0 / 1.34) * 5.0_f64.powf(-0.2);
        let curve = density(&sorted, 100, all);
        assert_eq!(curve.len(), 101);
        assert!((curve[0].0 + 2.0 * width).abs() < 1e-9);
        assert!((curve[100].0 - 10.0 - 2.0 * width).abs() < 1e-9);
        let bell = |value: f64| -> f64 {
            let each = sorted.iter().map(|x| (-0.5 * ((value - x) / width).powi(2)).exp());
            each.sum()
        };
        let top = curve.iter().map(|p| bell(p.0)).fold(0.0, f64::max);
        for (value, height) in &curve {
            assert!((height - bell(*value) / top).abs() < 1e-9, "{value}");
        }
        // Where the middle half is one value, the deviation stands in; two values have none.
        let curve = density(&[0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0], 10, all);
        let width = 0.9 * (1.0_f64 / 3.0).sqrt() * 7.0_f64.powf(-0.2);
        assert!((curve[0].0 + 2.0 * width).abs() < 1e-9);
        assert!(density(&[1.0, 2.0], 10, all).is_empty());
    }
}
