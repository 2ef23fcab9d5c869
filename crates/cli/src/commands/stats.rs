//! `maveric stats`.

mod choices;
mod designs;
mod table;

use super::{Of, Runs, print_outcome};
use crate::{args::Format, diagnostics::Failure};
use choices::{ADJUST, CORRELATION, POSTHOC, STATISTIC, one_of};
use clap::{Args, CommandFactory as _, FromArgMatches as _, Subcommand};
use maveric_study::{
    Outcome,
    stages::{
        analyse::Analyse,
        stats::{
            self, Adjustment, CorrelationMethod, PosthocTest, Request, Resampled, Statistic, Test,
            WithinColumns,
        },
    },
    tables::TableBuilder,
};
use path_slash::PathExt as _;
use serde_json::Value;
use std::sync::{LazyLock, Mutex, PoisonError};
use table::{Conditions, Input, Within, needs};

/// One test on a tidy table (CSV, Parquet or - for standard input), or the paper's whole analysis
#[derive(Debug, Args)]
#[command(after_help = "\
Each call's own --help says which columns its table needs. Every call also takes rows by --where and a column a condition by --wide,
and gives the sentence alone by --apa, tables by --latex or --markdown, and a figure by --figure.
Examples: maveric stats compare data.csv --subject id --within condition --value score
          maveric stats compare data.csv --wide slow,fast,other --where session=2 --figure scores.svg
          maveric stats correlate data.csv --x age --y speed --method auto --format json
          maveric stats study study_data/generated/paper --out analysis.json")]
pub(crate) struct Stats {
    #[command(subcommand)]
    test: TestArgs,
}

