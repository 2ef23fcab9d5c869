//! What is held of the questionnaires that are shipped.

use super::score;
use maveric_domain::{Answer, Moment, ParticipantId, Scale};
use std::collections::BTreeSet;

fn shipped(id: &str) -> Scale {
    Scale::from_toml(maveric_data::scale(id).unwrap()).unwrap()
}

#[test]
fn every_shipped_scale_is_valid_and_scores_every_item_that_can_be() {
    let scales = maveric_data::FILES.iter().filter(|(path, _)| path.contains("scales/"));
    let mut count = 0;
    for (path, text) in scales {
        let scale = Scale::from_toml(text).unwrap_or_else(|e| panic!("{path}: {e}"));
        assert!(path.ends_with(&format!("/{}.toml", scale.id)), "{path}");
        let used: BTreeSet<u32> = scale.subscales.iter().flat_map(|s| s.items.clone()).collect();
        let rated = (1..).zip(&scale.items).filter(|(_, i)| i.kind.rates() && i.expected.is_none());
        assert!(rated.map(|(n, _)| n).all(|n| used.contains(&n)), "{path}");
        count += 1;
    }
    assert_eq!(count, 17);
}

#[test]
fn the_big_five_have_four_items_each_and_their_wording() {
    let scale = shipped("mini_ipip");
    assert_eq!(scale.subscales.len(), 5);
    assert!(scale.subscales.iter().all(|s| s.items.len() == 4));
    assert_eq!(scale.wording.worded(), 20);
    assert_eq!(scale.items.iter().filter(|i| i.reversed).count(), 11);
}

#[test]
fn adb_totals_go_from_11_to_55() {
    let scale = shipped("adb");
    assert_eq!(scale.score_range(&scale.subscales[0]), (11.0, 55.0));
}

/// The scores of one sheet, by subscale.
fn scores(id: &str, answers: &[i32]) -> Vec<(String, f64)> {
    let answers: Vec<Answer> = (1..)
        .zip(answers)
        .map(|(item, answer)| Answer {
            participant: ParticipantId::new("P1").unwrap(),
            moment: Moment::Pre,
            scale: id.to_owned(),
            item,
            answer: Some(*answer),
        })
        .collect();
    let scored = score(&[shipped(id)], &answers, None).unwrap();
    let value = |s: maveric_domain::Score| (s.subscale, s.value.unwrap());
    scored.scores.into_iter().map(value).collect()
}

fn assert_scores(id: &str, answers: &[i32], expected: &[(&str, f64)]) {
    let scored = scores(id, answers);
    for (subscale, value) in expected {
        let (_, score) = scored.iter().find(|(name, _)| name == subscale).unwrap();
        assert!((score - value).abs() < 1e-9, "{id}.{subscale}: {score}, expected {value}");
    }
}

#[test]
fn sickness_is_weighted_as_published_and_ends_at_235_62() {
    let three =
        [("nausea", 200.34), ("oculomotor", 159.18), ("disorientation", 292.32), ("total", 235.62)];
    assert_scores("ssq", &[3; 16], &three);
    assert_scores("ssq", &[0; 16], &[("total", 0.0), ("nausea", 0.0)]);
    let ranges: Vec<(f64, f64)> =
        shipped("ssq").subscales.iter().map(|s| shipped("ssq").score_range(s)).collect();
    assert!((ranges[3].1 - 235.62).abs() < 1e-9 && ranges[3].0.abs() < 1e-9);
    // Nausea (item 8) slight, difficulty focusing (5) moderate, general discomfort (1) slight: by hand
    // N = 9.54 (1 + 1), O = 7.58 (1 + 2), D = 13.92 (1 + 2), total = 3.74 (2 + 3 + 3).
    let mut some = [0; 16];
    (some[0], some[4], some[7]) = (1, 2, 1);
    let by_hand =
        [("nausea", 19.08), ("oculomotor", 22.74), ("disorientation", 41.76), ("total", 29.92)];
    assert_scores("ssq", &some, &by_hand);
}

#[test]
fn acceptance_counts_the_left_box_up_but_for_items_3_6_and_8() {
    // Always the better word: left, and right in items 3, 6 and 8.
    let best = [-2, -2, 2, -2, -2, 2, -2, 2, -2];
    assert_scores("acceptance", &best, &[("usefulness", 2.0), ("satisfying", 2.0)]);
    assert_scores("acceptance", &best.map(|a| -a), &[("usefulness", -2.0), ("satisfying", -2.0)]);
    // Always the left box: usefulness (2 - 2 + 2 + 2 + 2) / 5, satisfying (2 + 2 - 2 - 2) / 4.
    assert_scores("acceptance", &[-2; 9], &[("usefulness", 1.2), ("satisfying", 0.0)]);
    let pairs: Vec<String> = shipped("acceptance")
        .wording
        .items
        .iter()
        .map(|i| i.pair.clone().unwrap()[0].clone())
        .collect();
    assert_eq!([&pairs[2], &pairs[5], &pairs[7]], ["bad", "irritating", "undesirable"]);
}

#[test]
fn situational_trust_reverses_items_2_4_and_5() {
    assert_scores("sts_ad", &[7, 1, 7, 1, 1, 7], &[("trust", 7.0)]);
    assert_scores("sts_ad", &[7; 6], &[("trust", 4.0)]);
    assert_scores(
        "sts_ad",
        &[5, 3, 4, 2, 2, 6],
        &[("trust", (5.0 + 5.0 + 4.0 + 6.0 + 6.0 + 6.0) / 6.0)],
    );
    assert_eq!(shipped("sts_ad").wording_in("de").unwrap().worded(), 6);
}

#[test]
fn raw_workload_is_the_mean_of_six_ratings_by_five_points() {
    let rated = [70, 10, 55, 25, 60, 35];
    assert_scores(
        "nasa_tlx",
        &rated,
        &[("workload", 42.5), ("mental", 70.0), ("frustration", 35.0)],
    );
    let scale = shipped("nasa_tlx");
    assert!(scale.items.iter().all(|i| i.takes(95) && !i.takes(96) && i.points() == 21));
    assert_eq!(scale.wording.items[3].anchors, ["Perfect", "Failure"]);
    assert_eq!(scale.wording.items[4].anchors, ["Very low", "Very high"]);
}

#[test]
fn what_could_not_be_confirmed_has_no_wording_and_the_rest_has_all_of_it() {
    for id in
        ["nasa_tlx", "acceptance", "sts_ad", "ssq", "demographics", "attention", "purpose", "which"]
    {
        let scale = shipped(id);
        assert_eq!(scale.wording.worded(), scale.items.len(), "{id}");
        assert!(scale.licence.is_some() && scale.wording.shown_title.is_none(), "{id}");
    }
    assert_eq!(shipped("misc").wording.worded(), 0);
    for id in ["demographics", "attention", "purpose", "which"] {
        assert!(shipped(id).wording_in("de").is_some(), "{id}");
    }
}
