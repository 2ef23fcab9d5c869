//! `maveric score`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use clap::ValueEnum;
use maveric_study::stages::score::{self, Moments, ScoreOptions};

/// Turn questionnaire answers into scores and reliabilities
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: maveric score --surveys surveys.csv --out scores.csv")]
pub(crate) struct Score {
    /// Design of the study (TOML); study.toml of the folder one stands in when not given. Without either nothing is left out
    #[arg(long, value_name = "FILE")]
    design: Option<std::path::PathBuf>,
    /// Answers: participant, moment, scale, item, answer; may be given more than once
    #[arg(long, required = true)]
    surveys: Vec<std::path::PathBuf>,
    /// Table of who should have answered: whoever of them did not is listed
    #[arg(long)]
    participants: Option<std::path::PathBuf>,
    /// Folder of questionnaire definitions
    #[arg(long, default_value = "study_data/scales")]
    scales: std::path::PathBuf,
    /// Folder of drives: what was said of those left out there as too short is left out too; may be given more than once
    #[arg(long)]
    drives: Vec<std::path::PathBuf>,
    /// Score all answers, or only those given after a drive
    #[arg(long, value_enum, default_value_t)]
    moments: Which,
    /// Scores to write; NAME_reliabilities.csv, NAME_items.csv and NAME_exclusions.csv go beside them
    #[arg(long)]
    out: std::path::PathBuf,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Which answers to score.
#[derive(Debug, Clone, Copy, Default, ValueEnum)]
enum Which {
    /// All of them
    #[default]
    All,
    /// Those given after a drive
    After,
}

impl Score {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = ScoreOptions {
            design: self.design,
            surveys: self.surveys,
            participants: self.participants,
            scales: self.scales,
            drives: self.drives,
            moments: match self.moments {
                Which::All => Moments::All,
                Which::After => Moments::After,
            },
            out: self.out,
        };
        print_outcome(self.format, "could not score the questionnaires", |watch| {
            score::score(&options, watch)
        })
    }
}
