//! `stats`: one test on a tidy table.

mod columns;
mod designs;
mod input;
mod pictures;
mod printed;

pub use designs::{Bounds, DesignTest, FactorialColumns, FactorialMethod, Formula};
pub use input::{Input, ROW};
pub use maveric_stats::{Adjustment, CorrelationMethod, PosthocTest, Statistic};

use crate::{error::StudyError, outcome::Outcome, outputs::spare_inputs, tables::Table};
use input::Long;
use maveric_stats::{
    self as tests, Bootstrap, BootstrapData, BootstrapSettings,
    apa::{Statement, Statements},
};
use pictures::Picture;
use printed::Printed;
use serde_json::{Map, Value, json};
use std::path::PathBuf;

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
    fn long(&self) -> Long<'_> {
        Long {
            subject: Some(&self.subject),
            within: &self.within,
            value: &self.value,
        }
    }
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

/// What one test gives.
struct Ran {
    value: Value,
    said: Vec<(String, Statement)>,
    printed: Printed,
    picture: Option<Picture>,
}

impl Ran {
    /// A result that says itself; its sentences stand in the JSON as `apa`.
    fn of<T: serde::Serialize + Statements>(found: &T, printed: Printed) -> Self {
        let said = found.statements();
        let mut value = plain(found);
        if let Value::Object(object) = &mut value {
            let texts = said
                .iter()
                .map(|(name, s)| (name.clone(), s.to_string().into()));
            object.insert("apa".to_owned(), Value::Object(texts.collect()));
        }
        Self {
            value,
            said,
            printed,
            picture: None,
        }
    }

    /// A result whose report is its numbers.
    fn plainly<T: serde::Serialize + Statements>(found: &T) -> Self {
        let sentences = found.statements().into_iter();
        let sentences = sentences
            .map(|(_, said)| said.markup().to_owned())
            .collect();
        Self::of(found, printed::plain(&plain(found), sentences))
    }

    /// Numbers that are not said in a sentence.
    fn numbers(value: Value) -> Self {
        Self {
            printed: printed::plain(&value, Vec::new()),
            said: Vec::new(),
            picture: None,
            value,
        }
    }

    fn drawn(mut self, picture: Picture) -> Self {
        self.picture = Some(picture);
        self
    }

    fn lines(&self, show: Show) -> Vec<String> {
        match show {
            Show::Report => self.printed.text(),
            Show::Latex => self.printed.latex(),
            Show::Markdown => self.printed.markdown(),
            Show::Apa if self.said.len() == 1 => vec![self.said[0].1.to_string()],
            Show::Apa => self
                .said
                .iter()
                .map(|(name, s)| format!("{name}: {s}"))
                .collect(),
        }
    }
}

