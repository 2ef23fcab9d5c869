//! What was answered, and what it scores.

use super::moment::Moment;
use crate::{ids::ParticipantId, occasion::Ride};
use serde::{Deserialize, Serialize};

/// One answer to one item.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    /// Who answered.
    pub participant: ParticipantId,
    /// When.
    pub moment: Moment,
    /// Code name of the scale.
    pub scale: String,
    /// Item number, from 1.
    pub item: u32,
    /// The answer; `None` where it was left out.
    pub answer: Option<i32>,
}

/// One answer to a probe, a scale of one item.
#[derive(Debug, Clone, PartialEq)]
pub struct ProbeAnswer {
    /// Who answered.
    pub participant: ParticipantId,
    /// During which drive.
    pub ride: Ride,
    /// Code name of the scale.
    pub scale: String,
    /// When it was asked, in s since the drive began.
    pub at_s: f64,
    /// The answer; `None` where it did not come in time.
    pub answer: Option<i32>,
}

/// The score of one subscale for one participant at one moment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// Who answered.
    pub participant: ParticipantId,
    /// When.
    pub moment: Moment,
    /// Code name of the scale.
    pub scale: String,
    /// Code name of the subscale.
    pub subscale: String,
    /// The score; `None` where too few items were answered.
    pub value: Option<f64>,
    /// Items answered.
    pub answered: u32,
    /// Items of the subscale.
    pub items: u32,
}
