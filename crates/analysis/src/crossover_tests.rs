//! Studies whose orders are known: what the period, the gate and carry-over do to them.

use crate::{
    Analysis, AnalysisError, Balance, ContrastTest, Person, Purpose, Question, StudyData, Tables,
    Verdict, analyse, finding,
    testing::{analysed_by, design, drive, id, panel, person, plain, score},
};
use Verdict::{Fails, NotShown, NotTestable, NotTested, Shown, TooFew};
use maveric_domain::{
    ConditionId, Moment,
    design::{OrderPlan, Square},
};
use maveric_stats::{ByDesign, CarryOver, NoCarryOver, PERIOD};
use std::collections::BTreeMap;

const CONDITIONS: [&str; 4] = ["calm", "even", "brisk", "sporty"];
const SPEED: &str = "mean_velocity_mps";
const GAP: &str = "mean_headway_time_s";

/// A design of the four conditions without a baseline, so that values are tested as measured.
fn text(outcomes: &str) -> String {
    plain(&CONDITIONS, outcomes).replace("[baseline]\nid = \"own\"\n", "")
}

fn primary(measure: &str, test: &str) -> String {
    format!(
        "[[outcome]]\nmeasure = \"{measure}\"\nprimary = true\ntest = \"{test}\"\ncontrast = [\"sporty\", \"calm\"]\n"
    )
}

/// Numbers between -1 and 1 without order.
fn noise(i: usize, k: usize) -> f64 {
    let mixed = (i * 31 + k * 17 + (i * k) % 13) * 7919 % 1009;
    mixed as f64 / 504.5 - 1.0
}

/// People who met the conditions by a Williams square: speed is 0.5 a step from calm to sporty (times `effect`) and `trend` a ride, the
/// gap is nothing but chance and the same trend.
fn ridden(people: usize, effect: f64, trend: f64) -> Tables {
    let plan = OrderPlan::new(&design(&text("")), Square::Williams, None).unwrap();
    let mut tables = Tables::default();
    for i in 0..people {
        let order = plan.order(i);
        for (k, condition) in CONDITIONS.into_iter().enumerate() {
            let period = order.iter().position(|c| *c == id(condition)).unwrap() as f64;
            let base = 25.0 + noise(i, 90);
            let mut ride = drive(i, condition, None);
            let speed = base + effect * k as f64 + trend * period + noise(i, k);
            let gap = base + trend * period + noise(i, 40 + k);
            ride.values =
                BTreeMap::from([(SPEED.to_owned(), Some(speed)), (GAP.to_owned(), Some(gap))]);
            tables.measurements.push(ride);
        }
        tables.people.push(Person {
            id: person(i),
            learned: false,
            tested: true,
            order,
            columns: BTreeMap::new(),
        });
    }
    tables
}

fn both() -> String {
    text(&(primary(SPEED, "mixed") + &primary(GAP, "mixed")))
}

fn verdicts(a: &Analysis) -> Vec<Verdict> {
    a.primary.iter().map(|o| o.verdict).collect()
}

#[test]
fn a_study_with_orders_has_the_period_in_every_test_and_one_without_has_none() {
    let measured = text(&format!("[[outcome]]\nmeasure = \"{SPEED}\"\n"));
    let with = analysed_by(&measured, ridden(12, 0.5, 0.3));
    let speed_panel = panel(&with, SPEED);
    let terms: Vec<&str> =
        speed_panel.comparison.as_ref().unwrap().effects().into_iter().map(|(n, _)| n).collect();
    assert_eq!(terms, ["condition", PERIOD]);
    assert_eq!(speed_panel.test, Some(ContrastTest::Mixed));
    assert!(speed_panel.contrasts.iter().all(|c| c.se.is_some() && c.interval.is_some()));
    let mut unknown = ridden(12, 0.5, 0.3);
    for p in &mut unknown.people {
        p.order.clear();
    }
    let without = analysed_by(&measured, unknown);
    let plain = panel(&without, SPEED);
    assert!(matches!(plain.comparison, Some(ByDesign::OneFactor(_))));
    assert!(plain.carry_over.is_none() && plain.balance.is_none());
    // A trend over the rides costs the test without the period, and not the one with it.
    let steep = analysed_by(&measured, ridden(12, 0.5, 3.0));
    for (a, b) in panel(&steep, SPEED).contrasts.iter().zip(&speed_panel.contrasts) {
        assert!((a.mean_difference.unwrap() - b.mean_difference.unwrap()).abs() < 1e-9);
        assert!((a.p.unwrap() - b.p.unwrap()).abs() < 1e-9);
    }
}

