//! The studentised range.

use super::{
    distributions::{normal_density, normal_upper},
    roots,
    special::ln_gamma,
};

/// P(range of `k` standard normal values > `q`).
///
/// k ∫ φ(z) (Φ(z)^(k-1) - (Φ(z) - Φ(z - q))^(k-1)) dz by the trapezoidal rule, which
/// converges exponentially here; the difference is formed without cancellation, so the far
/// tail keeps its digits (R's `ptukey` has none below 1e-13).
pub(crate) fn upper(q: f64, k: usize) -> f64 {
    // The error of the rule is about exp(-2π² / (step² k)): below 1e-17 with this step.
    let step = 0.7 / (k as f64).sqrt();
    // Φ(z), the upper tail at q - z, and φ(z) make one term.
    let term = |whole: f64, upper: f64, z: f64| {
        // a^m - b^m = (a - b) Σ a^i b^(m-1-i), where a - b is the upper tail itself.
        let lower = (whole - upper).max(0.0);
        let (mut sum, mut power) = (0.0, 1.0);
        for _ in 1..k {
            sum = sum * lower + power;
            power *= whole;
        }
        normal_density(z) * upper * sum
    };
    let middle = 0.5 * q;
    let tail = normal_upper(middle);
    let mut total = term(1.0 - tail, tail, middle);
    for i in 1..10_000 {
        // Two terms as far above the middle as below: their four tails are two and their
        // complements, each taken from the smaller of the two.
        let far = step * f64::from(i);
        let outer = normal_upper(middle + far);
        let small = normal_upper((middle - far).abs());
        let (inner, rest) = if far > middle { (1.0 - small, small) } else { (small, 1.0 - small) };
        let above = term(1.0 - outer, inner, middle + far);
        let below = term(rest, outer, middle - far);
        total += above + below;
        // Past the peak the terms fall faster than a geometric series.
        if above.max(below) <= 1e-18 * total && far > 2.0 {
            break;
        }
    }
    (k as f64 * total * step).clamp(f64::MIN_POSITIVE, 1.0)
}

/// P(range of `k` standard normal values, over an independent √(χ²/df), > `q`).
///
/// The mean of [`upper`] over x = ln √(χ²/df), whose density is smooth and falls at least exponentially on both sides: the
/// trapezoidal rule again. Its error is about exp(-π²/(2 step)) for few and exp(-π²/(df step²)) for many degrees of freedom.
pub(crate) fn upper_with_df(q: f64, k: usize, df: f64) -> f64 {
    let half = 0.5 * df;
    let ln_front = std::f64::consts::LN_2 + half * libm::log(half) - ln_gamma(half);
    let ln_density = |x: f64| ln_front + df * x - half * libm::exp(2.0 * x);
    let step = 0.12_f64.min(0.5 / (2.0 * df).sqrt());
    let mut total = 0.0;
    for side in [-1.0, 1.0] {
        // The middle belongs to the right side.
        let mut i = if side < 0.0 { 1.0 } else { 0.0 };
        loop {
            let x = side * step * i;
            let density = libm::exp(ln_density(x));
            total += density * upper(q * libm::exp(x), k);
            if density < 1e-18 && i > 3.0 {
                break;
            }
            i += 1.0;
        }
    }
    (total * step).clamp(f64::MIN_POSITIVE, 1.0)
}

/// q with P(range > q) = `p`, as [`upper_with_df`].
pub(crate) fn quantile_upper(p: f64, k: usize, df: f64) -> Option<f64> {
    roots::upwards(|q| libm::log(upper_with_df(q, k, df)) - libm::log(p), 0.0, 4.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::distributions::t_two_sided;

    #[test]
    fn the_range_of_two_is_a_t() {
        for df in [1.0, 3.0, 17.5, 400.0] {
            for q in [0.3, 2.0, 6.0] {
                let exact = t_two_sided(q / 2.0_f64.sqrt(), df);
                let found = upper_with_df(q, 2, df);
                assert!((found / exact - 1.0).abs() < 1e-9, "{df} {q} {found} {exact}");
            }
        }
    }

    #[test]
    fn a_quantile_is_that_of_the_tables() {
        // Tukey's table: 5 %, three means, 10 degrees of freedom.
        let q = quantile_upper(0.05, 3, 10.0).unwrap();
        assert!((q - 3.877).abs() < 5e-4, "{q}");
    }

    #[test]
    fn two_values_are_a_normal_difference() {
        // range of two = |z1 - z2|, normal with variance 2.
        for q in [0.0, 0.5, 2.0, 6.0] {
            let exact = 2.0 * normal_upper(q / 2.0_f64.sqrt());
            assert!((upper(q, 2) / exact - 1.0).abs() < 1e-10, "{q}");
        }
    }
}
