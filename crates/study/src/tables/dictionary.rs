//! What the program writes, as data: `columns.toml`.

use maveric_measures::objective;
use serde::Deserialize;
use std::{collections::BTreeMap, sync::LazyLock};

/// A table that the program writes, by the name of its entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TableName {
    Answers,
    Codebook,
    CodebookMeasures,
    Conditions,
    Consents,
    Dial,
    Dictionary,
    Drive,
    Drives,
    Embeddings,
    EndedEarly,
    Events,
    Exclusions,
    Factors,
    Files,
    Forgotten,
    ItemMeans,
    Items,
    LearningCurve,
    LeftOut,
    Measurements,
    Measures,
    Missing,
    NotAdmitted,
    NotAgreed,
    Lent,
    Notes,
    OutcomesLong,
    OutcomesWide,
    OwnMeasurements,
    Participants,
    Payment,
    PressMoments,
    Presses,
    Reliabilities,
    Rollouts,
    Scores,
    Stopped,
    SurveysWide,
}

/// A kind of file that the program writes.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileEntry {
    /// The table that it holds; nothing for a file that is no table.
    pub name: Option<TableName>,
    /// Names that it has, with the folders that tell it from others; `*` stands for anything.
    pub files: Vec<String>,
    pub about: String,
    /// The commands that write it.
    pub by: Vec<String>,
    /// Where its numbers come from, below `crates/`.
    pub made_in: Option<String>,
    /// It is written only then.
    pub when: Option<String>,
    /// Its columns, in the order in which they are written.
    #[serde(default)]
    pub columns: Vec<ColumnEntry>,
    /// Whether every objective measure is one of them.
    #[serde(default)]
    measures: bool,
}

/// A column of a table.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColumnEntry {
    /// Its name; what `*` stands for differs from table to table.
    pub name: String,
    #[serde(default)]
    pub means: String,
    /// The unit of its numbers.
    pub unit: Option<String>,
    /// Where it comes from, below `crates/`, if elsewhere than the table.
    pub made_in: Option<String>,
    /// It is written only then.
    pub when: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Dictionary {
    /// What columns mean that many tables have, by their names.
    columns: BTreeMap<String, String>,
    file: Vec<FileEntry>,
}

/// Every kind of file that the program writes.
pub fn entries() -> &'static [FileEntry] {
    static ENTRIES: LazyLock<Vec<FileEntry>> = LazyLock::new(|| {
        read(include_str!("columns.toml"))
            .expect("the file is this crate's own, and a test reads it")
    });
    &ENTRIES
}

/// The entry of a file at this path, `/` between its parts: the one whose pattern says most of it.
pub fn entry_at(path: &str) -> Option<&'static FileEntry> {
    let names = std::iter::successors(Some(path), |rest| Some(rest.split_once('/')?.1));
    let names: Vec<&str> = names.collect();
    let matched = |pattern: &&String| names.iter().any(|name| is_like(pattern, name));
    let length = |entry: &FileEntry| entry.files.iter().filter(matched).map(String::len).max();
    let known = entries().iter().filter(|entry| length(entry).is_some());
    known.max_by_key(|entry| length(entry))
}

impl TableName {
    /// Its entry.
    ///
    /// # Panics
    /// Never: every table has one.
    pub fn entry(self) -> &'static FileEntry {
        let entry = entries().iter().find(|entry| entry.name == Some(self));
        entry.expect("a test asks for the entry of every table")
    }
}

impl FileEntry {
    /// What it says of a column.
    pub fn column(&self, name: &str) -> Option<&ColumnEntry> {
        self.columns.get(self.place_of(name)?)
    }

    /// Where a column stands among those of the entry; none for one that it does not have.
    pub fn place_of(&self, column: &str) -> Option<usize> {
        let place = |is: &dyn Fn(&str) -> bool| self.columns.iter().position(|c| is(&c.name));
        let exactly = place(&|name| name == column);
        exactly.or_else(|| place(&|name| name.contains('*') && is_like(name, column)))
    }

    /// The columns that it has always, by their names.
    pub fn always(&self) -> impl Iterator<Item = &str> {
        let always = |c: &&ColumnEntry| c.when.is_none() && !c.name.contains('*');
        self.columns.iter().filter(always).map(|c| c.name.as_str())
    }
}

