//! What a stage of a pipeline reads and writes, by its command line.

use crate::commands::parsed;
use maveric_pipeline::{CommandFiles, Commands};
use path_slash::PathExt as _;
use std::path::{Path, PathBuf};

/// This program, for pipelines whose stages call it.
pub(crate) const COMMANDS: Commands = Commands { program: "maveric", files };

fn files(root: &Path, words: &[String]) -> Result<Option<CommandFiles>, String> {
    let args = match parsed(words.iter().map(String::as_str)) {
        Ok(args) => args,
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
    let problem = text.split("\n\n").next().unwrap_or_default();
    problem.trim_start_matches("error: ").replace("\n  ", " ")
}
