//! How many of the paper's numbers come out.

use crate::stages::report::card::{card, number, plot};
use maveric_analysis::findings;
use maveric_report::Card;
use maveric_report::claims::{LedgerRow, verdict_counts};
use maveric_report::figures::intervals::IntervalRow;
use maveric_stats::proportion;

/// How many numbers of the paper come out here, of those that could differ.
pub(super) fn against_the_paper(ledger: &[LedgerRow]) -> Card {
    use maveric_report::claims::Verdict as Claimed;
    let counts = verdict_counts(ledger);
    let count = |v: Claimed| counts.get(&v).copied().unwrap_or(0);
    let (agree, same, differ) = (
        count(Claimed::Agrees),
        count(Claimed::SameDirection),
        count(Claimed::Differs),
    );
    let could = agree + same + differ;
    let share = proportion(agree, could, 0.95).ok();
    let finding = findings::against_the_paper(agree, could);
    let mut found = card(&finding, "Do the paper’s numbers come out here?");
    found.answer = format!(
        "Of {could} that could differ, {agree} agree, {same} point the same way, {differ} differ; {} were set or tuned to be so and are not counted.",
        count(Claimed::ByDesign) + count(Claimed::Tuned)
    );
    "Shown if more than half of those that could differ agree (Wilson’s 95% interval above 50%); fails if fewer do.".clone_into(&mut found.rule);
    found.number = number(format!("{agree} of {could} agree"), "half", "all of them");
    found.plot = plot(
        "Agree, of those that could differ (%)",
        "Wilson’s 95% CI",
        Some(50.0),
        vec![IntervalRow::share("Agree", share.as_ref())],
    );
    "The paper’s participants are real people; where ours are made up, agreement says that the method can do it, and is no replication. \
     Claims share data, so the interval is too narrow."
        .clone_into(&mut found.doubt);
    found.see = Some("ledger".to_owned());
    found
}
