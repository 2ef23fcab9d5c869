//! The tables of a pipeline file: each `[[stage]]`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use toml::de::{DeTable, DeValue};

use super::commands::Commands;
use super::fan::{self, Branch};
use super::keys::{RESOURCE_KEYS, STAGE_KEYS};
use super::layers::Entry;
use super::value::{
    Located, Value, check_keys, check_name, command, position, required, string, strings,
    wrong_type,
};
use crate::PipelineError;
use crate::content::hash_of;
use crate::error::FileProblem;
use crate::params::{Param, ParamKind, Params};
use crate::paths::normalise;
use crate::stage::{FILES, Resources, Stage};

const STAGE: &str = "[[stage]]";
/// Bytes that are kept of a branch's name: it is part of names of files, which may have 255.
const LONGEST_NAME: usize = 100;

/// The stages, and what each reads if it is there.
pub(super) fn read_stages(
    entries: &[Entry<'_>],
    params: &Params,
    surroundings: Surroundings<'_>,
) -> Result<(Vec<Stage>, Vec<Vec<String>>), PipelineError> {
    let mut read = Read::default();
    for entry in entries {
        read.add(entry, params, surroundings).map_err(|at| entry.layer.error(at))?;
    }
    Ok((read.stages, read.if_there))
}

/// Where the stages run, and the program that knows its own files.
#[derive(Clone, Copy)]
pub(super) struct Surroundings<'a> {
    pub(super) root: &'a Path,
    pub(super) commands: Option<Commands>,
}

/// The stages so far, and by name the number of each and the byte where it is named.
#[derive(Default)]
struct Read {
    stages: Vec<Stage>,
    if_there: Vec<Vec<String>>,
    firsts: BTreeMap<String, (usize, usize)>,
}

impl Read {
    /// Adds the stages of one `[[stage]]`.
    fn add(
        &mut self,
        entry: &Entry<'_>,
        params: &Params,
        surroundings: Surroundings<'_>,
    ) -> Result<(), Located> {
        let DeValue::Table(table) = entry.value.get_ref() else {
            return Err(wrong_type("stage", entry.value, "a table"));
        };
        let start = entry.value.span().start;
        check_keys(table, STAGE, STAGE_KEYS)?;
        let mut substitute = |text: &str, start| {
            let value = params.substitute(text, &mut BTreeSet::new());
            value.map_err(|problem| problem.located(start))
        };
        for branch in fan::branches(table, surroundings.root, start, &mut substitute)? {
            let clash = |(name, _): &&(String, Param)| params.0.contains_key(name);
            let clash = branch.values.iter().find(clash).map(|(name, _)| name.clone());
            let (mut stage, if_there, start) =
                read_stage(table, params, branch, (start, surroundings))?;
            if let Some(name) = clash.filter(|name| stage.params.contains_key(name)) {
                return Err(FileProblem::AlsoParameter { name }.located(start));
            }
            let name = stage.name.clone();
            let mut number = 1;
            loop {
                let next = (self.stages.len(), start);
                let (first, first_at) = *self.firsts.entry(stage.name.clone()).or_insert(next);
                match self.stages.get(first) {
                    None => {
                        self.stages.push(stage);
                        self.if_there.push(if_there);
                        break;
                    }
                    Some(same) if is_same_branch(same, &stage) => break,
                    Some(same) if first_at == start && is_other_branch(same, &stage) => {
                        number += 1;
                        stage.name = format!("{name}-{number}");
                    }
                    Some(_) => {
                        let first_line = position(entry.layer.text, first_at).0;
                        return Err(FileProblem::DuplicateStage { name, first_line }.located(start));
                    }
                }
            }
        }
        Ok(())
    }
}

/// Whether two combinations of one fan-out differ though their names are spelled alike: (1, 2.3) and (1.2, 3), or `a b` and `a;b`.
fn is_other_branch(first: &Stage, other: &Stage) -> bool {
    first.family == other.family && first.params != other.params
}

/// Whether two rows of one table differ only in columns that the stage does not use.
fn is_same_branch(first: &Stage, other: &Stage) -> bool {
    first.row.is_some()
        && first.family == other.family
        && first.params == other.params
        && first.command == other.command
        && first.share == other.share
}

