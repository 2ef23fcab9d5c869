//! Do the conditions differ, and the way that was expected?

use super::data::Study;
use crate::{
    card::{Drawn, tested_card},
    texts::{Texts, value},
    words::{in_unit_of, omnibus, other_choice, paired, small},
};
use maveric_analysis::{Contrast, Finding, Panel, Question, Sensitivity, Verdict, verdict::FEWEST};
use maveric_domain::{
    ConditionId,
    design::{Condition, Sign},
};
use maveric_report::{Card, ReportError, figures::intervals::IntervalRow};
use maveric_stats::{Adjustment, proportion};
use minijinja::context;
use std::collections::BTreeSet;

fn whole<'a>(study: &Study<'a>) -> impl Iterator<Item = &'a Panel> {
    let panels = study.analysis.panels.iter();
    panels.filter(|panel| panel.group.is_none())
}

/// Of these contrasts the one between the places that lie furthest apart on the dial.
fn widest<'a>(study: &Study<'_>, contrasts: &[&'a Contrast]) -> Option<&'a Contrast> {
    let dial = |id: ConditionId| study.design.condition(id).and_then(Condition::dial);
    let apart = |c: &Contrast| (dial(c.first).unwrap_or(0.0) - dial(c.second).unwrap_or(0.0)).abs();
    let contrasts = contrasts.iter().copied();
    contrasts.max_by(|a, b| apart(a).total_cmp(&apart(b)))
}

/// People for whom a contrast lies the expected way, in %; those of whom it lies neither way count as the others.
fn expected_share(title: &str, c: &Contrast) -> IntervalRow {
    let [above, tied, below] = c.people;
    let hits = match c.expected {
        Some(Sign::Plus) => above,
        _ => below,
    };
    let n = above + tied + below;
    let share = proportion(hits, n, 0.95).ok().filter(|_| n >= FEWEST);
    IntervalRow::share(title, share.as_ref())
}

/// The test over the conditions, in words.
fn over(
    study: &Study<'_>,
    texts: &Texts,
    card: &str,
    panel: &Panel,
) -> Result<String, ReportError> {
    let test = omnibus(study.design, panel, false);
    let values = context! { title => panel.title.as_str(), omnibus => test };
    texts.say(card, "over", &values)
}

/// Do the differences stay by another choice? A test a difference that was found.
pub(super) fn stays(
    study: &Study<'_>,
    texts: &Texts,
    finding: &Finding,
) -> Result<Card, ReportError> {
    let choices_compared = &study.analysis.sensitivity;
    let mut tests = Vec::new();
    for by_choice in choices_compared {
        let rows = by_choice.rows.iter();
        for row in rows.filter(|row| row.differs == Verdict::Shown) {
            let values = context! {
                title => by_choice.title.as_str(),
                choice => other_choice(&by_choice.choice),
                first => study.label(row.first),
                second => study.label(row.second),
                ..context! { ..in_unit_of(study.analysis, &by_choice.outcome), ..value(row) }
            };
            tests.push(texts.say("stays", "test", &values)?);
        }
    }
    let outcomes: BTreeSet<&str> = choices_compared.iter().map(|one| one.title.as_str()).collect();
    let choices: BTreeSet<String> =
        choices_compared.iter().map(|one| other_choice(&one.choice)).collect();
    let values = context! {
        outcomes => value(&outcomes),
        choices => value(&choices),
        all => finding.parts.len(),
        stay => finding.count(Verdict::Shown),
        only => choices_compared.iter().map(Sensitivity::only_there).sum::<usize>(),
    };
    tested_card(texts, finding, &values, None, tests)
}

/// Do the conditions differ the way that was expected: in what was measured, or in what people said?
pub(super) fn expected(
    study: &Study<'_>,
    texts: &Texts,
    finding: &Finding,
) -> Result<Option<Card>, ReportError> {
    let name = finding.question.to_string();
    let measured = finding.question != Question::Noticed;
    let mut panels: Vec<(&Panel, Vec<&Contrast>)> = Vec::new();
    for panel in whole(study).filter(|p| p.measured == measured) {
        let expected = panel.contrasts.iter().filter(|c| c.expected.is_some());
        let expected: Vec<&Contrast> = expected.collect();
        if !expected.is_empty() {
            panels.push((panel, expected));
        }
    }
    let Some(first) = panels.first().and_then(|(_, all)| widest(study, all)) else {
        return Ok(None);
    };
    let drawn = panels.iter().filter_map(|(panel, contrasts)| {
        let pair = widest(study, contrasts)?;
        Some((expected_share(&panel.title, pair), pair.people[1]))
    });
    let drawn: Vec<(IntervalRow, usize)> = drawn.collect();
    let lowest = drawn.iter().filter(|(row, _)| row.estimate.is_some());
    let lowest = lowest
        .min_by(|(a, _), (b, _)| a.estimate.unwrap_or(0.0).total_cmp(&b.estimate.unwrap_or(0.0)));
    let pairs = || panels.iter().flat_map(|(p, cs)| cs.iter().map(move |c| (*p, *c)));
    let right = pairs().filter(|(_, c)| c.mean_difference.and_then(Sign::of) == c.expected);
    let steps = study.conditions.iter();
    let steps = steps.filter(|c| c.moved_points.is_some_and(|m| m.abs() > 0.0) || c.clamped);
    let (cut, asked) =
        steps.fold((0, 0), |(cut, asked), c| (cut + usize::from(c.clamped), asked + 1));
    let values = context! {
        right => right.count(),
        all => finding.parts.len(),
        shown => finding.count(Verdict::Shown),
        fails => finding.count(Verdict::Fails),
        lowest => lowest.map(|(row, tied)| context! { tied, ..value(row) }),
        pair => format!("{} against {}", study.label(first.first), study.label(first.second)),
        steered => study.design.style().is_some(),
        steps => study.steps,
        cut,
        asked,
    };
    let mut tests = Vec::new();
    for (panel, _) in &panels {
        tests.push(over(study, texts, &name, panel)?);
    }
    for (panel, pair) in pairs() {
        if let Some(paired) = paired(panel, pair, Adjustment::Holm) {
            let values = context! {
                title => panel.title.as_str(),
                first => study.label(pair.first),
                second => study.label(pair.second),
                paired,
            };
            tests.push(texts.say(&name, "test", &values)?);
        }
    }
    let drawn = Drawn::beside(50.0, drawn.into_iter().map(|(row, _)| row));
    tested_card(texts, finding, &values, Some(drawn), tests).map(Some)
}

/// Do the conditions differ at all? Where nothing else was expected of them.
pub(super) fn differ(
    study: &Study<'_>,
    texts: &Texts,
    finding: &Finding,
) -> Result<Card, ReportError> {
    let compared = || whole(study).filter(|panel| !panel.contrasts.is_empty());
    let judged = compared().zip(&finding.parts);
    let clear = judged.filter(|(_, part)| part.verdict == Verdict::Shown);
    let clear: Vec<String> = clear.map(|(panel, _)| small(&panel.title)).collect();
    let values = context! { clear, all => finding.parts.len() };
    let tests = compared().map(|panel| over(study, texts, "differ", panel));
    let tests = tests.collect::<Result<_, _>>()?;
    tested_card(texts, finding, &values, None, tests)
}

#[cfg(test)]
mod tests {
    use super::super::results::texts;
    use minijinja::context;

    #[test]
    fn who_is_tied_is_told_beside_the_share_and_nothing_is_where_nobody_is() {
        let texts = texts().unwrap();
        let said = |tied: usize| {
            let lowest = context! { label => "Lane changes", estimate => 52.2, tied };
            let values = context! { pair => "A against B", lowest };
            texts.say("dial", "value", &values).unwrap()
        };
        let share = "A against B: lane changes as expected for 52% of people";
        assert_eq!(said(6), format!("{share}; 6 tied, counted as not so"));
        assert_eq!(said(0), share);
    }
}
