//! A run of a study: its design, its results, and what both say together.

use crate::{
    atomic_write::{if_there, read_json},
    beyond::turned_for,
    design::DesignFile,
    error::StudyError,
    run_folder::{MEASUREMENTS, MODEL_FILE, read_model, read_scales, score_range, training_path},
    stages::train::TrainingSummary,
    tables::{
        conditions::{ConditionRow, read_conditions},
        embeddings::read_embeddings,
        measurements::{MeasuredDrive, read_measurements},
    },
};
use maveric_analysis::Analysis;
use maveric_domain::{Design, Scale};
use maveric_model::Model;
use maveric_report::{Context, figures::ConditionLook};
use std::path::{Path, PathBuf};

/// What the page of a study is made from.
pub(in crate::stages::report) struct Run {
    pub(in crate::stages::report) design: Design,
    /// Score ranges of the questionnaires, where the design leaves them to the file.
    pub(in crate::stages::report) scales: Vec<Scale>,
    pub(in crate::stages::report) analysis: Analysis,
    pub(in crate::stages::report) training: Option<TrainingSummary>,
    pub(in crate::stages::report) model: Option<Model>,
    /// Where it stands: among the results, or where the design says that it was learned.
    pub(in crate::stages::report) model_file: PathBuf,
    pub(in crate::stages::report) measured: Vec<MeasuredDrive>,
    pub(in crate::stages::report) conditions: Vec<ConditionRow>,
    pub(in crate::stages::report) context: Context,
}

impl Run {
    /// Reads a run: its results and, where the design says that the model was learned elsewhere, that model.
    pub(in crate::stages::report) fn read(
        folder: &Path,
        study: &DesignFile,
    ) -> Result<Self, StudyError> {
        let design = &study.design;
        let analysis: Analysis = read_json(&folder.join("analysis.json"))?;
        let model = match design.model().filter(|_| design.needs_a_model()) {
            Some(elsewhere) => study.resolve(&elsewhere.file),
            None => folder.join(MODEL_FILE),
        };
        let summary = training_path(&folder.join(MODEL_FILE));
        let conditions = folder.join("conditions.csv");
        let training: Option<TrainingSummary> =
            if_there(&summary, |path| read_json(path).map(Some))?;
        let context = match (&training, analysis.synthetic) {
            (Some(training), true) => Context::synthetic(training.seed),
            (None, true) => Context { synthetic: true, ..Context::real() },
            (_, false) => Context { scripted: analysis.scripted, ..Context::real() },
        };
        let conditions = if_there(&conditions, read_conditions)?;
        let embeddings = if_there(&folder.join("embeddings.csv"), read_embeddings)?;
        let turned = turned_for(&embeddings, &conditions, design);
        let context =
            Context { beyond: turned.values().filter(|turned| **turned).count(), ..context };
        Ok(Self {
            scales: read_scales(&study.resolve(&design.files().scales))?,
            model: if_there(&model, |path| read_model(path).map(Some))?,
            model_file: model,
            conditions,
            measured: if_there(&folder.join(MEASUREMENTS), read_measurements)?,
            context: context
                .with_conditions(ConditionLook::of(design))
                .with_speed(design.speed_unit()),
            design: design.clone(),
            analysis,
            training,
        })
    }

    /// What the dial turns, on the page.
    pub(in crate::stages::report) fn style_label(&self) -> &str {
        self.design.style().map_or("the style", |s| &s.label)
    }

    /// Lowest and highest score of the style.
    pub(in crate::stages::report) fn score_range(&self) -> Option<(f64, f64)> {
        let style = self.design.style()?;
        let declared = style.range.map(|[low, high]| (low, high));
        declared.or_else(|| score_range(&self.scales, &style.score))
    }

    pub(in crate::stages::report) fn seed(&self) -> Option<u64> {
        self.training.as_ref().map(|t| t.seed)
    }
}
