//! What was found, as tables and as lines.

use super::{Cell, Rehearsal, TestRate};
use crate::mean::mean;
use maveric_rehearsal::{ALPHA, HypothesisRate, POWER, n_for};
use maveric_report::tables::{Cell as Entry, Table};
use maveric_stats::Proportion;

fn rate(share: Option<Proportion>) -> Entry {
    Entry::bounded(share.map(|s| s.estimate), 3)
}

fn interval(share: Option<Proportion>) -> Entry {
    share.map_or(Entry::Missing, |s| {
        let digits = |v: f64| format!("{v:.3}").trim_start_matches('0').to_owned();
        Entry::text(format!("{} to {}", digits(s.low), digits(s.high)))
    })
}

/// Whether a test keeps its level: .05 within .01.
fn keeps_level(test: &TestRate) -> bool {
    test.rate
        .is_some_and(|r| (r.estimate - ALPHA).abs() <= 0.01)
}

/// The tables of studies without effects.
pub(super) fn null_tables(cell: &Cell) -> Vec<Table> {
    let parts = cell.by_part().into_iter();
    let parts: Vec<_> = parts
        .map(|(part, tests)| (part, rates(&tests), tests))
        .collect();
    let title = format!(
        "False-positive rates by part of the report, {} studies of {}",
        cell.studies, cell.participants
    );
    let reduced = |rates: &[f64], by: fn(f64, f64) -> f64| {
        Entry::bounded(rates.iter().copied().reduce(by), 4)
    };
    let parts = Table::of("null-parts", title, &parts)
        .text("Part", |(part, ..)| part.title())
        .right("Tests", |(.., tests)| Entry::count(tests.len()))
        .right("Mean rate", |(_, rates, _)| Entry::bounded(mean(rates), 4))
        .right("Lowest", |(_, rates, _)| reduced(rates, f64::min))
        .right("Highest", |(_, rates, _)| reduced(rates, f64::max))
        .right("Within .05 ± .01", |(.., tests)| {
            let kept = tests.iter().filter(|t| keeps_level(t)).count();
            Entry::text(format!("{kept} of {}", tests.len()))
        })
        .noted("Share of studies without any effect in which p < .05, uncorrected.");
    let title = "Any false positive in a family of tests";
    let families = Table::of("null-families", title, &cell.families)
        .text("Family", |f| &f.family)
        .right("Tests", |f| Entry::count(f.tests))
        .right("Uncorrected", |f| rate(f.any_uncorrected))
        .right("After Holm", |f| rate(f.any_holm))
        .right("95%", |f| interval(f.any_holm))
        .noted("Share of studies in which at least one test of the family has p < .05. Holm keeps it at or below .05 whatever the dependence.");
    let tests = Table::of("null-tests", "Every test of the report", &cell.tests)
        .text("Test", |t| &t.key)
        .right("Part", |t| Entry::text(t.part.title()))
        .right("Studies", |t| Entry::count(t.studies))
        .right("p < .05", |t| Entry::count(t.rejected))
        .right("Rate", |t| Entry::bounded(t.rate.map(|r| r.estimate), 4))
        .right("Monte-Carlo 95%", |t| interval(t.rate))
        .right("After Holm", |t| rate(t.holm))
        .noted("Studies: those in which the test had a p. Interval: Wilson's, for the number of studies.");
    vec![parts, families, tests]
}

/// The rates of tests that have one.
fn rates(tests: &[&TestRate]) -> Vec<f64> {
    tests
        .iter()
        .filter_map(|t| Some(t.rate?.estimate))
        .collect()
}

/// The rate of a test in a cell.
pub(super) fn rate_of(cell: &Cell, key: &str) -> Option<Proportion> {
    cell.tests.iter().find(|t| t.key == key)?.rate
}

/// A rate at each size tried, for one scale of the effects.
pub(super) fn curve(
    cells: &[Cell],
    scale: f64,
    rate: &dyn Fn(&Cell) -> Option<Proportion>,
) -> Vec<(usize, Proportion)> {
    let same = cells
        .iter()
        .filter(|c| (c.effect_scale - scale).abs() < 1e-12);
    same.filter_map(|c| Some((c.participants, rate(c)?)))
        .collect()
}

