//! The answers that the page of a validation opens with.

use super::{Examined, Metric, Right, Validated, tables::over};
use crate::stages::report::card::{card, interval, must_not_happen, number, percent, plot};
use maveric_analysis::{Verdict, verdict::within};
use maveric_report::{Card, apa, figures::intervals::IntervalRow};
use maveric_stats::proportion;

/// A card a question.
pub(super) fn cards(found: &Validated, points: f64) -> Vec<Card> {
    let Some(first) = found.models.first() else {
        return Vec::new();
    };
    let mut cards = vec![like_its_driver(found, first)];
    cards.extend(recognised(found, first));
    cards.push(dial(found, first, points));
    cards.extend(style(found, first));
    cards.push(safe(found));
    cards
}

fn like_its_driver(found: &Validated, first: &Examined) -> Card {
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
    let verdicts = rows.iter().zip(&first.fidelity).map(|(row, f)| {
        let floor = row.floor.unwrap_or(f64::NEG_INFINITY);
        within(f.n, row.interval, (floor, f64::INFINITY))
    });
    let mut card = card(
        "own-style",
        "Does the car drive as its driver does?",
        Verdict::all(verdicts.collect::<Vec<_>>()),
    );
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
    if card.verdict != "shown" {
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

fn recognised(found: &Validated, first: &Examined) -> Option<Card> {
    let main = first
        .identity
        .iter()
        .position(|i| i.metric == Metric::WithinPerson)
        .unwrap_or(0);
    let of = |m: &Examined| m.identity.get(main).cloned();
    let shown = of(first)?;
    let chance = 1.0 / shown.n.max(1) as f64;
    let verdicts = found
        .models
        .iter()
        .filter_map(of)
        .map(|i| within(i.n, Some((i.low, i.high)), (chance, f64::INFINITY)));
    let mut card = card(
        "recognised",
        "Is a driver recognised on another day?",
        Verdict::all(verdicts.collect::<Vec<_>>()),
    );
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

fn dial(found: &Validated, first: &Examined, points: f64) -> Card {
    let share = |r: &Right| proportion(r.right, r.n, 0.95).ok();
    let judged = found
        .models
        .iter()
        .flat_map(|m| &m.dial)
        .flat_map(|d| [&d.aggressive, &d.cautious]);
    let verdicts = judged.map(|r| within(r.n, share(r).map(|s| s.ends()), (0.5, f64::INFINITY)));
    let mut card = card(
        "dial",
        "Does turning the dial change the driving as it says?",
        Verdict::all(verdicts.collect::<Vec<_>>()),
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

fn style(found: &Validated, first: &Examined) -> Option<Card> {
    let last = first
        .line
        .iter()
        .position(|a| a.reading.contains("without"))?;
    let verdicts = found
        .models
        .iter()
        .filter_map(|m| m.line.get(last))
        .map(|a| within(a.n, a.adb_interval, (0.0, f64::INFINITY)));
    let shown = &first.line[last];
    let mut card = card(
        "style",
        "Does driving alone tell the score?",
        Verdict::all(verdicts.collect::<Vec<_>>()),
    );
    card.answer = format!(
        "The style read from a drive alone explains {:.0}% of how the scores of {} drivers differ (first model).",
        100.0 * shown.adb.unwrap_or(0.0).powi(2),
        shown.n
    );
    format!("Shown if for every model the correlation of the score with “{}” is above 0 (95% interval); fails if below.", shown.reading)
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
        .map(|a| IntervalRow::new(a.reading, a.adb, a.adb_interval));
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

fn safe(found: &Validated) -> Card {
    let drives: usize = found.models.iter().map(|m| m.drives).sum();
    let collisions: u32 = found.models.iter().map(|m| m.collisions).sum();
    let near: u32 = found.models.iter().map(|m| m.rule_violations).sum();
    let question = ("safe", "Does the car stay clear of others?");
    let (mut card, ends) = must_not_happen(question, (collisions as usize, drives), "rate");
    card.answer = format!(
        "{collisions} collisions and {near} moments nearer than the safety rule allows in {drives} drives."
    );
    "Shown if no drive of the car has a collision; fails if one has.".clone_into(&mut card.rule);
    card.plot = plot(
        "Drives with a collision (%)",
        "Wilson’s 95% CI",
        Some(0.0),
        vec![IntervalRow::new(
            "All models",
            (drives > 0).then(|| 100.0 * (f64::from(collisions) / drives as f64)),
            ends.map(|(l, h)| (100.0 * l, 100.0 * h)),
        )],
    );
    "The other cars are simulated and keep to their rules.".clone_into(&mut card.doubt);
    card.see = Some("exclusions".to_owned());
    card
}
