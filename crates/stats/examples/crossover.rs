//! What the tests of a crossover find where conditions do not differ, and how carry-over is estimated where it is planted.
//!
//! `cargo run --release -p maveric-stats --example crossover [DATA_SETS]`; 5,000 tables a row by default.
#![expect(clippy::print_stdout, reason = "an example shows its table on the terminal")]

mod support;

use maveric_stats::{
    AskedTest, ByDesign, CarryOver, DesignChoice, DesignColumns, PERIOD, carry_over,
    compare_by_design,
};
use rand::Rng;
use rand_pcg::Pcg64;
use rayon::prelude::*;
use support::{normal, tables_or};

const ALPHA: f64 = 0.05;
const NAMES: [&str; 5] = ["a", "b", "c", "d", "e"];
/// What each condition leaves behind where carry-over is planted; the mean of those that there are is taken off.
const LEFT: [f64; 5] = [0.6, -0.2, 0.0, -0.4, 0.3];

/// How the values of a study come about.
#[derive(Clone, Copy)]
struct Study {
    name: &'static str,
    people: usize,
    conditions: usize,
    test: AskedTest,
    /// Trend over the rides, in standard deviations a ride.
    trend: f64,
    /// What the errors of the first condition are multiplied with.
    first: f64,
    /// Lognormal errors.
    skewed: bool,
    /// Answers from 1 to 5.
    item: bool,
    /// Share of people who are left out, so that orders are not balanced.
    left_out: f64,
    carried: bool,
}

const PLAIN: Study = Study {
    name: "normal, trend .5 a ride",
    people: 24,
    conditions: 4,
    test: AskedTest::Mixed,
    trend: 0.5,
    first: 1.0,
    skewed: false,
    item: false,
    left_out: 0.0,
    carried: false,
};

/// Rows of a Williams square.
fn orders(k: usize) -> Vec<Vec<usize>> {
    let zigzag = |i: usize| {
        if i % 2 == 1 { i.div_ceil(2) } else { (k - i / 2) % k }
    };
    let row = |add: usize| (0..k).map(|i| (zigzag(i) + add) % k).collect::<Vec<_>>();
    let mut rows: Vec<Vec<usize>> = (0..k).map(row).collect();
    if k % 2 == 1 {
        let turned: Vec<Vec<usize>> =
            rows.iter().map(|r| r.iter().rev().copied().collect()).collect();
        rows.extend(turned);
    }
    rows
}

/// p of the conditions, of the first contrast and of the period; off and covered of the first carry-over.
#[derive(Default)]
struct Outcome {
    conditions: Option<f64>,
    contrast: Option<f64>,
    period: Option<f64>,
    carried: Option<f64>,
    off: Option<f64>,
    covered: Option<bool>,
}

impl Study {
    fn run(&self, seed: u64) -> Outcome {
        let mut generator = Pcg64::new(u128::from(seed), 7);
        let rows = orders(self.conditions);
        let mean = LEFT[..self.conditions].iter().sum::<f64>() / self.conditions as f64;
        let (mut people, mut conditions, mut periods, mut values) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for person in 0..self.people {
            let order = &rows[person % rows.len()];
            let intercept = normal(&mut generator);
            let stays = f64::from(generator.next_u32()) / 4_294_967_296.0 >= self.left_out;
            for (period, &condition) in order.iter().enumerate() {
                let mut error = normal(&mut generator);
                if self.skewed {
                    // Of mean 0 and variance 1.
                    let e = std::f64::consts::E;
                    error = (error.exp() - e.sqrt()) / (e * (e - 1.0)).sqrt();
                }
                if condition == 0 {
                    error *= self.first;
                }
                let mut value = intercept + self.trend * period as f64 + error;
                if let Some(before) = period.checked_sub(1).filter(|_| self.carried) {
                    value += LEFT[order[before]] - mean;
                }
                if self.item {
                    value = (3.0 + value - 0.5 * self.trend).round().clamp(1.0, 5.0);
                }
                if stays {
                    people.push(person.to_string());
                    conditions.push(NAMES[condition].to_owned());
                    periods.push(period + 1);
                    values.push(Some(value));
                }
            }
        }
        let data = DesignColumns {
            subjects: &people,
            within: vec![("condition", &conditions)],
            periods: &periods,
            values: &values,
            ..DesignColumns::default()
        };
        let choice = DesignChoice { test: self.test, exact: false, ..DesignChoice::default() };
        let mut outcome = Outcome::default();
        let pair = |pairs: &maveric_stats::Named<maveric_stats::MarginalContrast>| {
            let known = pairs.get("a|b").or_else(|| pairs.get("b|a"));
            known.and_then(|pair| pair.p)
        };
        if let Ok(tested) = compare_by_design(&data, &choice) {
            for (name, p) in tested.effects() {
                let place =
                    if name == PERIOD { &mut outcome.period } else { &mut outcome.conditions };
                *place = p;
            }
            outcome.contrast = match &tested {
                ByDesign::Mixed(model) => model.found.pairs("condition").and_then(pair),
                ByDesign::Ordinal(model) => pair(&model.found.contrast),
                _ => None,
            };
        }
        if let (false, Ok(CarryOver::Fitted(fitted))) = (self.item, carry_over(&data)) {
            outcome.carried = fitted.test.p;
            let planted = if self.carried { LEFT[0] - mean } else { 0.0 };
            if let Some(effect) = fitted.effects.get("a") {
                outcome.off = Some(effect.estimate - planted);
                let ends = effect.ci.ends();
                outcome.covered = ends.map(|(low, high)| low <= planted && planted <= high);
            }
        }
        outcome
    }
}

