//! `codebook`, with the pages that people would be shown.

use super::{Of, Runs, print_lines, seat};
use crate::diagnostics::{Failure, tell};
use maveric_seat::write_sheet_pages;
use maveric_study::{
    DesignFile, Files, StudyError, run_folder::read_scales, stages::codebook::Describe,
};
use path_slash::PathExt as _;
use std::path::{Path, PathBuf};

// No doc: the stage's own is its help.
#[derive(Debug, clap::Args)]
pub(crate) struct Codebook {
    #[command(flatten)]
    of: Of<Describe>,
    /// Folder for a page (HTML) a questionnaire, drawn as the seat draws it, in the language of the design and with its own sentences
    #[arg(long, value_name = "DIR")]
    pages: Option<PathBuf>,
}

impl Runs for Codebook {
    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        let files = self.of.files(root)?.writes(&self.pages);
        let study = DesignFile::below(root, self.of.stage.design.as_deref());
        let words = study.filter(|_| self.pages.is_some());
        let words = words.and_then(|s| Some(s.resolve(s.design.protocol().words.as_ref()?)));
        Ok(files.reads(words))
    }

    fn run(&mut self) -> Result<(), Failure> {
        self.of.run()?;
        let Some(folder) = &self.pages else {
            return Ok(());
        };
        let doing = "could not write the pages";
        let failed = |error| Failure::study(doing)(error);
        let stage = &self.of.stage;
        let study = DesignFile::here(stage.design.as_deref()).map_err(failed)?;
        let scales = stage.scales_folder().and_then(|folder| read_scales(&folder));
        let scales = scales.map_err(failed)?;
        let pages = write_sheet_pages(&scales, study.as_ref(), folder);
        let pages = pages.map_err(seat::failure(doing))?;
        for lacking in &pages.lacking {
            tell!("warning: no page: {lacking}");
        }
        let (n, shown) = (pages.written.len(), folder.to_slash_lossy());
        print_lines(&[format!("{n} pages: {shown}")])
    }
}
