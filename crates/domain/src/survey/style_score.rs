//! A score that a style is read as, on its scale.

use crate::error::DomainError;
use serde::{Deserialize, Serialize};
use std::fmt;

/// The ends of a score's scale, in its points.
///
/// As data: the lowest and the highest score.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "[f64; 2]", into = "[f64; 2]")]
pub struct ScoreRange {
    low: f64,
    high: f64,
}

impl ScoreRange {
    /// The Aggressive Driving Behavior scale: 11 to 55 points.
    pub const ADB: Self = Self { low: 11.0, high: 55.0 };

    /// Scores between two numbers.
    ///
    /// # Errors
    /// [`DomainError::NoRange`] unless both are finite and the second is the higher one.
    pub fn new(low: f64, high: f64) -> Result<Self, DomainError> {
        if low.is_finite() && high.is_finite() && low < high {
            return Ok(Self { low, high });
        }
        Err(DomainError::NoRange { low, high })
    }

    /// Points from one end to the other.
    pub fn width(self) -> f64 {
        self.high - self.low
    }

    /// The score of so many points.
    ///
    /// # Errors
    /// [`DomainError::NotOnScale`] for one outside the range.
    pub fn score(self, points: f64) -> Result<StyleScore, DomainError> {
        let (found, range) = (points, self);
        let Self { low, high } = self;
        if (low..=high).contains(&points) {
            return Ok(StyleScore { points, range });
        }
        Err(DomainError::NotOnScale { found, low, high })
    }

    /// A step of the dial where nothing says how far one is, with the outermost setting `steps` of them from the middle: a third of the
    /// range, to two digits (15 points of the ADB's 44), or what keeps that setting within the length of the scale.
    pub fn step(self, steps: f64) -> f64 {
        let digits = |points: f64, to_whole: fn(f64) -> f64| {
            let digit = 10f64.powi(libm::log10(points).floor() as i32 - 1);
            to_whole(points / digit + 1e-9) * digit
        };
        let mut points = digits(self.width() / 3.0, f64::round);
        if points * steps > self.width() {
            points = digits(self.width() / steps, f64::floor);
        }
        // No tail of binary digits in a file.
        (points * 1e6).round() / 1e6
    }

    /// Decimals of its points: as many as make the last digit no coarser on this scale than a whole point is on the ADB's.
    pub fn decimals(self) -> usize {
        let narrower = Self::ADB.width() / self.width();
        libm::log10(narrower).ceil().max(0.0) as usize
    }

    /// So many points of this scale as points of another, end on end.
    pub fn onto(self, other: Self, points: f64) -> f64 {
        other.low + (points - self.low) * (other.width() / self.width())
    }

    /// Whether the scale has such a score, in points; one that only rounding puts outside counts as its end.
    pub fn has(self, points: f64) -> bool {
        let rounding = 1e-9 * self.width();
        (self.low - rounding..=self.high + rounding).contains(&points)
    }
}

impl TryFrom<[f64; 2]> for ScoreRange {
    type Error = DomainError;
    fn try_from([low, high]: [f64; 2]) -> Result<Self, DomainError> {
        Self::new(low, high)
    }
}

impl From<ScoreRange> for [f64; 2] {
    fn from(range: ScoreRange) -> Self {
        [range.low, range.high]
    }
}

impl fmt::Display for ScoreRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} to {}", self.low, self.high)
    }
}

/// A score on a scale that has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StyleScore {
    points: f64,
    range: ScoreRange,
}

impl StyleScore {
    /// The score, in points of its scale.
    pub fn points(self) -> f64 {
        self.points
    }

    /// The ends of its scale.
    pub fn range(self) -> ScoreRange {
        self.range
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adb_scores_end_at_11_and_55() {
        let adb = ScoreRange::ADB;
        assert!(adb.score(10.9).is_err());
        assert!(adb.score(f64::NAN).is_err());
        assert!(adb.score(55.0).is_ok());
        assert!(adb.has(55.0 + 1e-12) && adb.has(11.0));
        for none in [55.1, 10.9, f64::NAN, f64::INFINITY] {
            assert!(!adb.has(none), "{none}");
        }
    }

    #[test]
    fn a_step_is_a_third_of_the_range_and_keeps_the_outermost_setting_on_its_length() {
        let step = |low, high, steps| ScoreRange::new(low, high).unwrap().step(steps);
        assert_eq!(ScoreRange::ADB.step(1.0).to_bits(), 15.0_f64.to_bits());
        assert_eq!(step(1.0, 6.0, 1.0).to_bits(), 1.7_f64.to_bits());
        assert_eq!(step(0.0, 300.0, 3.0).to_bits(), 100.0_f64.to_bits());
        // 4 × 15 points are more than the 44 there are.
        assert_eq!(ScoreRange::ADB.step(4.0).to_bits(), 11.0_f64.to_bits());
    }

    #[test]
    fn points_of_a_narrow_scale_have_decimals_and_those_of_the_adb_or_a_wider_one_have_none() {
        let decimals = |low, high| ScoreRange::new(low, high).unwrap().decimals();
        assert_eq!(ScoreRange::ADB.decimals(), 0);
        assert_eq!(decimals(0.0, 300.0), 0);
        assert_eq!(decimals(1.0, 6.0), 1);
        assert_eq!(decimals(0.0, 1.0), 2);
    }

    #[test]
    fn a_score_outside_its_scale_and_ends_that_are_none_are_refused() {
        let risky = ScoreRange::new(1.0, 6.0).unwrap();
        let score = risky.score(6.0).unwrap();
        assert_eq!((score.points().to_bits(), score.range()), (6.0_f64.to_bits(), risky));
        assert_eq!(risky.score(6.5).unwrap_err().to_string(), "a score of 6.5, expected 1 to 6");
        assert!(ScoreRange::new(6.0, 1.0).is_err() && ScoreRange::new(0.0, f64::NAN).is_err());
        assert!(serde_json::from_str::<ScoreRange>("[6.0, 1.0]").is_err());
        let text = serde_json::to_string(&risky).unwrap();
        assert_eq!(serde_json::from_str::<ScoreRange>(&text).unwrap(), risky);
    }
}
