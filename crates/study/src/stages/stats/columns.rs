//! From the columns of a table to what a test takes.

use super::input::Long;
use crate::{error::StudyError, tables::Table};
use maveric_stats::{PlannedTest, PowerQuestion, ReportedCorrelation, WithinSubjects};

/// The columns of a within-subject design.
#[derive(Debug, Clone)]
pub struct WithinColumns {
    /// Whose row it is.
    pub subject: String,
    /// In which condition.
    pub within: String,
    /// The value.
    pub value: String,
}

impl WithinColumns {
    pub(super) fn long(&self) -> Long<'_> {
        Long {
            subject: Some(&self.subject),
            within: &self.within,
            value: &self.value,
        }
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

pub(super) fn within(table: &Table, columns: &WithinColumns) -> Result<WithinSubjects, StudyError> {
    let subjects = labels(table, &columns.subject)?;
    let conditions = labels(table, &columns.within)?;
    Ok(WithinSubjects::from_long(
        &subjects,
        &conditions,
        &table.numbers(&columns.value)?,
    )?)
}

/// A group's name and its values.
pub(super) type Group = (String, Vec<Option<f64>>);

/// Values by group, in the order in which the groups first appear.
pub(super) fn grouped(table: &Table, group: &str, value: &str) -> Result<Vec<Group>, StudyError> {
    let mut found: Vec<Group> = Vec::new();
    for (name, value) in labels(table, group)?.into_iter().zip(table.numbers(value)?) {
        match found.iter_mut().find(|(known, _)| *known == name) {
            Some((_, values)) => values.push(value),
            None => found.push((name, vec![value])),
        }
    }
    Ok(found)
}

/// A number that counts something: whole and not negative.
fn count(table: &Table, row: usize, column: &str, value: f64) -> Result<usize, StudyError> {
    if value >= 0.0 && value.fract() == 0.0 {
        return Ok(value as usize);
    }
    Err(table.bad_cell(row, column, value.to_string(), "a whole number, 0 or more"))
}

/// One question a row: `test`, `n`, `effect`, `alpha`, and for an ANOVA `k`, `corr`, `epsilon`.
pub(super) fn power_questions(table: &Table) -> Result<Vec<PowerQuestion>, StudyError> {
    let test = labels(table, "test")?;
    let n = table.all_numbers("n")?;
    let effect = table.all_numbers("effect")?;
    let alpha = table.all_numbers("alpha")?;
    let optional = |name: &str| {
        if table.has(name) {
            table.numbers(name)
        } else {
            Ok(vec![None; table.rows()])
        }
    };
    let (k, corr, epsilon) = (optional("k")?, optional("corr")?, optional("epsilon")?);
    let need = |cells: &[Option<f64>], row: usize, name: &str| {
        cells[row].ok_or_else(|| table.bad_cell(row, name, "", "a number, for an ANOVA"))
    };
    (0..table.rows())
        .map(|row| {
            let effect = effect[row];
            let planned = match test[row].as_str() {
                "paired_t" => PlannedTest::PairedT { effect },
                "pearson" => PlannedTest::Pearson { effect },
                "rm_anova" => PlannedTest::RmAnova {
                    effect,
                    k: count(table, row, "k", need(&k, row, "k")?)?,
                    corr: need(&corr, row, "corr")?,
                    epsilon: need(&epsilon, row, "epsilon")?,
                },
                other => {
                    return Err(table.bad_cell(
                        row,
                        "test",
                        other,
                        "paired_t, pearson or rm_anova",
                    ));
                }
            };
            Ok(PowerQuestion {
                test: planned,
                n: count(table, row, "n", n[row])?,
                alpha: alpha[row],
            })
        })
        .collect()
}

/// One published correlation a row: `coefficient`, `df`, `p`, as printed.
pub(super) fn reported(table: &Table) -> Result<Vec<ReportedCorrelation>, StudyError> {
    let coefficient = labels(table, "coefficient")?;
    let df = table.all_numbers("df")?;
    let p = labels(table, "p")?;
    (0..table.rows())
        .map(|row| {
            Ok(ReportedCorrelation {
                coefficient: coefficient[row].clone(),
                df: count(table, row, "df", df[row])?,
                p: p[row].clone(),
            })
        })
        .collect()
}
