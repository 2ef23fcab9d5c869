//! `rehearse-dial`: the recommendation on made-up people whose preference is known.

mod page;

pub use maveric_rehearsal::{LearnedFrom, Method, Score, TrialError};
use path_slash::PathExt as _;

use crate::{
    atomic_write::write_json,
    design::DesignFile,
    error::StudyError,
    outcome::{Outcome, Watch, for_each_on},
    stage::{Files, Stage},
    stages::{rehearse::read_world, report::write_page},
};
use maveric_analysis::{Dial, Finding};
use maveric_domain::stream_seed;
use maveric_rehearsal::{DialTrials, findings};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Try the recommended shift on made-up people whose preference is known, and count the trials it takes to learn one
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "Example: maveric rehearse-dial --participants 24,48,96 --studies 20 --out reports/dial"
)]
pub struct RehearseDial {
    /// What drives look like (TOML); as shipped when not given
    #[arg(long)]
    pub population: Option<PathBuf>,
    /// Sizes of the effects (TOML); as shipped when not given
    #[arg(long)]
    pub effects: Option<PathBuf>,
    /// Folder of questionnaire definitions; the paper's, study_data/scales, when not given
    #[arg(long)]
    pub scales: Option<PathBuf>,
    /// Participants of the studies to learn from; several sizes, ascending
    #[arg(long, value_delimiter = ',', default_value = "24,48,96")]
    pub participants: Vec<usize>,
    /// Studies of each size
    #[arg(long, default_value_t = 20)]
    pub studies: usize,
    /// Trials of each new person
    #[arg(long, default_value_t = 14)]
    pub trials: usize,
    /// Folder to write into: dial.json and a page with figures and tables
    #[arg(long)]
    pub out: PathBuf,
    /// Root of every random choice
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads
    #[arg(short, long, default_value_t = crate::outcome::all_cores())]
    pub jobs: usize,
    /// The command that makes the same again, for the page; this one when not given
    #[arg(long, value_name = "TEXT")]
    pub command: Option<String>,
}

/// What was found.
#[derive(Debug, Clone, Serialize)]
pub struct DialRehearsal {
    /// The people are made up.
    pub synthetic: bool,
    /// Size by size.
    pub learned_from: Vec<LearnedFrom>,
    /// Trial by trial, learned from studies of the largest size.
    pub search: Vec<TrialError>,
    /// What became of the questions: whether it knows how far to turn, and whether choosing saves rides.
    pub findings: Vec<Finding>,
    /// Where the dial truly is in the unit of perceived shift.
    pub dial: Dial,
}

impl Stage for RehearseDial {
    const NAME: &'static str = "rehearse-dial";
    const FAILURE: &'static str = "could not rehearse the dial";
    type Result = DialRehearsal;

    fn files(&self, _root: &Path) -> Result<Files, StudyError> {
        let paper = DesignFile::paper()?;
        let files = Files::default()
            .reads(&self.population)
            .reads([paper.scales_folder(self.scales.as_deref())])
            .writes([&self.out]);
        Ok(match &self.effects {
            Some(given) => files.reads([given]),
            None => files.reads_if_there([paper.effects_file(None)]),
        })
    }

    fn repeated_by(&mut self, command: &str) {
        self.command.get_or_insert_with(|| command.to_owned());
    }

    /// Learns from made-up studies, recommends to new people, and holds it against the preference that they were made with.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<DialRehearsal>, StudyError> {
        let ascend = self.participants.is_sorted_by(|a, b| a < b);
        let sizes = self.participants.iter().all(|n| (6..=500).contains(n));
        if self.participants.is_empty() || !ascend || !sizes || self.studies == 0 {
            let problem = "studies to learn from must have 6 to 500 participants, ascending, and there must be one at least";
            let help = "such as --participants 24,48,96 --studies 20";
            return Err(StudyError::not_possible(problem).with_help(help));
        }
        let paper = DesignFile::paper()?;
        let scales = paper.scales_folder(self.scales.as_deref());
        let (population, effects) = (self.population.as_deref(), self.effects.as_deref());
        let world = read_world(&paper, [population, effects, Some(&scales)])?;
        let trials = DialTrials::new(&world, self.seed)?;
        let mut items = Vec::new();
        for &n in &self.participants {
            items.extend((0..self.studies).map(|index| (n, index)));
        }
        let tried = for_each_on(self.jobs, &items, watch, "studies", |&(n, index)| {
            let labels = ["dial", &n.to_string(), &index.to_string()];
            Ok(trials.one(n, stream_seed(self.seed, &labels))?)
        })?;
        let learned_from: Vec<LearnedFrom> = self
            .participants
            .iter()
            .zip(tried.chunks(self.studies))
            .map(|(n, studies)| LearnedFrom::of(*n, studies))
            .collect();
        let largest = self.participants[self.participants.len() - 1];
        let indices: Vec<usize> = (0..self.studies).collect();
        let searched = for_each_on(self.jobs, &indices, watch, "searches", |index| {
            let seed = stream_seed(self.seed, &["search", &index.to_string()]);
            Ok(trials.search(largest, self.trials, seed)?)
        })?;
        let search = TrialError::of(&searched.concat(), self.trials);
        let recommends = learned_from.last().map(findings::recommends);
        let value = DialRehearsal {
            synthetic: true,
            findings: recommends
                .into_iter()
                .chain(findings::saves(&search))
                .collect(),
            learned_from,
            search,
            dial: trials.dial(),
        };
        write_json(&self.out.join("dial.json"), &value)?;
        let page = write_page(&self.out, &page::page(&value, self)?)?;
        let mut summary = page::summary(&value)?;
        summary.push(format!("synthetic participants: {}", page.to_slash_lossy()));
        Ok(Outcome::new(value, summary, Vec::new()))
    }
}
