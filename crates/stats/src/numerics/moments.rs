//! Means and sums of squares that keep their digits far from zero.

/// Terms added side by side: sums of many values then wait for memory, not for each other.
const LANES: usize = 8;

/// Σ f(v), in a fixed order.
pub(crate) fn sum_of(values: &[f64], f: impl Fn(f64) -> f64) -> f64 {
    let mut lanes = [0.0; LANES];
    let chunks = values.chunks_exact(LANES);
    let rest: f64 = chunks.remainder().iter().map(|&v| f(v)).sum();
    for chunk in chunks {
        for (lane, &v) in lanes.iter_mut().zip(chunk) {
            *lane += f(v);
        }
    }
    lanes.iter().sum::<f64>() + rest
}

/// Σ x y, in a fixed order.
pub(crate) fn dot(x: &[f64], y: &[f64]) -> f64 {
    let mut lanes = [0.0; LANES];
    let (a, b) = (x.chunks_exact(LANES), y.chunks_exact(LANES));
    let rest = a.remainder().iter().zip(b.remainder());
    let rest: f64 = rest.map(|(x, y)| x * y).sum();
    for (a, b) in a.zip(b) {
        for ((lane, x), y) in lanes.iter_mut().zip(a).zip(b) {
            *lane += x * y;
        }
    }
    lanes.iter().sum::<f64>() + rest
}

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
    let shift = sum_of(values, |v| v - pivot) / values.len().max(1) as f64;
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
    let scale = largest(values);
    values.iter().all(|&v| is_rounding(v - first, scale))
}

/// The largest magnitude.
pub(crate) fn largest(values: &[f64]) -> f64 {
    let mut lanes = [0.0_f64; LANES];
    let chunks = values.chunks_exact(LANES);
    let rest = chunks.remainder().iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    for chunk in chunks {
        for (lane, v) in lanes.iter_mut().zip(chunk) {
            *lane = lane.max(v.abs());
        }
    }
    lanes.iter().fold(rest, |m, &v| m.max(v))
}
