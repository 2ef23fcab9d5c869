//! Styles that an older program kept: that one judged a score when it was read, and had it in points of the ADB's scale whatever the study's.

use crate::{person::Person, seat::Seat};
use maveric_domain::{BeyondWhy, Embedding, ScoreRange};
use maveric_model::style_space::LinearHead;
use maveric_seat_page::Fit;

/// How near two readings of a style lie that are the same but for how often its model was learned again, in shares of the scale.
const SAME_READING: f64 = 1e-3;

/// The score that was kept, in points of this `range`; `reading` is what the model that rides reads of the style.
fn points_on(range: ScoreRange, kept: f64, reading: Option<f64>) -> f64 {
    if range == ScoreRange::ADB {
        return kept;
    }
    let converted = ScoreRange::ADB.onto(range, kept);
    let near = |points: &f64| (points - converted).abs() < SAME_READING * range.width();
    match reading.filter(near) {
        Some(points) => points,
        // This program keeps no score that the scale does not have.
        None if !range.has(kept) => converted,
        None => kept,
    }
}

/// What has to stand in the place of a style; none where it stays as it is.
fn anew(style: Fit, range: ScoreRange, reading: Option<f64>) -> Option<Fit> {
    let kept = style.score.filter(|_| style.beyond.is_none())?;
    let points = points_on(range, kept, reading);
    let (score, beyond) = BeyondWhy::of_reading(range, Some(points), None);
    if score == Some(kept) {
        return None;
    }
    Some(Fit {
        score,
        beyond,
        ..style
    })
}

impl Seat {
    /// What has to stand in the place of somebody's style, as JSON; none where it stays as it is.
    pub(crate) fn style_anew(&self, person: &Person) -> Option<String> {
        let style = person.style()?;
        let model = self.model.as_ref();
        let axis = model.and_then(|model| LinearHead::aggression(model).ok());
        let embedding = Embedding::new(style.embedding.clone()).ok();
        // A style of another size is not read.
        let reading = axis
            .zip(embedding)
            .and_then(|(axis, embedding)| axis.read(&embedding).ok());
        let range = self.score_range()?;
        serde_json::to_string(&anew(style, range, reading)?).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(score: Option<f64>) -> Fit {
        Fit {
            embedding: vec![0.5],
            covariance: None,
            score,
            readings: 3,
            beyond: None,
        }
    }

    fn range(low: f64, high: f64) -> ScoreRange {
        ScoreRange::new(low, high).unwrap()
    }

    #[test]
    fn a_score_that_the_scale_does_not_have_is_taken_out_and_is_why_the_style_is_beyond() {
        for none in [-3.0, -1.3, 55.5] {
            let style = anew(kept(Some(none)), ScoreRange::ADB, Some(none)).unwrap();
            assert_eq!((style.score, style.beyond), (None, Some(BeyondWhy::Scale)));
            assert_eq!((style.embedding, style.readings), (vec![0.5], 3));
        }
        // What is on the ADB's scale stays to the bit, whatever a model that was learned since reads.
        for stays in [11.0, 30.0, 55.0] {
            for reading in [None, Some(stays), Some(stays + 1e-9), Some(-3.0)] {
                assert_eq!(anew(kept(Some(stays)), ScoreRange::ADB, reading), None);
            }
        }
        assert_eq!(anew(kept(None), ScoreRange::ADB, Some(30.0)), None);
        let why = BeyondWhy::Style {
            habit: "pass".to_owned(),
        };
        let stranger = Fit {
            beyond: Some(why),
            ..kept(Some(99.0))
        };
        assert_eq!(anew(stranger, ScoreRange::ADB, None), None);
    }

    #[test]
    fn points_of_the_adbs_scale_are_those_of_the_study_s_end_on_end() {
        let score = |range: ScoreRange, score: f64, reading: Option<f64>| {
            let style = anew(kept(Some(score)), range, reading)?;
            Some((style.score, style.beyond))
        };
        let risky = range(1.0, 6.0);
        // 19 of 44 points up from the lower end.
        let expected = 1.0 + 19.0 * 5.0 / 44.0;
        // The last reading is of a model that was not the one that rides.
        for reading in [None, Some(expected), Some(2.0)] {
            let (found, beyond) = score(risky, 30.0, reading).unwrap();
            assert!((found.unwrap() - expected).abs() < 1e-12);
            assert_eq!(beyond, None);
        }
        let off = Some((None, Some(BeyondWhy::Scale)));
        assert_eq!(score(risky, -3.0, None), off);
        assert_eq!(
            score(risky, 60.0, Some(ScoreRange::ADB.onto(risky, 60.0))),
            off
        );
        // A score of 3 points of the ADB's scale is none, one of the study's is.
        assert_eq!(
            score(risky, 3.0, Some(ScoreRange::ADB.onto(risky, 3.0))),
            off
        );
        assert_eq!(score(risky, 3.0, Some(3.0)), None);
        // Both scales have 30: what the model reads says which it was.
        let wide = range(11.0, 66.0);
        assert_eq!(score(wide, 30.0, Some(34.75)), Some((Some(34.75), None)));
        assert_eq!(score(wide, 30.0, Some(30.0)), None);
        assert_eq!(score(wide, 34.75, Some(34.75)), None);
        assert_eq!(score(wide, 30.0, None), None);
    }
}
