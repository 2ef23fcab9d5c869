//! `maveric import`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use clap::ValueEnum;
use maveric_study::stages::import::{self, ImportOptions, SurveySoftware};

/// Read answers as survey software exports them, and write the table that `score` takes
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Example: maveric import all_apps_wide.csv --from otree --out surveys.csv
         maveric import results.json --from jspsych --columns columns.toml --out surveys.csv")]
pub(crate) struct Import {
    /// The export: oTree's wide CSV of all apps (or any table with a row a participant), or jsPsych's JSON
    file: std::path::PathBuf,
    /// What wrote it
    #[arg(long, value_enum)]
    from: From,
    /// Design of the study (TOML), which says what conditions there are; study.toml of the folder one stands in when not given,
    /// else the paper's
    #[arg(long, value_name = "FILE")]
    design: Option<std::path::PathBuf>,
    /// What its columns mean (TOML), where they are not called SCALE_ITEM
    #[arg(long)]
    columns: Option<std::path::PathBuf>,
    /// Folder of questionnaire definitions
    #[arg(long, default_value = "study_data/scales")]
    scales: std::path::PathBuf,
    /// Answers to write: participant, moment, scale, item, answer, and seconds where they were measured
    #[arg(long)]
    out: std::path::PathBuf,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// What wrote the file.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum From {
    /// A row a participant, columns `app.round.player.field`
    Otree,
    /// An array of trials a session
    Jspsych,
}

impl Import {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = ImportOptions {
            from: match self.from {
                From::Otree => SurveySoftware::OTree,
                From::Jspsych => SurveySoftware::JsPsych,
            },
            design: self.design,
            file: self.file,
            scales: self.scales,
            columns: self.columns,
            out: self.out,
        };
        print_outcome(self.format, "could not import the answers", |watch| {
            import::import(&options, watch)
        })
    }
}
