//! Roots of what is nearly a line on the scale of normal deviates.

use super::distributions::normal_quantile;

/// Where a distribution function that is nearly normal in its parameter has a value: the
/// secant method on the scale of normal deviates, where the function is nearly a line.
///
/// `None` if that does not settle within a dozen steps; a bracketing method then must.
pub(crate) fn on_normal_scale(
    lower_tail: impl Fn(f64) -> f64,
    probability: f64,
    first: f64,
    second: f64,
) -> Option<f64> {
    let target = normal_quantile(probability);
    let gap = |x: f64| {
        let p = lower_tail(x);
        (p > 0.0 && p < 1.0).then(|| normal_quantile(p) - target)
    };
    let (mut a, mut b) = (first, second);
    let (mut ga, mut gb) = (gap(a)?, gap(b)?);
    for _ in 0..12 {
        let step = gb * (b - a) / (gb - ga);
        if !step.is_finite() {
            return (gb.abs() < 1e-13).then_some(b);
        }
        (a, ga) = (b, gb);
        b -= step;
        // The function is so nearly a line that the next step would be below rounding.
        if step.abs() <= 1e-8 * b.abs() {
            return Some(b);
        }
        gb = gap(b)?;
    }
    None
}
