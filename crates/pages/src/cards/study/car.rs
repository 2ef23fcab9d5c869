//! Does the car at 0 on the dial drive as its driver does, and nearer than the other cars?

use super::data::Study;
use crate::{
    card::{Drawn, tested_card},
    texts::{Texts, value},
    words::in_unit_of,
};
use maveric_analysis::{Bias, Finding, Nearer, Reproduction, Verdict};
use maveric_report::{Card, ReportError, apa, figures::intervals::IntervalRow};
use maveric_stats::Adjustment;
use minijinja::{Value, context};

pub(super) fn own_style(
    study: &Study<'_>,
    texts: &Texts,
    finding: &Finding,
) -> Result<Option<Card>, ReportError> {
    let rows = &study.analysis.reproduction;
    let Some(first) = rows.first() else {
        return Ok(None);
    };
    let say = |key: &str, values: &Value| texts.say("own-style", key, values);
    let of_bias = |row: &Reproduction, bias: &Bias, t: String| {
        let numbers = in_unit_of(study.analysis, &row.measure);
        context! { title => row.title.as_str(), t, ..context! { ..numbers, ..value(bias) } }
    };
    let (mut off, mut tests, mut drawn) = (Vec::new(), Vec::new(), Vec::new());
    let mut accuracies = Vec::new();
    for (row, part) in rows.iter().zip(&finding.parts) {
        accuracies.push(say("accuracies", &value(row))?);
        let bias = row.bias.as_ref();
        let scale = bias.map_or(1.0, |b| b.same_within);
        let scaled = |(low, high): (f64, f64)| (low / scale, high / scale);
        drawn.push(IntervalRow::new(
            row.title.clone(),
            bias.map(|b| b.mean / scale),
            bias.and_then(|b| b.interval).map(scaled),
        ));
        let Some(bias) = bias else { continue };
        if part.verdict != Verdict::Shown {
            off.push(say("off", &of_bias(row, bias, String::new()))?);
        }
        if let (Some(t), Some(p), Some(_)) = (bias.t, bias.p, bias.p_equivalent) {
            let t = apa::t(t, bias.df as f64, p, Adjustment::None, None);
            tests.push(say("test", &of_bias(row, bias, t.markup().to_owned()))?);
        }
    }
    let worst = rows.iter().filter(|r| r.mean.is_some());
    let worst = worst.min_by(|a, b| a.mean.unwrap_or(1.0).total_cmp(&b.mean.unwrap_or(1.0)));
    let judged = rows.iter().zip(&finding.parts);
    let judged = judged.filter(|(_, part)| part.verdict != Verdict::NotAsked);
    let titles: Vec<String> = judged.map(|(row, _)| row.title.to_lowercase()).collect();
    let values = context! {
        label => study.label(first.condition),
        off,
        titles,
        same => finding.count(Verdict::Shown),
        worst => worst.map(value),
        accuracies,
    };
    tests.insert(0, say("accuracy", &values)?);
    let drawn = Drawn::beside(0.0, drawn).within((-1.0, 1.0));
    tested_card(texts, finding, &values, Some(drawn), tests).map(Some)
}

pub(super) fn nearer(
    study: &Study<'_>,
    texts: &Texts,
    finding: &Finding,
) -> Result<Option<Card>, ReportError> {
    let rows = &study.analysis.nearer;
    let effect = |row: &Nearer| row.effect.unwrap_or(1.0);
    let weakest = rows.iter().min_by(|a, b| effect(a).total_cmp(&effect(b)));
    let Some(weakest) = weakest else {
        return Ok(None);
    };
    let with_label = |row: &Nearer| context! { other => study.label(row.than), ..value(row) };
    let [near, tied, far] =
        rows.iter().fold([0; 3], |[a, b, c], r| [a + r.nearer, b + r.tied, c + r.farther]);
    let total = (near + tied + far).max(1) as f64;
    let share = |part: usize| 100.0 * part as f64 / total;
    // Of each measure the comparison that is least clear.
    let mut least: Vec<&Nearer> = Vec::new();
    for row in rows {
        match least.iter_mut().find(|s| s.measure == row.measure) {
            Some(known) if effect(row) < effect(known) => *known = row,
            Some(_) => {}
            None => least.push(row),
        }
    }
    let drawn = least.into_iter();
    let drawn = drawn.map(|r| IntervalRow::new(r.title.clone(), r.effect, r.interval));
    let values = context! {
        label => study.label(weakest.condition),
        shown => finding.count(Verdict::Shown),
        rows => value(rows),
        nearer => share(near),
        tied => share(tied),
        farther => share(far),
        weakest => with_label(weakest),
    };
    let tested = rows.iter().filter(|row| row.p_holm.is_some());
    let tests = tested.map(|row| texts.say("nearer", "test", &with_label(row)));
    let drawn = Drawn::beside(0.0, drawn);
    let tests = tests.collect::<Result<_, _>>()?;
    tested_card(texts, finding, &values, Some(drawn), tests).map(Some)
}
