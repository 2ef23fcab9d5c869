//! What people answer before the drives.

use crate::{
    cohort::{Cohort, PlannedDrive},
    effects::{AdbModel, Effects, FactorModel},
    error::ParticipantError,
    person::Participant,
    response::{as_given, grade, maybe_left_out, normal, stream, with_total},
};
use maveric_domain::{Answer, Condition, LatentTraits, Moment, Scale, Subscale};
use std::collections::{BTreeMap, BTreeSet};

/// Code name of the scale whose total, not whose items, follows the person's aggressiveness.
pub const ADB: &str = "adb";

/// The answers of a whole cohort before the drives, and of the professionals in their roles.
///
/// Everybody answers the ADB scale and every scale that [`Effects::answers`] knows, at [`Moment::Pre`]; professionals
/// answer the ADB scale again after each role, as the person they played. Other scales in `scales` are not asked. Ordered by participant,
/// moment, scale as given and item. Each answer depends on the seed, the person, the moment and the subscale alone.
///
/// # Errors
/// [`ParticipantError::BadSetting`], [`ParticipantError::UnknownSubscale`], [`ParticipantError::ItemTwice`],
/// [`ParticipantError::ItemWithoutModel`] or [`ParticipantError::Domain`] where effects or scales do not fit.
///
/// # Source
/// Method section 7; calibration section 2 for the ADB total.
pub fn answer_before(
    cohort: &Cohort,
    scales: &[Scale],
    effects: &Effects,
    seed: u64,
) -> Result<Vec<Answer>, ParticipantError> {
    effects.check()?;
    check_coverage(scales, effects)?;
    let mut answers = Vec::new();
    for participant in &cohort.participants {
        for scale in scales {
            if scale.id == ADB {
                let traits = &participant.traits;
                answers.extend(adb(participant, traits, Moment::Pre, scale, effects, seed));
            } else if let Some(models) = effects.answers.get(&scale.id) {
                answers.extend(graded(participant, scale, models, effects, seed));
            }
        }
        let roles = cohort
            .drives
            .iter()
            .filter(|d| d.participant == participant.id && d.condition != Condition::Own);
        for PlannedDrive {
            condition, traits, ..
        } in roles
        {
            for scale in scales.iter().filter(|s| s.id == ADB) {
                let moment = Moment::After(*condition);
                answers.extend(adb(participant, traits, moment, scale, effects, seed));
            }
        }
    }
    Ok(answers)
}

fn check_coverage(scales: &[Scale], effects: &Effects) -> Result<(), ParticipantError> {
    for scale in scales {
        scale.validate()?;
    }
    for (id, models) in &effects.answers {
        let Some(scale) = scales.iter().find(|s| s.id == *id) else {
            let subscale = models.keys().next().cloned().unwrap_or_default();
            return Err(ParticipantError::UnknownSubscale {
                scale: id.clone(),
                subscale,
            });
        };
        covered_once(scale, models.keys())?;
    }
    Ok(())
}

/// Whether each item belongs to exactly one of the subscales named.
pub(crate) fn covered_once<'a>(
    scale: &Scale,
    subscales: impl Iterator<Item = &'a String>,
) -> Result<(), ParticipantError> {
    let mut seen = BTreeSet::new();
    for id in subscales {
        for &item in &subscale_of(scale, id)?.items {
            if !seen.insert(item) {
                return Err(ParticipantError::ItemTwice {
                    scale: scale.id.clone(),
                    item,
                });
            }
        }
    }
    match (1..=scale.items).find(|i| !seen.contains(i)) {
        Some(item) => Err(ParticipantError::ItemWithoutModel {
            scale: scale.id.clone(),
            item,
        }),
        None => Ok(()),
    }
}

pub(crate) fn subscale_of<'a>(
    scale: &'a Scale,
    id: &str,
) -> Result<&'a Subscale, ParticipantError> {
    let found = scale.subscales.iter().find(|s| s.id == id);
    found.ok_or_else(|| ParticipantError::UnknownSubscale {
        scale: scale.id.clone(),
        subscale: id.to_owned(),
    })
}

