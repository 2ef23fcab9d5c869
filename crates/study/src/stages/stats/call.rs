//! A call of a test: its table, what is done to it, and how the result is shown.

use super::{
    input::{self, Input, Long, Show},
    pictures,
    ran::Ran,
    statistical_test::Test,
};
use crate::{error::StudyError, outcome::Outcome, outputs::spare_inputs, tables::Table};
use maveric_stats::StatsError as Refused;
use path_slash::PathExt as _;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

// No doc: the test's own is its help.
#[derive(Debug, Clone, clap::Args)]
pub struct Call<T: Test> {
    #[command(flatten)]
    pub input: Input,
    #[command(flatten)]
    pub test: T,
}

impl<T: Test> Call<T> {
    /// Runs a test, or one for each of several outcomes; the value is the JSON of the contract, names as in the field's textbooks.
    /// Several outcomes stand under `value`, each under its name, and are not corrected for their number.
    ///
    /// # Errors
    /// [`StudyError`] naming file, row and column, and the shape that was found where the test refuses it; before anything is read, if
    /// the figure is neither SVG, PNG nor PDF, or the test has nothing to draw.
    pub fn run(&self) -> Result<Outcome<Value>, StudyError> {
        spare_inputs([&*self.input.data], self.input.figure.as_deref())?;
        self.run_on(|| Table::read(&self.input.data))
    }

    /// As [`Call::run`], of a table that is not in a file; `input.data` is its name in messages.
    ///
    /// # Errors
    /// As [`Call::run`], and what `table` gives.
    pub fn run_on(
        &self,
        table: impl FnOnce() -> Result<Table, StudyError>,
    ) -> Result<Outcome<Value>, StudyError> {
        let (input, test) = (&self.input, &self.test);
        if let Some(path) = &input.figure {
            pictures::format(path)?;
            if !test.has_figure() {
                let problem = format!("`{}` has nothing to draw", T::NAME);
                let help = "leave out --figure";
                return Err(StudyError::not_possible(problem).with_help(help));
            }
        }
        if input.apa && !T::HAS_SENTENCE {
            let problem = format!("`{}` has no sentence", T::NAME);
            return Err(StudyError::not_possible(problem).with_help("leave out --apa"));
        }
        let whole = table()?;
        if whole.rows() == 0 {
            return Err(StudyError::file(&input.data, "has a header but no rows"));
        }
        let table = input.read(whole, test.long(), T::NAME)?;
        let by_value = by_value(test, &table).into_iter();
        let runs = by_value.map(|(outcome, test)| {
            let ran = test.roles().check(&table).and_then(|()| test.run(&table));
            let long = test.long();
            let ran =
                ran.map_err(|e| with_shape(in_table(e, &table, &outcome), &table, input, long))?;
            Ok((outcome, ran))
        });
        shown(input, T::NAME, runs.collect::<Result<_, StudyError>>()?, table.rows())
    }
}

/// The test of each of several values; a column may have a comma in its name.
fn by_value<T: Test>(test: &T, table: &Table) -> Vec<(String, T)> {
    let mut test = test.clone();
    let named = test.value().map(|value| value.clone()).unwrap_or_default();
    if table.has(&named) || !named.contains(',') {
        return vec![(named, test)];
    }
    let one = |name: &str| {
        let mut test = test.clone();
        if let Some(value) = test.value() {
            name.trim().clone_into(value);
        }
        (name.trim().to_owned(), test)
    };
    named.split(',').map(one).collect()
}

/// What the tests of one table gave, as JSON, lines and figure.
fn shown(
    input: &Input,
    test: &str,
    runs: Vec<(String, Ran)>,
    rows: usize,
) -> Result<Outcome<Value>, StudyError> {
    let show = input.show();
    let several = runs.len() > 1;
    let (mut values, mut summary, mut warnings) = (Map::new(), Vec::new(), Vec::new());
    let (mut pictures, mut labels) = (Vec::new(), BTreeSet::new());
    for (outcome, mut ran) in runs {
        ran.printed.label_apart(&mut labels);
        if show == Show::Apa && ran.statements.is_empty() {
            let problem = format!("`{test}` has no sentence for these data");
            let help = "leave out --apa: the report says what it found, and why it has no value";
            return Err(StudyError::not_possible(problem).with_help(help));
        }
        let new_warnings = take_warnings(&ran.value, rows);
        if let Value::Object(object) = &mut ran.value {
            // The outcome carries them; one place is enough.
            object.remove("warnings");
        }
        if several {
            if !summary.is_empty() {
                summary.push(String::new());
            }
            summary.push(match show {
                Show::Latex => format!("% {outcome}"),
                Show::Markdown => format!("## {outcome}"),
                _ => outcome.clone(),
            });
            let named = new_warnings.into_iter().map(|warning| format!("{outcome}: {warning}"));
            warnings.extend(named);
        } else {
            warnings.extend(new_warnings);
        }
        summary.extend(ran.lines(show));
        pictures.extend(ran.picture.take());
        values.insert(outcome, ran.value);
    }
    if let Some(path) = &input.figure {
        pictures::write(path, pictures)?;
    }
    let value = if several {
        json!({ "value": values })
    } else {
        values.into_iter().next().map_or(Value::Null, |(_, value)| value)
    };
    Ok(Outcome::new(value, summary, warnings))
}

/// A refusal of a cell by its row and column in the file; `value` is the column of values.
fn in_table(error: StudyError, table: &Table, value: &str) -> StudyError {
    match error {
        StudyError::Stats(Refused::NotWhole { row, value: found }) => {
            let expected = "a whole number, as ordered answers are";
            table.bad_cell(row, value, found.to_string(), expected)
        }
        StudyError::Stats(Refused::Unreadable { row, what, text, expected }) => {
            table.bad_cell(row, &what, text, expected)
        }
        other => other,
    }
}

/// A refusal of the test names the table; one that has to do with its shape says what that is, and what might be meant.
fn with_shape(
    error: StudyError,
    table: &Table,
    input: &Input,
    long: Option<Long<'_>>,
) -> StudyError {
    let of_shape = matches!(
        &error,
        StudyError::NoColumn { .. }
            | StudyError::Stats(
                Refused::DoubleCell { .. }
                    | Refused::TooFewConditions { .. }
                    | Refused::TooFew { .. }
            )
    );
    let problem = match &error {
        StudyError::Stats(refused) => format!("{}: {refused}", table.path().to_slash_lossy()),
        other => other.to_string(),
    };
    if !of_shape {
        return match error {
            StudyError::Stats(refused) => {
                StudyError::NotPossible { problem, help: refused.suggestion().map(str::to_owned) }
            }
            other => other,
        };
    }
    let wide_is_wanted = long.filter(|long| input.wide.is_empty() && !long.is_in(table));
    let advice = wide_is_wanted.and_then(|_| input::advice(table));
    let help: Vec<String> = [error.suggestion(), advice].into_iter().flatten().collect();
    StudyError::NotPossible {
        problem: format!("{problem}; {}", input::shape(table)),
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
        warnings.push(format!("{missing} of {rows} rows left out for a missing value"));
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
