//! `maveric measure`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::measure::{self, MeasureOptions};

/// Measure drives: the seven objective measures, a row a drive
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: maveric measure --drives drives/study2 --drives av/drives --out measurements.parquet"
)]
pub(crate) struct Measure {
    /// Folder of drives; may be given more than once
    #[arg(long, required = true)]
    drives: Vec<std::path::PathBuf>,
    /// Design of the study (TOML); study.toml of the folder one stands in when not given. Without either nothing is left out
    #[arg(long, value_name = "FILE")]
    design: Option<std::path::PathBuf>,
    /// Who takes part; the design's table when not given
    #[arg(long)]
    participants: Option<std::path::PathBuf>,
    /// Table to write (CSV or Parquet by its name)
    #[arg(long)]
    out: std::path::PathBuf,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Measure {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = MeasureOptions {
            design: self.design,
            participants: self.participants,
            drives: self.drives,
            out: self.out,
        };
        print_outcome(self.format, "could not measure", |watch| {
            measure::measure(&options, watch)
        })
    }
}
