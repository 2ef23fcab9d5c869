//! Sides of the road.

use serde::{Deserialize, Serialize};

/// A side of the road, seen along x.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// The left (fast) side.
    Left,
    /// The right (slow) side.
    Right,
}
