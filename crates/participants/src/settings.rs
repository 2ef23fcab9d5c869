//! How a cohort is made up.

use crate::{
    error::{ParticipantError, within},
    part::Part,
    person::{Population, Trait},
};
use serde::{Deserialize, Serialize};

/// A group of participants: how old, how many of them women.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Group {
    /// Mean age, before rounding to whole years.
    pub mean_age_years: f64,
    /// Standard deviation of age in years, before the tails are cut at 1.5 of them.
    pub sd_age_years: f64,
    /// Share of women, 0 to 1.
    pub female_share: f64,
}

/// How a cohort is made up.
///
/// # Source
/// Paper, Participants; method section 7. Standard deviations of age are not reported: 10 years is ours, and so are
/// the correlations between traits, which only follow the direction usual in the literature on driving.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CohortSettings {
    /// Those who are learned from, all recruited internally.
    pub study1: Group,
    /// The half of those who are tested that was recruited internally: the participants of odd number.
    pub study2_internal: Group,
    /// The half of them that was recruited from the public: the participants of even number.
    pub study2_external: Group,
    /// Share of professionals among those who are learned from, 0 to 1.
    pub professional_share: f64,
    /// Aggressiveness at which professionals drive the aggressive role; its negative for the cautious one.
    pub role_aggressiveness: f64,
    pub role_sd: f64,
    /// Correlation of conscientiousness with aggressiveness.
    pub conscientiousness_aggressiveness: f64,
    /// Correlation of agreeableness with aggressiveness.
    pub agreeableness_aggressiveness: f64,
    /// Correlation of extraversion with openness.
    pub extraversion_openness: f64,
    /// Correlation of extraversion with agreeableness.
    pub extraversion_agreeableness: f64,
    /// Correlation of extraversion with neuroticism.
    pub extraversion_neuroticism: f64,
    /// Correlation of agreeableness with openness.
    pub agreeableness_openness: f64,
    /// Correlation of agreeableness with conscientiousness.
    pub agreeableness_conscientiousness: f64,
    /// Correlation of conscientiousness with neuroticism.
    pub conscientiousness_neuroticism: f64,
    /// Correlation of the high-velocity style with aggressiveness.
    pub high_velocity_aggressiveness: f64,
    /// Correlation of the high-velocity style with pace.
    pub high_velocity_pace: f64,
}

impl Default for CohortSettings {
    fn default() -> Self {
        let group = |mean_age_years, female_share| Group {
            mean_age_years,
            sd_age_years: 10.0,
            female_share,
        };
        Self {
            study1: group(35.4, 0.27),
            study2_internal: group(34.42, 0.334),
            study2_external: group(43.92, 0.417),
            professional_share: 4.0 / 30.0,
            role_aggressiveness: 1.9,
            role_sd: 0.2,
            conscientiousness_aggressiveness: -0.15,
            agreeableness_aggressiveness: -0.2,
            // The correlations of the scores (scale file) over the roots of their reliabilities.
            extraversion_openness: 0.28,
            extraversion_agreeableness: 0.27,
            extraversion_neuroticism: -0.21,
            agreeableness_openness: 0.22,
            agreeableness_conscientiousness: 0.14,
            conscientiousness_neuroticism: -0.22,
            high_velocity_aggressiveness: 0.5,
            high_velocity_pace: 0.4,
        }
    }
}

impl CohortSettings {
    /// Says whether each setting makes sense; whether correlations contradict each other shows when people are drawn.
    ///
    /// # Errors
    /// [`ParticipantError::BadSetting`] naming the first key that does not.
    pub fn check(&self) -> Result<(), ParticipantError> {
        for (name, group) in [
            ("study1", &self.study1),
            ("study2_internal", &self.study2_internal),
            ("study2_external", &self.study2_external),
        ] {
            let key = |field: &str| format!("{name}.{field}");
            let (mean, sd) = (group.mean_age_years, group.sd_age_years);
            within(&key("mean_age_years"), mean, 18.0, 90.0, "18 to 90 years")?;
            within(&key("sd_age_years"), sd, 0.0, 30.0, "0 to 30 years")?;
            within(&key("female_share"), group.female_share, 0.0, 1.0, "0 to 1")?;
        }
        let (share, level) = (self.professional_share, self.role_aggressiveness);
        within("professional_share", share, 0.0, 1.0, "0 to 1")?;
        within("role_aggressiveness", level, 0.0, 5.0, "0 to 5")?;
        within("role_sd", self.role_sd, 0.0, 2.0, "0 to 2")?;
        for (x, y, r) in self.correlations() {
            let key = format!("{}_{}", x.as_str(), y.as_str());
            within(&key, r, -1.0, 1.0, "-1 to 1")?;
        }
        let explained = self.high_velocity_aggressiveness.powi(2) + self.high_velocity_pace.powi(2);
        let key = "high_velocity_aggressiveness² + high_velocity_pace²";
        within(key, explained, 0.0, 1.0, "0 to 1")
    }

    /// The correlations among aggressiveness and the Big Five; the key of each is made of the names of its traits.
    pub(crate) fn correlations(&self) -> [(Trait, Trait, f64); 8] {
        use Trait::{
            Aggressiveness, Agreeableness, Conscientiousness, Extraversion, Neuroticism, Openness,
        };
        [
            (Conscientiousness, Aggressiveness, self.conscientiousness_aggressiveness),
            (Agreeableness, Aggressiveness, self.agreeableness_aggressiveness),
            (Extraversion, Openness, self.extraversion_openness),
            (Extraversion, Agreeableness, self.extraversion_agreeableness),
            (Extraversion, Neuroticism, self.extraversion_neuroticism),
            (Agreeableness, Openness, self.agreeableness_openness),
            (Agreeableness, Conscientiousness, self.agreeableness_conscientiousness),
            (Conscientiousness, Neuroticism, self.conscientiousness_neuroticism),
        ]
    }

    pub(crate) fn group(&self, part: Part, population: Population) -> &Group {
        match (part, population) {
            (Part::Learn, _) => &self.study1,
            (Part::Test, Population::Internal) => &self.study2_internal,
            (Part::Test, Population::External) => &self.study2_external,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_traits_explain_of_a_habit_adds_up_to_one_at_most() {
        let with = |aggressiveness: f64, pace: f64| {
            let settings = CohortSettings {
                high_velocity_aggressiveness: aggressiveness,
                high_velocity_pace: pace,
                ..CohortSettings::default()
            };
            settings.check().map_err(|e| e.to_string())
        };
        assert!(with(0.6, 0.8).is_ok());
        let error = with(0.7, 0.8).unwrap_err();
        assert!(error.contains("high_velocity_pace²"), "{error}");
        let older = CohortSettings {
            study1: Group { mean_age_years: 17.9, ..CohortSettings::default().study1 },
            ..CohortSettings::default()
        };
        let error = older.check().unwrap_err().to_string();
        assert!(error.contains("study1.mean_age_years"), "{error}");
    }
}
