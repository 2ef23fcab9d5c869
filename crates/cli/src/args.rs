//! What can be asked on the command line.

use crate::commands;
use clap::{Parser, Subcommand, ValueEnum};

/// Learn a driver's style, drive as that driver would, and analyse the study: from driving logs to the
/// printed figure.
#[derive(Debug, Parser)]
#[command(
    name = "maveric",
    version,
    arg_required_else_help = true,
    after_help = "\
Example: maveric run                      the whole synthetic study, into reports/paper
         maveric run pipelines/smoke.toml a small one, in a minute"
)]
pub(crate) struct Args {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// The commands, in the order of the data.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Run(commands::run::Run),
    Status(commands::status::Status),
    Graph(commands::graph::Graph),
    Verify(commands::verify::Verify),
    Diff(commands::diff::Diff),
    Trace(commands::trace::Trace),
    Clean(commands::clean::Clean),
    Init(commands::init::Init),
    Design(commands::design::Design),
    Generate(commands::generate::Generate),
    Ingest(commands::ingest::Ingest),
    Inspect(commands::inspect::Inspect),
    Import(commands::import::Import),
    Score(commands::score::Score),
    Codebook(commands::codebook::Codebook),
    Train(commands::train::Train),
    Personalize(commands::personalize::Personalize),
    Steer(commands::steer::Steer),
    Simulate(commands::simulate::Simulate),
    Measure(commands::measure::Measure),
    Rate(commands::rate::Rate),
    Evaluate(commands::evaluate::Evaluate),
    Stats(commands::stats::Stats),
    Ablate(commands::ablate::Ablate),
    Validate(commands::validate::Validate),
    Recommend(commands::recommend::Recommend),
    Rehearse(commands::rehearse::Rehearse),
    RehearseDial(commands::rehearse_dial::RehearseDial),
    Report(commands::report::Report),
    Export(commands::export::Export),
}

/// What a page says is to be repeated.
#[derive(Debug, clap::Args)]
pub(crate) struct Repeat {
    /// The command that makes the same again, for the page; this one when not given
    #[arg(long, value_name = "TEXT")]
    command: Option<String>,
}

impl Repeat {
    /// The command as it can be typed.
    pub(crate) fn command(self) -> String {
        self.command.unwrap_or_else(commands::this_command)
    }
}

/// How a result is printed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Lines for people
    #[default]
    Text,
    /// One JSON object
    Json,
}
