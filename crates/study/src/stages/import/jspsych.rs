//! jsPsych's JSON: an array of trials a session.

use super::{
    columns::{Columns, Slot, When},
    sheets::{Contents, Orders, Page, Reading},
};
use crate::error::StudyError;
use serde_json::{Map, Value};
use std::{borrow::Cow, path::Path};

type Trial = Map<String, Value>;

/// Properties that hold the participant's id where no map names one.
const PARTICIPANT: [&str; 5] = [
    "participant",
    "participant_id",
    "subject",
    "subject_id",
    "PROLIFIC_PID",
];

/// Reads the trials of one or more sessions.
///
/// # Errors
/// [`StudyError`] naming session and trial: what is no JSON of trials, nobody's answers, an id, a moment or an answer that is none.
pub(super) fn read(
    path: &Path,
    text: &str,
    columns: &Columns<'_>,
    orders: &Orders,
) -> Result<Contents, StudyError> {
    let mut contents = Contents::default();
    let reading = Reading {
        path,
        columns,
        orders,
        missing: &[],
    };
    for (number, trials) in sessions(path, text)?.iter().enumerate() {
        let session = trials.iter().find_map(|t| whose(t, columns));
        for (index, trial) in trials.iter().enumerate() {
            let Some(responses) = responses(trial) else {
                continue;
            };
            let place = format!("session {}, trial {}", number + 1, index + 1);
            let fields = fields(trial, &responses, columns, &mut contents);
            if fields.is_empty() {
                continue;
            }
            let whose = whose(trial, columns).or_else(|| session.clone()).ok_or_else(|| {
                let names = PARTICIPANT.join(", ");
                let problem = format!("{place}: does not say whose answers they are; expected a property such as {names}");
                StudyError::file(path, problem)
            })?;
            let word = |name: &str| trial.get(name).and_then(text_of);
            let moments = columns.moment_fields().into_iter();
            let page = Page {
                place,
                participant: whose,
                moment: moments
                    .into_iter()
                    .find_map(|field| Some((field, word(field)?))),
                seconds: trial
                    .get("rt")
                    .and_then(Value::as_f64)
                    .map(|ms| ms / 1000.0 / fields.len() as f64),
                fields,
                shown: true,
                // A Likert item's answer is the position of the box.
                from_zero: trial
                    .get("trial_type")
                    .is_some_and(|t| t == "survey-likert"),
            };
            contents.rows.extend(reading.rows_of(&page)?);
        }
    }
    Ok(contents)
}

/// Sessions, each an array of trials: one array, arrays one after the other, or an array of arrays.
fn sessions(path: &Path, text: &str) -> Result<Vec<Vec<Trial>>, StudyError> {
    let bad = |problem: String| StudyError::file(path, problem);
    let trials = |entries: Vec<Value>| -> Result<Vec<Trial>, StudyError> {
        let object = |trial| match trial {
            Value::Object(trial) => Ok(trial),
            Value::Array(_) => Err(bad("mixes trials and arrays of trials".to_owned())),
            other => Err(bad(format!("a trial is `{other}`, expected an object"))),
        };
        entries.into_iter().map(object).collect()
    };
    let mut sessions = Vec::new();
    for value in serde_json::Deserializer::from_str(text).into_iter::<Value>() {
        match value.map_err(|e| bad(format!("not JSON: {e}")))? {
            Value::Array(all) if all.iter().all(Value::is_array) => {
                for session in all {
                    let Value::Array(entries) = session else {
                        continue;
                    };
                    sessions.push(trials(entries)?);
                }
            }
            Value::Array(entries) => sessions.push(trials(entries)?),
            _ => return Err(bad("holds something else than arrays of trials".to_owned())),
        }
    }
    Ok(sessions)
}

/// A text or number as text.
fn text_of(value: &Value) -> Option<Cow<'_, str>> {
    match value {
        Value::String(text) => Some(text.into()),
        Value::Number(number) => Some(number.to_string().into()),
        _ => None,
    }
}

fn whose<'t>(trial: &'t Trial, columns: &Columns<'_>) -> Option<Cow<'t, str>> {
    match &columns.map.participant {
        Some(name) => text_of(trial.get(name)?),
        None => PARTICIPANT
            .iter()
            .find_map(|name| text_of(trial.get(*name)?)),
    }
}

/// The answers of a trial by name: an object, or (before version 7) its text.
fn responses(trial: &Trial) -> Option<Cow<'_, Trial>> {
    match trial.get("response").or_else(|| trial.get("responses"))? {
        Value::Object(answers) => Some(Cow::Borrowed(answers)),
        Value::String(text) => serde_json::from_str(text).ok().map(Cow::Owned),
        _ => None,
    }
}

/// The answers among a trial's responses, by their names or, where the trial names its scale, by Q0, Q1, …; other names are noted.
fn fields<'r>(
    trial: &Trial,
    responses: &'r Trial,
    columns: &Columns<'_>,
    contents: &mut Contents,
) -> Vec<(Slot, &'r str, Cow<'r, str>)> {
    let named = trial.get("scale").and_then(Value::as_str);
    let scale = columns
        .scales
        .iter()
        .position(|s| Some(s.id.as_str()) == named);
    let mut fields = Vec::new();
    for (name, value) in responses {
        let numbered = || {
            let from_zero: u32 = name.strip_prefix('Q')?.parse().ok()?;
            Some(Slot {
                scale: scale?,
                item: from_zero.checked_add(1)?,
                when: When::Unsaid,
            })
        };
        let by_name = columns.slot_of(name).and_then(Result::ok);
        let Some(slot) = by_name.or_else(numbered) else {
            contents.unused.insert(name.clone());
            continue;
        };
        let text = match value {
            Value::Null => "".into(),
            other => text_of(other).unwrap_or_else(|| other.to_string().into()),
        };
        fields.push((slot, name.as_str(), text));
    }
    fields
}
