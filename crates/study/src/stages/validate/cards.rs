//! The answers that the page of a validation opens with.

use super::{Agreement, Examined, Metric, Right, Validated, tables::over};
use crate::stages::report::card::{
    card, interval, must_not_happen, number, percent, plot, share_row,
};
use maveric_analysis::{Finding, Question, Verdict};
use maveric_rehearsal::{findings, validation::Reading};
use maveric_report::{Card, apa, figures::intervals::IntervalRow};
use maveric_stats::proportion;

/// A card a question.
pub(super) fn cards(found: &Validated, points: f64) -> Vec<Card> {
    let Some(first) = found.models.first() else {
        return Vec::new();
    };
    let words = |finding: &Finding| match finding.question {
        Question::OwnStyle => Some(like_its_driver(found, first, finding)),
        Question::Recognised => recognised(first, finding),
        Question::Dial => Some(dial(first, finding, points)),
        Question::Style => style(first, finding),
        Question::Safe => Some(safe(found, finding)),
        _ => None,
    };
    found.findings.iter().filter_map(words).collect()
}

fn like_its_driver(found: &Validated, first: &Examined, finding: &Finding) -> Card {
    let models = &found.models;
    let rows: Vec<IntervalRow> = first
        .fidelity
        .iter()
        .enumerate()
        .map(|(k, f)| {
            let [car, floor, ceiling] = [
                over(models, |m| m.fidelity[k].mimic),
                over(models, |m| m.fidelity[k].population_mean),
                over(models, |m| m.fidelity[k].test_retest),
            ];
            IntervalRow {
                floor: floor.map(|f| 100.0 * f.mean),
                ceiling: ceiling.map(|c| 100.0 * c.mean),
                ..IntervalRow::new(
                    f.title,
                    car.map(|c| 100.0 * c.mean),
                    car.map(|c| (100.0 * c.low, 100.0 * c.high)),
                )
            }
        })
        .collect();
    let mut card = card(finding, "Does the car drive as its driver does?");
    let mean = |of: fn(&IntervalRow) -> Option<f64>| {
        let values: Vec<f64> = rows.iter().filter_map(of).collect();
        percent(super::mean(&values).map(|v| v / 100.0))
    };
    let above = rows
        .iter()
        .filter(|r| r.estimate.zip(r.ceiling).is_some_and(|(e, c)| e >= c));
    card.answer = format!(
        "It is nearer to its driver than guessing the average would be, and in {} of {} measures as near as the driver’s own second drive.",
        above.count(),
        rows.len()
    );
    if finding.verdict != Verdict::Shown {
        card.answer = format!(
            "Not in every measure nearer than guessing the average driver would be; {} models, {} drivers.",
            models.len(),
            found.drivers
        );
    }
    "Shown if in every measure the least accurate model is above guessing the average driver; fails if in one the most accurate is below it."
        .clone_into(&mut card.rule);
    card.number = number(
        format!("mean accuracy over measures {}", mean(|r| r.estimate)),
        format!("guessing the average driver, {}", mean(|r| r.floor)),
        format!("the driver’s own second drive, {}", mean(|r| r.ceiling)),
    );
    card.plot = plot(
        "Accuracy (%)",
        "Mean over models, lowest to highest",
        None,
        rows,
    );
    "A person’s second drive on another road differs by what the road asks: a car can be above that ceiling by driving the mean of many roads."
        .clone_into(&mut card.doubt);
    card.see = Some("figure-fidelity".to_owned());
    card
}

fn recognised(first: &Examined, finding: &Finding) -> Option<Card> {
    let shown = findings::deciding(&first.identity)?;
    let chance = 1.0 / shown.n.max(1) as f64;
    let mut card = card(finding, "Is a driver recognised on another day?");
    card.answer = format!(
        "Of {} drivers, {} are the nearest to their own second drive (first model); chance would give one.",
        shown.n, shown.hits
    );
    "Shown if for every model the share found again by the distance that knows how people vary from day to day is above chance (Wilson’s 95% \
     interval); fails if below."
        .clone_into(&mut card.rule);
    card.number = number(
        format!(
            "{}{}",
            percent(Some(shown.rate)),
            interval(Some((100.0 * shown.low, 100.0 * shown.high)), 0)
        ),
        format!("chance, {}", percent(Some(chance))),
        "100%",
    );
    let rows = first.identity.iter().map(|i| IntervalRow {
        floor: Some(100.0 / i.n.max(1) as f64),
        ..IntervalRow::new(
            format!(
                "{}{}",
                i.what,
                match i.metric {
                    Metric::Euclidean => ", straight",
                    Metric::WithinPerson => "",
                    Metric::Posterior => ", posteriors",
                }
            ),
            Some(100.0 * i.rate),
            Some((100.0 * i.low, 100.0 * i.high)),
        )
    });
    card.plot = plot(
        "Found again (%)",
        "Wilson’s 95% CI, first model",
        None,
        rows.collect(),
    );
    "How many can be told apart depends on how alike people are: a bound by as many plain numbers stands in the table."
        .clone_into(&mut card.doubt);
    card.see = Some("table-validation-identity".to_owned());
    Some(card)
}

