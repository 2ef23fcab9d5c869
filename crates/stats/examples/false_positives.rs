//! How often `compare` finds a difference where there is none, in data sets of 24 subjects and 4 conditions.
//!
//! `cargo run --release -p maveric-stats --example false_positives [DATA_SETS]`; 20,000 of each kind by default.
//!
//! The exact p of Friedman's test is that of `friedman`; without ties it depends on the statistic alone, so it is computed
//! once for each. Every hundredth data set goes through `compare` itself as well, which must find the same.
//!
//! Each step of the procedure is also looked at alone: the analysis of variance without a correction, with Greenhouse and
//! Geisser's, and Friedman's chi-squared.
#![expect(clippy::print_stdout, reason = "an example shows its table on the terminal")]

mod support;

use std::{
    collections::HashMap,
    sync::{Mutex, PoisonError},
};

use maveric_stats::{
    OmnibusTest, StatsError, WithinSubjects, compare, compare_without_exact, friedman, proportion,
    within_without_exact,
};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use support::{normal, tables_or};

const N: usize = 24;
const K: usize = 4;
const ALPHA: f64 = 0.05;

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
    Kind { name: "normal, spherical", spread: [1.0; K], shape: |z| z, written: |v| v },
    Kind { name: "normal, epsilon .9", spread: [1.0, 1.0, 1.0, 1.6], shape: |z| z, written: |v| v },
    Kind { name: "normal, epsilon .7", spread: [1.0, 1.0, 1.5, 2.5], shape: |z| z, written: |v| v },
    Kind {
        name: "normal, epsilon .36",
        spread: [0.4, 0.4, 0.4, 4.0],
        shape: |z| z,
        written: |v| v,
    },
    Kind { name: "lognormal, spherical", spread: [1.0; K], shape: f64::exp, written: |v| v },
    Kind {
        name: "answers from 1 to 7",
        spread: [1.0; K],
        shape: |z| z,
        written: |v| (4.0 + v).round().clamp(1.0, 7.0),
    },
    Kind { name: "heavy tails (z cubed)", spread: [1.0; K], shape: |z| z.powi(3), written: |v| v },
];

fn data(generator: &mut Pcg64, kind: &Kind) -> Result<WithinSubjects, StatsError> {
    let names = |size: usize| -> Vec<String> { (0..size).map(|i| i.to_string()).collect() };
    let rows: Vec<Vec<f64>> = (0..N)
        .map(|_| {
            let person_level = normal(generator);
            let value = |s: f64, z: f64| (kind.written)(person_level + s * (kind.shape)(z));
            kind.spread.map(|s| value(s, normal(generator))).to_vec()
        })
        .collect();
    WithinSubjects::from_rows(&names(K), &names(N), &rows)
}

/// Findings: of `compare`, of each test alone, and how often the analysis of variance was chosen.
type Counts = [usize; 5];

/// Exact p of Friedman's test by the bits of chi-squared, for data without ties.
type Known = Mutex<HashMap<u64, Option<f64>>>;

fn exact_p(data: &WithinSubjects, chi2: Option<f64>, known: &Known) -> Option<f64> {
    let untied = data.rows().all(|row| {
        let alike = |i: usize| row[..i].iter().any(|v| v.to_bits() == row[i].to_bits());
        !(1..row.len()).any(alike)
    });
    let Some(chi2) = chi2.filter(|_| untied) else {
        return friedman(data).friedman.p_exact;
    };
    let look_up = || known.lock().unwrap_or_else(PoisonError::into_inner);
    let cached = look_up().get(&chi2.to_bits()).copied();
    cached.unwrap_or_else(|| {
        let p = friedman(data).friedman.p_exact;
        look_up().insert(chi2.to_bits(), p);
        p
    })
}

fn look(
    generator: &mut Pcg64,
    kind: &Kind,
    known: &Known,
    check: bool,
) -> Result<Counts, StatsError> {
    let data = data(generator, kind)?;
    let result = compare_without_exact(&data, ALPHA)?;
    let finding = if result.chosen == OmnibusTest::Friedman {
        let exact = exact_p(&data, result.omnibus.statistic, known);
        exact.or(result.omnibus.p).map(|p| p < ALPHA)
    } else {
        result.omnibus.reject
    };
    if check {
        assert_eq!(compare(&data, ALPHA)?.omnibus.reject, finding, "the short cut differs");
    }
    let tests = within_without_exact(&data);
    let below = |p: Option<f64>| usize::from(p.is_some_and(|p| p < ALPHA));
    Ok([
        usize::from(finding == Some(true)),
        below(tests.rm_anova.p),
        below(tests.sphericity.p_gg),
        below(tests.friedman.p),
        usize::from(result.chosen == OmnibusTest::RmAnova),
    ])
}

fn main() -> Result<(), StatsError> {
    let sets = tables_or(20_000) as usize;
    println!("null data sets of {N} subjects x {K} conditions, findings at .05\n");
    println!(
        "{:<24}{:>8}{:>8}  95 % interval   {:>8}{:>8}{:>8}   ANOVA chosen",
        "errors", "sets", "compare", "F", "F (GG)", "chi2"
    );
    let known = Known::default();
    for (i, kind) in KINDS.iter().enumerate() {
        // A stream of its own for each data set, so that the number of threads changes nothing.
        let counts = (0..sets)
            .into_par_iter()
            .map(|set| {
                let stream = (i as u128) << 64 | set as u128;
                look(
                    &mut Pcg64::new(stream.wrapping_mul(0x9e37_79b9_7f4a_7c15), stream),
                    kind,
                    &known,
                    set % 100 == 0,
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
