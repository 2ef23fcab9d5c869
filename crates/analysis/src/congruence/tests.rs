use super::*;
use crate::{
    Analysis, Person, Question, StudyData, Tables, Verdict, finding,
    testing::{DESIGN, analysed_by, id, liked, person},
};
use Verdict::{Fails, NotShown, Shown, TooFew};
use maveric_domain::{ConditionRow, Design, Scale, Score};
use maveric_stats::{Bend, Region};
use std::collections::BTreeMap;

/// The design less its car across the dial.
fn on_the_dial() -> String {
    let across = "    [[condition]]\n    id = \"across\"\n    car = { across = true }\n";
    assert!(DESIGN.contains(across));
    DESIGN.replace(across, "")
}

fn analysed(tables: Tables) -> Analysis {
    analysed_by(&on_the_dial(), tables)
}

fn row(analysis: &Analysis) -> &CongruenceRow {
    &analysis.congruence[0]
}

fn verdict(analysis: &Analysis) -> Option<Verdict> {
    finding::by_question(&analysis.findings, Question::Congruence).map(|f| f.verdict)
}

#[test]
fn people_who_like_best_what_is_near_their_own_style_are_found_and_others_are_not() {
    let near = analysed(liked(24, |_| 1.0, 0.01));
    let model = row(&near).model.as_ref().unwrap();
    assert_eq!((model.bend, model.n_subjects, row(&near).n), (Bend::Top, 24, 24));
    assert!((model.turn.estimate.unwrap() - 1.0).abs() < 1.0);
    assert!((row(&near).near_points - 5.0).abs() < 1e-12);
    assert_eq!(verdict(&near), Some(Shown));
    // Everybody wants a car ten points above their own.
    assert_eq!(verdict(&analysed(liked(24, |_| 10.0, 0.01))), Some(Fails));
    // Everybody wants the same car, wherever their own style lies.
    let one_car = analysed(liked(24, |own| 30.0 - own, 0.01));
    let parts = &finding::by_question(&one_car.findings, Question::Congruence).unwrap().parts;
    let of: Vec<(&str, Verdict)> = parts.iter().map(|p| (p.of.as_str(), p.verdict)).collect();
    assert_eq!(of, [("jian_trust.overall.top", Shown), ("jian_trust.overall.movement", Fails)]);
    assert_eq!(verdict(&analysed(liked(24, |_| 0.0, 0.0))), Some(NotShown));
}

#[test]
fn what_is_liked_least_near_ones_own_style_fails_and_has_no_top() {
    let worst = analysed(liked(24, |_| 0.0, -0.01));
    assert_eq!(verdict(&worst), Some(Fails));
    let finding = finding::by_question(&worst.findings, Question::Congruence).unwrap();
    assert!(finding.parts.iter().all(|part| part.estimate.is_none()));
    let flat = analysed(liked(24, |_| 0.0, 0.0));
    let region = row(&flat).model.as_ref().unwrap().turn.region;
    assert!(!matches!(region, Some(Region::Between { .. })), "{region:?}");
}

#[test]
fn fewer_than_six_people_or_three_places_are_not_judged() {
    assert_eq!(verdict(&analysed(liked(5, |_| 1.0, 0.01))), Some(TooFew));
    let two = on_the_dial().replace("car = { dial = \"-1\" }", "car = { mean = true }");
    let two = analysed_by(&two, liked(24, |_| 1.0, 0.01));
    assert!(two.congruence.is_empty());
    assert_eq!(verdict(&two), None);
    // Without a style nobody's distance is known.
    let mut unknown = liked(24, |_| 1.0, 0.01);
    unknown.conditions.iter_mut().for_each(|row| row.adb_hat = None);
    let unknown = analysed(unknown);
    assert_eq!((row(&unknown).n, row(&unknown).model.is_some()), (0, false));
    assert!(row(&unknown).why_not.is_some() && row(&unknown).curves.is_empty());
    assert_eq!(verdict(&unknown), None);
}

