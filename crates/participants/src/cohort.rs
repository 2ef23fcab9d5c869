//! Who takes part.

use crate::{
    error::ParticipantError,
    part::Part,
    person::{Gender, Participant, Personality, Population, Trait},
    response::{normal, stream},
    settings::{CohortSettings, Group},
    trait_mixing::TraitMixing,
};
use maveric_domain::{
    ConditionId, Design, DriveId, LatentTraits, Occasion, ParticipantId, Ride,
    design::{By, Condition, williams},
};
use serde::{Deserialize, Serialize};

/// A drive by hand that somebody is to make, and the traits to make it with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlannedDrive {
    /// Such as `S1P04-aggressive`.
    pub drive: DriveId,
    pub participant: ParticipantId,
    /// What the person takes part in.
    pub part: Part,
    /// Whether the drive shows a role, and not the person's own style.
    pub role: bool,
    /// The baseline, or the role that a professional demonstrates.
    pub condition: ConditionId,
    /// In which session: whoever is learned from has one.
    pub occasion: Occasion,
    /// The person's traits; in a role with another aggressiveness.
    pub traits: LatentTraits,
}

/// The participants of a study and the drives they make by hand.
#[derive(Debug, Clone, PartialEq)]
pub struct Cohort {
    /// Those who are learned from, then those who are tested, by number.
    pub participants: Vec<Participant>,
    /// How many of them are learned from.
    pub learners: usize,
    /// In the order of the participants; own drive first, then a professional's roles.
    pub drives: Vec<PlannedDrive>,
    /// What they were drawn by.
    pub settings: CohortSettings,
}

