//! `score`: questionnaire answers to scores and reliabilities.

mod item_means;
mod left_out;

use crate::{
    design::DesignFile,
    error::StudyError,
    gate::counted,
    mean::{mean, sd},
    once::count,
    outcome::{Outcome, Watch},
    run_folder::{exclusions_path, item_means_path, items_path, read_scales, reliabilities_path},
    stage::{Files, Stage},
    stages::import::told_as_export,
    tables::{
        Table, TableName,
        keys::one_case_of,
        surveys::{read_answered, refuse_unclear, write_scores},
        write_rows,
    },
};
pub use item_means::ItemMean;
use item_means::item_means;
pub(crate) use left_out::of_answers;
use left_out::{Expected, exclusions, let_in, line, nothing_to_score};
use maveric_analysis::Rule;
use maveric_domain::{Moment, ParticipantId, Scale, Score, Subscale};
use maveric_measures::{
    ItemMatrix,
    survey::{attention_missed, response_styles, score_probes, too_fast},
};
use maveric_stats::AlphaAnalysis;
use path_slash::PathExt as _;
use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// Turn questionnaire answers into scores and reliabilities
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example: maveric score --surveys surveys.csv --out scores.csv")]
pub struct ScoreAnswers {
    /// Design of the study (TOML); study.toml of the current directory when not given. Without either nothing is left out
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// Answers: participant, moment, scale, item, answer; may be given more than once
    #[arg(long, required = true)]
    pub surveys: Vec<PathBuf>,
    /// Table of who should have answered: whoever of them did not is listed
    #[arg(long)]
    pub participants: Option<PathBuf>,
    /// Folder of questionnaire definitions; the design's when not given
    #[arg(long)]
    pub scales: Option<PathBuf>,
    /// Folder of drives: what was said of those left out there as too short is left out too, and nobody is expected to answer after a ride
    /// that others have there and they have not; may be given more than once
    #[arg(long)]
    pub drives: Vec<PathBuf>,
    /// Score all answers, or only those given after a drive
    #[arg(long, value_enum, default_value_t)]
    pub moments: Moments,
    /// Scores to write; NAME_reliabilities.csv, NAME_items.csv, NAME_item_means.csv and NAME_exclusions.csv go beside them
    #[arg(long)]
    pub out: PathBuf,
}

/// Which answers to score.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Moments {
    /// All of them
    #[default]
    All,
    /// Those given after a drive
    After,
}

/// Reliability of one subscale, and how its scores lie; a number that does not exist is missing.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Reliability {
    pub scale: String,
    pub subscale: String,
    pub items: usize,
    pub n: usize,
    pub dropped: usize,
    pub people: Option<usize>,
    pub alpha: Option<f64>,
    pub ci_low: Option<f64>,
    pub ci_high: Option<f64>,
    pub omega: Option<f64>,
    pub mean: Option<f64>,
    pub sd: Option<f64>,
    pub floor: usize,
    pub ceiling: usize,
    /// A table of their own.
    #[serde(skip_deserializing)]
    pub item: Vec<ItemReliability>,
}

/// One item of a subscale, as scored (after reversal); complete respondents.
#[derive(Debug, Clone, Serialize)]
pub struct ItemReliability {
    pub item: u32,
    pub reversed: bool,
    pub mean: Option<f64>,
    pub sd: Option<f64>,
    pub r_rest: Option<f64>,
    pub alpha_dropped: Option<f64>,
    pub floor: usize,
    pub ceiling: usize,
}

#[derive(Debug, Clone, Serialize)]
pub struct ScoredSurveys {
    pub scores: usize,
    pub missing: usize,
    pub reliabilities: Vec<Reliability>,
}

