//! Do people press more in some conditions, and was the ride another one just before?

use super::data::Study;
use crate::{
    card::{Drawn, tested_card},
    texts::{Texts, value},
    words::label_of_id,
};
use maveric_analysis::{BeforePress, Finding};
use maveric_report::{Card, ReportError, figures::intervals::IntervalRow};
use minijinja::context;

/// Do people press more in some conditions than in others?
pub(super) fn pressed(
    study: &Study<'_>,
    texts: &Texts,
    finding: &Finding,
) -> Result<Option<Card>, ReportError> {
    let presses = study.analysis.presses.as_ref();
    let Some(rates) = presses.and_then(|presses| presses.rates.as_ref()) else {
        return Ok(None);
    };
    let by_rate = |a: &(&str, &f64), b: &(&str, &f64)| a.1.total_cmp(b.1);
    let named = |(id, rate): (&str, &f64)| {
        context! { label => label_of_id(study.design, id), rate }
    };
    let values = context! {
        least => rates.rate.iter().min_by(by_rate).map(named),
        most => rates.rate.iter().max_by(by_rate).map(named),
        never => rates.never,
        ..value(rates)
    };
    let test = texts.say("pressed", "test", &values)?;
    tested_card(texts, finding, &values, None, vec![test]).map(Some)
}

/// Was the ride another one just before people press?
pub(super) fn before(
    study: &Study<'_>,
    texts: &Texts,
    finding: &Finding,
) -> Result<Option<Card>, ReportError> {
    let Some(presses) = &study.analysis.presses else {
        return Ok(None);
    };
    let clear = |row: &&BeforePress| row.p_holm.is_some_and(|p| p < 0.05);
    let clear = presses.before.iter().filter(clear);
    let clear: Vec<String> = clear.map(|row| row.title.to_lowercase()).collect();
    let values = context! { clear, people => presses.people, presses => presses.presses };
    let rows = presses.before.iter().map(|row| {
        let test = &row.test;
        let interval = test.odds_ratio_ci.ends();
        IntervalRow::new(row.title.as_str(), test.odds_ratio, interval)
    });
    let drawn = Drawn::beside(1.0, rows);
    let mut tests = Vec::new();
    for row in presses.before.iter().filter(|row| row.p_holm.is_some()) {
        let values =
            context! { p_holm => row.p_holm, title => row.title.as_str(), ..value(&row.test) };
        tests.push(texts.say("before-press", "test", &values)?);
    }
    tested_card(texts, finding, &values, Some(drawn), tests).map(Some)
}
