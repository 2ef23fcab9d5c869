//! Recommendations worked out by hand, and found again in the ratings of made-up numbers.

use super::{
    Learned, OnTheScale, Preferred, Reason, SETTINGS,
    learned::{Standard, parabola, setting_of},
    percept::{Dial, Percept},
    reasons,
    scale::{on_the_scale, settings_within},
};
use crate::{
    Settled, StudyData, Tables, Turns,
    testing::{drive, id, person, score, steered},
};
use maveric_domain::{
    BeyondWhy, ConditionRow, Design, EmbeddingRow, MeasureValues, Moment, design::ScoreName,
};
use maveric_stats::{Belief, Hierarchical};
use std::collections::BTreeMap;

#[track_caller]
fn near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() < within, "{found}, not {expected}");
}

fn named(values: [(&str, f64); 2]) -> BTreeMap<String, f64> {
    values.map(|(name, v)| (name.to_owned(), v)).into()
}

#[test]
fn a_drive_is_perceived_by_its_weighted_differences_in_spreads() {
    let percept = Percept {
        shift: named([("speed", 0.5), ("room", -0.2)]),
        distance: named([("speed", 0.75), ("room", 0.25)]),
        spread: named([("speed", 2.0), ("room", 10.0)]),
    };
    let values = |speed: f64, room: Option<f64>| {
        MeasureValues::from([("speed".to_owned(), Some(speed)), ("room".to_owned(), room)])
    };
    let own = values(25.0, Some(40.0));
    let seen = |speed, room| percept.perceived(&own, &values(speed, room));
    // One spread faster, three nearer.
    let (shift, distance) = seen(27.0, Some(10.0));
    near(shift, 0.5 + 0.6, 1e-12);
    near(distance, (0.75 + 0.25 * 9.0_f64).sqrt(), 1e-12);
    // What is missing is no part of the comparison, and beyond five spreads all is alike.
    let (shift, distance) = seen(21.0, None);
    near(shift, -1.0, 1e-12);
    near(distance, 2.0, 1e-12);
    near(seen(99.0, None).0, 2.5, 1e-12);
    assert_eq!(percept.perceived(&MeasureValues::new(), &own), (0.0, 0.0));
}

/// Where a unit of perceived shift is 15 points, below the own style 30; b = 0.6, g = -1.5, and for each SD of one trait 0.3 more of
/// b, of another 0.1 less.
fn learned() -> Learned {
    let score = |name: &str, sign, mean, sd| {
        let name: ScoreName = name.parse().unwrap();
        let title = name.to_string();
        (name, sign, Standard { name: title, mean, sd })
    };
    Learned {
        adb_point: 1.0,
        percept: Percept {
            shift: BTreeMap::new(),
            distance: BTreeMap::new(),
            spread: BTreeMap::new(),
        },
        dial: Dial { points: 15.0, shift: [-0.5, 0.0, 1.0], distance: [0.0; 3] },
        traits: ["pace", "calm"].map(trait_of).into(),
        ratings: vec![score("calm.total", -1.0, 4.0, 2.0), score("trust.total", 1.0, 3.0, 1.0)],
        fit: Hierarchical {
            coefficients: known(&[]),
            shrunken_sd: Vec::new(),
            random_sd: vec![0.0; 3],
            residual_sd: 0.5,
            ln_evidence: 0.0,
        },
    }
}

fn trait_of(name: &str) -> Standard {
    Standard { name: name.to_owned(), mean: 10.0, sd: 2.0 }
}

/// The coefficients for sure, but for those with a variance.
fn known(variances: &[(usize, f64)]) -> Belief {
    let mean = vec![4.0, 0.6, -1.5, -0.2, 0.3, -0.1, 0.0, 0.0];
    let mut covariance = vec![vec![0.0; 8]; 8];
    for &(at, variance) in variances {
        covariance[at][at] = variance;
    }
    Belief::new(mean, covariance).unwrap()
}

fn believed(learned: &Learned) -> Belief {
    learned.fit.somebody().extended(&[0.0; SETTINGS.len()])
}