#[test]
fn the_choice_by_what_the_data_look_like_is_declared_by_name_and_says_so() {
    let auto = text(&format!("[[outcome]]\nmeasure = \"{SPEED}\"\ntest = \"auto\"\n"));
    let a = analysed_by(&auto, ridden(12, 0.5, 0.3));
    let speed_panel = panel(&a, SPEED);
    assert!(matches!(speed_panel.comparison, Some(ByDesign::OneFactor(_))));
    assert!(speed_panel.reasons.iter().any(|r| r.contains("`test = \"auto\"`")));
}

#[test]
fn primary_outcomes_are_tested_in_the_order_written_until_the_first_that_is_not_below_alpha() {
    let a = analysed_by(&both(), ridden(16, 0.5, 0.3));
    assert_eq!(verdicts(&a), [Shown, NotShown]);
    let turned = text(&(primary(GAP, "mixed") + &primary(SPEED, "mixed")));
    let closed = analysed_by(&turned, ridden(16, 0.5, 0.3));
    assert_eq!(verdicts(&closed), [NotShown, NotTested]);
    let second = &closed.primary[1];
    assert_eq!((second.closed_by.as_deref(), second.p), (Some(GAP), None));
    assert_eq!(
        finding::by_question(&closed.findings, Question::Primary(2)).unwrap().verdict,
        NotTested
    );
    // The same numbers, tested: the gate alone keeps them back.
    let first = &a.primary[0];
    assert!(first.p.unwrap() < 0.05 && first.interval.unwrap().0 > 0.0);
    assert_eq!(finding::by_question(&a.findings, Question::Primary(1)).unwrap().verdict, Shown);
    // Of too few people nothing is said, and the gate closes.
    let few = analysed_by(&both(), ridden(5, 0.5, 0.3));
    assert_eq!(verdicts(&few), [TooFew, NotTested]);
}

#[test]
fn a_hypothesis_about_a_primary_contrast_has_its_unadjusted_p_and_none_behind_a_closed_gate() {
    let says = |outcome: &str| {
        format!(
            "[[hypothesis]]\nsays = \"h\"\noutcome = \"{outcome}\"\ncontrast = [\"calm\", \"sporty\"]\ndirection = \"-\"\n"
        )
    };
    let a = analysed_by(&(both() + &says(SPEED)), ridden(16, 0.5, 0.3));
    let judged = &a.hypotheses[0];
    assert!(!judged.holm);
    assert_eq!((judged.verdict, judged.p), (Shown, a.primary[0].p));
    assert!(
        (judged.mean_difference.unwrap() + a.primary[0].mean_difference.unwrap()).abs() < 1e-12
    );
    let (low, high) = judged.interval.unwrap();
    assert!(low < high && high < 0.0);
    let turned = text(&(primary(GAP, "mixed") + &primary(SPEED, "mixed"))) + &says(SPEED);
    let closed = analysed_by(&turned, ridden(16, 0.5, 0.3));
    assert_eq!((closed.hypotheses[0].verdict, closed.hypotheses[0].p), (NotTested, None));
}

#[test]
fn equivalence_is_of_the_model_with_the_narrower_interval_beside_both_one_sided_tests() {
    let says = |low: f64, high: f64| {
        format!(
            "[[hypothesis]]\nsays = \"same\"\noutcome = \"{GAP}\"\ncontrast = [\"sporty\", \"calm\"]\nequivalent = [{low:?}, {high:?}]\n"
        )
    };
    let judged = |low, high| {
        let a = analysed_by(
            &(text(&format!("[[outcome]]\nmeasure = \"{GAP}\"\n")) + &says(low, high)),
            ridden(16, 0.0, 3.0),
        );
        let contrast = panel(&a, GAP)
            .contrasts
            .iter()
            .find(|c| c.first == id("sporty") && c.second == id("calm"))
            .unwrap()
            .clone();
        (a.hypotheses[0].clone(), contrast)
    };
    let (same, contrast) = judged(-1.5, 1.5);
    assert_eq!(same.verdict, Shown);
    assert_eq!(same.mean_difference, contrast.mean_difference);
    let width = |ends: Option<(f64, f64)>| ends.map(|(low, high)| high - low).unwrap();
    assert!(width(same.interval) < width(contrast.interval));
    let (low, high) = same.interval.unwrap();
    assert!(low > -1.5 && high < 1.5 && same.p.unwrap() < 0.05);
    let (elsewhere, _) = judged(3.0, 5.0);
    assert_eq!(elsewhere.verdict, Verdict::Fails);
}

