//! How often `compare_by_design` finds an effect where there is none: groups, factors between and within, items, covariates.
//!
//! `cargo run -p maveric-stats --example false_positives_by_design [DATA_SETS] [PART OF A NAME]`; 10,000 of each kind by default, a quarter
//! of that where a model of ordered answers is fitted.
#![expect(
    clippy::print_stdout,
    reason = "an example shows its table on the terminal"
)]

use std::collections::BTreeMap;

use maveric_stats::{
    ByDesign, DesignChoice, DesignColumns, OutcomeScale, StatsError, compare_by_design, proportion,
};
use rand::Rng;
use rand_pcg::Pcg64;
use rayon::prelude::*;

const ALPHA: f64 = 0.05;

/// A standard normal deviate, by Box and Muller.
fn normal(generator: &mut Pcg64) -> f64 {
    let mut uniform = || (f64::from(generator.next_u32()) + 0.5) / 4_294_967_296.0;
    let (a, b) = (uniform(), uniform());
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

/// A design and the errors of its data, without any effect.
#[derive(Clone, Copy)]
struct Kind {
    name: &'static str,
    /// People in each group.
    groups: &'static [usize],
    /// Levels of each factor within.
    within: &'static [usize],
    covariate: bool,
    scale: OutcomeScale,
    /// Standard deviations of the cells within, and what the second group's are multiplied with.
    spread: [f64; 4],
    second_group: f64,
    /// From a normal deviate to an error, and from a value to what is written down.
    shape: fn(f64) -> f64,
    written: fn(f64) -> f64,
}

const PLAIN: Kind = Kind {
    name: "",
    groups: &[24],
    within: &[],
    covariate: false,
    scale: OutcomeScale::Measure,
    spread: [1.0; 4],
    second_group: 1.0,
    shape: |z| z,
    written: |v| v,
};
const EVEN: Kind = Kind {
    groups: &[12, 12],
    within: &[3],
    ..PLAIN
};
const UNEVEN: Kind = Kind {
    groups: &[8, 16],
    ..EVEN
};
const SQUARE: Kind = Kind {
    within: &[2, 2],
    ..PLAIN
};
const TWO: Kind = Kind {
    groups: &[12, 12],
    ..PLAIN
};
const THREE: Kind = Kind {
    groups: &[8, 12, 16],
    ..PLAIN
};
const ITEM: Kind = Kind {
    within: &[4],
    scale: OutcomeScale::Rating,
    written: five_points,
    ..PLAIN
};
const COVARIATE: Kind = Kind {
    within: &[4],
    covariate: true,
    ..PLAIN
};

fn five_points(v: f64) -> f64 {
    (3.0 + v).round().clamp(1.0, 5.0)
}

/// Most people answer 1 or 2.
fn low_points(v: f64) -> f64 {
    (1.3 + v).round().clamp(1.0, 5.0)
}

const KINDS: [Kind; 22] = [
    Kind {
        name: "2 x 12 people, 3 conditions; normal",
        ..EVEN
    },
    Kind {
        name: "2 x 12 people, 3 conditions; epsilon about .7",
        spread: [1.0, 1.5, 3.0, 1.0],
        ..EVEN
    },
    Kind {
        name: "2 x 12 people, 3 conditions; lognormal",
        shape: f64::exp,
        ..EVEN
    },
    Kind {
        name: "2 x 12 people, 3 conditions; answers 1 to 5",
        written: five_points,
        ..EVEN
    },
    Kind {
        name: "8 and 16 people, 3 conditions; normal",
        ..UNEVEN
    },
    Kind {
        name: "8 and 16 people, 3 conditions; the 16 twice as spread",
        second_group: 2.0,
        ..UNEVEN
    },
    Kind {
        name: "16 and 8 people, 3 conditions; the 8 twice as spread",
        groups: &[16, 8],
        second_group: 2.0,
        ..EVEN
    },
    Kind {
        name: "8 and 16 people, 3 conditions; lognormal",
        shape: f64::exp,
        ..UNEVEN
    },
    Kind {
        name: "2 x 2 conditions, 24 people; normal",
        ..SQUARE
    },
    Kind {
        name: "2 x 2 conditions, 24 people; one cell three times as spread",
        spread: [1.0, 1.0, 1.0, 3.0],
        ..SQUARE
    },
    Kind {
        name: "2 x 2 conditions, 24 people; lognormal",
        shape: f64::exp,
        ..SQUARE
    },
    Kind {
        name: "2 x 2 conditions, 24 people; answers 1 to 5",
        written: five_points,
        ..SQUARE
    },
    Kind {
        name: "2 conditions, 24 people; normal",
        within: &[2],
        ..PLAIN
    },
    Kind {
        name: "2 conditions, 24 people; lognormal",
        within: &[2],
        shape: f64::exp,
        ..PLAIN
    },
    Kind {
        name: "groups of 12 and 12; normal",
        ..TWO
    },
    Kind {
        name: "groups of 12 and 12; lognormal",
        shape: f64::exp,
        ..TWO
    },
    Kind {
        name: "groups of 8, 12, 16; normal",
        ..THREE
    },
    Kind {
        name: "groups of 8, 12, 16; lognormal",
        shape: f64::exp,
        ..THREE
    },
    Kind {
        name: "an item 1 to 5, 24 people, 4 conditions",
        ..ITEM
    },
    Kind {
        name: "an item 1 to 5, mostly 1 and 2",
        written: low_points,
        ..ITEM
    },
    Kind {
        name: "a covariate, 24 people, 4 conditions; spherical",
        ..COVARIATE
    },
    Kind {
        name: "a covariate, 24 people, 4 conditions; epsilon about .7",
        spread: [1.0, 1.0, 1.5, 2.5],
        ..COVARIATE
    },
];

impl Kind {
    fn cells(&self) -> usize {
        self.within.iter().product()
    }

    /// One data set, tested.
    fn look(&self, generator: &mut Pcg64) -> Result<ByDesign, StatsError> {
        let (mut people, mut group, mut age, mut values) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut factors: Vec<Vec<String>> = vec![Vec::new(); self.within.len()];
        for (g, &size) in self.groups.iter().enumerate() {
            let wider = if g == 1 { self.second_group } else { 1.0 };
            for _ in 0..size {
                let (own, years) = (normal(generator), normal(generator));
                let who = format!("{g}.{}", people.len());
                for cell in 0..self.cells() {
                    let error = wider * self.spread[cell] * (self.shape)(normal(generator));
                    // People differ by as much as one error, and by their age where that is a covariate.
                    let level = own + if self.covariate { years } else { 0.0 };
                    values.push(Some((self.written)(level + error)));
                    people.push(who.clone());
                    group.push(Some(g.to_string()));
                    age.push(Some(years));
                    let mut rest = cell;
                    for (levels, column) in self.within.iter().zip(&mut factors).rev() {
                        column.push((rest % levels).to_string());
                        rest /= levels;
                    }
                }
            }
        }
        let names = ["a", "b"];
        let data = DesignColumns {
            subjects: &people,
            within: names
                .into_iter()
                .zip(factors.iter().map(Vec::as_slice))
                .collect(),
            between: if self.groups.len() > 1 {
                vec![("group", &group)]
            } else {
                Vec::new()
            },
            covariates: if self.covariate {
                vec![("age", &age)]
            } else {
                Vec::new()
            },
            values: &values,
        };
        let choice = DesignChoice {
            scale: self.scale,
            alpha: ALPHA,
            exact: false,
            ..DesignChoice::default()
        };
        compare_by_design(&data, &choice)
    }
}

/// Findings of each effect, and how often each test was chosen.
type Counts = (BTreeMap<String, usize>, BTreeMap<String, usize>);

fn chosen(found: &ByDesign) -> String {
    match found {
        ByDesign::OneFactor(found) => format!("{:?}", found.chosen),
        ByDesign::Factorial(found) => format!("{:?}", found.chosen),
        ByDesign::Groups(found) => format!("{:?}", found.chosen),
        ByDesign::Mixed(found) => format!("{:?}", found.chosen),
        ByDesign::Ordinal(found) => format!("{:?}", found.chosen),
        _ => "another".to_owned(),
    }
}

fn add(mut all: Counts, more: Counts) -> Counts {
    for (name, count) in more.0 {
        *all.0.entry(name).or_default() += count;
    }
    for (name, count) in more.1 {
        *all.1.entry(name).or_default() += count;
    }
    all
}

fn main() -> Result<(), StatsError> {
    let mut arguments = std::env::args().skip(1);
    let sets = arguments
        .next()
        .and_then(|text| text.parse().ok())
        .unwrap_or(10_000);
    let wanted = arguments.next().unwrap_or_default();
    println!(
        "null data sets, findings at .05\n\n| design and errors | effect | rate | 95 % interval | chosen |\n| --- | --- | --- | --- | --- |"
    );
    for (i, kind) in KINDS
        .iter()
        .enumerate()
        .filter(|(_, k)| k.name.contains(&wanted))
    {
        let sets: usize = if kind.scale == OutcomeScale::Rating {
            sets / 4
        } else {
            sets
        };
        let (effects, tests) = (0..sets)
            .into_par_iter()
            .map(|set| {
                // A stream of its own for each data set, so that the number of threads changes nothing.
                let stream = (i as u128 + 100) << 64 | set as u128;
                let seed = stream.wrapping_mul(0x9e37_79b9_7f4a_7c15);
                let found = kind.look(&mut Pcg64::new(seed, stream))?;
                let effects = found.effects().into_iter();
                let below = |p: Option<f64>| usize::from(p.is_some_and(|p| p < ALPHA));
                let counts = effects
                    .map(|(name, p)| (name.to_owned(), below(p)))
                    .collect();
                Ok((counts, BTreeMap::from([(chosen(&found), 1)])))
            })
            .try_reduce(Counts::default, |a, b| Ok(add(a, b)))?;
        let tests: Vec<String> = tests
            .iter()
            .map(|(name, count)| format!("{name} {:.1} %", 100.0 * *count as f64 / sets as f64))
            .collect();
        for (effect, count) in &effects {
            let rate = proportion(*count, sets, 0.95)?;
            println!(
                "| {} | {effect} | {:.4} | {:.4} to {:.4} | {} |",
                kind.name,
                rate.estimate,
                rate.low,
                rate.high,
                tests.join(", ")
            );
        }
    }
    Ok(())
}
