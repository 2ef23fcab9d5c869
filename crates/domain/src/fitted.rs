//! Embeddings that were fitted to drives.

use crate::{
    condition::ConditionId,
    embedding::Embedding,
    ids::{DriveId, ParticipantId},
    occasion::{first, is_first},
    survey::ScoreRange,
};
use serde::{Deserialize, Serialize};
use std::{fmt, num::NonZeroU32, str::FromStr};

/// Why a drive is beyond what a model has learned from; each names the habit that stands furthest from what the others let expect.
///
/// As text: `scale`, `style:HABIT` or `habits:HABIT`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum BeyondWhy {
    /// It reads as a score that the scale does not have.
    Scale,
    /// An unusual style: further from the mean person than those learned from, along what a style can say.
    Style {
        /// Code name of the habit.
        habit: String,
    },
    /// Habits that no style explains together.
    Habits {
        /// Code name of the habit.
        habit: String,
    },
}

impl BeyondWhy {
    /// The score that a drive has where a model read this one of it, in points of its scale, and why the drive is beyond: a reading
    /// that the scale does not have is no score, and is why; otherwise it is what the model's support says.
    pub fn of_reading(
        range: ScoreRange,
        reading: Option<f64>,
        by_support: Option<Self>,
    ) -> (Option<f64>, Option<Self>) {
        match reading {
            Some(points) if !range.has(points) => (None, Some(Self::Scale)),
            _ => (reading, by_support),
        }
    }
}

impl fmt::Display for BeyondWhy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scale => f.write_str("scale"),
            Self::Style { habit } => write!(f, "style:{habit}"),
            Self::Habits { habit } => write!(f, "habits:{habit}"),
        }
    }
}

impl FromStr for BeyondWhy {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let habit = |habit: &str| habit.to_owned();
        match text.split_once(':') {
            None if text == "scale" => Ok(Self::Scale),
            Some(("style", h)) => Ok(Self::Style { habit: habit(h) }),
            Some(("habits", h)) => Ok(Self::Habits { habit: habit(h) }),
            _ => Err(format!(
                "`{text}`, expected `scale`, `style:` or `habits:` with the name of a habit"
            )),
        }
    }
}

crate::as_text::as_text!(BeyondWhy);

/// One fitted embedding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EmbeddingRow {
    /// The drive it was fitted to.
    pub drive: DriveId,
    /// Its driver.
    pub participant: ParticipantId,
    /// The style the drive shows.
    pub condition: ConditionId,
    /// In which session it was driven.
    #[serde(default = "first", skip_serializing_if = "is_first")]
    pub session: NonZeroU32,
    /// Which drive of the condition within the session it was.
    #[serde(default = "first", skip_serializing_if = "is_first")]
    pub trial: NonZeroU32,
    /// Whether the score of the style (the ADB's, or the study's own) took part in the fit.
    pub adb_used: bool,
    /// Score of the style, in points, where there is one.
    pub adb: Option<f64>,
    /// Ŝ(w), in points; none for a model that saw no scores.
    pub adb_hat: Option<f64>,
    /// Position on the aggression line; none for a model that saw no scores.
    pub line_position: Option<f64>,
    /// Events or rows that it was solved from; none for training drives.
    pub readings: Option<usize>,
    /// Its covariance, shape `(d, d)`, row by row; none for training drives, and where a drive is too short to tell.
    pub covariance: Option<Vec<f64>>,
    /// SD of `line_position`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line_position_se: Option<f64>,
    /// Probability of a drive at least as surprising by one of the people learned from; none where the model cannot say.
    pub support_p: Option<f64>,
    /// Why the drive is beyond what was learned from; none where it is not, or where nobody can say.
    pub beyond_why: Option<BeyondWhy>,
    /// Whether what was posted lies outside what was posted for those learned from; none where nobody can say.
    pub posted_unseen: Option<bool>,
    /// Where the drive lies in the model's style space.
    pub embedding: Embedding,
}

impl EmbeddingRow {
    /// A style of a person's first drive in a condition, of which nothing else is known.
    pub fn new(
        drive: DriveId,
        participant: ParticipantId,
        condition: ConditionId,
        embedding: Embedding,
    ) -> Self {
        Self {
            drive,
            participant,
            condition,
            session: first(),
            trial: first(),
            adb_used: false,
            adb: None,
            adb_hat: None,
            line_position: None,
            readings: None,
            covariance: None,
            line_position_se: None,
            support_p: None,
            beyond_why: None,
            posted_unseen: None,
            embedding,
        }
    }

    /// Whether the drive is beyond what the model has learned from; `None` where the model cannot say.
    pub fn beyond(&self) -> Option<bool> {
        (self.beyond_why.is_some() || self.support_p.is_some()).then(|| self.beyond_why.is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_that_the_scale_does_not_have_is_no_score_and_why_a_drive_is_beyond() {
        let pass = || Some(BeyondWhy::Style { habit: "pass".to_owned() });
        let of_reading = |reading, why| BeyondWhy::of_reading(ScoreRange::ADB, reading, why);
        let scale = (None, Some(BeyondWhy::Scale));
        assert_eq!(of_reading(Some(-1.3), None), scale);
        assert_eq!(of_reading(Some(55.1), pass()), scale);
        assert_eq!(of_reading(Some(30.0), pass()), (Some(30.0), pass()));
        assert_eq!(of_reading(None, None), (None, None));
        let risky = ScoreRange::new(1.0, 6.0).unwrap();
        let found = BeyondWhy::of_reading(risky, Some(6.1), None);
        assert_eq!(found, scale);
    }

    #[test]
    fn why_a_drive_is_beyond_survives_its_text() {
        let habit = || "pass".to_owned();
        for why in [
            BeyondWhy::Scale,
            BeyondWhy::Style { habit: habit() },
            BeyondWhy::Habits { habit: habit() },
        ] {
            assert_eq!(why.to_string().parse(), Ok(why));
        }
        for bad in ["", "style", "scale:pass", "speed:pass"] {
            assert!(bad.parse::<BeyondWhy>().is_err(), "{bad}");
        }
    }
}
