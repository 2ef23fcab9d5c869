use super::*;
use crate::{outcomes::Part as Of, validation::Right};
use maveric_analysis::Verdict::{self, Fails, NotAsked, NotShown, Shown, TooFew};

fn share(hits: usize, n: usize) -> Option<Proportion> {
    proportion(hits, n, 0.95).ok()
}

fn cell(studies: usize) -> Cell {
    Cell {
        participants: 24,
        effect_scale: 0.0,
        studies,
        tests: Vec::new(),
        families: Vec::new(),
        hypotheses: Vec::new(),
        findings: Vec::new(),
    }
}

#[test]
fn a_family_is_kept_at_its_level_after_holm_or_fails() {
    let judged = |holm: &[usize]| {
        let family = |hits: &usize| FamilyRate {
            family: "panel".to_owned(),
            tests: 3,
            any_uncorrected: share(900, 1000),
            any_holm: share(*hits, 1000),
        };
        let families = holm.iter().map(family).collect();
        super::families(&Cell { families, ..cell(1000) }).verdict
    };
    assert_eq!([judged(&[20, 30]), judged(&[50]), judged(&[20, 90])], [Shown, NotShown, Fails]);
    assert_eq!(judged(&[]), NotAsked);
}

#[test]
fn one_test_in_twenty_may_look_lax_and_no_more() {
    let judged = |lax: usize| {
        let test = |i: usize| TestRate {
            part: Of::Nearer,
            key: format!("t{i}"),
            about: String::new(),
            studies: 1000,
            rejected: 0,
            rate: share(if i < lax { 100 } else { 50 }, 1000),
            holm: None,
            mean_estimate: None,
            mean_when_significant: None,
            above_zero: None,
        };
        single(&Cell { tests: (0..200).map(test).collect(), ..cell(1000) }).verdict
    };
    assert_eq!([judged(2), judged(10), judged(30)], [Shown, NotShown, Fails]);
}

fn fidelity(mimic: f64, floor: f64, n: usize) -> Fidelity {
    Fidelity {
        title: "Mean velocity",
        n,
        mimic: Some(mimic),
        population_mean: Some(floor),
        test_retest: Some(0.99),
        ..Fidelity::default()
    }
}

#[test]
fn the_least_accurate_model_decides_whether_the_car_is_like_its_driver() {
    let judged = |models: [f64; 2]| {
        let rows = models.map(|mimic| vec![fidelity(mimic, 0.8, 24)]);
        own_style(&[&rows[0], &rows[1]]).verdict
    };
    assert_eq!(
        [judged([0.9, 0.81]), judged([0.9, 0.79]), judged([0.7, 0.6])],
        [Shown, NotShown, Fails]
    );
    assert_eq!(own_style(&[&[fidelity(0.9, 0.8, 5)]]).verdict, TooFew);
}

#[test]
fn a_driver_is_recognised_by_the_distance_that_knows_how_people_vary() {
    let row = |metric, hits: usize, n: usize| {
        let share = share(hits, n).unwrap();
        Identification {
            what: "embedding",
            metric,
            n,
            hits,
            rate: share.estimate,
            low: share.low,
            high: share.high,
            mean_rank: 1.0,
        }
    };
    let judged = |hits, n| {
        let rows = [row(Metric::Euclidean, n - hits, n), row(Metric::WithinPerson, hits, n)];
        recognised(&[&rows]).unwrap().verdict
    };
    assert_eq!([judged(20, 24), judged(1, 24), judged(3, 5)], [Shown, NotShown, TooFew]);
    assert_eq!(recognised(&[]), None);
}

#[test]
fn the_dial_needs_more_than_half_of_the_drivers_on_both_sides_for_every_model() {
    let judged = |up: usize, down: usize| {
        let right = |right| Right { right, n: 24, ..Right::default() };
        let row = |up, down| Dial {
            title: "Mean velocity",
            aggressive: right(up),
            cautious: right(down),
            ..Dial::default()
        };
        let (first, second) = ([row(24, 24)], [row(up, down)]);
        dial(&[&first, &second]).verdict
    };
    assert_eq!([judged(24, 24), judged(24, 12), judged(2, 24)], [Shown, NotShown, Fails]);
}

