//! What a stage of a pipeline reads and writes, by its command line.

use crate::commands::Args;
use clap::{CommandFactory as _, FromArgMatches as _};
use maveric_pipeline::{CommandFiles, Commands};
use path_slash::PathExt as _;
use std::{
    path::{Path, PathBuf},
    sync::{LazyLock, Mutex, PoisonError},
};

/// This program, for pipelines whose stages call it.
pub(crate) const COMMANDS: Commands = Commands {
    program: "maveric",
    files,
};

/// All commands and flags, put together once: that takes longer than to read many a command line.
static PARSER: LazyLock<Mutex<clap::Command>> = LazyLock::new(|| Mutex::new(Args::command()));

fn files(root: &Path, words: &[String]) -> Result<Option<CommandFiles>, String> {
    let words = ["maveric"]
        .into_iter()
        .chain(words.iter().map(String::as_str));
    let mut parser = PARSER.lock().unwrap_or_else(PoisonError::into_inner);
    let args = match parser.try_get_matches_from_mut(words) {
        Ok(matches) => Args::from_arg_matches(&matches).map_err(|e| first_lines(&e))?,
        // A pipeline refuses what is not a command at all by itself.
        Err(error) if error.kind() == clap::error::ErrorKind::InvalidSubcommand => return Ok(None),
        Err(error) => return Err(first_lines(&error)),
    };
    let mut command = args.command;
    let Some(stage) = command.stage() else {
        return Ok(None);
    };
    let files = stage.files(root).map_err(|e| e.to_string())?;
    Ok(Some(CommandFiles {
        inputs: written(files.inputs),
        if_there: written(files.if_there),
        outputs: written(files.outputs),
    }))
}

fn written(paths: Vec<PathBuf>) -> Vec<String> {
    let written = |path: PathBuf| path.to_slash_lossy().into_owned();
    paths.into_iter().map(written).collect()
}

/// What is wrong with a command line, without how to use the program.
fn first_lines(error: &clap::Error) -> String {
    let text = error.to_string();
    let said = text.split("\n\n").next().unwrap_or_default();
    said.trim_start_matches("error: ").replace("\n  ", " ")
}
