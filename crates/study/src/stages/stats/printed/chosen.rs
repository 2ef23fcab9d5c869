//! The report of what a design called for: why, and the report of that test.

use super::{
    Printed,
    cells::{p, table},
    comparison,
    factors::decided,
    groups,
    models::mixed_with,
    named_sentences, ordinal,
    reasons::{checks, why},
};
use crate::stages::stats::ran::ALPHA;
use maveric_report::tables::Table;
use maveric_stats::{ByDesign, FollowUp, RankCheck};

/// `after` is what follows the tests of a factorial design; other designs have none.
pub(in crate::stages::stats) fn by_design(result: &ByDesign, after: Option<&FollowUp>) -> Printed {
    let mut inner = match (result, after) {
        (ByDesign::OneFactor(result), _) => return comparison(result),
        (ByDesign::Factorial(result), Some(after)) => decided(&result.found, after),
        (ByDesign::Groups(chosen), _) => {
            let mut printed = groups(&chosen.found);
            // What was chosen, in the place of all that was computed.
            let mut sentences = named_sentences(result);
            let p = result.effects().first().and_then(|(_, p)| *p);
            let verdict = match p.map(|p| p < ALPHA) {
                Some(true) => "The groups differ at .05.",
                Some(false) => "No difference of the groups is shown at .05.",
                None => "The test that was chosen has no value for these data.",
            };
            sentences.push(verdict.to_owned());
            printed.tables[0].notes = sentences;
            printed
        }
        (ByDesign::Mixed(result), _) => {
            let mut printed = mixed_with(&result.found.model, |term| result.found.pairs(term));
            if !result.found.corrected.is_empty() {
                let sentences = named_sentences(&result.found);
                let title = "Terms, degrees of freedom within subjects times epsilon";
                printed =
                    Printed { heading: std::mem::take(&mut printed.heading), tables: Vec::new() }
                        .lines(title, sentences)
                        .and(printed);
            }
            printed
        }
        (ByDesign::Ordinal(result), _) => {
            let mut printed = ordinal(&result.found.model);
            // The conditions by the test that decides: the likelihood ratio held against F.
            printed.tables[0].notes = named_sentences(&result.found);
            match &result.found.beside {
                Some(beside) => printed.table(ranks(beside)),
                None => printed,
            }
        }
        _ => return Printed::default(),
    };
    let mut printed = Printed::default()
        .table(checks(result.checks()))
        .lines("Why this test", why(result.reasons()));
    printed.heading = std::mem::take(&mut inner.heading);
    printed.and(inner)
}

fn ranks(beside: &RankCheck) -> Table {
    let title = format!("Rank tests of the {} complete subjects, as a check", beside.n);
    let f = &beside.friedman;
    let omnibus = ("Friedman".to_owned(), f.reported_p().0);
    let pairs = beside.wilcoxon.iter();
    let pairs = pairs.map(|(name, w)| (format!("Wilcoxon {name}, Holm"), w.p_holm));
    table(&title, std::iter::once(omnibus).chain(pairs))
        .text("", |(name, _)| name.clone())
        .right("*p*", |(_, value)| p(*value))
        .done()
}
