//! `maveric generate`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::{
    generate::{self, GenerateOptions},
    simulate::Scenes,
};

/// Make up a whole study: synthetic participants, their answers and their driving logs
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: maveric generate --out study_data/generated/paper --seed 1")]
pub(crate) struct Generate {
    /// Folder to write into: logs/study1, logs/study2, participants.csv, surveys.csv
    #[arg(long)]
    out: std::path::PathBuf,
    /// World to drive in (TOML); the paper's when not given
    #[arg(long)]
    scenario: Option<std::path::PathBuf>,
    /// Who drives (TOML), such as study_data/population_misspecified.toml; the scenario's people when not given
    #[arg(long)]
    population: Option<std::path::PathBuf>,
    /// Folder of questionnaire definitions
    #[arg(long, default_value = "study_data/scales")]
    scales: std::path::PathBuf,
    /// Sizes of the effects in their answers (TOML)
    #[arg(long, default_value = "study_data/effects.toml")]
    effects: std::path::PathBuf,
    /// Participants of Study 1
    #[arg(long, default_value_t = 30)]
    study1: usize,
    /// Participants of Study 2
    #[arg(long, default_value_t = 24)]
    study2: usize,
    /// Length of a drive, in s; the scenario's when not given
    #[arg(long)]
    duration: Option<f64>,
    /// Everybody drives as themselves once more, on another day: logs/study1-again, logs/study2-again
    #[arg(long)]
    repeat_drives: bool,
    /// Add a scene for Foxglove and Lichtblick to the logs: everybody's, or one participant's
    #[arg(long, value_name = "PARTICIPANT", num_args = 0..=1, default_missing_value = "all")]
    scene: Option<Scenes>,
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

impl Generate {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = GenerateOptions {
            out: self.out,
            scenario: self.scenario,
            population: self.population,
            scales: self.scales,
            effects: self.effects,
            study1: self.study1,
            study2: self.study2,
            duration_s: self.duration,
            repeat_drives: self.repeat_drives,
            scenes: self.scene.unwrap_or_default(),
            seed: self.seed,
            jobs: self.jobs,
        };
        print_outcome(self.format, "could not generate the study", |watch| {
            generate::generate(&options, watch)
        })
    }
}
