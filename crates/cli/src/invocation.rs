//! How the program was called, and how its stages call it again.

use crate::diagnostics::tell;
use std::{path::PathBuf, sync::OnceLock};

/// The words that the program was called with, and what starts it again.
#[derive(Debug, Clone)]
pub struct Invocation {
    /// The words after the program's name.
    pub words: Vec<String>,
    /// The executable that stages are started with; absolute.
    pub program: PathBuf,
    /// Its arguments before those of a stage: `-m maveric` where the executable is Python, else none.
    pub leading: Vec<String>,
}

static CALLED: OnceLock<Invocation> = OnceLock::new();

impl Invocation {
    /// This process's own words and executable.
    ///
    /// # Errors
    /// The exit status, after saying why on stderr: a word that is not text, or an executable that cannot be found.
    pub fn of_this_program() -> Result<Self, u8> {
        let mut words = Vec::new();
        for word in std::env::args_os().skip(1) {
            words.push(word.into_string().map_err(|word| {
                tell!("error: `{}` is not UTF-8", word.to_string_lossy());
                2
            })?);
        }
        let program = std::env::current_exe().map_err(|error| {
            tell!("error: could not find this program's own file: {error}");
            1
        })?;
        Ok(Self { words, program, leading: Vec::new() })
    }
}

/// Remembers the call; the first of a process counts.
pub(crate) fn begin(invocation: Invocation) {
    drop(CALLED.set(invocation));
}

/// The call that is running.
pub(crate) fn current() -> Option<&'static Invocation> {
    CALLED.get()
}

/// How figures are to look.
#[derive(Debug)]
pub(crate) struct FigureStyle {
    pub(crate) file: PathBuf,
    /// The hash of it and its fonts.
    pub(crate) hash: String,
}

static STYLE: OnceLock<FigureStyle> = OnceLock::new();

/// Has stages draw like that, too; the first of a process counts.
pub(crate) fn style_stages(style: FigureStyle) {
    drop(STYLE.set(style));
}

/// How figures of stages are to look, where a style was given.
pub(crate) fn style_of_stages() -> Option<&'static FigureStyle> {
    STYLE.get()
}

/// The command that is running, as it can be typed again.
pub(crate) fn this_command() -> String {
    let words = current().map_or(&[][..], |call| &call.words);
    let words = words.iter().map(String::as_str);
    maveric_pipeline::command_line(std::iter::once("maveric").chain(words))
}
