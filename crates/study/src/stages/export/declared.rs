//! What a study declares: its design, its questionnaires, and what is compared.

use super::{outcomes::crossed, people::cell, pseudonym::Ids};
use crate::{
    atomic_write::{atomic_write_bytes, read_text},
    design::{DESIGN_FILE, DesignFile},
    error::StudyError,
    once::count,
    run_folder::read_scales,
    stages::codebook::write_codebook,
    tables::{TableName, participants::Enrolled, write_rows},
};
use maveric_domain::{ConditionId, Design};
use path_slash::PathExt as _;
use serde::Serialize;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use toml::{Table, Value};

/// Where the parts of a study lie in an export.
const FILES: [(&str, &str); 4] = [
    ("logs", "logs"),
    ("answers", "surveys.csv"),
    ("measures", "measures.csv"),
    ("scales", "scales"),
];
/// Files of a study that are not given away, or not needed for what is.
const NOT_GIVEN: [&str; 5] = ["mapping", "software", "columns", "claims", "effects"];
const SCENARIO: &str = "scenario.toml";

/// A design that names nobody.
pub(super) struct Declared {
    pub(super) design: Design,
    text: String,
    /// What to know of it.
    pub(super) doubt: Option<String>,
}

/// Writes `study.toml`, `scales/`, the scenario, the codebook and `factors.csv`.
///
/// # Errors
/// [`StudyError::BadFile`] for a questionnaire or a scenario that names somebody; as [`read_scales`] and [`write_rows`].
pub(super) fn write(
    out: &Path,
    study: &DesignFile,
    declared: &Declared,
    ids: &Ids,
    people: &[Enrolled],
) -> Result<(), StudyError> {
    let text = declared.text.as_bytes();
    atomic_write_bytes(&out.join(DESIGN_FILE), text)?;
    let design = &study.design;
    let scales = study.resolve(&design.files().scales);
    let mut questionnaires = Vec::new();
    if scales.is_dir() {
        questionnaires = read_scales(&scales)?;
        let entries = std::fs::read_dir(&scales).map_err(StudyError::read(&scales))?;
        for entry in entries {
            let path = entry.map_err(StudyError::read(&scales))?.path();
            if path.extension().is_some_and(|e| e == "toml") {
                copy(
                    &path,
                    &out.join("scales")
                        .join(path.file_name().unwrap_or_default()),
                    ids,
                )?;
            }
        }
    }
    let scenario = study.resolve(&design.files().scenario);
    if scenario.is_file() {
        copy(&scenario, &out.join(SCENARIO), ids)?;
    }
    let design = &declared.design;
    write_codebook(&questionnaires, Some(design), out)?;
    write_rows(
        TableName::Factors,
        &out.join("factors.csv"),
        factors(design, people),
    )
}

/// Copies a text that names nobody.
fn copy(from: &Path, to: &Path, ids: &Ids) -> Result<(), StudyError> {
    let text = read_text(from)?;
    if let Some(id) = ids.in_words(&text) {
        return Err(StudyError::BadFile {
            path: from.to_owned(),
            problem: format!("names `{id}`, and would be given away as it is"),
            help: Some("take the name out of it".to_owned()),
        });
    }
    atomic_write_bytes(to, text.as_bytes())
}

impl Declared {
    /// The design without who is left out by name, without comments, and with the places of an export.
    ///
    /// # Errors
    /// [`StudyError::BadFile`] where it is none without the names in it.
    pub(super) fn of(study: &DesignFile, ids: &Ids) -> Result<Self, StudyError> {
        let path = study.path.clone().unwrap_or_default();
        let bad = |problem: String| StudyError::file(&path, problem);
        let mut table: Table =
            toml::from_str(&read_text(&path)?).map_err(|e| bad(e.to_string()))?;
        let mut head = "# As the study declared it, but for the places of its files.\n".to_owned();
        if let Some(Value::Table(exclude)) = table.get_mut("exclude") {
            for (key, one, several) in [
                ("people", "person", "people"),
                ("drives", "drive", "drives"),
            ] {
                let named = exclude.remove(key);
                let n = named
                    .as_ref()
                    .and_then(Value::as_table)
                    .map_or(0, Table::len);
                if n > 0 {
                    let left_out = count(n, one, several);
                    head += &format!(
                        "# {left_out} left out by name ([exclude] {key}): which is not given away.\n"
                    );
                }
            }
        }
        let files = table.entry("files").or_insert_with(|| Table::new().into());
        if let Value::Table(files) = files {
            for key in NOT_GIVEN {
                files.remove(key);
            }
            for (key, place) in FILES {
                files.insert(key.to_owned(), place.into());
            }
            files.insert("scenario".to_owned(), SCENARIO.into());
        }
        let people = table.entry("people").or_insert_with(|| Table::new().into());
        if let Value::Table(people) = people {
            people.insert("file".to_owned(), "participants.csv".into());
        }
        let mut hides = false;
        for (_, value) in &mut table {
            hides |= cleared(value, ids);
        }
        let text = head + "\n" + &toml::to_string(&table).map_err(|e| bad(e.to_string()))?;
        let design = Design::from_toml(&text);
        let design = design
            .map_err(|e| bad(format!("cannot be given away without the names in it: {e}")))?;
        let doubt = "words of study.toml that name somebody are `…` in the export".to_owned();
        Ok(Self {
            design,
            text,
            doubt: hides.then_some(doubt),
        })
    }
}

