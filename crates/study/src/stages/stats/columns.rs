//! From the columns of a table to what a test takes.

use super::input::{Long, ROW};
use crate::{error::StudyError, tables::Table};
use clap::builder::ArgPredicate;
use maveric_stats::WithinSubjects;

/// The columns of a within-subject design.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct WithinColumns {
    /// Column that says whose row it is
    #[arg(
        long,
        required = false,
        required_unless_present = "wide",
        default_value_if("wide", ArgPredicate::IsPresent, ROW)
    )]
    pub(super) subject: String,
    /// Column that says in which condition
    #[arg(
        long,
        required = false,
        required_unless_present = "wide",
        default_value_if("wide", ArgPredicate::IsPresent, "condition")
    )]
    pub(super) within: String,
    /// Column with the value; several, as in score,speed, are analysed one by one
    #[arg(
        long,
        required = false,
        required_unless_present = "wide",
        default_value_if("wide", ArgPredicate::IsPresent, "value")
    )]
    pub(super) value: String,
}

impl WithinColumns {
    pub(super) fn long(&self) -> Long<'_> {
        Long { subject: Some(&self.subject), within: &self.within, value: &self.value }
    }

    pub(super) fn read(&self, table: &Table) -> Result<WithinSubjects, StudyError> {
        self.long().read(table)
    }
}

/// Conditions of the same people, where a call can do without them.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct Conditions {
    /// Column that says whose row it is
    #[arg(long, default_value_if("wide", ArgPredicate::IsPresent, ROW))]
    pub(super) subject: Option<String>,
    /// Column that says in which condition
    #[arg(long, default_value_if("wide", ArgPredicate::IsPresent, "condition"))]
    pub(super) within: Option<String>,
    /// Column with the value; several, as in score,speed, are analysed one by one
    #[arg(long, default_value_if("wide", ArgPredicate::IsPresent, "value"))]
    pub(super) value: Option<String>,
}

impl Conditions {
    pub(super) fn long(&self) -> Option<Long<'_>> {
        Some(Long {
            subject: Some(self.subject.as_deref()?),
            within: self.within.as_deref()?,
            value: self.value.as_deref()?,
        })
    }

    /// What is missing where one of the columns of conditions is named without the other.
    pub(super) fn lacks(&self) -> Option<&'static str> {
        (self.subject.is_some() != self.within.is_some()).then_some("--subject and --within")
    }

    /// The values of one sample.
    pub(super) fn sample(&self, table: &Table) -> Result<Vec<Option<f64>>, StudyError> {
        table.numbers(self.value.as_deref().unwrap_or_default())
    }
}

/// Groups of different people.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct GroupColumns {
    /// Column that groups the rows
    #[arg(
        long,
        visible_alias = "between",
        required = false,
        required_unless_present = "wide",
        default_value_if("wide", ArgPredicate::IsPresent, "group")
    )]
    pub(super) group: String,
    /// Column with the value; several, as in score,speed, are analysed one by one
    #[arg(
        long,
        required = false,
        required_unless_present = "wide",
        default_value_if("wide", ArgPredicate::IsPresent, "value")
    )]
    pub(super) value: String,
}

impl GroupColumns {
    pub(super) fn long(&self) -> Long<'_> {
        Long::groups(&self.group, &self.value)
    }
}

impl Long<'_> {
    /// The cells of conditions that the same people met.
    pub(super) fn read(&self, table: &Table) -> Result<WithinSubjects, StudyError> {
        let subjects = labels(table, self.subject.unwrap_or_default())?;
        let conditions = labels(table, self.within)?;
        let values = table.numbers(self.value)?;
        Ok(WithinSubjects::from_long(&subjects, &conditions, &values)?)
    }
}

/// A column of labels without a missing one.
pub(super) fn labels(table: &Table, column: &str) -> Result<Vec<String>, StudyError> {
    let cells = table.text(column)?;
    let filled = |(row, cell): (usize, Option<String>)| {
        cell.ok_or_else(|| table.bad_cell(row, column, "", "a label"))
    };
    cells.into_iter().enumerate().map(filled).collect()
}

/// The cells of conditions that the same people answered with yes (1) or no (0).
pub(super) fn yes_no(table: &Table, columns: &WithinColumns) -> Result<WithinSubjects, StudyError> {
    let answer = |(row, cell): (usize, Option<String>)| {
        let Some(cell) = cell else { return Ok(None) };
        match cell.trim().to_lowercase().as_str() {
            "yes" | "y" | "true" | "1" | "1.0" => Ok(Some(1.0)),
            "no" | "n" | "false" | "0" | "0.0" => Ok(Some(0.0)),
            _ => Err(table.bad_cell(row, &columns.value, cell, "yes or no, true or false, 1 or 0")),
        }
    };
    let answers = table.text(&columns.value)?.into_iter().enumerate().map(answer);
    let answers = answers.collect::<Result<Vec<_>, StudyError>>()?;
    let subjects = labels(table, &columns.subject)?;
    let conditions = labels(table, &columns.within)?;
    Ok(WithinSubjects::from_long(&subjects, &conditions, &answers)?)
}

/// A group's name and its values.
pub(super) type Group = (String, Vec<Option<f64>>);

/// Values by group, in the order in which the groups first appear.
pub(super) fn grouped(table: &Table, group: &str, value: &str) -> Result<Vec<Group>, StudyError> {
    let mut groups: Vec<Group> = Vec::new();
    for (name, value) in labels(table, group)?.into_iter().zip(table.numbers(value)?) {
        match groups.iter_mut().find(|(known, _)| *known == name) {
            Some((_, values)) => values.push(value),
            None => groups.push((name, vec![value])),
        }
    }
    Ok(groups)
}

/// A number that counts something: whole and not negative.
pub(super) fn count(
    table: &Table,
    row: usize,
    column: &str,
    value: f64,
) -> Result<usize, StudyError> {
    if value >= 0.0 && value.fract() == 0.0 {
        return Ok(value as usize);
    }
    Err(table.bad_cell(row, column, value.to_string(), "a whole number, 0 or more"))
}
