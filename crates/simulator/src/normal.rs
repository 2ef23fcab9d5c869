//! Normal draws that are the same on every machine.

use maveric_domain::stream_seed;
use rand::{RngExt as _, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// One draw from N(0, 1).
///
/// # Source
/// Marsaglia's polar method, with `libm`'s logarithm: the standard library's differs from machine to machine in the last place.
pub(crate) fn standard_normal(rng: &mut Pcg64Mcg) -> f64 {
    loop {
        let u = 2.0 * rng.random::<f64>() - 1.0;
        let v = 2.0 * rng.random::<f64>() - 1.0;
        let square = u * u + v * v;
        if square > 0.0 && square < 1.0 {
            return u * (-2.0 * libm::log(square) / square).sqrt();
        }
    }
}

/// The first draw of a stream.
pub(crate) fn normal_of(seed: u64, stream: &[&str]) -> f64 {
    standard_normal(&mut Pcg64Mcg::seed_from_u64(stream_seed(seed, stream)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_have_the_moments_of_the_normal() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let draws: Vec<f64> = (0..200_000).map(|_| standard_normal(&mut rng)).collect();
        let moment = |k| draws.iter().map(|z: &f64| z.powi(k)).sum::<f64>() / 200_000.0;
        assert!(moment(1).abs() < 0.01 && (moment(2) - 1.0).abs() < 0.02);
        assert!(moment(3).abs() < 0.05 && (moment(4) - 3.0).abs() < 0.1);
    }
}