#[test]
fn carry_over_stands_beside_and_changes_no_verdict() {
    let a = analysed_by(&both(), ridden(16, 0.5, 0.3));
    let speed_panel = panel(&a, SPEED);
    let Some(CarryOver::Fitted(carried)) = &speed_panel.carry_over else {
        panic!("{:?}", speed_panel.carry_over)
    };
    assert!((carried.variance_ratio - 1.1).abs() < 1e-12);
    assert_eq!(
        (carried.effects.len(), speed_panel.balance),
        (4, Some(Balance::PlacesAndSuccession))
    );
    let sum: f64 = carried.effects.values().map(|e| e.estimate).sum();
    assert!(sum.abs() < 1e-9);
    // What was planted for the ride after the sporty car is found, and the primary p is the model's without it.
    let mut left = ridden(16, 0.5, 0.3);
    for ride in &mut left.measurements {
        let order = &left.people.iter().find(|p| p.id == ride.meta.participant).unwrap().order;
        let place = order.iter().position(|c| *c == ride.meta.condition).unwrap();
        if place > 0 && order[place - 1] == id("sporty") {
            *ride.values.get_mut(SPEED).unwrap() = ride.values[SPEED].map(|v| v + 4.0);
        }
    }
    let b = analysed_by(&both(), left);
    let Some(CarryOver::Fitted(carried)) = &panel(&b, SPEED).carry_over else { panic!("fitted") };
    assert!(
        carried.test.p.unwrap() < 0.001 && carried.effects.get("sporty").unwrap().estimate > 2.0
    );
    let pair = |c: &&crate::Contrast| c.first == id("calm") && c.second == id("sporty");
    let contrast = panel(&b, SPEED).contrasts.iter().find(pair).unwrap();
    assert_eq!(b.primary[0].p, contrast.p);
    // A simulation of many studies does without.
    let data = StudyData::new(&design(&both()), ridden(16, 0.5, 0.3)).unwrap();
    let quick = analyse(&data, Purpose::Simulation).unwrap();
    assert!(panel(&quick, SPEED).carry_over.is_none());
    assert_eq!(verdicts(&quick), verdicts(&a));
}

#[test]
fn people_whose_order_is_not_known_are_left_out_and_named_and_uneven_orders_are_said() {
    let mut tables = ridden(16, 0.5, 0.3);
    tables.people[3].order.clear();
    tables.people[7].order.truncate(2);
    for i in [0, 4, 8] {
        let order: Vec<ConditionId> = CONDITIONS.iter().map(|c| id(c)).collect();
        tables.people[i].order = order;
    }
    let a = analysed_by(&both(), tables);
    let speed_panel = panel(&a, SPEED);
    assert_eq!(speed_panel.n, 14);
    assert_eq!(speed_panel.without_order, ["P4", "P8"]);
    assert_eq!(speed_panel.dropped, speed_panel.without_order);
    assert_eq!(speed_panel.lacking(), 0);
    let why = a.exclusions.iter().find(|e| e.who == "P4").unwrap();
    assert!(why.why.contains("order in which the conditions were met"), "{}", why.why);
    assert_eq!(speed_panel.balance, Some(Balance::Neither));
    assert!(speed_panel.contrasts.iter().all(|c| c.people.iter().sum::<usize>() == 14));
}

#[test]
fn tests_without_a_period_are_refused_where_orders_are_known_and_run_where_none_is() {
    for (test, kind) in [("rm-anova", ContrastTest::T), ("friedman", ContrastTest::Wilcoxon)] {
        let declared = text(&primary(SPEED, test));
        let data = StudyData::new(&design(&declared), ridden(12, 0.5, 0.3)).unwrap();
        let refused = analyse(&data, Purpose::Report).unwrap_err();
        assert!(matches!(refused, AnalysisError::NoPeriod { people: 12, .. }));
        assert!(refused.to_string().contains(test) && refused.suggestion().is_some());
        let mut unknown = ridden(12, 0.5, 0.0);
        for p in &mut unknown.people {
            p.order.clear();
        }
        let a = analysed_by(&declared, unknown);
        assert_eq!((panel(&a, SPEED).test, a.primary[0].verdict), (Some(kind), Shown));
    }
}

