//! `maveric steer`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::steer::{self, AttributeOptions, SteerOptions};

/// Place the conditions of the design in style space
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: maveric steer --model model.maveric --embeddings embeddings.csv --out conditions.csv\n\
    A sweep: maveric steer --model model.maveric --embeddings embeddings.csv --sweep=-20,-10,0,10,20 --out sweep.csv\n\
    Another direction: maveric steer --model model.maveric --embeddings embeddings.csv --attribute mini_ipip.openness --scores scores.csv --points 1 --hold aggression --out openness.csv"
)]
pub(crate) struct Steer {
    /// Design of the study (TOML); study.toml of the folder one stands in when not given, else the paper's
    #[arg(long, value_name = "FILE")]
    design: Option<std::path::PathBuf>,
    /// Trained model
    #[arg(long)]
    model: std::path::PathBuf,
    /// Fitted embeddings
    #[arg(long)]
    embeddings: std::path::PathBuf,
    /// Conditions to write
    #[arg(long)]
    out: std::path::PathBuf,
    /// A step of the dial, in points of the style or of the attribute; the design's when not given
    #[arg(long)]
    points: Option<f64>,
    /// Place these points in place of the conditions, such as --sweep=-20,-10,0,10,20
    #[arg(
        long,
        value_delimiter = ',',
        allow_hyphen_values = true,
        value_name = "POINTS"
    )]
    sweep: Vec<f64>,
    /// Move along this score in place of aggression: SCALE.SUBSCALE of a table of scores, or any table's column
    #[arg(long, requires = "scores", value_name = "NAME")]
    attribute: Option<String>,
    /// Table that the attribute stands in
    #[arg(long, requires = "attribute", value_name = "FILE")]
    scores: Option<std::path::PathBuf>,
    /// Hold this score while moving along the attribute; `aggression` is the model's own
    #[arg(long, requires = "attribute", value_name = "NAME")]
    hold: Vec<String>,
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
            design: self.design,
            model: self.model,
            embeddings: self.embeddings,
            out: self.out,
            points: self.points,
            sweep: self.sweep,
            attribute: self
                .attribute
                .zip(self.scores)
                .map(|(name, scores)| AttributeOptions {
                    name,
                    scores,
                    hold: self.hold,
                }),
            seed: self.seed,
        };
        print_outcome(self.format, "could not steer", |watch| {
            steer::steer(&options, watch)
        })
    }
}
