//! The claims ledger on the page: grouped by part of the paper, ready to be filtered.

use super::template::safe;
use crate::claims::{
    LedgerRow, LeftOpen, Verdict, ours, own_figures, rule, theirs, verdict_counts,
};
use crate::markup;
use minijinja::{Value, context};
use std::collections::BTreeSet;

/// What the template shows. `anchors` are the ids that the page has: a link to another one is left out.
pub(crate) fn ledger(rows: &[LedgerRow], anchors: &BTreeSet<String>) -> Value {
    let mut parts: Vec<(&str, Vec<Value>)> = Vec::new();
    for row in rows {
        let part = row.claim.section.as_str();
        let shown = row_value(row, anchors);
        match parts.iter_mut().find(|(name, _)| *name == part) {
            Some((_, list)) => list.push(shown),
            None => parts.push((part, vec![shown])),
        }
    }
    let counts = verdict_counts(rows);
    let verdicts = Verdict::ALL
        .iter()
        .map(|v| context! { text => v.text(), of_several => v.of_several(), kind => kind(*v), count => counts.get(v).copied().unwrap_or(0) });
    let disagreeing = |row: &&LedgerRow| row.own_figures.is_some_and(|check| !check.agrees());
    context! {
        parts => parts.into_iter().map(|(name, rows)| context! { name, rows }).collect::<Vec<_>>(),
        verdicts => verdicts.collect::<Vec<_>>(),
        total => rows.len(),
        disagreeing => rows.iter().filter(disagreeing).count(),
    }
}

fn kind(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Agrees => "agrees",
        Verdict::SameDirection => "same-direction",
        Verdict::Differs => "differs",
        Verdict::TooFew => "too-few",
        Verdict::ByDesign => "by-design",
        Verdict::Tuned => "tuned",
        Verdict::NotComputed => "not-computed",
    }
}

fn row_value(row: &LedgerRow, anchors: &BTreeSet<String>) -> Value {
    let origin = row.made.as_ref();
    let shown_in =
        origin.and_then(|m| m.shown_in.as_ref()).filter(|anchor| anchors.contains(*anchor));
    context! {
        id => &row.claim.id,
        text => &row.claim.text,
        note => &row.claim.note,
        theirs => safe(markup::html(&theirs(row))),
        own_figures => own_figures(row).map(|text| safe(markup::html(&text))),
        disagrees => row.own_figures.is_some_and(|check| !check.agrees()),
        ours => ours(row).map(|text| safe(markup::html(&text))),
        verdict => row.verdict.text(),
        kind => kind(row.verdict),
        rule => rule(row.claim.rule),
        clear => row.clear().or_else(|| row.left_open().map(LeftOpen::text)),
        stage => origin.map(|m| &m.stage),
        anchor => shown_in,
        shown_as => shown_in.map(|anchor| if anchor.starts_with("figure-") { "figure" } else { "table" }),
    }
}
