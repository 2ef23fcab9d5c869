//! `steer`: where in style space each participant's conditions lie, or the points of a sweep.

mod attribute_scores;
mod sweep;

pub use attribute_scores::AttributeSummary;

use crate::{
    error::StudyError,
    outcome::{Outcome, Watch},
    stages::train::read_model,
    tables::{
        conditions::{ConditionRow, write_conditions},
        embeddings::{EmbeddingRow, read_embeddings},
    },
};
use maveric_domain::{ConditionId, Embedding, ParticipantId, stream_seed};
use maveric_model::{
    Model, ModelError,
    style_space::{AggressionAxis, PerpendicularEllipse, share_outside_training, shift},
};
use rand_pcg::{Pcg64Mcg, rand_core::SeedableRng};
use serde::Serialize;
use std::path::PathBuf;

/// What to steer.
#[derive(Debug, Clone)]
pub struct SteerOptions {
    /// Trained model.
    pub model: PathBuf,
    /// Fitted embeddings.
    pub embeddings: PathBuf,
    /// Conditions to write.
    pub out: PathBuf,
    /// How far to move, in points of ADB or of the attribute.
    pub points: f64,
    /// Points to sweep over in place of the four conditions; may be empty.
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

/// Places Mimic, Aggressive, Cautious and Perpendicular for every own-drive embedding that was fitted with its ADB
/// score; for one without a score, the fit without. With a sweep or an attribute, places its points instead.
///
/// # Errors
/// [`StudyError`] if model, embeddings or scores cannot be read, the model has no style head, or an attribute cannot be
/// fitted or moved.
///
/// # Source
/// Method section 4.
pub fn steer(options: &SteerOptions, watch: Watch<'_>) -> Result<Outcome<Steered>, StudyError> {
    let model = read_model(&options.model)?;
    let rows = read_embeddings(&options.embeddings)?;
    let axis = AggressionAxis::of(&model)?;
    let own = own_drives(&rows);
    if own.is_empty() {
        return Err(StudyError::file(
            &options.embeddings,
            "holds no own drive to steer from",
        ));
    }
    let outcome = if options.sweep.is_empty() && options.attribute.is_none() {
        four_conditions(options, &model, &axis, &own, watch)?
    } else {
        sweep::sweep(options, &model, &axis, &own, watch)?
    };
    write_conditions(&options.out, &outcome.value.conditions)?;
    Ok(outcome)
}

/// One row a participant: the fit with the ADB score where there is one.
fn own_drives(rows: &[EmbeddingRow]) -> Vec<&EmbeddingRow> {
    let own = |r: &&EmbeddingRow| r.condition == ConditionId::OWN;
    let has_adb_fit = |p: &ParticipantId| {
        let mut fits = rows.iter().filter(own);
        fits.any(|r| r.participant == *p && r.adb_used)
    };
    rows.iter()
        .filter(own)
        .filter(|r| r.adb_used == has_adb_fit(&r.participant))
        .collect()
}

fn four_conditions(
    options: &SteerOptions,
    model: &Model,
    axis: &AggressionAxis,
    own: &[&EmbeddingRow],
    watch: Watch<'_>,
) -> Result<Outcome<Steered>, StudyError> {
    let mut warnings = Vec::new();
    let ellipse = match PerpendicularEllipse::of(model) {
        Err(error @ ModelError::NoPerpendicular { .. }) => {
            warnings.push(format!("condition perpendicular left out: {error}"));
            None
        }
        other => Some(other?),
    };
    let mut conditions = Vec::new();
    let mut clamped = 0;
    for row in own {
        watch.check()?;
        let mut place =
            |condition, embedding: Embedding, moved_points, angle_rad| -> Result<(), StudyError> {
                conditions.push(ConditionRow {
                    participant: row.participant.clone(),
                    condition,
                    adb_hat: axis.aggression_hat(&embedding)?,
                    moved_points,
                    angle_rad,
                    beyond_training: is_beyond(model, &embedding)?,
                    sweep: None,
                    embedding,
                });
                Ok(())
            };
        let up = shift(axis, &row.embedding, options.points)?;
        let down = shift(axis, &row.embedding, -options.points)?;
        clamped += usize::from(up.clamped) + usize::from(down.clamped);
        place(ConditionId::MIMIC, row.embedding.clone(), 0.0, None)?;
        place(
            ConditionId::AGGRESSIVE,
            up.embedding,
            up.effective_points,
            None,
        )?;
        place(
            ConditionId::CAUTIOUS,
            down.embedding,
            down.effective_points,
            None,
        )?;
        if let Some(ellipse) = &ellipse {
            let mut rng = Pcg64Mcg::seed_from_u64(stream_seed(
                options.seed,
                &[row.participant.as_str(), "perpendicular"],
            ));
            let across = ellipse.sample(&row.embedding, &mut rng)?;
            place(
                ConditionId::PERPENDICULAR,
                across.embedding,
                0.0,
                Some(across.angle_rad),
            )?;
        }
    }
    if clamped > 0 {
        warnings.push(format!(
            "{clamped} of {} shifts were cut short by the ends of the ADB scale",
            2 * own.len()
        ));
    }
    let summary = vec![format!(
        "{} participants × {} conditions: {}",
        own.len(),
        if ellipse.is_some() { 4 } else { 3 },
        options.out.display()
    )];
    Ok(Outcome {
        value: Steered {
            participants: own.len(),
            clamped,
            attributes: Vec::new(),
            conditions,
        },
        summary,
        warnings,
    })
}

fn is_beyond(model: &Model, embedding: &Embedding) -> Result<bool, StudyError> {
    Ok(
        share_outside_training(model, std::slice::from_ref(embedding))?
            .is_some_and(|share| share > 0.5),
    )
}
