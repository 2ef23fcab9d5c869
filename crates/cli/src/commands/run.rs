//! `maveric run`.

use super::{print_json, print_lines};
use crate::{
    diagnostics::{Failure, tell},
    interrupt,
    place::{PipelineArgs, check_named_files, check_people, place},
};
use maveric_pipeline::{
    Event, Outcome, Pipeline, RunOptions, RunReport, StageStatus, State, plan, run, why,
};
use maveric_study::outcome::Format;
use path_slash::PathExt as _;
use std::{fmt::Write as _, num::NonZeroUsize, path::PathBuf};

/// Bring a pipeline up to date: run what is stale, in order, and say where the report is
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples: maveric run                                    the default study
          maveric run pipelines/smoke.toml -j 2          two stages at once
          maveric run pipelines/paper.toml train --force only the model, anew
          maveric run --why train                        why a stage would run
          maveric run --variant b --set seed=2           another study, beside the first
          maveric run --cache /shared/maveric            take what a colleague has made
          maveric run --executor slurm                   on the cluster")]
#[expect(
    clippy::struct_field_names,
    clippy::struct_excessive_bools,
    reason = "the fields are the flags and named as they are"
)]
pub(crate) struct Run {
    /// Pipeline file; then stages or files to bring up to date, all when none are named
    #[arg(value_name = "PIPELINE] [STAGE")]
    words: Vec<String>,
    #[command(flatten)]
    pipeline: PipelineArgs,
    /// Stages that may run at once; one when not given, on a cluster as many as it has room for
    #[arg(short, long)]
    jobs: Option<NonZeroUsize>,
    /// Say what would run and why; run nothing
    #[arg(short = 'n', long)]
    dry_run: bool,
    /// Say why this stage would run; run nothing
    #[arg(long, value_name = "STAGE")]
    why: Option<String>,
    /// Run the named stages (all when none are named) even if they are up to date
    #[arg(long)]
    force: bool,
    /// Print the pipeline; run nothing
    #[arg(long)]
    show: bool,
    /// Move files that no run made out of the way, into a folder beside with the date
    #[arg(long)]
    move_aside: bool,
    /// After a failure go on with what does not need the failed stage
    #[arg(long)]
    keep_going: bool,
    /// Folder of outputs by what they were made from: take from it, add to it
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Where the stages run
    #[arg(long, value_enum, default_value_t)]
    executor: Executor,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Where stages run.
#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
enum Executor {
    /// As processes on this machine
    #[default]
    Local,
    /// As jobs of Slurm, through sbatch
    Slurm,
    /// As tasks of HyperQueue, through hq
    Hq,
}

impl From<Executor> for maveric_pipeline::Executor {
    fn from(executor: Executor) -> Self {
        match executor {
            Executor::Local => Self::Local,
            Executor::Slurm => Self::Slurm,
            Executor::Hq => Self::HyperQueue,
        }
    }
}

impl Run {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let (file, targets) = PipelineArgs::split(self.words);
        check_named_files(&file)?;
        let pipeline = self.pipeline.read(&file)?;
        if self.show {
            return print_lines(&shown(&pipeline));
        }
        let place = place(&file)?;
        if let Some(stage) = &self.why {
            let statuses = why(&pipeline, &place, stage)
                .map_err(Failure::pipeline("could not explain the stage"))?;
            return print_statuses(self.format, &statuses);
        }
        if self.dry_run {
            let statuses = plan(&pipeline, &place, &targets, self.force)
                .map_err(Failure::pipeline("could not plan the run"))?;
            return print_statuses(self.format, &statuses);
        }
        check_people(&file)?;
        let options = RunOptions {
            targets,
            jobs: self.jobs,
            force: self.force,
            move_aside: self.move_aside,
            keep_going: self.keep_going,
            cache: self.cache,
            executor: self.executor.into(),
            cancel: interrupt::flag().clone(),
            ..RunOptions::default()
        };
        interrupt::be_patient();
        let mut idle = UpToDate::default();
        let report = run(&pipeline, &place, &options, &mut |event| idle.say(&event));
        idle.tell();
        let report = report.map_err(Failure::pipeline("could not run the pipeline"))?;
        print_report(self.format, &report)
    }
}

