use super::*;
use crate::testing::*;
use maveric_domain::spread;

#[test]
fn a_rating_adds_up_what_each_part_of_the_impression_is_worth() {
    let model = RatingModel {
        mean: 4.0,
        preference: 2.0,
        homophily: 3.0,
        shift: 5.0,
        distance: -7.0,
        order: 11.0,
        carry_over: 17.0,
        liking: 0.25,
        halo_condition: 0.5,
        halo_person: 13.0,
        person_sd: 9.0,
        noise_sd: 9.0,
        item_sd: 9.0,
    };
    let found = model.latent(&Impression {
        fit: -1.0,
        likeness: -0.1,
        shift: 0.01,
        distance: 0.001,
        place: 1e-4,
        halo_condition: 2.0,
        halo_person: 1e-5,
    });
    let expected = 4.0 - 2.0 - 0.3 + 0.05 - 0.007 + 0.0011 + 1.5 + 0.000_13;
    assert!((found - expected).abs() < 1e-12, "{found}");
}

#[test]
fn a_share_of_the_drive_before_is_left_in_the_next_rating_and_none_in_the_first() {
    let carried = |share: f64| {
        let mut effects = effects();
        let scale = effects.ratings.get_mut("aggressiveness").unwrap();
        scale.get_mut("aggressiveness").unwrap().carry_over = share;
        TestStudy::run(40, 3, &effects)
    };
    let (with, without) = (carried(0.8), carried(0.0));
    let conditions = [id("mimic"), id("aggressive"), id("cautious")];
    let changes = |of: ConditionId| {
        let rated = |study: &TestStudy| {
            study.scores(Moment::After(of.into()), "aggressiveness", "aggressiveness")
        };
        let pairs = rated(&with).into_iter().zip(rated(&without));
        pairs.map(|(with, without)| with - without).collect::<Vec<f64>>()
    };
    let (mut first, mut after) = (Vec::new(), BTreeMap::new());
    for condition in conditions {
        let people = &with.cohort.participants;
        for (person, change) in people.iter().zip(changes(condition)) {
            let place = person.order.iter().position(|c| *c == condition).unwrap();
            match place.checked_sub(1) {
                None => first.push(change),
                Some(before) => {
                    let before = person.order[before];
                    after.entry(before).or_insert_with(Vec::new).push(change);
                }
            }
        }
    }
    assert!(!first.is_empty() && first.iter().all(|change| *change == 0.0));
    let left = |of: &str| mean(&after[&id(of)]);
    assert!(left("aggressive") > 0.1, "{}", left("aggressive"));
    assert!(left("cautious") < -0.1, "{}", left("cautious"));
}

