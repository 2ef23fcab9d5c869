//! `maveric validate`.

use super::print_outcome;
use crate::{
    args::{Format, Repeat},
    diagnostics::Failure,
};
use maveric_study::stages::validate::{self, ValidateOptions};

/// Check on people who drove twice whether the learned style is theirs: identity, fidelity, dial, aggression line
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: maveric validate study_data/generated/validate --model models/1.maveric --model models/2.maveric --out validation"
)]
pub(crate) struct Validate {
    /// A run's results with second drives: see `generate --repeat-drives` and pipelines/validate.toml
    run: std::path::PathBuf,
    /// Trained model; several of them, of the same training with other seeds, give ranges
    #[arg(long = "model", required = true)]
    models: Vec<std::path::PathBuf>,
    /// Folder to write into: validation.md, validation.json, one CSV a table
    #[arg(long)]
    out: std::path::PathBuf,
    /// World to drive in (TOML); the paper's when not given
    #[arg(long)]
    scenario: Option<std::path::PathBuf>,
    /// Length of a drive, in s; the scenario's when not given
    #[arg(long)]
    duration: Option<f64>,
    /// How far a step of the dial to either side is from the own style, in points of the ADB scale
    #[arg(long, default_value_t = 15.0)]
    points: f64,
    /// Roads on which each setting of the dial is driven; the measures are averaged
    #[arg(long, default_value_t = 1)]
    worlds: usize,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Threads
    #[arg(short, long, default_value_t = super::all_cores())]
    jobs: usize,
    #[command(flatten)]
    repeat: Repeat,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Validate {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = ValidateOptions {
            run: self.run,
            models: self.models,
            out: self.out,
            scenario: self.scenario,
            duration_s: self.duration,
            points: self.points,
            worlds: self.worlds,
            seed: self.seed,
            jobs: self.jobs,
            command: self.repeat.command(),
        };
        print_outcome(self.format, "could not validate", |watch| {
            validate::validate(&options, watch)
        })
    }
}
