//! `maveric report`.

use super::print_outcome;
use crate::{
    args::{Format, Repeat},
    diagnostics::Failure,
};
use maveric_study::stages::report::{self, ReportOptions};

/// Draw the figures, tables and the page from the results of a run
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: maveric report study_data/generated/paper --out reports/paper")]
pub(crate) struct Report {
    /// Design of the study (TOML); study.toml of the folder one stands in when not given, else the paper's
    #[arg(long, value_name = "FILE")]
    design: Option<std::path::PathBuf>,
    /// Folder of results, as the pipeline leaves it
    results: std::path::PathBuf,
    /// Folder to write into: index.html, figures, tables
    #[arg(long)]
    out: std::path::PathBuf,
    /// Ledger of claims (TOML); the design's when not given, and none where it names none
    #[arg(long)]
    claims: Option<std::path::PathBuf>,
    /// A parameter of the run, for the page; a value that is a file is shown whole, with its hash
    #[arg(long = "param", value_name = "KEY=VALUE", value_parser = parameter)]
    parameters: Vec<(String, String)>,
    /// Table of who took part; RESULTS/participants.csv when not given
    #[arg(long)]
    participants: Option<std::path::PathBuf>,
    #[command(flatten)]
    repeat: Repeat,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Report {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = ReportOptions {
            design: self.design,
            results: self.results,
            out: self.out,
            claims: self.claims,
            command: self.repeat.command(),
            parameters: self.parameters,
            participants: self.participants,
        };
        print_outcome(self.format, "could not write the report", |watch| {
            report::report(&options, watch)
        })
    }
}

fn parameter(text: &str) -> Result<(String, String), String> {
    let parts = text.split_once('=').filter(|(key, _)| !key.is_empty());
    let (key, value) = parts.ok_or_else(|| format!("`{text}` is not KEY=VALUE, such as seed=1"))?;
    Ok((key.to_owned(), value.to_owned()))
}
