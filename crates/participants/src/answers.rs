//! What people answer before the drives.

use crate::{
    cohort::{Cohort, PlannedDrive},
    coverage::covered,
    effects::{AdbModel, Effects},
    error::ParticipantError,
    item_model::ItemModel,
    person::Participant,
    response::{as_given, grade, maybe_left_out, normal, stream, with_total},
    scale_model::ScaleModel,
    trait_mixing::TraitMixing,
};
use maveric_domain::{Answer, LatentTraits, Moment, Scale};
use rand_pcg::Pcg64;

/// Code name of the scale whose total, not whose items, follows the person's aggressiveness.
pub const ADB: &str = "adb";

/// The answers of a whole cohort before the drives, and of the professionals in their roles.
///
/// Everybody answers the ADB scale and every scale that [`Effects::answers`] knows, at [`Moment::Pre`]; professionals
/// answer the ADB scale again after each role, as the person they played. Other scales in `scales` are not asked. Ordered by participant,
/// moment, scale as given and item. Scores have the means, standard deviations, alphas and correlations that the scales' files give as
/// norms. Each answer depends on the seed, the person, the moment and the scale alone.
///
/// # Errors
/// [`ParticipantError::BadSetting`], [`ParticipantError::UnknownSubscale`], [`ParticipantError::ItemTwice`],
/// [`ParticipantError::ItemWithoutModel`], [`ParticipantError::NoNorms`], [`ParticipantError::BadNorms`] or [`ParticipantError::Domain`]
/// where effects or scales do not fit.
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
    covered(scales, &effects.answers)?;
    let traits = TraitMixing::new(&cohort.settings)?;
    let mut models = Vec::new();
    for scale in scales.iter().filter(|s| s.id != ADB) {
        if let Some(of_scale) = effects.answers.get(&scale.id) {
            models.push(ScaleModel::new(scale, of_scale, &traits)?);
        }
    }
    let mut answers = Vec::new();
    for participant in &cohort.participants {
        for scale in scales {
            if scale.id == ADB {
                let traits = &participant.traits;
                answers.extend(adb(participant, traits, Moment::Pre, scale, effects, seed));
            } else if let Some(model) = models.iter().find(|m| m.scale.id == scale.id) {
                answers.extend(graded(participant, model, effects.missing_rate, seed));
            }
        }
        let roles = cohort.drives.iter().filter(|d| d.participant == participant.id && d.role);
        for PlannedDrive { condition, traits, .. } in roles {
            for scale in scales.iter().filter(|s| s.id == ADB) {
                let moment = Moment::after(*condition);
                answers.extend(adb(participant, traits, moment, scale, effects, seed));
            }
        }
    }
    Ok(answers)
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
    let AdbModel { mean_points, sd_points, aggressiveness: loading, item_sd } = effects.adb;
    let moment_name = moment.to_string();
    let mut rng = stream(seed, &[participant.id.as_str(), ADB, moment_name.as_str()]);
    let noise = (1.0 - loading * loading).max(0.0).sqrt();
    let z = loading * traits.aggressiveness + noise * normal(&mut rng);
    let total = (mean_points + sd_points * z).round() as i64;
    // The first subscale is the total; only its key matters here.
    let total_scale = &scale.subscales[0];
    let scored = with_total(&scale.items, total, item_sd, &mut rng);
    (1..=scale.count())
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
    model: &ScaleModel<'_>,
    missing_rate: f64,
    seed: u64,
) -> Vec<Answer> {
    let scale = model.scale;
    let mut streams: Vec<Pcg64> = model
        .factors
        .iter()
        .map(|f| {
            let labels = [participant.id.as_str(), "pre", &scale.id, &f.subscale.id];
            stream(seed, &labels)
        })
        .collect();
    let draws: Vec<f64> = streams.iter_mut().map(normal).collect();
    let scores = model.scores(participant, &draws);
    let mut answers = Vec::new();
    for ((factor, score), rng) in model.factors.iter().zip(scores).zip(&mut streams) {
        let ItemModel { mean, sd, loading, .. } = factor.item;
        let noise = (1.0 - loading * loading).max(0.0).sqrt();
        for &item in &factor.subscale.items {
            let Some(asked) = scale.item(item) else {
                continue; // checked when the scale was read
            };
            let latent = loading * score + noise * normal(rng);
            let scored = grade(asked, mean + sd * latent);
            let given = as_given(scale, factor.subscale, item, scored);
            answers.push(Answer {
                participant: participant.id.clone(),
                moment: Moment::Pre,
                scale: scale.id.clone(),
                item,
                answer: maybe_left_out(rng, missing_rate, given),
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
    use std::collections::BTreeMap;

    fn everybody(n1: usize, n2: usize, effects: &Effects) -> (Cohort, Vec<Answer>) {
        let cohort =
            Cohort::draw(n1, n2, 11, &CohortSettings::default(), &crate::testing::design())
                .unwrap();
        let answers = answer_before(&cohort, &scales(), effects, 11).unwrap();
        (cohort, answers)
    }

    fn complete() -> Effects {
        Effects { missing_rate: 0.0, ..effects() }
    }

    #[test]
    fn the_adb_total_follows_aggressiveness_as_calibrated() {
        let cohort =
            Cohort::draw(0, 2000, 11, &CohortSettings::default(), &crate::testing::design())
                .unwrap();
        let scales: Vec<Scale> = scales().into_iter().filter(|s| s.id == ADB).collect();
        let effects = Effects { answers: BTreeMap::new(), ..complete() };
        let answers = answer_before(&cohort, &scales, &effects, 11).unwrap();
        let totals: Vec<f64> = answers
            .chunks(11)
            .map(|items| items.iter().filter_map(|a| a.answer).map(f64::from).sum())
            .collect();
        let a: Vec<f64> = cohort.participants.iter().map(|p| p.traits.aggressiveness).collect();
        let r = correlation(&a, &totals);
        assert!((r - 0.88).abs() < 0.02, "{r}");
        let mean = totals.iter().sum::<f64>() / 2000.0;
        assert!((mean - 28.0).abs() < 0.7, "{mean}");
        assert!(totals.iter().all(|t| (11.0..=55.0).contains(t)));
        // Cronbach's alpha is that of the scale's file.
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
        let norms = scales[0].subscales[0].norms.as_ref().unwrap();
        assert!((alpha - norms.alpha).abs() < 0.02, "{alpha}");
        assert!(
            (mean - norms.mean).abs() < 0.7 && (variance(&totals).sqrt() - norms.sd).abs() < 0.3
        );
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
            let up = total(p.id.clone(), Moment::after(id("aggressive")));
            let down = total(p.id.clone(), Moment::after(id("cautious")));
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
            for (id, items) in [(ADB, 11), ("mdsi", 44), ("mini_ipip", 20), ("jian_trust", 12)] {
                let mine: Vec<&Answer> = answers
                    .iter()
                    .filter(|a| a.participant == p.id && a.scale == id && a.moment == Moment::Pre)
                    .collect();
                assert!(mine.iter().map(|a| a.item).eq(1..=items), "{id}");
                let scale = scales.iter().find(|s| s.id == id).unwrap();
                assert!(mine.iter().filter_map(|a| a.answer).all(|x| scale.items[0].takes(x)));
            }
        }
    }

    #[test]
    fn scores_follow_their_traits_through_reversed_items() {
        let (cohort, answers) = everybody(0, 300, &complete());
        let scales = scales();
        let scores = |scale, subscale| -> Vec<f64> {
            let asked: Vec<Answer> = answers.iter().filter(|a| a.scale == scale).cloned().collect();
            let people = cohort.participants.iter();
            people.map(|p| score(&asked, &scales, &p.id, Moment::Pre, scale, subscale)).collect()
        };
        let conscientiousness: Vec<f64> =
            cohort.participants.iter().map(|p| p.personality.conscientiousness).collect();
        let r = correlation(&conscientiousness, &scores("mini_ipip", "conscientiousness"));
        assert!(r > 0.7, "{r}");
        let a: Vec<f64> = cohort.participants.iter().map(|p| p.traits.aggressiveness).collect();
        assert!(correlation(&a, &scores("mdsi", "risky")) > 0.2);
        assert!(correlation(&a, &scores("mdsi", "careful")) < -0.1);
        // As given, a reversed item goes the other way.
        let item = |n| -> Vec<f64> {
            let column = answers.iter().filter(|x| x.scale == "mini_ipip" && x.item == n);
            column.filter_map(|x| x.answer).map(f64::from).collect()
        };
        assert!(correlation(&conscientiousness, &item(3)) > 0.4);
        assert!(correlation(&conscientiousness, &item(8)) < -0.4);
    }

    #[test]
    fn five_thousand_people_have_the_means_spreads_alphas_and_correlations_of_the_norms() {
        let n = 5000;
        let cohort =
            Cohort::draw(0, n, 5, &CohortSettings::default(), &crate::testing::design()).unwrap();
        let scales = scales();
        let answers = answer_before(&cohort, &scales, &complete(), 5).unwrap();
        let variance = |v: &[f64]| {
            let m = v.iter().sum::<f64>() / v.len() as f64;
            v.iter().map(|x| (x - m).powi(2)).sum::<f64>() / (v.len() - 1) as f64
        };
        for scale in scales.iter().filter(|s| effects().answers.contains_key(&s.id)) {
            let mine = answers.iter().filter(|a| a.scale == scale.id);
            let mut columns = vec![Vec::new(); scale.items.len()];
            for answer in mine {
                columns[answer.item as usize - 1].push(f64::from(answer.answer.unwrap()));
            }
            let mut scores: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
            for subscale in &scale.subscales {
                let Some(norms) = &subscale.norms else {
                    continue;
                };
                let k = subscale.items.len() as f64;
                let items: Vec<Vec<f64>> = subscale
                    .items
                    .iter()
                    .map(|&item| {
                        let turn = f64::from(scale.items[0].min + scale.items[0].max);
                        let column = columns[item as usize - 1].iter();
                        let reversed = scale.is_reversed(subscale, item);
                        column.map(|x| if reversed { turn - x } else { *x }).collect()
                    })
                    .collect();
                let score: Vec<f64> =
                    (0..n).map(|p| items.iter().map(|i| i[p]).sum::<f64>() / k).collect();
                let name = format!("{}.{}", scale.id, subscale.id);
                let mean = score.iter().sum::<f64>() / n as f64;
                let total = variance(&score);
                let alpha = k / (k - 1.0)
                    * (1.0 - items.iter().map(|i| variance(i)).sum::<f64>() / (k * k * total));
                // Four standard errors or so of 5,000 people.
                assert!((mean - norms.mean).abs() < 0.06 * norms.sd, "{name}: mean {mean}");
                assert!(
                    (total.sqrt() / norms.sd - 1.0).abs() < 0.04,
                    "{name}: sd {}",
                    total.sqrt()
                );
                assert!((alpha - norms.alpha).abs() < 0.03, "{name}: alpha {alpha}");
                scores.insert(&subscale.id, score);
            }
            for pair in &scale.correlations {
                let r = correlation(&scores[pair.of[0].as_str()], &scores[pair.of[1].as_str()]);
                assert!((r - pair.r).abs() < 0.05, "{}: {:?} {r}", scale.id, pair.of);
            }
        }
    }

    #[test]
    fn items_are_left_out_at_the_rate_asked_for() {
        let effects = Effects { missing_rate: 0.1, ..effects() };
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
        effects.answers.get_mut("mdsi").unwrap().insert("riskly".to_owned(), model);
        let cohort =
            Cohort::draw(0, 1, 1, &CohortSettings::default(), &crate::testing::design()).unwrap();
        let error = answer_before(&cohort, &scales(), &effects, 1).unwrap_err();
        assert!(error.to_string().contains("`mdsi.riskly`"), "{error}");
        effects.answers.get_mut("mdsi").unwrap().retain(|name, _| name == "angry");
        let error = answer_before(&cohort, &scales(), &effects, 1).unwrap_err();
        assert!(matches!(error, ParticipantError::ItemWithoutModel { item: 1, .. }), "{error}");
    }
}
