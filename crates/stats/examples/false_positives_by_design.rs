//! How often `compare_by_design` finds an effect where there is none, over designs, errors and what differs between people.
//!
//! `cargo run --release -p maveric-stats --example false_positives_by_design [DATA_SETS] [PART OF A NAME]`; 10,000 data sets a row by
//! default, a fifth of that where a mixed model or one of ordered answers is fitted.
#![expect(clippy::print_stdout, reason = "an example shows its table on the terminal")]

mod support;

use std::collections::BTreeMap;

use maveric_stats::{
    AskedTest, ByDesign, DesignChoice, DesignColumns, MissingCells, OutcomeScale, StatsError,
    compare_by_design, proportion,
};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use support::{normal, tables_or};

const ALPHA: f64 = 0.05;

/// A rate whose 99.9 % interval lies wholly above this is too high.
const TOO_MANY: f64 = 0.06;

/// A rate below this is called conservative.
const FEW: f64 = 0.035;

/// What goes along with the outcome.
#[derive(Clone, Copy, PartialEq)]
enum Covariate {
    None,
    /// One value a person.
    OfPeople,
    /// The same, its product with the first factor declared.
    Declared,
    /// A value a row.
    OfRows,
}

/// How errors become values.
#[derive(Clone, Copy)]
enum Values {
    Normal,
    /// Errors are lognormal.
    Skewed,
    /// Values are lognormal, a person's level with them.
    SkewedWhole,
    /// Answers from 1 to 5.
    Answers,
    /// The same, mostly 1 and 2.
    LowAnswers,
}

/// A design and the errors of its data.
#[derive(Clone)]
struct Cell {
    design: &'static str,
    data: &'static str,
    /// People in each group.
    groups: &'static [usize],
    /// Levels of each factor within.
    within: &'static [usize],
    covariate: Covariate,
    values: Values,
    item: bool,
    /// Standard deviation over people of the effect of the first factor within.
    slope: f64,
    /// What the errors of the first group are multiplied with.
    first_group: f64,
    /// Size of the second factor within, or of the groups where there is no second: all but the first factor's effects are there.
    other: f64,
    /// Size of the first factor within.
    first: f64,
    /// Share of cells that are missing, by chance.
    missing: f64,
}

const PLAIN: Cell = Cell {
    design: "",
    data: "normal",
    groups: &[24],
    within: &[2, 2],
    covariate: Covariate::None,
    values: Values::Normal,
    item: false,
    slope: 0.0,
    first_group: 1.0,
    other: 0.0,
    first: 0.0,
    missing: 0.0,
};

/// One thing changed at a time, then the corners.
fn variations(base: &Cell) -> Vec<Cell> {
    let variant = |data: &'static str, change: &dyn Fn(&mut Cell)| {
        let mut cell = base.clone();
        cell.data = data;
        change(&mut cell);
        cell
    };
    vec![
        variant("normal", &|_| ()),
        variant("lognormal errors", &|c| c.values = Values::Skewed),
        variant("lognormal values", &|c| c.values = Values::SkewedWhole),
        variant("answers 1 to 5", &|c| c.values = Values::Answers),
        variant("an item, 1 to 5", &|c| {
            (c.values, c.item) = (Values::Answers, true);
        }),
        variant("slopes .7", &|c| c.slope = 0.7),
        variant("slopes 1", &|c| c.slope = 1.0),
        variant("slopes 1.5", &|c| c.slope = 1.5),
        variant("slopes 1.5, lognormal errors", &|c| {
            (c.slope, c.values) = (1.5, Values::Skewed);
        }),
        variant("slopes 1.5, lognormal values", &|c| {
            (c.slope, c.values) = (1.5, Values::SkewedWhole);
        }),
        variant("slopes 1.5, answers 1 to 5", &|c| {
            (c.slope, c.values) = (1.5, Values::Answers);
        }),
        variant("a covariate of people", &|c| {
            c.covariate = Covariate::OfPeople;
        }),
        variant("a covariate of people, slopes 1.5", &|c| {
            (c.covariate, c.slope) = (Covariate::OfPeople, 1.5);
        }),
        variant("a covariate of people, slopes 1.5, lognormal errors", &|c| {
            (c.covariate, c.slope, c.values) = (Covariate::OfPeople, 1.5, Values::Skewed);
        }),
        variant("a declared product, slopes 1.5", &|c| {
            (c.covariate, c.slope) = (Covariate::Declared, 1.5);
        }),
        variant("other effects present", &|c| c.other = 1.5),
        variant("other effects present, lognormal errors", &|c| {
            (c.other, c.values) = (1.5, Values::Skewed);
        }),
        variant("both main effects present, slopes 1.5", &|c| {
            (c.first, c.other, c.slope) = (1.5, 1.5, 1.5);
        }),
        variant("both main effects present, slopes 1.5, lognormal errors", &|c| {
            (c.first, c.other, c.slope, c.values) = (1.5, 1.5, 1.5, Values::Skewed);
        }),
    ]
}

