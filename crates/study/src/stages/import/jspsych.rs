//! jsPsych's JSON: an array of trials a session.

use super::{
    columns::{Columns, Slot, When},
    sheets::{Contents, Orders, Page, Reading},
};
use crate::{error::StudyError, once::told_once};
use maveric_domain::{Moment, ParticipantId};
use serde_json::{Map, Value};
use std::{
    borrow::Cow,
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

type Trial = Map<String, Value>;

/// Properties that hold the participant's id where no map names one.
const PARTICIPANT: [&str; 5] =
    ["participant", "participant_id", "subject", "subject_id", "PROLIFIC_PID"];

/// Reads the trials of one or more sessions.
///
/// # Errors
/// [`StudyError`] naming session and trial: what is no JSON of trials, nobody's answers, an id, a moment or an answer that is none. Items of a
/// scale that nobody was asked.
pub(super) fn read(
    path: &Path,
    text: &str,
    columns: &Columns<'_>,
    orders: &Orders,
) -> Result<Contents, StudyError> {
    let mut contents = Contents::default();
    let mut unknown_scales = Vec::new();
    let reading = Reading { path, columns, orders, missing: &[] };
    for (number, trials) in sessions(path, text)?.iter().enumerate() {
        let session = trials.iter().find_map(|t| whose(t, columns));
        for (index, trial) in trials.iter().enumerate() {
            let Some(responses) = responses(trial) else {
                continue;
            };
            let place = format!("session {}, trial {}", number + 1, index + 1);
            let fields = fields(trial, &responses, columns, &mut contents);
            if let Some(id) = unknown_scale(trial, &responses, columns) {
                let trial = format!("{} of session {}", index + 1, number + 1);
                let what = format!("its `scale` is `{id}`, which is none of the study's: not read");
                unknown_scales.push((trial, what));
            }
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
                moment: moments.into_iter().find_map(|field| Some((field, word(field)?))),
                seconds: trial
                    .get("rt")
                    .and_then(Value::as_f64)
                    .map(|ms| ms / 1000.0 / fields.len() as f64),
                fields,
                shown: true,
                // A Likert item's answer is the position of the box.
                from_zero: trial.get("trial_type").is_some_and(|t| t == "survey-likert"),
            };
            contents.rows.extend(reading.rows_of(&page)?);
        }
    }
    contents.warnings.extend(told_once("trial", unknown_scales));
    whole_sheets(path, columns, &mut contents)?;
    Ok(contents)
}

/// The scale that a trial names for its numbered questions, where the study has none of that id.
fn unknown_scale<'t>(
    trial: &'t Trial,
    responses: &Trial,
    columns: &Columns<'_>,
) -> Option<&'t str> {
    let id = trial.get("scale").and_then(Value::as_str)?;
    let is_known = columns.scales.iter().any(|scale| scale.id == id);
    let numbered = |name: &String| item_of(name).is_some() && columns.slot_of(name).is_none();
    (!is_known && responses.keys().any(numbered)).then_some(id)
}

/// The item of a question that has a number alone: Q0 is the first.
fn item_of(name: &str) -> Option<u32> {
    let from_zero: u32 = name.strip_prefix('Q')?.parse().ok()?;
    from_zero.checked_add(1)
}

/// Holds the items that were asked against those of their scales: what one sheet lacks and others have is told.
///
/// # Errors
/// [`StudyError::BadFile`] for items of a scale that no sheet has.
fn whole_sheets(
    path: &Path,
    columns: &Columns<'_>,
    contents: &mut Contents,
) -> Result<(), StudyError> {
    let mut sheets: BTreeMap<(usize, &ParticipantId, Moment), BTreeSet<u32>> = BTreeMap::new();
    for row in &contents.rows {
        let sheet = (row.scale, &row.participant, row.moment);
        sheets.entry(sheet).or_default().insert(row.item);
    }
    let mut by_scale: BTreeMap<usize, BTreeSet<u32>> = BTreeMap::new();
    for ((scale, ..), items) in &sheets {
        by_scale.entry(*scale).or_default().extend(items);
    }
    let lacking = |scale: usize, items: &BTreeSet<u32>| {
        let numbers = 1..=columns.scales[scale].count();
        let lacking = numbers.filter(|item| !items.contains(item));
        let lacking: Vec<String> = lacking.map(|item| item.to_string()).collect();
        (!lacking.is_empty()).then(|| lacking.join(", "))
    };
    for (scale, items) in &by_scale {
        if let Some(items) = lacking(*scale, items) {
            let id = &columns.scales[*scale].id;
            let problem = format!("scale `{id}`: no trial asks items {items}");
            return Err(StudyError::file(path, problem));
        }
    }
    let short = sheets.iter().filter_map(|((scale, who, moment), items)| {
        let items = lacking(*scale, items)?;
        let id = &columns.scales[*scale].id;
        let what = format!("scale `{id}` without items {items}, which count as not answered");
        Some((format!("{who} ({moment})"), what))
    });
    let short = told_once("sheet", short);
    contents.warnings.extend(short);
    Ok(())
}

/// Sessions, each an array of trials: one array, arrays one after the other, or an array of arrays.
fn sessions(path: &Path, text: &str) -> Result<Vec<Vec<Trial>>, StudyError> {
    let bad = |problem: String| {
        let help = "save what jsPsych collected as JSON: `jsPsych.data.get().json()`";
        StudyError::file(path, problem).with_help(help)
    };
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
        None => PARTICIPANT.iter().find_map(|name| text_of(trial.get(*name)?)),
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
    let scale = columns.scales.iter().position(|s| Some(s.id.as_str()) == named);
    let mut fields = Vec::new();
    for (name, value) in responses {
        let numbered = || Some(Slot { scale: scale?, item: item_of(name)?, when: When::Unsaid });
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
