//! Where in style space the car should drive.

use crate::{
    condition::ConditionId,
    embedding::Embedding,
    error::DomainError,
    fitted::BeyondWhy,
    ids::{DriveId, ParticipantId},
    occasion::{Occasion, Ride},
};
use serde::{Deserialize, Serialize};

/// One participant in one condition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ConditionRow {
    /// Whose style the condition starts from.
    pub participant: ParticipantId,
    /// The label of its drives.
    pub condition: ConditionId,
    /// Ŝ at the embedding, in points; `None` where the model has no style head.
    pub adb_hat: Option<f64>,
    /// How far Ŝ moved from the participant's own, in points, after clamping; `None` where the model has no style head.
    pub moved_points: Option<f64>,
    /// SD of that, as far as the people learned from determine the direction; none where that is not known.
    pub moved_points_sd: Option<f64>,
    /// Whether an end of the scale cut the move short.
    pub clamped: bool,
    /// Angle on the ellipse across the dial, in rad; only there.
    pub angle_rad: Option<f64>,
    /// Whose style it is where somebody else's is lent. In a table its fields are columns of their own.
    #[serde(skip_deserializing)]
    pub lent: Option<Lent>,
    /// Whether the embedding lies further out than any training driver's.
    pub beyond_training: bool,
    /// Why the drive that the person's style was learned of is beyond what the model has met; none where it is not or nobody can say, and
    /// where the car has another style than the person's.
    pub beyond_why: Option<BeyondWhy>,
    /// What it is one point of; none for the conditions of a study. In a table its fields are columns of their own.
    #[serde(skip_deserializing)]
    pub sweep: Option<SweepPoint>,
    /// The style that is driven, in the model's style space.
    pub embedding: Embedding,
}

/// One point of a sweep, or one move along an attribute.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepPoint {
    /// Name of the simulated drive: several points of one participant may be the same condition.
    pub drive: DriveId,
    /// What was moved along; `aggression` is the model's own head.
    pub attribute: String,
    /// How far it should have moved, in its own points.
    pub requested_points: f64,
    /// How far it moved within its range, in its own points.
    pub attribute_points: f64,
}

/// A style that somebody else lends, moved along the dial to the person's own score.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Lent {
    /// The drive that the style was learned of.
    pub donor: DriveId,
    /// How far it was moved, in points.
    pub donor_shift_points: f64,
    /// How far donor and person lie apart across the dial, in standard deviations of the people learned from.
    pub donor_distance_sd: f64,
    /// Whether shift and distance are within what was asked for; the nearest was taken where nobody's are.
    pub donor_within_reach: bool,
}

impl ConditionRow {
    /// A style in a condition, of which nothing else is known.
    pub fn new(participant: ParticipantId, condition: ConditionId, embedding: Embedding) -> Self {
        Self {
            participant,
            condition,
            adb_hat: None,
            moved_points: None,
            moved_points_sd: None,
            clamped: false,
            angle_rad: None,
            lent: None,
            beyond_training: false,
            beyond_why: None,
            sweep: None,
            embedding,
        }
    }

    /// Name of the first drive simulated in this condition.
    ///
    /// # Errors
    /// [`DomainError::BadId`] if participant and condition make no identifier.
    pub fn drive(&self) -> Result<DriveId, DomainError> {
        self.drive_on(Occasion::FIRST)
    }

    /// Name of the drive simulated in this condition in a session and trial; a point of a sweep is driven once.
    ///
    /// # Errors
    /// As [`ConditionRow::drive`].
    pub fn drive_on(&self, occasion: Occasion) -> Result<DriveId, DomainError> {
        let condition = self.condition;
        match &self.sweep {
            Some(point) => Ok(point.drive.clone()),
            None => DriveId::in_condition(&self.participant, Ride { condition, occasion }),
        }
    }
}
