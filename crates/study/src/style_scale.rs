//! The score that the dial turns, on the scale on which the networks learn it.
//!
//! The style head is learned on the range of the ADB score, 11 to 55 points; another score is stretched onto it on the way in, and
//! back on the way out, so that every file has the points of the study's own score.

use crate::{
    design::DesignFile,
    error::StudyError,
    once::told_once,
    run_folder::{read_scales, score_range},
};
use maveric_domain::{
    AdbScore, BeyondWhy, Drive, DriveId, EmbeddingRow, ParticipantId, Scale, Score,
    design::DesignError,
};
use maveric_model::StyleHead;
use serde::Serialize;
use std::path::Path;

/// A drive that a model reads as a score that its scale does not have.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OffTheScale {
    /// Its id.
    pub drive: DriveId,
    /// Whose it is.
    pub participant: ParticipantId,
    /// Whether the person's own score was read too.
    pub adb_used: bool,
    /// What the model read, in points.
    pub reading: f64,
}

/// Lowest and highest score of a style.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StyleScale {
    low: f64,
    high: f64,
}

impl StyleScale {
    /// 11 to 55 points.
    pub const ADB: Self = Self {
        low: AdbScore::MIN,
        high: AdbScore::MAX,
    };

    /// The scale of scores between two numbers.
    ///
    /// # Errors
    /// [`StudyError::NotPossible`] unless both are finite and the second is the higher one.
    pub fn new(low: f64, high: f64) -> Result<Self, StudyError> {
        if low.is_finite() && high.is_finite() && low < high {
            return Ok(Self { low, high });
        }
        let problem = format!(
            "scores from {low} to {high}, expected two finite numbers, the lower one first"
        );
        Err(StudyError::not_possible(problem))
    }

    /// The score of the networks for one of this scale.
    ///
    /// # Errors
    /// [`StudyError::NotPossible`] for a score outside the scale.
    pub fn score(self, points: f64) -> Result<AdbScore, StudyError> {
        if !(self.low..=self.high).contains(&points) {
            let problem = format!(
                "a score of {points}, expected {} to {}",
                self.low, self.high
            );
            let help = "give the range of the questionnaire, or check the score";
            return Err(StudyError::not_possible(problem).with_help(help));
        }
        let inward = self.inward(points).clamp(AdbScore::MIN, AdbScore::MAX);
        Ok(AdbScore::new(inward)?)
    }

    /// The scale of a design's style; the ADB score's where it has none.
    ///
    /// # Errors
    /// [`StudyError`] where neither the design nor a questionnaire says the range.
    pub(crate) fn of(study: &DesignFile) -> Result<Self, StudyError> {
        let Some(style) = study.design.style() else {
            return Ok(Self::ADB);
        };
        if let Some([low, high]) = style.range {
            return Ok(Self { low, high });
        }
        let scales = read_scales(&study.resolve(&study.design.files().scales))?;
        if let Some((low, high)) = score_range(&scales, &style.score) {
            return Ok(Self { low, high });
        }
        let ids: Vec<String> = scales.iter().flat_map(Scale::score_names).collect();
        let name = style.score.to_string();
        let error = DesignError::word("style.score", &name, ids.iter().map(String::as_str));
        Err(study.wrong(error.to_string(), error.suggestion()))
    }

    /// Points of the networks for one point of this score.
    pub fn stretch(self) -> f64 {
        if self == Self::ADB {
            return 1.0;
        }
        (AdbScore::MAX - AdbScore::MIN) / (self.high - self.low)
    }

    fn inward(self, points: f64) -> f64 {
        if self == Self::ADB {
            return points;
        }
        AdbScore::MIN + (points - self.low) * self.stretch()
    }

    /// A score of the networks as a score of this scale.
    pub fn outward(self, points: f64) -> f64 {
        if self == Self::ADB {
            return points;
        }
        self.low + (points - AdbScore::MIN) / self.stretch()
    }

