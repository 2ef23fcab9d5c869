//! Rows of a table picked out, told apart and put under each other.

use super::{Table, keys::key, table::Stacked};
use crate::{error::StudyError, once::first_names};
use path_slash::PathExt as _;
use polars::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

impl Table {
    /// Refuses two rows that say the same of these columns: which of them counted would depend on their order.
    ///
    /// # Errors
    /// [`StudyError::NoColumn`]; [`StudyError::BadCell`] naming the second row and the first.
    pub(crate) fn each_once(&self, columns: &[&str]) -> Result<(), StudyError> {
        let cells: Vec<Vec<Option<String>>> =
            columns.iter().map(|column| self.text(column)).collect::<Result<_, _>>()?;
        let mut seen: BTreeMap<Vec<Option<&str>>, usize> = BTreeMap::new();
        for row in 0..self.rows() {
            let key: Vec<Option<&str>> = cells.iter().map(|c| c[row].as_deref()).collect();
            let Some(first) = seen.insert(key.clone(), row) else {
                continue;
            };
            let values: Vec<&str> = key.into_iter().flatten().collect();
            let expected = format!("each once: row {} says so already", self.origin(first) + 1);
            return Err(self.bad_cell(row, &columns.join("`, `"), values.join(", "), expected));
        }
        Ok(())
    }

    /// The rows whose cell in `column` is `value`; numbers are compared as numbers.
    ///
    /// # Errors
    /// [`StudyError::NoColumn`]; [`StudyError::NotPossible`] if no row is left.
    pub(crate) fn keeping(&self, column: &str, value: &str) -> Result<Self, StudyError> {
        let cells = self.text(column)?;
        let wanted = &*key(value);
        let number =
            self.number(wanted).or_else(|_| maveric_ingest::parse_number(wanted, false)).ok();
        let same = |cell: &str| {
            let both = number.zip(self.number(cell).ok());
            cell.trim() == wanted
                || both.is_some_and(|(a, b)| (a - b).abs() <= f64::EPSILON * a.abs())
        };
        let mask: Vec<bool> = cells.iter().map(|cell| cell.as_deref().is_some_and(same)).collect();
        let kept: Vec<usize> = (0..mask.len()).filter(|&row| mask[row]).collect();
        if kept.is_empty() {
            let seen: BTreeSet<&str> = cells.iter().flatten().map(String::as_str).collect();
            let problem = format!(
                "{}: no row has `{wanted}` in column `{column}`",
                self.path.to_slash_lossy()
            );
            let help = format!("its values are {}", first_names(&seen, 8));
            return Err(StudyError::not_possible(problem).with_help(help));
        }
        let mask = BooleanChunked::from_slice("kept".into(), &mask);
        let frame = self.frame.filter(&mask).map_err(|e| self.bad_column(column, &e))?;
        let origin = kept.iter().map(|&row| self.origin(row)).collect();
        Ok(Self {
            path: self.path.clone(),
            frame,
            decimal_comma: self.decimal_comma,
            origin: Some(origin),
            // Its rows are no longer one after the other.
            stacked: None,
        })
    }

    /// A row a cell: the columns of conditions under each other, named in `within` with their cells in `value`; the other columns
    /// are repeated. `subject` names a column to be added that numbers the rows of before from 1. What the cells are is for their reader to say.
    pub(crate) fn melted(
        &self,
        conditions: &[String],
        within: &str,
        value: &str,
        subject: Option<&str>,
    ) -> Result<Self, StudyError> {
        let (rows, k) = (self.rows(), conditions.len());
        let mut are_numbers = true;
        for name in conditions {
            are_numbers &= self.column(name)?.dtype().is_primitive_numeric();
        }
        let stacked = if are_numbers {
            Column::new(value.into(), under(conditions, |name| self.numbers(name))?)
        } else {
            Column::new(value.into(), under(conditions, |name| self.text(name))?)
        };
        let mut columns = Vec::new();
        for name in self.columns().iter().filter(|name| !conditions.contains(name)) {
            let cells = self.text(name)?;
            let repeated: Vec<Option<String>> =
                (0..rows * k).map(|i| cells[i / k].clone()).collect();
            columns.push(Column::new(name.as_str().into(), repeated));
        }
        if let Some(subject) = subject {
            let numbers: Vec<String> = (0..rows * k).map(|i| (i / k + 1).to_string()).collect();
            columns.push(Column::new(subject.into(), numbers));
        }
        let names: Vec<&str> = (0..rows * k).map(|i| conditions[i % k].as_str()).collect();
        columns.push(Column::new(within.into(), names));
        columns.push(stacked);
        let frame = DataFrame::new(rows * k, columns).map_err(|e| self.bad_column(value, &e))?;
        Ok(Self {
            path: self.path.clone(),
            frame,
            decimal_comma: self.decimal_comma,
            origin: Some((0..rows * k).map(|i| self.origin(i / k)).collect()),
            stacked: Some(Stacked { value: value.to_owned(), columns: conditions.to_vec() }),
        })
    }
}

/// The cells of these columns, one row after the other.
fn under<T: Clone>(
    columns: &[String],
    cells: impl Fn(&str) -> Result<Vec<Option<T>>, StudyError>,
) -> Result<Vec<Option<T>>, StudyError> {
    let columns: Vec<Vec<Option<T>>> =
        columns.iter().map(|name| cells(name)).collect::<Result<_, _>>()?;
    let rows = columns.first().map_or(0, Vec::len);
    let row = |row: usize| columns.iter().map(move |column| column[row].clone());
    Ok((0..rows).flat_map(row).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn columns_under_each_other_keep_their_cells_and_a_fault_names_the_column_of_the_file() {
        let text = "who,slow,fast\nA,yes,no\nB,,maybe\n";
        let wide = Table::parse(Path::new("t.csv"), text.as_bytes().to_vec()).unwrap();
        let conditions = ["slow", "fast"].map(str::to_owned);
        let long = wide.melted(&conditions, "pace", "seen", None).unwrap();
        let cells = long.text("seen").unwrap();
        let cells: Vec<&str> = cells.iter().map(|c| c.as_deref().unwrap_or("-")).collect();
        assert_eq!(cells, ["yes", "no", "-", "maybe"]);
        let error = long.bad_cell(3, "seen", "maybe", "yes or no").to_string();
        let expected = "t.csv: row 2, column `fast`: found `maybe`, expected yes or no";
        assert_eq!(error, expected);
        let other = long.bad_cell(3, "who", "B", "an id").to_string();
        assert!(other.contains("row 2, column `who`"), "{other}");
        let text = "who,slow,fast\nA,1,2.5\nB,,0.1\n";
        let wide = Table::parse(Path::new("t.csv"), text.as_bytes().to_vec()).unwrap();
        let long = wide.melted(&conditions, "pace", "speed", None).unwrap();
        let numbers = long.numbers("speed").unwrap();
        assert_eq!(numbers, [Some(1.0), Some(2.5), None, Some(0.1)]);
    }

    #[test]
    fn two_rows_of_one_key_are_refused_by_both_their_numbers() {
        let text = "who,when,x\nA,1,3\nA,2,4\nA,1,5\n";
        let table = Table::parse(Path::new("t.csv"), text.as_bytes().to_vec()).unwrap();
        let error = table.each_once(&["who", "when"]).unwrap_err().to_string();
        let expected = "t.csv: row 3, column `who`, `when`: found `A, 1`, expected each once: row 1 says so already";
        assert_eq!(error, expected);
        table.each_once(&["who", "x"]).unwrap();
    }
}
