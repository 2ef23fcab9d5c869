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
use maveric_analysis::{Finding, Question};
use maveric_report::claims::LedgerRow;
use maveric_report::figures::intervals::{IntervalRow, Intervals};
use maveric_report::{Card, apa, markup};

/// A card a finding, in the order of the analysis, and what the paper's ledger says.
pub(super) fn cards(
    run: &Run,
    reliabilities: &[Reliable],
    ledger: Option<&[LedgerRow]>,
) -> Vec<Card> {
    let findings = run.analysis.findings.iter();
    let words = findings.filter_map(|finding| match finding.question {
        Question::Hypothesis(number) => hypothesis(run, finding, number),
        Question::OwnStyle => car::own_style(run, finding),
        Question::Nearer => car::nearer(run, finding),
        Question::Dial | Question::Expected | Question::Noticed => {
            conditions::expected(run, finding)
        }
        Question::Differ => Some(conditions::conditions(run, finding)),
        Question::Style => style::line(run, finding, reliabilities),
        Question::Across => style::across(run, finding),
        Question::Preferred => people::preferred(run, finding),
        Question::Personality => people::homophily(run, finding),
        _ => None,
    });
    let mut cards: Vec<Card> = words.collect();
    cards.extend(ledger.map(paper::against_the_paper));
    cards
}

fn hypothesis(run: &Run, finding: &Finding, number_of: usize) -> Option<Card> {
    let h = run.analysis.hypotheses.get(number_of.checked_sub(1)?)?;
    let mut found = card(finding, h.says.clone());
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
    Some(found)
}
