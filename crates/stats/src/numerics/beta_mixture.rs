//! Poisson-like mixtures of incomplete beta functions, which noncentral F and t are made of.

use super::special::{beta_tails, ln_beta, ln_gamma};

/// Terms tabulated at most; beyond that each sum is made on its own.
const MOST_TERMS: f64 = 300.0;

/// Σ w(j) I_x(a + j, b), with w(j) = exp(-rate) rate^j / Γ(j + shift), so that shift 1 is the
/// Poisson law. x, y = 1 - x, a and b stay; the rate is what a search moves.
pub(super) struct BetaMixture {
    a: f64,
    b: f64,
    x: f64,
    y: f64,
    shift: f64,
    /// I_x(a + j, b) for j from 0, or nothing.
    tails: Vec<f64>,
}

impl BetaMixture {
    pub(super) fn new([a, b]: [f64; 2], [x, y]: [f64; 2], shift: f64) -> Self {
        Self { a, b, x, y, shift, tails: Vec::new() }
    }

    /// The same, quick at rates up to about `rate`.
    pub(super) fn tabulated(mut self, rate: f64) -> Self {
        let terms = terms_at(rate);
        // The steps I(a + j) - I(a + j + 1) = x^(a+j) y^b / ((a+j) B(a+j, b)), from the first.
        let mut step = self.step_at(self.a);
        if !(terms <= MOST_TERMS && step > 1e-200) {
            return self;
        }
        let terms = terms as usize;
        let mut tails = Vec::with_capacity(terms);
        for j in 0..terms {
            tails.push(step);
            let a = self.a + j as f64;
            step *= self.x * (a + self.b) / (a + 1.0);
        }
        // Summed from the far end, so that only positive numbers are added.
        let mut tail = beta_tails(self.a + terms as f64, self.b, self.x, self.y).0;
        for value in tails.iter_mut().rev() {
            tail = (tail + *value).min(1.0);
            *value = tail;
        }
        self.tails = tails;
        self
    }

    pub(super) fn sum(&self, rate: f64) -> f64 {
        if terms_at(rate) <= self.tails.len() as f64 {
            self.sum_of_table(rate)
        } else {
            self.sum_outwards(rate)
        }
    }

    fn sum_of_table(&self, rate: f64) -> f64 {
        let mut weight = libm::exp(-rate - ln_gamma(self.shift));
        let (mut total, mut place) = (0.0, self.shift);
        for tail in &self.tails {
            let term = weight * tail;
            total += term;
            if term <= 1e-17 * total && place > rate + 1.0 {
                break;
            }
            weight *= rate / place;
            place += 1.0;
        }
        total
    }

    /// x^a y^b / (a B(a, b)).
    fn step_at(&self, a: f64) -> f64 {
        libm::exp(a * libm::log(self.x) + self.b * libm::log(self.y) - ln_beta(a, self.b)) / a
    }

    /// Starts at the largest weight, so that the rate may be large.
    fn sum_outwards(&self, rate: f64) -> f64 {
        let start = rate.floor();
        let ln_weight = if rate > 0.0 {
            start * libm::log(rate) - rate - ln_gamma(start + self.shift)
        } else {
            -ln_gamma(self.shift)
        };
        let weight = libm::exp(ln_weight);
        let a0 = self.a + start;
        let tail = beta_tails(a0, self.b, self.x, self.y).0;
        // I(a + 1) = I(a) - x^a y^b / (a B(a, b)).
        let drop = self.step_at(a0);
        let mut total = weight * tail;
        let (mut w, mut t, mut d, mut j) = (weight, tail, drop, start);
        loop {
            t = (t - d).max(0.0);
            d *= self.x * (self.a + j + self.b) / (self.a + j + 1.0);
            j += 1.0;
            w *= rate / (j - 1.0 + self.shift);
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
            w *= (j - 1.0 + self.shift) / rate;
            j -= 1.0;
            total += w * t;
            if w < 1e-17 * weight || start - j > 1e6 {
                break;
            }
        }
        total
    }
}

/// Terms after which the weights at this rate are far below rounding.
fn terms_at(rate: f64) -> f64 {
    rate + 8.0 * rate.sqrt() + 25.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_gives_what_each_sum_gives_alone() {
        for (a, b, x) in [
            (0.5, 11.5, 0.15_f64),
            (1.0, 11.5, 0.4),
            (1.5, 34.5, 0.02),
            (0.5, 0.5, 0.9),
            (1.5, 4999.5, 1e-3),
        ] {
            let mixture = BetaMixture::new([a, b], [x, 1.0 - x], 1.5).tabulated(60.0);
            assert!(!mixture.tails.is_empty());
            for rate in [0.0, 1e-3, 0.7, 5.0, 31.9, 60.0] {
                let (table, alone) = (mixture.sum(rate), mixture.sum_outwards(rate));
                assert!((table - alone).abs() < 1e-13, "{a} {b} {x} {rate}: {table} {alone}");
            }
        }
    }

    #[test]
    fn what_would_vanish_is_not_tabulated() {
        let mixture = BetaMixture::new([0.5, 5000.0], [0.5, 0.5], 1.0).tabulated(60.0);
        assert!(mixture.tails.is_empty());
    }
}