#[test]
fn a_rating_whose_low_values_are_better_is_turned() {
    let mut tables = rated(liked(24, |_| 1.0, 0.01), |moved| moved);
    for score in tables.post.iter_mut().filter(|s| s.scale == "jian_trust") {
        score.value = score.value.map(|trust| 8.0 - trust);
    }
    let keyed = |lower: bool| {
        let scale = format!(
            "id = \"jian_trust\"\ntitle = \"T\"\nreference = \"r\"\nitems = 1\nmin = 1\nmax = 7\nscoring = \"mean\"\n\
                 [[subscales]]\nid = \"overall\"\ntitle = \"T\"\nitems = [1]\nlower_is_better = {lower}"
        );
        vec![Scale::from_toml(&scale).unwrap()]
    };
    tables.scales = keyed(true);
    let turned = analysed(tables.clone());
    assert_eq!(verdict(&turned), Some(Shown));
    // Best is where the rating, as it is keyed, is lowest.
    let is_lowest = |curve: &CongruenceCurve| curve.rating[2] > 0.0;
    assert!(row(&turned).less_is_better && row(&turned).curves.iter().all(is_lowest));
    let bend = |analysis: &Analysis| {
        let perceived = by_what_was_perceived(analysis);
        let model = perceived.model.as_ref().unwrap();
        (perceived.less_is_better, model.bend)
    };
    assert_eq!(bend(&turned), (true, Bend::Top));
    tables.scales = keyed(false);
    let as_asked = analysed(tables);
    assert_eq!(verdict(&as_asked), Some(Fails));
    assert_eq!(bend(&as_asked), (false, Bend::Bottom));
}

/// The same people, who rated themselves and each car by the score of the style: the car where they felt it to be.
fn rated(mut tables: Tables, felt: impl Fn(f64) -> f64) -> Tables {
    for row in tables.conditions.clone() {
        let moved = row.moved_points.unwrap();
        let own = row.adb_hat.unwrap() - moved;
        let score = |moment, value| Score {
            participant: row.participant.clone(),
            moment,
            scale: "adb".to_owned(),
            subscale: "total".to_owned(),
            value: Some(value),
            answered: 1,
            items: 1,
        };
        let after = Moment::after(row.condition);
        tables.post.push(score(after, own + felt(moved)));
        if moved == 0.0 {
            tables.pre.push(score(Moment::Pre, own));
        }
    }
    tables
}

fn by_what_was_perceived(analysis: &Analysis) -> &CongruenceRow {
    let [driven, row] = &analysis.congruence[..] else { panic!("{:?}", analysis.congruence) };
    assert!(driven.perceived.is_none() && row.perceived.is_some());
    // It is not drawn.
    let surface = |row: &CongruenceRow| row.model.as_ref().map_or(0, |m| m.surface.len());
    assert_eq!((surface(driven), driven.curves.len()), (9, 3));
    assert_eq!((surface(row), row.curves.len()), (0, 0));
    row
}

fn turn(row: &CongruenceRow) -> (f64, bool) {
    let turn = &row.model.as_ref().unwrap().turn;
    let p = turn.p_lower.unwrap().max(turn.p_upper.unwrap());
    (turn.estimate.unwrap(), p < 0.05)
}

#[test]
fn what_is_liked_best_as_perceived_is_found_near_and_elsewhere_and_decides_nothing() {
    // Everybody likes best their own style, and feels every car to lie where it does, or eight points below.
    let alike = analysed(rated(liked(24, |_| 1.0, 0.01), |moved| moved));
    let (driven, near) = turn(row(&alike));
    let (perceived, also_near) = turn(by_what_was_perceived(&alike));
    assert!(near && also_near && (driven - perceived).abs() < 1e-3);
    let below = analysed(rated(liked(24, |_| 1.0, 0.01), |moved| moved - 8.0));
    let (perceived, near) = turn(by_what_was_perceived(&below));
    assert!(!near && (driven - 8.0 - perceived).abs() < 0.05);
    assert_eq!(verdict(&below), Some(Shown));
    // Everybody likes best what lies ten points above and is felt to be their own.
    let above = analysed(rated(liked(24, |_| 10.0, 0.01), |moved| moved - 10.0));
    let (perceived, near) = turn(by_what_was_perceived(&above));
    assert!(near && perceived.abs() < 1.5, "{perceived}");
    assert_eq!(verdict(&above), Some(Fails));
    let finding = finding::by_question(&above.findings, Question::Congruence).unwrap();
    assert_eq!(finding.parts.len(), 2);
}