#[derive(Debug, Subcommand)]
enum TestArgs {
    /// The whole analysis of a within-subject design
    #[command(after_help = "\
The table: a row a cell, with subject, condition and value; or a column a condition, by --wide.
Example: maveric stats within data.csv --subject id --within condition --value score")]
    Within(Within),
    /// Repeated-measures ANOVA with Mauchly's test and corrected degrees of freedom
    #[command(after_help = "\
The table: a row a cell, with subject, condition and value; or a column a condition, by --wide.
Example: maveric stats rm-anova data.csv --subject id --within condition --value score --latex")]
    RmAnova(Within),
    /// Friedman's test: chi-squared, Iman-Davenport F, exact
    #[command(after_help = "\
The table: a row a cell, with subject, condition and value; or a column a condition, by --wide.
Example: maveric stats friedman data.csv --subject id --within condition --value score")]
    Friedman(Within),
    /// Every pair of conditions, adjusted
    #[command(after_help = "\
The table: a row a cell, with subject, condition and value; or a column a condition, by --wide.
Example: maveric stats posthoc data.csv --subject id --within condition --value score --test wilcoxon --adjust holm")]
    Posthoc {
        #[command(flatten)]
        within: Within,
        /// Test of a pair
        #[arg(long, value_parser = one_of(&POSTHOC), default_value = "t")]
        test: PosthocTest,
        /// Adjustment for the number of pairs
        #[arg(long, value_parser = one_of(&ADJUST), default_value = "holm")]
        adjust: Adjustment,
    },
    /// Correlation of two columns
    #[command(after_help = "\
The table: a row a person (or a measurement), with two columns of numbers.
Example: maveric stats correlate data.csv --x age --y speed --method auto --figure speed.svg")]
    Correlate {
        #[command(flatten)]
        input: Input,
        /// First column
        #[arg(long)]
        x: String,
        /// Second column
        #[arg(long)]
        y: String,
        /// Which coefficient
        #[arg(long, value_parser = one_of(&CORRELATION), default_value = "auto")]
        method: CorrelationMethod,
        /// Column that says whose row it is: warns where one subject has several rows
        #[arg(long)]
        subject: Option<String>,
    },
    /// Repeated-measures correlation: several rows a subject
    #[command(after_help = "\
The table: several rows a person, with the column of subjects and two of numbers.
Example: maveric stats rmcorr data.csv --subject id --x age --y speed")]
    Rmcorr {
        #[command(flatten)]
        input: Input,
        /// Column that says whose row it is
        #[arg(long)]
        subject: String,
        /// First column
        #[arg(long)]
        x: String,
        /// Second column
        #[arg(long)]
        y: String,
    },
    /// Shapiro-Wilk and the moments of a column
    #[command(after_help = "\
The table: a row a value, with a column of numbers, and of groups if there are any.
Example: maveric stats normality data.csv --value score --group condition")]
    Normality {
        #[command(flatten)]
        input: Input,
        /// Column with the value
        #[arg(long)]
        value: String,
        /// Column that groups the rows
        #[arg(long)]
        group: Option<String>,
    },
    /// Equal variances: Levene, Brown-Forsythe, Bartlett
    #[command(after_help = "\
The table: a row a person, with the columns of group and value.
Example: maveric stats levene data.csv --group group --value score")]
    Levene {
        #[command(flatten)]
        input: Input,
        /// Column that groups the rows
        #[arg(long)]
        group: String,
        /// Column with the value
        #[arg(long)]
        value: String,
    },
    /// Cronbach's alpha of a scale
    #[command(after_help = "\
The table: a row an answer sheet, with a column an item, reversed items turned already; and a column of people where they filled in several.
Examples: maveric stats alpha data.csv --items q1,q2,q3
          maveric stats alpha data.csv --items q1,q2,q3 --subject id")]
    Alpha {
        #[command(flatten)]
        input: Input,
        /// Columns of the items
        #[arg(long, value_delimiter = ',', required = true)]
        items: Vec<String>,
        /// Column that says whose sheet it is, where people answered several: the interval then draws whole people
        #[arg(long)]
        subject: Option<String>,
    },
    /// Adjust p values for their number
    #[command(after_help = "\
The table: a row a test, with a column of p values.
Example: maveric stats adjust data.csv --p p")]
    Adjust {
        #[command(flatten)]
        input: Input,
        /// Column of p values
        #[arg(long)]
        p: String,
    },
    /// Percentile and BCa intervals by resampling
    #[command(after_help = "\
The table: a column of values; two of a correlation; or, as for `within`, a row a cell.
Examples: maveric stats bootstrap data.csv --statistic median --value score --resamples 2000 --seed 3
          maveric stats bootstrap data.csv --statistic eta2_partial --subject id --within condition --value score")]
    Bootstrap {
        #[command(flatten)]
        input: Input,
        /// What to estimate
        #[arg(long, value_parser = one_of(&STATISTIC))]
        statistic: Statistic,
        /// Column with the value
        #[arg(long)]
        value: Option<String>,
        /// First column of a correlation
        #[arg(long)]
        x: Option<String>,
        /// Second column of a correlation
        #[arg(long)]
        y: Option<String>,
        #[command(flatten)]
        conditions: Conditions,
        /// Resamples
        #[arg(long, default_value_t = 10_000)]
        resamples: usize,
        /// Root of the random choice
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
    /// Power of a design, and the sample for 80 %: a question a row
    #[command(after_help = "\
The table: a question a row. test: paired_t, pearson or rm_anova; n: people; effect: dz, r or partial eta squared; alpha;
of rm_anova also k (conditions), corr (between them) and epsilon. Other columns are not read.
Example: maveric stats power questions.csv")]
    Power {
        #[command(flatten)]
        input: Input,
    },
    /// Does each printed p follow from its printed coefficient and degrees of freedom?
    #[command(after_help = "\
The table: a printed correlation a row, as text. coefficient: .46 or -.71; df; p: =.012, <.001 or .012. Other columns are not read.
Example: maveric stats recheck printed.csv")]
    Recheck {
        #[command(flatten)]
        input: Input,
    },
    #[command(flatten)]
    Design(designs::DesignArgs),
    #[command(visible_alias = "paper")]
    Study(Of<Analyse>),
}

/// What was asked for.
enum Asked {
    Test(Format, Request),
    Study(Of<Analyse>),
}

const DOING: &str = "could not run the test";

impl Stats {
    /// The analysis of a whole study, if that is what it is.
    pub(crate) fn study(&mut self) -> Option<&mut dyn Runs> {
        match &mut self.test {
            TestArgs::Study(study) => Some(study),
            _ => None,
        }
    }

