//! The answers of rehearsals: of studies without effects, and of power.

use crate::{
    card::{Drawn, card, share_row},
    texts::{Texts, value},
};
use maveric_analysis::{Finding, Question, Verdict};
use maveric_rehearsal::{ALPHA, Cell, POWER, validation::mean};
use maveric_report::{Card, ReportError, figures::intervals::IntervalRow};
use minijinja::context;

/// Most rows of a picture.
const ROWS: usize = 30;

fn texts() -> Result<Texts, ReportError> {
    Texts::read("rehearsal.toml", include_str!("../../texts/rehearsal.toml"))
}

/// The card of a finding about studies of one size.
///
/// # Errors
/// [`ReportError::Template`] for a text that asks for a value which is not given.
pub fn of_studies(cell: &Cell, finding: &Finding) -> Result<Option<Card>, ReportError> {
    let texts = texts()?;
    let card = match finding.question {
        Question::Families => families(&texts, cell, finding),
        Question::Single => single(&texts, cell, finding),
        Question::Power => power(&texts, cell, finding),
        _ => return Ok(None),
    };
    card.map(Some)
}

fn families(texts: &Texts, cell: &Cell, finding: &Finding) -> Result<Card, ReportError> {
    let known = finding.parts.iter().filter(|part| part.estimate.is_some());
    let rate = |part: &maveric_analysis::Part| part.estimate.unwrap_or(0.0);
    let worst = known.max_by(|a, b| rate(a).total_cmp(&rate(b)));
    let uncorrected = cell.families.iter().filter_map(|f| f.any_uncorrected);
    let values = context! {
        worst => worst.map(|part| context! { family => part.of.as_str(), rate => part.estimate }),
        studies => cell.studies,
        uncorrected => uncorrected.map(|share| share.estimate).reduce(f64::max),
    };
    let rows = finding.parts.iter().take(ROWS);
    let drawn = Drawn::beside(100.0 * ALPHA, rows.map(|part| share_row(&part.of, part)));
    card(texts, finding, &values, Some(drawn))
}

fn single(texts: &Texts, cell: &Cell, finding: &Finding) -> Result<Card, ReportError> {
    let rates = cell.tests.iter().filter_map(|t| Some((t, t.rate.as_ref()?)));
    let tests: Vec<_> = rates.collect();
    let above = tests.iter().filter(|(_, rate)| rate.low > ALPHA).count();
    let most = tests.iter().max_by(|a, b| a.1.estimate.total_cmp(&b.1.estimate));
    let values = context! {
        tests => tests.len(),
        above,
        chance => 0.025 * tests.len() as f64,
        most => most.map(|(test, rate)| context! { key => test.key.as_str(), rate => rate.estimate }),
    };
    let rows = cell.by_part().into_iter().map(|(part, tests)| {
        let rates = tests.iter().filter_map(|t| Some(100.0 * t.rate?.estimate));
        let rates: Vec<f64> = rates.collect();
        let low = rates.iter().copied().reduce(f64::min);
        let ends = low.zip(rates.iter().copied().reduce(f64::max));
        IntervalRow::new(part.title(), mean(&rates), ends)
    });
    let drawn = Drawn::beside(100.0 * ALPHA, rows);
    card(texts, finding, &values, Some(drawn))
}

fn power(texts: &Texts, cell: &Cell, finding: &Finding) -> Result<Card, ReportError> {
    let weakest = finding.least(|part| part.estimate);
    let weakest = weakest.filter(|part| part.estimate.is_some());
    let planted = (cell.effect_scale - 1.0).abs() < 1e-12;
    let values = context! {
        people => cell.participants,
        declared => !cell.hypotheses.is_empty(),
        scale => if planted { 1.0 } else { cell.effect_scale },
        scale_words => cell.effect_scale.to_string(),
        questions => finding.parts.len(),
        only => finding.parts.first().map(value),
        enough => finding.count(Verdict::Shown),
        weakest => weakest.map(value),
    };
    let rows = finding.parts.iter();
    let drawn = Drawn::beside(100.0 * POWER, rows.map(|part| share_row(&part.of, part)));
    card(texts, finding, &values, Some(drawn))
}
