//! The report of what a design called for: why, and the report of that test.

use super::{
    Printed,
    cells::{p, table},
    comparison, factorial,
    factors::deciding,
    groups, mixed, named_sentences, ordinal,
    reasons::{checks, why},
};
use maveric_report::tables::Table;
use maveric_stats::{ByDesign, RankCheck};

pub(in crate::stages::stats) fn by_design(result: &ByDesign) -> Printed {
    let mut inner = match result {
        ByDesign::OneFactor(result) => return comparison(result),
        ByDesign::Factorial(result) => {
            let mut printed = factorial(&result.found.anova);
            // The tests that count in the place of those of the analysis of variance.
            printed.tables[0] = deciding(&result.found);
            printed
        }
        ByDesign::Groups(result) => groups(&result.found),
        ByDesign::Mixed(result) => {
            let mut printed = mixed(&result.found.model);
            if !result.found.corrected.is_empty() {
                let sentences = named_sentences(&result.found);
                let title = "Terms, degrees of freedom within subjects times epsilon";
                printed = Printed {
                    heading: std::mem::take(&mut printed.heading),
                    tables: Vec::new(),
                }
                .lines(title, sentences)
                .and(printed);
            }
            printed
        }
        ByDesign::Ordinal(result) => {
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
    let title = format!(
        "Rank tests of the {} complete subjects, as a check",
        beside.n
    );
    let f = &beside.friedman;
    let omnibus = ("Friedman".to_owned(), f.p_exact.or(f.f_p).or(f.p));
    let pairs = beside.wilcoxon.iter();
    let pairs = pairs.map(|(name, w)| (format!("Wilcoxon {name}, Holm"), w.p_holm));
    table(&title, std::iter::once(omnibus).chain(pairs))
        .text("", |(name, _)| name.clone())
        .right("*p*", |(_, value)| p(*value))
        .done()
}
