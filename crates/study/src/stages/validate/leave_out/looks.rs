//! Who opened which recordings, and under which rules.

use super::{
    recordings::Recordings,
    rules::{Part, Rules},
};
use crate::{
    error::StudyError,
    stages::validate::Validate,
    tables::{TableName, read_rows, write_rows},
};
use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// One look at recordings; `columns.toml` says what its fields are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Look {
    pub date: String,
    pub program: String,
    pub rules: String,
    pub part: Part,
    pub people: String,
    pub roles: String,
}

/// Where looks are noted: beside the rules, so that no run takes them away.
fn looks_path(rules: &Path) -> PathBuf {
    let stem = rules.file_stem().unwrap_or_default().to_string_lossy();
    let stem = stem.strip_suffix("_rules").unwrap_or(&stem).to_owned();
    rules.with_file_name(format!("{stem}_looks.csv"))
}

/// Notes this look, unless the same recordings were opened under the same rules before; gives all looks, the first one first.
///
/// # Errors
/// [`StudyError`] for a list that cannot be read or written.
pub(super) fn look(
    rules_file: &Path,
    hash: &str,
    rules: &Rules,
    options: &Validate,
    all: &Recordings,
) -> Result<Vec<Look>, StudyError> {
    let path = looks_path(rules_file);
    let mut looks: Vec<Look> = if path.is_file() {
        read_rows(&path)?
    } else {
        Vec::new()
    };
    let opened = |part: Part| part == Part::Development || options.part == Part::Test;
    let (mut people, mut roles) = (BTreeSet::new(), BTreeSet::new());
    for table in rules.tables.iter().filter(|t| opened(t.part)) {
        for row in all.of(table) {
            let meta = row.drive.meta();
            people.insert(meta.participant.to_string());
            roles.insert(meta.condition.to_string());
        }
    }
    let words = |set: BTreeSet<String>| set.into_iter().collect::<Vec<_>>().join(" ");
    let look = Look {
        date: options.date.clone().unwrap_or_default(),
        program: options.program.clone().unwrap_or_default(),
        rules: hash.to_owned(),
        part: options.part,
        people: words(people),
        roles: words(roles),
    };
    let same = |before: &Look| {
        let key = |l: &Look| (l.rules.clone(), l.part, l.people.clone(), l.roles.clone());
        key(before) == key(&look)
    };
    if !look.people.is_empty() && !looks.iter().any(same) {
        looks.push(look);
        write_rows(TableName::Looks, &path, &looks)?;
    }
    Ok(looks)
}