/// Runs a test, or one for each of several outcomes; the value is the JSON of the contract, names as in the field's textbooks.
/// Several outcomes stand under `value`, each under its name.
///
/// # Errors
/// [`StudyError`] naming file, row and column, and the shape that was found where the test refuses it; before anything is read, if
/// the figure is neither SVG nor PNG, or the test has nothing to draw.
pub fn stats(request: &Request) -> Result<Outcome<Value>, StudyError> {
    spare_inputs([&*request.data], request.figure.as_deref())?;
    if let Some(path) = &request.figure {
        pictures::svg(path)?;
        if !request.test.has_figure() {
            return Err(StudyError::NotPossible {
                problem: format!("`{}` has nothing to draw", request.test.name()),
                help: Some("leave out --figure".to_owned()),
            });
        }
    }
    let whole = Table::read(&request.data)?;
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
        let mut found = run(&table, test).map_err(|e| with_shape(e, &table, input))?;
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

impl Test {
    /// Its name on the command line.
    fn name(&self) -> &'static str {
        match self {
            Self::Within(_) => "within",
            Self::RmAnova(_) => "rm-anova",
            Self::Friedman(_) => "friedman",
            Self::Compare(_) => "compare",
            Self::Posthoc { .. } => "posthoc",
            Self::Correlate { .. } => "correlate",
            Self::Rmcorr { .. } => "rmcorr",
            Self::Normality { .. } => "normality",
            Self::Levene { .. } => "levene",
            Self::Alpha { .. } => "alpha",
            Self::Adjust { .. } => "adjust",
            Self::Bootstrap { .. } => "bootstrap",
            Self::Power => "power",
            Self::Recheck => "recheck",
            Self::Design(design) => design.name(),
        }
    }

    /// The columns that a wide table becomes; `None` if the test compares no conditions.
    fn long(&self) -> Option<Long<'_>> {
        match self {
            Self::Within(c) | Self::RmAnova(c) | Self::Friedman(c) | Self::Compare(c) => {
                Some(c.long())
            }
            Self::Posthoc { columns, .. }
            | Self::Bootstrap {
                resampled: Resampled::Design { columns, .. },
                ..
            } => Some(columns.long()),
            Self::Levene { group, value }
            | Self::Normality {
                value,
                group: Some(group),
            } => Some(Long {
                subject: None,
                within: group,
                value,
            }),
            Self::Design(design) => design.long(),
            _ => None,
        }
    }

    /// The column of values, if there is one.
    fn value(&mut self) -> Option<&mut String> {
        match self {
            Self::Within(c) | Self::RmAnova(c) | Self::Friedman(c) | Self::Compare(c) => {
                Some(&mut c.value)
            }
            Self::Posthoc { columns, .. }
            | Self::Bootstrap {
                resampled: Resampled::Design { columns, .. },
                ..
            } => Some(&mut columns.value),
            Self::Bootstrap {
                resampled: Resampled::Column { value, .. },
                ..
            }
            | Self::Normality { value, .. }
            | Self::Levene { value, .. } => Some(value),
            Self::Design(design) => design.value(),
            _ => None,
        }
    }

    /// The test of each of several values; a column may have a comma in its name.
    fn by_value(&self, table: &Table) -> Vec<(String, Self)> {
        let mut test = self.clone();
        let named = test.value().map(|value| value.clone()).unwrap_or_default();
        if table.has(&named) || !named.contains(',') {
            return vec![(named, test)];
        }
        let one = |name: &str| {
            let mut test = self.clone();
            if let Some(value) = test.value() {
                name.trim().clone_into(value);
            }
            (name.trim().to_owned(), test)
        };
        named.split(',').map(one).collect()
    }

    /// Whether there is something to draw: conditions, groups, contrasts, or two columns.
    fn has_figure(&self) -> bool {
        !matches!(
            self,
            Self::Normality { .. }
                | Self::Levene { .. }
                | Self::Alpha { .. }
                | Self::Adjust { .. }
                | Self::Bootstrap { .. }
                | Self::Power
                | Self::Recheck
                | Self::Design(_)
        )
    }
}