/// One stage, what it reads if it is there, and the byte where its name stands.
fn read_stage(
    table: &DeTable<'_>,
    params: &Params,
    branch: Branch,
    (at, surroundings): (usize, Surroundings<'_>),
) -> Result<(Stage, Vec<String>, usize), Located> {
    let name_value = required(table, "name", STAGE, at)?;
    let family = string("name", name_value)?;
    let name_at = name_value.span().start;
    check_name(&family, name_at)?;
    let with_branch;
    let params = if branch.values.is_empty() {
        params
    } else {
        with_branch = with_values(params, &branch);
        &with_branch
    };
    let mut used = BTreeSet::new();
    let cmd = required(table, "cmd", STAGE, at)?;
    let words = command(cmd, params, &mut used)?;
    if let Some((_, at)) = words
        .iter()
        .find(|(word, _)| branch.share.is_some() && word.contains(FILES) && word != FILES)
    {
        return Err(FileProblem::FilesInsideWord.located(*at));
    }
    used.remove("files");
    let command: Vec<String> = words.into_iter().map(|(word, _)| word).collect();
    if command.first().is_none_or(String::is_empty) {
        return Err(FileProblem::EmptyCommand { stage: family }.located(at));
    }
    let mut in_paths = BTreeSet::new();
    let mut paths = |key| match table.get(key) {
        Some(value) => read_paths(key, value, params, &mut in_paths),
        None => Ok(Vec::new()),
    };
    let (mut inputs, mut outputs) = (paths("inputs")?, paths("outputs")?);
    let mut if_there = Vec::new();
    let files = match surroundings.commands {
        Some(commands) => commands.files_of(surroundings.root, &command, at)?,
        None => None,
    };
    if let Some(files) = files {
        files.check("inputs", table.get("inputs"), &inputs)?;
        files.check("outputs", table.get("outputs"), &outputs)?;
        let in_path = |(_, cell): &&(String, Param)| files.has_in_path(&cell.text);
        let in_its_paths = branch.values.iter().filter(in_path);
        in_paths
            .extend(in_its_paths.map(|(name, _)| name.clone()).filter(|name| used.contains(name)));
        (inputs, outputs, if_there) = (files.inputs, files.outputs, files.if_there);
    }
    check_ids(&branch, &in_paths, at)?;
    used.append(&mut in_paths);
    let summary = match table.get("summary") {
        None => false,
        Some(value) => value
            .get_ref()
            .as_bool()
            .ok_or_else(|| wrong_type("summary", value, "true or false"))?,
    };
    let text = |key| table.get(key).map(|value| string(key, value)).transpose();
    // How to get a file is no part of what outputs are made from: its parameters do not count.
    let help = text("inputs_help")?
        .map(|help| params.substitute(&help, &mut BTreeSet::new()))
        .transpose()
        .map_err(|problem| problem.located(at))?;
    let value_of = |name: &String| {
        let value = params.substitute(&format!("{{{name}}}"), &mut BTreeSet::new());
        value.map(|value| (name.clone(), value))
    };
    let values = used.iter().map(value_of).collect::<Result<_, _>>();
    let values: BTreeMap<String, String> = values.map_err(|problem| problem.located(at))?;
    let stage = Stage {
        name: name_of(&family, &branch, &used, &values, at)?,
        family,
        command,
        inputs,
        outputs,
        params: values,
        version: text("version")?,
        summary,
        inputs_help: help,
        share: branch.share,
        row: branch.row,
        retries: match table.get("retries") {
            Some(value) => fan::count("retries", value)?,
            None => 0,
        },
        resources: read_resources(table)?,
    };
    Ok((stage, if_there, name_at))
}

/// Refuses a cell that stands in a path and could lead anywhere else.
fn check_ids(branch: &Branch, in_paths: &BTreeSet<String>, at: usize) -> Result<(), Located> {
    let Some(row) = &branch.row else {
        return Ok(());
    };
    let is_id = |value: &str| {
        let plain = |c: char| c.is_alphanumeric() || "_-.".contains(c);
        !value.is_empty() && value != "." && !value.contains("..") && value.chars().all(plain)
    };
    let bad = |(name, cell): &&(String, Param)| in_paths.contains(name) && !is_id(&cell.text);
    match branch.values.iter().find(bad) {
        None => Ok(()),
        Some((column, cell)) => Err(FileProblem::NotAnId {
            column: column.clone(),
            value: cell.text.clone(),
            table: row.table.clone(),
            line: row.line,
        }
        .located(at)),
    }
}

fn with_values(params: &Params, branch: &Branch) -> Params {
    let mut params = params.clone();
    for (name, value) in &branch.values {
        // A parameter of the same name is refused where it is used.
        params.0.insert(name.clone(), value.clone());
    }
    if branch.share.is_some() {
        let kind = ParamKind::Text;
        let text = format!("{{{FILES}}}");
        params.0.insert("files".to_owned(), Param { kind, text });
    }
    params
}

/// The name of one branch: that of the stage and the values that set it apart.
fn name_of(
    family: &str,
    branch: &Branch,
    used: &BTreeSet<String>,
    values: &BTreeMap<String, String>,
    at: usize,
) -> Result<String, Located> {
    if branch.distinct && !branch.values.iter().any(|(name, _)| used.contains(name)) {
        return Err(FileProblem::NoColumnUsed {
            columns: branch.values.iter().map(|(name, _)| name.clone()).collect(),
        }
        .located(at));
    }
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
    let mut name = family.to_owned();
    let mut spelled = Vec::new();
    for (key, value) in &branch.values {
        let told_apart = key == "shard" || !branch.distinct || used.contains(key);
        if key == "shards" || !told_apart {
            continue;
        }
        let value = values.get(key).unwrap_or(&value.text);
        spelled.push(value.as_str());
        name.push('.');
        name.extend(value.chars().map(|c| if plain(c) { c } else { '_' }));
    }
    if name.len() > LONGEST_NAME {
        let hash = hash_of(spelled.join("\n").as_bytes());
        name.truncate(LONGEST_NAME.max(family.len() + 1));
        name.push('-');
        name.push_str(&hash[..8]);
    }
    Ok(name)
}

fn read_resources(table: &DeTable<'_>) -> Result<Resources, Located> {
    let Some(value) = table.get("resources") else {
        return Ok(Resources::default());
    };
    let DeValue::Table(asked) = value.get_ref() else {
        return Err(wrong_type("resources", value, "a table"));
    };
    check_keys(asked, "resources", RESOURCE_KEYS)?;
    let count = |key| asked.get(key).map(|value| fan::count(key, value)).transpose();
    Ok(Resources {
        cpus: count("cpus")?,
        memory_mb: count("memory_mb")?,
        minutes: count("minutes")?,
    })
}

fn read_paths(
    key: &str,
    value: &Value<'_>,
    params: &Params,
    used: &mut BTreeSet<String>,
) -> Result<Vec<String>, Located> {
    let mut paths = Vec::new();
    for (written, at) in strings(key, value, |text, _| params.substitute(text, used))? {
        let Some(path) = normalise(&written) else {
            return Err(FileProblem::BadPath { path: written }.located(at));
        };
        if !paths.contains(&path) {
            paths.push(path);
        }
    }
    Ok(paths)
}
