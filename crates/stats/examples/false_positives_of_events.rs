//! How often presses seem to have a cause where there is none: rates by condition, and what came before a press.
//!
//! `cargo run --release -p maveric-stats --example false_positives_of_events [TABLES]`; 5,000 of each kind by default.
//!
//! Rates: people in four conditions of ten minutes who press at a rate of their own, evenly or in bursts. Before a press: an exposure that goes
//! up and down slowly, in minutes of 60 seconds, and presses at any of them; then presses that follow it, by a log odds ratio of .5.
#![expect(clippy::print_stdout, reason = "an example shows its table on the terminal")]

mod support;

use maveric_stats::{CaseStratum, Exposed, StatsError, case_crossover, event_rates, proportion};
use rand::Rng as _;
use rand_pcg::Pcg64;
use rayon::prelude::*;
use support::{normal, tables_or, uniform};

const ALPHA: f64 = 0.05;

fn poisson(generator: &mut Pcg64, mean: f64) -> usize {
    let (mut product, mut count) = (uniform(generator), 0);
    while product > (-mean).exp() {
        product *= uniform(generator);
        count += 1;
    }
    count
}

/// Whether rates seem to differ: every press is one of `burst`, on average.
fn rates_differ(
    seed: u64,
    people: usize,
    mean: f64,
    burst: usize,
) -> Result<Option<f64>, StatsError> {
    let mut generator = Pcg64::new(u128::from(seed), 1);
    let conditions: Vec<String> = ["a", "b", "c", "d"].map(str::to_owned).to_vec();
    let rows: Vec<Vec<Exposed>> = (0..people)
        .map(|_| {
            let rate = mean * normal(&mut generator).exp();
            let cell = |_: &String| {
                let bursts = poisson(&mut generator, rate / burst as f64);
                let events =
                    (0..bursts).map(|_| 1 + generator.next_u64() as usize % (2 * burst - 1));
                Exposed { events: events.sum(), time: 10.0 }
            };
            conditions.iter().map(cell).collect()
        })
        .collect();
    Ok(event_rates(&conditions, &rows, 999, seed)?.p)
}

/// The p of an exposure, and its log odds ratio for one unit, where a press is `slope` likelier a unit.
fn cause(
    seed: u64,
    people: usize,
    presses: usize,
    slope: f64,
    common: bool,
) -> (Option<f64>, Option<f64>) {
    let mut generator = Pcg64::new(u128::from(seed), 2);
    let mut strata = Vec::new();
    for person in 0..people {
        // People differ in what they are exposed to, and in what it does to them.
        let scale = (0.5 * normal(&mut generator)).exp();
        let person_slope = if common { slope } else { slope + 0.5 * normal(&mut generator) };
        for _ in 0..=poisson(&mut generator, presses as f64 - 1.0) {
            let mut level = normal(&mut generator);
            let course: Vec<f64> = (0..60)
                .map(|_| {
                    level = 0.9 * level + 0.19_f64.sqrt() * normal(&mut generator);
                    scale * level
                })
                .collect();
            let weights: Vec<f64> = course.iter().map(|x| (person_slope * x).exp()).collect();
            let mut left = uniform(&mut generator) * weights.iter().sum::<f64>();
            let mut event = 0;
            while event < 59 && left > weights[event] {
                left -= weights[event];
                event += 1;
            }
            let others = course.iter().enumerate().filter(|(i, _)| *i != event);
            strata.push(CaseStratum {
                person: person.to_string(),
                events: vec![course[event]],
                others: others.map(|(_, x)| *x).collect(),
            });
        }
    }
    let result = case_crossover(&strata);
    let of_one = result.estimate.zip(result.sd).map(|(estimate, sd)| estimate / sd);
    (result.p, of_one)
}

fn print_share(name: &str, p: &[Option<f64>]) -> Result<(), StatsError> {
    let there: Vec<f64> = p.iter().flatten().copied().collect();
    let below = there.iter().filter(|p| **p < ALPHA).count();
    let share = proportion(below, there.len(), 0.95)?;
    let (low, high) = share.ends();
    println!("{name:<62} {:.3}  [{low:.3}, {high:.3}]  of {}", share.estimate, there.len());
    Ok(())
}

fn main() -> Result<(), StatsError> {
    let tables = tables_or(5_000);
    println!("share of tables with p < .05, its 95 % interval");
    for (people, mean, burst) in [(12, 1.0, 1), (24, 3.0, 1), (24, 3.0, 4), (40, 0.5, 1)] {
        let p: Result<Vec<Option<f64>>, StatsError> = (0..tables)
            .into_par_iter()
            .map(|seed| rates_differ(seed, people, mean, burst))
            .collect();
        print_share(
            &format!("rates, {people} people, {mean} presses a ride, {burst} at once"),
            &p?,
        )?;
    }
    for (people, presses) in [(10, 3), (12, 8), (24, 3), (40, 5)] {
        for (slope, common) in [(0.0, true), (0.0, false), (0.5, true)] {
            let results: Vec<_> = (0..tables)
                .into_par_iter()
                .map(|seed| cause(seed, people, presses, slope, common))
                .collect();
            let p: Vec<Option<f64>> = results.iter().map(|(p, _)| *p).collect();
            let estimates: Vec<f64> = results.iter().filter_map(|(_, e)| *e).collect();
            let mean = estimates.iter().sum::<f64>() / estimates.len() as f64;
            let alike = if common { "the same in all" } else { "not the same in all" };
            print_share(
                &format!(
                    "before a press, {people} people, {presses} presses, slope {slope} ({alike}), found {mean:.3}"
                ),
                &p,
            )?;
        }
    }
    Ok(())
}
