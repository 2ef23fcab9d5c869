//! `maveric man`, for those who package the program.

use super::Args;
use crate::diagnostics::{Failure, tell};
use clap::CommandFactory as _;
use path_slash::PathExt as _;
use std::path::PathBuf;

/// Write the manual, a page a command, into a folder
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: maveric man ~/.local/share/man/man1")]
pub(crate) struct Man {
    /// The folder; made where it is not there
    folder: PathBuf,
}

impl Man {
    pub(crate) fn run(self) -> Result<(), Failure> {
        let doing = "could not write the manual";
        std::fs::create_dir_all(&self.folder).map_err(|e| Failure::io(doing, e))?;
        let mut program = Args::command();
        program.build();
        let mut pages = Vec::new();
        add_pages(&program, "maveric", &mut pages).map_err(|e| Failure::io(doing, e))?;
        for (name, page) in &pages {
            let path = self.folder.join(name);
            maveric_study::atomic_write::atomic_write_bytes(&path, page)
                .map_err(Failure::study(doing))?;
        }
        tell!("{} pages in {}", pages.len(), self.folder.to_slash_lossy());
        Ok(())
    }
}

/// Adds to `pages` the page of a command, then those of the commands below it.
fn add_pages(
    command: &clap::Command,
    name: &str,
    pages: &mut Vec<(String, Vec<u8>)>,
) -> std::io::Result<()> {
    let mut page = Vec::new();
    clap_mangen::Man::new(command.clone()).title(name).render(&mut page)?;
    pages.push((format!("{name}.1"), page));
    for below in command.get_subcommands() {
        if !below.is_hide_set() && below.get_name() != "help" {
            add_pages(below, &format!("{name}-{}", below.get_name()), pages)?;
        }
    }
    Ok(())
}