fn cells() -> Vec<Cell> {
    let mut cells = Vec::new();
    let within = |design, groups, within| Cell { design, groups, within, ..PLAIN };
    for base in [
        within("2 x 2, 24 people", &[24], &[2, 2]),
        within("2 x 2, 12 people", &[12], &[2, 2]),
        within("2 x 3, 24 people", &[24], &[2, 3]),
        within("3 x 3, 12 people", &[12], &[3, 3]),
        within("3 conditions, 24 people", &[24], &[3]),
    ] {
        cells.extend(variations(&base));
    }
    for base in [
        within("2 conditions, groups of 12 and 12", &[12, 12], &[2]),
        within("3 conditions, groups of 12 and 12", &[12, 12], &[3]),
        within("3 conditions, groups of 8 and 16", &[8, 16], &[3]),
        within("2 x 2, groups of 8 and 16", &[8, 16], &[2, 2]),
    ] {
        let few = variations(&base).into_iter();
        let few = few.filter(|c| c.covariate != Covariate::Declared);
        let few = few.filter(|c| !(c.slope > 0.0 && matches!(c.values, Values::SkewedWhole)));
        cells.extend(few.filter(|c| !(0.5..1.4).contains(&c.slope)));
        if base.groups[0] == 8 {
            for (data, values) in [
                ("the 8 twice as spread", Values::Normal),
                ("the 8 twice as spread, lognormal errors", Values::Skewed),
            ] {
                cells.push(Cell { data, values, first_group: 2.0, ..base.clone() });
            }
        }
    }
    for base in [
        within("groups of 12 and 12", &[12, 12], &[]),
        within("groups of 8, 12, 16", &[8, 12, 16], &[]),
    ] {
        for (data, values) in [("normal", Values::Normal), ("lognormal errors", Values::Skewed)] {
            cells.push(Cell { data, values, ..base.clone() });
        }
    }
    for (design, groups, values) in [
        ("an item, 4 conditions, 24 people", &[24], Values::Answers),
        ("an item, mostly 1 and 2, 4 conditions, 24 people", &[24], Values::LowAnswers),
        ("an item, 4 conditions, 12 people", &[12], Values::Answers),
        ("an item, mostly 1 and 2, 4 conditions, 12 people", &[12], Values::LowAnswers),
    ] {
        cells.push(Cell {
            design,
            data: "answers 1 to 5",
            groups,
            values,
            item: true,
            within: &[4],
            ..PLAIN
        });
    }
    for base in [
        within("missing cells kept, 2 x 2, 24 people", &[24], &[2, 2]),
        within("missing cells kept, 3 x 3, 12 people", &[12], &[3, 3]),
        within("missing cells kept, 3 conditions, 12 and 12", &[12, 12], &[3]),
        within("a covariate of rows, 2 x 2, 24 people", &[24], &[2, 2]),
    ] {
        let of_rows = base.design.starts_with("a covariate");
        for (data, slope, values) in [
            ("normal", 0.0, Values::Normal),
            ("slopes .7", 0.7, Values::Normal),
            ("slopes 1.5", 1.5, Values::Normal),
            ("lognormal errors", 0.0, Values::Skewed),
        ] {
            cells.push(Cell {
                data,
                slope,
                values,
                missing: if of_rows { 0.0 } else { 0.05 },
                covariate: if of_rows { Covariate::OfRows } else { Covariate::None },
                ..base.clone()
            });
        }
    }
    cells
}