    /// What was learned of stretched scores, in points of the study's own.
    pub(crate) fn outward_head(self, head: StyleHead) -> StyleHead {
        let stretch = self.stretch();
        let each = |values: Vec<f64>, by: f64| values.into_iter().map(|v| v / by).collect();
        StyleHead {
            gradient: each(head.gradient, stretch),
            offset: self.outward(head.offset),
            covariance: each(head.covariance, stretch * stretch),
            reading_sd: head.reading_sd / stretch,
            cross_fitted_rmse: head.cross_fitted_rmse.map(|e| e / stretch),
            ..head
        }
    }

    /// Embeddings that were fitted to stretched scores, in points of the study's own. What a model reads as a score that the scale does
    /// not have is no score: it is taken out, and told.
    pub(crate) fn outward_rows(self, rows: &mut [EmbeddingRow]) -> Vec<OffTheScale> {
        let mut off = Vec::new();
        for row in rows {
            row.adb = row.adb.map(|x| self.outward(x));
            let reading = row.adb_hat;
            (row.adb_hat, row.beyond_why) = self.score_of(reading, row.beyond_why.take());
            if let (None, Some(reading)) = (row.adb_hat, reading) {
                off.push(OffTheScale {
                    drive: row.drive.clone(),
                    participant: row.participant.clone(),
                    adb_used: row.adb_used,
                    reading: self.outward(reading),
                });
            }
        }
        off
    }

    /// [`BeyondWhy::of_reading`] of what a model read in its own points, the score as one of this scale.
    pub fn score_of(
        self,
        reading: Option<f64>,
        by_support: Option<BeyondWhy>,
    ) -> (Option<f64>, Option<BeyondWhy>) {
        let (score, why) = BeyondWhy::of_reading(reading, by_support);
        (score.map(|points| self.outward(points)), why)
    }

    /// A sentence for each drive that reads as no score of the scale.
    pub(crate) fn warnings(self, off: &[OffTheScale]) -> Vec<String> {
        let why = format!(
            "reads as a score outside {} to {}, so it has none: the model has met nobody who drives like this, and where it puts this driver says little",
            self.low, self.high
        );
        told_once(
            "drive",
            off.iter().map(|o| (o.drive.to_string(), why.clone())),
        )
    }
}

/// Points of a model for one point of the study's style, for whoever turns a model's dial in the study's own points.
///
/// # Errors
/// [`StudyError`] where neither the design nor a questionnaire says the range of the style.
pub fn dial_stretch(study: &DesignFile) -> Result<f64, StudyError> {
    Ok(StyleScale::of(study)?.stretch())
}

/// The scores from which the networks learn: the design's style, under the name and on the range of the ADB score. Without a
/// design they are as they are; with one that has no style there are none. Gives the scale to come back by.
///
/// # Errors
/// [`StudyError`] naming participant and score for one outside the range of the style.
pub(crate) fn style_scores(
    mut scores: Vec<Score>,
    design: Option<&Path>,
) -> Result<(Vec<Score>, StyleScale), StudyError> {
    let Some(study) = DesignFile::here(design)? else {
        return Ok((scores, StyleScale::ADB));
    };
    let Some(style) = study.design.style() else {
        return Ok((Vec::new(), StyleScale::ADB));
    };
    let scale = StyleScale::of(&study)?;
    let is_named = |s: &Score, name: (&str, &str)| s.scale == name.0 && s.subscale == name.1;
    let style_name = (style.score.scale.as_str(), style.score.subscale.as_str());
    scores.retain(|s| is_named(s, style_name) || !is_named(s, ("adb", "total")));
    for score in scores.iter_mut().filter(|s| is_named(s, style_name)) {
        if let Some(value) = score.value {
            if !(scale.low..=scale.high).contains(&value) {
                return Err(study.wrong(
                    format!(
                        "`style.range`: participant {} ({}) scores {value} on `{}`, expected {} to {}",
                        score.participant, score.moment, style.score, scale.low, scale.high
                    ),
                    Some("widen `range` to that of the questionnaire, or check the answers".to_owned()),
                ));
            }
            score.value = Some(scale.inward(value).clamp(AdbScore::MIN, AdbScore::MAX));
        }
        "adb".clone_into(&mut score.scale);
        "total".clone_into(&mut score.subscale);
    }
    Ok((scores, scale))
}

