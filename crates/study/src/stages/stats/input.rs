//! The table as people have it: rows that are kept, and a column a condition made long.

use crate::{error::StudyError, outcome::Format, tables::Table};
use std::{collections::BTreeSet, path::PathBuf};

/// The column that numbers the rows of a wide table, where it names no subjects.
pub const ROW: &str = "(row)";

/// The table, what is done to it before a test reads it, and how the result is shown.
#[derive(Debug, Clone, clap::Args)]
pub struct Input {
    /// Table to read: CSV, TSV, Parquet, or - for CSV on standard input
    pub data: PathBuf,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
    /// Keep the rows that have this value in this column; several: all of them
    #[arg(long = "where", value_name = "COLUMN=VALUE", value_parser = column_and_value, help_heading = "The table")]
    pub keep: Vec<(String, String)>,
    /// Columns that are conditions or groups, in the place of --within and --value (which then name what they become), for calls that compare
    /// some; without --subject a row is a subject
    #[arg(long, value_name = "A,B,…", value_delimiter = ',', help_heading = "The table")]
    pub wide: Vec<String>,
    /// Print the sentences alone, as APA has them, of calls that have some
    #[arg(long, group = "shown", help_heading = "The result")]
    pub apa: bool,
    /// Print the tables in LaTeX (booktabs)
    #[arg(long, group = "shown", help_heading = "The result")]
    pub latex: bool,
    /// Print the tables in Markdown
    #[arg(long, group = "shown", help_heading = "The result")]
    pub markdown: bool,
    /// Draw the result into this file, where there are conditions, groups, estimates or two columns to draw
    #[arg(long, value_name = "OUT.svg|png|pdf", help_heading = "The result")]
    pub figure: Option<PathBuf>,
}

fn column_and_value(text: &str) -> Result<(String, String), String> {
    let parts = text.split_once('=').filter(|(column, _)| !column.is_empty());
    parts
        .map(|(column, value)| (column.to_owned(), value.to_owned()))
        .ok_or_else(|| "expected COLUMN=VALUE, as in session=2".to_owned())
}

/// How the result is shown to people.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Show {
    /// Everything: what was found, of whom, why, and what has no value.
    Report,
    Apa,
    Latex,
    Markdown,
}

/// The columns of a long table.
#[derive(Debug, Clone, Copy)]
pub struct Long<'a> {
    /// Whose row it is; [`ROW`] numbers the rows of the wide table.
    pub(super) subject: Option<&'a str>,
    /// In which condition, or group.
    pub(super) within: &'a str,
    pub(super) value: &'a str,
}

impl<'a> Long<'a> {
    /// Of groups of different people.
    pub(super) fn groups(group: &'a str, value: &'a str) -> Self {
        Self { subject: None, within: group, value }
    }

    /// Whether a table has all these columns: then it is long, and was read as it is.
    pub(super) fn is_in(&self, table: &Table) -> bool {
        let columns = [self.subject, Some(self.within), Some(self.value)];
        columns.into_iter().flatten().all(|name| table.has(name))
    }
}

impl Input {
    pub(super) fn show(&self) -> Show {
        match (self.apa, self.latex, self.markdown) {
            (true, _, _) => Show::Apa,
            (_, true, _) => Show::Latex,
            (_, _, true) => Show::Markdown,
            _ => Show::Report,
        }
    }

    /// The rows that are kept, made long with the columns that the test reads.
    pub(super) fn read(
        &self,
        table: Table,
        long: Option<Long<'_>>,
        test: &str,
    ) -> Result<Table, StudyError> {
        let mut table = table;
        for (column, value) in &self.keep {
            table = table.keeping(column, value)?;
        }
        if self.wide.is_empty() {
            return Ok(table);
        }
        let Some(long) = long else {
            let problem = format!("`{test}` compares no conditions, so it takes no --wide columns");
            return Err(StudyError::not_possible(problem));
        };
        self.melt(&table, long)
    }

    fn melt(&self, table: &Table, long: Long<'_>) -> Result<Table, StudyError> {
        let columns = &self.wide;
        let refused =
            |problem: String, help: &str| Err(StudyError::not_possible(problem).with_help(help));
        if let Some(twice) = (1..columns.len()).find(|&i| columns[..i].contains(&columns[i])) {
            let problem = format!("`{}` is named twice among the wide columns", columns[twice]);
            return refused(problem, "name each column once");
        }
        if let Some(taken) = [long.within, long.value].into_iter().find(|name| table.has(name)) {
            let problem = format!(
                "the table has a column `{taken}` already, which the wide columns would become"
            );
            return refused(problem, "give other names by --within and --value");
        }
        let numbered = long.subject.filter(|subject| *subject == ROW);
        table.melted(columns, long.within, long.value, numbered)
    }
}

/// What a table looks like, for somebody whose call did not fit it.
pub(super) fn shape(table: &Table) -> String {
    let columns: Vec<String> =
        table.columns().iter().map(|name| format!("`{name}` ({})", kind(table, name))).collect();
    format!("the table has {} rows and the columns {}", table.rows(), columns.join(", "))
}

/// What to try, where the shape tells it: several columns of numbers, one row a person.
pub(super) fn advice(table: &Table) -> Option<String> {
    let names = table.columns();
    let numeric: Vec<&String> = names.iter().filter(|name| table.numbers(name).is_ok()).collect();
    let everyone_once = names
        .iter()
        .find(|name| distinct(table, name) == Some(table.rows()) && !numeric.contains(name));
    if numeric.len() < 2 {
        return None;
    }
    let who = everyone_once.map_or_else(String::new, |name| format!(" --subject {name}"));
    let list: Vec<&str> = numeric.iter().map(|name| name.as_str()).collect();
    Some(format!("if these are a column a condition: --wide {}{who}", list.join(",")))
}

fn distinct(table: &Table, column: &str) -> Option<usize> {
    let cells = table.text(column).ok()?;
    let different: BTreeSet<String> = cells.into_iter().flatten().collect();
    Some(different.len())
}

fn kind(table: &Table, column: &str) -> String {
    let different = distinct(table, column).unwrap_or(0);
    match table.numbers(column) {
        Ok(values) => {
            let missing = values.iter().filter(|v| v.is_none()).count();
            let missing = if missing > 0 { format!(", {missing} missing") } else { String::new() };
            format!("numbers, {different} different{missing}")
        }
        Err(_) => format!("text, {different} different"),
    }
}
