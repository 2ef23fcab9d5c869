//! The period in a test, and carry-over, on orders of Williams squares.

use super::*;
use crate::{Comparison, OmnibusTest, PosthocTest, numerics::distributions::normal_quantile};

/// Rows of a Williams square of three, four or five conditions.
fn orders(k: usize) -> Vec<Vec<usize>> {
    let zigzag = |i: usize| if i % 2 == 1 { i.div_ceil(2) } else { k - i / 2 };
    let first: Vec<usize> = (0..k).map(|i| if i == 0 { 0 } else { zigzag(i) % k }).collect();
    let row = |add: usize| first.iter().map(|c| (c + add) % k).collect::<Vec<_>>();
    let mut rows: Vec<Vec<usize>> = (0..k).map(row).collect();
    if k % 2 == 1 {
        let mirrored: Vec<Vec<usize>> =
            rows.iter().map(|r| r.iter().rev().copied().collect()).collect();
        rows.extend(mirrored);
    }
    rows
}

/// What a study of rides is made of.
struct Made {
    people: Vec<String>,
    conditions: Vec<String>,
    periods: Vec<usize>,
    values: Vec<Option<f64>>,
}

const NAMES: [&str; 5] = ["a", "b", "c", "d", "e"];

/// Values of people who met the conditions in these orders: `of` a person, condition, period (from 0) and the condition before.
fn made(
    orders: &[Vec<usize>],
    people: usize,
    of: impl Fn(usize, usize, usize, Option<usize>) -> f64,
) -> Made {
    let rows = || {
        (0..people).flat_map(|person| {
            let order = &orders[person % orders.len()];
            (0..order.len()).map(move |period| {
                let before = period.checked_sub(1).map(|at| order[at]);
                (person, order[period], period, before)
            })
        })
    };
    Made {
        people: rows().map(|(p, ..)| format!("p{p}")).collect(),
        conditions: rows().map(|(_, c, ..)| NAMES[c].to_owned()).collect(),
        periods: rows().map(|(_, _, period, _)| period + 1).collect(),
        values: rows().map(|(p, c, t, b)| Some(of(p, c, t, b))).collect(),
    }
}

impl Made {
    fn columns(&self) -> DesignColumns<'_> {
        DesignColumns {
            subjects: &self.people,
            within: vec![("condition", &self.conditions)],
            periods: &self.periods,
            values: &self.values,
            ..DesignColumns::default()
        }
    }

    fn tested(&self, test: AskedTest, scale: OutcomeScale) -> Result<ByDesign, StatsError> {
        let choice = DesignChoice { test, scale, ..DesignChoice::default() };
        compare_by_design(&self.columns(), &choice)
    }

    fn mixed(&self) -> MixedFinding {
        let ByDesign::Mixed(found) = self.tested(AskedTest::Chosen, OutcomeScale::Measure).unwrap()
        else {
            panic!("a mixed model")
        };
        found.found
    }

    fn carried(&self) -> CarriedOver {
        match carry_over(&self.columns()).unwrap() {
            CarryOver::Fitted(found) => *found,
            CarryOver::NotFitted { why_not } => panic!("{why_not}"),
        }
    }

    fn why_not(&self) -> NoCarryOver {
        match carry_over(&self.columns()).unwrap() {
            CarryOver::Fitted(_) => panic!("fitted"),
            CarryOver::NotFitted { why_not } => why_not,
        }
    }
}

/// Nearly normal numbers without order.
fn noise(seed: usize, i: usize) -> f64 {
    let mixed = (seed.wrapping_mul(0x9E37_79B9) ^ i.wrapping_mul(0x85EB_CA6B)) as u64;
    let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x2C1B_3C6D);
    let mixed = (mixed ^ (mixed >> 12)).wrapping_mul(0x297A_2D39);
    let mixed = (mixed ^ (mixed >> 15)) % 1_000_003;
    normal_quantile((mixed as f64 + 0.5) / 1_000_003.0)
}

#[test]
fn carry_over_costs_a_quarter_a_tenth_and_an_eighteenth_in_squares_of_three_four_and_five() {
    for (k, ratio) in [(3, 5.0 / 4.0), (4, 11.0 / 10.0), (5, 19.0 / 18.0)] {
        let rows = orders(k);
        let study = made(&rows, 2 * rows.len(), |p, c, t, _| noise(1, 100 * p + 10 * c + t));
        assert!((study.carried().variance_ratio - ratio).abs() < 1e-12, "{k}");
    }
}

