//! A style from what was driven.

use crate::error::SeatPageError;
use maveric_domain::{BeyondWhy, Drive, DriveMeta, DrivenBy, Recording};
use maveric_model::{Model, Support, personalize};
use serde::{Deserialize, Serialize};

/// A person's style, as far as one drive shows it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fit {
    /// The mean of the style, shape `(d,)`.
    pub embedding: Vec<f64>,
    /// Its covariance, shape `(d, d)`, row by row; none where too little was driven.
    pub covariance: Option<Vec<f64>>,
    /// The score that is read from it, in its scale's points; none where the model reads none, or one that the scale does not have.
    pub score: Option<f64>,
    /// Events or rows that it was learned from; 0: nothing was shown, and this is the average driver.
    pub readings: usize,
    /// Why the drive is beyond what the model has learned from, as in a table of embeddings; none where it is not, or where the
    /// model cannot say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beyond: Option<BeyondWhy>,
}

/// Learns a style from `recording`, the weights of `model` as they are.
///
/// A drive that shows nothing of what the model reads gives the average driver, with no reading.
///
/// # Errors
/// [`SeatPageError::Model`] for a drive that is too short for the model's windows, [`SeatPageError::Domain`] for one that is no drive.
pub fn fit(
    model: &Model,
    recording: &Recording,
    driven_by: DrivenBy,
) -> Result<Fit, SeatPageError> {
    let meta = DriveMeta::named("seat", "seat", "own", driven_by)?;
    let drive = Drive::from_recording(meta, recording)?;
    let personalized = personalize(model, &drive, None)?;
    let support = personalized.support.as_ref().and_then(Support::beyond);
    let reading = personalized.aggression_hat;
    let (score, beyond) = BeyondWhy::of_reading(model.score_range(), reading, support);
    Ok(Fit {
        embedding: personalized.embedding.coordinates().to_vec(),
        covariance: personalized.covariance,
        score,
        readings: personalized.readings,
        beyond,
    })
}
