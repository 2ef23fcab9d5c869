//! `maveric simulate`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::simulate::{self, SimulateOptions};

/// Drive each participant's conditions in the simulator
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: maveric simulate --model model.maveric --conditions conditions.csv --out av"
)]
pub(crate) struct Simulate {
    /// Trained model
    #[arg(long)]
    model: std::path::PathBuf,
    /// Conditions to drive
    #[arg(long)]
    conditions: std::path::PathBuf,
    /// Folder to write into: logs (MCAP), drives (Parquet), rollouts.csv
    #[arg(long)]
    out: std::path::PathBuf,
    /// World to drive in (TOML); the paper's when not given
    #[arg(long)]
    scenario: Option<std::path::PathBuf>,
    /// Length of a drive, in s; the scenario's when not given
    #[arg(long)]
    duration: Option<f64>,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Threads
    #[arg(short, long, default_value_t = super::all_cores())]
    jobs: usize,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Simulate {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = SimulateOptions {
            model: self.model,
            conditions: self.conditions,
            out: self.out,
            scenario: self.scenario,
            duration_s: self.duration,
            seed: self.seed,
            jobs: self.jobs,
        };
        print_outcome(self.format, "could not simulate", |watch| {
            simulate::simulate(&options, watch)
        })
    }
}
