//! Simple effects and contrasts of levels, against tests of each person's contrast.

use super::*;
use crate::{Chosen, LevelChoice, PairedT, WithinSubjects, adjust, groups, within};

const PEOPLE: usize = 14;
const ROADS: [&str; 3] = ["city", "country", "motorway"];

/// The value of a person in a mode (0 calm) on a road.
fn value(person: usize, mode: usize, road: usize) -> f64 {
    let own = noise(7 * person) + if is_car(person) { 0.0 } else { 0.8 };
    10.0 + own + (mode * road) as f64 * 0.6 + noise(person * 6 + mode * 3 + road)
}

fn is_car(person: usize) -> bool {
    person % 7 < 4
}

fn age(person: usize) -> f64 {
    20.0 + (person * 5 % 14) as f64
}

/// Fourteen people (eight in a car, six in a truck) in two modes on three roads, with their age.
fn made() -> Made {
    let rows = || (0..PEOPLE * 6).map(|row| (row / 6, row % 6 / 3, row % 3));
    Made {
        people: rows().map(|(p, ..)| format!("p{p}")).collect(),
        mode: rows().map(|(_, m, _)| ["calm", "sporty"][m].to_owned()).collect(),
        road: rows().map(|(.., r)| ROADS[r].to_owned()).collect(),
        vehicle: rows()
            .map(|(p, ..)| Some(if is_car(p) { "car" } else { "truck" }.to_owned()))
            .collect(),
        age: rows().map(|(p, ..)| Some(age(p))).collect(),
        value: rows().map(|(p, m, r)| Some(value(p, m, r))).collect(),
    }
}

/// As residuals that look normal would have it, or as ranks.
fn factorial_of(data: &DesignColumns<'_>, normal: bool) -> Chosen<FactorialFinding> {
    let (design, shape, covariates) = factors::shaped(data).unwrap();
    let plan = DesignPlan::of(&shape);
    let (anova, tests) = factors::tested(&design, &shape, &covariates, &plan, normal).unwrap();
    Chosen {
        chosen: if normal { ChosenTest::Factorial } else { ChosenTest::Ranks },
        reasons: Vec::new(),
        checks: Vec::new(),
        found: FactorialFinding { anova, tests },
    }
}

fn pair(first: &str, second: &str) -> LevelChoice {
    LevelChoice::Pair([first, second].map(str::to_owned))
}

#[track_caller]
fn close(found: Option<f64>, expected: Option<f64>) {
    let (found, expected) = (found.unwrap(), expected.unwrap());
    assert!((found - expected).abs() < 1e-9, "{found}, not {expected}");
}

/// What a person's contrast is worth, against nothing.
fn against_nothing(score: impl Fn(usize) -> f64) -> (PairedT, crate::WithinAnalysis) {
    let names = ["score", "nothing"].map(str::to_owned);
    let people: Vec<String> = (0..PEOPLE).map(|p| p.to_string()).collect();
    let rows: Vec<Vec<f64>> = (0..PEOPLE).map(|p| vec![score(p), 0.0]).collect();
    let all = within(&WithinSubjects::from_rows(&names, &people, &rows).unwrap());
    let t = all.paired.values().next().unwrap().clone();
    (t, all)
}

fn roads(person: usize, mode: usize) -> f64 {
    (0..3).map(|road| value(person, mode, road)).sum::<f64>() / 3.0
}

fn mean(scores: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = scores.len() as f64;
    scores.sum::<f64>() / n
}

#[test]
fn without_groups_a_contrast_is_the_paired_t_test_of_each_persons_contrast() {
    type Case<'a> = (Vec<(&'a str, LevelChoice)>, Box<dyn Fn(usize) -> f64>);
    let made = made();
    let found = factorial_of(&made.within(), true);
    let sporty = |p, road| value(p, 1, road) - value(p, 0, road);
    let cases: [Case<'_>; 4] = [
        (vec![("mode", pair("sporty", "calm"))], Box::new(|p| roads(p, 1) - roads(p, 0))),
        (vec![("mode", pair("calm", "sporty"))], Box::new(|p| roads(p, 0) - roads(p, 1))),
        (
            vec![("mode", pair("sporty", "calm")), ("road", pair("motorway", "city"))],
            Box::new(move |p| sporty(p, 2) - sporty(p, 0)),
        ),
        (
            vec![("mode", pair("sporty", "calm")), ("road", LevelChoice::At("country".to_owned()))],
            Box::new(move |p| sporty(p, 1)),
        ),
    ];
    for (parts, score) in cases {
        let contrast = level_contrast(&made.within(), &found, &parts).unwrap();
        let (t, _) = against_nothing(&score);
        assert!((contrast.estimate - mean((0..PEOPLE).map(&score))).abs() < 1e-12, "{parts:?}");
        close(contrast.statistic, t.t);
        close(contrast.p, t.p);
        assert_eq!((contrast.n, contrast.df), (PEOPLE, Some(PEOPLE as f64 - 1.0)));
        let half = contrast.ci.high.unwrap() - contrast.estimate;
        close(Some(contrast.estimate - contrast.ci.low.unwrap()), Some(half));
    }
}

