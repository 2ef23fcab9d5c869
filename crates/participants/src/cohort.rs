//! Who takes part.

use crate::{
    error::ParticipantError,
    person::{Gender, Participant, Personality, Population, Trait},
    response::{normal, stream},
    settings::{CohortSettings, Group},
    trait_mixing::TraitMixing,
};
use maveric_domain::{ConditionId, DriveId, LatentTraits, ParticipantId, Study};
use serde::{Deserialize, Serialize};

/// A drive by hand that somebody is to make, and the traits to make it with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlannedDrive {
    /// Such as `S1P04-aggressive`.
    pub drive: DriveId,
    /// Who drives.
    pub participant: ParticipantId,
    /// Which study.
    pub study: Study,
    /// Own, or the role that a professional demonstrates.
    pub condition: ConditionId,
    /// The person's traits; in a role with another aggressiveness.
    pub traits: LatentTraits,
}

/// The participants of both studies and the drives they make by hand.
#[derive(Debug, Clone, PartialEq)]
pub struct Cohort {
    /// Study 1, then Study 2, by number.
    pub participants: Vec<Participant>,
    /// In the order of the participants; own drive first, then a professional's roles.
    pub drives: Vec<PlannedDrive>,
    /// What they were drawn by.
    pub settings: CohortSettings,
}

impl Cohort {
    /// Draws `n_study1` + `n_study2` people, `S1P01`… and `S2P01`….
    ///
    /// Each person depends on the seed and their own number alone: a larger study starts with the same people. Shares
    /// (women, professionals) are met by rounding as numbers go up: 8 women and 4 professionals of 30, 4 and 5 women of 12.
    /// Neighbours within a group share the size of their deviation from the mean age, with opposite signs, so that the mean
    /// of an even group is as given.
    ///
    /// # Errors
    /// [`ParticipantError::BadSetting`].
    pub fn draw(
        n_study1: usize,
        n_study2: usize,
        seed: u64,
        settings: &CohortSettings,
    ) -> Result<Self, ParticipantError> {
        settings.check()?;
        let mut cohort = Self {
            participants: Vec::new(),
            drives: Vec::new(),
            settings: settings.clone(),
        };
        let mixing = TraitMixing::of(settings)?;
        for (study, n) in [(Study::One, n_study1), (Study::Two, n_study2)] {
            for index in 0..n {
                let participant = person(study, index, seed, settings, &mixing)?;
                cohort.drives.extend(drives(&participant, seed, settings)?);
                cohort.participants.push(participant);
            }
        }
        Ok(cohort)
    }

    /// The participant of this id.
    pub fn find(&self, id: &ParticipantId) -> Option<&Participant> {
        self.participants.iter().find(|p| p.id == *id)
    }
}

/// Whether number `index` is one of the `share` that are picked, spread evenly; `phase` shifts the pattern.
fn picked(index: usize, share: f64, phase: f64) -> bool {
    let up_to = |n: usize| (n as f64 * share + phase).floor();
    up_to(index + 1) > up_to(index)
}

fn person(
    study: Study,
    index: usize,
    seed: u64,
    settings: &CohortSettings,
    mixing: &TraitMixing,
) -> Result<Participant, ParticipantError> {
    let id = ParticipantId::new(format!("S{}P{:02}", study.as_str(), index + 1))?;
    let (population, within) = match study {
        Study::One => (Population::Internal, index),
        Study::Two if index.is_multiple_of(2) => (Population::Internal, index / 2),
        Study::Two => (Population::External, index / 2),
    };
    let group = settings.group(study, population);
    let mut rng = stream(seed, &[id.as_str(), "latents"]);
    let draws = std::array::from_fn(|_| normal(&mut rng));
    let latent = |name| mixing.mix(name, &draws);
    let traits = LatentTraits {
        aggressiveness: latent(Trait::Aggressiveness),
        spacing: latent(Trait::Spacing),
        pace: latent(Trait::Pace),
    };
    let personality = Personality {
        extraversion: latent(Trait::Extraversion),
        agreeableness: latent(Trait::Agreeableness),
        conscientiousness: latent(Trait::Conscientiousness),
        neuroticism: latent(Trait::Neuroticism),
        openness: latent(Trait::Openness),
    };
    Ok(Participant {
        study,
        population,
        age_years: age_years(group, study, population, within, seed),
        gender: if picked(within, group.female_share, 0.0) {
            Gender::Female
        } else {
            Gender::Male
        },
        professional: study == Study::One && picked(index, settings.professional_share, 0.5),
        order: match study {
            Study::One => Vec::new(),
            Study::Two => order(within),
        },
        traits,
        personality,
        high_velocity: latent(Trait::HighVelocity),
        id,
    })
}

fn age_years(group: &Group, study: Study, population: Population, within: usize, seed: u64) -> u32 {
    let pair = (within / 2).to_string();
    let mut rng = stream(
        seed,
        &["age", study.as_str(), population.as_str(), pair.as_str()],
    );
    // A truncated normal: redraw, at most a handful of times, then take the edge.
    let deviation = (0..8)
        .map(|_| normal(&mut rng))
        .find(|z| z.abs() <= 1.5)
        .unwrap_or(1.5);
    let sign = if within.is_multiple_of(2) { 1.0 } else { -1.0 };
    (group.mean_age_years + sign * deviation * group.sd_age_years)
        .round()
        .clamp(18.0, 120.0) as u32
}

/// The order of the conditions: a row of a Latin square in which each condition follows each other one once.
///
/// # Source
/// Williams (1949). The paper says only that participants experience all four; the method says in random order.
fn order(within: usize) -> Vec<ConditionId> {
    const FIRST_ROW: [usize; 4] = [0, 1, 3, 2];
    FIRST_ROW
        .iter()
        .map(|column| ConditionId::AV[(column + within) % 4])
        .collect()
}

