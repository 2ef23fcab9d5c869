//! `maveric init`.

use super::print_outcome;
use crate::{args::Format, diagnostics::Failure};
use maveric_study::stages::init::{self, InitOptions};

/// Make the folder of a study of your own: its design, scales, a mapping, and what goes where
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples: maveric init my_study                                                     the paper's study, for recordings of your own
          maveric init --paper                                                      here, the paper's study as shipped: made-up people, ready to run
          maveric init my_study --conditions calm,normal,sporty --style none        cars of your own, only their logs are read
          maveric init my_study --conditions calm,sporty --style mdsi.risky         a dial of another score
          maveric init my_study --conditions calm,sporty --synthetic                to rehearse with made-up people")]
pub(crate) struct Init {
    /// The folder; not there yet, or empty; the one you stand in when not given
    #[arg(default_value = ".")]
    folder: std::path::PathBuf,
    /// The conditions, in the order of the page; the paper's study when not given
    #[arg(long, value_delimiter = ',', value_name = "IDS")]
    conditions: Vec<String>,
    /// The score that the dial turns, or none where every car was recorded; adb.total when not given
    #[arg(long, value_name = "none|SCALE.SUBSCALE", requires = "conditions")]
    style: Option<String>,
    /// The people will be made up
    #[arg(long)]
    synthetic: bool,
    /// The paper's study as this program ships it, with made-up people: pipelines, design, scales, scenarios
    #[arg(long, conflicts_with_all = ["conditions", "style", "synthetic"])]
    paper: bool,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Init {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let options = InitOptions {
            folder: self.folder,
            paper: self.paper,
            conditions: self.conditions,
            style: self.style,
            synthetic: self.synthetic,
        };
        print_outcome(self.format, "could not make the study's folder", |watch| {
            init::init(&options, watch)
        })
    }
}
