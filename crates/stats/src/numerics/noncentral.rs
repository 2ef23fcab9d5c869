//! Noncentral F and t distributions, summed outwards from the largest Poisson weight.
//!
//! Starting in the middle is what lets the noncentrality be large: R's `pt`, which starts
//! at zero, stops at 37.6.

use super::{
    beta_mixture::BetaMixture,
    distributions::{chi2_upper, normal_density, normal_quantile, normal_upper},
    normal_scale::on_normal_scale,
    roots,
};

/// The distribution function of the noncentral F at one `f` above 0.
struct AtF {
    f: f64,
    df1: f64,
    df2: f64,
    mixture: BetaMixture,
}

impl AtF {
    fn new(f: f64, df1: f64, df2: f64) -> Self {
        let whole = df2 + df1 * f;
        let mixture = BetaMixture::new([0.5 * df1, 0.5 * df2], [df1 * f / whole, df2 / whole], 1.0);
        Self { f, df1, df2, mixture }
    }

    fn lower(&self, ncp: f64) -> f64 {
        let scaled = self.df1 * self.f;
        if ncp > 1e5 && scaled > 1e5 {
            return f_lower_large(scaled, self.df1, self.df2, ncp);
        }
        self.mixture.sum(0.5 * ncp).clamp(0.0, 1.0)
    }
}

/// P(F <= f) with noncentrality `ncp`.
pub(crate) fn f_lower(f: f64, df1: f64, df2: f64, ncp: f64) -> f64 {
    if f <= 0.0 {
        return 0.0;
    }
    AtF::new(f, df1, df2).lower(ncp)
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

/// The distribution function of the noncentral t at one `t` of at least 0.
struct AtT {
    t: f64,
    df: f64,
    even: BetaMixture,
    odd: BetaMixture,
}

impl AtT {
    fn new(t: f64, df: f64) -> Self {
        let square = t * t;
        let share = [square / (df + square), df / (df + square)];
        Self {
            t,
            df,
            even: BetaMixture::new([0.5, 0.5 * df], share, 1.0),
            odd: BetaMixture::new([1.0, 0.5 * df], share, 1.5),
        }
    }

    fn lower(&self, ncp: f64) -> f64 {
        let (t, df) = (self.t, self.df);
        let below = normal_upper(ncp);
        if t <= 0.0 {
            return below;
        }
        if ncp < -9.0 {
            return 1.0; // T is negative but for 1e-19.
        }
        if t * t > 2500.0 + 50.0 * df && ncp > 9.0 {
            // T ≤ t means s ≥ (ncp + Z)/t, where s² is χ²/df.
            return over_normal(|z| chi2_upper(df * ((ncp + z) / t).powi(2), df));
        }
        let rate = 0.5 * ncp * ncp;
        let odd = ncp * std::f64::consts::FRAC_1_SQRT_2 * self.odd.sum(rate);
        (below + 0.5 * (self.even.sum(rate) + odd)).clamp(0.0, 1.0)
    }
}

/// P(T <= t) with noncentrality `ncp`.
pub(crate) fn t_lower(t: f64, df: f64, ncp: f64) -> f64 {
    if t < 0.0 {
        return 1.0 - t_lower(-t, df, -ncp);
    }
    AtT::new(t, df).lower(ncp)
}

/// The noncentralities that leave `tail` above and below an observed F; 0 where none does.
pub(crate) fn f_ncp_interval(f: f64, df1: f64, df2: f64, tail: f64) -> Option<(f64, f64)> {
    if f <= 0.0 {
        return Some((0.0, 0.0));
    }
    let scale = df1 * f;
    // The root of ncp, less that of its expectation, is nearly normal.
    let spread = (1.0 + scale / (2.0 * df2)).sqrt();
    let centre = (scale - df1).max(0.0).sqrt();
    let reach = normal_quantile(1.0 - tail) * spread;
    let mut distribution = AtF::new(f, df1, df2);
    distribution.mixture = distribution.mixture.tabulated(0.5 * (centre + reach + spread).powi(2));
    let central = distribution.lower(0.0);
    let ncp_at = |probability: f64, guess: f64| {
        if central <= probability {
            return Some(0.0);
        }
        let lower_tail = |root: f64| distribution.lower(root * root);
        let first = guess.max(0.1);
        on_normal_scale(lower_tail, probability, first, first + 0.2 * spread)
            .map(|root| root * root)
            .or_else(|| {
                let gap = |ncp: f64| distribution.lower(ncp) - probability;
                roots::upwards(gap, 0.0, scale.max(1.0))
            })
    };
    Some((ncp_at(1.0 - tail, centre - reach)?, ncp_at(tail, centre + reach)?))
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
    let mut distribution = AtT::new(t, df);
    let rate = 0.5 * (t + reach + spread).powi(2);
    distribution.even = distribution.even.tabulated(rate);
    distribution.odd = distribution.odd.tabulated(rate);
    let ncp_at = |probability: f64, guess: f64| {
        let lower_tail = |ncp: f64| distribution.lower(ncp);
        on_normal_scale(lower_tail, probability, guess, guess + 0.1 * spread)
            .or_else(|| bracketed(|ncp| lower_tail(ncp) - probability, guess, 0.1 * spread))
    };
    Some((ncp_at(1.0 - tail, t - reach)?, ncp_at(tail, t + reach)?))
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
            assert!((high2 / high - 1.0 - 2e-6).abs() < 1e-6, "{df} {high} {high2}");
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
