//! How often `compare` finds a difference where there is none: 20,000 null data sets of 24
//! subjects and 4 conditions with and without sphericity, and 1,000 with skewed errors.
//!
//! Run with `cargo run --release -p maveric-stats --example false_positives`; it takes ten minutes
//! or more, nearly all of them for exact p values of Friedman's test.
#![expect(
    clippy::print_stdout,
    reason = "an example shows its table on the terminal"
)]

use maveric_stats::{OmnibusTest, StatsError, WithinSubjects, compare, proportion};
use rand::Rng;
use rand_pcg::Pcg64;

const SETS: usize = 20_000;
/// Skewed errors mean Friedman's test, whose exact p takes some thirty milliseconds.
const SKEWED_SETS: usize = 1_000;
const N: usize = 24;
const K: usize = 4;

/// A standard normal deviate, by Box and Muller.
fn normal(generator: &mut Pcg64) -> f64 {
    let mut uniform = || (f64::from(generator.next_u32()) + 0.5) / 4_294_967_296.0;
    let (a, b) = (uniform(), uniform());
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

fn data(
    generator: &mut Pcg64,
    spread: [f64; K],
    shape: fn(f64) -> f64,
) -> Result<WithinSubjects, StatsError> {
    let names = |size: usize| -> Vec<String> { (0..size).map(|i| i.to_string()).collect() };
    let rows: Vec<Vec<f64>> = (0..N)
        .map(|_| {
            let own = normal(generator);
            let error = spread.map(|s| s * shape(normal(generator)));
            error.iter().map(|e| own + e).collect()
        })
        .collect();
    WithinSubjects::from_rows(&names(K), &names(N), &rows)
}

/// Name, number of data sets, standard deviations of the conditions, shape of the errors.
type Case = (&'static str, usize, [f64; K], fn(f64) -> f64);

fn main() -> Result<(), StatsError> {
    let cases: [Case; 4] = [
        ("normal, spherical", SETS, [1.0; K], |z| z),
        (
            "normal, epsilon about .7",
            SETS,
            [1.0, 1.0, 1.5, 2.5],
            |z| z,
        ),
        (
            "normal, epsilon about .45",
            SETS,
            [0.4, 0.4, 0.4, 4.0],
            |z| z,
        ),
        ("lognormal, spherical", SKEWED_SETS, [1.0; K], |z| z.exp()),
    ];
    println!(
        "{:<28}{:>8}  95 % interval   ANOVA chosen",
        "errors", "rate"
    );
    for (name, sets, spread, shape) in cases {
        let mut generator = Pcg64::new(20, 24);
        let (mut found, mut anova) = (0, 0);
        for _ in 0..sets {
            let result = compare(&data(&mut generator, spread, shape)?, 0.05)?;
            found += usize::from(result.omnibus.reject == Some(true));
            anova += usize::from(result.chosen == OmnibusTest::RmAnova);
        }
        let rate = proportion(found, sets, 0.95)?;
        let chosen = 100.0 * anova as f64 / sets as f64;
        println!(
            "{name:<28}{:>8.4}  [{:.4}, {:.4}] {chosen:>8.1} %",
            rate.estimate, rate.low, rate.high
        );
    }
    Ok(())
}
