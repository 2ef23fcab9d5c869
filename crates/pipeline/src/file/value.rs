//! Values of a TOML document, each with the place where it stands.

use std::collections::BTreeSet;
use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::keys::Key;
use crate::PipelineError;
use crate::error::{FileProblem, nearest};
use crate::params::{Param, ParamKind, Params, is_name};
use crate::shell::is_script;

pub(super) type Value<'a> = Spanned<DeValue<'a>>;

/// A problem and the byte of the text where it stands.
pub(super) struct Located {
    pub(super) at: usize,
    pub(super) problem: FileProblem,
}

impl FileProblem {
    /// At a byte of the file.
    pub(super) fn located(self, at: usize) -> Located {
        Located { at, problem: self }
    }
}

impl Located {
    pub(super) fn into_error(self, text: &str, path: &Path) -> PipelineError {
        let (line, column) = position(text, self.at);
        PipelineError::Malformed {
            path: path.to_owned(),
            line,
            column,
            problem: Box::new(self.problem),
        }
    }
}

/// Line and column, both from 1, of a byte.
pub(super) fn position(text: &str, byte: usize) -> (usize, usize) {
    let before = text.get(..byte).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = before.matches('\n').count() + 1;
    (line, before[line_start..].chars().count() + 1)
}

pub(super) fn check_keys(
    table: &DeTable<'_>,
    described: &'static str,
    keys: &'static [Key],
) -> Result<(), Located> {
    let known: Vec<&'static str> = keys.iter().map(|key| key.name).collect();
    let unknown = table
        .keys()
        .filter(|key| !known.contains(&key.get_ref().as_ref()))
        .min_by_key(|key| key.span().start);
    unknown.map_or(Ok(()), |key| {
        Err(FileProblem::UnknownKey {
            key: key.get_ref().to_string(),
            table: described,
            nearest: nearest(key.get_ref(), known.iter().copied()),
            known,
        }
        .located(key.span().start))
    })
}

pub(super) fn required<'t, 'i>(
    table: &'t DeTable<'i>,
    key: &'static str,
    described: &'static str,
    at: usize,
) -> Result<&'t Value<'i>, Located> {
    table.get(key).ok_or(FileProblem::MissingKey { key, table: described }.located(at))
}

pub(super) fn check_name(name: &str, at: usize) -> Result<(), Located> {
    if is_name(name) {
        return Ok(());
    }
    let name = name.to_owned();
    Err(FileProblem::BadName { name }.located(at))
}

/// The strings of an array, each with the byte where it stands; `substitute` puts parameters in, given those before it.
pub(super) fn strings(
    key: &str,
    value: &Value<'_>,
    mut substitute: impl FnMut(&str, &[(String, usize)]) -> Result<String, FileProblem>,
) -> Result<Vec<(String, usize)>, Located> {
    let DeValue::Array(entries) = value.get_ref() else {
        return Err(wrong_type(key, value, "an array of strings"));
    };
    let mut texts: Vec<(String, usize)> = Vec::with_capacity(entries.len());
    for entry in entries {
        let start = entry.span().start;
        let text = substitute(&string(key, entry)?, &texts);
        texts.push((text.map_err(|problem| problem.located(start))?, start));
    }
    Ok(texts)
}

/// The words of a command line, parameters put in, each with the byte where it stands; inside
/// the script of a shell, values are quoted for the shell.
pub(super) fn command(
    value: &Value<'_>,
    params: &Params,
    used: &mut BTreeSet<String>,
) -> Result<Vec<(String, usize)>, Located> {
    strings("cmd", value, |text, before| {
        if text.contains('{') && is_script(before.iter().map(|(word, _)| word.as_str())) {
            params.substitute_in_script(text, used)
        } else {
            params.substitute(text, used)
        }
    })
}

pub(super) fn string(key: &str, value: &Value<'_>) -> Result<String, Located> {
    value.get_ref().as_str().map(str::to_owned).ok_or_else(|| wrong_type(key, value, "a string"))
}

pub(super) fn wrong_type(key: &str, value: &Value<'_>, expected: &'static str) -> Located {
    let type_name = match value.get_ref() {
        DeValue::Integer(_) => "an integer".to_owned(),
        DeValue::Array(_) => "an array".to_owned(),
        other => format!("a {}", other.type_str()),
    };
    FileProblem::WrongType { key: key.to_owned(), found: type_name, expected }
        .located(value.span().start)
}

/// The parameters of a file.
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

/// One value that a parameter may have.
pub(super) fn read_param(name: &str, value: &Value<'_>) -> Result<Param, Located> {
    let (kind, text) = match value.get_ref() {
        DeValue::String(text) => (ParamKind::Text, text.to_string()),
        DeValue::Integer(number) if number.radix() == 10 => {
            (ParamKind::Integer, number.as_str().to_owned())
        }
        DeValue::Float(number) => (ParamKind::Float, number.as_str().to_owned()),
        DeValue::Boolean(truth) => (ParamKind::Boolean, truth.to_string()),
        _ => {
            return Err(wrong_type(name, value, "a string, a decimal number or a boolean"));
        }
    };
    Ok(Param { kind, text })
}
