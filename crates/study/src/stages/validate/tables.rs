//! What was found, over all models, as tables.

use super::{
    Across, Dial, Examined, FULL, Held, MEASURES, Retest, ShareOfPeople, Validate, mean, title,
};
use crate::error::StudyError;
use maveric_pages::{PageTexts, VALIDATION};
use maveric_rehearsal::findings::over_models;
use maveric_report::{Context, figures::fidelity::Accuracy, tables::Table};
use maveric_stats::Proportion;
use serde::Serialize;
use std::collections::BTreeMap;

/// What the texts of the page may ask for.
#[derive(Serialize)]
struct Words<'a> {
    synthetic: bool,
    preface: &'a str,
    /// In which unit figures show speeds.
    speed: &'static str,
    drivers: usize,
    models: usize,
    /// Files that hold them: more where some hold the same one.
    files: usize,
    worlds: usize,
    points: f64,
    full: f64,
    steps: &'a [f64],
    measures: Vec<&'static str>,
    /// Drivers among whom the own one is sought.
    among: usize,
    errors: Option<&'a Held>,
    days_of: Option<usize>,
    /// Share of the dial's embeddings further out than any training driver.
    beyond: f64,
    /// The largest change of S by moving across the dial.
    largest: String,
}

/// The texts of a validation of these models.
pub(super) fn texts(
    models: &[Examined],
    options: &Validate,
    (drivers, synthetic): (usize, bool),
) -> Result<PageTexts, StudyError> {
    let one = models.first();
    let beyond: Vec<f64> = models.iter().filter_map(|m| m.beyond_training).collect();
    let moves = models.iter().map(|m| m.perpendicular_moves_s);
    let context = Context::of(synthetic, options.seed);
    let words = Words {
        synthetic,
        preface: context.preface(),
        speed: context.speed.name(),
        drivers,
        models: models.len(),
        files: models.iter().map(|m| 1 + m.same.len()).sum(),
        worlds: options.worlds,
        points: options.points,
        full: FULL,
        steps: one.map_or(&[], |m| &m.steps),
        measures: (0..MEASURES.len()).map(title).collect(),
        among: one.and_then(|m| m.identity.first()).map_or(0, |r| r.n),
        errors: one.map(|m| &m.errors),
        days_of: one.and_then(|m| m.days_of),
        beyond: mean(&beyond).unwrap_or(0.0),
        largest: match moves.fold(0.0, f64::max) {
            // What a step of the dial leaves by rounding is nothing.
            rounding if rounding < 1e-9 => "0".to_owned(),
            moved => format!("{moved:.1e}"),
        },
    };
    Ok(PageTexts::new(VALIDATION, &words)?)
}

/// Mean, lowest and highest over the models that have a value.
pub(super) fn over<T>(models: &[T], value: impl Fn(&T) -> Option<f64>) -> Option<Accuracy> {
    let (mean, (low, high)) = over_models(models.iter().map(value))?;
    Some(Accuracy { mean, low, high })
}

/// A thing that every model was asked, as the first one answers, with the answers of all; `more` is of this row alone.
#[derive(Serialize)]
struct Row<'a, T, More> {
    #[serde(flatten)]
    first: &'a T,
    over: Vec<&'a T>,
    #[serde(flatten)]
    more: More,
}

fn rows<'a, T, More>(
    models: &'a [Examined],
    answers: impl Fn(&'a Examined) -> &'a [T],
    more: impl Fn(&[&'a T]) -> More,
) -> Vec<Row<'a, T, More>> {
    let first = models.first().map_or(&[][..], &answers).iter().enumerate();
    let row = |(index, first)| {
        let over: Vec<&T> = models.iter().map(|m| &answers(m)[index]).collect();
        let more = more(&over);
        Row { first, over, more }
    };
    first.map(row).collect()
}

/// Nothing more of a row.
#[derive(Serialize)]
struct Nothing {}

fn nothing<T>(_: &[&T]) -> Nothing {
    Nothing {}
}

/// All tables over `models`, which were examined on the same people.
pub(super) fn tables(
    models: &[Examined],
    retested: &[Retest],
    texts: &PageTexts,
) -> Result<Vec<Table>, StudyError> {
    let Some(one) = models.first() else {
        return Ok(Vec::new());
    };
    let hit_interval =
        |over: &[&super::Identification]| BTreeMap::from([("interval", interval_of(over))]);
    Ok(vec![
        texts.table("validation-retest", retested)?,
        texts.table("validation-identity", rows(models, |m| &m.identity, hit_interval))?,
        texts.table("validation-errors", errors(models, one))?,
        texts.table("validation-fidelity", rows(models, |m| &m.fidelity, nothing))?,
        texts.table("validation-likeness", rows(models, |m| &m.likeness, nothing))?,
        texts.table(
            "validation-likeness-by-column",
            rows(models, |m| &m.likeness_by_column, nothing),
        )?,
        texts.table("validation-dial", rows(models, |m| &m.dial, with_room))?,
        texts.table("validation-perpendicular", rows(models, |m| &m.perpendicular, changes))?,
        texts.table(
            "validation-line",
            rows(models, |m| &m.line, |over| BTreeMap::from([("name", over[0].reading.title())])),
        )?,
    ])
}

/// The interval of the mean rate over the models.
fn interval_of(over: &[&super::Identification]) -> Option<Proportion> {
    let n = over.first()?.n;
    let hits: f64 = over.iter().map(|row| row.rate).sum::<f64>() / over.len() as f64 * n as f64;
    maveric_stats::proportion((hits.round() as usize).min(n), n, 0.95).ok()
}

/// Those whom the drive of a second day meets within so many standard errors.
#[derive(Serialize)]
struct ErrorRow {
    at: usize,
    shares: Vec<Option<f64>>,
    /// Of the first model, over people.
    interval: Option<(f64, f64)>,
    right: f64,
}

fn errors(models: &[Examined], one: &Examined) -> [ErrorRow; 2] {
    type Share = fn(&Held) -> Option<ShareOfPeople>;
    let row = |at, right, share: Share| ErrorRow {
        at,
        shares: models.iter().map(|m| share(&m.errors).map(|s| s.estimate)).collect(),
        interval: share(&one.errors).and_then(|s| s.interval),
        right,
    };
    [row(1, 68.3, |h| h.within_1), row(2, 95.4, |h| h.within_2)]
}

/// Shares of those who had room for it, and did as they should, of the aggressive setting.
fn with_room(over: &[&Dial]) -> BTreeMap<&'static str, Vec<Option<f64>>> {
    let share = |dial: &&Dial| {
        let n = dial.aggressive.with_room;
        (n > 0).then(|| dial.aggressive.right_with_room as f64 / n as f64)
    };
    BTreeMap::from([("with_room", over.iter().map(share).collect())])
}

/// In how many models an angle goes with the change, and how many decimals the change is read with.
fn changes(over: &[&Across]) -> BTreeMap<&'static str, usize> {
    let small = over.iter().filter(|a| a.angle_p.is_some_and(|p| p < 0.05));
    let decimals = if over[0].measure == "left_lane_fraction" { 3 } else { 2 };
    BTreeMap::from([("small", small.count()), ("decimals", decimals)])
}