#[test]
fn the_preferred_setting_is_the_top_of_the_parabola_within_what_was_driven() {
    let learned = learned();
    let belief = believed(&learned);
    let at = |pace: f64| learned.preferred(&belief, &[pace, 0.0]).unwrap();
    // b = 1.2 over 2 · 1.5; b = -0.6, where a unit is 30 points; and beyond 30 points nobody has driven.
    near(at(2.0).points, 6.0, 1e-9);
    near(at(-4.0).points, -6.0, 1e-9);
    near(at(30.0).points, 30.0, 1e-9);
    assert!((at(2.0).within_5 - 1.0).abs() < 1e-12);
    let mut unsure = self::learned();
    // An SD of 1 of b is one of 5 points.
    unsure.fit.coefficients = known(&[(1, 1.0)]);
    let found = unsure.preferred(&believed(&unsure), &[20.0, 0.0]).unwrap();
    near(found.points, 30.0, 1e-9);
    let found = unsure.preferred(&believed(&unsure), &[8.0, 0.0]).unwrap();
    near(found.points, 15.0, 1e-9);
    near(found.low, 15.0 - 1.96 * 5.0, 0.3);
    near(found.high, 15.0 + 1.96 * 5.0, 0.3);
    near(found.within_5, 0.683, 0.02);
    let mut flat = self::learned();
    flat.fit.coefficients = Belief::new(vec![0.0; 8], vec![vec![0.0; 8]; 8]).unwrap();
    assert_eq!(flat.preferred(&believed(&flat), &[0.0, 0.0]), None);
}

#[test]
fn the_reasons_are_what_each_part_adds_in_points() {
    let learned = learned();
    let belief = believed(&learned);
    let points = |traits: &[f64]| {
        let found = reasons(&learned, [&belief, &belief, &belief], traits);
        let all = found.into_iter().map(|r| (r.because, r.points));
        all.collect::<BTreeMap<String, f64>>()
    };
    // Everybody's b of 0.6 is 3 points; two SDs of the trait are 0.6 of b and 3 points more.
    let above = points(&[2.0, 0.0]);
    near(above["everybody"], 3.0, 1e-9);
    near(above["pace"], 3.0, 1e-9);
    near(points(&[2.0, 1.0])["calm"], -0.5, 1e-9);
    near(above["own ratings"], 0.0, 1e-12);
    assert!(!above.contains_key("own turns of the dial"));
    // Below the own style a unit of b is worth twice as much.
    near(points(&[-4.0, 0.0])["pace"], -12.0, 1e-9);
    let mut rated = belief.clone();
    rated = Belief::new(
        rated.mean().iter().enumerate().map(|(i, m)| m + if i == 1 { 0.9 } else { 0.0 }).collect(),
        vec![vec![0.0; belief.len()]; belief.len()],
    )
    .unwrap();
    // Where the ratings hardly bend, a bend of 0.05 is reckoned with: 0.6 / 0.1 of the dial.
    let mut straight = self::learned();
    let mut mean = straight.fit.coefficients.mean().to_vec();
    mean[2] = 0.0;
    straight.fit.coefficients = Belief::new(mean, vec![vec![0.0; 8]; 8]).unwrap();
    let unbent = believed(&straight);
    let found = reasons(&straight, [&unbent, &unbent, &unbent], &[0.0, 0.0]);
    let everybody = found.iter().find(|r| r.because == "everybody").unwrap();
    near(everybody.points, 90.0, 1e-9);
    let found = reasons(&learned, [&belief, &belief, &rated], &[2.0, 0.0]);
    assert_eq!(found[0].because, "own turns of the dial", "the largest first");
    near(found[0].points, 4.5, 1e-9);
}

#[test]
fn a_rating_is_the_mean_of_what_was_answered_in_spreads() {
    let learned = learned();
    let rating = |calm: Option<f64>, trust: Option<f64>| {
        learned.rating(|name| if name.scale == "calm" { calm } else { trust })
    };
    // Less calm is better: (4 - 2) / 2, and (5 - 3) / 1.
    near(rating(Some(2.0), Some(5.0)).unwrap(), 1.5, 1e-12);
    near(rating(Some(6.0), None).unwrap(), -1.0, 1e-12);
    assert_eq!(rating(None, None), None);
}

#[test]
fn where_the_dial_was_left_the_preference_neither_rises_nor_falls() {
    let mut learned = learned();
    learned.fit.coefficients = known(&[(1, 1.0)]);
    let mut belief = believed(&learned);
    let settled = Settled { points: 7.5, sd: 1.5 };
    learned.observe_settled(&mut belief, &[0.0, 0.0], settled);
    // At half a shift b + g is 0 instead of -0.9, with an error of 2 · 1.5 · 1.5 / 15 beside the SD of 1.
    near(belief.mean()[1], 0.6 + 0.9 / 1.09, 1e-9);
    near(belief.mean()[2], -1.5, 1e-12);
}