/// The ADB scale: a total that follows aggressiveness, spread over the items.
fn adb(
    participant: &Participant,
    traits: &LatentTraits,
    moment: Moment,
    scale: &Scale,
    effects: &Effects,
    seed: u64,
) -> Vec<Answer> {
    let AdbModel {
        mean_points,
        sd_points,
        aggressiveness: loading,
        item_sd,
    } = effects.adb;
    let moment_name = moment.to_string();
    let mut rng = stream(seed, &[participant.id.as_str(), ADB, moment_name.as_str()]);
    let noise = (1.0 - loading * loading).max(0.0).sqrt();
    let z = loading * traits.aggressiveness + noise * normal(&mut rng);
    let total = (mean_points + sd_points * z).round() as i64;
    // The first subscale is the total; only its key matters here.
    let total_scale = &scale.subscales[0];
    let scored = with_total(scale, scale.items as usize, total, item_sd, &mut rng);
    (1..=scale.items)
        .zip(scored)
        .map(|(item, answer)| {
            let given = as_given(scale, total_scale, item, answer);
            Answer {
                participant: participant.id.clone(),
                moment,
                scale: scale.id.clone(),
                item,
                answer: maybe_left_out(&mut rng, effects.missing_rate, given),
            }
        })
        .collect()
}

