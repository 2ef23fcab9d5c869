//! A run of a study: its design, its results, and what both say together.

use crate::{
    atomic_write::{if_there, read_json},
    design::DesignFile,
    error::StudyError,
    run_folder::{MEASUREMENTS, MODEL_FILE, read_model, read_scales, score_range, training_path},
    stages::{steer::own_drives, train::TrainingSummary},
    tables::{
        conditions::{ConditionRow, read_conditions},
        embeddings::{EmbeddingRow, read_embeddings},
        measurements::{MeasuredDrive, read_measurements},
    },
};
use maveric_analysis::Analysis;
use maveric_domain::{Design, ParticipantId, Scale};
use maveric_model::Model;
use maveric_report::{Context, figures::ConditionLook};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

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
            (None, true) => Context {
                synthetic: true,
                ..Context::real()
            },
            (_, false) => Context {
                scripted: analysis.scripted,
                ..Context::real()
            },
        };
        let conditions = if_there(&conditions, read_conditions)?;
        let embeddings = if_there(&folder.join("embeddings.csv"), read_embeddings)?;
        let context = Context {
            beyond: beyond_but_driven(&embeddings, &conditions, design),
            ..context
        };
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

/// People whose drive that is steered from is beyond what the model has learned from, and who have a condition that turns the dial all the same.
fn beyond_but_driven(
    rows: &[EmbeddingRow],
    conditions: &[ConditionRow],
    design: &Design,
) -> usize {
    let Some(baseline) = design.baseline_id() else {
        return 0;
    };
    let turned = |who: &ParticipantId| {
        let theirs = conditions.iter().filter(|row| row.participant == *who);
        theirs
            .filter_map(|row| design.condition(row.condition))
            .any(|condition| condition.side().is_some())
    };
    let steered_from = own_drives(rows, baseline).into_iter();
    let beyond = steered_from.filter(|row| row.beyond() == Some(true));
    let people: BTreeSet<&ParticipantId> = beyond.map(|row| &row.participant).collect();
    people.into_iter().filter(|who| turned(who)).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::{BeyondWhy, DriveId, Embedding};
    use std::num::NonZeroU32;

    #[test]
    fn who_was_driven_though_beyond_is_counted_by_the_drive_that_is_steered_from_alone() {
        let design = Design::from_toml(
            "[study]\ntitle = \"Two\"\n[people]\nlearn = { part = \"learn\" }\n[style]\nscore = \"adb.total\"\npoints = 15\n\
             [baseline]\nid = \"own\"\n[[condition]]\nid = \"sporty\"\ncar = { dial = \"+1\" }\n",
        )
        .unwrap();
        let who = ParticipantId::new("P1").unwrap();
        let style = || Embedding::new(vec![0.5]).unwrap();
        let drive = |session: u32, beyond: bool| {
            let id = DriveId::new(format!("P1-own{session}")).unwrap();
            EmbeddingRow {
                session: NonZeroU32::new(session).unwrap(),
                support_p: Some(0.5),
                beyond_why: beyond.then_some(BeyondWhy::Scale),
                ..EmbeddingRow::new(id, who.clone(), "own".parse().unwrap(), style())
            }
        };
        let turned = ConditionRow {
            participant: who.clone(),
            condition: "sporty".parse().unwrap(),
            adb_hat: None,
            moved_points: None,
            moved_points_sd: None,
            clamped: false,
            angle_rad: None,
            lent: None,
            beyond_training: false,
            beyond_why: None,
            sweep: None,
            embedding: style(),
        };
        let of = |first: bool, second: bool| {
            let rows = [drive(1, first), drive(2, second)];
            beyond_but_driven(&rows, std::slice::from_ref(&turned), &design)
        };
        assert_eq!((of(true, false), of(false, true)), (1, 0));
        assert_eq!(beyond_but_driven(&[drive(1, true)], &[], &design), 0);
    }
}
