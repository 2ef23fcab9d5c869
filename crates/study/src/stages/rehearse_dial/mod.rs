//! `rehearse-dial`: the recommendation on made-up people whose preference is known.

mod page;

pub use maveric_rehearsal::{LearnedFrom, Method, TrialError};
use path_slash::PathExt as _;

use crate::{
    atomic_write::write_json,
    design::DesignFile,
    error::StudyError,
    outcome::{Outcome, Watch, for_each_on},
    stages::{rehearse::read_world, report::write_page},
};
use maveric_analysis::{Dial, Finding};
use maveric_domain::stream_seed;
use maveric_rehearsal::{DialTrials, findings};
use serde::Serialize;
use std::path::PathBuf;

/// What to rehearse.
#[derive(Debug, Clone)]
pub struct RehearseDialOptions {
    /// What drives look like (TOML).
    pub population: PathBuf,
    /// Sizes of the effects.
    pub effects: PathBuf,
    /// Folder of questionnaire definitions.
    pub scales: PathBuf,
    /// Sizes of the studies to learn from.
    pub participants: Vec<usize>,
    /// Studies of each size.
    pub studies: usize,
    /// Further trials of a person.
    pub trials: usize,
    /// Folder to write into.
    pub out: PathBuf,
    /// Root of every random choice.
    pub seed: u64,
    /// Threads.
    pub jobs: usize,
    /// The command that makes the same again, for the page.
    pub command: String,
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

/// Learns from made-up studies, recommends to new people, and holds it against the preference that they were made with.
///
/// # Errors
/// [`StudyError`] if an input cannot be read, a size or count makes no study, or a file cannot be written.
pub fn rehearse_dial(
    options: &RehearseDialOptions,
    watch: Watch<'_>,
) -> Result<Outcome<DialRehearsal>, StudyError> {
    let ascend = options.participants.is_sorted_by(|a, b| a < b);
    let sizes = options.participants.iter().all(|n| (6..=500).contains(n));
    if options.participants.is_empty() || !ascend || !sizes || options.studies == 0 {
        return Err(StudyError::NotPossible {
            problem: "studies to learn from must have 6 to 500 participants, ascending, and there must be one at least".to_owned(),
            help: Some("such as --participants 24,48,96 --studies 20".to_owned()),
        });
    }
    let given = [&options.population, &options.effects, &options.scales];
    let world = read_world(
        &DesignFile::paper()?,
        given.map(|path| Some(path.as_path())),
    )?;
    let trials = DialTrials::new(&world, options.seed)?;
    let mut items = Vec::new();
    for &n in &options.participants {
        items.extend((0..options.studies).map(|index| (n, index)));
    }
    let tried = for_each_on(options.jobs, &items, watch, "studies", |&(n, index)| {
        let labels = ["dial", &n.to_string(), &index.to_string()];
        Ok(trials.one(n, stream_seed(options.seed, &labels))?)
    })?;
    let learned_from: Vec<LearnedFrom> = options
        .participants
        .iter()
        .zip(tried.chunks(options.studies))
        .map(|(n, studies)| LearnedFrom::of(*n, studies))
        .collect();
    let largest = options.participants[options.participants.len() - 1];
    let indices: Vec<usize> = (0..options.studies).collect();
    let searched = for_each_on(options.jobs, &indices, watch, "searches", |index| {
        let seed = stream_seed(options.seed, &["search", &index.to_string()]);
        Ok(trials.search(largest, options.trials, seed)?)
    })?;
    let search = TrialError::of(&searched.concat(), options.trials);
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
    write_json(&options.out.join("dial.json"), &value)?;
    let page = write_page(&options.out, &page::page(&value, options)?)?;
    let mut summary = page::summary(&value);
    summary.push(format!("synthetic participants: {}", page.to_slash_lossy()));
    Ok(Outcome {
        value,
        summary,
        warnings: Vec::new(),
    })
}
