//! How many people a declared study needs: the power that a rehearsal of it found.

use crate::{atomic_write::read_json, design::DesignFile, error::StudyError};
use maveric_domain::design::Outcome;
use maveric_measures::objective;
use maveric_pages::{DECLARED, PageTexts};
use maveric_rehearsal::{Cell, HypothesisRate, TestRate, UnknownCar};
use path_slash::PathExt as _;
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, path::Path};

/// What is read of a `rehearsal.json`.
#[derive(Debug, Deserialize)]
struct Rehearsed {
    cells: Vec<Cell>,
}

/// The sentences of a preregistration about the number of participants.
///
/// # Errors
/// [`StudyError`] if the rehearsal cannot be read, or knows none of the design's tests.
pub(super) fn sample_size(
    study: &DesignFile,
    power: Option<&Path>,
) -> Result<Vec<String>, StudyError> {
    let design = &study.design;
    let usual = study.path.as_deref().and_then(Path::parent);
    let usual = usual.map(|folder| folder.join("rehearsal/rehearsal.json"));
    let there = usual.filter(|path| path.is_file());
    let texts = PageTexts::new(DECLARED, &())?;
    let Some(path) = power.map(Path::to_owned).or(there) else {
        let mut conditions = design.conditions().iter();
        let unknown = conditions.find_map(|c| Some((c, UnknownCar::of(c.car.as_ref())?)));
        return Ok(vec![match unknown {
            None => texts.text("not_rehearsed")?,
            Some((condition, why)) => {
                let label = condition.label.clone();
                let values = BTreeMap::from([("condition", label), ("why", why.to_string())]);
                texts.with(&values).text("not_known")?
            }
        }]);
    };
    let rehearsed: Rehearsed = read_json(&path)?;
    let planted: Vec<&Cell> =
        rehearsed.cells.iter().filter(|c| (c.effect_scale - 1.0).abs() < 1e-9).collect();
    let mut lines = Vec::new();
    let mut add = |what: String, share: &dyn Fn(&Cell) -> Option<f64>| -> Result<(), StudyError> {
        let shares = planted.iter().filter_map(|cell| Some((share(cell)?, cell.participants)));
        let shares: Vec<(f64, usize)> = shares.collect();
        if !shares.is_empty() {
            lines.push(texts.with(&Power { what, shares }).text("power")?);
        }
        Ok(())
    };
    for (title, key, after_holm) in wanted(study, &planted, &texts)? {
        add(title, &|cell| {
            let test = cell.tests.iter().find(|t| t.key == key)?;
            let share = if after_holm { &test.holm } else { &test.rate };
            Some(share.as_ref()?.estimate)
        })?;
    }
    for (at, hypothesis) in design.hypotheses().iter().enumerate() {
        let says = BTreeMap::from([("says", &hypothesis.says)]);
        add(texts.with(&says).text("shown")?, &|cell| {
            let same = |h: &&HypothesisRate| h.says == hypothesis.says;
            Some(cell.hypotheses.get(at).filter(same)?.shown?.estimate)
        })?;
    }
    let Some(first) = planted.first().filter(|_| !lines.is_empty()) else {
        let problem = "has no test of this design with its effects as they are planted";
        let help = "rehearse this design: maveric rehearse --design FILE --effects-times 1 --participants 12,24,48";
        return Err(StudyError::file(path, problem).with_help(help));
    };
    let values = BTreeMap::from([
        ("path", path.to_slash_lossy().into_owned()),
        ("studies", first.studies.to_string()),
    ]);
    lines.insert(0, texts.with(&values).text("rehearsed")?);
    let own_measures = design.measures().iter();
    let own_titles: Vec<&str> = own_measures.map(|m| m.title.as_str()).collect();
    if !own_titles.is_empty() {
        let texts = texts.with(&BTreeMap::from([("own", own_titles)]));
        lines.push(texts.text("own_measures")?);
    }
    Ok(lines)
}

/// The power of a test, with the sizes at which it was rehearsed.
#[derive(Serialize)]
struct Power {
    what: String,
    shares: Vec<(f64, usize)>,
}

/// The tests to tell of: title, key, and whether its p is adjusted.
fn wanted(
    study: &DesignFile,
    cells: &[&Cell],
    texts: &PageTexts,
) -> Result<Vec<(String, String, bool)>, StudyError> {
    let design = &study.design;
    let title = |outcome: &str| {
        let declared = design.outcomes().iter().find(|o| o.id() == outcome);
        let label = declared.and_then(|o| o.label.clone());
        let own_measure = || design.measure(outcome).map(|m| m.title.clone());
        let measure =
            || own_measure().or_else(|| objective::find(outcome).map(|m| m.title.to_owned()));
        label.or_else(measure).unwrap_or_else(|| outcome.to_owned())
    };
    let mut outcomes: Vec<String> = design.outcomes().iter().map(Outcome::id).collect();
    if outcomes.is_empty() {
        let keys = cells.iter().flat_map(|c| &c.tests);
        let outcome_of = |t: &TestRate| {
            let inner = t.key.strip_prefix("panel.")?.strip_suffix(".omnibus")?;
            Some(inner.to_owned())
        };
        for outcome in keys.filter_map(outcome_of) {
            if !outcomes.contains(&outcome) {
                outcomes.push(outcome);
            }
        }
    }
    let mut tests = Vec::new();
    for outcome in &outcomes {
        let values = BTreeMap::from([("title", title(outcome))]);
        tests.push((
            texts.with(&values).text("omnibus")?,
            format!("panel.{outcome}.omnibus"),
            false,
        ));
    }
    if !design.hypotheses().is_empty() || design.conditions().len() >= 3 {
        return Ok(tests);
    }
    for outcome in &outcomes {
        for [first, second] in design.contrasts() {
            let values = BTreeMap::from([
                ("title", title(outcome)),
                ("first", design.label(first)),
                ("second", design.label(second)),
            ]);
            let words = texts.with(&values).text("contrast")?;
            for (a, b) in [(first, second), (second, first)] {
                tests.push((words.clone(), format!("panel.{outcome}.{a}-{b}"), true));
            }
        }
    }
    Ok(tests)
}