fn dial(first: &Examined, finding: &Finding, points: f64) -> Card {
    let share = |r: &Right| proportion(r.right, r.n, 0.95).ok();
    let mut card = card(
        finding,
        "Does turning the dial change the driving as it says?",
    );
    let rows: Vec<IntervalRow> = first
        .dial
        .iter()
        .flat_map(|d| [(d, "+", &d.aggressive), (d, "−", &d.cautious)])
        .map(|(d, sign, right)| {
            let label = format!("{} {sign}{points}", d.title);
            IntervalRow::share(label, share(right).as_ref())
        })
        .collect();
    let lowest = rows
        .iter()
        .filter_map(|r| Some((r.label.clone(), r.estimate?)));
    let lowest = lowest.min_by(|a, b| a.1.total_cmp(&b.1));
    card.answer = lowest.as_ref().map_or_else(String::new, |(label, share)| {
        format!("For most drivers in every measure; least for {} ({share:.0}% of drivers, first model).", label.to_lowercase())
    });
    "Shown if for every model, measure and side more than half of the drivers change the right way (Wilson’s 95% interval above 50%; no change \
     counts as wrong); fails if in one fewer than half do."
        .clone_into(&mut card.rule);
    card.number = lowest.and_then(|(label, share)| {
        number(
            format!("least: {}, {share:.0}%", label.to_lowercase()),
            "50%, a coin",
            "100%, every driver",
        )
    });
    card.plot = plot(
        "Drivers who change the right way (%)",
        "Wilson’s 95% CI, first model",
        Some(50.0),
        rows,
    );
    "Whoever already changes lanes as often as the road allows cannot do so more often: the table counts those with room apart."
        .clone_into(&mut card.doubt);
    card.see = Some("figure-dial-sweep".to_owned());
    card
}

fn style(first: &Examined, finding: &Finding) -> Option<Card> {
    let alone = |a: &&Agreement| a.reading == Reading::WithoutScore;
    let shown = first.line.iter().find(alone)?;
    let mut card = card(finding, "Does driving alone tell the score?");
    card.answer = format!(
        "The style read from a drive alone explains {:.0}% of how the scores of {} drivers differ (first model).",
        100.0 * shown.adb.unwrap_or(0.0).powi(2),
        shown.n
    );
    format!("Shown if for every model the correlation of the score with “{}” is above 0 (95% interval); fails if below.", shown.reading.title())
        .clone_into(&mut card.rule);
    card.number = number(
        format!(
            "*r* = {}{}",
            shown
                .adb
                .map_or_else(|| "n/a".to_owned(), |r| apa::bounded(r, 2)),
            interval(shown.adb_interval, 2)
        ),
        "0",
        "the score’s own reliability",
    );
    let rows = first
        .line
        .iter()
        .map(|a| IntervalRow::new(a.reading.title(), a.adb, a.adb_interval));
    card.plot = plot(
        "Correlation with the score",
        "95% CI, first model",
        Some(0.0),
        rows.collect(),
    );
    "Fitted with the score, the correlation is partly built in.".clone_into(&mut card.doubt);
    card.see = Some("table-validation-line".to_owned());
    Some(card)
}

fn safe(found: &Validated, finding: &Finding) -> Card {
    let drives: usize = found.models.iter().map(|m| m.drives).sum();
    let collisions: u32 = found.models.iter().map(|m| m.collisions).sum();
    let near: u32 = found.models.iter().map(|m| m.rule_violations).sum();
    let mut card = must_not_happen(finding, "Does the car stay clear of others?", "rate");
    let part = finding.parts.first();
    card.answer = format!(
        "{collisions} collisions and {near} moments nearer than the safety rule allows in {drives} drives."
    );
    "Shown if no drive of the car has a collision; fails if one has.".clone_into(&mut card.rule);
    card.plot = plot(
        "Drives with a collision (%)",
        "Wilson’s 95% CI",
        Some(0.0),
        part.map(|part| share_row("All models", part))
            .into_iter()
            .collect(),
    );
    "The other cars are simulated and keep to their rules.".clone_into(&mut card.doubt);
    card.see = Some("exclusions".to_owned());
    card
}
