//! What became of the questions that rehearsals and validations ask: which rates, shares and intervals decide, and by which rule.

use crate::{
    leave_out::{By, Direction, Order, Whose},
    power::POWER,
    rates::{ALPHA, Cell, FamilyRate, TestRate},
    validation::{Agreement, Dial, Fidelity, Identification, Metric, Reading, mean},
};
use maveric_analysis::{Finding, Part, Question};
use maveric_domain::design::Sign;
use maveric_stats::{Proportion, proportion};

/// Is anything found where there is nothing? Every family has to be kept at its level after Holm.
pub fn families(cell: &Cell) -> Finding {
    let part =
        |f: &FamilyRate| Part::share(&f.family, cell.studies, f.any_holm.as_ref(), (0.0, ALPHA));
    Finding::every(Question::Families, cell.families.iter().map(part).collect())
}

/// Is each test as strict as it says? At most one in twenty may look too lax by its own interval.
pub fn single(cell: &Cell) -> Finding {
    let rates: Vec<&Proportion> = cell.tests.iter().filter_map(|t| t.rate.as_ref()).collect();
    let above = rates.iter().filter(|rate| rate.low > ALPHA).count();
    let share = proportion(above, rates.len().max(1), 0.95).ok();
    let part = Part::share("tests above .05", rates.len(), share.as_ref(), (0.0, ALPHA));
    Finding::every(Question::Single, vec![part])
}

/// Would studies of this size show what is there? Each declared hypothesis has to be shown in more than [`POWER`] of them; without any, of
/// each part of the analysis the test that most studies found, which flatters.
pub fn power(cell: &Cell) -> Finding {
    let part = |of: &str, share: Option<&Proportion>| {
        // A question that no study could judge is as one of too few.
        let judged = share.map_or(cell.studies.min(1), |_| cell.studies);
        Part::share(of, judged, share, (POWER, f64::INFINITY))
    };
    let parts = if cell.hypotheses.is_empty() {
        let best = cell.best_tests().into_iter();
        best.map(|t: &TestRate| {
            let of = format!("{}: {}", t.part.title(), t.about);
            part(&of, t.rate.as_ref())
        })
        .collect()
    } else {
        let declared = cell.hypotheses.iter();
        declared.map(|h| part(&h.says, h.shown.as_ref())).collect()
    };
    Finding::every(Question::Power, parts)
}

/// A number over several models: mean, lowest and highest; nothing where no model has it.
pub fn over_models(values: impl IntoIterator<Item = Option<f64>>) -> Option<(f64, (f64, f64))> {
    let values: Vec<f64> = values.into_iter().flatten().collect();
    let low = values.iter().copied().reduce(f64::min)?;
    let high = values.iter().copied().reduce(f64::max)?;
    Some((mean(&values)?, (low, high)))
}

/// Is the car like its driver? In every measure the least accurate model has to be above guessing the average driver.
pub fn own_style(models: &[&[Fidelity]]) -> Finding {
    let first = models.first().copied().unwrap_or_default();
    let part = |(k, row): (usize, &Fidelity)| {
        let over = |number: fn(&Fidelity) -> Option<f64>| {
            over_models(models.iter().map(|m| m.get(k).and_then(number)))
        };
        let floor = over(|f| f.population_mean).map_or(f64::NEG_INFINITY, |(mean, _)| mean);
        let (mean, range) = over(|f| f.mimic).unzip();
        Part::within(row.title, row.n, (mean, range), (floor, f64::INFINITY))
    };
    Finding::every(Question::OwnStyle, first.iter().enumerate().map(part).collect())
}

/// The way of telling drivers apart that decides: by a distance that knows how people vary from day to day.
pub fn deciding(identity: &[Identification]) -> Option<&Identification> {
    let by_days = |i: &&Identification| i.metric == Metric::WithinPerson;
    identity.iter().find(by_days).or(identity.first())
}

/// Is a driver recognised on another day? For every model more often than by chance.
pub fn recognised(models: &[&[Identification]]) -> Option<Finding> {
    let part = |i: &Identification| {
        let chance = 1.0 / i.n.max(1) as f64;
        let interval = Some((i.low, i.high));
        Part::within(i.what, i.n, (Some(i.rate), interval), (chance, f64::INFINITY))
    };
    let parts: Vec<Part> = models.iter().filter_map(|m| deciding(m)).map(part).collect();
    (!parts.is_empty()).then(|| Finding::every(Question::Recognised, parts))
}

