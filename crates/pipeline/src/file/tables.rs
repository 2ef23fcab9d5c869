//! The tables of a pipeline file: `[params]` and each `[[stage]]`.

use std::collections::{BTreeMap, BTreeSet};

use toml::de::{DeTable, DeValue};

use super::Stage;
use super::value::{
    Located, Value, check_keys, check_name, position, required, string, strings, wrong_type,
};
use crate::error::FileProblem;
use crate::params::{Param, ParamKind, Params};
use crate::paths::normalise;

const STAGE_KEYS: &[&str] = &["name", "cmd", "inputs", "outputs", "summary", "inputs_help"];
const STAGE: &str = "[[stage]]";

pub(super) fn read_params(table: &DeTable<'_>) -> Result<Params, Located> {
    let Some(value) = table.get("params") else {
        return Ok(Params::default());
    };
    let DeValue::Table(entries) = value.get_ref() else {
        return Err(wrong_type("params", value, "a table"));
    };
    let mut params = Params::default();
    for (key, value) in entries {
        let name = key.get_ref().to_string();
        check_name(&name, key.span().start)?;
        params.0.insert(name.clone(), read_param(&name, value)?);
    }
    Ok(params)
}

fn read_param(name: &str, value: &Value<'_>) -> Result<Param, Located> {
    let (kind, text) = match value.get_ref() {
        DeValue::String(text) => (ParamKind::Text, text.to_string()),
        DeValue::Integer(number) if number.radix() == 10 => {
            (ParamKind::Integer, number.as_str().to_owned())
        }
        DeValue::Float(number) => (ParamKind::Float, number.as_str().to_owned()),
        DeValue::Boolean(truth) => (ParamKind::Boolean, truth.to_string()),
        _ => {
            return Err(wrong_type(
                name,
                value,
                "a string, a decimal number or a boolean",
            ));
        }
    };
    Ok(Param { kind, text })
}

pub(super) fn read_stages(
    table: &DeTable<'_>,
    params: &Params,
    text: &str,
) -> Result<Vec<Stage>, Located> {
    let no_stages = |at| Located {
        at,
        problem: FileProblem::NoStages,
    };
    let value = table.get("stage").ok_or_else(|| no_stages(0))?;
    let DeValue::Array(entries) = value.get_ref() else {
        return Err(wrong_type(
            "stage",
            value,
            "an array of tables, each headed [[stage]]",
        ));
    };
    if entries.is_empty() {
        return Err(no_stages(value.span().start));
    }
    let mut stages = Vec::new();
    let mut firsts: BTreeMap<String, usize> = BTreeMap::new();
    for entry in entries {
        let DeValue::Table(stage) = entry.get_ref() else {
            return Err(wrong_type("stage", entry, "a table"));
        };
        let (stage, at) = read_stage(stage, params, entry.span().start)?;
        if let Some(first) = firsts.insert(stage.name.clone(), at) {
            let first_line = position(text, first).0;
            let name = stage.name;
            let problem = FileProblem::DuplicateStage { name, first_line };
            return Err(Located { at, problem });
        }
        stages.push(stage);
    }
    Ok(stages)
}

/// The stage, and the byte where its name stands.
fn read_stage(table: &DeTable<'_>, params: &Params, at: usize) -> Result<(Stage, usize), Located> {
    check_keys(table, STAGE, STAGE_KEYS)?;
    let name_value = required(table, "name", STAGE, at)?;
    let name = string("name", name_value)?;
    let name_at = name_value.span().start;
    check_name(&name, name_at)?;
    let mut used = BTreeSet::new();
    let command = strings("cmd", required(table, "cmd", STAGE, at)?, params, &mut used)?
        .into_iter()
        .map(|(word, _)| word)
        .collect::<Vec<_>>();
    if command.first().is_none_or(String::is_empty) {
        return Err(Located {
            at,
            problem: FileProblem::EmptyCommand { stage: name },
        });
    }
    let mut paths = |key| match table.get(key) {
        Some(value) => read_paths(key, value, params, &mut used),
        None => Ok(Vec::new()),
    };
    let (inputs, outputs) = (paths("inputs")?, paths("outputs")?);
    let summary = match table.get("summary") {
        None => false,
        Some(value) => value
            .get_ref()
            .as_bool()
            .ok_or_else(|| wrong_type("summary", value, "true or false"))?,
    };
    let inputs_help = table
        .get("inputs_help")
        .map(|value| string("inputs_help", value));
    let value_of = |name: String| {
        let value = params.substitute(&format!("{{{name}}}"), &mut BTreeSet::new());
        value.map(|value| (name, value))
    };
    let params = used.into_iter().map(value_of).collect::<Result<_, _>>();
    let stage = Stage {
        name,
        command,
        inputs,
        outputs,
        params: params.map_err(|problem| Located { at, problem })?,
        summary,
        inputs_help: inputs_help.transpose()?,
    };
    Ok((stage, name_at))
}

fn read_paths(
    key: &str,
    value: &Value<'_>,
    params: &Params,
    used: &mut BTreeSet<String>,
) -> Result<Vec<String>, Located> {
    let mut paths = Vec::new();
    for (written, at) in strings(key, value, params, used)? {
        let Some(path) = normalise(&written) else {
            let problem = FileProblem::BadPath { path: written };
            return Err(Located { at, problem });
        };
        if !paths.contains(&path) {
            paths.push(path);
        }
    }
    Ok(paths)
}