/// Reliability over one sheet a person: those from before the drives where there are any. After the conditions a person
/// answers once a condition, and all sheets count, as the paper's scales were used; the interval then allows for sheets of one
/// person being alike.
fn reliability(matrix: &ItemMatrix, scales: &[Scale], scores: &[Score]) -> Reliability {
    let names: Vec<String> = matrix.items.iter().map(|item| format!("item {item}")).collect();
    let before = matrix.respondents.iter().any(|(_, moment)| *moment == Moment::Pre);
    let counts = |moment: Moment| !before || moment == Moment::Pre;
    let (people, sheets): (Vec<String>, Vec<&Vec<Option<f64>>>) = matrix
        .respondents
        .iter()
        .zip(&matrix.answers)
        .filter(|((_, m), _)| counts(*m))
        .map(|((who, _), row)| (who.to_string(), row))
        .unzip();
    let column_of = |sheets: &[&Vec<Option<f64>>], item: usize| {
        sheets.iter().map(|row| row[item]).collect::<Vec<_>>()
    };
    let columns: Vec<Vec<Option<f64>>> = (0..names.len()).map(|i| column_of(&sheets, i)).collect();
    let items: Vec<(&str, &[Option<f64>])> = names
        .iter()
        .zip(&columns)
        .map(|(name, column)| (name.as_str(), column.as_slice()))
        .collect();
    let scale = scales.iter().find(|s| s.id == matrix.scale);
    // Numbers of people's own have no points in common: what they hold together by is not asked.
    let rates = |item: &u32| scale.and_then(|s| s.item(*item)).is_some_and(|i| i.kind.rates());
    let analysis = maveric_stats::alpha(&items, Some(&people)).ok();
    let analysis = analysis.filter(|_| matrix.items.iter().all(rates));
    let alpha = analysis.as_ref().map(|a| &a.alpha);
    let is_complete = |row: &&Vec<Option<f64>>| row.iter().all(Option::is_some);
    let complete: Vec<&Vec<Option<f64>>> = sheets.iter().copied().filter(is_complete).collect();
    let complete_columns: Vec<Vec<Option<f64>>> =
        (0..names.len()).map(|i| column_of(&complete, i)).collect();
    let values: Vec<f64> = scores
        .iter()
        .filter(|s| s.scale == matrix.scale && s.subscale == matrix.subscale && counts(s.moment))
        .filter_map(|s| s.value)
        .collect();
    let subscale = scale.and_then(|s| s.subscales.iter().find(|u| u.id == matrix.subscale));
    let ends = scale.zip(subscale).map(|(scale, subscale)| scale.score_range(subscale));
    let count_at = |end: f64| values.iter().filter(|v| (*v - end).abs() < 1e-9).count();
    Reliability {
        scale: matrix.scale.clone(),
        subscale: matrix.subscale.clone(),
        items: matrix.items.len(),
        n: complete.len(),
        dropped: sheets.len() - complete.len(),
        people: analysis.as_ref().and_then(|a| a.people),
        alpha: alpha.and_then(|a| a.raw),
        ci_low: alpha.and_then(|a| a.ci.low),
        ci_high: alpha.and_then(|a| a.ci.high),
        omega: alpha.and_then(|a| a.omega),
        mean: mean(&values),
        sd: sd(&values),
        floor: ends.map_or(0, |(low, _)| count_at(low)),
        ceiling: ends.map_or(0, |(_, high)| count_at(high)),
        item: scale
            .zip(subscale)
            .map(|(scale, subscale)| {
                item_parts(scale, subscale, &complete_columns, analysis.as_ref())
            })
            .unwrap_or_default(),
    }
}

fn item_parts(
    scale: &Scale,
    subscale: &Subscale,
    columns: &[Vec<Option<f64>>],
    analysis: Option<&AlphaAnalysis>,
) -> Vec<ItemReliability> {
    let part = |(i, (&item, column)): (usize, (&u32, &Vec<Option<f64>>))| {
        let count_at = |end: i32| {
            let ticked = |v: &Option<f64>| v.is_some_and(|v| (v - f64::from(end)).abs() < 1e-9);
            column.iter().filter(|v| ticked(v)).count()
        };
        let (definition, statistics) = (scale.item(item), analysis.map(|f| &f.item[i]));
        ItemReliability {
            item,
            reversed: scale.is_reversed(subscale, item),
            mean: statistics.map(|s| s.mean),
            sd: statistics.map(|s| s.sd),
            r_rest: statistics.and_then(|s| s.r_drop),
            alpha_dropped: analysis.and_then(|f| f.drop[i].alpha),
            floor: definition.map_or(0, |definition| count_at(definition.min)),
            ceiling: definition.map_or(0, |definition| count_at(definition.max)),
        }
    };
    let items = scale.items_of(subscale);
    items.iter().zip(columns).enumerate().map(part).collect()
}

impl Stage for ScoreAnswers {
    const NAME: &'static str = "score";
    const FAILURE: &'static str = "could not score the questionnaires";
    type Result = ScoredSurveys;

    fn files(&self, root: &Path) -> Result<Files, StudyError> {
        let study = DesignFile::below_or_paper(root, self.design.as_deref())?;
        Ok(Files::default()
            .reads(&self.surveys)
            .reads([study.scales_folder(self.scales.as_deref())])
            .reads(&self.drives)
            .reads_people(root, self.design.as_deref(), self.participants.as_deref())
            .writes([&self.out])
            .writes(
                [reliabilities_path, items_path, item_means_path, exclusions_path]
                    .map(|beside| beside(&self.out)),
            ))
    }

