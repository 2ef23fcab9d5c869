//! What the examples that simulate have in common: random numbers, and how many tables are asked for.

use rand::Rng;
use rand_pcg::Pcg64;

/// From 0 to 1, both left out.
pub(crate) fn uniform(generator: &mut Pcg64) -> f64 {
    (f64::from(generator.next_u32()) + 0.5) / 4_294_967_296.0
}

/// A standard normal deviate, by Box and Muller.
pub(crate) fn normal(generator: &mut Pcg64) -> f64 {
    let (a, b) = (uniform(generator), uniform(generator));
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

/// The first argument, a number of tables.
pub(crate) fn tables_or(default: u64) -> u64 {
    let argument = std::env::args().nth(1);
    argument.and_then(|n| n.parse().ok()).unwrap_or(default)
}
