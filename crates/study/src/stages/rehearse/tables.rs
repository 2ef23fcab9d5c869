//! What was found, as tables and as lines.

use super::{Cell, Part, Rehearsal, TestRate};
use maveric_rehearsal::{ALPHA, n_for};
use maveric_report::tables::{Cell as Entry, Column, Table};
use maveric_stats::Proportion;

fn table(name: &str, title: String, columns: &[&str], rows: Vec<Vec<Entry>>, note: &str) -> Table {
    let columns = columns.iter().enumerate().map(|(i, &header)| match i {
        0 => Column::left(header),
        _ => Column::right(header),
    });
    Table {
        name: name.to_owned(),
        title,
        columns: columns.collect(),
        rows,
        notes: vec![note.to_owned()],
    }
}

fn rate(share: Option<Proportion>) -> Entry {
    Entry::bounded(share.map(|s| s.estimate), 3)
}

fn interval(share: Option<Proportion>) -> Entry {
    share.map_or(Entry::Missing, |s| {
        let digits = |v: f64| format!("{v:.3}").trim_start_matches('0').to_owned();
        Entry::text(format!("{} to {}", digits(s.low), digits(s.high)))
    })
}

/// Parts of the report with their tests' rates.
pub(super) fn by_part(cell: &Cell) -> Vec<(Part, Vec<&TestRate>)> {
    let of = |part: Part| {
        cell.tests
            .iter()
            .filter(|t| t.part == part)
            .collect::<Vec<_>>()
    };
    let parts = Part::ALL.into_iter().map(|part| (part, of(part)));
    parts.filter(|(_, tests)| !tests.is_empty()).collect()
}

/// Whether a test keeps its level: .05 within .01.
fn keeps_level(test: &TestRate) -> bool {
    test.rate
        .is_some_and(|r| (r.estimate - ALPHA).abs() <= 0.01)
}

/// The tables of studies without effects.
pub(super) fn null_tables(cell: &Cell) -> Vec<Table> {
    let parts = by_part(cell).into_iter().map(|(part, tests)| {
        let rates: Vec<f64> = tests
            .iter()
            .filter_map(|t| t.rate.map(|r| r.estimate))
            .collect();
        let mean = (!rates.is_empty()).then(|| rates.iter().sum::<f64>() / rates.len() as f64);
        let low = rates.iter().copied().reduce(f64::min);
        let high = rates.iter().copied().reduce(f64::max);
        vec![
            Entry::text(part.title()),
            Entry::count(tests.len()),
            Entry::bounded(mean, 4),
            Entry::bounded(low, 4),
            Entry::bounded(high, 4),
            Entry::text(format!(
                "{} of {}",
                tests.iter().filter(|t| keeps_level(t)).count(),
                tests.len()
            )),
        ]
    });
    let parts = table(
        "null-parts",
        format!(
            "False-positive rates by part of the report, {} studies of {}",
            cell.studies, cell.participants
        ),
        &[
            "Part",
            "Tests",
            "Mean rate",
            "Lowest",
            "Highest",
            "Within .05 ± .01",
        ],
        parts.collect(),
        "Share of studies without any effect in which p < .05, uncorrected.",
    );
    let families = cell.families.iter().map(|f| {
        vec![
            Entry::text(f.family.as_str()),
            Entry::count(f.tests),
            rate(f.any_uncorrected),
            rate(f.any_holm),
            interval(f.any_holm),
        ]
    });
    let families = table(
        "null-families",
        "Any false positive in a family of tests".to_owned(),
        &["Family", "Tests", "Uncorrected", "After Holm", "95%"],
        families.collect(),
        "Share of studies in which at least one test of the family has p < .05. Holm keeps it at or below .05 whatever the dependence.",
    );
    let tests = cell.tests.iter().map(|t| {
        vec![
            Entry::text(t.key.as_str()),
            Entry::text(t.part.title()),
            Entry::count(t.studies),
            Entry::count(t.rejected),
            Entry::bounded(t.rate.map(|r| r.estimate), 4),
            interval(t.rate),
            rate(t.holm),
        ]
    });
    let tests = table(
        "null-tests",
        "Every test of the report".to_owned(),
        &[
            "Test",
            "Part",
            "Studies",
            "p < .05",
            "Rate",
            "Monte-Carlo 95%",
            "After Holm",
        ],
        tests.collect(),
        "Studies: those in which the test had a p. Interval: Wilson's, for the number of studies.",
    );
    vec![parts, families, tests]
}

/// The rate of a test at each size tried, for one scale of the effects.
pub(super) fn curve(cells: &[Cell], scale: f64, key: &str) -> Vec<(usize, Proportion)> {
    let of = |c: &Cell| {
        let test = c.tests.iter().find(|t| t.key == key)?;
        Some((c.participants, test.rate?))
    };
    let same = cells
        .iter()
        .filter(|c| (c.effect_scale - scale).abs() < 1e-12);
    same.filter_map(of).collect()
}

/// The tables of studies with effects.
pub(super) fn power_tables(found: &Rehearsal) -> Vec<Table> {
    let mut tables = Vec::new();
    if !found.signs.is_empty() {
        let rows = found.signs.iter().map(|row| {
            vec![
                Entry::text(row.text.as_str()),
                Entry::bounded(Some(row.paper), 2),
                Entry::bounded(row.mean, 2),
                Entry::bounded(row.mean_when_significant, 2),
                rate(row.same_sign),
                rate(row.power),
                row.n_for_80
                    .map_or_else(|| Entry::text("not reached"), |n| Entry::number(Some(n), 0)),
            ]
        });
        let n = found.signs[0].participants;
        tables.push(table(
            "power-signs",
            format!("The paper’s correlations in synthetic studies of {n}: sign, power, and people needed"),
            &["Correlation", "Paper", "Mean of ours", "where p < .05", "Same sign", "p < .05", "n for 80% power"],
            rows.collect(),
            "Effects as planted (scale 1). Where p < .05: mean over those studies, to which the paper’s rows belong by choice. Same sign: share of studies with the paper’s sign. n: by straight lines between the sizes tried.",
        ));
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
    let tests = first.tests.iter().map(|test| {
        let mut row = vec![Entry::text(test.key.as_str())];
        row.extend(scales.iter().map(|scale| {
            let points: Vec<(usize, f64)> = curve(&found.cells, *scale, &test.key)
                .into_iter()
                .map(|(n, r)| (n, r.estimate))
                .collect();
            let lowest = points.first().map(|(n, _)| *n as f64);
            match n_for(&points, 0.8) {
                Some(n) if lowest.is_some_and(|low| n <= low) => Entry::text(format!("≤ {n}")),
                Some(n) => Entry::number(Some(n), 0),
                None => Entry::Missing,
            }
        }));
        row
    });
    let headers: Vec<String> = std::iter::once("Test".to_owned())
        .chain(scales.iter().map(|s| format!("effects × {s}")))
        .collect();
    let headers: Vec<&str> = headers.iter().map(String::as_str).collect();
    tables.push(table(
        "power-n",
        "How many people each test needs for a power of 80%".to_owned(),
        &headers,
        tests.collect(),
        "By straight lines between the sizes tried; a dash: not reached at the largest. Uncorrected p < .05.",
    ));
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
        for (part, tests) in by_part(cell) {
            let rates: Vec<f64> = tests
                .iter()
                .filter_map(|t| t.rate.map(|r| r.estimate))
                .collect();
            let mean = rates.iter().sum::<f64>() / rates.len().max(1) as f64;
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