/// Any other scale: each subscale a factor, each item a graded response to it.
fn graded(
    participant: &Participant,
    scale: &Scale,
    models: &BTreeMap<String, FactorModel>,
    effects: &Effects,
    seed: u64,
) -> Vec<Answer> {
    let mut answers = Vec::new();
    for subscale in &scale.subscales {
        let Some(model) = models.get(&subscale.id) else {
            continue;
        };
        let labels = [
            participant.id.as_str(),
            "pre",
            scale.id.as_str(),
            subscale.id.as_str(),
        ];
        let mut rng = stream(seed, &labels);
        let known: f64 = model
            .loadings
            .iter()
            .map(|(name, loading)| loading * participant.latent(*name))
            .sum();
        let explained: f64 = model.loadings.values().map(|l| l * l).sum();
        let factor = known + (1.0 - explained).max(0.0).sqrt() * normal(&mut rng);
        let noise = (1.0 - model.item_loading.powi(2)).max(0.0).sqrt();
        for &item in &subscale.items {
            let latent = model.item_loading * factor + noise * normal(&mut rng);
            let scored = grade(scale, model.mean + model.sd * latent);
            let given = as_given(scale, subscale, item, scored);
            answers.push(Answer {
                participant: participant.id.clone(),
                moment: Moment::Pre,
                scale: scale.id.clone(),
                item,
                answer: maybe_left_out(&mut rng, effects.missing_rate, given),
            });
        }
    }
    answers.sort_by_key(|a| a.item);
    answers
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{settings::CohortSettings, testing::*};

    fn everybody(n1: usize, n2: usize, effects: &Effects) -> (Cohort, Vec<Answer>) {
        let cohort = Cohort::draw(n1, n2, 11, &CohortSettings::default()).unwrap();
        let answers = answer_before(&cohort, &scales(), effects, 11).unwrap();
        (cohort, answers)
    }

    fn complete() -> Effects {
        Effects {
            missing_rate: 0.0,
            ..effects()
        }
    }

    #[test]
    fn the_adb_total_follows_aggressiveness_as_calibrated() {
        let cohort = Cohort::draw(0, 2000, 11, &CohortSettings::default()).unwrap();
        let scales: Vec<Scale> = scales().into_iter().filter(|s| s.id == ADB).collect();
        let effects = Effects {
            answers: BTreeMap::new(),
            ..complete()
        };
        let answers = answer_before(&cohort, &scales, &effects, 11).unwrap();
        let totals: Vec<f64> = answers
            .chunks(11)
            .map(|items| items.iter().filter_map(|a| a.answer).map(f64::from).sum())
            .collect();
        let a: Vec<f64> = cohort
            .participants
            .iter()
            .map(|p| p.traits.aggressiveness)
            .collect();
        let r = correlation(&a, &totals);
        assert!((r - 0.88).abs() < 0.02, "{r}");
        let mean = totals.iter().sum::<f64>() / 2000.0;
        assert!((mean - 28.0).abs() < 0.7, "{mean}");
        assert!(totals.iter().all(|t| (11.0..=55.0).contains(t)));
        // Cronbach's alpha near that of the publication (.80).
        let variance = |v: &[f64]| {
            let m = v.iter().sum::<f64>() / v.len() as f64;
            v.iter().map(|x| (x - m).powi(2)).sum::<f64>() / (v.len() - 1) as f64
        };
        let items: f64 = (0..11)
            .map(|i| {
                let column: Vec<f64> = answers
                    .iter()
                    .skip(i)
                    .step_by(11)
                    .filter_map(|a| a.answer)
                    .map(f64::from)
                    .collect();
                variance(&column)
            })
            .sum();
        let alpha = 1.1 * (1.0 - items / variance(&totals));
        assert!((0.75..0.92).contains(&alpha), "{alpha}");
    }

    #[test]
    fn professionals_answer_the_adb_again_in_their_roles() {
        let (cohort, answers) = everybody(30, 0, &complete());
        let total = |id, moment| -> i32 {
            let mine = answers
                .iter()
                .filter(|a| a.participant == id && a.moment == moment && a.scale == ADB);
            mine.filter_map(|a| a.answer).sum()
        };
        for p in cohort.participants.iter().filter(|p| p.professional) {
            let up = total(p.id.clone(), Moment::After(Condition::Aggressive));
            let down = total(p.id.clone(), Moment::After(Condition::Cautious));
            assert!(up > 30 && (11..26).contains(&down), "{up} {down}");
        }
        let roles = answers.iter().filter(|a| a.moment != Moment::Pre).count();
        assert_eq!(roles, 4 * 2 * 11);
    }

    #[test]
    fn every_item_of_every_scale_is_answered_once_and_within_range() {
        let (cohort, answers) = everybody(4, 2, &effects());
        let scales = scales();
        for p in &cohort.participants {
            for (id, items) in [
                (ADB, 11),
                ("mdsi", 44),
                ("mini_ipip", 20),
                ("jian_trust", 12),
            ] {
                let mine: Vec<&Answer> = answers
                    .iter()
                    .filter(|a| a.participant == p.id && a.scale == id && a.moment == Moment::Pre)
                    .collect();
                assert!(mine.iter().map(|a| a.item).eq(1..=items), "{id}");
                let scale = scales.iter().find(|s| s.id == id).unwrap();
                assert!(
                    mine.iter()
                        .filter_map(|a| a.answer)
                        .all(|x| (scale.min..=scale.max).contains(&x))
                );
            }
        }
    }

    #[test]
    fn scores_follow_their_traits_through_reversed_items() {
        let (cohort, answers) = everybody(0, 300, &complete());
        let scales = scales();
        let scores = |scale, subscale| -> Vec<f64> {
            let asked: Vec<Answer> = answers
                .iter()
                .filter(|a| a.scale == scale)
                .cloned()
                .collect();
            let people = cohort.participants.iter();
            people
                .map(|p| score(&asked, &scales, &p.id, Moment::Pre, scale, subscale))
                .collect()
        };
        let conscientiousness: Vec<f64> = cohort
            .participants
            .iter()
            .map(|p| p.personality.conscientiousness)
            .collect();
        let r = correlation(
            &conscientiousness,
            &scores("mini_ipip", "conscientiousness"),
        );
        assert!(r > 0.75, "{r}");
        let a: Vec<f64> = cohort
            .participants
            .iter()
            .map(|p| p.traits.aggressiveness)
            .collect();
        assert!(correlation(&a, &scores("mdsi", "risky")) > 0.2);
        assert!(correlation(&a, &scores("mdsi", "careful")) < -0.1);
        // As given, a reversed item goes the other way.
        let item = |n| -> Vec<f64> {
            let column = answers
                .iter()
                .filter(|x| x.scale == "mini_ipip" && x.item == n);
            column.filter_map(|x| x.answer).map(f64::from).collect()
        };
        assert!(correlation(&conscientiousness, &item(3)) > 0.4);
        assert!(correlation(&conscientiousness, &item(8)) < -0.4);
    }

    #[test]
    fn items_are_left_out_at_the_rate_asked_for() {
        let effects = Effects {
            missing_rate: 0.1,
            ..effects()
        };
        let (_, answers) = everybody(0, 60, &effects);
        let share =
            answers.iter().filter(|a| a.answer.is_none()).count() as f64 / answers.len() as f64;
        assert!((share - 0.1).abs() < 0.02, "{share}");
    }

    #[test]
    fn the_same_seed_gives_the_same_answers_whoever_else_takes_part() {
        let (_, few) = everybody(0, 1, &effects());
        let (_, many) = everybody(0, 3, &effects());
        assert_eq!(few[..], many[..few.len()]);
    }

    #[test]
    fn effects_for_an_unknown_subscale_are_refused() {
        let mut effects = effects();
        let model = effects.answers["mdsi"]["risky"].clone();
        effects
            .answers
            .get_mut("mdsi")
            .unwrap()
            .insert("riskly".to_owned(), model);
        let cohort = Cohort::draw(0, 1, 1, &CohortSettings::default()).unwrap();
        let error = answer_before(&cohort, &scales(), &effects, 1).unwrap_err();
        assert!(error.to_string().contains("`mdsi.riskly`"), "{error}");
        effects
            .answers
            .get_mut("mdsi")
            .unwrap()
            .retain(|name, _| name == "angry");
        let error = answer_before(&cohort, &scales(), &effects, 1).unwrap_err();
        assert!(
            matches!(error, ParticipantError::ItemWithoutModel { item: 1, .. }),
            "{error}"
        );
    }
}
