//! `maveric rate`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::rate::{self, RateOptions};

/// Let the synthetic participants rate what each condition did
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: maveric rate --measures measurements.parquet --participants participants.csv --out ratings.csv"
)]
pub(crate) struct Rate {
    /// Design of the study (TOML); study.toml of the folder one stands in when not given, else the paper's
    #[arg(long, value_name = "FILE")]
    design: Option<std::path::PathBuf>,
    /// Measurements of own and AV drives
    #[arg(long)]
    measures: std::path::PathBuf,
    /// The synthetic participants
    #[arg(long)]
    participants: std::path::PathBuf,
    /// Sizes of the effects (TOML)
    #[arg(long, default_value = "study_data/effects.toml")]
    effects: std::path::PathBuf,
    /// Folder of questionnaire definitions
    #[arg(long, default_value = "study_data/scales")]
    scales: std::path::PathBuf,
    /// Answers to write
    #[arg(long)]
    out: std::path::PathBuf,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Rate {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = RateOptions {
            design: self.design,
            measures: self.measures,
            participants: self.participants,
            effects: self.effects,
            scales: self.scales,
            out: self.out,
            seed: self.seed,
        };
        print_outcome(self.format, "could not rate", |watch| {
            rate::rate(&options, watch)
        })
    }
}
