//! `maveric rehearse`.

use super::print_outcome;
use crate::{
    args::{Format, Repeat},
    diagnostics::Failure,
};
use maveric_study::stages::rehearse::{self, RehearseOptions};

/// Run the whole analysis of a design on many made-up studies without driving: false-positive rates, power, sample sizes
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples: maveric rehearse --effects-times 0 --studies 4000 --out reports/null
          maveric rehearse --participants 12,24,48,96 --effects-times 0.5,1 --studies 300 --out reports/power")]
pub(crate) struct Rehearse {
    /// Design of the study (TOML); study.toml of the folder one stands in when not given, else the paper's
    #[arg(long, value_name = "FILE")]
    design: Option<std::path::PathBuf>,
    /// What drives look like (TOML); as shipped when not given
    #[arg(long)]
    population: Option<std::path::PathBuf>,
    /// Sizes of the effects (TOML); the design's when not given, else as shipped
    #[arg(long)]
    effects: Option<std::path::PathBuf>,
    /// Folder of questionnaire definitions; the design's when not given
    #[arg(long)]
    scales: Option<std::path::PathBuf>,
    /// What the paper reported (TOML): signs are compared with it
    #[arg(long)]
    claims: Option<std::path::PathBuf>,
    /// Participants of a study; several sizes, ascending
    #[arg(long, value_delimiter = ',', default_value = "24")]
    participants: Vec<usize>,
    /// What every effect is multiplied with; 0 for none at all
    #[arg(long, value_delimiter = ',', default_value = "0")]
    effects_times: Vec<f64>,
    /// Studies of each size and scale of the effects
    #[arg(long, default_value_t = 1000)]
    studies: usize,
    /// Folder to write into: rehearsal.json and a page with figures and tables
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

impl Rehearse {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = RehearseOptions {
            design: self.design,
            population: self.population,
            effects: self.effects,
            scales: self.scales,
            claims: self.claims,
            participants: self.participants,
            effect_scales: self.effects_times,
            studies: self.studies,
            out: self.out,
            seed: self.seed,
            jobs: self.jobs,
            command: self.repeat.command(),
        };
        print_outcome(self.format, "could not rehearse", |watch| {
            rehearse::rehearse(&options, watch)
        })
    }
}