/// Share of the p that are there and below α.
fn below(p: impl Iterator<Item = Option<f64>>) -> String {
    let there: Vec<f64> = p.flatten().collect();
    let low = there.iter().filter(|p| **p < ALPHA).count();
    if there.is_empty() {
        return "–".to_owned();
    }
    format!("{:.4} of {}", low as f64 / there.len() as f64, there.len())
}

fn main() {
    let tables = tables_or(5_000);
    let variant = |name, change: fn(&mut Study)| {
        let mut study = Study { name, ..PLAIN };
        change(&mut study);
        study
    };
    let studies = [
        PLAIN,
        variant("twelve people", |s| s.people = 12),
        variant("three conditions, twelve people", |s| {
            (s.conditions, s.people) = (3, 12);
        }),
        variant("two conditions, twelve people", |s| {
            (s.conditions, s.people) = (2, 12);
        }),
        variant("five conditions, twenty people", |s| {
            (s.conditions, s.people) = (5, 20);
        }),
        variant("a fifth of the people left out", |s| s.left_out = 0.2),
        variant("lognormal errors", |s| s.skewed = true),
        variant("the first condition varies 1.5 times as much", |s| {
            s.first = 1.5;
        }),
        variant("carry-over planted", |s| s.carried = true),
        variant("three conditions, carry-over planted", |s| {
            (s.conditions, s.people, s.carried) = (3, 24, true);
        }),
        variant("an item, ordinal", |s| {
            (s.item, s.test) = (true, AskedTest::Ordinal);
        }),
        variant("an item, ordinal, twelve people", |s| {
            (s.item, s.test, s.people) = (true, AskedTest::Ordinal, 12);
        }),
    ];
    println!(
        "| study | conditions | one contrast | period | carry-over | its bias ± error | covered |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for study in &studies {
        let outcomes: Vec<Outcome> =
            (0..tables).into_par_iter().map(|seed| study.run(seed)).collect();
        let off: Vec<f64> = outcomes.iter().filter_map(|f| f.off).collect();
        let n = off.len() as f64;
        let mean = off.iter().sum::<f64>() / n;
        let error = (off.iter().map(|o| (o - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt();
        let covered = outcomes.iter().filter(|f| f.covered == Some(true)).count() as f64;
        let carried = if off.is_empty() {
            "– | –".to_owned()
        } else {
            format!("{mean:.4} ± {error:.4} | {:.4}", covered / n)
        };
        println!(
            "| {} | {} | {} | {} | {} | {carried} |",
            study.name,
            below(outcomes.iter().map(|f| f.conditions)),
            below(outcomes.iter().map(|f| f.contrast)),
            below(outcomes.iter().map(|f| f.period)),
            below(outcomes.iter().map(|f| f.carried)),
        );
    }
}