/// Mean correlation over studies of 24 of a trait's score with a difference of ratings.
fn mean_r(
    studies: &[TestStudy],
    before: (&str, &str),
    other: ConditionId,
    after: (&str, &str),
) -> f64 {
    let r = |study: &TestStudy| {
        let x = study.scores(Moment::Pre, before.0, before.1);
        correlation(&x, &study.mimic_minus(other, after.0, after.1))
    };
    studies.iter().map(r).sum::<f64>() / studies.len() as f64
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

const OUTCOMES: [(&str, &str, f64); 4] = [
    ("rosas", "competence", 1.0),
    ("godspeed_intelligence", "intelligence", 1.0),
    ("jian_trust", "overall", 1.0),
    ("rosas", "discomfort", -1.0),
];

#[test]
fn the_papers_correlations_come_out_with_their_signs() {
    let effects = effects();
    let studies: Vec<TestStudy> = (0..20).map(|s| TestStudy::run(24, s, &effects)).collect();
    let conscientious = ("mini_ipip", "conscientiousness");
    for (scale, subscale, sign) in OUTCOMES {
        let outcome = (scale, subscale);
        for other in [id("cautious"), id("aggressive")] {
            let r = sign * mean_r(&studies, conscientious, other, outcome);
            assert!((-0.75..-0.15).contains(&r), "{other} {subscale}: {r}");
        }
        let r = sign * mean_r(&studies, ("mdsi", "high_velocity"), id("aggressive"), outcome);
        assert!((-0.75..-0.15).contains(&r), "high velocity {subscale}: {r}");
    }
    let r = mean_r(&studies, ("mini_ipip", "openness"), id("aggressive"), ("rosas", "discomfort"));
    assert!((0.1..0.6).contains(&r), "openness: {r}");
    for (scale, subscale, sign) in OUTCOMES {
        let over_conditions = |s: &TestStudy, scale: &str, subscale: &str| -> Vec<f64> {
            let after = |c: &ConditionId| s.scores(Moment::after(*c), scale, subscale);
            conditions().iter().flat_map(after).collect()
        };
        let r = |s: &TestStudy| {
            correlation(
                &over_conditions(s, "similarity", "similarity"),
                &over_conditions(s, scale, subscale),
            )
        };
        let r = sign * mean(&studies.iter().map(r).collect::<Vec<_>>());
        assert!((0.05..0.5).contains(&r), "similarity {subscale}: {r}");
    }
}

#[test]
fn aggressive_is_called_more_and_cautious_less_aggressive_than_mimic() {
    let study = TestStudy::run(200, 3, &effects());
    let scale = ("aggressiveness", "aggressiveness");
    let mimic = mean(&study.scores(Moment::after(id("mimic")), scale.0, scale.1));
    assert!((mimic - 4.0).abs() < 0.2, "{mimic}");
    let above = mean(&study.mimic_minus(id("aggressive"), scale.0, scale.1));
    let below = mean(&study.mimic_minus(id("cautious"), scale.0, scale.1));
    assert!(above < -0.4 && below > 0.4, "{above} {below}");
}

#[test]
fn a_part_of_the_people_prefer_another_style_than_their_own() {
    let study = TestStudy::run(400, 4, &effects());
    for (other, low) in [(id("aggressive"), 0.12), (id("cautious"), 0.2)] {
        let differences = study.mimic_minus(other, "jian_trust", "overall");
        let share = differences.iter().filter(|d| **d < 0.0).count() as f64 / 400.0;
        assert!((low..0.5).contains(&share), "{other}: {share}");
    }
}

#[test]
fn without_effects_ratings_know_nothing_of_condition_trait_or_similarity() {
    let study = TestStudy::run(600, 5, &effects().without_effects());
    // 3.3 standard errors of r, and of a mean difference.
    let bound = 3.3 / 600_f64.sqrt();
    let scales = OUTCOMES.iter().map(|(s, d, _)| (*s, *d));
    let scales = scales.chain([("similarity", "similarity"), ("aggressiveness", "aggressiveness")]);
    for (scale, subscale) in scales {
        for other in [id("cautious"), id("aggressive"), id("perpendicular")] {
            let d = study.mimic_minus(other, scale, subscale);
            let m = mean(&d);
            let sd = mean(&d.iter().map(|x| (x - m).powi(2)).collect::<Vec<_>>()).sqrt();
            assert!((m / sd).abs() < bound, "{other} {subscale}: {m}");
            for (name, before) in [
                ("conscientiousness", "mini_ipip"),
                ("openness", "mini_ipip"),
                ("high_velocity", "mdsi"),
            ] {
                let r = correlation(&study.scores(Moment::Pre, before, name), &d);
                assert!(r.abs() < bound, "{name} {other} {subscale}: {r}");
            }
        }
        if scale != "similarity" {
            let mimic = Moment::after(id("mimic"));
            let similarity = study.scores(mimic, "similarity", "similarity");
            let r = correlation(&similarity, &study.scores(mimic, scale, subscale));
            assert!(r.abs() < bound, "similarity {subscale}: {r}");
        }
    }
}

fn one_trial(
    values: MeasureValues,
) -> (Participant, MeasureValues, Vec<(ConditionId, MeasureValues)>) {
    let study = TestStudy::run(2, 1, &effects());
    let participant = study.cohort.participants[0].clone();
    let own = own_measures(&participant.id, 1);
    (participant, own, vec![(id("mimic"), values)])
}

fn units() -> BTreeMap<String, f64> {
    let people = ["A", "B", "C"].map(|id| own_measures(&ParticipantId::new(id).unwrap(), 1));
    spread(&people.iter().collect::<Vec<_>>())
}

#[test]
fn a_drive_without_merge_back_is_judged_by_the_rest_and_said_so() {
    let (participant, own, _) = one_trial(MeasureValues::new());
    let mut values = own.clone();
    values.insert("headway_merge_back_m".to_owned(), None);
    let trials = [(id("mimic"), values)];
    let rated = rate(&participant, &own, &trials, &units(), &scales(), &effects(), 1).unwrap();
    assert_eq!(rated.answers.len(), 12 + 12 + 5 + 4 + 4);
    assert_eq!(rated.warnings.len(), 1);
    assert!(rated.warnings[0].to_string().ends_with("was rated without headway_merge_back_m"));
}

#[test]
fn one_trial_does_not_change_another() {
    let study = TestStudy::run(2, 1, &effects());
    let participant = &study.cohort.participants[0];
    let own = own_measures(&participant.id, 1);
    let all = trials(&own, &participant.id, 1);
    let run = |trials: &[(ConditionId, MeasureValues)]| {
        rate(participant, &own, trials, &units(), &scales(), &effects(), 1).unwrap().answers
    };
    assert_eq!(run(&all)[..37], run(&all[..1])[..]);
}

#[test]
fn impossible_trials_are_refused() {
    let (participant, own, mut trials) = one_trial(MeasureValues::new());
    trials.push(trials[0].clone());
    let said = |trials: &[(ConditionId, MeasureValues)]| {
        rate(&participant, &own, trials, &units(), &scales(), &effects(), 1)
            .unwrap_err()
            .to_string()
    };
    assert!(said(&trials).contains("mimic is given twice"));
    assert!(said(&[(id("own"), own.clone())]).contains("own is none that they sat through"));
    let mut infinite = own.clone();
    infinite.insert("lane_changes".to_owned(), Some(f64::INFINITY));
    assert!(said(&[(id("mimic"), infinite)]).contains("`lane_changes` is inf"));
}