#[test]
fn the_parabola_has_every_part_of_a_rating_that_turns_with_the_shift_what_is_the_persons_own_too() {
    let traits = [0.7, -1.3];
    let (linear, square) = parabola(&traits);
    let row = |shift: f64| Learned::row(&traits, (shift, 0.0), None);
    assert_eq!(linear.len() + SETTINGS.len(), row(0.0).len());
    for shift in [-2.0, 0.5, 3.0] {
        let parts = row(shift).into_iter().zip(row(0.0));
        for ((there, still), (l, s)) in parts.zip(linear.iter().zip(&square)) {
            near(there - still, l * shift + s * shift * shift, 1e-12);
        }
    }
}

#[test]
fn no_setting_is_recommended_that_the_scale_does_not_have() {
    let mut data = two_placed();
    let within = |data: &StudyData, i: usize, expected: [f64; 2]| {
        let found = settings_within(data, data.embedding(&person(i), true), [-30.0, 30.0]);
        (0..2).for_each(|end| near(found[end], expected[end], 1e-12));
    };
    // Nobody knows the range.
    within(&data, 0, [-30.0, 30.0]);
    let ranged = DESIGN.replace("points = 15", "points = 15\nrange = [20, 60]");
    data.design = Design::from_toml(&ranged).unwrap();
    // S reads 39 and 21, and nothing of the third.
    within(&data, 0, [-19.0, 21.0]);
    within(&data, 1, [-1.0, 30.0]);
    within(&data, 2, [-30.0, 30.0]);
    let people: Vec<_> = (0..PEOPLE).map(person).collect();
    let learned = Learned::from(&eight(below), &people).unwrap();
    let found = learned.recommendation(&data, &person(1));
    assert!(found.preferred.unwrap().low >= -1.0);
    let there = found.on_the_scale.unwrap();
    assert!(there.low <= there.at && there.at <= there.high, "{there:?}");
}

#[test]
fn on_a_scale_from_1_to_6_a_recommendation_is_as_large_a_share_as_on_the_adb() {
    let a_point = 5.0 / 44.0;
    let mut learned = learned();
    (learned.adb_point, learned.dial.points) = (a_point, 15.0 * a_point);
    let belief = believed(&learned);
    let at = |pace: f64| learned.preferred(&belief, &[pace, 0.0]).unwrap();
    near(at(2.0).points, 6.0 * a_point, 1e-9);
    near(at(30.0).points, 30.0 * a_point, 1e-9);
}

#[test]
fn a_condition_shows_the_setting_that_it_came_near_to() {
    let text = "[study]\ntitle = \"t\"\n[people]\nlearn = { a = 1 }\n[style]\nscore = \"adb.total\"\n\
                [[condition]]\nid = \"up\"\ncar = { dial = 15 }\n[[condition]]\nid = \"mean\"\ncar = { mean = true }";
    let design = Design::from_toml(text).unwrap();
    let [up, mean] = design.conditions() else { panic!("two") };
    assert_eq!(setting_of(up, Some(15.0)), Some(6));
    assert_eq!((setting_of(up, Some(12.6)), setting_of(up, Some(12.4))), (Some(6), Some(5)));
    assert_eq!((setting_of(up, Some(17.6)), setting_of(up, None)), (None, None));
    assert_eq!(setting_of(mean, Some(15.0)), None);
}

const PEOPLE: usize = 8;
const DESIGN: &str = r#"
[study]
title = "Eight people"
[people]
learn = { group = "drivers" }
[style]
score = "adb.total"
points = 15
[baseline]
id = "own"
[[condition]]
id = "same"
car = { dial = 0 }
[[condition]]
id = "up"
car = { dial = 15 }
[[condition]]
id = "down"
car = { dial = -15 }
[homophily]
factors = ["ipip.pace"]
ratings = ["trust.total"]
"#;

/// The trait of somebody, in SDs from its mean, all but.
fn pace(i: usize) -> f64 {
    i as f64 - 3.5
}

/// What somebody likes: the shift in spreads of speed where their ratings are highest.
fn liked(i: usize) -> f64 {
    0.2 + 0.12 * pace(i)
}

