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

impl Side {
    /// 1 for the left, -1 for the right: what turns a distance to this side into one to the left.
    pub(crate) fn to_left(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}
