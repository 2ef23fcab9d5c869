//! `steer`: where in style space each participant's conditions lie, or the points of a sweep.

mod attribute_scores;
mod conditions;
mod sweep;

pub use attribute_scores::AttributeSummary;

use crate::{
    design::DesignFile,
    error::StudyError,
    forget::refuse_learned_from_gone,
    outcome::{Outcome, Watch},
    outputs::spare_inputs,
    run_folder::read_model,
    tables::{
        conditions::{ConditionRow, write_conditions},
        embeddings::{EmbeddingRow, read_embeddings},
    },
};
use maveric_domain::{ConditionId, Embedding, ParticipantId};
use maveric_model::{
    Model, ModelError,
    style_space::{LinearHead, share_outside_training},
};
use serde::Serialize;
use std::path::PathBuf;

/// What to steer.
#[derive(Debug, Clone)]
pub struct SteerOptions {
    /// The study's design; `study.toml` of the folder one stands in without, else the paper's.
    pub design: Option<PathBuf>,
    /// Trained model.
    pub model: PathBuf,
    /// Fitted embeddings.
    pub embeddings: PathBuf,
    /// Conditions to write.
    pub out: PathBuf,
    /// A step of the dial, in points of the style or of the attribute; the design's without.
    pub points: Option<f64>,
    /// Points to sweep over in place of the conditions; may be empty.
    pub sweep: Vec<f64>,
    /// What to move along in place of aggression.
    pub attribute: Option<AttributeOptions>,
    /// Root of every random choice.
    pub seed: u64,
}

/// A move along something else than aggression.
#[derive(Debug, Clone)]
pub struct AttributeOptions {
    /// The score to move: `SCALE.SUBSCALE` of a table of scores, or a column of any other table.
    pub name: String,
    /// The table it stands in.
    pub scores: PathBuf,
    /// Scores to hold; `aggression` is the model's own head.
    pub hold: Vec<String>,
}

/// Where the conditions lie.
#[derive(Debug, Clone, Serialize)]
pub struct Steered {
    /// Participants.
    pub participants: usize,
    /// Shifts that the ends of the scale cut short.
    pub clamped: usize,
    /// Heads that were fitted to scores.
    pub attributes: Vec<AttributeSummary>,
    /// The conditions.
    pub conditions: Vec<ConditionRow>,
}

/// Places every condition of the design that has a learned car, for every baseline embedding that was fitted with the score of
/// the style; for one without a score, the fit without. With a sweep or an attribute, places its points instead.
///
/// # Errors
/// [`StudyError`] if model, embeddings or scores cannot be read, an attribute cannot be fitted or moved, or the model has no style
/// head and the design a dial: without one, cars such as the average driver's need no such head.
///
/// # Source
/// Method section 4.
pub fn steer(options: &SteerOptions, watch: Watch<'_>) -> Result<Outcome<Steered>, StudyError> {
    let named = options.design.as_deref().into_iter();
    let named = named.chain(options.attribute.as_ref().map(|a| &*a.scores));
    spare_inputs(
        named.chain([&*options.model, &options.embeddings]),
        [&*options.out],
    )?;
    let study = DesignFile::find(options.design.as_deref())?;
    refuse_learned_from_gone(&study, &options.model)?;
    let model = read_model(&options.model)?;
    let rows = read_embeddings(&options.embeddings)?;
    let sweeps = !options.sweep.is_empty() || options.attribute.is_some();
    let axis = match LinearHead::aggression(&model) {
        Err(ModelError::NoAggressionAxis) if !sweeps && !study.design.has_a_dial() => None,
        axis => Some(axis?),
    };
    let Some(baseline) = study.design.baseline_id() else {
        return Err(study.wrong(
            "`baseline`: found none, expected the drive by hand that the car is fitted to",
            Some("add [baseline] with the id of that drive, such as id = \"own\"".to_owned()),
        ));
    };
    let own = own_drives(&rows, baseline);
    if own.is_empty() {
        return Err(StudyError::file(
            &options.embeddings,
            "holds no own drive to steer from",
        ));
    }
    let outcome = match &axis {
        Some(axis) if sweeps => sweep::sweep(options, &study.design, (&model, axis), &own, watch)?,
        _ => conditions::conditions(options, &study, &model, axis.as_ref(), &own, watch)?,
    };
    write_conditions(&options.out, &outcome.value.conditions)?;
    Ok(outcome)
}

/// One row a participant: the fit with the ADB score where there is one.
fn own_drives(rows: &[EmbeddingRow], baseline: ConditionId) -> Vec<&EmbeddingRow> {
    let own = |r: &&EmbeddingRow| r.condition == baseline;
    let has_adb_fit = |p: &ParticipantId| {
        let mut fits = rows.iter().filter(own);
        fits.any(|r| r.participant == *p && r.adb_used)
    };
    rows.iter()
        .filter(own)
        .filter(|r| r.adb_used == has_adb_fit(&r.participant))
        .collect()
}

fn is_beyond(model: &Model, embedding: &Embedding) -> Result<bool, StudyError> {
    Ok(
        share_outside_training(model, std::slice::from_ref(embedding))?
            .is_some_and(|share| share > 0.5),
    )
}
