//! What the learned style holds: the score, and habits beside it.

use super::super::{Run, correlation_words, enumerated, setting::Reliable};
use crate::stages::report::card::{card, interval, number, plot};
use maveric_analysis::{Finding, Verdict};
use maveric_report::figures::intervals::IntervalRow;
use maveric_report::{Card, apa, markup};

/// Does the learned style hold what the driver's score says?
pub(super) fn line(run: &Run, finding: &Finding, reliabilities: &[Reliable]) -> Option<Card> {
    let a = &run.analysis;
    let score =
        |line: &maveric_analysis::AggressionLine| line.rows.last().map(|r| r.correlation.clone());
    let with = a.line.as_ref().and_then(score);
    let without = a.line_without_adb.as_ref().and_then(score);
    let decides = without.as_ref().or(with.as_ref())?;
    let mut found = card(
        finding,
        format!("Does driving alone tell the {}?", run.style_label()),
    );
    let r = decides.r.unwrap_or(0.0);
    found.answer = format!(
        "Of {} people, the style that was learned from a drive alone explains {:.0}% of how their scores differ.",
        decides.n,
        100.0 * r * r
    );
    format!(
        "Shown if the position on the line of {} goes with the score (*p* < .05) although the score took no part in the fit; fails if it goes \
         against it.",
        run.style_label()
    )
    .clone_into(&mut found.rule);
    let row = |label: &str, c: &maveric_analysis::Correlation| {
        IntervalRow::new(label, c.r, c.ci_low.zip(c.ci_high))
    };
    let style = run.design.style()?;
    let wanted = style.score.to_string();
    let alpha = reliabilities
        .iter()
        .find(|r| r.id == wanted)
        .and_then(|r| r.found.alpha);
    let ceiling = alpha.filter(|a| *a > 0.0).map(f64::sqrt);
    let mut rows: Vec<IntervalRow> = without
        .iter()
        .map(|c| row("Fitted without the score", c))
        .collect();
    rows.extend(with.iter().map(|c| row("Fitted with it", c)));
    for row in &mut rows {
        (row.floor, row.ceiling) = (Some(0.0), ceiling);
    }
    found.plot = plot("Correlation with the score", "95% CI", Some(0.0), rows);
    found.number = number(
        format!(
            "*r* = {}{}",
            apa::bounded(r, 2),
            interval(decides.ci_low.zip(decides.ci_high), 2)
        ),
        "0, driving tells nothing",
        match (ceiling, alpha) {
            (Some(c), Some(alpha)) => format!(
                "{}, the root of the score’s α of {}",
                apa::bounded(c, 2),
                apa::bounded(alpha, 2)
            ),
            _ => "1: the score’s reliability is not known here".to_owned(),
        },
    );
    "Fitted with the score the correlation is partly built in; what a line holds need not be what the car does with it."
        .clone_into(&mut found.doubt);
    found.see = Some("table-embedding-line".to_owned());
    found.tests = [("without the score", &without), ("with the score", &with)]
        .into_iter()
        .filter_map(|(how, c)| {
            Some(format!(
                "Position on the line of {}, fitted {how}: {}",
                run.style_label(),
                correlation_words(c.as_ref()?)
            ))
        })
        .collect();
    Some(found)
}

/// Does moving across the dial change a habit that the dial leaves alone?
pub(super) fn across(run: &Run, finding: &Finding) -> Option<Card> {
    let kept = &run.analysis.kept;
    let label = run.label(kept.first()?.across);
    let mut found = card(
        finding,
        format!(
            "Does {} change a habit other than aggression?",
            markup::plain(&label)
        ),
    );
    let judged = kept.iter().zip(&finding.parts);
    let titles: Vec<String> = judged
        .filter(|(_, part)| part.verdict == Verdict::Shown)
        .map(|(habit, _)| habit.title.to_lowercase())
        .collect();
    found.answer = if titles.is_empty() {
        format!(
            "None of {} habits clearly follows where a person was moved to.",
            kept.len()
        )
    } else {
        format!(
            "Where a person was moved to tells how this changes: {}.",
            enumerated(&titles)
        )
    };
    "Shown if the change of at least one habit goes with cosine and sine of the angle of the move (*p* < .05, Holm over the habits)."
        .clone_into(&mut found.rule);
    let rows = kept.iter().map(|k| {
        let mut row = IntervalRow::new(k.title.clone(), k.circular_r, None);
        row.floor = chance(k.points.len());
        row
    });
    found.plot = plot(
        "Multiple *R* with the angle",
        "No interval",
        Some(0.0),
        rows.collect(),
    );
    let strongest = kept.iter().max_by(|a, b| {
        a.circular_r
            .unwrap_or(0.0)
            .total_cmp(&b.circular_r.unwrap_or(0.0))
    })?;
    found.number = number(
        format!(
            "{}: *R* = {}",
            strongest.title.to_lowercase(),
            strongest
                .circular_r
                .map_or_else(|| "n/a".to_owned(), |r| apa::bounded(r, 2))
        ),
        chance(strongest.points.len()).map_or_else(
            || "not known".to_owned(),
            |c| format!("{}, what chance gives on average", apa::bounded(c, 2)),
        ),
        "1",
    );
    "An angle has no natural zero: a correlation with the bare angle, as the paper has it, depends on where counting starts."
        .clone_into(&mut found.doubt);
    found.see = Some("figure-perpendicular".to_owned());
    found.tests = kept
        .iter()
        .filter_map(|k| {
            let p = apa::p_holm(k.circular_p_holm?);
            Some(format!(
                "{}: *R* = {}, {}",
                k.title,
                apa::bounded(k.circular_r?, 2),
                p.markup()
            ))
        })
        .collect();
    Some(found)
}

/// Multiple R of two predictors that tell nothing, on average: √(2 / (n − 1)).
fn chance(n: usize) -> Option<f64> {
    (n > 3).then(|| (2.0 / (n as f64 - 1.0)).sqrt())
}
