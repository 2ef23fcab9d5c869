//! What people answered, and what questionnaires say of it.

use super::{StudyData, cells::FIRST};
use maveric_domain::{
    ConditionId, Moment, Occasion, ParticipantId, Scale, ScoreRange, Subscale,
    design::{ScoreName, Sign},
};
use std::num::NonZeroU32;

impl StudyData {
    /// A questionnaire score about a condition in a session, as [`StudyData::rated`].
    pub(crate) fn rated_in(
        &self,
        session: NonZeroU32,
        participant: &ParticipantId,
        condition: ConditionId,
        name: &ScoreName,
    ) -> Option<f64> {
        let score_at = |moment: Moment| {
            let moment = moment.on(Occasion { session, trial: FIRST });
            self.post.get(participant, moment, &name.scale, &name.subscale)
        };
        score_at(Moment::after(condition)).or_else(|| score_at(Moment::probe(condition)))
    }

    /// A questionnaire score from before the drives, or from the end where it was asked then alone.
    pub fn pre(&self, participant: &ParticipantId, name: &ScoreName) -> Option<f64> {
        let once = |moment| self.answered_at(moment, participant, name);
        once(Moment::Pre).or_else(|| once(Moment::Post))
    }

    /// A questionnaire score from before the drives or from their end.
    pub(crate) fn answered_at(
        &self,
        moment: Moment,
        participant: &ParticipantId,
        name: &ScoreName,
    ) -> Option<f64> {
        self.pre.get(participant, moment, &name.scale, &name.subscale)
    }

    /// A questionnaire score about a condition: from after the ride, or the mean of what was asked during it; of several rides of the first
    /// session their mean.
    pub fn rated(
        &self,
        participant: &ParticipantId,
        condition: ConditionId,
        name: &ScoreName,
    ) -> Option<f64> {
        self.rated_in(FIRST, participant, condition, name)
    }

    /// Subscales of a scale from before the drives, in the order in which they were scored.
    pub fn pre_subscales(&self, scale: &str) -> Vec<ScoreName> {
        let names = self.before.iter().filter(|name| name.scale == scale);
        names.cloned().collect()
    }

    /// Everything that was scored after a condition, in the order in which it was scored.
    pub fn rated_names(&self) -> &[ScoreName] {
        &self.after
    }

    /// The subscale of a score, where its questionnaire is known.
    pub fn subscale(&self, name: &ScoreName) -> Option<(&Scale, &Subscale)> {
        let scale = self.scales.iter().find(|s| s.id == name.scale)?;
        let subscale = scale.subscales.iter().find(|s| s.id == name.subscale)?;
        Some((scale, subscale))
    }

    /// Lowest and highest score of the design's style; none where neither it nor a questionnaire says.
    pub fn style_range(&self) -> Option<(f64, f64)> {
        let style = self.design.style()?;
        let declared = style.range.map(|[low, high]| (low, high));
        let of_scale = || {
            let (scale, subscale) = self.subscale(&style.score)?;
            Some(scale.score_range(subscale))
        };
        declared.or_else(of_scale)
    }

    /// The scale of the design's style; the ADB's where nobody says its range.
    pub fn style_scale(&self) -> ScoreRange {
        let range = self.style_range();
        let range = range.and_then(|(low, high)| ScoreRange::new(low, high).ok());
        range.unwrap_or(ScoreRange::ADB)
    }

    /// Points of the design's style that one ADB point is, both scales end on end.
    pub fn adb_point(&self) -> f64 {
        self.style_scale().width() / ScoreRange::ADB.width()
    }

    /// What a page calls a score: the subscale's title, or the scale's where it has no other.
    pub fn score_title(&self, name: &ScoreName) -> String {
        match self.subscale(name) {
            Some((scale, _)) if scale.subscales.len() == 1 => scale.title.clone(),
            Some((_, subscale)) => subscale.title.clone(),
            None => name.to_string(),
        }
    }

    /// Which way is better on a score: down where its questionnaire says that lower is better.
    pub fn better(&self, name: &ScoreName) -> Sign {
        match self.subscale(name) {
            Some((_, subscale)) if subscale.lower_is_better => Sign::Minus,
            _ => Sign::Plus,
        }
    }
}
