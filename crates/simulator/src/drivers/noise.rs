//! Ornstein-Uhlenbeck noise: wander that is the same from one moment to the next.

use crate::normal::standard_normal;
use rand_pcg::Pcg64Mcg;

/// A stationary Ornstein-Uhlenbeck process, sampled evenly.
#[derive(Debug, Clone)]
pub struct OrnsteinUhlenbeck {
    keep: f64,
    kick: f64,
    value: f64,
    rng: Pcg64Mcg,
}

impl OrnsteinUhlenbeck {
    /// Standard deviation `sd`, correlation time `time_s`, a sample every `step_s`.
    pub fn new(sd: f64, time_s: f64, step_s: f64, mut rng: Pcg64Mcg) -> Self {
        let keep = libm::exp(-step_s / time_s);
        let first = standard_normal(&mut rng);
        Self { keep, kick: sd * (1.0 - keep * keep).sqrt(), value: sd * first, rng }
    }

    /// The next sample.
    #[expect(clippy::should_implement_trait, reason = "it has no end")]
    pub fn next(&mut self) -> f64 {
        let noise = standard_normal(&mut self.rng);
        self.value = self.keep * self.value + self.kick * noise;
        self.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn the_wander_has_the_spread_and_the_memory_asked_for() {
        let mut ou = OrnsteinUhlenbeck::new(0.4, 20.0, 0.05, Pcg64Mcg::seed_from_u64(1));
        let values: Vec<f64> = (0..2_000_000).map(|_| ou.next()).collect();
        let n = values.len() as f64;
        let variance = values.iter().map(|v| v * v).sum::<f64>() / n;
        assert!((variance.sqrt() - 0.4).abs() < 0.03, "{variance}");
        let lagged: f64 = values.iter().zip(&values[400..]).map(|(a, b)| a * b).sum();
        let correlation = lagged / n / variance;
        assert!((correlation - (-1.0_f64).exp()).abs() < 0.08, "{correlation}");
    }
}