#[test]
fn an_item_is_tested_by_its_order_with_the_period_and_has_no_carry_over() {
    let rated = "[[outcome]]\nscale = \"comfort.total\"\nprimary = true\ntest = \"ordinal\"\ncontrast = [\"sporty\", \"calm\"]\n";
    let mut tables = ridden(16, 0.0, 0.0);
    for i in 0..16 {
        for (k, condition) in CONDITIONS.into_iter().enumerate() {
            let answer = (2.0 + k as f64 + 1.4 * noise(i, 60 + k)).round().clamp(1.0, 7.0);
            let after = Moment::after(id(condition));
            tables.post.push(score(i, after, "comfort", "total", answer));
        }
    }
    let says = "[[hypothesis]]\nsays = \"h\"\noutcome = \"comfort.total\"\ncontrast = [\"calm\", \"sporty\"]\ndirection = \"-\"\n";
    let a = analysed_by(&(text(rated) + says), tables);
    let comfort_panel = panel(&a, "comfort.total");
    assert!(matches!(comfort_panel.comparison, Some(ByDesign::Ordinal(_))));
    assert_eq!((comfort_panel.test, a.primary[0].verdict), (Some(ContrastTest::Ordinal), Shown));
    // The difference is that of the answers, not of logits.
    let difference = a.primary[0].mean_difference.unwrap();
    assert!((2.0..4.0).contains(&difference) && a.primary[0].interval.is_none());
    let odds = a.primary[0].odds.unwrap();
    let (low, high) = odds.interval.unwrap();
    // The whole interval above 1, as p is below .05.
    assert!(1.0 < low && low < odds.ratio && odds.ratio < high, "{odds:?}");
    let pair = ["calm", "sporty"].map(id);
    let turned = crate::pairs::contrast(comfort_panel, pair).unwrap().odds;
    let turned = turned.unwrap();
    assert!((turned.ratio * odds.ratio - 1.0).abs() < 1e-9);
    assert!((turned.interval.unwrap().0 * high - 1.0).abs() < 1e-9);
    let judged = &a.hypotheses[0];
    assert_eq!((judged.odds, judged.interval), (Some(turned), None));
    assert_eq!((judged.verdict, judged.p), (Shown, a.primary[0].p));
    assert!(a.primary[0].p.unwrap() < 0.05);
    assert_eq!(
        comfort_panel.carry_over,
        Some(CarryOver::NotFitted { why_not: NoCarryOver::OrderedAnswers })
    );
}

const COMFORT: &str = "comfort.total";

/// The same rides, after which a person (from 0) answered so to an item on a condition (from 0).
fn answered(answer: impl Fn(usize, usize) -> f64) -> Tables {
    let mut tables = ridden(16, 0.5, 0.3);
    for i in 0..16 {
        for (k, condition) in CONDITIONS.into_iter().enumerate() {
            let after = Moment::after(id(condition));
            let answer = score(i, after, "comfort", "total", answer(i, k));
            tables.post.push(answer);
        }
    }
    tables
}

/// Comfort is primary, then speed; the hypothesis says that calm lies above sporty, or below.
fn comfort_first(sign: &str) -> String {
    let comfort = format!(
        "[[outcome]]\nscale = \"{COMFORT}\"\nprimary = true\ntest = \"ordinal\"\ncontrast = [\"sporty\", \"calm\"]\n"
    );
    let says = format!(
        "[[hypothesis]]\nsays = \"h\"\noutcome = \"{COMFORT}\"\ncontrast = [\"calm\", \"sporty\"]\ndirection = \"{sign}\"\n"
    );
    text(&(comfort + &primary(SPEED, "mixed"))) + &says
}

