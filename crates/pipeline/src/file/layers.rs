//! Pipeline files that build on another one: `extends = "paper.toml"`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use toml::de::{DeTable, DeValue};

use super::keys::TOP_KEYS;
use super::value::{Located, Value, check_keys, read_params, string, wrong_type};
use crate::PipelineError;
use crate::error::{FileProblem, nearest};
use crate::params::{Params, is_name};
use crate::paths::normalise;

const TOP: &str = "the pipeline";

/// One file; the first of several is the one that was asked for, each next the one it extends.
#[derive(Clone, Copy)]
pub(super) struct Layer<'t> {
    pub(super) path: &'t Path,
    pub(super) text: &'t str,
    pub(super) table: &'t DeTable<'t>,
}

/// A `[[stage]]` and the file in which it stands.
pub(super) struct Entry<'t> {
    pub(super) layer: Layer<'t>,
    pub(super) value: &'t Value<'t>,
}

impl Layer<'_> {
    pub(super) fn error(&self, located: Located) -> PipelineError {
        located.into_error(self.text, self.path)
    }
}

/// Parses `text` and the files that it extends, then calls `then` with all of them.
pub(super) fn with_layers<T>(
    path: &Path,
    text: &str,
    above: &[Layer<'_>],
    then: &mut dyn FnMut(&[Layer<'_>]) -> Result<T, PipelineError>,
) -> Result<T, PipelineError> {
    let located = |at: Located| at.into_error(text, path);
    let document = DeTable::parse(text).map_err(|error| {
        let message = error.message().to_owned();
        let offset = error.span().map_or(0, |span| span.start);
        located(FileProblem::Syntax { message }.located(offset))
    })?;
    let table = document.get_ref();
    check_keys(table, TOP, TOP_KEYS).map_err(located)?;
    let mut layers = above.to_vec();
    layers.push(Layer { path, text, table });
    let Some(value) = table.get("extends") else {
        return then(&layers);
    };
    let base = string("extends", value).map_err(located)?;
    let base = path.parent().unwrap_or(Path::new("")).join(base);
    let refused = |problem: FileProblem| located(problem.located(value.span().start));
    let real = |path: &Path| std::fs::canonicalize(path).unwrap_or_else(|_| PathBuf::from(path));
    if layers.iter().any(|layer| real(layer.path) == real(&base)) {
        return Err(refused(FileProblem::ExtendsItself { path: base }));
    }
    let text = std::fs::read_to_string(&base).map_err(|error| {
        refused(FileProblem::NoBase { path: base.clone(), message: error.to_string() })
    })?;
    with_layers(&base, &text, &layers, then)
}

/// The parameters of all files, those of the first before those of the others.
pub(super) fn merged_params(layers: &[Layer<'_>]) -> Result<Params, PipelineError> {
    let mut merged = Params::default();
    for layer in layers.iter().rev() {
        let params = read_params(layer.table).map_err(|at| layer.error(at))?;
        for (name, mut param) in params.0 {
            if let Some(before) = merged.0.get(&name) {
                let expected = before.kind.described();
                let value = written_params(layer).and_then(|params| params.get(name.as_str()));
                match value.filter(|_| !before.kind.admits(&param.text)) {
                    Some(value) => return Err(layer.error(wrong_type(&name, value, expected))),
                    None => param.kind = before.kind,
                }
            }
            merged.0.insert(name, param);
        }
    }
    Ok(merged)
}

/// The stages of all files: one takes the place of its namesake in a file that its own
/// extends, others come after those.
pub(super) fn merged_stages<'t>(layers: &[Layer<'t>]) -> Result<Vec<Entry<'t>>, PipelineError> {
    let mut entries: Vec<Entry<'t>> = Vec::new();
    for layer in layers.iter().rev() {
        let before = entries.len();
        let names = entries.iter().enumerate();
        let names: BTreeMap<String, usize> = names
            .filter_map(|(place, entry)| Some((name_of(entry.value)?.to_owned(), place)))
            .collect();
        let mut replaced = vec![false; before];
        for value in stages_in(*layer)? {
            let entry = Entry { layer: *layer, value };
            // A second stage of the name is no replacement: it is refused where it is read.
            match name_of(value).and_then(|name| names.get(name)) {
                Some(&place) if !replaced[place] => {
                    replaced[place] = true;
                    entries[place] = entry;
                }
                _ => entries.push(entry),
            }
        }
    }
    if let ([], Some(layer)) = (&entries[..], layers.first()) {
        let stage = layer.table.get("stage");
        let offset = stage.map_or(0, |value| value.span().start);
        return Err(layer.error(FileProblem::NoStages.located(offset)));
    }
    Ok(entries)
}

fn stages_in(layer: Layer<'_>) -> Result<&[Value<'_>], PipelineError> {
    let Some(value) = layer.table.get("stage") else {
        return Ok(&[]);
    };
    let DeValue::Array(entries) = value.get_ref() else {
        let expected = "an array of tables, each headed [[stage]]";
        return Err(layer.error(wrong_type("stage", value, expected)));
    };
    Ok(entries)
}

fn written_params<'t>(layer: &Layer<'t>) -> Option<&'t DeTable<'t>> {
    match layer.table.get("params")?.get_ref() {
        DeValue::Table(params) => Some(params),
        _ => None,
    }
}

