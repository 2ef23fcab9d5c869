//! Who opened which recordings, and under which rules.

use super::{
    commit::{Stands, UNKNOWN},
    rules::{Part, Rules, Table},
};
use crate::{
    error::StudyError,
    recordings::Recordings,
    stages::validate::Validate,
    tables::{Table as File, TableName, write_rows},
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
    pub commit: String,
    pub rules: String,
    pub part: Part,
    pub people: String,
    pub roles: String,
}

/// A look as it was noted before commits were.
#[derive(Deserialize)]
struct LookOfBefore {
    date: String,
    program: String,
    rules: String,
    part: Part,
    people: String,
    roles: String,
}

impl Look {
    /// Whether it opened one of the recordings that a table reads.
    fn opened(&self, table: &Table, recordings: &Recordings) -> bool {
        let names = |list: &str, name: &str| list.split(' ').any(|word| word == name);
        let part = self.part == Part::Test || table.part == Part::Development;
        part && table.reads(recordings).iter().any(|row| {
            let meta = row.drive.meta();
            names(&self.people, meta.participant.as_str())
                && names(&self.roles, meta.condition.as_str())
        })
    }
}

/// The first look at the recordings of a table, where it was under other rules than those of now: what stands in the table was changed
/// after it.
pub(super) fn changed_since(
    looks: &[Look],
    hash: Option<&str>,
    table: &Table,
    recordings: &Recordings,
) -> Option<Look> {
    let first = looks.iter().find(|look| look.opened(table, recordings))?;
    (Some(first.rules.as_str()) != hash).then(|| first.clone())
}

/// Where looks are noted: beside the rules, so that no run takes them away.
fn looks_path(rules: &Path) -> PathBuf {
    let stem = rules.file_stem().unwrap_or_default().to_string_lossy();
    let stem = stem.strip_suffix("_rules").unwrap_or(&stem).to_owned();
    rules.with_file_name(format!("{stem}_looks.csv"))
}

fn read_looks(path: &Path) -> Result<Vec<Look>, StudyError> {
    if !path.is_file() {
        return Ok(Vec::new());
    }
    let table = File::read(path)?;
    if table.has("commit") {
        return table.records();
    }
    let before = table.records::<LookOfBefore>()?.into_iter();
    let look = |look: LookOfBefore| Look {
        date: look.date,
        program: look.program,
        commit: UNKNOWN.to_owned(),
        rules: look.rules,
        part: look.part,
        people: look.people,
        roles: look.roles,
    };
    Ok(before.map(look).collect())
}

/// Notes this look, unless the same recordings were opened under the same rules before; gives all looks, the first one first.
///
/// # Errors
/// [`StudyError`] for a list that cannot be read or written, and for rules that stand in no commit where the test part is to be opened.
pub(super) fn look(
    rules_file: &Path,
    hash: &str,
    rules: &Rules,
    options: &Validate,
    recordings: &Recordings,
    warnings: &mut Vec<String>,
) -> Result<Vec<Look>, StudyError> {
    let mut stands = Stands::ask_git(rules_file, "git");
    if options.part == Part::Test {
        stands = stands.checked(rules_file)?;
        if stands == Stands::NoGit {
            warnings.push(
                "there is no git on this machine, so nobody can tell from the list of looks that the rules were committed before the test part was opened"
                    .to_owned(),
            );
        }
    }
    let path = looks_path(rules_file);
    let mut looks = read_looks(&path)?;
    let opened = |part: Part| part == Part::Development || options.part == Part::Test;
    let (mut people, mut roles) = (BTreeSet::new(), BTreeSet::new());
    for table in rules.tables.iter().filter(|t| opened(t.part)) {
        for row in table.reads(recordings) {
            let meta = row.drive.meta();
            people.insert(meta.participant.to_string());
            roles.insert(meta.condition.to_string());
        }
    }
    let words = |set: BTreeSet<String>| set.into_iter().collect::<Vec<_>>().join(" ");
    let look = Look {
        date: options.date.clone().unwrap_or_default(),
        program: options.program.clone().unwrap_or_default(),
        commit: stands.text(),
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
