//! Means and sums of squares that keep their digits far from zero.

/// Mean and sum of squared deviations, taken from the first value so that an offset of
/// 1e12 costs nothing.
pub(crate) fn mean_and_square_sum(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let mut count = 0.0_f64;
    let mut sum = 0.0;
    let pivot = values.clone().next().unwrap_or(0.0);
    for value in values.clone() {
        sum += value - pivot;
        count += 1.0;
    }
    let shift = sum / count.max(1.0);
    let (mut squares, mut rest) = (0.0, 0.0);
    for value in values {
        let deviation = (value - pivot) - shift;
        squares += deviation * deviation;
        rest += deviation;
    }
    let squares = (squares - rest * rest / count.max(1.0)).max(0.0);
    (pivot + shift, squares)
}

/// Values less their mean.
pub(crate) fn centred(values: &[f64]) -> Vec<f64> {
    let pivot = values.first().copied().unwrap_or(0.0);
    let shift = values.iter().map(|v| v - pivot).sum::<f64>() / values.len().max(1) as f64;
    values.iter().map(|v| (v - pivot) - shift).collect()
}

/// Whether deviations are no more than rounding of numbers as large as `scale`.
pub(crate) fn is_rounding(deviation: f64, scale: f64) -> bool {
    deviation.abs() <= 4.0 * f64::EPSILON * scale.abs()
}

/// Whether all values are equal, or differ only by rounding.
pub(crate) fn is_constant(values: &[f64]) -> bool {
    let Some(&first) = values.first() else {
        return true;
    };
    let scale = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    values.iter().all(|&v| is_rounding(v - first, scale))
}

/// The largest magnitude.
pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0_f64, |m, v| m.max(v.abs()))
}
