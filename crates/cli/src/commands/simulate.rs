//! `maveric simulate`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::simulate::{self, Scenes, SimulateOptions, WatchOptions};

/// Drive each participant's conditions in the simulator
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: maveric simulate --model model.maveric --conditions conditions.csv --out av --watch P07.html --watch-participant P07"
)]
pub(crate) struct Simulate {
    /// Design of the study (TOML); study.toml of the folder one stands in when not given. Without either every condition is driven
    #[arg(long, value_name = "FILE")]
    design: Option<std::path::PathBuf>,
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
    /// Write a page that plays one participant's conditions from above, side by side
    #[arg(long, value_name = "FILE.html")]
    watch: Option<std::path::PathBuf>,
    /// Whose conditions to watch; the first participant's when not given
    #[arg(long, value_name = "PARTICIPANT", requires = "watch")]
    watch_participant: Option<String>,
    /// Log of that participant's own drive, to be shown first
    #[arg(long, value_name = "LOG", requires = "watch")]
    watch_own: Option<std::path::PathBuf>,
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

impl Simulate {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = SimulateOptions {
            design: self.design,
            model: self.model,
            conditions: self.conditions,
            out: self.out,
            scenario: self.scenario,
            duration_s: self.duration,
            watch: self.watch.map(|page| WatchOptions {
                page,
                participant: self.watch_participant,
                own: self.watch_own,
            }),
            scenes: self.scene.unwrap_or_default(),
            seed: self.seed,
            jobs: self.jobs,
        };
        print_outcome(self.format, "could not simulate", |watch| {
            simulate::simulate(&options, watch)
        })
    }
}