impl Cohort {
    /// Draws `learn` + `test` people, `S1P01`… and `S2P01`…, for the conditions and roles of a design.
    ///
    /// Each person depends on the seed and their own number alone: a larger study starts with the same people. Shares
    /// (women, professionals) are met by rounding as numbers go up: 8 women and 4 professionals of 30, 4 and 5 women of 12.
    /// Neighbours within a group share the size of their deviation from the mean age, with opposite signs, so that the mean
    /// of an even group is as given.
    ///
    /// # Errors
    /// [`ParticipantError::BadSetting`].
    pub fn draw(
        learn: usize,
        test: usize,
        seed: u64,
        settings: &CohortSettings,
        design: &Design,
    ) -> Result<Self, ParticipantError> {
        let mixing = TraitMixing::new(settings)?;
        let mut cohort = Self {
            participants: Vec::new(),
            learners: learn,
            drives: Vec::new(),
            settings: settings.clone(),
        };
        for (part, n) in [(Part::Learn, learn), (Part::Test, test)] {
            for index in 0..n {
                let participant = person(part, index, seed, settings, &mixing, design)?;
                let drives = drives(&participant, part, seed, settings, design)?;
                cohort.drives.extend(drives);
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
    part: Part,
    index: usize,
    seed: u64,
    settings: &CohortSettings,
    mixing: &TraitMixing,
    design: &Design,
) -> Result<Participant, ParticipantError> {
    let id = ParticipantId::new(format!("S{}P{:02}", part.number(), index + 1))?;
    let (population, within) = match part {
        Part::Learn => (Population::Internal, index),
        Part::Test if index.is_multiple_of(2) => (Population::Internal, index / 2),
        Part::Test => (Population::External, index / 2),
    };
    let group = settings.group(part, population);
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
        population,
        age_years: age_years(group, part, population, within, seed),
        gender: if picked(within, group.female_share, 0.0) { Gender::Female } else { Gender::Male },
        professional: part == Part::Learn && picked(index, settings.professional_share, 0.5),
        order: match part {
            Part::Learn => Vec::new(),
            Part::Test => order(within, design),
        },
        traits,
        personality,
        high_velocity: latent(Trait::HighVelocity),
        id,
    })
}

fn age_years(group: &Group, part: Part, population: Population, within: usize, seed: u64) -> u32 {
    let pair = (within / 2).to_string();
    let mut rng = stream(seed, &["age", part.number(), population.as_str(), pair.as_str()]);
    // A truncated normal: redraw, at most a handful of times, then take the edge.
    let deviation = (0..8).map(|_| normal(&mut rng)).find(|z| z.abs() <= 1.5).unwrap_or(1.5);
    let sign = if within.is_multiple_of(2) { 1.0 } else { -1.0 };
    (group.mean_age_years + sign * deviation * group.sd_age_years).round().clamp(18.0, 120.0) as u32
}

/// The order of the conditions. The paper says only that participants experience all four; the method says in random order.
fn order(within: usize, design: &Design) -> Vec<ConditionId> {
    let ids: Vec<ConditionId> = design.condition_ids().collect();
    williams(ids.len(), within).into_iter().map(|place| ids[place]).collect()
}

/// The baseline by hand, and a professional's roles; without a baseline whoever is learned from drives the roles. A role lies
/// on the side of the dial on which the condition of its name lies.
fn drives(
    participant: &Participant,
    part: Part,
    seed: u64,
    settings: &CohortSettings,
    design: &Design,
) -> Result<Vec<PlannedDrive>, ParticipantError> {
    let by_hand = design.baseline().filter(|b| b.by == By::Hand);
    let in_roles = part == Part::Learn && (participant.professional || by_hand.is_none());
    let roles = design.roles().iter().filter(|_| in_roles);
    let by_hand = by_hand.into_iter().flat_map(|b| {
        let occasions = match part {
            Part::Learn => vec![Occasion::FIRST],
            Part::Test => design.occasions(b.id),
        };
        occasions.into_iter().map(|on| (b.id, on, false))
    });
    let plan = |(condition, occasion, role): (ConditionId, Occasion, bool)| {
        let mut rng = stream(seed, &[participant.id.as_str(), "role", condition.as_str()]);
        let level = settings.role_aggressiveness;
        let mut traits = participant.traits;
        let side = design.condition(condition).and_then(Condition::side);
        if let Some(side) = side.filter(|_| role) {
            traits.aggressiveness = side.factor() * level + settings.role_sd * normal(&mut rng);
        }
        Ok(PlannedDrive {
            drive: DriveId::in_condition(&participant.id, Ride { condition, occasion })?,
            participant: participant.id.clone(),
            part,
            role,
            condition,
            occasion,
            traits,
        })
    };
    let roles = roles.map(|r| (r.id, Occasion::FIRST, true));
    by_hand.chain(roles).map(plan).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{conditions, design};

    fn paper() -> Cohort {
        Cohort::draw(30, 24, 7, &CohortSettings::default(), &design()).unwrap()
    }

    fn people(
        cohort: &Cohort,
        part: Part,
        population: Population,
    ) -> impl Iterator<Item = &Participant> {
        let (learn, test) = cohort.participants.split_at(cohort.learners);
        let these = if part == Part::Learn { learn } else { test };
        these.iter().filter(move |p| p.population == population)
    }

    #[test]
    fn the_cohort_is_as_the_paper_describes_it() {
        let cohort = paper();
        for (part, population, n, age, women) in [
            (Part::Learn, Population::Internal, 30, 35.4, 8),
            (Part::Test, Population::Internal, 12, 34.42, 4),
            (Part::Test, Population::External, 12, 43.92, 5),
        ] {
            let group: Vec<&Participant> = people(&cohort, part, population).collect();
            assert_eq!(group.len(), n);
            assert_eq!(group.iter().filter(|p| p.gender == Gender::Female).count(), women);
            let mean = group.iter().map(|p| f64::from(p.age_years)).sum::<f64>() / n as f64;
            assert!((mean - age).abs() < 0.6, "{mean}");
        }
        let professionals = cohort.participants.iter().filter(|p| p.professional);
        assert_eq!(professionals.count(), 4);
        assert_eq!(cohort.drives.iter().filter(|d| d.part == Part::Learn).count(), 38);
    }

    #[test]
    fn professionals_keep_everything_but_aggressiveness_in_a_role() {
        let cohort = paper();
        for drive in &cohort.drives {
            let own = cohort.find(&drive.participant).unwrap().traits;
            assert!((drive.traits.spacing - own.spacing).abs() < 1e-12);
            assert!((drive.traits.pace - own.pace).abs() < 1e-12);
            let a = drive.traits.aggressiveness;
            match drive.condition.as_str() {
                "aggressive" => assert!((a - 1.9).abs() < 1.0),
                "cautious" => assert!((a + 1.9).abs() < 1.0),
                _ => assert!((a - own.aggressiveness).abs() < 1e-12),
            }
        }
    }

    #[test]
    fn a_larger_study_starts_with_the_same_people() {
        let small = Cohort::draw(4, 2, 7, &CohortSettings::default(), &design()).unwrap();
        assert_eq!(small.participants[..4], paper().participants[..4]);
        assert_eq!(small.participants[4..], paper().participants[30..32]);
        assert_eq!(small.participants.iter().filter(|p| p.professional).count(), 1);
        assert_eq!(small.drives.len(), 8);
    }

    #[test]
    fn any_small_number_works() {
        for n in 0..4 {
            let cohort = Cohort::draw(n, 3 - n, 1, &CohortSettings::default(), &design()).unwrap();
            assert_eq!(cohort.participants.len(), 3);
        }
    }

    #[test]
    fn each_condition_has_each_place_and_predecessor_equally_often() {
        let cohort = paper();
        let mut places = [[0; 4]; 4];
        let mut successions = [[0; 4]; 4];
        let all = conditions();
        let number = |c: &ConditionId| all.iter().position(|x| x == c).unwrap();
        for p in &cohort.participants[cohort.learners..] {
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
        let other = Cohort::draw(1, 0, 8, &CohortSettings::default(), &design()).unwrap();
        assert_ne!(other.participants[0].traits, paper().participants[0].traits);
    }

    #[test]
    fn impossible_settings_are_named() {
        let mut settings = CohortSettings::default();
        settings.study1.female_share = f64::NAN;
        let error = Cohort::draw(1, 1, 1, &settings, &design()).unwrap_err();
        assert!(error.to_string().contains("study1.female_share"));
    }

    fn with_conditions(ids: &[&str]) -> Design {
        let conditions = ids.iter().map(|id| format!("[[condition]]\nid = \"{id}\"\n"));
        let text = format!("[study]\ntitle = \"x\"\n{}", conditions.collect::<String>());
        Design::from_toml(&text).unwrap()
    }

    #[test]
    fn three_conditions_are_balanced_over_six_people_and_nobody_drives_what_the_design_has_not() {
        let design = with_conditions(&["calm", "normal", "sporty"]);
        let cohort = Cohort::draw(2, 12, 7, &CohortSettings::default(), &design).unwrap();
        assert!(cohort.drives.is_empty());
        let mut follows = [[0; 3]; 3];
        let number = |c: &ConditionId| design.condition(*c).unwrap().place;
        for p in &cohort.participants[2..] {
            for pair in p.order.windows(2) {
                follows[number(&pair[0])][number(&pair[1])] += 1;
            }
        }
        for (i, row) in follows.iter().enumerate() {
            for (j, &n) in row.iter().enumerate() {
                assert_eq!(n, if i == j { 0 } else { 4 }, "{follows:?}");
            }
        }
        let one = with_conditions(&["calm"]);
        let cohort = Cohort::draw(0, 3, 7, &CohortSettings::default(), &one).unwrap();
        assert!(cohort.participants.iter().all(|p| p.order.len() == 1));
    }
}
