//! The ledger as a table.

use super::join::{LedgerRow, LeftOpen, Verdict};
use super::load::{DfSource, Quantity, Rule};
use super::self_check::SelfCheck;
use crate::apa;
use crate::markup::literal;
use crate::tables::{Cell, Table};
use std::collections::BTreeMap;

/// How many claims got each verdict, in the order of [`Verdict`].
pub fn verdict_counts(rows: &[LedgerRow]) -> BTreeMap<Verdict, usize> {
    let mut counts = BTreeMap::new();
    for row in rows {
        *counts.entry(row.verdict).or_insert(0) += 1;
    }
    counts
}

/// Builds the table `claims`.
pub fn ledger_table(rows: &[LedgerRow]) -> Table {
    let counts: Vec<String> = verdict_counts(rows)
        .into_iter()
        .map(|(verdict, count)| format!("{}: {count}", verdict.text()))
        .collect();
    let missing = |text: Option<String>| text.map_or(Cell::Missing, Cell::Text);
    let marked = |text: Option<String>| text.map_or(Cell::Missing, Cell::Marked);
    Table::of("claims", "Every number that the paper reports, and ours", rows)
        .text("Claim", |row| &row.claim.text)
        .text("Part", |row| &row.claim.section)
        .left("Paper", |row| Cell::Marked(theirs(row)))
        .left("Here", |row| marked(ours(row)))
        .text("Verdict", |row| row.verdict.text())
        .text("Rule", |row| rule(row.claim.rule))
        .left("*p* < .05?", |row| {
            let left_open = || row.left_open().map(LeftOpen::text);
            row.clear().or_else(left_open).map_or(Cell::Missing, Cell::text)
        })
        .left("Does the paper agree with itself?", |row| marked(own_figures(row)))
        .left("Stage", |row| missing(row.made.as_ref().map(|m| m.stage.clone())))
        .left("Shown in", |row| shown_in(row).map_or(Cell::Missing, Cell::text))
        .left("Remark", |row| missing(row.claim.note.clone()))
        .noted(format!("{}.", counts.join("; ")))
        .noted(
            "The paper’s participants are real people, ours may be synthetic: a verdict compares \
             direction and size, and is no replication.",
        )
        .keyed(&[
            "claim",
            "part",
            "paper",
            "here",
            "verdict",
            "rule",
            "clear",
            "paper_with_itself",
            "stage",
            "shown_in",
            "remark",
        ])
}

fn shown_in(row: &LedgerRow) -> Option<&str> {
    row.made.as_ref()?.shown_in.as_deref()
}

fn symbol(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::R => "*r*",
        Quantity::Rho => "*ρ*",
        _ => "*p*",
    }
}

/// `= .46`, `< .001`.
fn relation(text: &str) -> String {
    if text.starts_with(['<', '>']) { text.to_owned() } else { format!("= {text}") }
}

pub(crate) fn theirs(row: &LedgerRow) -> String {
    let claim = &row.claim;
    let printed = literal(&claim.printed.text());
    match claim.quantity {
        Quantity::R | Quantity::Rho => {
            let df = match (claim.df, claim.df_from) {
                (Some(df), Some(DfSource::Printed)) => format!("({df})"),
                _ => String::new(),
            };
            let p = claim.printed_p.as_ref();
            let p = p.map_or(String::new(), |p| format!(", *p* {}", relation(&p.text())));
            format!("{}{df} = {printed}{p}", symbol(claim.quantity))
        }
        Quantity::P => format!("*p* {}", relation(&printed)),
        Quantity::Difference => match claim.printed.bound {
            Some('<') => "lower".to_owned(),
            _ => "higher".to_owned(),
        },
        other => format!("{printed}{}", other.unit()),
    }
}