#[test]
fn an_item_at_its_floor_after_one_condition_is_tested_by_its_likelihood_ratio_and_opens_the_gate() {
    let scattered = |i: usize, k: usize| (4.0 + 1.6 * noise(i, 60 + k)).round().clamp(2.0, 7.0);
    let floor = |i: usize, k: usize| if k == 3 { 1.0 } else { scattered(i, k) };
    // Everybody says yes but after sporty, nobody there: no condition has a finite coefficient.
    let whole = |_: usize, k: usize| if k == 3 { 0.0 } else { 1.0 };
    for (way, verdict) in [("+", Shown), ("-", Fails)] {
        for tables in [answered(floor), answered(whole)] {
            let a = analysed_by(&comfort_first(way), tables);
            assert_eq!(verdicts(&a), [Shown, Shown]);
            let comfort = &a.primary[0];
            assert!(comfort.p.unwrap() < 0.001 && comfort.mean_difference.unwrap() < 0.0);
            assert!(comfort.unbounded && comfort.odds.is_none() && comfort.why_not.is_none());
            let judged = &a.hypotheses[0];
            assert_eq!((judged.verdict, judged.p), (verdict, comfort.p));
            assert!(judged.unbounded && judged.mean_difference.unwrap() > 0.0);
            let pair = crate::pairs::contrast(panel(&a, COMFORT), ["sporty", "calm"].map(id));
            // The signed root of the ratio, which is held against F.
            assert!(pair.unwrap().statistic.unwrap().abs() > 3.0);
        }
    }
    // Two conditions at the floor do not differ, and what can be estimated is.
    let two = |i: usize, k: usize| {
        if k.is_multiple_of(3) { 1.0 } else { scattered(i, k) }
    };
    let a = analysed_by(&comfort_first("+"), answered(two));
    assert_eq!(verdicts(&a), [NotShown, NotTested]);
    assert!(a.primary[0].p.unwrap() > 0.99);
    let finite = crate::pairs::contrast(panel(&a, COMFORT), ["even", "brisk"].map(id)).unwrap();
    assert!(finite.odds.is_some() && !finite.unbounded);
}

#[test]
fn what_cannot_be_tested_is_neither_shown_nor_not_shown_says_why_and_closes_the_gate() {
    // Answers that nobody varies have no model.
    let a = analysed_by(&comfort_first("+"), answered(|_, _| 3.0));
    assert_eq!(verdicts(&a), [NotTestable, NotTested]);
    let comfort = &a.primary[0];
    assert!(comfort.p.is_none() && !comfort.unbounded);
    let why = comfort.why_not.as_ref().unwrap();
    assert!(why.contains("all answers are 3"), "{why}");
    let judged = &a.hypotheses[0];
    assert_eq!((judged.verdict, judged.n), (NotTestable, 16));
    assert_eq!((judged.mean_difference, judged.interval), (Some(0.0), None));
    assert_eq!(&judged.why_not, &comfort.why_not);
    let question = |question| finding::by_question(&a.findings, question).unwrap().verdict;
    assert_eq!(question(Question::Primary(1)), NotTestable);
    assert_eq!(question(Question::Hypothesis(1)), NotTestable);
}

#[test]
fn where_the_declared_test_has_no_result_no_other_steps_in() {
    // A speed is no ordered answer.
    let a = analysed_by(&text(&primary(SPEED, "ordinal")), ridden(16, 0.5, 0.3));
    let speed_panel = panel(&a, SPEED);
    assert!(speed_panel.comparison.is_none() && speed_panel.test.is_none());
    assert!(
        speed_panel.contrasts.len() == 6 && speed_panel.contrasts.iter().all(|c| c.p.is_none())
    );
    assert!(speed_panel.reasons[0].contains("whole number"), "{:?}", speed_panel.reasons);
    assert_eq!((a.primary[0].p, a.primary[0].verdict), (None, NotTestable));
    let why = a.primary[0].why_not.as_ref().unwrap();
    assert!(why.contains("whole number"), "{why}");
    // One order for all: the condition is one thing with the period.
    let mut same = ridden(16, 0.5, 0.3);
    let order = same.people[0].order.clone();
    for p in &mut same.people {
        p.order.clone_from(&order);
    }
    let b = analysed_by(&text(&primary(SPEED, "mixed")), same);
    let speed_panel = panel(&b, SPEED);
    assert!(speed_panel.reasons[0].contains("condition and period cannot be told apart"));
    assert!(speed_panel.contrasts.iter().all(|c| c.p.is_none()));
}

#[test]
fn with_one_order_for_all_an_outcome_without_a_declared_test_is_tested_without_the_period() {
    let mut same = ridden(16, 0.5, 0.3);
    let order = same.people[0].order.clone();
    for p in &mut same.people {
        p.order.clone_from(&order);
    }
    let analysis = analysed_by(&text(""), same);
    let speed_panel = panel(&analysis, SPEED);
    assert!(
        speed_panel.contrasts.iter().all(|c| c.p.is_some()) && speed_panel.without_order.is_empty()
    );
    assert!(
        speed_panel.reasons.iter().any(|r| r.contains("do not tell the period")),
        "{:?}",
        speed_panel.reasons
    );
}