#[test]
fn a_planted_carry_over_comes_back_at_its_size_and_condition_and_period_with_it() {
    let (effects, left) = ([0.0, 1.0, 3.0, -1.0], [0.5, -0.3, 0.1, -0.3]);
    let study = made(&orders(4), 16, |p, c, t, before| {
        let slight = 1e-4 * noise(2, 100 * p + 10 * c + t);
        noise(3, p) + effects[c] + 0.7 * t as f64 + before.map_or(0.0, |b| left[b]) + slight
    });
    let found = study.carried();
    for (name, planted) in NAMES.iter().zip(left) {
        let effect = found.effects.get(name).unwrap();
        assert!((effect.estimate - planted).abs() < 1e-3, "{name}: {}", effect.estimate);
    }
    assert!(found.test.p.unwrap() < 1e-6);
    for (pair, contrast) in found.contrast.iter() {
        let (a, b) = pair.split_once('|').unwrap();
        let of = |name: &str| effects[NAMES.iter().position(|n| *n == name).unwrap()];
        assert!((contrast.estimate - (of(a) - of(b))).abs() < 1e-3, "{pair}");
    }
    // The verdict's own test does not look at it: there it is left in the conditions.
    let verdict = study.mixed();
    assert!(verdict.model.anova.get(TERM_OF_CARRY_OVER).is_none());
}

const TERM_OF_CARRY_OVER: &str = "carry_over";

#[test]
fn over_many_tables_carry_over_is_without_bias_and_its_intervals_cover_it() {
    let planted = [0.4, 0.0, -0.4];
    let rows = orders(3);
    let (mut sum, mut squares, mut covered, mut count) = (0.0, 0.0, 0, 0);
    for table in 0..400 {
        let study = made(&rows, 12, |p, c, t, before| {
            let own = noise(4, 1000 * table + p);
            own + 0.5 * c as f64
                + 0.3 * t as f64
                + before.map_or(0.0, |b| planted[b])
                + noise(5, 100_000 * table + 100 * p + 10 * c + t)
        });
        let found = study.carried();
        let effect = found.effects.get("a").unwrap();
        let off = effect.estimate - planted[0];
        (sum, squares, count) = (sum + off, squares + off * off, count + 1);
        let (low, high) = (effect.ci.low.unwrap(), effect.ci.high.unwrap());
        covered += usize::from(low <= planted[0] && planted[0] <= high);
    }
    let n = f64::from(count);
    let error = (squares / n / n).sqrt();
    assert!((sum / n).abs() < 2.0 * error, "bias {} ± {error}", sum / n);
    let share = covered as f64 / n;
    assert!((0.93..=0.97).contains(&share), "coverage {share}");
}

#[test]
fn a_period_however_large_is_taken_out_of_a_balanced_study() {
    let study = |slope: f64| {
        made(&orders(4), 8, |p, c, t, _| noise(6, 100 * p + 10 * c + t) + slope * t as f64)
    };
    let (without, with) = (study(0.0).mixed(), study(40.0).mixed());
    let same = |a: f64, b: f64| (a - b).abs() < 1e-6;
    for (pair, contrast) in without.model.contrast.get("condition").unwrap().iter() {
        let other = with.model.contrast.get("condition").unwrap().get(pair).unwrap();
        assert!(same(contrast.estimate, other.estimate) && same(contrast.se, other.se));
    }
    assert!(with.model.anova.get(PERIOD).unwrap().p.unwrap() < 1e-6);
    // Whatever the period's p, it stays in the model.
    assert!(without.model.anova.get(PERIOD).unwrap().p.unwrap() > 0.05);
    assert!(without.p("condition").is_some() && with.corrected.get("condition").is_some());
}

#[test]
fn why_carry_over_is_not_fitted_is_a_value() {
    let flat = |p: usize, c: usize, t: usize, _: Option<usize>| noise(7, 100 * p + 10 * c + t);
    assert_eq!(made(&orders(2), 8, flat).why_not(), NoCarryOver::TwoConditions);
    let few = NoCarryOver::FewPeople { people: 6, orders: 6 };
    assert_eq!(made(&orders(3), 6, flat).why_not(), few);
    assert!(few.to_string().contains("6 people in 6 different orders"));
    // Two orders tell conditions from periods, and no more.
    let two = [vec![0, 1, 2], vec![1, 2, 0]];
    assert_eq!(made(&two, 8, flat).why_not(), NoCarryOver::NotConnected);
    let grouped = made(&orders(3), 12, flat);
    let group: Vec<Option<String>> = (0..36).map(|i| Some((i / 18).to_string())).collect();
    let columns = DesignColumns { between: vec![("group", &group)], ..grouped.columns() };
    assert_eq!(
        carry_over(&columns).unwrap(),
        CarryOver::NotFitted { why_not: NoCarryOver::SeveralFactors }
    );
}

