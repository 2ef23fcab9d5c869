//! Where a pipeline stands, and what its stages may call.

use crate::{
    diagnostics::Failure,
    invocation::{self, FigureStyle, Invocation},
    stage_files::COMMANDS,
};
use maveric_pipeline::{Ledger, Pipeline, Place, Program, Settings, command_line, parse_override};
use maveric_study::{DesignFile, StudyError, design::DESIGN_FILE, missing::Missing, stages};
use path_slash::PathExt as _;
use std::path::{Path, PathBuf};

/// The pipeline of the current directory: that of its study, else the paper's.
pub(crate) const DEFAULT_PIPELINE: &str = ".";
const PAPER_PIPELINE: &str = "pipelines/paper.toml";
/// A study's own pipeline, where it has one.
const OWN_PIPELINE: &str = "pipelines/study.toml";
/// Where the pipeline that follows from a study's design is written, and its ledger.
pub(crate) const DESIGNED_FOLDER: &str = ".maveric";
const DESIGNED_PIPELINE: &str = ".maveric/study.toml";
const RESULTS: &str = "results";

/// The pipeline of a folder, seen from there.
fn folders_own(folder: &Path) -> &'static Path {
    Path::new(if !folder.join(DESIGN_FILE).is_file() {
        PAPER_PIPELINE
    } else if has_text(&folder.join(OWN_PIPELINE)) {
        OWN_PIPELINE
    } else {
        DESIGNED_PIPELINE
    })
}

/// Whether a file holds anything: a shell makes the file of `run --show > pipelines/study.toml` before the program starts.
fn has_text(file: &Path) -> bool {
    std::fs::metadata(file).is_ok_and(|m| m.is_file() && m.len() > 0)
}

/// The file that was named; for the current directory, with a `study.toml` its own pipeline, else the one that follows from the
/// design; without, the paper's.
fn named(file: &Path) -> Result<PathBuf, Failure> {
    if file != Path::new(DEFAULT_PIPELINE) {
        return Ok(file.to_owned());
    }
    let pipeline = folders_own(Path::new("")).to_owned();
    if pipeline == Path::new(PAPER_PIPELINE) && !pipeline.is_file() {
        return Err(Failure::no_study());
    }
    if pipeline != Path::new(DESIGNED_PIPELINE) {
        return Ok(pipeline);
    }
    let doing = "could not make the study's pipeline";
    let study = DesignFile::find(None).map_err(Failure::study(doing))?;
    maveric_study::check_design(&study).map_err(Failure::study(doing))?;
    let text = maveric_study::design_pipeline(&study);
    if std::fs::read_to_string(&pipeline).is_ok_and(|there| there == text) {
        return Ok(pipeline);
    }
    maveric_study::atomic_write::atomic_write_bytes(&pipeline, text.as_bytes())
        .map_err(Failure::study(doing))?;
    Ok(pipeline)
}

/// Refuses files that the design in the current directory names and that are not there, where the pipeline follows from it: a run would not
/// read what is meant. What asks for no logs goes on without them.
pub(crate) fn check_named_files(file: &Path) -> Result<(), Failure> {
    check_designed(file, |study| maveric_study::check_named_files(study, Path::new(RESULTS)))
}

/// Refuses to run such a study while its table of people has no row.
pub(crate) fn check_people(file: &Path) -> Result<(), Failure> {
    check_designed(file, maveric_study::check_people)
}

/// Checks the design in the current directory, where the pipeline follows from it.
fn check_designed(
    file: &Path,
    check: impl FnOnce(&DesignFile) -> Result<(), StudyError>,
) -> Result<(), Failure> {
    let own = Path::new(DESIGNED_PIPELINE);
    if file != Path::new(DEFAULT_PIPELINE) || folders_own(Path::new("")) != own {
        return Ok(());
    }
    let study = DesignFile::find(None);
    study
        .and_then(|study| check(&study))
        .map_err(Failure::study("could not make the study's pipeline"))
}

/// What every command about a pipeline takes.
#[derive(Debug, Default, clap::Args)]
pub(crate) struct PipelineArgs {
    /// Change a parameter for this run; may be given more than once
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Put everything that is made beside what is made without: every folder of outputs gets -NAME
    #[arg(long, value_name = "NAME")]
    variant: Option<String>,
}

impl PipelineArgs {
    /// The pipeline file and the targets: the first word is the file if it ends in `.toml`.
    pub(crate) fn split(mut words: Vec<String>) -> (PathBuf, Vec<String>) {
        let named =
            words.first().is_some_and(|w| Path::new(w).extension().is_some_and(|e| e == "toml"));
        let file = if named { words.remove(0) } else { DEFAULT_PIPELINE.to_owned() };
        (PathBuf::from(file), words)
    }

