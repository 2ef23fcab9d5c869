//! A score on the scale of aggressive driving.

use crate::error::DomainError;
use serde::{Deserialize, Serialize};

/// A score on the Aggressive Driving Behavior scale: 11 to 55 points.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(try_from = "f64", into = "f64")]
pub struct AdbScore(f64);

impl AdbScore {
    /// Lowest score, in points.
    pub const MIN: f64 = 11.0;
    /// Highest score, in points.
    pub const MAX: f64 = 55.0;

    /// Takes 11 to 55 points.
    ///
    /// # Errors
    /// [`DomainError::OutOfRange`] for anything else.
    pub fn new(points: f64) -> Result<Self, DomainError> {
        if (Self::MIN..=Self::MAX).contains(&points) {
            Ok(Self(points))
        } else {
            Err(DomainError::OutOfRange {
                name: "ADB score",
                found: points,
                expected: "11 to 55 points",
            })
        }
    }

    /// Whether the scale has such a score, in points; one that only rounding puts outside counts as its end.
    pub fn has(points: f64) -> bool {
        const ROUNDING: f64 = 1e-9 * (AdbScore::MAX - AdbScore::MIN);
        (Self::MIN - ROUNDING..=Self::MAX + ROUNDING).contains(&points)
    }

    /// The score in points of the scale, from [`Self::MIN`] to [`Self::MAX`].
    pub fn points(self) -> f64 {
        self.0
    }
}

impl TryFrom<f64> for AdbScore {
    type Error = DomainError;
    fn try_from(points: f64) -> Result<Self, DomainError> {
        Self::new(points)
    }
}

impl From<AdbScore> for f64 {
    fn from(score: AdbScore) -> Self {
        score.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adb_scores_end_at_11_and_55() {
        assert!(AdbScore::new(10.9).is_err());
        assert!(AdbScore::new(f64::NAN).is_err());
        assert!(AdbScore::new(55.0).is_ok());
        assert!(AdbScore::has(55.0 + 1e-12) && AdbScore::has(11.0));
        for none in [55.1, 10.9, f64::NAN, f64::INFINITY] {
            assert!(!AdbScore::has(none), "{none}");
        }
    }
}
