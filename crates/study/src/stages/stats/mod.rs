//! `stats`: one test on a tidy table.

mod apa;
mod columns;

pub use maveric_stats::{Adjustment, CorrelationMethod, PosthocTest};

pub(crate) use apa::omnibus as apa_omnibus;

use crate::{error::StudyError, outcome::Outcome, tables::Table};
use maveric_stats::{self as tests, BootstrapData, BootstrapSettings};
use serde_json::{Map, Value, json};
use std::path::Path;

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

/// What to bootstrap.
#[derive(Debug, Clone)]
pub enum Statistic {
    /// Mean of a column.
    Mean {
        /// The column.
        value: String,
    },
    /// Pearson's r of two columns.
    Pearson {
        /// First column.
        x: String,
        /// Second column.
        y: String,
    },
    /// Spearman's rho of two columns.
    Spearman {
        /// First column.
        x: String,
        /// Second column.
        y: String,
    },
    /// Partial eta squared of a within-subject design.
    Eta2Partial {
        /// Its columns.
        columns: WithinColumns,
    },
}

/// A test and the columns that it reads.
#[derive(Debug, Clone)]
pub enum Test {
    /// The whole analysis of a within-subject design.
    Within(WithinColumns),
    /// Repeated-measures ANOVA.
    RmAnova(WithinColumns),
    /// Friedman's test.
    Friedman(WithinColumns),
    /// Checks assumptions, chooses, compares the pairs.
    Compare(WithinColumns),
    /// Every pair.
    Posthoc {
        /// Columns of the design.
        columns: WithinColumns,
        /// Test of a pair.
        test: PosthocTest,
        /// Adjustment over the pairs.
        adjust: Adjustment,
    },
    /// Correlation of two columns.
    Correlate {
        /// First column.
        x: String,
        /// Second column.
        y: String,
        /// Which coefficient.
        method: CorrelationMethod,
        /// Whose row it is, to warn of repeated rows.
        subject: Option<String>,
    },
    /// Correlation within subjects.
    Rmcorr {
        /// Whose row it is.
        subject: String,
        /// First column.
        x: String,
        /// Second column.
        y: String,
    },
    /// Shapiro-Wilk and moments.
    Normality {
        /// The column.
        value: String,
        /// Groups, tested apart.
        group: Option<String>,
    },
    /// Equal variances.
    Levene {
        /// The groups.
        group: String,
        /// The value.
        value: String,
    },
    /// Cronbach's alpha.
    Alpha {
        /// Columns of the items.
        items: Vec<String>,
    },
    /// Adjusted p values.
    Adjust {
        /// The column.
        p: String,
    },
    /// Resampling intervals.
    Bootstrap {
        /// What to estimate.
        statistic: Statistic,
        /// Resamples.
        resamples: usize,
        /// Root of the random choice.
        seed: u64,
    },
    /// Power, a question a row.
    Power,
    /// Do printed p values follow from printed coefficients?
    Recheck,
}

/// Confidence of an interval and level of a test.
const ALPHA: f64 = 0.05;

