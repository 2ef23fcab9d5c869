//! The page of a study: sections that its design and its analysis fill, and how it was done.

mod accuracy;
mod conditions;
mod crossover;
mod factors;
mod homophily;
mod line;
mod manuscript;
mod methods;
mod people;
mod presses;
mod results;
mod retest;
mod tested;

pub use conditions::ItemInCondition;
pub use line::{line_panels, steps};
pub use methods::Paragraph;
pub use people::{ParticipantGroup, Reliability};

use crate::{
    page_texts::{METHODS, PageTexts, RESULTS, STUDY},
    texts::value,
    words::{self, correlation_of_claim, in_words, of_group, omnibus, percent},
};
use maveric_analysis::{Analysis, Panel};
use maveric_domain::{ConditionId, Design, Road, design::By};
use maveric_report::{Context, ReportError, claims::LedgerRow};
use minijinja::context;
use serde::Serialize;

/// What the page of a study is made from.
pub struct StudyPage<'a> {
    /// Conditions, outcomes and scales, as `study.toml` declares them.
    pub design: &'a Design,
    pub analysis: &'a Analysis,
    pub context: &'a Context,
    /// The claims that it is held against; empty where there are none.
    pub ledger: &'a [LedgerRow],
    /// The texts of the page, with the values that all of them may ask for.
    pub texts: PageTexts,
    methods: PageTexts,
    results: PageTexts,
}

/// What the texts may ask for beside design and analysis.
#[derive(Debug, Serialize)]
pub struct Facts<'a, Training> {
    /// The report of the training, where there was one.
    pub training: Option<&'a Training>,
    /// Size of the embedding, where there is a model.
    pub embedding_size: Option<usize>,
    /// Lowest and highest score of the style.
    pub score_range: Option<(f64, f64)>,
    /// The road, where a drive is there.
    pub road: Option<Road>,
    /// Posted speed on it, in m/s.
    pub posted_mps: Option<f64>,
    /// Mean length of the baseline drives, in minutes.
    pub minutes: Option<f64>,
}

impl<'a> StudyPage<'a> {
    /// # Errors
    /// [`ReportError::Template`] naming a file of texts and its fault.
    pub fn new<Training: Serialize>(
        (design, analysis): (&'a Design, &'a Analysis),
        context: &'a Context,
        ledger: &'a [LedgerRow],
        facts: &Facts<'_, Training>,
    ) -> Result<Self, ReportError> {
        let conditions = design.conditions();
        let labels = conditions.iter().map(|c| words::label(design, c.id));
        let labels: Vec<String> = labels.collect();
        let baseline = design.baseline();
        let values = context! {
            style => words::style(design),
            participants => analysis.participants,
            own => design.own_style().map(|id| id.to_string()),
            across => design.across().map(|id| id.to_string()),
            baseline => baseline.map(|b| b.id.to_string()),
            by_hand => baseline.is_some_and(|b| b.by == By::Hand),
            count => in_words(conditions.len()),
            labels,
            digits => words::decimals(facts.score_range),
            preface => context.preface(),
            speed => context! { unit => context.speed.name(), per_mps => context.speed.per_mps() },
            ..value(facts),
        };
        Ok(Self {
            design,
            analysis,
            context,
            ledger,
            texts: PageTexts::new(STUDY, &values)?.labelled(design),
            methods: PageTexts::new(METHODS, &values)?.labelled(design),
            results: PageTexts::new(RESULTS, &values)?.labelled(design),
        })
    }

    /// How many took part in what.
    ///
    /// # Errors
    /// [`ReportError::Template`] for a text that asks for a value which is not given.
    pub fn subtitle(&self) -> Result<String, ReportError> {
        self.texts.text("subtitle")
    }

    /// Whether any condition is compared with another, or with the baseline.
    fn compares(&self) -> bool {
        let mut panels = self.analysis.panels.iter();
        panels.any(|panel| !panel.contrasts.is_empty())
    }

    /// The lines that a run ends with.
    pub fn lines(&self) -> Result<Vec<String>, ReportError> {
        let a = self.analysis;
        let mut lines = vec![self.subtitle()?];
        if let Some(first) = a.reproduction.first() {
            let of_each = a.reproduction.iter();
            let accuracies: Vec<String> = of_each
                .map(|r| format!("{} {}", r.title.to_lowercase(), percent(r.mean)))
                .collect();
            let values = context! { condition => first.condition.to_string(), accuracies };
            lines.push(self.texts.with(&values).text("accuracy")?);
        }
        for line in [&a.line, &a.line_without_adb].into_iter().flatten() {
            if let Some(score) = line.rows.last() {
                let values = context! { adb_used => line.adb_used, ..value(score) };
                lines.push(self.texts.with(&values).text("line")?);
            }
        }
        for panel in &a.panels {
            let values = context! { title => titled(panel), over => words::over(self.design, panel), test => omnibus(self.design, panel, false) };
            lines.push(self.texts.with(&values).text("panel")?);
        }
        Ok(lines)
    }

    /// The correlation that the paper printed, with marks.
    fn printed(&self, key: &str) -> Option<String> {
        let row = self.ledger.iter().find(|row| row.claim.key == key)?;
        correlation_of_claim(&row.claim)
    }

    fn label(&self, id: ConditionId) -> String {
        words::label(self.design, id)
    }
}

/// An outcome, and whose it is where people are divided.
fn titled(panel: &Panel) -> String {
    format!("{}{}", panel.title, of_group(panel))
}
