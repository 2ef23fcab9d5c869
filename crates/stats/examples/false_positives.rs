//! How often `compare` finds a difference where there is none, in data sets of 24 subjects and 4 conditions.
//!
//! `cargo run --release -p maveric-stats --example false_positives [DATA_SETS]`; 20,000 of each normal kind by default, and a
//! tenth as many of the others, which mostly mean Friedman's test with its exact p.
//!
//! Each step of the procedure is also looked at alone: the analysis of variance without a correction, with Greenhouse and
//! Geisser's, and Friedman's chi-squared.
#![expect(
    clippy::print_stdout,
    reason = "an example shows its table on the terminal"
)]

use maveric_stats::{
    OmnibusTest, StatsError, WithinSubjects, compare, proportion, within_without_exact,
};
use rand::Rng;
use rand_pcg::Pcg64;
use rayon::prelude::*;

const N: usize = 24;
const K: usize = 4;
const ALPHA: f64 = 0.05;

/// A standard normal deviate, by Box and Muller.
fn normal(generator: &mut Pcg64) -> f64 {
    let mut uniform = || (f64::from(generator.next_u32()) + 0.5) / 4_294_967_296.0;
    let (a, b) = (uniform(), uniform());
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

/// How the errors of one kind of data are made.
struct Kind {
    name: &'static str,
    /// Standard deviations of the conditions.
    spread: [f64; K],
    /// From a normal deviate to an error.
    shape: fn(f64) -> f64,
    /// From a value to what is written down.
    written: fn(f64) -> f64,
}

const KINDS: [Kind; 7] = [
    Kind {
        name: "normal, spherical",
        spread: [1.0; K],
        shape: |z| z,
        written: |v| v,
    },
    Kind {
        name: "normal, epsilon .9",
        spread: [1.0, 1.0, 1.0, 1.6],
        shape: |z| z,
        written: |v| v,
    },
    Kind {
        name: "normal, epsilon .7",
        spread: [1.0, 1.0, 1.5, 2.5],
        shape: |z| z,
        written: |v| v,
    },
    Kind {
        name: "normal, epsilon .36",
        spread: [0.4, 0.4, 0.4, 4.0],
        shape: |z| z,
        written: |v| v,
    },
    Kind {
        name: "lognormal, spherical",
        spread: [1.0; K],
        shape: f64::exp,
        written: |v| v,
    },
    Kind {
        name: "answers from 1 to 7",
        spread: [1.0; K],
        shape: |z| z,
        written: |v| (4.0 + v).round().clamp(1.0, 7.0),
    },
    Kind {
        name: "heavy tails (z cubed)",
        spread: [1.0; K],
        shape: |z| z.powi(3),
        written: |v| v,
    },
];

fn data(generator: &mut Pcg64, kind: &Kind) -> Result<WithinSubjects, StatsError> {
    let names = |size: usize| -> Vec<String> { (0..size).map(|i| i.to_string()).collect() };
    let rows: Vec<Vec<f64>> = (0..N)
        .map(|_| {
            let own = normal(generator);
            let value = |s: f64, z: f64| (kind.written)(own + s * (kind.shape)(z));
            kind.spread.map(|s| value(s, normal(generator))).to_vec()
        })
        .collect();
    WithinSubjects::from_rows(&names(K), &names(N), &rows)
}

/// Findings: of `compare`, of each test alone, and how often the analysis of variance was chosen.
type Counts = [usize; 5];

fn look(generator: &mut Pcg64, kind: &Kind) -> Result<Counts, StatsError> {
    let data = data(generator, kind)?;
    let result = compare(&data, ALPHA)?;
    let all = within_without_exact(&data);
    let below = |p: Option<f64>| usize::from(p.is_some_and(|p| p < ALPHA));
    Ok([
        usize::from(result.omnibus.reject == Some(true)),
        below(all.rm_anova.p),
        below(all.sphericity.p_gg),
        below(all.friedman.p),
        usize::from(result.chosen == OmnibusTest::RmAnova),
    ])
}

fn main() -> Result<(), StatsError> {
    let sets = std::env::args().nth(1).and_then(|text| text.parse().ok());
    let sets: usize = sets.unwrap_or(20_000);
    println!("null data sets of {N} subjects x {K} conditions, findings at .05\n");
    println!(
        "{:<24}{:>8}{:>8}  95 % interval   {:>8}{:>8}{:>8}   ANOVA chosen",
        "errors", "sets", "compare", "F", "F (GG)", "chi2"
    );
    for (i, kind) in KINDS.iter().enumerate() {
        let sets = if kind.name.starts_with("normal") {
            sets
        } else {
            sets / 10
        };
        // A stream of its own for each data set, so that the number of threads changes nothing.
        let counts = (0..sets)
            .into_par_iter()
            .map(|set| {
                let stream = (i as u128) << 64 | set as u128;
                look(
                    &mut Pcg64::new(stream.wrapping_mul(0x9e37_79b9_7f4a_7c15), stream),
                    kind,
                )
            })
            .try_reduce(|| [0; 5], |a, b| Ok(std::array::from_fn(|j| a[j] + b[j])))?;
        let rate = proportion(counts[0], sets, 0.95)?;
        let share = |j: usize| counts[j] as f64 / sets as f64;
        println!(
            "{:<24}{sets:>8}{:>8.4}  [{:.4}, {:.4}]{:>8.4}{:>8.4}{:>8.4}{:>12.1} %",
            kind.name,
            rate.estimate,
            rate.low,
            rate.high,
            share(1),
            share(2),
            share(3),
            100.0 * share(4)
        );
    }
    Ok(())
}
