//! One measured value of one drive.

use crate::ids::DriveId;
use serde::{Deserialize, Serialize};

/// One measured value of one drive, in the unit that its measure declares.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    /// The drive.
    pub drive: DriveId,
    /// Code name of the measure, such as `mean_headway_time_s`: the unit is its suffix.
    pub measure: String,
    /// The value; `None` where the drive has none (a drive that never merges back).
    pub value: Option<f64>,
}
