//! `stats`: one test on a tidy table.

mod apa;
mod columns;
mod designs;
mod text;

pub use designs::{Bounds, DesignTest, FactorialColumns, FactorialMethod, Formula};
pub use maveric_stats::{Adjustment, CorrelationMethod, PosthocTest, Statistic};

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

/// What to bootstrap, and from which columns.
#[derive(Debug, Clone)]
pub enum Resampled {
    /// A statistic of one column.
    Column {
        /// Which.
        statistic: Statistic,
        /// The column.
        value: String,
    },
    /// A correlation of two columns.
    Pair {
        /// Which.
        statistic: Statistic,
        /// First column.
        x: String,
        /// Second column.
        y: String,
    },
    /// An effect size of a within-subject design; whole subjects are drawn.
    Design {
        /// Which.
        statistic: Statistic,
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
        /// Whose sheet it is, where people answered several.
        subject: Option<String>,
    },
    /// Adjusted p values.
    Adjust {
        /// The column.
        p: String,
    },
    /// Resampling intervals.
    Bootstrap {
        /// What to estimate.
        resampled: Resampled,
        /// Resamples.
        resamples: usize,
        /// Root of the random choice.
        seed: u64,
    },
    /// Power, a question a row.
    Power,
    /// Do printed p values follow from printed coefficients?
    Recheck,
    /// Groups, factors, bounds and models.
    Design(DesignTest),
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
    let (mut value, summary) = match test {
        Test::Within(c) => {
            let found = tests::within(&columns::within(&table, c)?);
            let said = apa::within(&found);
            let lines = text::whole(&found, &said);
            (with_apa(&found, said), lines)
        }
        Test::RmAnova(c) => {
            let found = tests::rm_anova(&columns::within(&table, c)?);
            let said = apa::rm_anova(&found.rm_anova, &found.mauchly, &found.sphericity);
            let lines = text::rm_anova(&found, &said);
            (with_apa(&found, said), lines)
        }
        Test::Friedman(c) => {
            let found = tests::friedman(&columns::within(&table, c)?);
            let said = apa::friedman(&found.friedman, found.n);
            let lines = text::friedman(&found, &said);
            (with_apa(&found, said), lines)
        }
        Test::Compare(c) => {
            let found = tests::compare(&columns::within(&table, c)?, ALPHA)?;
            let mut said = apa::pairs(&found.posthoc);
            if let Some(omnibus) = apa::omnibus(&found.omnibus, found.n, false) {
                said.insert("omnibus".to_owned(), omnibus.to_string().into());
            }
            let lines = text::comparison(&found, &said);
            (with_apa(&found, said), lines)
        }
        Test::Posthoc {
            columns: c,
            test,
            adjust,
        } => {
            let found = tests::posthoc(&columns::within(&table, c)?, *test, *adjust, ALPHA)?;
            let lines = text::posthoc(&found);
            (with_apa(&found, apa::pairs(&found)), lines)
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
            let said = apa::correlation(&found);
            let lines = text::correlation(&found, x, y, &said);
            (with_apa(&found, said), lines)
        }
        Test::Rmcorr { subject, x, y } => {
            let subjects = columns::labels(&table, subject)?;
            let found = tests::rm_correlation(&subjects, &table.numbers(x)?, &table.numbers(y)?)?;
            let said = apa::rm_correlation(&found.rm_corr);
            let lines = text::rm_correlation(&found, x, y, &said);
            (with_apa(&found, said), lines)
        }
        other => {
            let value = without_apa(&table, other)?;
            let lines = text::plain(&value);
            (value, lines)
        }
    };
    let warnings = take_warnings(&value, table.rows());
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

/// The tests whose numbers are not written as a sentence.
fn without_apa(table: &Table, test: &Test) -> Result<Value, StudyError> {
    Ok(match test {
        Test::Normality { value, group: None } => plain(&tests::normality(&table.numbers(value)?)?),
        Test::Normality {
            value,
            group: Some(group),
        } => {
            let mut groups = Map::new();
            for (name, values) in columns::grouped(table, group, value)? {
                groups.insert(name, plain(&tests::normality(&values)?));
            }
            json!({ "group": groups })
        }
        Test::Levene { group, value } => plain(&tests::levene(
            &columns::labels(table, group)?,
            &table.numbers(value)?,
        )?),
        Test::Alpha { items, subject } => {
            let found: Result<Vec<_>, StudyError> = items
                .iter()
                .map(|item| Ok((item.as_str(), table.numbers(item)?)))
                .collect();
            let found = found?;
            let items: Vec<(&str, &[Option<f64>])> =
                found.iter().map(|(n, c)| (*n, c.as_slice())).collect();
            let people = subject
                .as_ref()
                .map(|s| columns::labels(table, s))
                .transpose()?;
            plain(&tests::alpha(&items, people.as_deref())?)
        }
        Test::Adjust { p } => plain(&tests::adjust(&table.all_numbers(p)?)?),
        Test::Bootstrap {
            resampled,
            resamples,
            seed,
        } => bootstrap(table, resampled, *resamples, *seed)?,
        Test::Power => plain(&tests::power(&columns::power_questions(table)?)?),
        Test::Recheck => plain(&tests::recheck(&columns::reported(table)?)?),
        Test::Design(design) => designs::run(table, design)?,
        // The others have sentences.
        _ => Value::Null,
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
    resampled: &Resampled,
    resamples: usize,
    seed: u64,
) -> Result<Value, StudyError> {
    let settings = BootstrapSettings {
        resamples,
        seed,
        confidence: 1.0 - ALPHA,
    };
    let found = match resampled {
        Resampled::Column { statistic, value } => {
            let values = table.numbers(value)?;
            tests::bootstrap(*statistic, BootstrapData::Values(&values), &settings)
        }
        Resampled::Pair { statistic, x, y } => {
            let (x, y) = (table.numbers(x)?, table.numbers(y)?);
            tests::bootstrap(*statistic, BootstrapData::Pairs(&x, &y), &settings)
        }
        Resampled::Design { statistic, columns } => {
            let data = columns::within(table, columns)?;
            tests::bootstrap(*statistic, BootstrapData::Within(&data), &settings)
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