#[test]
fn the_score_is_told_by_driving_alone_when_the_fit_without_it_goes_with_it() {
    let judged = |low: f64, high: f64| {
        let row = |reading, interval| Agreement {
            reading,
            n: 24,
            adb: Some(0.5 * (low + high)),
            adb_interval: Some(interval),
            latent: None,
        };
        // The fit with the score says the opposite.
        let rows =
            [row(Reading::WithScore, (-high, -low)), row(Reading::WithoutScore, (low, high))];
        style(&[&rows]).unwrap().verdict
    };
    assert_eq!([judged(0.1, 0.6), judged(-0.1, 0.6), judged(-0.6, -0.1)], [Shown, NotShown, Fails]);
    assert_eq!(style(&[&[]]), None);
}

#[test]
fn one_collision_is_enough() {
    let judged = |hits, n| safe(hits, n).verdict;
    let all: [Verdict; 3] = [judged(0, 24), judged(1, 24), judged(0, 3)];
    assert_eq!(all, [Shown, Fails, TooFew]);
}

use crate::leave_out::{Asked, Mean, ReadOrder};

fn order(right: usize, n: usize, p: f64, beyond: (f64, f64)) -> Order {
    let read = |by, right| ReadOrder {
        by,
        n,
        right,
        share: maveric_stats::proportion_exact(right, n, 0.95).ok(),
        p: Some(p),
        p_below: Some(1.0 - p),
        difference: None,
        beyond_speed: Some(Mean {
            n,
            mean: f64::midpoint(beyond.0, beyond.1),
            low: Some(beyond.0),
            high: Some(beyond.1),
            dz: None,
        }),
    };
    Order {
        asked: Asked { higher: "sporty".parse().unwrap(), lower: vec!["calm".parse().unwrap()] },
        chance: 0.5,
        // Speed says the opposite.
        readings: vec![read(By::Line, right), read(By::Speed, n - right)],
        people: Vec::new(),
        permutations: 1000,
        uncounted: Vec::new(),
    }
}

#[test]
fn an_order_is_shown_by_the_p_of_exchanged_roles_and_fails_on_the_other_side() {
    let judged = |right, n, p| ordered(&[&order(right, n, p, (0.0, 0.0))]).verdict;
    assert_eq!(
        [judged(6, 6, 0.016), judged(5, 6, 0.11), judged(0, 6, 0.99), judged(5, 5, 0.031)],
        [Shown, NotShown, Fails, TooFew]
    );
}

#[test]
fn a_line_says_more_than_speed_where_the_paired_difference_lies_above_0() {
    let judged = |n, beyond| beyond_speed(&[&order(n, n, 0.016, beyond)]).verdict;
    assert_eq!(
        [
            judged(6, (0.1, 0.9)),
            judged(6, (-0.1, 0.9)),
            judged(6, (-0.9, -0.1)),
            judged(5, (0.1, 0.9))
        ],
        [Shown, NotShown, Fails, TooFew]
    );
}

#[test]
fn a_driver_is_recognised_by_the_style_and_not_by_speed() {
    let row = |by, hits, n| Whose {
        among: "calm".parse().unwrap(),
        sought: "sporty".parse().unwrap(),
        by,
        n,
        candidates: n as f64,
        chance: 1.0 / n as f64,
        hits,
        share: maveric_stats::proportion_exact(hits, n, 0.95).ok(),
        uncounted: Vec::new(),
    };
    let judged =
        |hits, n| recognised_unmet(&[row(By::Line, hits, n), row(By::Speed, n - hits, n)]).verdict;
    assert_eq!([judged(20, 24), judged(2, 24), judged(5, 5)], [Shown, NotShown, TooFew]);
}

#[test]
fn a_dial_has_to_point_better_than_directions_that_are_drawn() {
    let judged = |dial: f64, p: f64, n| {
        let direction = Direction {
            n,
            driven: None,
            dial: Some(dial),
            speed: None,
            speed_and_gap: None,
            directions: 1000,
            drawn: Some(0.0),
            p: Some(p),
            p_below: Some(1.0 - p),
            people: Vec::new(),
        };
        pointed(&[&direction]).verdict
    };
    assert_eq!(
        [judged(0.8, 0.01, 6), judged(0.5, 0.2, 6), judged(-0.8, 0.99, 6), judged(0.8, 0.01, 3)],
        [Shown, NotShown, Fails, TooFew]
    );
}
