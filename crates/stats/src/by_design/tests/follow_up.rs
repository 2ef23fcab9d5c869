//! Pairs, means and simple effects follow the test that decides.

use super::*;
use crate::{FactorialFinding, FollowUp, LevelChoice, follow_up, level_contrast};

/// Some normal numbers, the same for the same seed (splitmix64).
struct Draws(u64);

impl Draws {
    fn normal(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        let share = ((bits >> 11) as f64 + 0.5) / (1_u64 << 53) as f64;
        crate::numerics::distributions::normal_quantile(share)
    }
}

/// People in two vehicles and two modes: so many in a car, the others in a truck, with these spreads and ages.
fn two_by_two(
    [cars, trucks]: [usize; 2],
    [of_cars, of_trucks]: [f64; 2],
    age: impl Fn(usize) -> f64,
    draws: &mut Draws,
) -> Made {
    let people = cars + trucks;
    let rows = || (0..people * 2).map(|row| (row / 2, row % 2));
    let is_car = |person: usize| person < cars;
    let value = (0..people).flat_map(|person| {
        let spread = if is_car(person) { of_cars } else { of_trucks };
        let own = 0.2 * age(person) + spread * draws.normal();
        [0, 1].map(|_| Some(own + 0.5 * spread * draws.normal()))
    });
    let value = value.collect();
    Made {
        people: rows().map(|(p, _)| format!("p{p}")).collect(),
        mode: rows().map(|(_, m)| ["calm", "sporty"][m].to_owned()).collect(),
        road: Vec::new(),
        vehicle: rows()
            .map(|(p, _)| Some(if is_car(p) { "car" } else { "truck" }.to_owned()))
            .collect(),
        age: rows().map(|(p, _)| Some(age(p))).collect(),
        value,
    }
}

impl Made {
    fn mixed_design(&self) -> DesignColumns<'_> {
        DesignColumns {
            within: vec![("mode", &self.mode)],
            between: vec![("vehicle", &self.vehicle)],
            ..self.columns()
        }
    }
}