/// The text of a pipeline, and as comments what its stages read and make.
fn shown(pipeline: &Pipeline) -> Vec<String> {
    const HEAD: &str = "# What each stage reads, and what it makes:";
    // The text of a file that was made of this holds the comments already.
    let text = pipeline.text().split(HEAD).next().unwrap_or_default();
    let text = format!("{}\n\n{HEAD}", text.trim_end());
    let files = pipeline.stages().iter().map(|stage| {
        let (inputs, outputs) = (stage.inputs.join(", "), stage.outputs.join(", "));
        format!("# {}: {inputs} -> {outputs}", stage.name)
    });
    std::iter::once(text).chain(files).collect()
}

/// Lines about stages that are up to date: of many in a row there are some thousands a second, which are told together.
#[derive(Default)]
struct UpToDate(String);

impl UpToDate {
    const MOST: usize = 1 << 16;

    fn say(&mut self, event: &Event<'_>) {
        let Event::UpToDate { stage, settled, wanted } = event else {
            self.tell();
            return say(event);
        };
        let _ = writeln!(self.0, "[{settled}/{wanted}] {stage}: up to date");
        if self.0.len() > Self::MOST {
            self.tell();
        }
    }

    fn tell(&mut self) {
        if !self.0.is_empty() {
            tell!("{}", self.0.trim_end());
            self.0.clear();
        }
    }
}

/// Stages that are told by name, of those that did not come to run.
const TOLD_STAGES: usize = 10;

/// Bytes of a command that are still told; the names of a shard's files may be megabytes.
const LONGEST_COMMAND: usize = 4_000;

fn say(event: &Event<'_>) {
    match event {
        Event::Started { stage, reasons, .. } => {
            let why: Vec<String> = reasons.iter().take(2).map(ToString::to_string).collect();
            let more = if reasons.len() > 2 {
                format!("; and {} more", reasons.len() - 2)
            } else {
                String::new()
            };
            tell!("{stage}: running ({}{more})", why.join("; "));
        }
        Event::Line { stage, line } => tell!("{stage}: {line}"),
        Event::Finished { stage, seconds, peak_memory, settled, wanted } => {
            let memory = peak_memory
                .map_or_else(String::new, |bytes| format!(", {:.0} MB", bytes as f64 / 1e6));
            tell!("[{settled}/{wanted}] {stage}: done in {seconds:.1} s{memory}");
        }
        Event::Retried { stage, cause, retry, retries } => {
            tell!("{stage}: {cause}; retry {retry} of {retries}");
        }
        Event::Restored { stage, settled, wanted } => {
            tell!("[{settled}/{wanted}] {stage}: taken from the cache");
        }
        Event::Submitted { job, stage, tasks } => {
            let tasks = if *tasks == 1 { String::new() } else { format!(" ({tasks} tasks)") };
            tell!("{stage}: handed in as job {job}{tasks}");
        }
        Event::Resumed { stages } => {
            let (stages, was) = stages_that(*stages, "was", "were");
            tell!("following {stages} that {was} handed in by an earlier run");
        }
        Event::Warning(warning) => tell!("warning: {warning}"),
        Event::Failed(failure) => {
            tell!("error: {failure}");
            for line in &failure.last_lines {
                tell!("  | {line}");
            }
            if let Some(log) = &failure.log {
                tell!("  its log: {}", log.to_slash_lossy());
            }
            match &failure.repeat {
                Some(command) if command.len() > LONGEST_COMMAND => {
                    tell!("  to repeat it alone: the command on the first line of its log");
                }
                Some(command) => tell!("  to repeat it alone: {command}"),
                None => {}
            }
        }
        _ => {}
    }
}

