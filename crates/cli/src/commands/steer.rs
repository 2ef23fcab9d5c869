//! `maveric steer`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::steer::{self, SteerOptions};

/// Place the four conditions in style space: mimic, aggressive, cautious, perpendicular
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: maveric steer --model model.maveric --embeddings embeddings.csv --out conditions.csv"
)]
pub(crate) struct Steer {
    /// Trained model
    #[arg(long)]
    model: std::path::PathBuf,
    /// Fitted embeddings
    #[arg(long)]
    embeddings: std::path::PathBuf,
    /// Conditions to write
    #[arg(long)]
    out: std::path::PathBuf,
    /// How far to move along the aggression line, in points of the ADB scale
    #[arg(long, default_value_t = 15.0)]
    points: f64,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Steer {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = SteerOptions {
            model: self.model,
            embeddings: self.embeddings,
            out: self.out,
            points: self.points,
            seed: self.seed,
        };
        print_outcome(self.format, "could not steer", |watch| {
            steer::steer(&options, watch)
        })
    }
}
