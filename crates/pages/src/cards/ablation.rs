//! The answer of an ablation.

use crate::{
    card::{Drawn, card, share_row},
    texts::{Texts, value},
};
use maveric_analysis::{Finding, Part, Verdict};
use maveric_report::{Card, ReportError};
use minijinja::context;

/// Most rows of the picture.
const ROWS: usize = 12;

/// Is every part worth having? `whole` is what each variant is held against.
///
/// # Errors
/// [`ReportError::Template`] for a text that asks for a value which is not given.
pub fn parts(finding: &Finding, whole: &str) -> Result<Card, ReportError> {
    let texts = Texts::read("ablation.toml", include_str!("../../texts/ablation.toml"))?;
    let mut ascending: Vec<&Part> = finding.parts.iter().collect();
    let share = |part: &Part| part.estimate.unwrap_or(0.0);
    ascending.sort_by(|a, b| share(a).total_cmp(&share(b)));
    let values = context! {
        shown => finding.count(Verdict::Shown),
        fails => finding.count(Verdict::Fails),
        all => finding.parts.len(),
        whole,
        least => ascending.first().map(value),
    };
    let rows = ascending.iter().take(ROWS);
    let drawn = Drawn::beside(50.0, rows.map(|part| share_row(&part.of, part)));
    card(&texts, finding, &values, Some(drawn))
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_analysis::Question;
    use maveric_stats::proportion;

    #[test]
    fn that_rows_are_the_least_is_said_where_some_are_left_out() {
        let what = |all: usize| {
            let share = proportion(7, 10, 0.95).ok();
            let part = Part::share("wide", 10, share.as_ref(), (0.5, f64::INFINITY));
            let finding = Finding::every(Question::Parts, vec![part; all]);
            parts(&finding, "whole").unwrap().plot.unwrap().what
        };
        assert_eq!(what(12), "Wilson’s 95% CI");
        assert_eq!(what(13), "The twelve least; Wilson’s 95% CI");
    }
}
