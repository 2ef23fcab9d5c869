//! `rehearse`: the whole analysis of a design on many synthetic studies that are not driven. How often does each test say yes
//! when there is nothing, and how many people would it need when there is something?

mod page;
mod signs;
mod tables;
mod world;

pub use maveric_pages::{PageTexts, REHEARSAL};
use maveric_rehearsal::{Cell, TestRate};
use path_slash::PathExt as _;
pub use signs::SignRow;
pub(crate) use world::read_world;

use crate::{
    atomic_write::write_json,
    design::DesignFile,
    error::StudyError,
    outcome::{Outcome, Watch, for_each_on},
    stage::{Files, Stage},
    stages::report::write_page,
};
use maveric_analysis::{Finding, Purpose};
use maveric_domain::{ConditionId, design::FEWEST_DONORS, stream_seed};
use maveric_rehearsal::{RehearsalError, Studied, World, findings, found_in};
use serde::Serialize;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

/// Run the whole analysis of a design on many made-up studies without driving: false-positive rates, power, sample sizes
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
Examples: maveric rehearse --effects-times 0 --studies 4000 --out reports/null
          maveric rehearse --participants 12,24,48,96 --effects-times 0.5,1 --studies 300 --out reports/power
Rehearsed are cars that are { dial = POINTS }, { across = true }, { mean = true } or { other = \"matched\" }; docs/rehearsal.md says how.")]
pub struct Rehearse {
    /// Design of the study (TOML); study.toml of the current directory when not given, else the paper's
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// What drives look like (TOML); as shipped when not given
    #[arg(long)]
    pub population: Option<PathBuf>,
    /// Sizes of the effects (TOML); the design's when not given, else as shipped
    #[arg(long)]
    pub effects: Option<PathBuf>,
    /// Folder of questionnaire definitions; the design's when not given
    #[arg(long)]
    pub scales: Option<PathBuf>,
    /// What the paper reported (TOML): signs are compared with it
    #[arg(long)]
    pub claims: Option<PathBuf>,
    /// Participants of a study; several sizes, ascending
    #[arg(long, value_delimiter = ',', default_value = "24")]
    pub participants: Vec<usize>,
    /// What every effect is multiplied with; 0 for none at all
    #[arg(
        long = "effects-times",
        value_name = "EFFECTS_TIMES",
        value_delimiter = ',',
        default_value = "0"
    )]
    pub effect_scales: Vec<f64>,
    /// Studies of each size and scale of the effects
    #[arg(long, default_value_t = 1000)]
    pub studies: usize,
    /// Folder to write into: rehearsal.json and a page with figures and tables
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

impl Stage for Rehearse {
    const NAME: &'static str = "rehearse";
    const FAILURE: &'static str = "could not rehearse";
    type Result = Rehearsal;

    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        let study = DesignFile::below_or_paper(root, self.design.as_deref())?;
        let files = study.design.files();
        let effects = files.effects.as_ref().filter(|_| self.effects.is_none());
        let scales = self.scales.clone().unwrap_or_else(|| study.resolve(&files.scales));
        Ok(Files::default()
            .reads_design(self.design.as_deref())
            .reads(&self.population)
            .reads(&self.effects)
            .reads_if_there(effects.map(|path| study.resolve(path)))
            .reads([scales])
            .reads(&self.claims)
            .writes([&self.out]))
    }

    fn repeated_by(&mut self, command: &str) {
        self.command.get_or_insert_with(|| command.to_owned());
    }

    /// Runs the analysis of `stats study` on `studies` made-up studies of each size and scale of the effects; writes `rehearsal.json` and a
    /// page with figures and tables.
    ///
    /// # Source
    /// Method, end of section 7: without effects no more significant results than chance.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Rehearsal>, StudyError> {
        check(self)?;
        let world = read_world(
            &DesignFile::find(self.design.as_deref())?,
            [&self.population, &self.effects, &self.scales].map(Option::as_deref),
        )?;
        for &n in &self.participants {
            world.enough_donors(n).map_err(|few| few_donors(&few))?;
        }
        let mut grid = Vec::new();
        for &scale in &self.effect_scales {
            grid.extend(self.participants.iter().map(|n| (scale, *n)));
        }
        let worlds: Vec<World> = self.effect_scales.iter().map(|s| world.scaled(*s)).collect();
        let mut items = Vec::new();
        for (cell, _) in grid.iter().enumerate() {
            items.extend((0..self.studies).map(|index| (cell, index)));
        }
        let studied = for_each_on(self.jobs, &items, watch, "studies", |&(cell, index)| {
            let (scale, n) = grid[cell];
            let labels = [format!("{scale}"), n.to_string(), index.to_string()];
            let [scale, size, index] = labels.each_ref().map(String::as_str);
            let seed = stream_seed(self.seed, &["rehearsal", scale, size, index]);
            let study = worlds[cell / self.participants.len()].study(n, seed)?;
            let analysis = maveric_analysis::analyse(&study.data, Purpose::Simulation)?;
            let lent = analysis.lent.iter().map(|lent| LentStyles {
                condition: lent.condition,
                participants: n,
                people: lent.people,
                beyond_reach: lent.beyond_reach,
            });
            Ok((found_in(&analysis), lent.collect::<Vec<LentStyles>>()))
        })?;
        let (studied, lent): (Vec<Studied>, Vec<Vec<LentStyles>>) = studied.into_iter().unzip();
        let cells: Vec<Cell> = grid
            .iter()
            .zip(studied.chunks(self.studies))
            .map(|((scale, n), studies)| Cell::of(*n, *scale, studies))
            .collect();
        let signs = match &self.claims {
            Some(path) => signs::signs(path, &cells)?,
            None => Vec::new(),
        };
        let mut value = Rehearsal { synthetic: true, cells, findings: Vec::new(), signs };
        value.findings = match (value.is_null(), value.cells.first(), value.largest()) {
            (true, Some(cell), _) => vec![findings::families(cell), findings::single(cell)],
            (false, _, Some(cell)) => vec![findings::power(cell)],
            _ => Vec::new(),
        };
        write_json(&self.out.join("rehearsal.json"), &value)?;
        let words =
            page::Words { studies: self.studies, null: value.is_null(), signs: &value.signs };
        let texts = PageTexts::new(REHEARSAL, &words)?;
        let page = write_page(&self.out, &page::page(&value, self, &texts)?)?;
        let mut summary = tables::summary(&value, &texts)?;
        summary.push(format!("{} synthetic studies: {}", items.len(), page.to_slash_lossy()));
        let warnings = beyond_reach(&lent.concat());
        Ok(Outcome::new(value, summary, warnings))
    }
}

