//! The score that the dial turns: the ends of its scale, and what people scored on it.

use crate::{
    design::DesignFile,
    error::StudyError,
    run_folder::{read_scales, score_range},
};
use maveric_domain::{
    ConditionId, Drive, Moment, Scale, Score, ScoreRange, StyleScore, design::DesignError,
};

/// The ends of the scale of a study's style; of the ADB score's where it has none.
///
/// # Errors
/// [`StudyError`] where neither the design nor a questionnaire says them.
pub fn style_range(study: &DesignFile) -> Result<ScoreRange, StudyError> {
    let Some(style) = study.design.style() else {
        return Ok(ScoreRange::ADB);
    };
    if let Some(ends) = style.range {
        return Ok(ScoreRange::try_from(ends)?);
    }
    let scales = read_scales(&study.resolve(&study.design.files().scales))?;
    if let Some((low, high)) = score_range(&scales, &style.score) {
        return Ok(ScoreRange::new(low, high)?);
    }
    let ids: Vec<String> = scales.iter().flat_map(Scale::score_names).collect();
    let name = style.score.to_string();
    let error = DesignError::word("style.score", &name, ids.iter().map(String::as_str));
    Err(study.wrong(error.to_string(), error.suggestion()))
}

/// What people scored on a study's style.
#[derive(Debug)]
pub(crate) struct StyleScores {
    /// The ends of its scale.
    pub(crate) range: ScoreRange,
    /// Of the style alone.
    pub(crate) rows: Vec<Score>,
}

impl StyleScores {
    /// The rows of a table that are of a study's style: none where it has no style. Without a study the ADB's total is it.
    ///
    /// # Errors
    /// [`StudyError`] naming participant and score for one outside the range of the style.
    pub(crate) fn of(mut rows: Vec<Score>, study: Option<&DesignFile>) -> Result<Self, StudyError> {
        let Some(study) = study else {
            rows.retain(|s| s.scale == "adb" && s.subscale == "total");
            let range = ScoreRange::ADB;
            return Ok(Self { range, rows });
        };
        let range = style_range(study)?;
        let name = study.design.style().map(|style| &style.score);
        rows.retain(|s| name.is_some_and(|n| s.scale == n.scale && s.subscale == n.subscale));
        for score in &rows {
            if let Some(value) = score.value.filter(|value| range.score(*value).is_err()) {
                return Err(study.wrong(
                    format!(
                        "`style.range`: participant {} ({}) scores {value} on `{}.{}`, expected {range}",
                        score.participant, score.moment, score.scale, score.subscale
                    ),
                    Some("widen `range` to that of the questionnaire, or check the answers".to_owned()),
                ));
            }
        }
        Ok(Self { range, rows })
    }

    /// The score that belongs to a drive: that of its role, where a study's says one by its instruction; else the one answered before the
    /// drives to the baseline, another to a professional's role.
    ///
    /// # Errors
    /// [`StudyError`] for one outside the scale.
    pub(crate) fn of_drive(
        &self,
        drive: &Drive,
        study: Option<&DesignFile>,
        baseline: Option<ConditionId>,
    ) -> Result<Option<StyleScore>, StudyError> {
        let meta = drive.meta();
        let role = study.and_then(|s| s.design.role(meta.condition));
        let moment = if Some(meta.condition) == baseline {
            Moment::Pre
        } else {
            Moment::after(meta.condition)
        };
        let is_of = |s: &&Score| s.participant == meta.participant && s.moment == moment;
        let answered = || self.rows.iter().find(is_of)?.value;
        let points = role.and_then(|role| role.score).or_else(answered);
        Ok(points.map(|points| self.range.score(points)).transpose()?)
    }
}
