//! One file per command: it parses, calls its library function, prints.

pub(crate) mod cite;
pub(crate) mod clean;
pub(crate) mod codebook;
pub(crate) mod completions;
pub(crate) mod design;
pub(crate) mod diff;
pub(crate) mod export;
pub(crate) mod graph;
pub(crate) mod man;
pub(crate) mod run;
pub(crate) mod seat;
pub(crate) mod stats;
pub(crate) mod status;
pub(crate) mod trace;
pub(crate) mod verify;

use crate::{
    diagnostics::{Failure, printable, tell},
    invocation::{FigureStyle, style_stages, this_command},
    progress,
};
use clap::{CommandFactory as _, FromArgMatches, Parser, Subcommand};
use maveric_study::outcome::Format;
use maveric_study::{
    Files, Outcome, Stage, StudyError, Watch,
    stages::{
        ablate, evaluate, generate, import, ingest, init, inspect, measure, personalize, rate,
        recommend, rehearse, report, score, simulate, steer, train, validate,
    },
};
use std::{
    ffi::OsString,
    io::Write as _,
    path::Path,
    sync::{LazyLock, Mutex, PoisonError},
};

/// Learn a driver's style, drive as that driver would, and analyse the study: from driving logs to the
/// printed figure.
#[derive(Debug, Parser)]
#[command(
    name = "maveric",
    version = env!("MAVERIC_VERSION"),
    arg_required_else_help = true,
    after_help = "\
Example: maveric run                      the whole synthetic study, into reports/paper
         maveric run pipelines/smoke.toml a small one, in a minute"
)]
pub(crate) struct Args {
    /// How every figure is to look: palette, font, sizes, labels (TOML; docs/report.md)
    #[arg(
        long,
        global = true,
        env = "MAVERIC_STYLE",
        value_name = "FILE",
        help_heading = "Figures"
    )]
    pub(crate) style: Option<String>,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// All commands and flags, put together once: that takes longer than to read many a command line.
static PARSER: LazyLock<Mutex<clap::Command>> = LazyLock::new(|| Mutex::new(Args::command()));

/// Reads the words after the program's name.
pub(crate) fn parsed<'w>(words: impl Iterator<Item = &'w str>) -> Result<Args, clap::Error> {
    read_words(&PARSER, std::iter::once("maveric").chain(words))
}

/// Reads words by a parser that was put together before.
pub(crate) fn read_words<T: FromArgMatches>(
    parser: &Mutex<clap::Command>,
    words: impl IntoIterator<Item = impl Into<OsString> + Clone>,
) -> Result<T, clap::Error> {
    let mut parser = parser.lock().unwrap_or_else(PoisonError::into_inner);
    let matches = parser.try_get_matches_from_mut(words)?;
    T::from_arg_matches(&matches).map_err(|error| error.format(&mut parser))
}

/// The commands, in the order of the data.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Run(run::Run),
    Status(status::Status),
    Graph(graph::Graph),
    Verify(verify::Verify),
    Diff(diff::Diff),
    Trace(trace::Trace),
    Clean(clean::Clean),
    Init(Of<init::Init>),
    Design(design::Design),
    Generate(Of<generate::Generate>),
    Ingest(Of<ingest::Ingest>),
    Inspect(Of<inspect::Inspect>),
    Import(Of<import::Import>),
    Score(Of<score::ScoreAnswers>),
    Codebook(codebook::Codebook),
    Train(Of<train::Train>),
    Personalize(Of<personalize::Personalize>),
    Steer(Of<steer::Steer>),
    Seat(seat::Seat),
    Simulate(Of<simulate::Simulate>),
    Measure(Of<measure::Measure>),
    Rate(Of<rate::Rate>),
    Evaluate(Of<evaluate::Evaluate>),
    Stats(stats::Stats),
    Ablate(Of<ablate::Ablate>),
    Validate(Of<validate::Validate>),
    Recommend(Of<recommend::Recommend>),
    Rehearse(Of<rehearse::Rehearse>),
    Report(Of<report::DrawReport>),
    Export(export::Export),
    Completions(completions::Completions),
    #[command(hide = true)]
    Man(man::Man),
    Cite(cite::Cite),
}