/// How many people of one made-up study were lent somebody else's style.
#[derive(Debug, Clone)]
struct LentStyles {
    condition: ConditionId,
    participants: usize,
    people: usize,
    beyond_reach: usize,
}

/// What a reader has to know of how donors were drawn, over all studies of a size.
fn beyond_reach(lent: &[LentStyles]) -> Vec<String> {
    let mut counts: BTreeMap<(ConditionId, usize), (usize, usize)> = BTreeMap::new();
    for study in lent {
        let count = counts.entry((study.condition, study.participants));
        let (beyond, people) = count.or_default();
        *beyond += study.beyond_reach;
        *people += study.people;
    }
    let beyond = counts.into_iter().filter(|(_, (beyond, _))| *beyond > 0);
    let line = |((condition, n), (beyond, people)): ((ConditionId, usize), (usize, usize))| {
        format!(
            "condition {condition}, studies of {n}: nobody within reach of {beyond} of {people} made-up people, who were lent the nearest style"
        )
    };
    beyond.map(line).collect()
}

fn few_donors(error: &RehearsalError) -> StudyError {
    let problem = error.to_string();
    let help = format!("such as --participants {}", FEWEST_DONORS + 1);
    StudyError::not_possible(problem).with_help(help)
}

fn check(options: &Rehearse) -> Result<(), StudyError> {
    let refuse = |problem: String| {
        let help = "such as --participants 24 --effects-times 0 --studies 4000";
        Err(StudyError::not_possible(problem).with_help(help))
    };
    if options.participants.is_empty() || options.effect_scales.is_empty() || options.studies == 0 {
        return refuse("no size, no scale of the effects or no study to rehearse".to_owned());
    }
    if let Some(n) = options.participants.iter().find(|n| !(4..=500).contains(*n)) {
        return refuse(format!("a study of {n} participants, expected 4 to 500"));
    }
    if !options.participants.is_sorted_by(|a, b| a < b) {
        return refuse("sizes of studies must ascend".to_owned());
    }
    if let Some(scale) = options.effect_scales.iter().find(|s| !(0.0..=10.0).contains(*s)) {
        return refuse(format!("effects times {scale}, expected 0 to 10"));
    }
    if options.effect_scales.iter().enumerate().any(|(i, s)| options.effect_scales[..i].contains(s))
    {
        return refuse("a scale of the effects stands twice".to_owned());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_was_lent_the_nearest_style_is_counted_over_the_studies_of_a_size() {
        let study = |participants, beyond_reach| LentStyles {
            condition: "other".parse().unwrap(),
            participants,
            people: participants,
            beyond_reach,
        };
        let told = beyond_reach(&[study(12, 2), study(12, 1), study(24, 0)]);
        assert_eq!(
            told,
            [
                "condition other, studies of 12: nobody within reach of 3 of 24 made-up people, who were lent the nearest style"
            ]
        );
        assert!(beyond_reach(&[]).is_empty());
    }
}