/// Does the dial do as it says? For every model, measure and side more than half of the drivers have to change the right way.
pub fn dial(models: &[&[Dial]]) -> Finding {
    let rows = models.iter().copied().flatten();
    let sides = rows.flat_map(|d| [(d, "+", &d.aggressive), (d, "-", &d.cautious)]);
    let part = |(d, side, right): (&Dial, &str, &crate::validation::Right)| {
        let share = proportion(right.right, right.n, 0.95).ok();
        let key = format!("{} {side}", d.title);
        Part::share(key, right.n, share.as_ref(), (0.5, f64::INFINITY))
    };
    Finding::every(Question::Dial, sides.map(part).collect())
}

/// Does driving alone tell the score? For every model the correlation of the fit without it has to be above 0.
pub fn style(models: &[&[Agreement]]) -> Option<Finding> {
    let alone = |m: &&[Agreement]| m.iter().find(|a| a.reading == Reading::WithoutScore).cloned();
    let part = |a: Agreement| {
        let estimate = (a.adb, a.adb_interval);
        Part::within(a.reading.title(), a.n, estimate, (0.0, f64::INFINITY))
    };
    let parts: Vec<Part> = models.iter().filter_map(alone).map(part).collect();
    (!parts.is_empty()).then(|| Finding::every(Question::Style, parts))
}

/// Does the car stay clear of others? One collision in one of its drives is enough to fail.
pub fn safe(collisions: usize, drives: usize) -> Finding {
    let part = Part::never("collision", collisions, drives);
    Finding::every(Question::Safe, vec![part])
}

/// Are drives of people whom the model has not met placed as they were told to drive? Every order by the p of exchanged roles.
pub fn ordered(orders: &[&Order]) -> Finding {
    let part = |order: &&Order| {
        let line = order.by(By::Line)?;
        let chance = order.chance;
        let above = line.share.map(|share| share.estimate - chance);
        // The p of the side on which it came out.
        let p = match above {
            Some(above) if above < 0.0 => line.p_below,
            _ => line.p,
        };
        let interval = line.share.map(|s| (s.low - chance, s.high - chance));
        let part = Part::directed(order.asked.title(), line.n, (above, p), Sign::Plus);
        Some(part.with_interval(interval))
    };
    Finding::every(Question::Order, orders.iter().filter_map(part).collect())
}

/// Does the line say more than speed alone? In every order the paired difference of the two, in spreads between people, has to lie
/// above 0.
pub fn beyond_speed(orders: &[&Order]) -> Finding {
    let part = |order: &&Order| {
        let beyond = order.by(By::Line)?.beyond_speed;
        let interval = beyond.and_then(|b| b.low.zip(b.high));
        let estimate = (beyond.map(|b| b.mean), interval);
        let n = beyond.map_or(0, |b| b.n);
        let ends = (0.0, f64::INFINITY);
        Some(Part::within(order.asked.title(), n, estimate, ends))
    };
    Finding::every(Question::BeyondSpeed, orders.iter().filter_map(part).collect())
}

/// Is a driver whom the model has not met recognised in another drive? By the style more often than by chance.
pub fn recognised_unmet<'a>(rows: impl IntoIterator<Item = &'a Whose>) -> Finding {
    let by_style = rows.into_iter().filter(|w| w.by == By::Line);
    let part = |w: &Whose| {
        let key = format!("{} among {}", w.sought, w.among);
        Part::share(key, w.n, w.share.as_ref(), (w.chance, f64::INFINITY))
    };
    Finding::every(Question::Recognised, by_style.map(part).collect())
}

/// Does the dial point where people themselves go? Better than directions drawn in style space.
pub fn pointed(directions: &[&Direction]) -> Finding {
    let part = |d: &&Direction| {
        let better = d.dial.zip(d.drawn).map(|(dial, drawn)| dial - drawn);
        // The p of the side on which it came out.
        let p = match better {
            Some(better) if better < 0.0 => d.p_below,
            _ => d.p,
        };
        Part::directed("dial - directions", d.n, (better, p), Sign::Plus)
    };
    Finding::every(Question::Direction, directions.iter().map(part).collect())
}

#[cfg(test)]
mod tests;