pub(crate) fn ours(row: &LedgerRow) -> Option<String> {
    let ours = row.ours?;
    let quantity = row.ours_quantity;
    Some(match quantity {
        Quantity::R | Quantity::Rho => {
            let p = row.ours_p.map_or(String::new(), |p| format!(", {}", apa::p(p).markup()));
            format!("{} = {}{p}", symbol(quantity), apa::bounded(ours, quantity.decimals()))
        }
        Quantity::P => apa::p(ours).markup().to_owned(),
        Quantity::Difference => {
            let p = row.ours_p.map_or(String::new(), |p| format!(", {}", apa::p_holm(p).markup()));
            let sign = if ours > 0.0 { "+" } else { "" };
            format!("{sign}{}{p}", apa::number(ours, quantity.decimals()))
        }
        other => {
            let whole = (ours - ours.round()).abs() < 1e-9;
            let decimals = if whole { 0 } else { other.decimals().max(1) };
            format!("{}{}", apa::number(ours, decimals), other.unit())
        }
    })
}

pub(crate) fn rule(rule: Rule) -> String {
    match rule {
        Rule::Direction { tolerance } => format!(
            "same sign; the paper’s within our 95% interval (without one: within {tolerance})"
        ),
        Rule::Near { tolerance } => format!("within {tolerance}"),
        Rule::PBelow { bound } => {
            let decimals = if bound < 0.01 { 3 } else { 2 };
            format!("p below {}", apa::bounded(bound, decimals))
        }
        Rule::PAbove { bound } => format!("p above {}", apa::bounded(bound, 2)),
        Rule::Above => "above the paper’s bound".to_owned(),
        Rule::Below => "below the paper’s bound".to_owned(),
        Rule::ByDesign {} => "set by whoever runs the study: no finding".to_owned(),
    }
}

pub(crate) fn own_figures(row: &LedgerRow) -> Option<String> {
    let result = match row.own_figures? {
        SelfCheck::Correlation(result) => result,
        SelfCheck::People { of, fits: true, .. } => {
            return Some(format!("yes: possible with {of} people"));
        }
        SelfCheck::People { of, nearest, .. } => {
            let decimals = row.claim.printed.decimals();
            let nearest = apa::number(nearest, decimals);
            let unit = row.claim.quantity.unit();
            return Some(format!("no: the nearest that {of} people can give is {nearest}{unit}"));
        }
        SelfCheck::Sum { fits: true, .. } => return Some("yes: its parts add up".to_owned()),
        SelfCheck::Sum { sum, .. } => {
            return Some(format!("no: its parts add up to {}", apa::number(sum, 0)));
        }
    };
    if result.follows {
        return Some("yes".to_owned());
    }
    let (low, high) = (result.p_low, result.p_high);
    let p = if high < 0.001 {
        "< .001".to_owned()
    } else {
        let write = |p: f64| {
            if p < 0.001 { "< .001".to_owned() } else { apa::bounded(p, 3) }
        };
        format!("{} to {}", write(low), write(high))
    };
    let df = row.claim.df.unwrap_or_default();
    let fits = match result.fitting_df {
        Some(fitting) => format!("; it fits *df* = {fitting}"),
        None => "; no *df* up to 200 fits".to_owned(),
    };
    Some(format!("no: *df* = {df} gives *p* {p}{fits}"))
}

#[cfg(test)]
mod tests {
    use super::super::{join, load};
    use super::*;

    #[test]
    fn the_papers_own_claims_make_a_complete_table() {
        let claims = load(maveric_data::CLAIMS).unwrap();
        let results = BTreeMap::from([
            ("line.mean_velocity.r".to_owned(), 0.52),
            ("line.mean_velocity.p".to_owned(), 0.0093),
        ]);
        let by_ranks = [("line.mean_velocity.ranks".to_owned(), 1.0)];
        let by_ranks: BTreeMap<_, _> = results.clone().into_iter().chain(by_ranks).collect();
        let ours = ledger_table(&join(&claims, &by_ranks).unwrap()).to_markdown();
        assert!(ours.contains("*ρ* = .52, *p* = .009"));
        let rows = join(&claims, &results).unwrap();
        let table = ledger_table(&rows);
        table.check().unwrap();
        assert_eq!(table.rows.len(), claims.len());
        let markdown = table.to_markdown();
        assert!(markdown.contains("*r* = .52, *p* = .009"));
        assert!(markdown.contains("no: *df* = 22 gives *p* .014 to .016; it fits *df* = 20"));
        assert_eq!(verdict_counts(&rows)[&Verdict::Agrees], 1);
    }
}
