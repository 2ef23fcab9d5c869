//! How many people a declared study needs: the power that a rehearsal of it found.

use crate::{atomic_write::read_json, design::DesignFile, error::StudyError};
use maveric_domain::design::{Car, Outcome};
use maveric_measures::objective;
use maveric_rehearsal::{Cell, HypothesisRate, TestRate};
use path_slash::PathExt as _;
use serde::Deserialize;
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
    let Some(path) = power.map(Path::to_owned).or(there) else {
        let on_the_dial = |car: &Option<Car>| matches!(car, Some(Car::Dial(_) | Car::Across));
        return Ok(vec![
            if design.conditions().iter().all(|c| on_the_dial(&c.car)) {
                "Not settled: no rehearsal of this design was found. `maveric rehearse --participants 12,24,48 --effects-times 1 --studies 200 \
             --out rehearsal` in its folder makes one, of people who are made up and effects that are assumed."
                .to_owned()
            } else {
                "Not settled: what a car that was recorded elsewhere does to people is not known beforehand and cannot be rehearsed. \
             `maveric stats power` gives the power for an effect that is assumed."
                .to_owned()
            },
        ]);
    };
    let rehearsed: Rehearsed = read_json(&path)?;
    let planted: Vec<&Cell> = rehearsed
        .cells
        .iter()
        .filter(|c| (c.effect_scale - 1.0).abs() < 1e-9)
        .collect();
    let mut lines = Vec::new();
    for (title, key, after_holm) in wanted(study, &planted) {
        let found: Vec<String> = planted
            .iter()
            .filter_map(|cell| {
                let test = cell.tests.iter().find(|t| t.key == key)?;
                let share = if after_holm { &test.holm } else { &test.rate };
                let share = share.as_ref()?.estimate;
                Some(format!("{share:.2} with {} people", cell.participants))
            })
            .collect();
        if !found.is_empty() {
            lines.push(format!("Power, {title}: {}.", found.join(", ")));
        }
    }
    for (at, hypothesis) in design.hypotheses().iter().enumerate() {
        let found: Vec<String> = planted
            .iter()
            .filter_map(|cell| {
                let same = |h: &&HypothesisRate| h.says == hypothesis.says;
                let shown = cell.hypotheses.get(at).filter(same)?.shown?.estimate;
                Some(format!("{shown:.2} with {} people", cell.participants))
            })
            .collect();
        if !found.is_empty() {
            let says = &hypothesis.says;
            lines.push(format!("Power, “{says}” is shown: {}.", found.join(", ")));
        }
    }
    let Some(first) = planted.first().filter(|_| !lines.is_empty()) else {
        return Err(StudyError::BadFile {
            path,
            problem: "has no test of this design with its effects as they are planted".to_owned(),
            help: Some("rehearse this design: maveric rehearse --design FILE --effects-times 1 --participants 12,24,48".to_owned()),
        });
    };
    let note = format!(
        "By a rehearsal ({}): {} made-up studies of each size, analysed as declared here. Its effects are assumed, not known: a share of the \
         studies in which p < .05, after Holm for a contrast, or in which a hypothesis is shown by its own rule.",
        path.to_slash_lossy(),
        first.studies
    );
    lines.insert(0, note);
    let own = design.measures().iter();
    let own: Vec<&str> = own.map(|m| m.title.as_str()).collect();
    if !own.is_empty() {
        lines.push(format!(
            "Not rehearsed: {}. What moves a measure of the study's own is not known to the program; `maveric stats power` gives the power \
             for an effect that is assumed.",
            own.join(", ")
        ));
    }
    Ok(lines)
}

/// The tests to tell of: title, key, and whether its p is adjusted.
fn wanted(study: &DesignFile, cells: &[&Cell]) -> Vec<(String, String, bool)> {
    let design = &study.design;
    let title = |outcome: &str| {
        let declared = design.outcomes().iter().find(|o| o.id() == outcome);
        let label = declared.and_then(|o| o.label.clone());
        let own = || design.measure(outcome).map(|m| m.title.clone());
        let measure = || own().or_else(|| objective::find(outcome).map(|m| m.title.to_owned()));
        label.or_else(measure).unwrap_or_else(|| outcome.to_owned())
    };
    let mut outcomes: Vec<String> = design.outcomes().iter().map(Outcome::id).collect();
    if outcomes.is_empty() {
        let keys = cells.iter().flat_map(|c| &c.tests);
        let of = |t: &TestRate| {
            let inner = t.key.strip_prefix("panel.")?.strip_suffix(".omnibus")?;
            Some(inner.to_owned())
        };
        let mut seen = BTreeMap::new();
        for (at, outcome) in keys.filter_map(of).enumerate() {
            seen.entry(outcome).or_insert(at);
        }
        let mut listed: Vec<(usize, String)> = seen.into_iter().map(|(o, at)| (at, o)).collect();
        listed.sort();
        outcomes = listed.into_iter().map(|(_, outcome)| outcome).collect();
    }
    let mut tests = Vec::new();
    for outcome in &outcomes {
        tests.push((
            format!("{} over the conditions", title(outcome)),
            format!("panel.{outcome}.omnibus"),
            false,
        ));
    }
    let mut pairs: Vec<(String, [_; 2])> = Vec::new();
    if design.hypotheses().is_empty() && design.conditions().len() < 3 {
        let all = design.contrasts();
        let of = |o: &String| {
            all.iter()
                .map(|pair| (o.clone(), *pair))
                .collect::<Vec<_>>()
        };
        pairs = outcomes.iter().flat_map(of).collect();
    }
    for (outcome, [first, second]) in pairs {
        let words = format!(
            "{}, {} against {}",
            title(&outcome),
            design.label(first),
            design.label(second)
        );
        for (a, b) in [(first, second), (second, first)] {
            tests.push((words.clone(), format!("panel.{outcome}.{a}-{b}"), true));
        }
    }
    tests
}