/// As residuals that look normal would have it, or as ranks.
fn tested_as(data: &DesignColumns<'_>, normal: bool) -> Chosen<FactorialFinding> {
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

/// The same, and what follows.
fn followed(data: &DesignColumns<'_>, normal: bool) -> (Chosen<FactorialFinding>, FollowUp) {
    let found = tested_as(data, normal);
    let after = follow_up(data, &found).unwrap();
    (found, after)
}

fn close(found: Option<f64>, expected: Option<f64>, what: &str) {
    let (found, expected) = (found.unwrap(), expected.unwrap());
    assert!(
        (found - expected).abs() <= 1e-9 * expected.abs().max(1e-3),
        "{what}: {found}, not {expected}"
    );
}

/// The p of the only pair of a factor with two levels.
fn only_pair(after: &FollowUp, factor: &str) -> Option<f64> {
    let pairs = after.contrast.get(factor).unwrap();
    assert_eq!(pairs.len(), 1);
    let pair = pairs.values().next().unwrap();
    assert_eq!(pair.test.p, pair.p_holm);
    pair.test.p
}

#[test]
fn of_two_levels_the_pair_is_the_test_of_the_effect_whatever_decides() {
    let plain = |_: usize| 40.0;
    let uneven = two_by_two([6, 14], [3.0, 1.0], plain, &mut Draws(1));
    let aged = |person: usize| 25.0 + (person * 7 % 30) as f64;
    let aged = two_by_two([9, 12], [1.0, 1.0], aged, &mut Draws(2));
    let with_age = |with| DesignColumns {
        covariates: vec![("age", &aged.age[..])],
        with,
        ..aged.mixed_design()
    };
    // One value is far from all others.
    let mut skewed = two_by_two([8, 9], [1.0, 1.0], plain, &mut Draws(3));
    skewed.value[0] = Some(400.0);
    let product = with_age(vec![("age", vec!["mode"])]);
    let designs = [
        (uneven.mixed_design(), true, EffectMethod::Unpooled),
        (with_age(Vec::new()), true, EffectMethod::Regression),
        (product, true, EffectMethod::Regression),
        (skewed.mixed_design(), false, EffectMethod::GroupRanks),
    ];
    for (data, normal, method) in designs {
        let (found, after) = followed(&data, normal);
        let tests = &found.found.tests;
        assert_eq!(tests.get("vehicle").unwrap().method, method);
        for factor in ["mode", "vehicle"] {
            let effect = tests.get(factor).unwrap();
            let what = format!("{factor} by {method:?}");
            close(only_pair(&after, factor), effect.p, &what);
        }
        // Two factors of two levels: four simple effects, none of which has pairs beside it.
        assert_eq!(after.simple.len(), 4);
        assert!(after.simple.iter().all(|simple| simple.pairs.is_empty()));
    }
}

#[test]
fn a_covariate_enters_the_pair_of_the_effect_that_it_is_declared_to_be_multiplied_by_alone() {
    let aged = |person: usize| 25.0 + (person * 7 % 30) as f64;
    let made = two_by_two([9, 12], [1.0, 1.0], aged, &mut Draws(5));
    let height: Vec<Option<f64>> =
        (0..made.people.len()).map(|row| Some(160.0 + (row / 2 * 11 % 25) as f64)).collect();
    let data = DesignColumns {
        covariates: vec![("age", &made.age), ("height", &height)],
        with: vec![("age", vec!["mode"])],
        ..made.mixed_design()
    };
    let (found, after) = followed(&data, true);
    // Twenty-one differences less two groups and one covariate.
    let pair = after.contrast.get("mode").unwrap().values().next().unwrap();
    assert_eq!(pair.test.df, Some(18.0));
    let effect = found.found.tests.get("mode").unwrap();
    close(pair.test.p, effect.p, "mode");
    let between = after.contrast.get("vehicle").unwrap();
    assert_eq!(between.values().next().unwrap().test.df, Some(17.0));
}

#[test]
fn groups_that_differ_in_a_covariate_alone_have_means_that_do_not() {
    // Whoever drives a car is 25 years older, and value follows age.
    let old = |person: usize| (person % 9) as f64 + if person < 9 { 60.0 } else { 35.0 };
    let made = two_by_two([9, 9], [0.3, 0.3], old, &mut Draws(7));
    let data = DesignColumns { covariates: vec![("age", &made.age)], ..made.mixed_design() };
    let (found, after) = followed(&data, true);
    assert_eq!(after.covariates, ["age"]);
    let plain = found.found.anova.contrast.get("vehicle").unwrap();
    assert!(plain.values().next().unwrap().p.unwrap() < 0.001);
    let pair = after.contrast.get("vehicle").unwrap().get("car|truck");
    let means = after.emm.get("vehicle").unwrap();
    let mean = |name: &str| means.get(name).unwrap();
    let difference = mean("car").mean - mean("truck").mean;
    close(Some(difference), pair.map(|pair| pair.test.estimate), "car");
    let raw = found.found.anova.emm.get("vehicle").unwrap();
    let raw = raw.get("car").unwrap().mean - raw.get("truck").unwrap().mean;
    assert!(raw > 4.0 && difference.abs() < 2.5, "{raw} {difference}");
    // Eighteen people less two groups and a slope.
    assert_eq!(mean("car").df, Some(15.0));
    assert!(mean("car").se.is_some() && mean("car").ci.low.is_some());
    assert_eq!(after.emm.len(), found.found.anova.emm.len());
}

#[test]
fn means_at_the_mean_of_a_covariate_differ_by_their_pair_whether_its_product_is_declared_or_not() {
    // Whoever drives a car is older, and sporty costs more with age.
    let age = |person: usize| (person % 9) as f64 + if person < 9 { 60.0 } else { 30.0 };
    let mut made = two_by_two([9, 12], [0.3, 0.3], age, &mut Draws(13));
    for (row, value) in made.value.iter_mut().enumerate() {
        let more = 0.05 * age(row / 2) * (row % 2) as f64;
        *value = value.map(|v| v + more);
    }
    for with in [Vec::new(), vec![("age", vec!["mode"])]] {
        let data =
            DesignColumns { covariates: vec![("age", &made.age)], with, ..made.mixed_design() };
        let (found, after) = followed(&data, true);
        let mean = |effect: &str, cell: &str| {
            let means = after.emm.get(effect).unwrap();
            means.get(cell).unwrap().mean
        };
        let of = |factor: &str, pair: &str| {
            let pairs = after.contrast.get(factor).unwrap();
            Some(pairs.get(pair).unwrap().test.estimate)
        };
        let modes = mean("mode", "calm") - mean("mode", "sporty");
        close(Some(modes), of("mode", "calm|sporty"), "mode");
        let vehicles = mean("vehicle", "car") - mean("vehicle", "truck");
        close(Some(vehicles), of("vehicle", "car|truck"), "vehicle");
        let cell = |name: &str| mean("vehicle:mode", name);
        let interaction =
            cell("car:calm") - cell("car:sporty") - cell("truck:calm") + cell("truck:sporty");
        let pair = |a: &str, b: &str| LevelChoice::Pair([a, b].map(str::to_owned));
        let both = [("vehicle", pair("car", "truck")), ("mode", pair("calm", "sporty"))];
        let both = level_contrast(&data, &found, &both).unwrap();
        close(Some(interaction), Some(both.estimate), "vehicle:mode");
    }
}

#[test]
fn a_mean_of_a_group_has_the_error_of_that_group() {
    let made = two_by_two([6, 14], [3.0, 1.0], |_| 40.0, &mut Draws(11));
    let (_, after) = followed(&made.mixed_design(), true);
    let by_hand = |from: usize, to: usize| {
        let people = made.value.chunks(2).skip(from).take(to - from);
        let means: Vec<f64> =
            people.map(|cells| f64::midpoint(cells[0].unwrap(), cells[1].unwrap())).collect();
        let n = means.len() as f64;
        let mean = means.iter().sum::<f64>() / n;
        let square: f64 = means.iter().map(|m| (m - mean).powi(2)).sum();
        (mean, (square / (n - 1.0) / n).sqrt(), n)
    };
    let means = after.emm.get("vehicle").unwrap();
    for (name, (mean, se, n)) in [("car", by_hand(0, 6)), ("truck", by_hand(6, 20))] {
        let found = means.get(name).unwrap();
        close(Some(found.mean), Some(mean), name);
        close(found.se, Some(se), name);
        close(found.df, Some(n - 1.0), name);
    }
}

#[test]
fn a_simple_effect_of_three_levels_has_pairs_that_holm_takes_together() {
    let made = made();
    let cell: Vec<String> = (0..48).map(|i| format!("r{}", i % 4)).collect();
    let data = DesignColumns {
        within: vec![("cell", &cell)],
        between: vec![("vehicle", &made.vehicle)],
        ..made.columns()
    };
    let (found, after) = followed(&data, true);
    assert_eq!(found.found.anova.n, 12);
    let simple = |factor: &str| {
        let all = after.simple.iter();
        all.filter(|s| s.effect.factor == factor).collect::<Vec<_>>()
    };
    assert_eq!((simple("vehicle").len(), simple("cell").len()), (4, 2));
    assert!(simple("vehicle").iter().all(|s| s.pairs.is_empty()));
    for effect in simple("cell") {
        assert_eq!(effect.pairs.len(), 6);
        let least = |p: &dyn Fn(&crate::LevelPair) -> Option<f64>| {
            effect.pairs.values().filter_map(p).fold(1.0, f64::min)
        };
        let (raw, holm) = (least(&|pair| pair.test.p), least(&|pair| pair.p_holm));
        close(Some(holm), Some((6.0 * raw).min(1.0)), "Holm");
    }
}

/// Where nothing differs and the smaller group varies more, pooled pairs find far too much; those that follow the effect do not.
#[test]
fn pairs_of_unequal_groups_keep_their_level() {
    let (mut pooled, mut followed_up) = (0, 0);
    let mut draws = Draws(17);
    for _ in 0..300 {
        let made = two_by_two([6, 18], [3.0, 1.0], |_| 40.0, &mut draws);
        let data = made.mixed_design();
        let found = tested_as(&data, true);
        let plain = found.found.anova.contrast.get("vehicle").unwrap();
        let plain = plain.values().next().unwrap();
        pooled += usize::from(plain.p.unwrap() < 0.05);
        let levels = LevelChoice::Pair(["car", "truck"].map(str::to_owned));
        let pair = level_contrast(&data, &found, &[("vehicle", levels)]).unwrap();
        followed_up += usize::from(pair.p.unwrap() < 0.05);
    }
    assert!(pooled > 36, "{pooled} of 300 pooled pairs below .05");
    assert!(followed_up < 36, "{followed_up} of 300 pairs below .05");
}

#[test]
fn whoever_lacks_a_cell_is_in_no_mean_pair_or_simple_effect() {
    let mut made = two_by_two([7, 8], [1.0, 1.0], |_| 40.0, &mut Draws(19));
    // Calm is there: a part at that level alone would have the person.
    made.value[1] = None;
    let (found, after) = followed(&made.mixed_design(), true);
    assert_eq!(found.found.anova.dropped, ["p0"]);
    let n = |effect: &str| -> usize { after.emm.get(effect).unwrap().values().map(|m| m.n).sum() };
    assert_eq!((n("vehicle"), n("vehicle:mode")), (14, 28));
    let calm = after.simple.iter().find(|s| s.effect.level == "calm");
    let whole = made.rows(|row| row > 1);
    let (_, without) = followed(&whole.mixed_design(), true);
    let expected = without.simple.iter().find(|s| s.effect.level == "calm");
    assert_eq!(calm, expected);
}

/// Twelve people in two vehicles on four roads, or these vehicles.
fn on_four_roads(vehicle: Option<Vec<Option<String>>>) -> (Made, Vec<String>) {
    let mut made = made();
    made.vehicle = vehicle.unwrap_or(made.vehicle);
    let cell = (0..48).map(|i| format!("r{}", i % 4)).collect();
    (made, cell)
}

fn mixed_of(data: &DesignColumns<'_>, choice: DesignChoice) -> crate::MixedFinding {
    let ByDesign::Mixed(found) = compare_by_design(data, &choice).unwrap() else {
        panic!("a mixed model")
    };
    found.found
}

const ASKED: DesignChoice = DesignChoice {
    test: AskedTest::Mixed,
    scale: OutcomeScale::Measure,
    missing: MissingCells::Mixed,
    alpha: 0.05,
    exact: false,
};

#[test]
fn a_pair_of_a_mixed_model_has_the_spread_of_its_own_difference_within_groups() {
    let (made, cell) = on_four_roads(None);
    let data = DesignColumns {
        within: vec![("cell", &cell)],
        between: vec![("vehicle", &made.vehicle)],
        covariates: vec![("age", &made.age)],
        ..made.columns()
    };
    let found = mixed_of(&data, ASKED);
    // Of each group the mean of r0 - r3 and its squared error.
    let of_group = |parity: usize| {
        let people = made.value.chunks(4).skip(parity).step_by(2);
        let own: Vec<f64> = people.map(|v| v[0].unwrap() - v[3].unwrap()).collect();
        let mean = own.iter().sum::<f64>() / 6.0;
        let square: f64 = own.iter().map(|d| (d - mean).powi(2)).sum();
        (mean, square / 5.0 / 6.0)
    };
    let ((cars, of_cars), (trucks, of_trucks)) = (of_group(0), of_group(1));
    let pairs = found.pairs("cell").unwrap();
    assert_eq!(pairs.len(), 6);
    let pair = pairs.get("r0|r3").unwrap();
    close(Some(pair.estimate), Some(0.5 * (cars + trucks)), "estimate");
    close(Some(pair.se), Some(0.5 * (of_cars + of_trucks).sqrt()), "se");
    assert!((pair.df.unwrap() - 10.0).abs() < 1e-6, "{:?}", pair.df);
    // At one vehicle it is the paired t test of its six people.
    let there = found.pairs("vehicle:cell").unwrap();
    let there = there.get("car:r0|car:r3").unwrap();
    close(Some(there.se), Some(of_cars.sqrt()), "se of cars");
    assert!((there.df.unwrap() - 5.0).abs() < 1e-6, "{:?}", there.df);
    let of_the_model = found.model.contrast.get("cell").unwrap();
    assert!((pair.se / of_the_model.get("r0|r3").unwrap().se - 1.0).abs() > 1e-3);
    assert!(found.pairs("weather").is_none());
}

#[test]
fn a_pair_that_hangs_on_one_person_has_no_p_and_a_reason() {
    let alone = |row: usize| Some(if row < 4 { "car" } else { "truck" }.to_owned());
    let (made, cell) = on_four_roads(Some((0..48).map(alone).collect()));
    let data = DesignColumns {
        within: vec![("cell", &cell)],
        between: vec![("vehicle", &made.vehicle)],
        ..made.columns()
    };
    let found = mixed_of(&data, ASKED);
    let pairs = found.pairs("cell").unwrap();
    let pair = pairs.get("r0|r1").unwrap();
    assert_eq!((pair.p, pair.p_holm, pair.ci.low), (None, None, None));
    let why = found.model.undefined.get("own_error.cell.r0|r1");
    assert!(why.unwrap().contains("without one of the subjects"));
    // Trucks are driven by eleven.
    let trucks = found.pairs("vehicle:cell").unwrap();
    let trucks = trucks.get("truck:r0|truck:r1").unwrap();
    assert!((trucks.df.unwrap() - 10.0).abs() < 1e-6 && trucks.p.is_some());
}

/// Where people differ in their slope over four roads, the ends differ more than the mean pair: over the pooled error they find far too
/// much, over their own they do not, beside groups, a covariate and a gap.
#[test]
fn pairs_of_a_mixed_model_keep_their_level() {
    let (mut pooled, mut own) = (0, 0);
    let mut draws = Draws(23);
    let rows = || (0..64).map(|row| (row / 4, row % 4));
    let people: Vec<String> = rows().map(|(person, _)| format!("p{person}")).collect();
    let cell: Vec<String> = rows().map(|(_, cell)| format!("r{cell}")).collect();
    let vehicle: Vec<Option<String>> =
        rows().map(|(person, _)| Some(["car", "truck"][person % 2].to_owned())).collect();
    let age: Vec<Option<f64>> =
        rows().map(|(person, _)| Some(20.0 + (person * 7 % 12) as f64)).collect();
    for _ in 0..300 {
        let mut value = Vec::new();
        for _ in 0..16 {
            let (level, slope) = (draws.normal(), 0.8 * draws.normal());
            value.extend(
                [-1.5, -0.5, 0.5, 1.5].map(|at| Some(level + slope * at + 0.7 * draws.normal())),
            );
        }
        value[5] = None;
        let data = DesignColumns {
            subjects: &people,
            within: vec![("cell", &cell)],
            between: vec![("vehicle", &vehicle)],
            covariates: vec![("age", &age)],
            values: &value,
            ..DesignColumns::default()
        };
        let found = mixed_of(&data, ASKED);
        let below = |pairs: &crate::Named<crate::MarginalContrast>| {
            usize::from(pairs.get("r0|r3").unwrap().p.unwrap() < 0.05)
        };
        pooled += below(found.model.contrast.get("cell").unwrap());
        own += below(found.pairs("cell").unwrap());
    }
    assert!(pooled > 28, "{pooled} of 300 pooled pairs below .05");
    assert!(own < 28, "{own} of 300 pairs below .05");
}