/// Takes names, and folders of this machine, out of all words below; whether there was a name.
fn cleared(value: &mut Value, ids: &Ids) -> bool {
    match value {
        Value::String(text) => {
            if Path::new(text.as_str()).is_absolute() {
                let name = PathBuf::from(&*text);
                *text = Path::new(name.file_name().unwrap_or_default())
                    .to_slash_lossy()
                    .into();
            }
            let hidden = ids.hidden(text);
            let hides = hidden.is_some();
            *text = hidden.unwrap_or_else(|| std::mem::take(text));
            hides
        }
        Value::Array(values) => values
            .iter_mut()
            .fold(false, |any, v| any | cleared(v, ids)),
        Value::Table(table) => table
            .iter_mut()
            .fold(false, |any, (_, v)| any | cleared(v, ids)),
        _ => false,
    }
}

/// A level of a factor: a row of `factors.csv`.
#[derive(Serialize)]
struct FactorRow<'a> {
    factor: &'a str,
    kind: &'static str,
    level: Option<String>,
    label: Option<String>,
    conditions: Option<String>,
    people: Option<usize>,
}

/// The conditions, the factors that they cross, the factors of people with how many have each level, and the covariates.
fn factors<'a>(design: &'a Design, people: &[Enrolled]) -> Vec<FactorRow<'a>> {
    let within = |factor, level: String, label, conditions: &[ConditionId]| FactorRow {
        factor,
        kind: "within",
        level: Some(level),
        label,
        conditions: Some(ConditionId::listed(conditions).replace(", ", " ")),
        people: None,
    };
    let ids = design.baseline_id().into_iter();
    let mut ids: Vec<ConditionId> = ids
        .chain(design.conditions().iter().map(|c| c.id))
        .collect();
    ids.dedup();
    let one = |id: ConditionId| within("condition", id.to_string(), Some(design.label(id)), &[id]);
    let mut rows: Vec<FactorRow<'_>> = ids.into_iter().map(one).collect();
    for factor in crossed(design) {
        let mut levels: Vec<(&String, Vec<ConditionId>)> = Vec::new();
        for condition in design.conditions() {
            let Some(level) = condition.levels.get(factor) else {
                continue;
            };
            match levels.iter_mut().find(|(known, _)| *known == level) {
                Some((_, ids)) => ids.push(condition.id),
                None => levels.push((level, vec![condition.id])),
            }
        }
        let levels = levels.into_iter();
        rows.extend(levels.map(|(level, ids)| within(factor, level.clone(), None, &ids)));
    }
    let of_people = |kind, column: &'a str, label: &Option<String>| {
        let mut levels: BTreeMap<Option<String>, usize> = BTreeMap::new();
        for cell in people.iter().filter_map(|p| cell(p, column)) {
            let level = (kind == "between").then_some(cell);
            *levels.entry(level).or_default() += 1;
        }
        let row = |(level, people)| FactorRow {
            factor: column,
            kind,
            level,
            label: label.clone(),
            conditions: None,
            people: Some(people),
        };
        levels.into_iter().map(row).collect::<Vec<_>>()
    };
    let between = design.factors().iter();
    rows.extend(between.flat_map(|f| of_people("between", &f.column, &f.label)));
    let covariates = design.covariates().iter();
    rows.extend(covariates.flat_map(|c| of_people("covariate", &c.column, &c.label)));
    rows
}
