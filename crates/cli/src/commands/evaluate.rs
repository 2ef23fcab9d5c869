//! `maveric evaluate`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::evaluate::{self, EvaluateOptions};

/// Predict each drive's unseen last third in closed loop, beside car-following models
///
/// Drives F and V of the model, a network trained here through its own simulated following, and constant time gap,
/// Newell, Helly, Gipps and IDM calibrated to the first two thirds; prints the whole table.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: maveric evaluate --model model.maveric --embeddings embeddings.csv --drives drives --out following.json"
)]
pub(crate) struct Evaluate {
    /// Trained model
    #[arg(long)]
    model: std::path::PathBuf,
    /// Embeddings fitted to the first two thirds
    #[arg(long)]
    embeddings: std::path::PathBuf,
    /// Folder of drives
    #[arg(long)]
    drives: std::path::PathBuf,
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
            model: self.model,
            embeddings: self.embeddings,
            drives: self.drives,
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
