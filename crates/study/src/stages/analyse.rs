//! `stats study`: every analysis that a study's design asks for, over the results of a run (method section 9).

use crate::{
    atomic_write::write_json,
    design::DesignFile,
    error::StudyError,
    once::{count, names, together},
    outcome::{Outcome, Watch},
    run_folder::{read_study, study_files},
    stage::{Files, Stage},
};
use maveric_analysis::{Analysis, Purpose};
use path_slash::PathExt as _;
use std::path::{Path, PathBuf};

/// Every analysis that a study's design asks for, over the results of a run
#[derive(Debug, Clone, clap::Args)]
pub struct Analyse {
    /// Folder of results, as the pipeline leaves it
    pub results: PathBuf,
    /// Design of the study (TOML); study.toml of the current directory when not given, else the paper's
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// Who took part; participants.csv among the results when not given, else the design's table
    #[arg(long)]
    pub participants: Option<PathBuf>,
    /// Analysis to write (JSON)
    #[arg(long)]
    pub out: PathBuf,
}

impl Stage for Analyse {
    const NAME: &'static str = "study";
    const FAILURE: &'static str = "could not analyse the study";
    type Result = Analysis;

    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        let design = self.design.as_deref();
        let study = DesignFile::below_or_paper(root, design)?;
        let files = Files::default().reads_design(design);
        let participants = self.participants.as_deref();
        Ok(study_files(files, root, &self.results, &study, participants).writes([&self.out]))
    }

    /// Runs every analysis that the design asks for and writes the results.
    ///
    /// # Source
    /// Method section 9.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Analysis>, StudyError> {
        let study = DesignFile::find(self.design.as_deref())?;
        let data = read_study(&self.results, &study, self.participants.as_deref())?;
        watch.step(0, 1, "analyses")?;
        let analysis = maveric_analysis::analyse(&data, Purpose::Report)?;
        watch.step(1, 1, "analyses")?;
        write_json(&self.out, &analysis)?;
        let flow = &analysis.flow;
        let mut warnings: Vec<String> = flow
            .left_out
            .iter()
            .chain(&flow.drives)
            .map(|l| format!("left out, {}: {}", l.why, l.who.join(", ")))
            .collect();
        warnings.extend(analysis.notes.iter().cloned());
        let lacking = analysis.exclusions.iter();
        let lacking =
            lacking.map(|e| (e.who.clone(), format!("left out of {}: {}", e.what, e.why)));
        let lacking = together(lacking).into_iter();
        warnings.extend(lacking.map(|(who, what)| format!("{}: {what}", names(&who))));
        let summary = vec![format!(
            "{} of {} analysed: {}",
            flow.analysed,
            count(flow.recruited, "participant", "participants"),
            self.out.to_slash_lossy()
        )];
        Ok(Outcome::new(analysis, summary, warnings))
    }
}
