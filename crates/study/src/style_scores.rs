//! The score that the dial turns: the ends of its scale, and what people scored on it.

use crate::{
    design::DesignFile,
    error::{CHECK_SCORE, StudyError},
    run_folder::{read_scales, score_range},
};
use maveric_domain::{
    ConditionId, DomainError, Drive, Moment, Scale, Score, ScoreRange, StyleScore,
    design::DesignError,
};

/// The ends of the scale of a study's style; none where it has no style.
///
/// # Errors
/// [`StudyError`] naming the key where neither the design nor a questionnaire says them.
pub fn style_range(study: &DesignFile) -> Result<Option<ScoreRange>, StudyError> {
    let Some(style) = study.design.style() else {
        return Ok(None);
    };
    if let Some(ends) = style.range {
        let range = ScoreRange::try_from(ends);
        return range
            .map(Some)
            .map_err(|error| study.wrong(format!("`style.range`: {error}"), None));
    }
    let scales = read_scales(&study.resolve(&study.design.files().scales))?;
    if let Some((low, high)) = score_range(&scales, &style.score) {
        let no_range = |error: DomainError| {
            let problem = format!("`style.score`: `{}` has {error}", style.score);
            let help = "mend its questionnaire, or say `range` below [style]";
            study.wrong(problem, Some(help.to_owned()))
        };
        return ScoreRange::new(low, high).map(Some).map_err(no_range);
    }
    let ids: Vec<String> = scales.iter().flat_map(Scale::score_names).collect();
    let name = style.score.to_string();
    let error = DesignError::word("style.score", &name, ids.iter().map(String::as_str));
    Err(study.wrong(error.to_string(), error.suggestion()))
}

/// What people scored on a study's style.
#[derive(Debug)]
pub(crate) struct StyleScores {
    /// The ends of its scale; none where no study says them: what people scored is then the ADB's.
    pub(crate) range: Option<ScoreRange>,
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
            return Ok(Self { range: None, rows });
        };
        let Some((style, range)) = study.design.style().zip(style_range(study)?) else {
            return Ok(Self { range: None, rows: Vec::new() });
        };
        let name = &style.score;
        rows.retain(|s| s.scale == name.scale && s.subscale == name.subscale);
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
        let range = Some(range);
        Ok(Self { range, rows })
    }

    /// The scale of what people scored.
    pub(crate) fn scale(&self) -> ScoreRange {
        self.range.unwrap_or(ScoreRange::ADB)
    }

    /// The score that belongs to a drive: that of its role, where a study's says one by its instruction; else the one answered before the
    /// drives to the baseline, another to a professional's role.
    ///
    /// # Errors
    /// [`StudyError`] naming participant, drive and moment for one outside the scale.
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
        let Some(points) = points else {
            return Ok(None);
        };
        self.scale().score(points).map(Some).map_err(|error| {
            let (who, drive) = (&meta.participant, &meta.drive);
            StudyError::not_possible(format!(
                "participant {who}, drive {drive} ({moment}): {error}"
            ))
            .with_help(CHECK_SCORE)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recordings::testing::drives;
    use maveric_domain::Design;

    fn study(style: &str) -> DesignFile {
        let text = format!("[study]\ntitle = \"t\"\n{style}[[role]]\nid = \"calm\"\n");
        let design = Design::from_toml(&text).unwrap();
        DesignFile { path: None, design }
    }

    #[test]
    fn a_study_says_a_range_only_with_its_style() {
        assert_eq!(style_range(&study("")).unwrap(), None);
        let scores = StyleScores::of(Vec::new(), Some(&study(""))).unwrap();
        assert_eq!(scores.range, None);
        let risky = study("[style]\nscore = \"risk.total\"\nrange = [1, 6]\n");
        let range = ScoreRange::new(1.0, 6.0).unwrap();
        assert_eq!(style_range(&risky).unwrap(), Some(range));
    }

    #[test]
    fn a_score_that_the_scale_has_not_is_refused_with_whose_it_is_and_what_to_do() {
        let drive = &drives()[0];
        let meta = drive.meta();
        let answered = |points: f64| Score {
            participant: meta.participant.clone(),
            moment: Moment::after(meta.condition),
            scale: "adb".to_owned(),
            subscale: "total".to_owned(),
            value: Some(points),
            answered: 11,
            items: 11,
        };
        let of = |points| {
            let scores = StyleScores::of(vec![answered(points)], None).unwrap();
            scores.of_drive(drive, None, None)
        };
        let score = of(30.0).unwrap();
        assert_eq!(score, ScoreRange::ADB.score(30.0).ok());
        let error = of(60.0).unwrap_err();
        let said = error.to_string();
        for part in
            [meta.participant.as_str(), meta.drive.as_str(), "calm", "60, expected 11 to 55"]
        {
            assert!(said.contains(part), "{part}: {said}");
        }
        assert_eq!(error.suggestion().as_deref(), Some(CHECK_SCORE));
    }
}
