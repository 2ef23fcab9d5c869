//! Incomplete beta and gamma functions, with both tails computed directly.
//!
//! `statrs` stops its continued fraction after 140 terms and forms one tail as
//! `1 - other`; with 10,000 subjects neither is enough.

pub(crate) use libm::lgamma as ln_gamma;

const MAX_TERMS: u32 = 100_000;
const TINY: f64 = 1e-300;

/// What Stirling's formula leaves out of `ln_gamma(x)`, for `x >= 10`.
fn stirling_rest(x: f64) -> f64 {
    let y = 1.0 / (x * x);
    (1.0 / 12.0
        - y * (1.0 / 360.0
            - y * (1.0 / 1260.0 - y * (1.0 / 1680.0 - y * (1.0 / 1188.0 - y * 691.0 / 360_360.0)))))
        / x
}

/// `ln B(a, b)` without the cancellation of three large `ln_gamma`.
pub(crate) fn ln_beta(a: f64, b: f64) -> f64 {
    let (p, q) = (a.min(b), a.max(b));
    if q < 10.0 {
        return ln_gamma(p) + (ln_gamma(q) - ln_gamma(p + q));
    }
    let share = p / (p + q);
    if p < 10.0 {
        let corr = stirling_rest(q) - stirling_rest(p + q);
        return ln_gamma(p) + corr + p - p * libm::log(p + q) + (q - 0.5) * libm::log1p(-share);
    }
    let corr = stirling_rest(p) + stirling_rest(q) - stirling_rest(p + q);
    -0.5 * libm::log(q)
        + 0.5 * libm::log(2.0 * std::f64::consts::PI)
        + corr
        + (p - 0.5) * libm::log(share)
        + q * libm::log1p(-share)
}

/// Hedges' exact correction, Γ(m/2) / (√(m/2) Γ((m-1)/2)), for m degrees of freedom, m > 1.
pub(crate) fn hedges_factor(m: f64) -> f64 {
    libm::exp(ln_gamma_half_step(0.5 * (m - 1.0)) - 0.5 * libm::log(0.5 * m))
}

/// `ln_gamma(x + 1/2) - ln_gamma(x)`.
pub(crate) fn ln_gamma_half_step(x: f64) -> f64 {
    // B(x, 1/2) = Γ(x) Γ(1/2) / Γ(x + 1/2)
    0.5 * libm::log(std::f64::consts::PI) - ln_beta(x, 0.5)
}

/// `(I_x(a, b), 1 - I_x(a, b))`, where `y = 1 - x` is given beside `x` to keep its digits.
pub(crate) fn beta_tails(a: f64, b: f64, x: f64, y: f64) -> (f64, f64) {
    if x <= 0.0 {
        return (0.0, 1.0);
    }
    if y <= 0.0 {
        return (1.0, 0.0);
    }
    // The logarithm of what is close to 1 has its digits in the other of both.
    let ln = |x: f64, rest: f64| {
        if rest < 0.5 { libm::log1p(-rest) } else { libm::log(x) }
    };
    let front = libm::exp(a * ln(x, y) + b * ln(y, x) - ln_beta(a, b));
    if x < (a + 1.0) / (a + b + 2.0) {
        let low = (front * beta_fraction(a, b, x) / a).min(1.0);
        (low, 1.0 - low)
    } else {
        let high = (front * beta_fraction(b, a, y) / b).min(1.0);
        (1.0 - high, high)
    }
}

/// The continued fraction of the incomplete beta function, by Lentz's method.
fn beta_fraction(a: f64, b: f64, x: f64) -> f64 {
    let guard = |v: f64| if v.abs() < TINY { TINY } else { v };
    let mut c = 1.0;
    let mut d = 1.0 / guard(1.0 - (a + b) * x / (a + 1.0));
    let mut h = d;
    for m in 1..MAX_TERMS {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        d = 1.0 / guard(1.0 + even * d);
        c = guard(1.0 + even / c);
        h *= d * c;
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / guard(1.0 + odd * d);
        c = guard(1.0 + odd / c);
        let step = d * c;
        h *= step;
        if (step - 1.0).abs() < 1e-16 {
            break;
        }
    }
    h
}

/// `x^a e^-x / Γ(a)`, without the cancellation of large logarithms.
fn gamma_front(a: f64, x: f64) -> f64 {
    if a < 10.0 {
        return libm::exp(a * libm::log(x) - x - ln_gamma(a));
    }
    let share = (x - a) / a;
    let distance =
        if share.abs() < 0.5 { share - libm::log1p(share) } else { share - libm::log(x / a) };
    let ln_root = 0.5 * libm::log(a / std::f64::consts::TAU);
    libm::exp(ln_root - stirling_rest(a) - a * distance)
}

/// `Q(a, x)`, the upper regularised incomplete gamma function.
pub(crate) fn gamma_upper(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let front = gamma_front(a, x);
    if x < a + 1.0 {
        let (mut term, mut sum, mut at) = (1.0 / a, 1.0 / a, a);
        for _ in 0..MAX_TERMS {
            at += 1.0;
            term *= x / at;
            sum += term;
            if term < sum * 1e-17 {
                break;
            }
        }
        return (1.0 - front * sum).max(0.0);
    }
    let mut b = x + 1.0 - a;
    let mut c = 1.0 / TINY;
    let mut d = 1.0 / b;
    let mut h = d;
    for i in 1..MAX_TERMS {
        let i = f64::from(i);
        let an = -i * (i - a);
        b += 2.0;
        d = 1.0 / (an * d + b);
        c = b + an / c;
        let step = d * c;
        h *= step;
        if (step - 1.0).abs() < 1e-16 {
            break;
        }
    }
    front * h
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_beta_function_of_large_arguments_keeps_its_digits() {
        // B(3, b) = 2 / (b (b + 1) (b + 2)).
        let b = 1e7_f64;
        let exact = (2.0 / (b * (b + 1.0) * (b + 2.0))).ln();
        assert!((ln_beta(3.0, b) - exact).abs() < 1e-12);
        assert!(
            (ln_beta(12.0, 11.0) - (ln_gamma(12.0) + ln_gamma(11.0) - ln_gamma(23.0))).abs()
                < 1e-12
        );
    }

    #[test]
    fn the_incomplete_beta_function_agrees_with_its_closed_form() {
        // I_x(2, 3) = x^2 (6 - 8x + 3x^2).
        for x in [0.01, 0.3, 0.5, 0.9] {
            let exact = x * x * (6.0 - 8.0 * x + 3.0 * x * x);
            let (low, high) = beta_tails(2.0, 3.0, x, 1.0 - x);
            assert!((low - exact).abs() < 1e-14 && (low + high - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn the_gamma_tail_of_one_is_an_exponential() {
        for x in [0.1_f64, 1.0, 5.0, 300.0] {
            assert!((gamma_upper(1.0, x) / (-x).exp() - 1.0).abs() < 1e-12);
        }
    }
}