/// People who call a drive half a point more aggressive for each spread of speed, and rate it by how far it is from what they like.
fn eight(down: impl Fn(f64) -> f64) -> StudyData {
    let mut tables = Tables::default();
    let own = |i: usize| if i.is_multiple_of(2) { 23.0 } else { 27.0 };
    let spread = (PEOPLE as f64 * 4.0 / (PEOPLE as f64 - 1.0)).sqrt();
    for i in 0..PEOPLE {
        tables.measurements.push(drive(i, "own", Some(own(i))));
        tables.pre.push(score(i, Moment::Pre, "ipip", "pace", 20.0 + pace(i)));
        tables.pre.push(score(i, Moment::Pre, "adb", "total", 30.0));
        let off = if i % 3 == 0 { 0.02 } else { -0.01 };
        for (condition, shift, moved) in
            [("same", off, 0.0), ("up", 1.5 + off, 15.0), ("down", down(off), -15.0)]
        {
            tables.measurements.push(drive(i, condition, Some(own(i) + shift * spread)));
            tables.conditions.push(ConditionRow {
                moved_points: Some(moved),
                ..steered(i, condition, None, false)
            });
            let after = Moment::after(id(condition));
            let felt = 4.0 + 0.5 * shift + 0.5 * off;
            tables.post.push(score(i, after, "aggressiveness", "aggressiveness", felt));
            let trust = 5.0 - (shift - liked(i)).powi(2) + off;
            tables.post.push(score(i, after, "trust", "total", trust));
        }
    }
    StudyData::new(&Design::from_toml(DESIGN).unwrap(), tables).unwrap()
}

/// Where the car turned down is, in spreads.
fn below(off: f64) -> f64 {
    -1.5 - 2.0 * off
}

#[test]
fn a_dial_that_nobody_sees_turn_down_is_none() {
    let data = eight(|off| off);
    let people: Vec<_> = (0..PEOPLE).map(person).collect();
    let error = Learned::from(&data, &people).unwrap_err();
    assert!(error.to_string().contains("not perceived in this order"), "{error}");
}

#[test]
fn what_eight_people_like_is_found_again_in_their_ratings_and_in_their_trait() {
    let data = eight(below);
    let people: Vec<_> = (0..PEOPLE).map(person).collect();
    let learned = Learned::from(&data, &people).unwrap();
    let traits: Vec<&str> = learned.traits.iter().map(|t| t.name.as_str()).collect();
    // Everybody's score is the same.
    assert_eq!(traits, ["pace", "own_mean_velocity"]);
    let standardised = people.iter().map(|p| learned.traits(&data, p)[0]);
    let (sum, squares) = standardised.fold((0.0, 0.0), |(s, q), t| (s + t, q + t * t));
    near(sum, 0.0, 1e-9);
    near(squares, PEOPLE as f64 - 1.0, 1e-9);
    near(learned.percept.shift["mean_velocity_mps"], 0.5, 0.02);
    near(learned.percept.distance["mean_velocity_mps"], 1.0, 1e-12);
    let dial = learned.dial;
    near(dial.points, 15.0, 1e-12);
    near(dial.shift[2] - dial.shift[0], 0.5 * 3.0, 0.05);
    near(dial.distance[2], 1.5, 0.05);
    for (i, somebody) in people.iter().enumerate() {
        let found = learned.recommendation(&data, somebody);
        // 15 points are a spread and a half.
        let expected = 10.0 * liked(i);
        near(found.preferred.unwrap().points, expected, 1.5);
        near(found.before_riding.unwrap().points, expected, 2.5);
        assert!(found.on_the_scale.is_none(), "no model read anybody's score");
    }
    // Who likes more than the own style, and left the dial further up, likes more still.
    let last = &people[PEOPLE - 1];
    let turns = Turns {
        participant: last.clone(),
        turned: vec![(1.0, 15.0)],
        duration_s: 100.0,
        step: 0.5,
    };
    let before = learned.recommendation(&data, last).preferred.unwrap();
    let data = data.with_turns(&[turns]);
    let found = learned.recommendation(&data, last);
    assert!(found.preferred.unwrap().points > before.points);
    let turned = |r: &Reason| r.because == "own turns of the dial";
    assert!(found.reasons.iter().any(turned));
    // From a drive that the model has met nobody with the dial has no place to turn from, unless the design lets it.
    let beyond = EmbeddingRow {
        beyond_why: Some(BeyondWhy::Scale),
        ..crate::testing::position(PEOPLE - 1, 0.0)
    };
    let mut stranger = data.clone().with_embeddings(vec![beyond]);
    let none = learned.recommendation(&stranger, last);
    assert_eq!(none.beyond, Some(BeyondWhy::Scale));
    assert!(none.preferred.is_none() && none.before_riding.is_none());
    let driven = format!("{DESIGN}[model]\nbeyond = \"drive\"\n");
    stranger.design = Design::from_toml(&driven).unwrap();
    let asked = learned.recommendation(&stranger, last);
    assert!(asked.beyond.is_some() && asked.preferred.is_some());
    let few = Learned::from(&data, &people[..4]).unwrap_err();
    assert!(few.to_string().contains("4 people"), "{few}");
}