#[test]
fn one_order_for_all_cannot_tell_condition_from_period_and_has_no_test() {
    let flat = |p: usize, c: usize, t: usize, _: Option<usize>| noise(8, 100 * p + 10 * c + t);
    let study = made(&[vec![0, 1, 2]], 9, flat);
    let refused = study.tested(AskedTest::Mixed, OutcomeScale::Measure).unwrap_err();
    assert!(refused.to_string().contains("condition and period"), "{refused}");
    let two = made(&[vec![0, 1, 2], vec![1, 2, 0]], 8, flat);
    assert!(two.tested(AskedTest::Mixed, OutcomeScale::Measure).is_ok());
}

#[test]
fn a_test_that_is_asked_for_is_run_whatever_the_data_look_like() {
    // One wild value: left to the checks this is Friedman's test.
    let mut study = made(&orders(3), 12, |p, c, t, _| {
        noise(9, 100 * p + 10 * c + t) + c as f64 + if p == 0 && c == 0 { 90.0 } else { 0.0 }
    });
    study.periods.clear();
    let chosen = |test| -> Comparison {
        let ByDesign::OneFactor(found) = study.tested(test, OutcomeScale::Measure).unwrap() else {
            panic!("one factor")
        };
        *found
    };
    assert_eq!(chosen(AskedTest::Chosen).chosen, OmnibusTest::Friedman);
    let anova = chosen(AskedTest::RmAnova);
    assert_eq!((anova.chosen, anova.posthoc.test), (OmnibusTest::RmAnova, PosthocTest::T));
    assert!(anova.reasons[0].starts_with("analysis of variance, as declared"));
    assert_eq!(chosen(AskedTest::Friedman).omnibus, chosen(AskedTest::Chosen).omnibus);
    let mixed = study.tested(AskedTest::Mixed, OutcomeScale::Measure).unwrap();
    assert_eq!(mixed.effects().len(), 1);
}

#[test]
fn ranks_and_differences_take_no_period_and_are_refused_where_orders_are_known() {
    let study = made(&orders(3), 12, |p, c, t, _| noise(10, 100 * p + 10 * c + t));
    for test in [AskedTest::RmAnova, AskedTest::Friedman] {
        let refused = study.tested(test, OutcomeScale::Measure).unwrap_err();
        assert!(refused.to_string().contains("takes no period"), "{refused}");
    }
}

#[test]
fn an_item_has_an_ordinal_model_with_the_period_and_its_pairs_by_t() {
    let study = |by_condition: f64, by_period: f64| {
        made(&orders(3), 24, |p, c, t, _| {
            let latent = noise(11, p)
                + by_condition * c as f64
                + by_period * t as f64
                + noise(12, 100 * p + 10 * c + t);
            (3.0 + latent).round().clamp(1.0, 5.0)
        })
    };
    let of = |study: &Made| {
        let found = study.tested(AskedTest::Chosen, OutcomeScale::Rating).unwrap();
        let ByDesign::Ordinal(found) = found else { panic!("an ordinal model") };
        found.found
    };
    let (conditions, periods) = (of(&study(0.8, 0.0)), of(&study(0.0, 0.8)));
    let p = |test: &Option<SmallSample>| test.as_ref().unwrap().p;
    assert!(p(&conditions.small_sample) < 0.001 && p(&conditions.period) > 0.05);
    assert!(p(&periods.small_sample) > 0.05 && p(&periods.period) < 0.001);
    // Pairs are differences of the coefficients, 72 - 24 - 2 - 2 degrees of freedom.
    let coef = |name: &str| conditions.model.quadrature.coef.get(name).unwrap().estimate.unwrap();
    let [first, second] = [&conditions.model.conditions[1], &conditions.model.conditions[2]];
    let pair = conditions.contrast.get(&format!("{first}|{second}")).unwrap();
    assert!((pair.estimate - (coef(first) - coef(second))).abs() < 1e-9);
    assert_eq!((conditions.contrast.len(), pair.df), (3, Some(44.0)));
    let against_first = conditions.contrast.values().next().unwrap();
    let se = conditions.model.quadrature.coef.get(first).unwrap().se.unwrap();
    assert!((against_first.se - se).abs() < 1e-9);
    // Asked for of a scale that is none, too; a mean of items is a mixed model's.
    let asked = study(0.8, 0.0).tested(AskedTest::Ordinal, OutcomeScale::Measure).unwrap();
    assert!(matches!(asked, ByDesign::Ordinal(_)));
}