fn print_report(format: Format, report: &RunReport) -> Result<(), Failure> {
    if format == Format::Json {
        print_json(report)?;
    } else {
        let ran = report
            .stages
            .iter()
            .filter(|s| matches!(s.state, State::Done | State::Restored))
            .count();
        if report.outcome == Outcome::Done && ran == 0 {
            print_lines(&["everything is up to date; nothing was run".to_owned()])?;
        }
        for summary in &report.summaries {
            print_lines(&[summary.text.trim_end().to_owned()])?;
        }
    }
    match report.outcome {
        Outcome::Done => Ok(()),
        Outcome::Failed => {
            let not_run = report.stages.iter();
            let not_run = not_run.filter(|s| matches!(s.state, State::Wanted | State::Ready));
            let not_run: Vec<&str> = not_run.map(|s| s.stage.as_str()).collect();
            let more = not_run.len().saturating_sub(TOLD_STAGES);
            let names = not_run[..not_run.len() - more].join(", ");
            match (not_run.len(), more) {
                (0, _) => {}
                (_, 0) => tell!("not run: {names}"),
                _ => tell!("not run: {names} and {more} more"),
            }
            Err(Failure::Told)
        }
        Outcome::Interrupted => {
            tell!("{}", interrupted(report));
            Err(Failure::InterruptedRun)
        }
    }
}

/// What an interrupted run leaves: a stage may be any program, so that of its outputs half may be there.
fn interrupted(report: &RunReport) -> String {
    let on_cluster = report.stages.iter().filter(|s| s.state == State::Running);
    let cut_off = report.stages.iter().filter(|s| s.state == State::Ready && !s.reasons.is_empty());
    let cut_off: Vec<&str> = cut_off.map(|s| s.stage.as_str()).collect();
    let mut text = "interrupted; the same command goes on from here".to_owned();
    match cut_off.as_slice() {
        [] => {}
        [stage] => {
            let _ = write!(
                text,
                "; stage {stage} did not finish: what it made so far is removed when it runs again"
            );
        }
        stages => {
            let _ = write!(
                text,
                "; stages {} did not finish: what they made so far is removed when they run again",
                stages.join(", ")
            );
        }
    }
    match on_cluster.count() {
        0 => {}
        count => {
            let (stages, go) = stages_that(count, "goes", "go");
            let _ = write!(text, "; {stages} {go} on where the cluster has them");
        }
    }
    text
}

/// A number of stages with the verb for it.
fn stages_that(count: usize, one: &'static str, many: &'static str) -> (String, &'static str) {
    match count {
        1 => ("one stage".to_owned(), one),
        count => (format!("{count} stages"), many),
    }
}

/// Prints a line a stage, or one JSON object.
pub(super) fn print_statuses(format: Format, statuses: &[StageStatus]) -> Result<(), Failure> {
    if format == Format::Json {
        return print_json(&serde_json::json!({ "stages": statuses }));
    }
    let mut lines = Vec::new();
    for status in statuses {
        if status.up_to_date {
            lines.push(format!("{}: up to date", status.stage));
            continue;
        }
        lines.push(format!("{}: stale", status.stage));
        lines.extend(status.reasons.iter().map(|reason| format!("    {reason}")));
    }
    print_lines(&lines)
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_pipeline::{Reason, StageResult};

    #[test]
    fn an_interrupted_run_says_whose_outputs_are_half_there() {
        let report = |stages: &[(&str, State)]| RunReport {
            outcome: Outcome::Interrupted,
            stages: stages
                .iter()
                .map(|(name, state)| StageResult {
                    stage: (*name).to_owned(),
                    state: *state,
                    reasons: name
                        .starts_with("begun")
                        .then_some(Reason::NeverRun)
                        .into_iter()
                        .collect(),
                    seconds: None,
                    peak_memory: None,
                })
                .collect(),
            failures: Vec::new(),
            warnings: Vec::new(),
            summaries: Vec::new(),
        };
        let text = interrupted(&report(&[("a", State::Done), ("b", State::Ready)]));
        assert_eq!(text, "interrupted; the same command goes on from here");
        let text = interrupted(&report(&[("begun.1", State::Ready), ("b", State::Wanted)]));
        assert!(text.contains("; stage begun.1 did not finish: what it made so far is removed"));
        let text = interrupted(&report(&[("a", State::Running)]));
        assert!(text.ends_with("; one stage goes on where the cluster has them"));
    }
}
