//! Noncentral F and t distributions, summed outwards from the largest Poisson weight.
//!
//! Starting in the middle is what lets the noncentrality be large: R's `pt`, which starts
//! at zero, stops at 37.6.

use super::{
    distributions::{chi2_upper, normal_density, normal_quantile, normal_upper},
    roots,
    special::{beta_tails, ln_beta, ln_gamma},
};

/// Σ w(j) I_x(a + j, b), with `ln w(j) = rate ln-weights` given by `ln_weight` at the start
/// and by the factor `rate / (j + shift)` from one term to the next.
struct BetaMixture {
    a: f64,
    b: f64,
    x: f64,
    y: f64,
    rate: f64,
    shift: f64,
}

impl BetaMixture {
    /// `weight(j) = exp(-rate) rate^j / Γ(j + shift)`, so that shift 1 is the Poisson law.
    fn sum(&self) -> f64 {
        let start = self.rate.floor();
        let ln_weight = if self.rate > 0.0 {
            start * self.rate.ln() - self.rate - ln_gamma(start + self.shift)
        } else {
            -ln_gamma(self.shift)
        };
        let weight = ln_weight.exp();
        let a0 = self.a + start;
        let tail = beta_tails(a0, self.b, self.x, self.y).0;
        // I(a + 1) = I(a) - x^a y^b / (a B(a, b)).
        let drop = (a0 * self.x.ln() + self.b * self.y.ln() - ln_beta(a0, self.b)).exp() / a0;
        let mut total = weight * tail;
        let (mut w, mut t, mut d, mut j) = (weight, tail, drop, start);
        loop {
            t = (t - d).max(0.0);
            d *= self.x * (self.a + j + self.b) / (self.a + j + 1.0);
            j += 1.0;
            w *= self.rate / (j - 1.0 + self.shift);
            let term = w * t;
            total += term;
            if w < 1e-17 * weight || term <= 1e-17 * total || j - start > 1e6 {
                break;
            }
        }
        let (mut w, mut t, mut d, mut j) = (weight, tail, drop, start);
        while j > 0.0 {
            d *= (self.a + j) / (self.x * (self.a + j - 1.0 + self.b));
            t = (t + d).min(1.0);
            w *= (j - 1.0 + self.shift) / self.rate;
            j -= 1.0;
            total += w * t;
            if w < 1e-17 * weight || start - j > 1e6 {
                break;
            }
        }
        total
    }
}

/// P(F <= f) with noncentrality `ncp`.
pub(crate) fn f_lower(f: f64, df1: f64, df2: f64, ncp: f64) -> f64 {
    if f <= 0.0 {
        return 0.0;
    }
    if ncp > 1e5 && df1 * f > 1e5 {
        return f_lower_large(df1 * f, df1, df2, ncp);
    }
    let whole = df2 + df1 * f;
    let mixture = BetaMixture {
        a: 0.5 * df1,
        b: 0.5 * df2,
        x: df1 * f / whole,
        y: df2 / whole,
        rate: 0.5 * ncp,
        shift: 1.0,
    };
    mixture.sum().clamp(0.0, 1.0)
}

/// P(F <= f) for a large noncentrality, whose χ² is taken as normal (relative skewness
/// below 1e-7).
fn f_lower_large(scaled: f64, df1: f64, df2: f64, ncp: f64) -> f64 {
    let (mean, sd) = (df1 + ncp, (2.0 * (df1 + 2.0 * ncp)).sqrt());
    over_normal(|z| chi2_upper(df2 * (mean + sd * z) / scaled, df2))
}

/// The mean of a smooth function of a standard normal Z, by the trapezoidal rule: with
/// this step its error is far below double precision.
fn over_normal(f: impl Fn(f64) -> f64) -> f64 {
    const STEP: f64 = 0.5;
    let nodes = (-17..=17).map(|i| STEP * f64::from(i));
    (nodes.map(|z| normal_density(z) * f(z)).sum::<f64>() * STEP).clamp(0.0, 1.0)
}

/// P(T <= t) with noncentrality `ncp`.
pub(crate) fn t_lower(t: f64, df: f64, ncp: f64) -> f64 {
    if t < 0.0 {
        return 1.0 - t_lower(-t, df, -ncp);
    }
    let below = normal_upper(ncp);
    if t <= 0.0 {
        return below;
    }
    if ncp < -9.0 {
        return 1.0; // T is negative but for 1e-19.
    }
    let square = t * t;
    if square > 2500.0 + 50.0 * df && ncp > 9.0 {
        // T ≤ t means s ≥ (ncp + Z)/t, where s² is χ²/df.
        return over_normal(|z| chi2_upper(df * ((ncp + z) / t).powi(2), df));
    }
    let even = BetaMixture {
        a: 0.5,
        b: 0.5 * df,
        x: square / (df + square),
        y: df / (df + square),
        rate: 0.5 * ncp * ncp,
        shift: 1.0,
    };
    let odd = BetaMixture {
        a: 1.0,
        shift: 1.5,
        ..even
    };
    let odd_sum = ncp * std::f64::consts::FRAC_1_SQRT_2 * odd.sum();
    (below + 0.5 * (even.sum() + odd_sum)).clamp(0.0, 1.0)
}