fn name_of<'t>(value: &'t Value<'t>) -> Option<&'t str> {
    match value.get_ref() {
        DeValue::Table(table) => table.get("name")?.get_ref().as_str(),
        _ => None,
    }
}

/// Adds `-VARIANT` to every parameter with which an output begins.
pub(super) fn move_roots(
    entries: &[Entry<'_>],
    stages: &[crate::Stage],
    params: &mut Params,
    variant: &str,
) -> Result<(), PipelineError> {
    if !is_name(variant) {
        let name = variant.to_owned();
        return Err(PipelineError::BadVariant { name });
    }
    let no_root = |stage: &str, output: &str| PipelineError::NoRoot {
        variant: variant.to_owned(),
        stage: stage.to_owned(),
        output: output.to_owned(),
    };
    let mut roots = BTreeSet::new();
    for entry in entries {
        let outputs = match entry.value.get_ref() {
            DeValue::Table(table) => table.get("outputs").map(Value::get_ref),
            _ => None,
        };
        // What is no array of strings is refused where the stage is read.
        let Some(DeValue::Array(outputs)) = outputs else {
            continue;
        };
        for output in outputs.iter().filter_map(|value| value.get_ref().as_str()) {
            let stage = name_of(entry.value).unwrap_or_default();
            let root = params.root_of(output);
            roots.insert(root.ok_or_else(|| no_root(stage, output))?);
        }
    }
    // Outputs that follow from a command begin with the value of a parameter of that command.
    let written = |stage: &str| {
        let mut same_stage = entries.iter().filter(|e| name_of(e.value) == Some(stage));
        same_stage
            .any(|e| matches!(e.value.get_ref(), DeValue::Table(t) if t.contains_key("outputs")))
    };
    for stage in stages.iter().filter(|stage| !written(&stage.family)) {
        for output in &stage.outputs {
            let begins = |value: &str| {
                let rest =
                    normalise(value).and_then(|v| output.strip_prefix(&v).map(str::to_owned));
                rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
            };
            let beginning = stage.params.iter().filter(|(_, value)| begins(value));
            let longest = beginning.max_by_key(|(_, value)| value.len());
            let root = longest.and_then(|(name, _)| params.root_of(&format!("{{{name}}}")));
            roots.insert(root.ok_or_else(|| no_root(&stage.name, output))?);
        }
    }
    for root in roots {
        if let Some(param) = params.0.get_mut(&root) {
            param.text = format!("{}-{variant}", param.text.trim_end_matches('/'));
        }
    }
    Ok(())
}

/// Refuses a parameter that a file adds to those it extends and that no stage uses: it is
/// most likely another one, misspelt.
pub(super) fn check_added(
    layers: &[Layer<'_>],
    stages: &[crate::Stage],
) -> Result<(), PipelineError> {
    let names = |layer: &Layer<'_>| {
        let keys = written_params(layer).into_iter().flat_map(|p| p.keys());
        keys.map(|key| (key.get_ref().to_string(), key.span().start)).collect::<Vec<_>>()
    };
    for (place, layer) in layers.iter().enumerate() {
        let below: Vec<String> =
            layers[place + 1..].iter().flat_map(names).map(|(name, _)| name).collect();
        let unused = |(name, _): &(String, usize)| {
            !below.contains(name) && !stages.iter().any(|stage| stage.params.contains_key(name))
        };
        if below.is_empty() {
            break;
        }
        if let Some((name, at)) = names(layer).into_iter().find(unused) {
            let problem = FileProblem::UnusedParameter {
                nearest: nearest(&name, below.iter().map(String::as_str)),
                name,
            };
            return Err(layer.error(Located { at, problem }));
        }
    }
    Ok(())
}