/// The tables of studies with effects.
pub(super) fn power_tables(found: &Rehearsal) -> Vec<Table> {
    let mut tables = Vec::new();
    if !found.signs.is_empty() {
        let title = format!(
            "The paper’s correlations in synthetic studies of {}: sign, power, and people needed",
            found.signs[0].participants
        );
        let table = Table::of("power-signs", title, &found.signs)
            .text("Correlation", |row| &row.text)
            .right("Paper", |row| Entry::bounded(Some(row.paper), 2))
            .right("Mean of ours", |row| Entry::bounded(row.mean, 2))
            .right("where p < .05", |row| Entry::bounded(row.mean_when_significant, 2))
            .right("Same sign", |row| rate(row.same_sign))
            .right("p < .05", |row| rate(row.power))
            .right("n for 80% power", |row| {
                let n = row.n_for_80.map(|n| Entry::number(Some(n), 0));
                n.unwrap_or_else(|| Entry::text("not reached"))
            })
            .noted("Effects as planted (scale 1). Where p < .05: mean over those studies, to which the paper’s rows belong by choice. Same sign: share of studies with the paper’s sign. n: by straight lines between the sizes tried.");
        tables.push(table);
    }
    let mut scales: Vec<f64> = Vec::new();
    for cell in &found.cells {
        if !scales.contains(&cell.effect_scale) {
            scales.push(cell.effect_scale);
        }
    }
    let Some(first) = found.cells.first() else {
        return tables;
    };
    let needed = |scale: f64, rate: &dyn Fn(&Cell) -> Option<Proportion>| {
        let curve = curve(&found.cells, scale, rate).into_iter();
        let points: Vec<(usize, f64)> = curve.map(|(n, r)| (n, r.estimate)).collect();
        let lowest = points.first().map(|(n, _)| *n as f64);
        match n_for(&points, POWER) {
            Some(n) if lowest.is_some_and(|low| n <= low) => Entry::text(format!("≤ {n}")),
            Some(n) => Entry::number(Some(n), 0),
            None => Entry::Missing,
        }
    };
    if !first.hypotheses.is_empty() {
        let title = "How many people each declared hypothesis needs to be shown in 80% of studies";
        let rows: Vec<(usize, &HypothesisRate)> = first.hypotheses.iter().enumerate().collect();
        let table =
            Table::of("power-hypotheses", title, &rows).text("Hypothesis", |(_, h)| &h.says);
        let table = scales.iter().fold(table, |table, &scale| {
            table.right(format!("effects × {scale}"), |(i, _)| {
                needed(scale, &|c| c.hypotheses.get(*i)?.shown)
            })
        });
        tables.push(table.noted(
            "Shown by its own rule, corrected as declared. By straight lines between the sizes tried; a dash: not reached at the largest.",
        ));
    }
    let title = "How many people each test needs for a power of 80%";
    let table = Table::of("power-n", title, &first.tests).text("Test", |test| &test.key);
    let table = scales.iter().fold(table, |table, &scale| {
        table.right(format!("effects × {scale}"), |test| {
            needed(scale, &|c| rate_of(c, &test.key))
        })
    });
    tables.push(table.noted("By straight lines between the sizes tried; a dash: not reached at the largest. Uncorrected p < .05."));
    tables
}

/// The result in a few lines.
pub(super) fn summary(found: &Rehearsal) -> Vec<String> {
    let mut lines = Vec::new();
    for cell in found.cells.iter().filter(|c| c.effect_scale == 0.0) {
        let kept = cell.tests.iter().filter(|t| keeps_level(t)).count();
        lines.push(format!(
            "no effect, n = {}: {kept} of {} tests have a false-positive rate of .05 within .01",
            cell.participants,
            cell.tests.len()
        ));
        for (part, tests) in cell.by_part() {
            let rates = rates(&tests);
            let mean = mean(&rates).unwrap_or(0.0);
            let low = rates.iter().copied().fold(f64::INFINITY, f64::min);
            let high = rates.iter().copied().fold(0.0, f64::max);
            lines.push(format!(
                "  {}: mean {mean:.4}, {low:.4} to {high:.4}",
                part.title()
            ));
        }
        for family in &cell.families {
            if let (Some(holm), Some(raw)) = (family.any_holm, family.any_uncorrected) {
                lines.push(format!(
                    "  any of {} in {}: {:.4} after Holm ({:.4} to {:.4}), {:.3} uncorrected",
                    family.tests, family.family, holm.estimate, holm.low, holm.high, raw.estimate
                ));
            }
        }
    }
    for cell in found.cells.iter().filter(|c| c.effect_scale != 0.0) {
        for hypothesis in &cell.hypotheses {
            let share = hypothesis.shown.map_or_else(
                || "nowhere".to_owned(),
                |s| format!("in {:.2} of studies", s.estimate),
            );
            lines.push(format!(
                "effects × {}, n = {}: “{}” is shown {share}",
                cell.effect_scale, cell.participants, hypothesis.says
            ));
        }
    }
    for row in &found.signs {
        let share = |s: Option<Proportion>| {
            s.map_or_else(|| "–".to_owned(), |s| format!("{:.2}", s.estimate))
        };
        lines.push(format!(
            "{}: paper {:.2}, mean of ours {} ({} where p < .05), same sign {}, power {} (n = {})",
            row.key,
            row.paper,
            row.mean
                .map_or_else(|| "–".to_owned(), |m| format!("{m:.2}")),
            row.mean_when_significant
                .map_or_else(|| "–".to_owned(), |m| format!("{m:.2}")),
            share(row.same_sign),
            share(row.power),
            row.participants
        ));
    }
    lines
}