/// The noncentralities that leave `tail` above and below an observed F; 0 where none does.
pub(crate) fn f_ncp_interval(f: f64, df1: f64, df2: f64, tail: f64) -> Option<(f64, f64)> {
    let scale = df1 * f;
    let central = f_lower(f, df1, df2, 0.0);
    // The root of ncp, less that of its expectation, is nearly normal.
    let spread = (1.0 + scale / (2.0 * df2)).sqrt();
    let at = |probability: f64, guess: f64| {
        if central <= probability {
            return Some(0.0);
        }
        let lower_tail = |root: f64| f_lower(f, df1, df2, root * root);
        let first = guess.max(0.1);
        roots::on_normal_scale(lower_tail, probability, first, first + 0.2 * spread)
            .map(|root| root * root)
            .or_else(|| {
                let gap = |ncp: f64| f_lower(f, df1, df2, ncp) - probability;
                roots::upwards(gap, 0.0, scale.max(1.0))
            })
    };
    let centre = (scale - df1).max(0.0).sqrt();
    let reach = normal_quantile(1.0 - tail) * spread;
    Some((at(1.0 - tail, centre - reach)?, at(tail, centre + reach)?))
}

/// The noncentralities that leave `tail` above and below an observed t.
pub(crate) fn t_ncp_interval(t: f64, df: f64, tail: f64) -> Option<(f64, f64)> {
    if t < 0.0 {
        let (low, high) = t_ncp_interval(-t, df, tail)?;
        return Some((-high, -low));
    }
    // (ncp - t) / √(1 + t²/2df) is nearly normal: a first guess.
    let spread = (1.0 + t * t / (2.0 * df)).sqrt();
    let reach = normal_quantile(1.0 - tail) * spread;
    let at = |probability: f64, guess: f64| {
        let lower_tail = |ncp: f64| t_lower(t, df, ncp);
        roots::on_normal_scale(lower_tail, probability, guess, guess + 0.1 * spread)
            .or_else(|| bracketed(|ncp| lower_tail(ncp) - probability, guess, 0.1 * spread))
    };
    Some((at(1.0 - tail, t - reach)?, at(tail, t + reach)?))
}

/// The root of a falling function, looked for outwards from a guess.
fn bracketed(gap: impl Fn(f64) -> f64, guess: f64, mut step: f64) -> Option<f64> {
    let (mut low, mut high) = (guess - step, guess + step);
    for _ in 0..60 {
        step *= 3.0;
        if gap(low) <= 0.0 {
            (low, high) = (low - step, low);
        } else if gap(high) >= 0.0 {
            (low, high) = (high, high + step);
        } else {
            return roots::brent(gap, low, high);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::distributions::{f_upper, t_two_sided};

    #[test]
    fn without_noncentrality_they_are_the_central_distributions() {
        assert!((f_lower(2.5, 3.0, 69.0, 0.0) - (1.0 - f_upper(2.5, 3.0, 69.0))).abs() < 1e-14);
        assert!((t_lower(2.0, 23.0, 0.0) - (1.0 - 0.5 * t_two_sided(2.0, 23.0))).abs() < 1e-14);
    }

    #[test]
    fn the_square_of_a_noncentral_t_is_a_noncentral_f() {
        for ncp in [0.3, 4.0, 60.0_f64] {
            for t in [0.5, 3.0, 55.0_f64] {
                let both = t_lower(t, 9.0, ncp) - t_lower(-t, 9.0, ncp);
                let f = f_lower(t * t, 1.0, 9.0, ncp * ncp);
                assert!((both - f).abs() < 1e-12, "{ncp} {t} {both} {f}");
            }
        }
    }

    #[test]
    fn large_statistics_meet_the_series_where_it_hands_over() {
        for df in [1.0, 9.0, 500.0_f64] {
            // Just below and just above the limit: the interval grows in proportion.
            let t = (2500.0 + 50.0 * df).sqrt();
            let (low, high) = t_ncp_interval(t * 0.999_999, df, 0.025).unwrap();
            let (low2, high2) = t_ncp_interval(t * 1.000_001, df, 0.025).unwrap();
            assert!((low2 / low - 1.0 - 2e-6).abs() < 1e-6, "{df} {low} {low2}");
            assert!(
                (high2 / high - 1.0 - 2e-6).abs() < 1e-6,
                "{df} {high} {high2}"
            );
        }
        let below = f_lower(40_000.0, 3.0, 69.0, 99_999.9);
        let above = f_lower(40_000.0, 3.0, 69.0, 100_000.1);
        assert!((below - above).abs() < 1e-5 && below > above);
    }

    #[test]
    fn the_interval_of_the_sleep_data_is_that_of_r() {
        let (low, high) = t_ncp_interval(-4.062_127_683_382_037, 9.0, 0.025).unwrap();
        let n = 10.0_f64.sqrt();
        assert!((low / n + 2.118_016_513_981_378_7).abs() < 1e-9);
        assert!((high / n + 0.414_627_756_380_452_63).abs() < 1e-9);
    }
}
