//! `codebook`: what each questionnaire asks and how it is scored, and what a study measures of its own, for people and for programs.

use crate::{
    atomic_write::atomic_write_bytes,
    design::DesignFile,
    error::StudyError,
    outcome::{Outcome, Watch},
    outputs::spare_inputs,
    run_folder::read_scales,
    stage::{Files, Stage},
    tables::{TableName, write_rows},
    texts,
};
use maveric_domain::{
    Scale,
    design::{OwnMeasure, Sign},
    survey::Scoring,
};
use minijinja::{Value, context};
use path_slash::PathExt as _;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Describe the questionnaires (items, ranges, reversals, subscales, norms) and the study's own measures
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example: maveric codebook --scales study_data/scales --out codebook")]
pub struct Describe {
    /// Folder of questionnaire definitions
    #[arg(long, default_value = "study_data/scales")]
    pub scales: PathBuf,
    /// Design of the study (TOML), for its own measures; study.toml of the current directory when not given
    #[arg(long, value_name = "FILE")]
    pub design: Option<PathBuf>,
    /// Folder to write into: codebook.md, codebook.csv and, of a study with measures of its own, codebook_measures.csv
    #[arg(long)]
    pub out: PathBuf,
}

/// What was described.
#[derive(Debug, Clone, Serialize)]
pub struct Codebook {
    /// Questionnaires.
    pub scales: usize,
    /// Their items.
    pub items: usize,
    /// Measures of the study's own.
    pub measures: usize,
}

/// An item of a subscale: a row of `codebook.csv`.
#[derive(Serialize)]
struct ItemRow {
    scale: String,
    subscale: String,
    item: u32,
    column: String,
    min: i32,
    max: i32,
    reversed: bool,
    wording: String,
}

/// A measure of the study's own: a row of `codebook_measures.csv`.
#[derive(Serialize)]
struct MeasureRow {
    id: String,
    title: String,
    unit: String,
    aggression: String,
}

impl From<&OwnMeasure> for MeasureRow {
    fn from(measure: &OwnMeasure) -> Self {
        Self {
            id: measure.id.clone(),
            title: measure.title.clone(),
            unit: measure.unit.clone(),
            aggression: match measure.aggression {
                Some(Sign::Plus) => "up",
                Some(Sign::Minus) => "down",
                None => "not known",
            }
            .to_owned(),
        }
    }
}

impl Stage for Describe {
    const NAME: &'static str = "codebook";
    const FAILURE: &'static str = "could not write the codebook";
    type Result = Codebook;

    fn files(&self, _root: &Path) -> Result<Files, StudyError> {
        Ok(Files::default()
            .reads([&self.scales])
            .reads_design(self.design.as_deref())
            .writes_into(
                &self.out,
                &["codebook.csv", "codebook.md", "codebook_measures.csv"],
            ))
    }

    /// Writes the codebook of every scale of a folder: Markdown for people; a CSV row an item of each subscale.
    fn work(&self, watch: Watch<'_>) -> Result<Outcome<Codebook>, StudyError> {
        let csv = self.out.join("codebook.csv");
        let markdown = self.out.join("codebook.md");
        let of_measures = self.out.join("codebook_measures.csv");
        spare_inputs([&*self.scales], [&*csv, &markdown, &of_measures])?;
        let study = DesignFile::here(self.design.as_deref())?;
        let design = study.as_ref().map(|study| &study.design);
        let own: Vec<MeasureRow> = design
            .iter()
            .flat_map(|design| design.measures())
            .map(MeasureRow::from)
            .collect();
        let scales = read_scales(&self.scales)?;
        watch.check()?;
        let described: Vec<Value> = scales.iter().map(described).collect();
        let measures = own.iter().map(|m| {
            context! { id => &m.id, title => shown(&m.title), unit => shown(&m.unit), aggression => &m.aggression }
        });
        let values = context! {
            scales => described,
            measures => measures.collect::<Vec<Value>>(),
            measured_in => design.map(|d| d.files().measures.to_slash_lossy()),
        };
        let page = texts::fill(texts::CODEBOOK, values);
        let mut rows = Vec::new();
        for scale in &scales {
            for subscale in &scale.subscales {
                rows.extend(subscale.items.iter().map(|&item| {
                    ItemRow {
                        scale: scale.id.clone(),
                        subscale: subscale.id.clone(),
                        item,
                        column: scale.column_of(item),
                        min: scale.min,
                        max: scale.max,
                        reversed: scale.is_reversed(subscale, item),
                        wording: scale
                            .wording
                            .get(item as usize - 1)
                            .cloned()
                            .unwrap_or_default(),
                    }
                }));
            }
        }
        write_rows(TableName::Codebook, &csv, &rows)?;
        if !own.is_empty() {
            write_rows(TableName::CodebookMeasures, &of_measures, &own)?;
        }
        atomic_write_bytes(&markdown, page.as_bytes())?;
        let value = Codebook {
            scales: scales.len(),
            items: scales.iter().map(|s| s.items as usize).sum(),
            measures: own.len(),
        };
        let summary = vec![format!(
            "{} scales, {} items: {}, {}",
            value.scales,
            value.items,
            markdown.to_slash_lossy(),
            csv.to_slash_lossy()
        )];
        Ok(Outcome {
            value,
            summary,
            warnings: Vec::new(),
        })
    }
}

/// A text as Markdown shows it: no mark-up of its own, and one line.
fn shown(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '|' => out.push_str("\\|"),
            '\n' | '\r' | '\t' => out.push(' '),
            c if c.is_control() => {}
            c => out.push(c),
        }
    }
    out
}

/// What the codebook says of a scale.
fn described(scale: &Scale) -> Value {
    let subscales = scale.subscales.iter().map(|subscale| {
        let items = subscale.items.iter().copied();
        let reversed: Vec<u32> = items.filter(|i| scale.is_reversed(subscale, *i)).collect();
        let (low, high) = scale.score_range(subscale);
        let norms = subscale.norms.as_ref().map_or_else(
            || " | | | ".to_owned(),
            |n| {
                let alpha = n.alpha_source.as_ref();
                let alpha = alpha.map_or_else(String::new, |s| format!("; alpha: {}", shown(s)));
                let source = shown(&n.source);
                format!("{} | {} | {} | {source}{alpha}", n.mean, n.sd, n.alpha)
            },
        );
        context! {
            id => subscale.id.clone(), title => shown(&subscale.title), items => subscale.items.clone(), reversed,
            low => low.to_string(), high => high.to_string(), norms,
        }
    });
    let correlations = scale.correlations.iter().map(|c| {
        let [one, other] = &c.of;
        format!("{one} with {other} {} ({})", c.r, shown(&c.source))
    });
    let wording = scale.wording.iter().map(|text| shown(text));
    context! {
        id => scale.id.clone(),
        title => shown(&scale.title),
        reference => shown(&scale.reference),
        items => scale.items,
        min => scale.min,
        max => scale.max,
        first => scale.column_of(1),
        last => scale.column_of(scale.items),
        scoring => match scale.scoring {
            Scoring::Sum => "sum",
            Scoring::Mean => "mean",
        },
        answered => format!("{:.0}", 100.0 * scale.min_answered),
        subscales => subscales.collect::<Vec<Value>>(),
        correlations => correlations.collect::<Vec<String>>(),
        wording => wording.collect::<Vec<String>>(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wording_is_text_and_neither_mark_up_nor_a_cell_of_its_own() {
        assert_eq!(
            shown("a | <script>b</script>\n& c\u{1b}[2J"),
            "a \\| &lt;script&gt;b&lt;/script&gt; &amp; c[2J"
        );
    }
}
