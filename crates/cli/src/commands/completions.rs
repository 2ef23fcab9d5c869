//! `maveric completions`.

use super::Args;
use crate::diagnostics::Failure;
use clap::CommandFactory as _;
use std::io::Write as _;

/// Print the completions of a shell, to be saved where that shell looks for them
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples: maveric completions bash > ~/.local/share/bash-completion/completions/maveric
          maveric completions zsh > ~/.zfunc/_maveric
          maveric completions fish > ~/.config/fish/completions/maveric.fish
          maveric completions powershell >> $PROFILE")]
pub(crate) struct Completions {
    /// The shell
    shell: clap_complete::Shell,
}

impl Completions {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let mut text = Vec::new();
        clap_complete::generate(self.shell, &mut Args::command(), "maveric", &mut text);
        std::io::stdout().write_all(&text).map_err(Failure::output)
    }
}