    pub(crate) fn run(self) -> Result<(), Failure> {
        match self.test.asked()? {
            Asked::Test(format, request) => {
                print_outcome(format, DOING, |_| stats::stats(&request))
            }
            Asked::Study(mut study) => study.run(),
        }
    }
}

/// A call of `maveric stats` without its table.
#[derive(Debug, clap::Parser)]
#[command(name = "maveric stats", no_binary_name = true)]
struct Call {
    #[command(subcommand)]
    test: TestArgs,
}

/// Its words and flags, put together once: that takes longer than many a test.
static CALL: LazyLock<Mutex<clap::Command>> = LazyLock::new(|| Mutex::new(Call::command()));

impl Call {
    fn of(words: &[String]) -> Result<Self, clap::Error> {
        let mut command = CALL.lock().unwrap_or_else(PoisonError::into_inner);
        let matches = command.try_get_matches_from_mut(words)?;
        Self::from_arg_matches(&matches).map_err(|error| error.format(&mut command))
    }
}

/// One call of `maveric stats` over a table in memory: `words` are those of the command after `stats`, the table's name among them.
///
/// # Errors
/// The text that the command would print.
pub fn stats_of_table(words: &[String], table: TableBuilder) -> Result<Outcome<Value>, String> {
    let call = Call::of(words).map_err(|e| e.to_string())?;
    let asked = call.test.asked().map_err(|e| e.text())?;
    let Asked::Test(_, request) = asked else {
        return Err("`stats study` reads a run's folder: run it as a command".to_owned());
    };
    let name = request.data.to_slash_lossy().into_owned();
    stats::stats_of(|| table.table(&name), &request).map_err(|e| Failure::study(DOING)(e).text())
}

impl TestArgs {
    fn asked(self) -> Result<Asked, Failure> {
        let (input, test) = match self {
            TestArgs::Study(study) => return Ok(Asked::Study(study)),
            TestArgs::Within(w) => with(w, Test::Within),
            TestArgs::RmAnova(w) => with(w, Test::RmAnova),
            TestArgs::Friedman(w) => with(w, Test::Friedman),
            TestArgs::Posthoc {
                within,
                test,
                adjust,
            } => {
                let (input, columns) = within.split();
                (
                    input,
                    Test::Posthoc {
                        columns,
                        test,
                        adjust,
                    },
                )
            }
            TestArgs::Correlate {
                input,
                x,
                y,
                method,
                subject,
            } => (
                input,
                Test::Correlate {
                    x,
                    y,
                    method,
                    subject,
                },
            ),
            TestArgs::Rmcorr {
                input,
                subject,
                x,
                y,
            } => (input, Test::Rmcorr { subject, x, y }),
            TestArgs::Normality {
                input,
                value,
                group,
            } => (input, Test::Normality { value, group }),
            TestArgs::Levene {
                input,
                group,
                value,
            } => (input, Test::Levene { group, value }),
            TestArgs::Alpha {
                input,
                items,
                subject,
            } => (input, Test::Alpha { items, subject }),
            TestArgs::Adjust { input, p } => (input, Test::Adjust { p }),
            TestArgs::Bootstrap {
                input,
                statistic,
                value,
                x,
                y,
                conditions,
                resamples,
                seed,
            } => {
                let resampled = resampled(statistic, value, (x, y), conditions)?;
                (
                    input,
                    Test::Bootstrap {
                        resampled,
                        resamples,
                        seed,
                    },
                )
            }
            TestArgs::Power { input } => (input, Test::Power),
            TestArgs::Recheck { input } => (input, Test::Recheck),
            TestArgs::Design(design) => design.split()?,
        };
        Ok(Asked::Test(input.format, input.request(test)))
    }
}

fn with(within: Within, test: impl FnOnce(WithinColumns) -> Test) -> (Input, Test) {
    let (input, columns) = within.split();
    (input, test(columns))
}

fn resampled(
    statistic: Statistic,
    value: Option<String>,
    (x, y): (Option<String>, Option<String>),
    conditions: Conditions,
) -> Result<Resampled, Failure> {
    Ok(match statistic {
        Statistic::Mean | Statistic::Median => Resampled::Column {
            statistic,
            value: value.ok_or_else(|| needs("--value"))?,
        },
        Statistic::Pearson | Statistic::Spearman => {
            let (x, y) = x.zip(y).ok_or_else(|| needs("--x and --y"))?;
            Resampled::Pair { statistic, x, y }
        }
        _ => {
            let columns = value.and_then(|value| conditions.columns(&value));
            let columns = columns.ok_or_else(|| needs("--subject, --within and --value"))?;
            Resampled::Design { statistic, columns }
        }
    })
}
