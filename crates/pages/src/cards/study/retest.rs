//! Do people drive in the second session as in the first?

use super::data::Study;
use crate::{
    card::{Drawn, card},
    texts::Texts,
    words::small,
};
use maveric_analysis::{FEWEST_FOR_ICC, Finding, Part, Verdict};
use maveric_report::{Card, ReportError, figures::intervals::IntervalRow};
use minijinja::context;

/// A row a reading of the drive by hand.
pub(super) fn retest(
    study: &Study<'_>,
    texts: &Texts,
    finding: &Finding,
) -> Result<Option<Card>, ReportError> {
    let Some(repeats) = &study.analysis.repeats else {
        return Ok(None);
    };
    let title = |part: &Part| {
        let mut rows = repeats.retest.iter();
        let row = rows.find(|row| row.outcome == part.of);
        row.map_or_else(|| part.of.clone(), |row| row.title.clone())
    };
    let titles: Vec<String> = finding.parts.iter().map(|p| small(&title(p))).collect();
    let by_hand =
        repeats.retest.iter().filter(|row| Some(row.condition) == study.design.baseline_id());
    let fewer = by_hand.filter(|row| row.n < FEWEST_FOR_ICC);
    let rows = finding.parts.iter();
    let rows = rows.map(|part| IntervalRow::new(title(part), part.estimate, part.interval));
    let drawn = Drawn::beside(None, rows);
    let values = context! {
        titles,
        fewer => fewer.map(|row| small(&row.title)).collect::<Vec<_>>(),
        alike => finding.count(Verdict::Shown),
        n => finding.parts.iter().map(|part| part.n).max(),
        fewest => FEWEST_FOR_ICC,
    };
    card(texts, finding, &values, Some(drawn)).map(Some)
}
