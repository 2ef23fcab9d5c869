//! `maveric evaluate`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::evaluate::{self, EvaluateOptions};

/// Predict each drive's unseen last third in closed loop, beside car-following models
///
/// Trains a network through its own simulated following, calibrates constant time gap, Newell, Helly, Gipps and IDM to the first
/// two thirds, drives by them and by F of a model, prints the whole table and says what is best on the fit rows.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples: maveric evaluate --drives drives --model model.maveric --embeddings embeddings.csv --out following.json\n          \
                  maveric evaluate --drives drives --learn other_drives --out following.json"
)]
pub(crate) struct Evaluate {
    /// Folder of the drives that are judged
    #[arg(long)]
    drives: std::path::PathBuf,
    /// Folder of drives to learn from instead: their first two thirds; a drive in both is judged by the others
    #[arg(long)]
    learn: Option<std::path::PathBuf>,
    /// Trained model, for F; left out without it
    #[arg(long, requires = "embeddings")]
    model: Option<std::path::PathBuf>,
    /// Embeddings fitted to the first two thirds of the drives
    #[arg(long, requires = "model")]
    embeddings: Option<std::path::PathBuf>,
    /// Results to write (JSON)
    #[arg(long)]
    out: std::path::PathBuf,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Ego speed above which a row has a time gap, in m/s (1 in dense traffic)
    #[arg(long, default_value_t = 2.0)]
    moving_above_mps: f64,
    /// From how many seeds to train the network in closed loop; 0 leaves it out
    #[arg(long, default_value_t = 5)]
    closed_loop_seeds: usize,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Evaluate {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = EvaluateOptions {
            drives: self.drives,
            learn: self.learn,
            model: self.model.zip(self.embeddings),
            out: self.out,
            seed: self.seed,
            moving_above_mps: self.moving_above_mps,
            closed_loop_seeds: self.closed_loop_seeds,
        };
        print_outcome(self.format, "could not evaluate", |watch| {
            evaluate::evaluate(&options, watch)
        })
    }
}
