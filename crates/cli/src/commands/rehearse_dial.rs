//! `maveric rehearse-dial`.

use super::print_outcome;
use crate::{
    args::{Format, Repeat},
    diagnostics::Failure,
};
use maveric_study::stages::rehearse_dial::{self, RehearseDialOptions};

/// Try the recommended shift on made-up people whose preference is known, and count the trials it takes to learn one
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: maveric rehearse-dial --participants 24,48,96 --studies 20 --out reports/dial"
)]
pub(crate) struct RehearseDial {
    /// What drives look like (TOML)
    #[arg(long, default_value = "study_data/population.toml")]
    population: std::path::PathBuf,
    /// Sizes of the effects (TOML)
    #[arg(long, default_value = "study_data/effects.toml")]
    effects: std::path::PathBuf,
    /// Folder of questionnaire definitions
    #[arg(long, default_value = "study_data/scales")]
    scales: std::path::PathBuf,
    /// Participants of the studies to learn from; several sizes, ascending
    #[arg(long, value_delimiter = ',', default_value = "24,48,96")]
    participants: Vec<usize>,
    /// Studies of each size
    #[arg(long, default_value_t = 20)]
    studies: usize,
    /// Trials of each new person
    #[arg(long, default_value_t = 14)]
    trials: usize,
    /// Folder to write into: dial.json and a page with figures and tables
    #[arg(long)]
    out: std::path::PathBuf,
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

impl RehearseDial {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = RehearseDialOptions {
            population: self.population,
            effects: self.effects,
            scales: self.scales,
            participants: self.participants,
            studies: self.studies,
            trials: self.trials,
            out: self.out,
            seed: self.seed,
            jobs: self.jobs,
            command: self.repeat.command(),
        };
        print_outcome(self.format, "could not rehearse the dial", |watch| {
            rehearse_dial::rehearse_dial(&options, watch)
        })
    }
}