fn run(table: &Table, test: &Test) -> Result<Ran, StudyError> {
    Ok(match test {
        Test::Within(c) => {
            let data = columns::within(table, c)?;
            let found = tests::within(&data);
            let p = found.paired.values().map(|pair| pair.p_holm);
            let picture =
                pictures::conditions(&data, &c.value, pictures::first(&found), &found.desc, p);
            Ran::of(&found, printed::whole(&found)).drawn(picture)
        }
        Test::RmAnova(c) => {
            let data = columns::within(table, c)?;
            let found = tests::rm_anova(&data);
            let none = std::iter::empty();
            let picture =
                pictures::conditions(&data, &c.value, pictures::first(&found), &found.desc, none);
            Ran::of(&found, printed::rm_anova(&found)).drawn(picture)
        }
        Test::Friedman(c) => {
            let data = columns::within(table, c)?;
            let found = tests::friedman(&data);
            let none = std::iter::empty();
            let picture =
                pictures::conditions(&data, &c.value, pictures::first(&found), &found.desc, none);
            Ran::of(&found, printed::friedman(&found)).drawn(picture)
        }
        Test::Compare(c) => {
            let data = columns::within(table, c)?;
            let found = tests::compare(&data, ALPHA)?;
            let p = found.posthoc.pairs.values().map(|pair| pair.p_adjusted);
            let picture =
                pictures::conditions(&data, &c.value, pictures::first(&found), &found.desc, p);
            Ran::of(&found, printed::comparison(&found)).drawn(picture)
        }
        Test::Posthoc {
            columns: c,
            test,
            adjust,
        } => {
            let data = columns::within(table, c)?;
            let found = tests::posthoc(&data, *test, *adjust, ALPHA)?;
            let desc = tests::rm_anova(&data).desc;
            let picture = pictures::pairs(&data, &c.value, &desc, &found);
            Ran::of(&found, printed::posthoc(&found)).drawn(picture)
        }
        Test::Correlate {
            x,
            y,
            method,
            subject,
        } => {
            let subjects = subject
                .as_ref()
                .map(|s| columns::labels(table, s))
                .transpose()?;
            let (of_x, of_y) = (table.numbers(x)?, table.numbers(y)?);
            let found = tests::correlate(&of_x, &of_y, *method, subjects.as_deref())?;
            let picture = pictures::correlation((x, &of_x), (y, &of_y), pictures::first(&found));
            Ran::of(&found, printed::correlation(&found, x, y)).drawn(picture)
        }
        Test::Rmcorr { subject, x, y } => {
            let subjects = columns::labels(table, subject)?;
            let (of_x, of_y) = (table.numbers(x)?, table.numbers(y)?);
            let found = tests::rm_correlation(&subjects, &of_x, &of_y)?;
            let (slope, said) = (found.rm_corr.slope, pictures::first(&found));
            let picture = pictures::within_people(&subjects, (x, &of_x), (y, &of_y), slope, said);
            Ran::of(&found, printed::rm_correlation(&found, x, y)).drawn(picture)
        }
        Test::Normality { value, group: None } => {
            Ran::plainly(&tests::normality(&table.numbers(value)?)?)
        }
        Test::Normality {
            value,
            group: Some(group),
        } => {
            let (mut groups, mut said) = (Map::new(), Vec::new());
            for (name, values) in columns::grouped(table, group, value)? {
                let found = tests::normality(&values)?;
                said.extend(
                    found
                        .statements()
                        .into_iter()
                        .map(|(_, s)| (name.clone(), s)),
                );
                groups.insert(name, plain(&found));
            }
            Ran {
                said,
                ..Ran::numbers(json!({ "group": groups }))
            }
        }
        Test::Levene { group, value } => Ran::plainly(&tests::levene(
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
            Ran::plainly(&tests::alpha(&items, people.as_deref())?)
        }
        Test::Adjust { p } => Ran::numbers(plain(&tests::adjust(&table.all_numbers(p)?)?)),
        Test::Bootstrap {
            resampled,
            resamples,
            seed,
        } => Ran::plainly(&bootstrap(table, resampled, *resamples, *seed)?),
        Test::Power => Ran::numbers(plain(&tests::power(&columns::power_questions(table)?)?)),
        Test::Recheck => Ran::numbers(plain(&tests::recheck(&columns::reported(table)?)?)),
        Test::Design(design) => Ran::numbers(designs::run(table, design)?),
    })
}

fn plain(found: &impl serde::Serialize) -> Value {
    serde_json::to_value(found).unwrap_or_default()
}

fn bootstrap(
    table: &Table,
    resampled: &Resampled,
    resamples: usize,
    seed: u64,
) -> Result<Bootstrap, StudyError> {
    let settings = BootstrapSettings {
        resamples,
        seed,
        confidence: 1.0 - ALPHA,
    };
    Ok(match resampled {
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
    }?)
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
