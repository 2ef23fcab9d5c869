//! How far out is too far: embeddings beyond every training driver.

use crate::{error::ModelError, model::Model};
use maveric_domain::Embedding;

/// Share of `embeddings` that lie further from the mean of the training embeddings than any of those; `None` of
/// nothing.
///
/// # Errors
/// [`ModelError::EmbeddingSize`] if one is not of the model's size.
///
/// # Source
/// Calibration section 6: the networks are extrapolated there, so the share is reported.
pub fn share_outside_training(
    model: &Model,
    embeddings: &[Embedding],
) -> Result<Option<f64>, ModelError> {
    let radius = model.training().iter().map(|t| model.distance_from_mean(&t.embedding));
    let radius = radius.fold(0.0, f64::max);
    let mut outside = 0;
    for embedding in embeddings {
        model.check(embedding)?;
        outside += usize::from(model.distance_from_mean(embedding) > radius);
    }
    let n = embeddings.len();
    Ok((n > 0).then(|| outside as f64 / n as f64))
}
