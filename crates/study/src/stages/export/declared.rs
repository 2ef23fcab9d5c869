//! What a study declares: its design, its questionnaires, and what is compared.

use super::{people::cell, pseudonym::Ids};
use crate::{
    atomic_write::{atomic_write_bytes, files_ending, read_text},
    design::{DESIGN_FILE, DesignFile},
    error::StudyError,
    once::count,
    stages::codebook::write_codebook,
    tables::{TableName, collected::SEAT, participants::Enrolled, write_rows},
};
use maveric_domain::{
    Design, Scale,
    design::{CONDITION, Condition},
};
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
    pub(super) doubt: Option<String>,
}

/// Writes `study.toml`, `scales/`, the codebook and `factors.csv`; the scenario where a car was simulated on its road, or people drove on it
/// in the seat, of which `out` has what was collected by then.
///
/// # Errors
/// [`StudyError::BadFile`] for a questionnaire or a scenario that names somebody; as [`write_rows`].
pub(super) fn write(
    out: &Path,
    study: &DesignFile,
    declared: &Declared,
    questionnaires: &[Scale],
    (ids, people): (&Ids, &[Enrolled]),
) -> Result<(), StudyError> {
    let text = declared.text.as_bytes();
    atomic_write_bytes(&out.join(DESIGN_FILE), text)?;
    let design = &study.design;
    let scales = study.resolve(&design.files().scales);
    if scales.is_dir() {
        for path in files_ending(&scales, "toml")? {
            let name = path.file_name().unwrap_or_default();
            copy(&path, &out.join("scales").join(name), ids)?;
        }
    }
    let scenario = study.resolve(&design.files().scenario);
    let is_used = design.conditions().iter().any(Condition::simulated) || out.join(SEAT).is_dir();
    if is_used && scenario.is_file() {
        copy(&scenario, &out.join(SCENARIO), ids)?;
    }
    let design = &declared.design;
    write_codebook(questionnaires, Some(design), out)?;
    write_rows(TableName::Factors, &out.join("factors.csv"), factors(design, people))
}

/// Copies a text that names nobody.
fn copy(from: &Path, to: &Path, ids: &Ids) -> Result<(), StudyError> {
    let text = read_text(from)?;
    if let Some(id) = ids.in_words(&text) {
        let problem = format!("names `{id}`, and would be given away as it is");
        return Err(StudyError::file(from, problem).with_help("take the name out of it"));
    }
    atomic_write_bytes(to, text.as_bytes())
}

impl Declared {
    /// The design without who is left out by name, without comments, and with the places of an export.
    ///
    /// # Errors
    /// [`StudyError::BadFile`] where it is none without the names in it.
    pub(super) fn new(study: &DesignFile, ids: &Ids) -> Result<Self, StudyError> {
        let path = study.path.clone().unwrap_or_default();
        let bad = |problem: String| StudyError::file(&path, problem);
        let mut table: Table =
            toml::from_str(&read_text(&path)?).map_err(|e| bad(e.to_string()))?;
        let mut head = "# As the study declared it, but for the places of its files.\n".to_owned();
        if let Some(Value::Table(exclude)) = table.get_mut("exclude") {
            for (key, one, several) in
                [("people", "person", "people"), ("drives", "drive", "drives")]
            {
                let named = exclude.remove(key);
                let n = named.as_ref().and_then(Value::as_table).map_or(0, Table::len);
                if n > 0 {
                    let left_out = count(n, one, several);
                    let comment = format!(
                        "# {left_out} left out by name ([exclude] {key}): which is not given away.\n"
                    );
                    head.push_str(&comment);
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
        Ok(Self { design, text, doubt: hides.then_some(doubt) })
    }
}

/// Takes names, and folders of this machine, out of all words below; whether there was a name.
fn cleared(value: &mut Value, ids: &Ids) -> bool {
    match value {
        Value::String(text) => {
            if Path::new(text.as_str()).is_absolute() {
                let name = PathBuf::from(&*text);
                *text = Path::new(name.file_name().unwrap_or_default()).to_slash_lossy().into();
            }
            let hidden = ids.hidden(text);
            let hides = hidden.is_some();
            *text = hidden.unwrap_or_else(|| std::mem::take(text));
            hides
        }
        Value::Array(values) => values.iter_mut().fold(false, |any, v| any | cleared(v, ids)),
        Value::Table(table) => table.iter_mut().fold(false, |any, (_, v)| any | cleared(v, ids)),
        _ => false,
    }
}

/// A level of a factor: a row of `factors.csv`.
#[derive(Serialize)]
struct FactorRow {
    factor: String,
    kind: &'static str,
    title: String,
    level: Option<String>,
    label: Option<String>,
    conditions: Option<String>,
    people: Option<usize>,
}

/// The baseline and the conditions, the factors that these cross, the factors of people with how many have each level, and the covariates.
fn factors(design: &Design, people: &[Enrolled]) -> Vec<FactorRow> {
    let row = |factor: &str, kind, level: Option<String>| FactorRow {
        title: design.factor_label(factor),
        label: level.as_ref().map(|l| design.level_label(factor, l)),
        factor: factor.to_owned(),
        kind,
        level,
        conditions: None,
        people: None,
    };
    let conditions = design.condition_ids();
    let baseline = design.baseline_id().into_iter();
    let ids = baseline.chain(conditions).map(|id| id.to_string());
    let mut rows: Vec<FactorRow> = ids.map(|id| row(CONDITION, "within", Some(id))).collect();
    for (factor, levels) in design.factors_within() {
        for level in levels.into_iter().filter(|_| factor != CONDITION) {
            let with = design.conditions().iter();
            let with = with.filter(|c| c.levels.get(&factor) == Some(&level));
            let ids: Vec<String> = with.map(|c| c.id.to_string()).collect();
            rows.push(FactorRow {
                conditions: Some(ids.join(" ")),
                ..row(&factor, "within", Some(level))
            });
        }
    }
    for factor in design.factors() {
        let mut levels: BTreeMap<String, usize> = BTreeMap::new();
        for level in people.iter().filter_map(|p| cell(p, &factor.name)) {
            *levels.entry(level).or_default() += 1;
        }
        rows.extend(levels.into_iter().map(|(level, people)| FactorRow {
            people: Some(people),
            ..row(&factor.name, "between", Some(level))
        }));
    }
    rows.extend(design.covariates().iter().map(|covariate| {
        let given = people.iter().filter_map(|p| cell(p, &covariate.column));
        FactorRow { people: Some(given.count()), ..row(&covariate.column, "covariate", None) }
    }));
    rows
}
