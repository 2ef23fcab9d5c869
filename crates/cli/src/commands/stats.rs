//! `maveric stats`.

use super::{Of, Runs, print_outcome, read_words};
use crate::diagnostics::Failure;
use clap::{Args, CommandFactory as _, Subcommand};
use maveric_study::{
    Outcome,
    stages::{analyse::Analyse, stats::AnyTest},
    tables::TableBuilder,
};
use path_slash::PathExt as _;
use serde_json::Value;
use std::sync::{LazyLock, Mutex};

/// One test on a tidy table (CSV, Parquet or - for standard input), or the paper's whole analysis
#[derive(Debug, Args)]
#[command(after_help = "\
Each call's own --help says which columns its table needs. Every call also takes rows by --where, and gives tables by --latex or
--markdown. Those that compare conditions or groups take a column each by --wide. All but adjust, power and recheck give the sentence
alone by --apa; all but these, mcnemar, cochran-q, normality, levene, alpha and bootstrap draw by --figure.
Examples: maveric stats compare data.csv --subject id --within condition --value score
          maveric stats compare data.csv --wide slow,fast,other --where session=2 --figure scores.svg
          maveric stats correlate data.csv --x age --y speed --method auto --format json
          maveric stats study study_data/generated/paper --out analysis.json")]
pub(crate) struct Stats {
    #[command(subcommand)]
    asked: Asked,
}

#[derive(Debug, Subcommand)]
enum Asked {
    #[command(flatten)]
    Test(AnyTest),
    #[command(visible_alias = "paper")]
    Study(Of<Analyse>),
}

const DOING: &str = "could not run the test";

impl Stats {
    /// The analysis of a whole study, if that is what it is.
    pub(crate) fn study(&mut self) -> Option<&mut dyn Runs> {
        match &mut self.asked {
            Asked::Study(study) => Some(study),
            Asked::Test(_) => None,
        }
    }

    pub(crate) fn run(self) -> Result<(), Failure> {
        match self.asked {
            Asked::Test(test) => {
                complete(&test)?;
                print_outcome(test.format(), DOING, |_| test.run())
            }
            Asked::Study(mut study) => study.run(),
        }
    }
}

/// Refuses a call without the columns that it needs.
fn complete(test: &AnyTest) -> Result<(), Failure> {
    let refuse = |flags| Err(Failure::Usage(format!("this test needs {flags}")));
    test.lacks().map_or(Ok(()), refuse)
}

/// A call of `maveric stats` without its table.
#[derive(Debug, clap::Parser)]
#[command(name = "maveric stats", no_binary_name = true)]
struct Call {
    #[command(subcommand)]
    asked: Asked,
}

/// Its words and flags, put together once: that takes longer than many a test.
static CALL: LazyLock<Mutex<clap::Command>> = LazyLock::new(|| Mutex::new(Call::command()));

/// One call of `maveric stats` over a table in memory: `words` are those of the command after `stats`, the table's name among them.
///
/// # Errors
/// The text that the command would print.
pub fn stats_of_table(words: &[String], table: TableBuilder) -> Result<Outcome<Value>, String> {
    let call: Call = read_words(&CALL, words).map_err(|e| e.to_string())?;
    let Asked::Test(test) = call.asked else {
        return Err("`stats study` reads a run's folder: run it as a command".to_owned());
    };
    complete(&test).map_err(|e| e.text())?;
    test.run_on(|name| table.table(&name.to_slash_lossy()))
        .map_err(|e| Failure::study(DOING)(e).text())
}