fn drives(
    participant: &Participant,
    seed: u64,
    settings: &CohortSettings,
) -> Result<Vec<PlannedDrive>, ParticipantError> {
    let conditions: &[ConditionId] = if participant.professional {
        &[
            ConditionId::OWN,
            ConditionId::AGGRESSIVE,
            ConditionId::CAUTIOUS,
        ]
    } else {
        &[ConditionId::OWN]
    };
    let plan = |&condition: &ConditionId| {
        let mut rng = stream(seed, &[participant.id.as_str(), "role", condition.as_str()]);
        let level = settings.role_aggressiveness;
        let mut traits = participant.traits;
        match condition {
            ConditionId::AGGRESSIVE => {
                traits.aggressiveness = level + settings.role_sd * normal(&mut rng);
            }
            ConditionId::CAUTIOUS => {
                traits.aggressiveness = -level + settings.role_sd * normal(&mut rng);
            }
            _ => {}
        }
        Ok(PlannedDrive {
            drive: DriveId::new(format!("{}-{condition}", participant.id))?,
            participant: participant.id.clone(),
            study: participant.study,
            condition,
            traits,
        })
    };
    conditions.iter().map(plan).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paper() -> Cohort {
        Cohort::draw(30, 24, 7, &CohortSettings::default()).unwrap()
    }

    fn people(
        cohort: &Cohort,
        study: Study,
        population: Population,
    ) -> impl Iterator<Item = &Participant> {
        cohort
            .participants
            .iter()
            .filter(move |p| p.study == study && p.population == population)
    }

    #[test]
    fn the_cohort_is_as_the_paper_describes_it() {
        let cohort = paper();
        for (study, population, n, age, women) in [
            (Study::One, Population::Internal, 30, 35.4, 8),
            (Study::Two, Population::Internal, 12, 34.42, 4),
            (Study::Two, Population::External, 12, 43.92, 5),
        ] {
            let group: Vec<&Participant> = people(&cohort, study, population).collect();
            assert_eq!(group.len(), n);
            assert_eq!(
                group.iter().filter(|p| p.gender == Gender::Female).count(),
                women
            );
            let mean = group.iter().map(|p| f64::from(p.age_years)).sum::<f64>() / n as f64;
            assert!((mean - age).abs() < 0.6, "{mean}");
        }
        let professionals = cohort.participants.iter().filter(|p| p.professional);
        assert_eq!(professionals.count(), 4);
        assert_eq!(
            cohort
                .drives
                .iter()
                .filter(|d| d.study == Study::One)
                .count(),
            38
        );
    }

    #[test]
    fn professionals_keep_everything_but_aggressiveness_in_a_role() {
        let cohort = paper();
        for drive in &cohort.drives {
            let own = cohort.find(&drive.participant).unwrap().traits;
            assert!((drive.traits.spacing - own.spacing).abs() < 1e-12);
            assert!((drive.traits.pace - own.pace).abs() < 1e-12);
            let a = drive.traits.aggressiveness;
            match drive.condition {
                ConditionId::AGGRESSIVE => assert!((a - 1.9).abs() < 1.0),
                ConditionId::CAUTIOUS => assert!((a + 1.9).abs() < 1.0),
                _ => assert!((a - own.aggressiveness).abs() < 1e-12),
            }
        }
    }

    #[test]
    fn a_larger_study_starts_with_the_same_people() {
        let small = Cohort::draw(4, 2, 7, &CohortSettings::default()).unwrap();
        assert_eq!(small.participants[..4], paper().participants[..4]);
        assert_eq!(small.participants[4..], paper().participants[30..32]);
        assert_eq!(
            small.participants.iter().filter(|p| p.professional).count(),
            1
        );
        assert_eq!(small.drives.len(), 8);
    }

    #[test]
    fn any_small_number_works() {
        for n in 0..4 {
            let cohort = Cohort::draw(n, 3 - n, 1, &CohortSettings::default()).unwrap();
            assert_eq!(cohort.participants.len(), 3);
        }
    }

    #[test]
    fn each_condition_has_each_place_and_predecessor_equally_often() {
        let cohort = paper();
        let mut places = [[0; 4]; 4];
        let mut successions = [[0; 4]; 4];
        let number = |c: &ConditionId| ConditionId::AV.iter().position(|x| x == c).unwrap();
        for p in cohort.participants.iter().filter(|p| p.study == Study::Two) {
            for (place, condition) in p.order.iter().enumerate() {
                places[place][number(condition)] += 1;
            }
            for pair in p.order.windows(2) {
                successions[number(&pair[0])][number(&pair[1])] += 1;
            }
        }
        assert!(places.iter().flatten().all(|&n| n == 6), "{places:?}");
        for (i, row) in successions.iter().enumerate() {
            for (j, &n) in row.iter().enumerate() {
                assert_eq!(n, if i == j { 0 } else { 6 });
            }
        }
    }

    #[test]
    fn another_seed_draws_other_people() {
        let other = Cohort::draw(1, 0, 8, &CohortSettings::default()).unwrap();
        assert_ne!(other.participants[0].traits, paper().participants[0].traits);
    }

    #[test]
    fn impossible_settings_are_named() {
        let mut settings = CohortSettings::default();
        settings.study1.female_share = f64::NAN;
        let error = Cohort::draw(1, 1, 1, &settings).unwrap_err();
        assert!(error.to_string().contains("study1.female_share"));
    }
}
