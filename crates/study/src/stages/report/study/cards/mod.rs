//! The answers that a study's page opens with, from its typed results.

mod car;
mod conditions;
mod paper;
mod people;
mod style;

use super::{Run, setting::Reliable};
use crate::stages::report::{
    card::{card, interval, number, plot},
    words::capital,
};
use maveric_analysis::Judged;
use maveric_report::claims::LedgerRow;
use maveric_report::figures::intervals::{IntervalRow, Intervals};
use maveric_report::{Card, apa, markup};

/// A card a question, in the order in which a reader asks: what was declared first, then does it work, for whom, can it be trusted.
pub(super) fn cards(
    run: &Run,
    reliabilities: &[Reliable],
    ledger: Option<&[LedgerRow]>,
) -> Vec<Card> {
    let declared = run.analysis.hypotheses.iter().enumerate();
    let mut found: Vec<Card> = declared.map(|(i, h)| hypothesis(run, i, h)).collect();
    found.extend(car::own_style(run));
    found.extend(car::nearer(run));
    found.extend(conditions::expected(run, true));
    found.extend(conditions::expected(run, false));
    if found.is_empty() {
        found.extend(conditions::conditions(run));
    }
    found.extend(style::line(run, reliabilities));
    found.extend(style::across(run));
    found.extend(people::preferred(run));
    found.extend(people::homophily(run));
    found.extend(ledger.map(paper::against_the_paper));
    found
}

fn hypothesis(run: &Run, i: usize, h: &Judged) -> Card {
    let mut found = card(&format!("hypothesis-{}", i + 1), h.says.clone(), h.verdict);
    let (first, second) = (run.label(h.first), run.label(h.second));
    found.answer = match h.mean_difference {
        Some(d) => {
            let way = if d < 0.0 { "below" } else { "above" };
            format!(
                "On average {first} lies {} {way} {second} ({} people).",
                apa::number(d.abs(), 2),
                h.n
            )
        }
        None => format!("{} people have both values.", h.n),
    };
    found.rule = format!("{}. Declared with the study.", capital(&h.rule));
    let row = IntervalRow::new(
        format!("{} − {}", markup::plain(&first), markup::plain(&second)),
        h.mean_difference,
        h.interval,
    );
    let level = if h.bounds.is_some() {
        "90% CI"
    } else {
        "95% CI"
    };
    found.plot = plot("Mean difference", level, Some(0.0), vec![row]).map(|p| Intervals {
        bounds: h.bounds,
        ..p
    });
    found.number = number(
        format!(
            "mean difference {}{}",
            h.mean_difference
                .map_or_else(|| "not known".to_owned(), |d| apa::number(d, 2)),
            interval(h.interval, 2)
        ),
        "0, no difference",
        "none: a difference has no upper end",
    );
    "The interval is of this contrast alone; the p of the rule is corrected over all contrasts of the outcome."
        .clone_into(&mut found.doubt);
    found.see = Some("table-contrasts".to_owned());
    found.tests =
        h.p.map(|p| apa::p(p).markup().to_owned())
            .into_iter()
            .collect();
    found
}
