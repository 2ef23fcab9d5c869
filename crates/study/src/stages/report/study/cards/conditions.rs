//! Do the conditions differ, and the way that was expected?

use super::super::{Run, enumerated};
use crate::stages::report::card::{card, number, plot};
use maveric_analysis::verdict::FEWEST;
use maveric_analysis::{Contrast, Finding, Panel, Question, Verdict};
use maveric_domain::ConditionId;
use maveric_domain::design::Sign;
use maveric_report::Card;
use maveric_report::figures::intervals::IntervalRow;
use maveric_stats::proportion;

/// The panels of everybody with a contrast of which a direction was expected: measures, or ratings.
fn directed_panels(run: &Run, measured: bool) -> Vec<(&Panel, Vec<&Contrast>)> {
    let whole = run.analysis.panels.iter().filter(|p| p.group.is_none());
    whole
        .filter(|p| p.measured == measured)
        .map(|p| {
            (
                p,
                p.contrasts
                    .iter()
                    .filter(|c| c.expected.is_some())
                    .collect::<Vec<_>>(),
            )
        })
        .filter(|(_, contrasts)| !contrasts.is_empty())
        .collect()
}

/// Of these contrasts the one between the places that lie furthest apart on the dial.
fn widest<'a>(run: &Run, contrasts: &[&'a Contrast]) -> Option<&'a Contrast> {
    let dial = |id: ConditionId| {
        run.design
            .condition(id)
            .and_then(maveric_domain::design::Condition::dial)
            .unwrap_or(0.0)
    };
    let apart = |c: &Contrast| (dial(c.first) - dial(c.second)).abs();
    contrasts
        .iter()
        .copied()
        .max_by(|a, b| apart(a).total_cmp(&apart(b)))
}

/// Do the conditions differ the way that was expected: in what was measured, or in what people said?
pub(super) fn expected(run: &Run, finding: &Finding) -> Option<Card> {
    let measured = finding.question != Question::Noticed;
    let panels = directed_panels(run, measured);
    let first = widest(run, &panels.first()?.1)?;
    let all = || {
        panels
            .iter()
            .flat_map(|(p, cs)| cs.iter().map(move |c| (*p, *c)))
    };
    let question = match finding.question {
        Question::Dial => "Does turning the dial change the driving as it says?",
        Question::Noticed => "Do people feel the difference that was meant?",
        _ => "Do the conditions drive the way that was expected?",
    };
    let mut found = card(finding, question);
    let right = all().filter(|(_, c)| c.mean_difference.and_then(Sign::of) == c.expected);
    found.answer = format!(
        "{} of {} differences lie the expected way, {} of them clearly; {} clearly the other way.",
        right.count(),
        finding.parts.len(),
        finding.count(Verdict::Shown),
        finding.count(Verdict::Fails)
    );
    let from = if run.design.style().is_some() {
        "What is expected follows from the places on the dial or stands in the design."
    } else {
        "What is expected stands in the design."
    };
    found.rule = format!(
        "Shown if every contrast with an expected direction lies that way with *p* < .05 (two-sided, Holm over the contrasts of its outcome); fails \
         if one lies the other way by the same rule. {from}"
    );
    let share = |c: &Contrast| {
        let [above, tied, below] = c.people;
        let hits = if c.expected == Some(Sign::Plus) {
            above
        } else {
            below
        };
        let n = above + tied + below;
        proportion(hits, n, 0.95).ok().filter(|_| n >= FEWEST)
    };
    let rows = panels.iter().filter_map(|(p, contrasts)| {
        let share = share(widest(run, contrasts)?);
        Some(IntervalRow::share(p.title.clone(), share.as_ref()))
    });
    let pair = format!(
        "{} against {}",
        run.label(first.first),
        run.label(first.second)
    );
    let rows: Vec<IntervalRow> = rows.collect();
    let lowest = rows.iter().filter_map(|r| Some((r, r.estimate?)));
    let lowest = lowest.min_by(|a, b| a.1.total_cmp(&b.1));
    found.number = lowest.and_then(|(row, share)| {
        number(
            format!(
                "{pair}: {} as expected for {share:.0}% of people",
                row.label.to_lowercase()
            ),
            "50%, a coin",
            "100%, everybody",
        )
    });
    found.plot = plot(
        "People for whom it lies the expected way (%)",
        &format!("{pair}; Wilson’s 95% CI"),
        Some(50.0),
        rows,
    );
    found.doubt = doubt_of_the_dial(run)
        .filter(|_| measured)
        .unwrap_or_else(|| {
            "The same people saw every condition: an answer may follow what came before it."
                .to_owned()
        });
    let steps = measured && !super::super::embedding::steps(run).is_empty();
    found.see = Some(
        if steps {
            "table-dial-steps"
        } else {
            "table-contrasts"
        }
        .to_owned(),
    );
    found.tests = panels.iter().map(|(p, _)| over_conditions(p)).collect();
    found.tests.extend(all().filter_map(|(p, c)| {
        Some(format!(
            "{}, {} − {}: {}",
            p.title,
            run.label(c.first),
            run.label(c.second),
            super::super::conditions::paired(p, c)?
        ))
    }));
    Some(found)
}

/// The test over the conditions, in words.
fn over_conditions(panel: &Panel) -> String {
    format!(
        "{} over the conditions: {}",
        panel.title,
        super::super::conditions::omnibus(panel, false)
    )
}

/// How often the end of the scale cut a step short.
fn doubt_of_the_dial(run: &Run) -> Option<String> {
    let asked = run
        .conditions
        .iter()
        .filter(|c| c.moved_points.is_some_and(|m| m.abs() > 0.0) || c.clamped);
    let (cut, all) = asked.fold((0, 0), |(cut, all), c| {
        (cut + usize::from(c.clamped), all + 1)
    });
    (all > 0).then(|| {
        format!("The end of the scale cut {cut} of {all} steps short: those people were moved by less than was asked for.")
    })
}

/// Do the conditions differ at all? Where nothing else was expected of them.
pub(super) fn conditions(run: &Run, finding: &Finding) -> Card {
    let panels: Vec<&Panel> = run
        .analysis
        .panels
        .iter()
        .filter(|p| p.group.is_none())
        .collect();
    let shown = panels.iter().zip(&finding.parts);
    let clear: Vec<String> = shown
        .filter(|(_, part)| part.verdict == Verdict::Shown)
        .map(|(panel, _)| panel.title.to_lowercase())
        .collect();
    let mut found = card(finding, "Do the conditions differ?");
    found.answer = if clear.is_empty() {
        format!("In none of {} outcomes clearly.", panels.len())
    } else {
        format!(
            "In {} of {} outcomes: {}.",
            clear.len(),
            panels.len(),
            enumerated(&clear)
        )
    };
    "Shown if in one outcome a declared contrast has *p* < .05 after Holm over the contrasts of that outcome; outcomes are not corrected \
     for one another."
        .clone_into(&mut found.rule);
    "Nothing was declared of which way they should differ, so any difference counts."
        .clone_into(&mut found.doubt);
    found.see = Some("table-contrasts".to_owned());
    found.tests = panels.iter().map(|p| over_conditions(p)).collect();
    found
}
