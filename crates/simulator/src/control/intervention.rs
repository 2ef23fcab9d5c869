//! What the safety layer did instead of what it was asked.

use maveric_domain::VehicleId;
use serde::{Deserialize, Serialize};

/// One moment at which the safety layer took over.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Intervention {
    /// Time since the start of the drive at which it began, in s.
    pub time_s: f64,
    /// The vehicle it was for, where that is one.
    pub vehicle: Option<VehicleId>,
    /// What was asked and what was done.
    #[serde(flatten)]
    pub kind: InterventionKind,
}

/// What was asked and what was done.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum InterventionKind {
    /// The car braked harder than the controllers asked; once for each time it took over.
    Braked {
        /// Acceleration that the controllers asked for, in m/s².
        asked_mps2: f64,
        /// Acceleration that the car was given in the first moment, in m/s².
        given_mps2: f64,
    },
    /// A lane change was due and had to wait for safe gaps.
    HeldChange {
        /// Lane asked for.
        asked_lane: u8,
        /// Lane that the car stays in, 0 the right one.
        kept_lane: u8,
    },
    /// A lane change was undone because a gap had become unsafe.
    GaveUpChange {
        /// Lane asked for.
        asked_lane: u8,
        /// Lane gone back to.
        kept_lane: u8,
    },
}
