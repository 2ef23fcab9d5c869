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
    /// Design of the study (TOML); study.toml of the folder one stands in when not given, else the paper's
    #[arg(long, value_name = "FILE")]
    design: Option<std::path::PathBuf>,
    /// Folder to write into: logs/study1, logs/study2, participants.csv, surveys.csv; the files that the design names when not given
    #[arg(long)]
    out: Option<std::path::PathBuf>,
    /// World to drive in (TOML); the design's when not given, else the paper's
    #[arg(long)]
    scenario: Option<std::path::PathBuf>,
    /// Who drives (TOML), such as study_data/population_misspecified.toml; the scenario's people when not given
    #[arg(long)]
    population: Option<std::path::PathBuf>,
    /// Folder of questionnaire definitions; the design's when not given, else study_data/scales
    #[arg(long)]
    scales: Option<std::path::PathBuf>,
    /// Sizes of the effects in their answers (TOML); the design's when not given, else study_data/effects.toml
    #[arg(long)]
    effects: Option<std::path::PathBuf>,
    /// People who are learned from
    #[arg(long, alias = "study1", default_value_t = 30)]
    learn: usize,
    /// People who are tested
    #[arg(long, alias = "study2", default_value_t = 24)]
    test: usize,
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
            design: self.design,
            out: self.out,
            scenario: self.scenario,
            population: self.population,
            scales: self.scales,
            effects: self.effects,
            learn: self.learn,
            test: self.test,
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