/// The design, where the car at a place of the dial is expected to seem more aggressive (+) or less (-).
fn expecting(signs: &[(&str, &str)]) -> String {
    let design = on_the_dial().replace("points = 15", "points = 15\n    range = [11, 55]");
    signs.iter().fold(design, |design, (dial, sign)| {
        let car = format!("car = {{ dial = \"{dial}\" }}");
        let expected = format!("expected = {{ \"aggressiveness.aggressiveness\" = \"{sign}\" }}");
        design.replace(&car, &format!("{car}\n    {expected}"))
    })
}

/// People who rated themselves by the score of the style, and how much more aggressive than they a car is: 4, and so much more a point.
fn compared(best: f64, more: f64) -> Tables {
    let mut tables = rated(liked(24, |_| best, 0.01), |moved| moved);
    for score in tables.post.iter_mut().filter(|s| s.scale == "adb") {
        let theirs = |s: &&Score| s.scale == "adb" && s.participant == score.participant;
        let own = tables.pre.iter().find(theirs).unwrap().value.unwrap();
        score.value = score.value.map(|felt| 4.0 + more * (felt - own));
        "aggressiveness".clone_into(&mut score.scale);
        "aggressiveness".clone_into(&mut score.subscale);
    }
    let scale = "id = \"aggressiveness\"\ntitle = \"T\"\nreference = \"r\"\nitems = 1\nmin = 1\nmax = 7\nscoring = \"mean\"\n\
             [[subscales]]\nid = \"aggressiveness\"\ntitle = \"T\"\nitems = [1]\nsame = 4";
    tables.scales = vec![Scale::from_toml(scale).unwrap()];
    tables
}

/// Points a step of the answer.
const STEP: f64 = 7.5;

#[test]
fn a_score_that_compares_the_car_with_oneself_is_a_distance_of_its_own() {
    let design = expecting(&[("+1", "+"), ("-1", "-")]);
    let mut tables = compared(1.0, 1.0 / STEP);
    let analysis = analysed_by(&design, tables.clone());
    let perceived = by_what_was_perceived(&analysis);
    let same = |row: &CongruenceRow| row.perceived.as_ref().unwrap().same;
    assert_eq!(same(perceived), Some(4.0));
    assert!((perceived.near_points - 5.0 * 6.0 / 44.0).abs() < 1e-12);
    assert_eq!((perceived.places, perceived.middle), (3, 33.0));
    let (driven, _) = turn(row(&analysis));
    let (turned, near) = turn(perceived);
    assert!(near && (driven / STEP - turned).abs() < 1e-3);
    // Of studies that are only counted, nothing is asked twice.
    let data = StudyData::new(&Design::from_toml(&design).unwrap(), tables.clone()).unwrap();
    assert_eq!(by_rating(&data, Purpose::Simulation).unwrap().len(), 1);
    // Who answered it before the drives too has the same own style and distances.
    for mut score in tables.pre.clone() {
        if score.scale == "adb" {
            "aggressiveness".clone_into(&mut score.scale);
            "aggressiveness".clone_into(&mut score.subscale);
            tables.pre.push(score);
        }
    }
    let both = analysed_by(&design, tables.clone());
    assert_eq!(turn(by_what_was_perceived(&both)), (turned, near));
    // The style's own score goes before.
    let own = rated(liked(24, |_| 1.0, 0.01), |moved| moved).post;
    let mut with_own = tables.clone();
    with_own.post.extend(own.into_iter().filter(|s| s.scale == "adb"));
    let with_own = analysed_by(&design, with_own);
    assert_eq!(same(by_what_was_perceived(&with_own)), None);
    // What is not expected to turn on the dial, or compares with nothing though it was asked before and after, says nothing of style; nor
    // is known whose own style was asked after the drives.
    let rows = |design: &str, tables| analysed_by(design, tables).congruence.len();
    assert_eq!(rows(&expecting(&[]), tables.clone()), 1);
    let mut unknown = tables.clone();
    unknown.scales.clear();
    assert_eq!(rows(&design, unknown), 1);
    for score in &mut tables.pre {
        score.moment = Moment::Post;
    }
    assert_eq!(rows(&design, tables), 1);
}

