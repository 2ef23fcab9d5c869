//! `steer`: where in style space each participant's four conditions lie.

use crate::{
    error::StudyError,
    outcome::{Outcome, Watch},
    stages::train::read_model,
    tables::{
        conditions::{ConditionRow, write_conditions},
        embeddings::read_embeddings,
    },
};
use maveric_domain::{Condition, Embedding, ParticipantId, stream_seed};
use maveric_model::{
    Model,
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
    /// How far to move along the aggression line, in ADB points.
    pub points: f64,
    /// Root of every random choice.
    pub seed: u64,
}

/// Where the conditions lie.
#[derive(Debug, Clone, Serialize)]
pub struct Steered {
    /// Participants.
    pub participants: usize,
    /// Shifts that the ends of the scale cut short.
    pub clamped: usize,
    /// The conditions.
    pub conditions: Vec<ConditionRow>,
}

/// Places Mimic, Aggressive, Cautious and Perpendicular for every own-drive embedding that was fitted with its ADB
/// score; for one without a score, the fit without.
///
/// # Errors
/// [`StudyError`] if model or embeddings cannot be read, or the model has no style head.
///
/// # Source
/// Method section 4.
pub fn steer(options: &SteerOptions, watch: Watch<'_>) -> Result<Outcome<Steered>, StudyError> {
    let model = read_model(&options.model)?;
    let rows = read_embeddings(&options.embeddings)?;
    let axis = AggressionAxis::of(&model)?;
    let ellipse = PerpendicularEllipse::of(&model)?;
    let has_adb_fit = |p: &ParticipantId| {
        rows.iter()
            .any(|r| r.participant == *p && r.adb_used && r.condition == Condition::Own)
    };
    let mut conditions = Vec::new();
    let mut clamped = 0;
    let mut participants = 0;
    for row in rows.iter().filter(|r| r.condition == Condition::Own) {
        if row.adb_used != has_adb_fit(&row.participant) {
            continue;
        }
        watch.check()?;
        participants += 1;
        let mut place =
            |condition, embedding: Embedding, moved_points, angle_rad| -> Result<(), StudyError> {
                conditions.push(ConditionRow {
                    participant: row.participant.clone(),
                    condition,
                    adb_hat: axis.aggression_hat(&embedding)?,
                    moved_points,
                    angle_rad,
                    beyond_training: is_beyond(&model, &embedding)?,
                    embedding,
                });
                Ok(())
            };
        let up = shift(&axis, &row.embedding, options.points)?;
        let down = shift(&axis, &row.embedding, -options.points)?;
        clamped += usize::from(up.clamped) + usize::from(down.clamped);
        let mut rng = Pcg64Mcg::seed_from_u64(stream_seed(
            options.seed,
            &[row.participant.as_str(), "perpendicular"],
        ));
        let across = ellipse.sample(&row.embedding, &mut rng)?;
        place(Condition::Mimic, row.embedding.clone(), 0.0, None)?;
        place(
            Condition::Aggressive,
            up.embedding,
            up.effective_points,
            None,
        )?;
        place(
            Condition::Cautious,
            down.embedding,
            down.effective_points,
            None,
        )?;
        place(
            Condition::Perpendicular,
            across.embedding,
            0.0,
            Some(across.angle_rad),
        )?;
    }
    if participants == 0 {
        return Err(StudyError::file(
            &options.embeddings,
            "holds no own drive to steer from",
        ));
    }
    write_conditions(&options.out, &conditions)?;
    let warnings = (clamped > 0).then(|| {
        format!(
            "{clamped} of {} shifts were cut short by the ends of the ADB scale",
            2 * participants
        )
    });
    let summary = vec![format!(
        "{participants} participants × 4 conditions: {}",
        options.out.display()
    )];
    Ok(Outcome {
        value: Steered {
            participants,
            clamped,
            conditions,
        },
        summary,
        warnings: warnings.into_iter().collect(),
    })
}

fn is_beyond(model: &Model, embedding: &Embedding) -> Result<bool, StudyError> {
    Ok(
        share_outside_training(model, std::slice::from_ref(embedding))?
            .is_some_and(|share| share > 0.5),
    )
}
