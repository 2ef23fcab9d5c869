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

// Imported once, for the files of the tests as well.
use super::{
    Call, choices,
    columns::{Conditions, GroupColumns, WithinColumns, count, grouped, labels, yes_no},
    input::Long,
    pictures, printed,
    ran::{ALPHA, Ran, plain},
    roles::{Role, Roles},
    rows::{DesignRows, FactorColumns},
    statistical_test::{Test, by_its_columns},
};
use crate::{error::StudyError, outcome::Format, outcome::Outcome, tables::Table};
use serde_json::Value;

macro_rules! tests {
    ($($file:ident::$test:ident),+ $(,)?) => {
        /// Any of the tests, called.
        #[derive(Debug, Clone, clap::Subcommand)]
        pub enum AnyTest {
            $($test(Call<$file::$test>)),+
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
            pub fn run(&self) -> Result<Outcome<Value>, StudyError> {
                match self {
                    $(Self::$test(call) => call.run()),+
                }
            }

            /// As [`Call::run_on`]; `table` is given the name that the table has in messages.
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
    within::Within,
    rm_anova::RmAnova,
    friedman::Friedman,
    posthoc::Posthoc,
    mcnemar::Mcnemar,
    cochran_q::CochranQ,
    correlate::Correlate,
    rmcorr::Rmcorr,
    normality::Normality,
    levene::Levene,
    alpha::Alpha,
    adjust::Adjust,
    bootstrap::Bootstrap,
    power::Power,
    recheck::Recheck,
    compare::Compare,
    factorial::Factorial,
    mixed::Mixed,
    ordinal::Ordinal,
    groups::Groups,
    equivalence::Equivalence,
    bayes::Bayes,
];
