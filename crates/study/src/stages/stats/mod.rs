//! `stats`: one test on a tidy table.

mod columns;
mod designs;
mod input;
mod pictures;
mod printed;
mod ran;
mod rows;
mod run;
mod test;

pub use columns::WithinColumns;
pub use input::{Input, ROW};
pub use maveric_stats::{
    Adjustment, Bounds, CorrelationMethod, Formula, MissingCells, PosthocTest, Statistic,
};
pub use rows::FactorColumns;
pub use test::{FactorialMethod, Resampled, Test};

use crate::{error::StudyError, outcome::Outcome, outputs::spare_inputs, tables::Table};
use serde_json::{Map, Value, json};
use std::path::PathBuf;

/// How the result is shown to people.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Show {
    /// Everything: what was found, of whom, why, and what has no value.
    #[default]
    Report,
    /// The sentences alone.
    Apa,
    /// Tables in LaTeX.
    Latex,
    /// Tables in Markdown.
    Markdown,
}

/// What is asked of a table.
#[derive(Debug, Clone)]
pub struct Request {
    /// CSV, TSV or Parquet; `-` for CSV on standard input.
    pub data: PathBuf,
    /// What is done to the table first.
    pub input: Input,
    /// The test. Several values, as in `score,speed`, are tested one by one and not corrected for their number.
    pub test: Test,
    /// How the result is shown.
    pub show: Show,
    /// A figure to write, as SVG or PNG.
    pub figure: Option<PathBuf>,
}

/// Runs a test, or one for each of several outcomes; the value is the JSON of the contract, names as in the field's textbooks.
/// Several outcomes stand under `value`, each under its name.
///
/// # Errors
/// [`StudyError`] naming file, row and column, and the shape that was found where the test refuses it; before anything is read, if
/// the figure is neither SVG, PNG nor PDF, or the test has nothing to draw.
pub fn stats(request: &Request) -> Result<Outcome<Value>, StudyError> {
    spare_inputs([&*request.data], request.figure.as_deref())?;
    stats_of(|| Table::read(&request.data), request)
}

/// As [`stats`], of a table that is not in a file; `request.data` is its name in messages.
///
/// # Errors
/// As [`stats`], and what `table` gives.
pub fn stats_of(
    table: impl FnOnce() -> Result<Table, StudyError>,
    request: &Request,
) -> Result<Outcome<Value>, StudyError> {
    if let Some(path) = &request.figure {
        pictures::format(path)?;
        if !request.test.has_figure() {
            return Err(StudyError::NotPossible {
                problem: format!("`{}` has nothing to draw", request.test.name()),
                help: Some("leave out --figure".to_owned()),
            });
        }
    }
    let whole = table()?;
    if whole.rows() == 0 {
        return Err(StudyError::file(&request.data, "has a header but no rows"));
    }
    let (test, input) = (&request.test, &request.input);
    let table = input.read(whole, test.long(), test.name())?;
    let tests = test.by_value(&table);
    let several = tests.len() > 1;
    let (mut values, mut summary, mut warnings) = (Map::new(), Vec::new(), Vec::new());
    let mut pictures = Vec::new();
    for (outcome, test) in &tests {
        let mut found = run::run(&table, test).map_err(|e| with_shape(e, &table, input))?;
        if request.show == Show::Apa && found.said.is_empty() {
            return Err(StudyError::NotPossible {
                problem: format!("`{}` has no sentence for these data", test.name()),
                help: Some(
                    "leave out --apa: the report says what it found, and why it has no value"
                        .to_owned(),
                ),
            });
        }
        let own = take_warnings(&found.value, table.rows());
        if let Value::Object(object) = &mut found.value {
            // The outcome carries them; one place is enough.
            object.remove("warnings");
        }
        if several {
            if !summary.is_empty() {
                summary.push(String::new());
            }
            summary.push(match request.show {
                Show::Latex => format!("% {outcome}"),
                Show::Markdown => format!("## {outcome}"),
                _ => outcome.clone(),
            });
            warnings.extend(
                own.into_iter()
                    .map(|warning| format!("{outcome}: {warning}")),
            );
        } else {
            warnings.extend(own);
        }
        summary.extend(found.lines(request.show));
        pictures.extend(found.picture.take());
        values.insert(outcome.clone(), found.value);
    }
    if let Some(path) = &request.figure {
        pictures::write(path, pictures)?;
    }
    let value = if several {
        json!({ "value": values })
    } else {
        values
            .into_iter()
            .next()
            .map_or(Value::Null, |(_, value)| value)
    };
    Ok(Outcome {
        value,
        summary,
        warnings,
    })
}

/// A refusal that has to do with the table's shape says what that is, and what might be meant.
fn with_shape(error: StudyError, table: &Table, input: &Input) -> StudyError {
    use maveric_stats::StatsError as Refused;
    let of_shape = matches!(
        &error,
        StudyError::NoColumn { .. }
            | StudyError::Stats(
                Refused::DoubleCell { .. }
                    | Refused::TooFewConditions { .. }
                    | Refused::TooFew { .. }
            )
    );
    if !of_shape {
        return error;
    }
    let advice = || input::advice(table).filter(|_| input.wide.is_empty());
    let help: Vec<String> = [error.suggestion(), advice()]
        .into_iter()
        .flatten()
        .collect();
    StudyError::NotPossible {
        problem: format!("{error}; {}", input::shape(table)),
        help: (!help.is_empty()).then(|| help.join("; ")),
    }
}

/// What was left out, said beside the result.
fn take_warnings(value: &Value, rows: usize) -> Vec<String> {
    let mut warnings: Vec<String> = Vec::new();
    if let Some(list) = value["warnings"].as_array() {
        warnings.extend(list.iter().filter_map(|w| w.as_str().map(str::to_owned)));
    }
    if let Some(missing) = value["missing"].as_u64().filter(|m| *m > 0) {
        warnings.push(format!(
            "{missing} of {rows} rows left out for a missing value"
        ));
    }
    if let Some(dropped) = value["dropped"].as_array().filter(|d| !d.is_empty()) {
        let names: Vec<&str> = dropped.iter().filter_map(Value::as_str).collect();
        warnings.push(format!(
            "{} subjects left out for a missing cell: {}",
            names.len(),
            names.join(", ")
        ));
    }
    warnings
}