/// Runs a command whose figures look as a file says.
pub(crate) fn styled(style: Option<&str>, command: Command) -> Result<(), Failure> {
    // The style of `init` is a driver's: a score that the dial turns.
    let figures = !matches!(command, Command::Init(_));
    if let Some(path) = style.filter(|_| figures) {
        let doing = "could not use the style";
        let file = std::path::absolute(path).map_err(|e| Failure::io(doing, e))?;
        let hash = maveric_study::style_figures(Path::new(path)).map_err(Failure::study(doing))?;
        style_stages(FigureStyle { file, hash });
    }
    run(command)
}

pub(crate) fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::Run(c) => c.run(),
        Command::Status(c) => c.run(),
        Command::Graph(c) => c.run(),
        Command::Verify(c) => c.run(),
        Command::Diff(c) => c.run(),
        Command::Trace(c) => c.run(),
        Command::Clean(c) => c.run(),
        Command::Design(c) => c.run(),
        Command::Seat(c) => c.run(),
        Command::Stats(c) => c.run(),
        Command::Export(c) => c.run(),
        Command::Completions(c) => c.run(),
        Command::Man(c) => c.run(),
        Command::Cite(c) => c.run(),
        mut other => other.stage().map_or(Ok(()), Runs::run),
    }
}

impl Command {
    /// The stage that it is; none of what works on a pipeline, a design or a table.
    pub(crate) fn stage(&mut self) -> Option<&mut dyn Runs> {
        Some(match self {
            Self::Init(c) => c,
            Self::Generate(c) => c,
            Self::Ingest(c) => c,
            Self::Inspect(c) => c,
            Self::Import(c) => c,
            Self::Score(c) => c,
            Self::Codebook(c) => c,
            Self::Train(c) => c,
            Self::Personalize(c) => c,
            Self::Steer(c) => c,
            Self::Simulate(c) => c,
            Self::Measure(c) => c,
            Self::Rate(c) => c,
            Self::Evaluate(c) => c,
            Self::Ablate(c) => c,
            Self::Validate(c) => c,
            Self::Recommend(c) => c,
            Self::Rehearse(c) => c,
            Self::Report(c) => c,
            Self::Stats(c) => return c.study(),
            _ => return None,
        })
    }
}

/// A stage with the form in which its result is printed.
pub(crate) trait Runs {
    /// What it reads and writes in a folder.
    fn files(&self, root: &Path) -> Result<Files, StudyError>;
    /// Does its work and prints the result.
    fn run(&mut self) -> Result<(), Failure>;
}

// No doc: the stage's own is its help.
#[derive(Debug, clap::Args)]
pub(crate) struct Of<S: Stage> {
    #[command(flatten)]
    stage: S,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl<S: Stage> Runs for Of<S> {
    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        self.stage.files(root)
    }

    fn run(&mut self) -> Result<(), Failure> {
        self.stage.repeated_by(&this_command());
        let mut success = true;
        print_outcome(self.format, S::FAILURE, |watch| {
            let outcome = self.stage.run(watch)?;
            success = self.stage.is_success(&outcome.value);
            Ok(outcome)
        })?;
        Failure::told_unless(success)
    }
}

/// Runs `work` under a progress bar and Ctrl-C, prints its warnings on stderr and its result on stdout.
pub(crate) fn print_outcome<T: serde::Serialize>(
    format: Format,
    doing: &'static str,
    work: impl FnOnce(Watch<'_>) -> Result<Outcome<T>, StudyError>,
) -> Result<(), Failure> {
    let outcome = progress::watched(work).map_err(Failure::study(doing))?;
    for warning in &outcome.warnings {
        tell!("warning: {warning}");
    }
    print_as(format, &outcome, &outcome.summary)
}

/// Prints a result: its lines, or one JSON object.
pub(crate) fn print_as(
    format: Format,
    result: &impl serde::Serialize,
    lines: &[String],
) -> Result<(), Failure> {
    match format {
        Format::Text => print_lines(lines),
        Format::Json => print_json(result),
    }
}

pub(crate) fn print_lines(lines: &[String]) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    for line in lines {
        writeln!(out, "{}", printable(line)).map_err(Failure::output)?;
    }
    Ok(())
}

pub(crate) fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    serde_json::to_writer_pretty(&mut out, value).map_err(|e| Failure::output(e.into()))?;
    writeln!(out).map_err(Failure::output)
}

/// The day that it is, in UTC.
pub(crate) fn today() -> String {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let seconds = i64::try_from(now.map_or(0, |d| d.as_secs())).unwrap_or_default();
    let now = chrono::DateTime::from_timestamp(seconds, 0).unwrap_or_default();
    now.date_naive().to_string()
}

pub(crate) use maveric_study::outcome::all_cores;
