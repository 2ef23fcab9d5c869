//! How the traits of a person hang together.

use crate::{error::ParticipantError, linear::cholesky, person::Trait, settings::CohortSettings};

const N: usize = Trait::ALL.len();

/// Traits as mixtures of independent draws: traits = mixing · draws, each N(0, 1); shape `(9, 9)`, rows and columns in the order
/// of [`Trait::ALL`].
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TraitMixing([[f64; N]; N]);

fn place(name: Trait) -> usize {
    // The order in which the enum lists them is that of `ALL`.
    name as usize
}

impl TraitMixing {
    /// The mixing that gives the correlations of the settings.
    ///
    /// Aggressiveness, spacing and pace are draws themselves, and so nearly are conscientiousness and openness, which the
    /// others are built around: correlations among the Big Five change nobody's driving.
    ///
    /// # Errors
    /// [`ParticipantError::BadSetting`] for a setting out of its range, and where the correlations contradict each other.
    pub(crate) fn new(settings: &CohortSettings) -> Result<Self, ParticipantError> {
        use Trait::{
            Aggressiveness, Agreeableness, Conscientiousness, Extraversion, HighVelocity,
            Neuroticism, Openness, Pace, Spacing,
        };
        settings.check()?;
        let order =
            [Aggressiveness, Conscientiousness, Openness, Extraversion, Agreeableness, Neuroticism];
        let pairs = settings.correlations();
        let correlation = |x: Trait, y: Trait| {
            let pair = pairs.iter().find(|(a, b, _)| (*a, *b) == (x, y) || (*b, *a) == (x, y));
            if x == y { 1.0 } else { pair.map_or(0.0, |p| p.2) }
        };
        let wanted: Vec<Vec<f64>> =
            order.iter().map(|x| order.iter().map(|y| correlation(*x, *y)).collect()).collect();
        let lower = cholesky(&wanted).map_err(|found| ParticipantError::BadSetting {
            name: "correlations of the Big Five".to_owned(),
            found,
            expected: "a positive definite matrix: some contradict each other",
        })?;
        let mut mixing = [[0.0; N]; N];
        for (row, x) in lower.iter().zip(order) {
            for (weight, y) in row.iter().zip(order) {
                mixing[place(x)][place(y)] = *weight;
            }
        }
        mixing[place(Spacing)][place(Spacing)] = 1.0;
        mixing[place(Pace)][place(Pace)] = 1.0;
        let (a, c) = (settings.high_velocity_aggressiveness, settings.high_velocity_pace);
        let velocity = &mut mixing[place(HighVelocity)];
        velocity[place(Aggressiveness)] = a;
        velocity[place(Pace)] = c;
        velocity[place(HighVelocity)] = (1.0 - a * a - c * c).max(0.0).sqrt();
        Ok(Self(mixing))
    }

    /// A trait from the nine draws.
    pub(crate) fn mix(&self, name: Trait, draws: &[f64; N]) -> f64 {
        self.0[place(name)].iter().zip(draws).map(|(w, z)| w * z).sum()
    }

    pub(crate) fn correlation(&self, x: Trait, y: Trait) -> f64 {
        let (x, y) = (&self.0[place(x)], &self.0[place(y)]);
        x.iter().zip(y).map(|(a, b)| a * b).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn traits_correlate_as_the_settings_say() {
        let settings = CohortSettings::default();
        let mixing = TraitMixing::new(&settings).unwrap();
        for (x, y, r) in [
            (Trait::Extraversion, Trait::Openness, settings.extraversion_openness),
            (Trait::Neuroticism, Trait::Conscientiousness, settings.conscientiousness_neuroticism),
            (Trait::Agreeableness, Trait::Aggressiveness, settings.agreeableness_aggressiveness),
            (Trait::HighVelocity, Trait::Pace, settings.high_velocity_pace),
            (Trait::Spacing, Trait::Pace, 0.0),
            (Trait::Openness, Trait::Openness, 1.0),
        ] {
            assert!((mixing.correlation(x, y) - r).abs() < 1e-12, "{x:?} {y:?}");
        }
        for (i, name) in Trait::ALL.into_iter().enumerate() {
            assert_eq!(place(name), i);
        }
    }

    #[test]
    fn correlations_that_contradict_each_other_are_refused() {
        let settings = CohortSettings {
            extraversion_openness: 0.9,
            extraversion_agreeableness: 0.9,
            agreeableness_openness: -0.9,
            ..CohortSettings::default()
        };
        let error = TraitMixing::new(&settings).unwrap_err().to_string();
        assert!(error.contains("positive definite"), "{error}");
    }
}