/// Whether a name is what a pattern says; `*` stands for anything.
fn is_like(pattern: &str, name: &str) -> bool {
    match pattern.split_once('*') {
        None => pattern == name,
        Some((start, rest)) => name.strip_prefix(start).is_some_and(|name| {
            let ends_at = |at: usize| name.is_char_boundary(at) && is_like(rest, &name[at..]);
            (0..=name.len()).any(ends_at)
        }),
    }
}

fn read(text: &str) -> Result<Vec<FileEntry>, String> {
    let mut dictionary: Dictionary = toml::from_str(text).map_err(|e| e.to_string())?;
    for file in &mut dictionary.file {
        for column in file.columns.iter_mut().filter(|c| c.means.is_empty()) {
            let shared = dictionary.columns.get(&column.name);
            let shared = shared.ok_or_else(|| format!("nothing says what `{}` means", column.name));
            column.means.clone_from(shared?);
        }
        if file.measures {
            let further = objective::further().iter().map(|further| ColumnEntry {
                when: Some("the design names it (an outcome, a hypothesis, `expected`)".to_owned()),
                ..measure(further)
            });
            let measures = objective::all().iter().map(measure).chain(further);
            let measures = measures.chain(objective::met().iter().map(measure));
            file.columns.extend(measures);
        }
    }
    Ok(dictionary.file)
}

fn measure(measure: &objective::Measure) -> ColumnEntry {
    ColumnEntry {
        name: measure.name.to_owned(),
        means: measure.description.trim_end_matches('.').to_owned(),
        unit: Some(measure.unit.to_owned()).filter(|unit| unit != "1"),
        made_in: None,
        when: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_table_has_one_entry() {
        let named: Vec<TableName> = entries().iter().filter_map(|entry| entry.name).collect();
        let last = TableName::SurveysWide as usize;
        assert_eq!(named.len(), last + 1);
        assert!((0..=last).all(|table| named.iter().any(|name| *name as usize == table)));
    }

    #[test]
    fn a_file_has_the_entry_that_says_most_of_its_path() {
        let name = |path: &str| entry_at(path).and_then(|entry| entry.name);
        assert_eq!(name("drives/study1/drives.csv"), Some(TableName::Drives));
        assert_eq!(name("drives/exclusions.csv"), Some(TableName::Exclusions));
        assert_eq!(name("av/drives/exclusions.csv"), Some(TableName::EndedEarly));
        assert_eq!(name("drives/a/b/S1P01-own.parquet"), Some(TableName::Drive));
        assert_eq!(name("measurements.parquet"), Some(TableName::Measurements));
        assert!(name("other.csv").is_none() && name("my_scores.csv").is_none());
        assert!(entry_at("av/logs/P1.mcap").is_some() && entry_at("P1.mcap").is_none());
    }

    #[test]
    fn a_column_has_its_place_and_a_strange_one_has_none() {
        let embeddings = TableName::Embeddings.entry();
        let place = |column: &str| embeddings.place_of(column);
        assert!(place("beyond_why") < place("w12") && place("w12") < place("cov1_2"));
        assert!(place("w12") == place("w1") && place("x1").is_none());
        let always: Vec<&str> = embeddings.always().collect();
        assert!(always.contains(&"adb") && !always.contains(&"line_position_se"));
        // A name that is said stands before a pattern that would do.
        let people = TableName::Participants.entry();
        assert_eq!(people.place_of("study"), Some(1));
        assert_eq!(people.place_of("participant"), Some(0));
    }

    #[test]
    fn a_column_that_nothing_explains_is_no_entry() {
        let file = |columns: &str| {
            read(&format!(
                "[columns]\ndrive = \"id\"\n[[file]]\nfiles = [\"a.csv\"]\nabout = \"b\"\nby = []\ncolumns = [{columns}]\n"
            ))
        };
        let read = file("{ name = \"drive\" }, { name = \"x\", means = \"y\" }").unwrap();
        assert_eq!((read[0].columns[0].means.as_str(), read[0].columns.len()), ("id", 2));
        let error = file("{ name = \"x\" }").unwrap_err();
        assert!(error.contains("what `x` means"), "{error}");
    }
}