#[test]
fn without_ratings_nothing_is_learned_and_what_to_write_is_said() {
    let people: Vec<_> = (0..PEOPLE).map(person).collect();
    let refused = |design: &str| {
        let mut data = eight(below);
        data.design = Design::from_toml(design).unwrap();
        Learned::from(&data, &people).unwrap_err()
    };
    let undeclared = refused(DESIGN.split("[homophily]").next().unwrap());
    assert!(undeclared.to_string().contains("no `[homophily] ratings`"), "{undeclared}");
    let help = undeclared.suggestion().unwrap();
    assert!(help.contains("ratings = [\"jian_trust.overall\"]"), "{help}");
    let unanswered = refused(&DESIGN.replace("trust.total", "comfort.total"));
    assert!(unanswered.to_string().contains("nobody answered comfort.total"), "{unanswered}");
    let mut tables = Tables::default();
    for i in 0..PEOPLE {
        for condition in ["own", "same", "up", "down"] {
            tables.measurements.push(drive(i, condition, Some(25.0)));
        }
    }
    let unfelt = StudyData::new(&Design::from_toml(DESIGN).unwrap(), tables).unwrap();
    let unfelt = Learned::from(&unfelt, &people).unwrap_err();
    assert!(
        unfelt.to_string().contains("nobody answered aggressiveness.aggressiveness"),
        "{unfelt}"
    );
}

/// The eight, of whom two have a style that reads as 9 points to either side of 30, to half a step of 9 points.
fn two_placed() -> StudyData {
    let row = |i: usize, position: f64| EmbeddingRow {
        adb_hat: Some(30.0 + 9.0 * position),
        line_position_se: Some(0.5),
        ..crate::testing::position(i, position)
    };
    eight(below).with_embeddings(vec![row(0, 1.0), row(1, -1.0)])
}

#[test]
fn on_the_scale_both_uncertainties_add_up_as_squares() {
    let data = two_placed();
    let preferred = Preferred { points: 6.0, low: 0.0, high: 14.0, within_5: 0.5 };
    let OnTheScale { own, own_sd, at, low, high } =
        on_the_scale(&data, &person(0), &preferred).unwrap();
    // S reads 39; half a step of 9 points is its SD.
    assert_eq!((own, own_sd, at), (39.0, 4.5, 45.0));
    near(low, 45.0 - (36.0 + (1.96 * 4.5_f64).powi(2)).sqrt(), 1e-9);
    near(high, 45.0 + (64.0 + (1.96 * 4.5_f64).powi(2)).sqrt(), 1e-9);
    // Of a setting at its own low end the own style alone is open below.
    let at_the_end = Preferred { low: 6.0, ..preferred };
    let found = on_the_scale(&data, &person(0), &at_the_end).unwrap();
    near(found.low, 45.0 - 1.96 * 4.5, 1e-9);
}

#[test]
fn a_recommendation_that_the_scale_has_no_score_for_has_none_and_no_interval_leaves_the_scale() {
    let mut data = two_placed();
    assert_eq!(data.style_range(), None);
    let ranged = DESIGN.replace("points = 15", "points = 15\nrange = [11, 55]");
    data.design = Design::from_toml(&ranged).unwrap();
    assert_eq!(data.style_range(), Some((11.0, 55.0)));
    // S reads 39.
    let preferred =
        |points: f64| Preferred { points, low: points - 8.0, high: points + 8.0, within_5: 0.5 };
    let inside = on_the_scale(&data, &person(0), &preferred(15.0)).unwrap();
    assert_eq!((inside.at, inside.high), (54.0, 55.0));
    assert!(inside.low < 54.0 - 8.0);
    assert_eq!(on_the_scale(&data, &person(0), &preferred(17.0)), None);
    let rounded = on_the_scale(&data, &person(0), &preferred(16.0 + 1e-12));
    assert_eq!(rounded.map(|found| found.at), Some(55.0));
    // Whoever reads as no score of the scale has no place on it.
    data.embeddings[0].adb_hat = None;
    assert_eq!(on_the_scale(&data, &person(0), &preferred(0.0)), None);
}