    /// Reads the pipeline with its parameters changed as asked for.
    pub(crate) fn read(&self, file: &Path) -> Result<Pipeline, Failure> {
        let file = &named(file)?;
        let set: Result<Vec<_>, _> = self.set.iter().map(|text| parse_override(text)).collect();
        let root = root(file)?;
        let settings = Settings {
            set: set.map_err(Failure::pipeline("could not read --set"))?,
            variant: self.variant.clone(),
            provided: [("command".to_owned(), self.command(file, &root))].into(),
            commands: Some(COMMANDS),
        };
        Pipeline::read(file, &root, &settings)
            .map_err(Failure::pipeline("could not read the pipeline"))
    }

    /// The command that makes the same again, from the root; its pipeline needs no name where it is the folder's own.
    fn command(&self, file: &Path, root: &Path) -> String {
        let file = Some(maveric_pipeline::below_root(file, root));
        let file = file.filter(|file| Path::new(file) != folders_own(root));
        let variant = self.variant.iter().flat_map(|name| ["--variant", name]);
        let set = self.set.iter().flat_map(|pair| ["--set", pair]);
        command_line(
            ["maveric", "run"].into_iter().chain(file.as_deref()).chain(variant).chain(set),
        )
    }
}

/// What one should know of the study in the current directory, and what is missing of it; nothing where there is none, or another
/// pipeline was named.
pub(crate) fn study_here(
    file: &Path,
) -> Result<Option<(DesignFile, Vec<String>, Missing)>, Failure> {
    if file != Path::new(DEFAULT_PIPELINE) || !Path::new(DESIGN_FILE).is_file() {
        return Ok(None);
    }
    let results = Path::new(RESULTS);
    let known = || -> Result<_, maveric_study::StudyError> {
        let study = DesignFile::find(None)?;
        let notes = maveric_study::study_notes(&study, results)?;
        let missing = maveric_study::missing(&study, results, None)?;
        Ok((study, notes, missing))
    };
    let doing = "could not tell what is in the study";
    known().map(Some).map_err(Failure::study(doing))
}

/// The project's root: above `pipelines/`, else the current folder.
fn root(file: &Path) -> Result<PathBuf, Failure> {
    let doing = "could not find the project's folder";
    let absolute = std::path::absolute(file).map_err(|e| Failure::io(doing, e))?;
    let absolute = absolute.parent().unwrap_or(&absolute);
    let above = absolute.parent().filter(|_| absolute.ends_with("pipelines"));
    above
        .map(Path::to_owned)
        .map_or_else(std::env::current_dir, Ok)
        .map_err(|e| Failure::io(doing, e))
}

/// The ledger beside a pipeline file. A study's own pipeline that was made of its design's (`run --show`) goes on with the ledger of that, so
/// that what is there stays its own.
fn ledger(file: &Path, root: &Path) -> PathBuf {
    let beside = file.with_extension("lock");
    let designed = root.join(DESIGNED_PIPELINE).with_extension("lock");
    if !file.ends_with(OWN_PIPELINE) || beside.is_file() {
        return beside;
    }
    let is_of = |ledger: Ledger| {
        let name = format!("name = \"{}\"", ledger.pipeline);
        let text = std::fs::read_to_string(file).unwrap_or_default();
        text.lines().any(|line| line.trim() == name)
    };
    let goes_on = Ledger::read_any(&designed).is_ok_and(is_of);
    if goes_on { designed } else { beside }
}

/// Where the pipeline of `file` runs: its root, its ledger, and this program under its own name.
pub(crate) fn place(file: &Path) -> Result<Place, Failure> {
    let file = &named(file)?;
    let folder = file.parent().unwrap_or(Path::new(""));
    let stem = file.file_stem().unwrap_or_default();
    let root = root(file)?;
    Ok(Place {
        ledger: ledger(file, &root),
        root,
        log_dir: folder.join(".logs").join(stem),
        program: invocation::current().map(|call| program(call, invocation::style_of_stages())),
    })
}

/// This program as stages call it, figures in the style of this call.
fn program(call: &Invocation, style: Option<&FigureStyle>) -> Program {
    let mut leading = call.leading.clone();
    if let Some(style) = style {
        leading.extend(["--style".to_owned(), style.file.to_slash_lossy().into_owned()]);
    }
    Program {
        name: "maveric".to_owned(),
        path: call.program.clone(),
        leading,
        versions: style
            .map_or_else(stages::versions, |style| stages::versions_in_style(&style.hash)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_draw_in_the_style_of_the_run_and_are_made_from_it() {
        let call = Invocation {
            words: Vec::new(),
            program: "/bin/python".into(),
            leading: vec!["-m".to_owned(), "maveric".to_owned()],
        };
        let plain = program(&call, None);
        assert_eq!(plain.leading, ["-m", "maveric"]);
        assert_eq!(plain.versions, stages::versions());
        let style = FigureStyle { file: "/study/s.toml".into(), hash: "0123456789".to_owned() };
        let styled = program(&call, Some(&style));
        let words = ["-m", "maveric", "--style", "/study/s.toml"];
        assert_eq!(styled.leading, words);
        assert_ne!(styled.versions["report"], plain.versions["report"]);
        assert_eq!(styled.versions["train"], plain.versions["train"]);
    }
}
