//! jsPsych's JSON: an array of trials a session.

use super::{Found, Row, columns::ColumnMap, participant};
use crate::error::StudyError;
use maveric_domain::{Moment, Scale};
use serde_json::{Map, Value};
use std::path::Path;

type Trial = Map<String, Value>;

/// Properties that hold the participant's id where no map names one.
const PARTICIPANT: [&str; 5] = [
    "participant",
    "participant_id",
    "subject",
    "subject_id",
    "PROLIFIC_PID",
];

pub(super) fn read(
    path: &Path,
    text: &str,
    scales: &[Scale],
    map: &ColumnMap,
) -> Result<Found, StudyError> {
    let mut found = Found::default();
    for (number, trials) in sessions(path, text)?.iter().enumerate() {
        let whose = trials.iter().find_map(|t| whose(t, map));
        for (index, trial) in trials.iter().enumerate() {
            let place = format!("session {}, trial {}", number + 1, index + 1);
            read_trial(
                path,
                &place,
                trial,
                whose.as_deref(),
                scales,
                map,
                &mut found,
            )?;
        }
    }
    Ok(found)
}

/// Sessions, each an array of trials: one array, arrays one after the other, or an array of arrays.
fn sessions(path: &Path, text: &str) -> Result<Vec<Vec<Trial>>, StudyError> {
    let mut sessions = Vec::new();
    for value in serde_json::Deserializer::from_str(text).into_iter::<Value>() {
        let value = value.map_err(|e| StudyError::file(path, format!("not JSON: {e}")))?;
        let Value::Array(entries) = value else {
            return Err(StudyError::file(
                path,
                "holds something else than arrays of trials",
            ));
        };
        if entries.iter().any(Value::is_array) {
            for session in entries {
                let Value::Array(trials) = session else {
                    return Err(StudyError::file(path, "mixes trials and arrays of trials"));
                };
                sessions.push(objects(path, trials)?);
            }
        } else {
            sessions.push(objects(path, entries)?);
        }
    }
    Ok(sessions)
}

fn objects(path: &Path, trials: Vec<Value>) -> Result<Vec<Trial>, StudyError> {
    let object = |trial| match trial {
        Value::Object(trial) => Ok(trial),
        other => Err(StudyError::file(
            path,
            format!("a trial is `{other}`, expected an object"),
        )),
    };
    trials.into_iter().map(object).collect()
}

/// A text or number as text.
fn text_of(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) => Some(number.to_string()),
        _ => None,
    }
}

fn whose(trial: &Trial, map: &ColumnMap) -> Option<String> {
    let named = map.participant.as_deref();
    let names = named.map_or_else(|| PARTICIPANT.to_vec(), |name| vec![name]);
    names.iter().find_map(|name| text_of(trial.get(*name)?))
}

/// The answers of a trial by name: an object, or (before version 7) its text.
fn responses(trial: &Trial) -> Option<Trial> {
    match trial.get("response").or_else(|| trial.get("responses"))? {
        Value::Object(answers) => Some(answers.clone()),
        Value::String(text) => serde_json::from_str(text).ok(),
        _ => None,
    }
}

fn read_trial(
    path: &Path,
    place: &str,
    trial: &Trial,
    session: Option<&str>,
    scales: &[Scale],
    map: &ColumnMap,
    found: &mut Found,
) -> Result<(), StudyError> {
    let Some(responses) = responses(trial) else {
        return Ok(());
    };
    let bad = |problem: String| StudyError::file(path, problem);
    let word = |name: &str| trial.get(name).and_then(text_of);
    let named = word("scale");
    let mut items = Vec::new();
    for (name, value) in &responses {
        let numbered = || {
            let scale = scales.iter().position(|s| Some(&s.id) == named.as_ref())?;
            let from_zero: u32 = name.strip_prefix('Q')?.parse().ok()?;
            Some((scale, from_zero.checked_add(1)?))
        };
        match map.item_of(scales, name).or_else(numbered) {
            Some((scale, item)) => items.push((scale, item, value)),
            None => {
                found.unused.insert(name.clone());
            }
        }
    }
    if items.is_empty() {
        return Ok(());
    }
    let whose = whose(trial, map).or_else(|| session.map(str::to_owned));
    let whose = whose.ok_or_else(|| {
        let names = PARTICIPANT.join(", ");
        bad(format!(
            "{place}: does not say whose answers they are; expected a property such as {names}"
        ))
    })?;
    let id = participant(path, place, &whose)?;
    let moment = match map.moment_fields().iter().find_map(|f| word(f)) {
        None => Moment::Pre,
        Some(word) => map
            .moment_of(&word)
            .map_err(|e| bad(format!("{place} (participant {id}): {e}")))?,
    };
    let seconds = trial
        .get("rt")
        .and_then(Value::as_f64)
        .map(|ms| ms / 1000.0 / items.len() as f64);
    // A Likert item's answer is the position of the box, from 0.
    let likert = trial
        .get("trial_type")
        .is_some_and(|t| t == "survey-likert");
    for (position, item, value) in items {
        let scale = &scales[position];
        let fault = |problem: String| {
            let scale = &scale.id;
            bad(format!(
                "participant {id} ({moment}), scale `{scale}`, item {item} ({place}): {problem}"
            ))
        };
        if !(1..=scale.items).contains(&item) {
            return Err(fault(format!("the scale has {} items", scale.items)));
        }
        let text = match value {
            Value::Null => String::new(),
            other => text_of(other).unwrap_or_else(|| other.to_string()),
        };
        let add = if likert { scale.min } else { 0 };
        found.rows.push(Row {
            participant: id.clone(),
            moment,
            scale: position,
            item,
            answer: map.answer_of(scale, &text, add).map_err(fault)?,
            seconds,
            place: place.to_owned(),
        });
    }
    Ok(())
}