impl Cell {
    fn count(&self) -> usize {
        self.within.iter().product()
    }

    /// Whether an effect is nil in these data.
    fn is_nil(&self, effect: &str) -> bool {
        let there = if self.within.len() > 1 { "b" } else { "group" };
        // Of skewed values that spread more, means and medians are not the same.
        let skewed = self.first_group > 1.0 && !matches!(self.values, Values::Normal);
        let real = (self.other > 0.0 && effect == there)
            || (self.first > 0.0 && effect == "a")
            || effect == "age"
            || (skewed && effect == "group");
        !real
    }

    fn value(&self, level: f64, error: f64) -> f64 {
        let answer = |middle: f64| (middle + level + error).round().clamp(1.0, 5.0);
        match self.values {
            Values::Normal => level + error,
            Values::Skewed => level + error.exp(),
            Values::SkewedWhole => (level + error).exp(),
            Values::Answers => answer(3.0),
            Values::LowAnswers => answer(1.3),
        }
    }

    /// One data set, tested.
    fn look(&self, generator: &mut Pcg64) -> Result<ByDesign, StatsError> {
        let (mut people, mut group, mut age, mut values) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut factors: Vec<Vec<String>> = vec![Vec::new(); self.within.len()];
        for (g, &size) in self.groups.iter().enumerate() {
            let wider = if g == 0 { self.first_group } else { 1.0 };
            for _ in 0..size {
                let (own, years) = (normal(generator), normal(generator));
                let who = format!("{g}.{}", people.len());
                let levels = self.within.first().copied().unwrap_or(1);
                let slopes: Vec<f64> = (0..levels)
                    .map(|_| self.slope * normal(generator) / std::f64::consts::SQRT_2)
                    .collect();
                let below: usize = self.within.iter().skip(1).product();
                for cell in 0..self.count() {
                    let years = match self.covariate {
                        Covariate::OfRows => years + normal(generator),
                        _ => years,
                    };
                    let first = cell / below % levels;
                    let mut level = own + wider * slopes[first] + self.first * first as f64;
                    if self.covariate != Covariate::None {
                        level += years;
                    }
                    level += self.other
                        * match self.within {
                            [_, k] => (cell % k) as f64,
                            _ => g as f64,
                        };
                    let error = wider * normal(generator);
                    let gone = normal(generator) < self.threshold();
                    values.push(Some(self.value(level, error)).filter(|_| !gone));
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
        let data = DesignColumns {
            subjects: &people,
            within: ["a", "b"].into_iter().zip(factors.iter().map(Vec::as_slice)).collect(),
            between: if self.groups.len() > 1 { vec![("group", &group)] } else { Vec::new() },
            covariates: if self.covariate == Covariate::None {
                Vec::new()
            } else {
                vec![("age", &age)]
            },
            with: if self.covariate == Covariate::Declared {
                vec![("age", vec!["a"])]
            } else {
                Vec::new()
            },
            periods: &[],
            labels: Vec::new(),
            values: &values,
        };
        let choice = DesignChoice {
            test: AskedTest::Chosen,
            scale: if self.item { OutcomeScale::Rating } else { OutcomeScale::Measure },
            missing: if self.missing > 0.0 { MissingCells::Mixed } else { MissingCells::Listwise },
            alpha: ALPHA,
            exact: false,
        };
        compare_by_design(&data, &choice)
    }

    /// The normal deviate below which the share of missing cells lies.
    fn threshold(&self) -> f64 {
        if self.missing > 0.0 { -1.645 } else { f64::MIN }
    }

    /// A fifth of the data sets where a model is fitted by search.
    fn sets(&self, sets: usize) -> usize {
        let slow = self.missing > 0.0
            || self.covariate == Covariate::OfRows
            || (self.item && self.within.len() == 1);
        if slow { sets / 5 } else { sets }
    }
}

/// What was seen of each effect that is nil, and how often ranks decided.
type Counts = (BTreeMap<String, Seen>, usize);

/// How often an effect was tested, and found.
#[derive(Clone, Copy, Default)]
struct Seen {
    tested: usize,
    below: usize,
}

fn by_ranks(found: &ByDesign) -> bool {
    use maveric_stats::{ChosenTest, OmnibusTest};
    let ranks = [ChosenTest::Ranks, ChosenTest::MannWhitney, ChosenTest::KruskalWallis];
    match found {
        ByDesign::OneFactor(found) => {
            [OmnibusTest::Friedman, OmnibusTest::Wilcoxon].contains(&found.chosen)
        }
        ByDesign::Factorial(found) => ranks.contains(&found.chosen),
        ByDesign::Groups(found) => ranks.contains(&found.chosen),
        _ => false,
    }
}

fn add(mut all: Counts, more: Counts) -> Counts {
    for (name, more) in more.0 {
        let seen = all.0.entry(name).or_default();
        seen.tested += more.tested;
        seen.below += more.below;
    }
    (all.0, all.1 + more.1)
}

fn main() -> Result<(), StatsError> {
    let sets = tables_or(10_000) as usize;
    let wanted = std::env::args().nth(2).unwrap_or_default();
    println!("| design | data | found at .05 | ranks | verdict |\n| --- | --- | --- | --- | --- |");
    for (i, cell) in cells().iter().enumerate() {
        // One factor of one group has no other effect.
        let empty = cell.other > 0.0 && cell.within.len() < 2 && cell.groups.len() < 2;
        if empty || !format!("{}; {}", cell.design, cell.data).contains(&wanted) {
            continue;
        }
        let sets = cell.sets(sets);
        let (effects, ranked) = (0..sets)
            .into_par_iter()
            .map(|set| {
                // A stream of its own for each data set, so that the number of threads changes nothing.
                let stream = (i as u128 + 100) << 64 | set as u128;
                let seed = stream.wrapping_mul(0x9e37_79b9_7f4a_7c15);
                let result = cell.look(&mut Pcg64::new(seed, stream))?;
                let seen = |p: Option<f64>| Seen {
                    tested: usize::from(p.is_some()),
                    below: usize::from(p.is_some_and(|p| p < ALPHA)),
                };
                let effects = result.effects().into_iter();
                let nil = effects.filter(|(name, _)| cell.is_nil(name));
                let counts = nil.map(|(name, p)| (name.to_owned(), seen(p))).collect();
                Ok((counts, usize::from(by_ranks(&result))))
            })
            .try_reduce(Counts::default, |a, b| Ok(add(a, b)))?;
        let (mut rates, mut high, mut low) = (Vec::new(), Vec::new(), Vec::new());
        for (effect, seen) in &effects {
            // A rate of the tests that gave a p value; how many did not stands beside it.
            let rate = proportion(seen.below, seen.tested, 0.999)?;
            let short = format!("{:.3}", rate.estimate);
            let none = sets - seen.tested;
            rates.push(match none {
                0 => format!("{effect} {}", short.trim_start_matches('0')),
                none => format!("{effect} {} (no p in {none})", short.trim_start_matches('0')),
            });
            if rate.low > TOO_MANY {
                high.push(effect.as_str());
            }
            if rate.estimate < FEW {
                low.push(effect.as_str());
            }
        }
        let verdict = match (&high[..], &low[..]) {
            ([], []) => "passes".to_owned(),
            ([], few) => format!("conservative: {}", few.join(", ")),
            (many, _) => format!("TOO MANY: {}", many.join(", ")),
        };
        println!(
            "| {} | {} | {} | {:.0} % | {verdict} |",
            cell.design,
            cell.data,
            rates.join(", "),
            100.0 * ranked as f64 / sets as f64,
        );
    }
    Ok(())
}