/// Runs one test; the value is the JSON of the contract, names as in the field's textbooks.
///
/// # Errors
/// [`StudyError`] naming file, row and column; [`StudyError::Stats`] where the test refuses the data.
pub fn stats(data: &Path, test: &Test) -> Result<Outcome<Value>, StudyError> {
    let table = Table::read(data)?;
    if table.rows() == 0 {
        return Err(StudyError::file(data, "has a header but no rows"));
    }
    let mut value = match test {
        Test::Within(c) => {
            let found = tests::within(&columns::within(&table, c)?);
            with_apa(&found, apa::within(&found))
        }
        Test::RmAnova(c) => {
            let found = tests::rm_anova(&columns::within(&table, c)?);
            with_apa(
                &found,
                apa::rm_anova(&found.rm_anova, &found.mauchly, &found.sphericity),
            )
        }
        Test::Friedman(c) => {
            let found = tests::friedman(&columns::within(&table, c)?);
            with_apa(&found, apa::friedman(&found.friedman, found.n))
        }
        Test::Compare(c) => {
            let found = tests::compare(&columns::within(&table, c)?, ALPHA)?;
            let mut said = apa::pairs(&found.posthoc);
            if let Some(omnibus) = apa::omnibus(&found.omnibus, found.n, false) {
                said.insert("omnibus".to_owned(), omnibus.to_string().into());
            }
            with_apa(&found, said)
        }
        Test::Posthoc {
            columns: c,
            test,
            adjust,
        } => {
            let found = tests::posthoc(&columns::within(&table, c)?, *test, *adjust, ALPHA)?;
            with_apa(&found, apa::pairs(&found))
        }
        Test::Correlate {
            x,
            y,
            method,
            subject,
        } => {
            let subjects = subject
                .as_ref()
                .map(|s| columns::labels(&table, s))
                .transpose()?;
            let found = tests::correlate(
                &table.numbers(x)?,
                &table.numbers(y)?,
                *method,
                subjects.as_deref(),
            )?;
            with_apa(&found, apa::correlation(&found))
        }
        Test::Rmcorr { subject, x, y } => {
            let subjects = columns::labels(&table, subject)?;
            let found = tests::rm_correlation(&subjects, &table.numbers(x)?, &table.numbers(y)?)?;
            with_apa(&found, apa::rm_correlation(&found.rm_corr))
        }
        Test::Normality { value, group: None } => plain(&tests::normality(&table.numbers(value)?)?),
        Test::Normality {
            value,
            group: Some(group),
        } => {
            let mut groups = Map::new();
            for (name, values) in columns::grouped(&table, group, value)? {
                groups.insert(name, plain(&tests::normality(&values)?));
            }
            json!({ "group": groups })
        }
        Test::Levene { group, value } => plain(&tests::levene(
            &columns::labels(&table, group)?,
            &table.numbers(value)?,
        )?),
        Test::Alpha { items } => {
            let found: Result<Vec<_>, StudyError> = items
                .iter()
                .map(|item| Ok((item.as_str(), table.numbers(item)?)))
                .collect();
            let found = found?;
            let items: Vec<(&str, &[Option<f64>])> =
                found.iter().map(|(n, c)| (*n, c.as_slice())).collect();
            plain(&tests::alpha(&items)?)
        }
        Test::Adjust { p } => plain(&tests::adjust(&table.all_numbers(p)?)?),
        Test::Bootstrap {
            statistic,
            resamples,
            seed,
        } => bootstrap(&table, statistic, *resamples, *seed)?,
        Test::Power => plain(&tests::power(&columns::power_questions(&table)?)?),
        Test::Recheck => plain(&tests::recheck(&columns::reported(&table)?)?),
    };
    let warnings = take_warnings(&value, table.rows());
    let summary = lines(&value);
    if let Value::Object(object) = &mut value {
        // The outcome carries them; one place is enough.
        object.remove("warnings");
    }
    Ok(Outcome {
        value,
        summary,
        warnings,
    })
}

fn plain(found: &impl serde::Serialize) -> Value {
    serde_json::to_value(found).unwrap_or_default()
}

fn with_apa(found: &impl serde::Serialize, said: Map<String, Value>) -> Value {
    let mut value = plain(found);
    if let Value::Object(object) = &mut value {
        object.insert("apa".to_owned(), Value::Object(said));
    }
    value
}

fn bootstrap(
    table: &Table,
    statistic: &Statistic,
    resamples: usize,
    seed: u64,
) -> Result<Value, StudyError> {
    let settings = BootstrapSettings {
        resamples,
        seed,
        confidence: 1.0 - ALPHA,
    };
    let found = match statistic {
        Statistic::Mean { value } => tests::bootstrap(
            tests::Statistic::Mean,
            BootstrapData::Values(&table.numbers(value)?),
            &settings,
        ),
        Statistic::Pearson { x, y } => {
            let (x, y) = (table.numbers(x)?, table.numbers(y)?);
            tests::bootstrap(
                tests::Statistic::Pearson,
                BootstrapData::Pairs(&x, &y),
                &settings,
            )
        }
        Statistic::Spearman { x, y } => {
            let (x, y) = (table.numbers(x)?, table.numbers(y)?);
            tests::bootstrap(
                tests::Statistic::Spearman,
                BootstrapData::Pairs(&x, &y),
                &settings,
            )
        }
        Statistic::Eta2Partial { columns } => {
            let data = columns::within(table, columns)?;
            tests::bootstrap(
                tests::Statistic::Eta2Partial,
                BootstrapData::Within(&data),
                &settings,
            )
        }
    };
    Ok(plain(&found?))
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

/// The result for people: the APA strings first, then every number on a line of its own.
fn lines(value: &Value) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(said) = value["apa"].as_object() {
        lines.extend(
            said.iter()
                .map(|(name, text)| format!("{name}: {}", text.as_str().unwrap_or_default())),
        );
        lines.push(String::new());
    }
    flatten("", value, &mut lines);
    lines
}

fn flatten(path: &str, value: &Value, lines: &mut Vec<String>) {
    let join = |key: &str| {
        if path.is_empty() {
            key.to_owned()
        } else {
            format!("{path}.{key}")
        }
    };
    match value {
        Value::Object(object) => {
            for (key, inner) in object
                .iter()
                .filter(|(key, _)| !(path.is_empty() && (*key == "apa" || *key == "warnings")))
            {
                flatten(&join(key), inner, lines);
            }
        }
        Value::Array(items) => {
            for (i, inner) in items.iter().enumerate() {
                flatten(&join(&i.to_string()), inner, lines);
            }
        }
        Value::Null => {}
        Value::String(text) => lines.push(format!("{path} = {text}")),
        other => lines.push(format!("{path} = {other}")),
    }
}