/// The score that a drive's role has by its instruction, on the scale of the networks.
///
/// # Errors
/// [`StudyError::NotPossible`] for one outside the scale of the style.
pub(crate) fn instructed(
    drive: &Drive,
    study: Option<&DesignFile>,
    scale: StyleScale,
) -> Result<Option<AdbScore>, StudyError> {
    let role = study.and_then(|s| s.design.role(drive.meta().condition));
    let points = role.and_then(|role| role.score);
    points.map(|points| scale.score(points)).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_that_is_no_score_of_the_scale_is_taken_out_and_told_and_one_at_its_end_stays() {
        let risky = StyleScale {
            low: 1.0,
            high: 6.0,
        };
        let row = |drive: &str, points: Option<f64>| EmbeddingRow {
            adb_hat: points.map(|points| risky.inward(points)),
            ..EmbeddingRow::new(
                DriveId::new(drive).unwrap(),
                ParticipantId::new("p").unwrap(),
                "own".parse().unwrap(),
                maveric_domain::Embedding::new(vec![0.0]).unwrap(),
            )
        };
        let points = [0.9, 1.0, 3.5, 6.0, 6.1].map(Some);
        let mut rows: Vec<EmbeddingRow> = ["a", "b", "c", "d", "e", "f"]
            .into_iter()
            .zip(points.into_iter().chain([None]))
            .map(|(drive, points)| row(drive, points))
            .collect();
        let off = risky.outward_rows(&mut rows);
        let kept: Vec<bool> = rows.iter().map(|r| r.adb_hat.is_some()).collect();
        assert_eq!(kept, [false, true, true, true, false, false]);
        let found: Vec<&str> = off.iter().map(|o| o.drive.as_str()).collect();
        assert_eq!(found, ["a", "e"]);
        assert!((off[1].reading - 6.1).abs() < 1e-9);
        let said = risky.warnings(&off);
        assert!(
            said[0].starts_with("2 drives (a, e): reads as a score outside 1 to 6"),
            "{said:?}"
        );
        assert!(risky.warnings(&[]).is_empty());
    }

    #[test]
    fn another_score_is_stretched_onto_the_range_of_the_networks_and_back() {
        let risky = StyleScale {
            low: 1.0,
            high: 6.0,
        };
        assert!(
            (risky.inward(1.0) - 11.0).abs() < 1e-12 && (risky.inward(6.0) - 55.0).abs() < 1e-12
        );
        assert!((risky.outward(risky.inward(3.7)) - 3.7).abs() < 1e-12);
        assert!((risky.stretch() - 8.8).abs() < 1e-12);
        assert!((risky.score(6.0).unwrap().points() - 55.0).abs() < 1e-12);
        let head = StyleHead {
            gradient: vec![8.8],
            offset: 33.0,
            covariance: vec![77.44],
            reading_sd: 4.4,
            cross_fitted_rmse: Some(7.1),
            cross_fitted_r: Some(0.5),
            people: 4,
            drives: 4,
        };
        let ours = risky.outward_head(head.clone());
        // Off by 7.1 points of 44 is off by 0.8 of 5.
        assert!((ours.cross_fitted_rmse.unwrap() - 7.1 / 8.8).abs() < 1e-12);
        let others = [
            ours.gradient[0],
            ours.offset,
            ours.covariance[0],
            ours.reading_sd,
        ];
        let wanted = [1.0, 3.5, 1.0, 0.5];
        assert!(
            others
                .iter()
                .zip(wanted)
                .all(|(a, b)| (a - b).abs() < 1e-12)
        );
        assert_eq!(StyleScale::ADB.outward_head(head.clone()), head);
        let outside = risky.score(6.5).unwrap_err().to_string();
        assert!(
            outside.contains("6.5") && outside.contains("1 to 6"),
            "{outside}"
        );
        assert!(StyleScale::new(6.0, 1.0).is_err() && StyleScale::new(0.0, f64::NAN).is_err());
        // The ADB score itself is not touched, to the last digit.
        assert!(StyleScale::ADB.inward(30.1).to_bits() == 30.1f64.to_bits());
    }
}
