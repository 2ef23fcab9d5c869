//! The scale of the score that a model has learned: that of its drives' scores, or another on which it is said.

use crate::{
    epochs::TrainingDrive,
    error::ModelError,
    model::{Heads, LinearHeads, Model},
};
use maveric_domain::{ScoreRange, StyleScore};

/// The scale of what drives score; the ADB's where nobody scored.
///
/// # Errors
/// [`ModelError::OtherScale`] for scores of two scales.
pub(crate) fn range_of(drives: &[TrainingDrive<'_>]) -> Result<ScoreRange, ModelError> {
    let mut scores = drives.iter().filter_map(|d| d.adb);
    let first = scores.next().map_or(ScoreRange::ADB, StyleScore::range);
    scores.try_for_each(|score| points_on(first, score).map(drop))?;
    Ok(first)
}

/// The points of a score that has to be on this scale.
pub(crate) fn points_on(expected: ScoreRange, score: StyleScore) -> Result<f64, ModelError> {
    let found = score.range();
    if found == expected {
        return Ok(score.points());
    }
    Err(ModelError::OtherScale { found, expected })
}

impl Model {
    /// The ends of the scale of the score that styles are read as; those of the ADB's where none was learned.
    pub fn score_range(&self) -> ScoreRange {
        self.parts.score_range
    }

    /// The same model with its score on another scale, end on end: for a study whose own score has that range. Without a range it stays
    /// on its own.
    #[must_use]
    pub fn on_range(mut self, range: impl Into<Option<ScoreRange>>) -> Self {
        let Some(range) = range.into() else {
            return self;
        };
        let learned = std::mem::replace(&mut self.parts.score_range, range);
        if learned == range {
            return self;
        }
        let a_point = range.width() / learned.width();
        let there = |points: f64| learned.onto(range, points);
        match &mut self.parts.heads {
            Heads::Linear(LinearHeads { style: Some(style), .. }) => {
                style.gradient.iter_mut().for_each(|g| *g *= a_point);
                let square = a_point * a_point;
                style.covariance.iter_mut().for_each(|c| *c *= square);
                style.offset = there(style.offset);
                style.reading_sd *= a_point;
                style.cross_fitted_rmse = style.cross_fitted_rmse.map(|e| e * a_point);
            }
            Heads::Linear(_) => {}
            Heads::Paper(paper) => {
                let aggression = &mut paper.scaling.aggression;
                aggression.mean = there(aggression.mean);
                aggression.sd *= a_point;
            }
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        heads::StyleHead,
        heads_kind::HeadsKind,
        model_file,
        params::TrainSettings,
        personalize::{learn_days, personalize},
        style_space::LinearHead,
        test_drives::{Scored, drivers_apart},
        train::tests::trained,
    };

    fn risky() -> ScoreRange {
        ScoreRange::new(1.0, 6.0).unwrap()
    }

    /// People with the same scores on the scale from 1 to 6.
    fn on_six() -> Vec<Scored> {
        let on_six = |(drive, adb): Scored| {
            let points = 1.0 + (adb.points() - 11.0) / 8.8;
            (drive, risky().score(points).unwrap())
        };
        drivers_apart(6, 240.0).into_iter().map(on_six).collect()
    }

    fn is_scaled(found: f64, from: f64, by: f64) {
        let expected = from * by;
        assert!(
            (found - expected).abs() < 1e-9 * (1.0 + expected.abs()),
            "{found} instead of {expected}"
        );
    }

    /// All that is in points of the score is in points of the ADB's: 8.8 for one.
    fn is_stretched(own: &StyleHead, adb: &StyleHead) {
        let square = 8.8 * 8.8;
        is_scaled(adb.reading_sd, own.reading_sd, 8.8);
        is_scaled(adb.cross_fitted_rmse.unwrap(), own.cross_fitted_rmse.unwrap(), 8.8);
        assert_eq!(adb.cross_fitted_r, own.cross_fitted_r);
        let d = own.gradient.len();
        let both = [own, adb].map(|style| &style.covariance);
        assert_eq!(both.map(Vec::len), [(d + 1) * (d + 1); 2]);
        for (own, adb) in both[0].iter().zip(both[1]) {
            is_scaled(*adb, *own, square);
        }
        // The offset's, in the last line.
        assert!(both[0].last().is_some_and(|variance| *variance > 0.0));
    }

    #[test]
    fn a_model_learned_on_1_to_6_reads_the_stretched_scores_on_11_to_55_and_its_own_again_on_1_to_6()
     {
        let people = on_six();
        for heads in [HeadsKind::Linear, HeadsKind::Paper] {
            let settings = TrainSettings {
                heads,
                epochs: 2,
                validation_fraction: 0.0,
                ..TrainSettings::default()
            };
            let own = trained(&people, &settings);
            assert_eq!(own.score_range(), risky());
            let adb = own.clone().on_range(ScoreRange::ADB);
            let back = adb.clone().on_range(risky());
            assert_eq!(own.clone().on_range(risky()), own);
            let kept = model_file::from_bytes(&model_file::to_bytes(&adb).unwrap()).unwrap();
            assert_eq!((kept.score_range(), &kept), (ScoreRange::ADB, &adb));
            let axes = [&own, &adb, &back].map(|m| LinearHead::aggression(m).unwrap());
            let ends = [11.0_f64, 55.0].map(f64::to_bits);
            assert_eq!(axes[1].range().map(f64::to_bits), ends);
            let (drive, score) = &people[4];
            let on_adb = ScoreRange::ADB.score(11.0 + (score.points() - 1.0) * 8.8);
            let fits = [
                personalize(&own, drive, Some(*score)).unwrap(),
                personalize(&adb, drive, Some(on_adb.unwrap())).unwrap(),
                personalize(&back, drive, Some(*score)).unwrap(),
            ];
            let [reads, stretched, again] = [0, 1, 2].map(|i| fits[i].aggression_hat.unwrap());
            assert!((stretched - (11.0 + (reads - 1.0) * 8.8)).abs() < 0.01);
            assert!((again - reads).abs() < 0.001);
            let embedding = &fits[0].embedding;
            let [reads, stretched, again] = axes.each_ref().map(|a| a.read(embedding).unwrap());
            assert!((stretched - (11.0 + (reads - 1.0) * 8.8)).abs() < 1e-9);
            assert!((again - reads).abs() < 1e-12);
            let sds = [0, 1].map(|i| axes[i].step_sd(embedding.coordinates()));
            let of_linear = [&own, &adb].map(|m| m.linear().ok()?.style.as_ref());
            match (heads, of_linear, sds) {
                (HeadsKind::Linear, [Some(own), Some(adb)], [Some(own_sd), Some(adb_sd)]) => {
                    assert!(own_sd > 0.0);
                    is_scaled(adb_sd, own_sd, 8.8);
                    is_stretched(own, adb);
                }
                (HeadsKind::Paper, [None, None], [None, None]) => {}
                other => panic!("{other:?}"),
            }
            // A point of the one is 8.8 of the other.
            let turned = [(0, 0.5), (1, 4.4)].map(|(i, by)| axes[i].shift(embedding, by).unwrap());
            let both = turned.each_ref().map(|moved| moved.embedding.coordinates());
            assert!(both[0].iter().zip(both[1]).all(|(a, b)| (a - b).abs() < 1e-9));
        }
    }

    #[test]
    fn a_score_of_another_scale_than_the_model_s_or_the_others_is_refused() {
        let mut people = on_six();
        let settings = TrainSettings::default();
        let model = trained(&people, &settings);
        let (drive, adb) = drivers_apart(1, 240.0).remove(0);
        let other = ModelError::OtherScale { found: ScoreRange::ADB, expected: risky() };
        let refused = personalize(&model, &drive, Some(adb)).unwrap_err();
        assert_eq!(refused, other);
        assert!(personalize(&model, &drive, None).is_ok());
        people.push((drive, adb));
        let given: Vec<TrainingDrive<'_>> = people.iter().map(TrainingDrive::from).collect();
        assert_eq!(range_of(&given), Err(other.clone()));
        let go_on = &mut |_: &_| std::ops::ControlFlow::Continue(());
        assert_eq!(crate::train(&given[1..], &settings, 1, go_on).err(), Some(other));
        let adb = model.on_range(ScoreRange::ADB);
        let twice = given.windows(2).map(|both| [both[0].drive, both[1].drive]);
        let twice: Vec<_> = twice.collect();
        let other = ModelError::OtherScale { found: risky(), expected: ScoreRange::ADB };
        assert_eq!(learn_days(&adb, &given[..6], 1.0, &twice, 1).err(), Some(other));
    }
}