#[test]
fn with_groups_each_keeps_its_variance_and_counts_alike() {
    let made = made();
    let data = made.grouped();
    let found = factorial_of(&data, true);
    let sporty = |p| roads(p, 1) - roads(p, 0);
    // A difference of groups in a difference within: Welch's test of the differences.
    let parts = [("vehicle", pair("truck", "car")), ("mode", pair("sporty", "calm"))];
    let contrast = level_contrast(&data, &found, &parts).unwrap();
    let names: Vec<String> =
        (0..PEOPLE).map(|p| if is_car(p) { "car" } else { "truck" }.to_owned()).collect();
    let scores: Vec<Option<f64>> = (0..PEOPLE).map(|p| Some(sporty(p))).collect();
    let by_hand = groups(&names, &scores).unwrap();
    let welch = by_hand.welch_t.get("car|truck").unwrap();
    close(Some(contrast.estimate), Some(-welch.mean_diff));
    close(contrast.statistic, welch.t.map(|t| -t));
    close(contrast.df, welch.df);
    close(contrast.p, welch.p);
    // Averaged over groups both count alike, whatever their size.
    let alone = level_contrast(&data, &found, &parts[1..]).unwrap();
    let of =
        |car: bool| -> Vec<f64> { (0..PEOPLE).filter(|p| is_car(*p) == car).map(sporty).collect() };
    let (cars, trucks) = (of(true), of(false));
    assert_ne!(cars.len(), trucks.len());
    let half = f64::midpoint(mean(cars.into_iter()), mean(trucks.into_iter()));
    close(Some(alone.estimate), Some(half));
}

#[test]
fn between_people_a_covariate_is_taken_out_as_of_the_effect() {
    let made = made();
    let data = DesignColumns { covariates: vec![("age", &made.age)], ..made.grouped() };
    let found = factorial_of(&data, true);
    let parts = [("vehicle", pair("truck", "car"))];
    let contrast = level_contrast(&data, &found, &parts).unwrap();
    assert_eq!(contrast.method, EffectMethod::Regression);
    // Of two groups the square of t is the effect's F.
    let effect = found.found.tests.get("vehicle").unwrap();
    close(contrast.statistic.map(|t| t * t), effect.statistic);
    close(contrast.p, effect.p);
    close(contrast.df, effect.df2);
    // By hand: the slope within groups, and the difference of the means at the same age.
    let all = |p: usize| f64::midpoint(roads(p, 0), roads(p, 1));
    let means = |of: &dyn Fn(usize) -> f64, car: bool| {
        let people: Vec<f64> = (0..PEOPLE).filter(|p| is_car(*p) == car).map(of).collect();
        mean(people.into_iter())
    };
    let (mut over, mut square) = (0.0, 0.0);
    for p in 0..PEOPLE {
        let from = age(p) - means(&age, is_car(p));
        over += from * (all(p) - means(&all, is_car(p)));
        square += from * from;
    }
    let difference = means(&all, false) - means(&all, true);
    let ages = means(&age, false) - means(&age, true);
    close(Some(contrast.estimate), Some(difference - over / square * ages));
    // Within people nothing is taken out.
    let mode = [("mode", pair("sporty", "calm"))];
    let with = level_contrast(&data, &found, &mode).unwrap();
    let without = made.grouped();
    let plain = factorial_of(&without, true);
    assert_eq!(with, level_contrast(&without, &plain, &mode).unwrap());
}

#[test]
fn where_ranks_decide_about_an_effect_they_decide_about_its_contrast() {
    let made = made();
    let data = made.within();
    let found = factorial_of(&data, false);
    let parts = [("road", pair("motorway", "city"))];
    let contrast = level_contrast(&data, &found, &parts).unwrap();
    let (_, all) = against_nothing(|p| {
        let road = |r| f64::midpoint(value(p, 0, r), value(p, 1, r));
        road(2) - road(0)
    });
    let ranks = all.wilcoxon.values().next().unwrap();
    assert_eq!((contrast.statistic, contrast.p), (ranks.w_plus, ranks.p));
    assert_eq!((contrast.se, contrast.ci.low), (None, None));
    let data = made.grouped();
    let found = factorial_of(&data, false);
    let contrast = level_contrast(&data, &found, &[("vehicle", pair("truck", "car"))]).unwrap();
    let test = found.found.tests.get("vehicle").unwrap();
    assert_eq!((contrast.method, contrast.p), (EffectMethod::GroupRanks, test.p));
}

