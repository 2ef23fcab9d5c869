//! `rehearse`: the whole analysis of a design on many synthetic studies that are not driven. How often does each test say yes
//! when there is nothing, and how many people would it need when there is something?

mod page;
mod signs;
mod tables;
mod world;

pub use maveric_rehearsal::{Cell, Part, TestRate};
use path_slash::PathExt as _;
pub use signs::SignRow;
pub(crate) use world::read_world;

use crate::{
    atomic_write::write_json,
    design::DesignFile,
    error::StudyError,
    outcome::{Outcome, Watch, for_each_on},
    stages::report::write_page,
};
use maveric_analysis::{Finding, Friedman};
use maveric_domain::stream_seed;
use maveric_rehearsal::{World, findings, found_in};
use serde::Serialize;
use std::path::PathBuf;

/// What to rehearse.
#[derive(Debug, Clone)]
pub struct RehearseOptions {
    /// The study's design; `study.toml` of the folder one stands in without, else the paper's.
    pub design: Option<PathBuf>,
    /// What drives look like (TOML); as shipped without.
    pub population: Option<PathBuf>,
    /// Sizes of the effects; the design's without, else as shipped.
    pub effects: Option<PathBuf>,
    /// Folder of questionnaire definitions; the design's without.
    pub scales: Option<PathBuf>,
    /// What the paper reported, to compare signs with.
    pub claims: Option<PathBuf>,
    /// Sizes of the studies.
    pub participants: Vec<usize>,
    /// What every effect is multiplied with; 0 is a study without any.
    pub effect_scales: Vec<f64>,
    /// Studies of each size and scale.
    pub studies: usize,
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
pub struct Rehearsal {
    /// The people are made up.
    pub synthetic: bool,
    /// Size by size, scale by scale.
    pub cells: Vec<Cell>,
    /// What became of the questions: whether nothing is found where nothing is, or whether there is power enough.
    pub findings: Vec<Finding>,
    /// The paper's correlations, for the cells at scale 1 with the fewest participants not below 24.
    pub signs: Vec<SignRow>,
}

impl Rehearsal {
    fn is_null(&self) -> bool {
        self.cells.iter().all(|c| c.effect_scale == 0.0)
    }

    /// The studies of the largest size in which the effects are as planted; else those of the last scale.
    fn largest(&self) -> Option<&Cell> {
        let planted = |c: &&Cell| (c.effect_scale - 1.0).abs() < 1e-12;
        self.cells.iter().rfind(planted).or(self.cells.last())
    }
}

/// Runs the analysis of `stats study` on `studies` made-up studies of each size and scale of the effects; writes `rehearsal.json` and a
/// page with figures and tables.
///
/// # Errors
/// [`StudyError`] if an input cannot be read, a size, scale or count makes no study, or a file cannot be written.
///
/// # Source
/// Method, end of section 7: without effects no more significant results than chance.
pub fn rehearse(
    options: &RehearseOptions,
    watch: Watch<'_>,
) -> Result<Outcome<Rehearsal>, StudyError> {
    check(options)?;
    let world = read_world(
        &DesignFile::find(options.design.as_deref())?,
        [&options.population, &options.effects, &options.scales].map(Option::as_deref),
    )?;
    let mut grid = Vec::new();
    for &scale in &options.effect_scales {
        grid.extend(options.participants.iter().map(|n| (scale, *n)));
    }
    let worlds: Vec<World> = options
        .effect_scales
        .iter()
        .map(|s| world.scaled(*s))
        .collect();
    let mut items = Vec::new();
    for (cell, _) in grid.iter().enumerate() {
        items.extend((0..options.studies).map(|index| (cell, index)));
    }
    let found = for_each_on(options.jobs, &items, watch, "studies", |&(cell, index)| {
        let (scale, n) = grid[cell];
        let labels = [format!("{scale}"), n.to_string(), index.to_string()];
        let [scale, size, index] = labels.each_ref().map(String::as_str);
        let seed = stream_seed(options.seed, &["rehearsal", scale, size, index]);
        let study = worlds[cell / options.participants.len()].study(n, seed)?;
        let analysis = maveric_analysis::analyse(&study.data, Friedman::Approximate)?;
        Ok(found_in(&analysis))
    })?;
    let cells: Vec<Cell> = grid
        .iter()
        .zip(found.chunks(options.studies))
        .map(|((scale, n), studies)| Cell::of(*n, *scale, studies))
        .collect();
    let signs = match &options.claims {
        Some(path) => signs::signs(path, &cells)?,
        None => Vec::new(),
    };
    let mut value = Rehearsal {
        synthetic: true,
        cells,
        findings: Vec::new(),
        signs,
    };
    value.findings = match (value.is_null(), value.cells.first(), value.largest()) {
        (true, Some(cell), _) => vec![findings::families(cell), findings::single(cell)],
        (false, _, Some(cell)) => vec![findings::power(cell)],
        _ => Vec::new(),
    };
    write_json(&options.out.join("rehearsal.json"), &value)?;
    let page = write_page(&options.out, &page::page(&value, options)?)?;
    let mut summary = tables::summary(&value);
    summary.push(format!(
        "{} synthetic studies: {}",
        items.len(),
        page.to_slash_lossy()
    ));
    Ok(Outcome {
        value,
        summary,
        warnings: Vec::new(),
    })
}

fn check(options: &RehearseOptions) -> Result<(), StudyError> {
    let refuse = |problem: String| {
        Err(StudyError::NotPossible {
            problem,
            help: Some("such as --participants 24 --effects-times 0 --studies 4000".to_owned()),
        })
    };
    if options.participants.is_empty() || options.effect_scales.is_empty() || options.studies == 0 {
        return refuse("no size, no scale of the effects or no study to rehearse".to_owned());
    }
    if let Some(n) = options
        .participants
        .iter()
        .find(|n| !(4..=500).contains(*n))
    {
        return refuse(format!("a study of {n} participants, expected 4 to 500"));
    }
    if !options.participants.is_sorted_by(|a, b| a < b) {
        return refuse("sizes of studies must ascend".to_owned());
    }
    if let Some(scale) = options
        .effect_scales
        .iter()
        .find(|s| !(0.0..=10.0).contains(*s))
    {
        return refuse(format!("effects times {scale}, expected 0 to 10"));
    }
    if options
        .effect_scales
        .iter()
        .enumerate()
        .any(|(i, s)| options.effect_scales[..i].contains(s))
    {
        return refuse("a scale of the effects stands twice".to_owned());
    }
    Ok(())
}