#[test]
fn what_was_compared_points_as_the_dial_does_or_nowhere() {
    // Who scores high drives calmly; everybody likes best what scores 3 points above their own.
    let turned = |signs: &[(&str, &str)], more: f64| {
        let calm = "range = [11, 55]\n    aggression = \"-\"";
        let design = expecting(signs).replace("range = [11, 55]", calm);
        let analysis = analysed_by(&design, compared(3.0, more / STEP));
        let (driven, _) = turn(row(&analysis));
        let (perceived, _) = turn(by_what_was_perceived(&analysis));
        assert!(driven > 2.0, "{driven}");
        perceived - driven / STEP
    };
    assert!(turned(&[("+1", "-"), ("-1", "+")], -1.0).abs() < 1e-3);
    assert!(turned(&[("-1", "+")], -1.0).abs() < 1e-3);
    assert!(turned(&[("+1", "+")], -1.0) < -0.5);
    let both = expecting(&[("+1", "+"), ("-1", "+")]);
    let both = analysed_by(&both, compared(1.0, 1.0 / STEP));
    let nowhere = by_what_was_perceived(&both);
    assert!(nowhere.model.is_none() && nowhere.n == 24);
    let why = nowhere.why_not.as_ref().unwrap();
    assert!(why.contains("aggressiveness.aggressiveness"), "{why}");
    assert_eq!(verdict(&both), Some(Shown));
}

#[test]
fn who_has_no_order_is_not_counted_where_the_model_takes_the_period() {
    let mut tables = liked(24, |_| 1.0, 0.01);
    for i in 0..24 {
        let mut order = ["same", "fast", "slow"].map(id).to_vec();
        order.rotate_left(i % 3);
        if i == 5 {
            order.clear();
        }
        tables.people.push(Person {
            id: person(i),
            learned: false,
            tested: true,
            order,
            columns: BTreeMap::new(),
        });
    }
    let theirs =
        |row: &&mut ConditionRow| row.participant == person(5) && row.condition == id("fast");
    let furthest = tables.conditions.iter_mut().find(theirs).unwrap();
    furthest.moved_points = furthest.moved_points.map(|moved| moved + 10.0);
    furthest.adb_hat = furthest.adb_hat.map(|score| score + 10.0);
    let tables = rated(tables, |moved| moved);
    let data = StudyData::new(&Design::from_toml(&on_the_dial()).unwrap(), tables).unwrap();
    let rows = by_rating(&data, Purpose::Report).unwrap();
    assert_eq!(rows.len(), 2);
    for row in &rows {
        let model = row.model.as_ref().unwrap();
        assert_eq!((row.period, row.n, model.n_subjects), (true, 23, 23));
    }
    let curves = &rows[0].curves;
    assert_eq!(curves.iter().map(|curve| curve.n).sum::<usize>(), 23);
    assert!(curves.iter().all(|curve| curve.met == (-15.0, 15.0)));
}

#[test]
fn curves_are_those_of_the_model_over_what_was_met_and_as_the_rating_is_keyed() {
    let analysis = analysed(liked(24, |own| 0.3 * (own - 30.0), 0.01));
    let near = row(&analysis);
    let model = near.model.as_ref().unwrap();
    let sds: Vec<i8> = near.curves.iter().map(|curve| curve.sds).collect();
    assert_eq!(sds, [-1, 0, 1]);
    assert_eq!(near.curves.iter().map(|curve| curve.n).sum::<usize>(), 24);
    let top = |curve: &CongruenceCurve| -curve.rating[1] / (2.0 * curve.rating[2]);
    let [low, mean, high] = &near.curves[..] else { panic!("{:?}", near.curves) };
    assert!((top(mean) - model.turn.estimate.unwrap()).abs() < 1e-9);
    let movement = model.movement.estimate.unwrap();
    assert!((top(high) - top(low) - movement).abs() < 1e-9);
    assert!((mean.own - near.middle - model.own_mean).abs() < 1e-9);
    assert!((high.own - low.own - 2.0 * model.own_sd).abs() < 1e-9);
    for curve in &near.curves {
        assert_eq!(curve.met, (-15.0, 15.0));
        assert!(curve.rating[2] < 0.0 && (2.0..6.0).contains(&curve.rating[0]));
    }
    // No car has a score that the scale does not have.
    let ranged = on_the_dial().replace("points = 15", "points = 15\n    range = [11, 55]");
    let tables = liked(24, |own| 0.3 * (own - 30.0), 0.01);
    let ends = row(&analysed_by(&ranged, tables)).curves[0].clone();
    assert!((ends.met.0 - (11.0 - ends.own)).abs() < 1e-9, "{ends:?}");
    assert!((ends.met.1 - 15.0).abs() < 1e-9, "{ends:?}");
}