#[test]
fn a_simple_effect_is_the_test_of_its_part_and_holm_goes_over_an_interaction() {
    let made = made();
    let found = factorial_of(&made.within(), true);
    let simple = simple_effects(&made.within(), &found).unwrap();
    let names: Vec<(&str, &str)> =
        simple.iter().map(|s| (s.factor.as_str(), s.level.as_str())).collect();
    assert_eq!(
        names,
        [
            ("mode", "city"),
            ("mode", "country"),
            ("mode", "motorway"),
            ("road", "calm"),
            ("road", "sporty")
        ]
    );
    for (at, effect) in simple[..3].iter().enumerate() {
        let (t, _) = against_nothing(|p| value(p, 1, at) - value(p, 0, at));
        let test = effect.test.as_ref().unwrap();
        close(test.statistic, t.t.map(|t| t * t));
        close(test.p, t.p);
    }
    // Of three levels the analysis of variance of that part alone.
    let people: Vec<String> = (0..PEOPLE).map(|p| p.to_string()).collect();
    let calm: Vec<Vec<f64>> =
        (0..PEOPLE).map(|p| (0..3).map(|road| value(p, 0, road)).collect()).collect();
    let table = WithinSubjects::from_rows(&ROADS.map(str::to_owned), &people, &calm).unwrap();
    let by_hand = crate::rm_anova(&table);
    close(simple[3].test.as_ref().unwrap().statistic, by_hand.rm_anova.f);
    let p: Vec<f64> = simple.iter().map(|s| s.test.as_ref().unwrap().p.unwrap()).collect();
    let holm: Vec<Option<f64>> = adjust(&p).unwrap().holm.into_iter().map(Some).collect();
    assert_eq!(simple.iter().map(|s| s.p_holm).collect::<Vec<_>>(), holm);
}

#[test]
fn a_simple_effect_between_people_is_welchs_test_there() {
    let made = made();
    let found = factorial_of(&made.grouped(), true);
    let simple = simple_effects(&made.grouped(), &found).unwrap();
    let at = |factor: &str, level: &str| {
        let mut all = simple.iter();
        all.find(|s| s.factor == factor && s.level == level).unwrap()
    };
    let names: Vec<String> =
        (0..PEOPLE).map(|p| if is_car(p) { "car" } else { "truck" }.to_owned()).collect();
    let calm: Vec<Option<f64>> = (0..PEOPLE).map(|p| Some(roads(p, 0))).collect();
    let welch = groups(&names, &calm).unwrap();
    let welch = welch.welch_t.values().next().unwrap();
    let test = at("vehicle", "calm").test.as_ref().unwrap();
    close(test.p, welch.p);
    close(test.statistic, welch.t.map(|t| t * t));
    // In one group alone: the paired t test of its people.
    let trucks: Vec<usize> = (0..PEOPLE).filter(|p| !is_car(*p)).collect();
    let (two, people) = (
        ["sporty", "calm"].map(str::to_owned),
        trucks.iter().map(ToString::to_string).collect::<Vec<_>>(),
    );
    let rows: Vec<Vec<f64>> = trucks.iter().map(|p| vec![roads(*p, 1), roads(*p, 0)]).collect();
    let all = within(&WithinSubjects::from_rows(&two, &people, &rows).unwrap());
    let t = all.paired.values().next().unwrap();
    close(at("mode", "truck").test.as_ref().unwrap().p, t.p);
}

#[test]
fn an_unknown_factor_or_level_is_refused_by_what_there_is() {
    let made = made();
    let data = made.grouped();
    let found = factorial_of(&data, true);
    for (parts, words) in [
        (vec![("colour", pair("red", "blue"))], "a factor: vehicle, mode, road"),
        (vec![("mode", pair("calm", "brisk"))], "a level of `mode`: calm, sporty"),
        (
            vec![("mode", LevelChoice::At("brisk".to_owned())), ("road", pair("city", "country"))],
            "`brisk` is unknown",
        ),
        (vec![("mode", LevelChoice::At("calm".to_owned()))], "expected an effect"),
    ] {
        let refused = level_contrast(&data, &found, &parts).unwrap_err().to_string();
        assert!(refused.contains(words), "{refused}");
    }
}
