//! What every call of `maveric stats` says of its table, and the columns that several of them read.

use crate::{args::Format, diagnostics::Failure};
use clap::{Args, builder::ArgPredicate};
use maveric_study::stages::stats::{self, FactorColumns, Request, Show, Test, WithinColumns};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct Input {
    /// Table to read: CSV, TSV, Parquet, or - for CSV on standard input
    data: PathBuf,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    pub(super) format: Format,
    /// Keep the rows that have this value in this column; several: all of them
    #[arg(long = "where", value_name = "COLUMN=VALUE", value_parser = column_and_value, help_heading = "The table")]
    keep: Vec<(String, String)>,
    /// Columns that are conditions, in the place of --within and --value (which then name what they become); without --subject a row is a subject
    #[arg(
        long,
        value_name = "A,B,…",
        value_delimiter = ',',
        help_heading = "The table"
    )]
    wide: Vec<String>,
    /// Print the sentences alone, as APA has them
    #[arg(long, group = "shown", help_heading = "The result")]
    apa: bool,
    /// Print the tables in LaTeX (booktabs)
    #[arg(long, group = "shown", help_heading = "The result")]
    latex: bool,
    /// Print the tables in Markdown
    #[arg(long, group = "shown", help_heading = "The result")]
    markdown: bool,
    /// Draw the result into this file
    #[arg(long, value_name = "OUT.svg|png|pdf", help_heading = "The result")]
    figure: Option<PathBuf>,
}

impl Input {
    pub(super) fn request(self, test: Test) -> Request {
        let show = match (self.apa, self.latex, self.markdown) {
            (true, _, _) => Show::Apa,
            (_, true, _) => Show::Latex,
            (_, _, true) => Show::Markdown,
            _ => Show::Report,
        };
        Request {
            data: self.data,
            input: stats::Input {
                keep: self.keep,
                wide: self.wide,
            },
            test,
            show,
            figure: self.figure,
        }
    }
}

fn column_and_value(text: &str) -> Result<(String, String), String> {
    let parts = text
        .split_once('=')
        .filter(|(column, _)| !column.is_empty());
    parts
        .map(|(column, value)| (column.to_owned(), value.to_owned()))
        .ok_or_else(|| "expected COLUMN=VALUE, as in session=2".to_owned())
}

#[derive(Debug, Args)]
#[expect(
    clippy::struct_field_names,
    reason = "the fields are named as their flags"
)]
pub(super) struct Within {
    #[command(flatten)]
    input: Input,
    /// Column that says whose row it is
    #[arg(
        long,
        required = false,
        required_unless_present = "wide",
        default_value_if("wide", ArgPredicate::IsPresent, stats::ROW)
    )]
    subject: String,
    /// Column that says in which condition
    #[arg(
        long,
        required = false,
        required_unless_present = "wide",
        default_value_if("wide", ArgPredicate::IsPresent, "condition")
    )]
    within: String,
    /// Column with the value; several, as in score,speed, are analysed one by one
    #[arg(
        long,
        required = false,
        required_unless_present = "wide",
        default_value_if("wide", ArgPredicate::IsPresent, "value")
    )]
    value: String,
}

impl Within {
    pub(super) fn split(self) -> (Input, WithinColumns) {
        let columns = WithinColumns {
            subject: self.subject,
            within: self.within,
            value: self.value,
        };
        (self.input, columns)
    }
}

/// The factors of a design: within, between, or both.
#[derive(Debug, Args)]
pub(super) struct Factors {
    #[command(flatten)]
    input: Input,
    /// Column that says whose row it is; without --within every row is a subject
    #[arg(
        long,
        required_unless_present_any = ["between", "wide"],
        default_value_if("wide", ArgPredicate::IsPresent, stats::ROW)
    )]
    subject: Option<String>,
    /// Columns of the factors within subjects, one or two
    #[arg(
        long,
        value_delimiter = ',',
        requires = "subject",
        required_unless_present_any = ["between", "wide"],
        default_value_if("wide", ArgPredicate::IsPresent, "condition")
    )]
    within: Vec<String>,
    /// Columns of the factors between subjects, one or two
    #[arg(long, value_delimiter = ',', conflicts_with = "wide")]
    between: Vec<String>,
    /// Column with the value; several, as in score,speed, are analysed one by one
    #[arg(
        long,
        required = false,
        required_unless_present = "wide",
        default_value_if("wide", ArgPredicate::IsPresent, "value")
    )]
    value: String,
}

impl Factors {
    pub(super) fn split(self) -> (Input, FactorColumns) {
        let columns = FactorColumns {
            subject: self.subject,
            within: self.within,
            between: self.between,
            covariates: Vec::new(),
            products: Vec::new(),
            value: self.value,
        };
        (self.input, columns)
    }
}

/// Conditions of the same people, where a call can do without them.
#[derive(Debug, Args)]
pub(super) struct Conditions {
    /// Column that says whose row it is
    #[arg(long, requires = "within")]
    subject: Option<String>,
    /// Column that says in which condition
    #[arg(long, requires = "subject")]
    within: Option<String>,
}

impl Conditions {
    pub(super) fn columns(self, value: &str) -> Option<WithinColumns> {
        Some(WithinColumns {
            subject: self.subject?,
            within: self.within?,
            value: value.to_owned(),
        })
    }
}

/// A call without the columns that it needs.
pub(super) fn needs(flags: &str) -> Failure {
    Failure::Usage(format!("this test needs {flags}"))
}
