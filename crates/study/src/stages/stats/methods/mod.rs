//! The tests: a file each, and a line in the list below.

mod adjust;
mod alpha;
mod bayes;
mod bootstrap;
mod cochran_q;
mod compare;
mod correlate;
mod equivalence;
mod factorial;
mod friedman;
mod groups;
mod levene;
mod mcnemar;
mod mixed;
mod normality;
mod ordinal;
mod posthoc;
mod power;
mod recheck;
mod rm_anova;
mod rmcorr;
mod within;

use super::{Call, statistical_test::Test as _};
use crate::{error::StudyError, outcome::Format, outcome::Outcome, tables::Table};
use serde_json::Value;

use adjust::Adjust;
use alpha::Alpha;
use bayes::Bayes;
use bootstrap::Bootstrap;
use cochran_q::CochranQ;
use compare::Compare;
use correlate::Correlate;
use equivalence::Equivalence;
use factorial::Factorial;
use friedman::Friedman;
use groups::Groups;
use levene::Levene;
use mcnemar::Mcnemar;
use mixed::Mixed;
use normality::Normality;
use ordinal::Ordinal;
use posthoc::Posthoc;
use power::Power;
use recheck::Recheck;
use rm_anova::RmAnova;
use rmcorr::Rmcorr;
use within::Within;

macro_rules! tests {
    ($($test:ident),+ $(,)?) => {
        /// Any of the tests, called.
        #[derive(Debug, Clone, clap::Subcommand)]
        #[allow(missing_docs, reason = "a doc comment would stand in the help of the test")]
        pub enum AnyTest {
            $($test(Call<$test>)),+
        }

        impl AnyTest {
            /// How the result is printed.
            pub fn format(&self) -> Format {
                match self {
                    $(Self::$test(call) => call.input.format),+
                }
            }

            /// Options without which it cannot run, if one is lacking.
            pub fn lacks(&self) -> Option<&'static str> {
                match self {
                    $(Self::$test(call) => call.test.lacks()),+
                }
            }

            /// As [`Call::run`].
            ///
            /// # Errors
            /// As [`Call::run`].
            pub fn run(&self) -> Result<Outcome<Value>, StudyError> {
                match self {
                    $(Self::$test(call) => call.run()),+
                }
            }

            /// As [`Call::run_on`]; `table` is given the name that the table has in messages.
            ///
            /// # Errors
            /// As [`Call::run_on`].
            pub fn run_on(
                &self,
                table: impl FnOnce(&std::path::Path) -> Result<Table, StudyError>,
            ) -> Result<Outcome<Value>, StudyError> {
                match self {
                    $(Self::$test(call) => call.run_on(|| table(&call.input.data))),+
                }
            }
        }
    };
}

tests![
    Within,
    RmAnova,
    Friedman,
    Posthoc,
    Mcnemar,
    CochranQ,
    Correlate,
    Rmcorr,
    Normality,
    Levene,
    Alpha,
    Adjust,
    Bootstrap,
    Power,
    Recheck,
    Compare,
    Factorial,
    Mixed,
    Ordinal,
    Groups,
    Equivalence,
    Bayes,
];
