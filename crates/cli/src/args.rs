//! Flags that several commands share.

use crate::invocation::this_command;
use clap::ValueEnum;

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
        self.command.unwrap_or_else(this_command)
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