#[test]
fn without_periods_a_pair_with_its_own_error_is_the_paired_t_test() {
    let mut study = made(&orders(4), 11, |p, c, t, _| {
        noise(13, 100 * p + 10 * c + t) * if c == 0 { 3.0 } else { 1.0 } + c as f64
    });
    study.periods.clear();
    let ByDesign::Mixed(found) = study.tested(AskedTest::Mixed, OutcomeScale::Measure).unwrap()
    else {
        panic!("a mixed model")
    };
    let data =
        crate::WithinSubjects::from_long(&study.people, &study.conditions, &study.values).unwrap();
    let pairs = crate::within(&data).paired;
    let own = found.found.own_error.get("condition").unwrap();
    assert_eq!(own.len(), 6);
    for (name, pair) in own.iter() {
        let known = pairs.get(name).unwrap();
        assert!((pair.t / known.t.unwrap() - 1.0).abs() < 1e-9, "{name}");
        assert!(
            (pair.df.unwrap() - 10.0).abs() < 1e-9
                && (pair.p.unwrap() / known.p.unwrap() - 1.0).abs() < 1e-6
        );
    }
}

#[test]
fn of_two_conditions_in_two_orders_it_is_welchs_test_of_the_orders_halves() {
    let study = made(&orders(2), 12, |p, c, t, _| {
        noise(14, 100 * p + 10 * c + t) * if p % 2 == 0 { 2.0 } else { 1.0 } + 0.4 * t as f64
    });
    let found = study.mixed();
    let pairs = found.pairs("condition").unwrap();
    let pair = pairs.values().next().unwrap();
    let difference = |p: usize| {
        let at = |name: &str| {
            let row = (0..24)
                .find(|&i| study.people[i] == format!("p{p}") && study.conditions[i] == name);
            study.values[row.unwrap()].unwrap()
        };
        at("a") - at("b")
    };
    let of = |parity: usize| -> (f64, f64) {
        let own: Vec<f64> = (0..12).filter(|p| p % 2 == parity).map(difference).collect();
        let mean = own.iter().sum::<f64>() / 6.0;
        (mean, own.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / 5.0 / 6.0)
    };
    let ((one, first), (two, second)) = (of(0), of(1));
    assert!((pair.estimate - 0.5 * (one + two)).abs() < 1e-9);
    assert!((pair.se - 0.5 * (first + second).sqrt()).abs() < 1e-9);
    assert!((pair.df.unwrap() - 10.0).abs() < 1e-6);
}

#[test]
fn the_estimate_of_a_pair_is_the_models_and_its_error_follows_its_own_spread() {
    let study = made(&orders(4), 24, |p, c, t, _| {
        noise(15, p)
            + noise(16, 100 * p + 10 * c + t) * if c == 0 { 4.0 } else { 1.0 }
            + 0.5 * t as f64
    });
    let found = study.mixed();
    let model = found.model.contrast.get("condition").unwrap();
    for (name, pair) in found.own_error.get("condition").unwrap().iter() {
        let of_model = model.get(name).unwrap();
        assert!((pair.estimate - of_model.estimate).abs() < 1e-9, "{name}");
        let wide = name.split('|').any(|c| c == "a");
        assert_eq!(pair.se > of_model.se, wide, "{name}: {} {}", pair.se, of_model.se);
        assert!(pair.df.unwrap() > 18.0 && pair.df.unwrap() < 23.0 + 1e-9);
    }
    // Somebody without a condition is left out whole, or stays in the model alone.
    let mut short = study;
    short.values[5] = None;
    let listwise = short.mixed();
    assert_eq!((listwise.model.n_subjects, listwise.model.n_obs), (23, 92));
    assert_eq!(listwise.pairs("condition").unwrap().len(), 6);
    let choice = DesignChoice { missing: MissingCells::Mixed, ..DesignChoice::default() };
    let ByDesign::Mixed(kept) = compare_by_design(&short.columns(), &choice).unwrap() else {
        panic!("a mixed model")
    };
    assert_eq!(kept.found.model.n_obs, 95);
    let pairs = kept.found.own_error.get("condition").unwrap();
    assert!(pairs.len() == 6 && pairs.values().all(|pair| pair.p.is_some()));
    let carried = short.carried();
    short.values.drain(4..8);
    short.people.drain(4..8);
    short.conditions.drain(4..8);
    short.periods.drain(4..8);
    assert_eq!(carried, short.carried());
}