    /// Scores answers by the scales of a folder and writes scores and reliabilities.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<ScoredSurveys>, StudyError> {
        let design = self.design.as_deref();
        let asked = DesignFile::find(design)?.scales_folder(self.scales.as_deref());
        let scales = read_scales(&asked)?;
        let (mut answers, mut probes, mut times) = (Vec::new(), Vec::new(), Vec::new());
        let study = DesignFile::here(design)?;
        for path in &self.surveys {
            let answered = read_answered(path).map_err(|error| told_as_export(path, error))?;
            if let Some(study) = &study {
                refuse_unclear(path, &answered.answers, &study.design)?;
            }
            answers.extend(answered.answers);
            probes.extend(answered.probes);
            times.extend(answered.times);
        }
        let nothing_given = answers.is_empty() && probes.is_empty();
        if self.moments == Moments::After {
            answers.retain(|a| a.moment.ride().is_some());
            times.retain(|t| t.moment.ride().is_some());
        }
        watch.check()?;
        let collected = (&mut answers, &mut probes, &mut times);
        let (left_out, gate) = let_in(study.as_ref(), self, &scales, collected)?;
        let at = left_out.keys().map(|(who, moment, _)| (who, moment.to_string()));
        let strangers = gate.as_ref().map_or_else(Vec::new, |gate| gate.unknown_people(at));
        one_case_of(answers.iter().map(|answer| &answer.participant))?;
        let nothing_let_in = answers.is_empty() && probes.is_empty();
        // Rides may not have been rated yet, or not at all: then the tables are empty.
        if nothing_let_in && (nothing_given || self.moments == Moments::All) {
            return Err(nothing_to_score(&left_out));
        }
        let participants: Option<Vec<ParticipantId>> = self
            .participants
            .as_deref()
            .map(|path| Table::read(path)?.ids("participant"))
            .transpose()?;
        let scales = match &study {
            Some(study) => study.design.with_dropped_items(scales),
            None => scales,
        };
        let mut scored = maveric_measures::score(&scales, &answers, participants.as_deref())?;
        let people: Option<BTreeSet<&ParticipantId>> =
            participants.as_ref().map(|ids| ids.iter().collect());
        let takes_part = |who: &ParticipantId| people.as_ref().is_none_or(|p| p.contains(who));
        probes.retain(|p| takes_part(&p.participant));
        scored.scores.extend(score_probes(&scales, &probes)?);
        let mut warnings = scored.warnings;
        let expected = Expected::new(study.as_ref().zip(gate), self, &left_out)?;
        warnings.retain(|warning| expected.misses(warning));
        let doubtful = response_styles(&scales, &answers)
            .into_iter()
            .chain(attention_missed(&scales, &answers))
            .chain(too_fast(&times));
        warnings.extend(doubtful.filter(|w| takes_part(w.participant())));
        let reliabilities: Vec<Reliability> = scored
            .matrices
            .iter()
            .map(|matrix| reliability(matrix, &scales, &scored.scores))
            .collect();
        write_scores(&self.out, &scored.scores)?;
        write_reliabilities(&self.out, &reliabilities)?;
        write_rows(
            TableName::ItemMeans,
            &item_means_path(&self.out),
            item_means(&scales, answers.iter().filter(|a| takes_part(&a.participant))),
        )?;
        let rows = exclusions(&warnings, &left_out, self.moments);
        write_rows(TableName::LeftOut, &exclusions_path(&self.out), rows)?;
        let missing = scored.scores.iter().filter(|s| s.value.is_none()).count();
        let mut summary = vec![format!(
            "{} scores ({missing} missing): {}",
            scored.scores.len(),
            self.out.to_slash_lossy()
        )];
        if nothing_let_in && left_out.is_empty() {
            summary.push("no answers after a drive".to_owned());
        }
        summary.extend(counted(
            ["sheet of answers", "sheets of answers"],
            left_out.keys().map(|(.., why)| why),
        ));
        let lines = warnings.iter().map(|w| line(w, self.moments));
        let mut warnings: Vec<String> = lines.collect();
        warnings.extend(strangers);
        let known = left_out.iter().filter(|((.., why), _)| why.rule != Rule::UnknownParticipant);
        warnings.extend(known.map(|((who, moment, why), n)| {
            let n = count(*n, "answer", "answers");
            format!("participant {who} ({moment}): {n} {why}")
        }));
        let value = ScoredSurveys { scores: scored.scores.len(), missing, reliabilities };
        Ok(Outcome::new(value, summary, warnings))
    }
}

fn write_reliabilities(out: &Path, rows: &[Reliability]) -> Result<(), StudyError> {
    write_rows(TableName::Reliabilities, &reliabilities_path(out), rows)?;
    let items = rows.iter().flat_map(|score| {
        let named = (("scale", &score.scale), ("subscale", &score.subscale));
        score.item.iter().map(move |item| (named, ("n", score.n), item))
    });
    write_rows(TableName::Items, &items_path(out), items)
}

#[cfg(test)]
mod tests;
