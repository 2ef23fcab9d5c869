//! A study of six people, computed by hand.

use crate::{
    AnalysisError, ContrastTest, Described, Judged, Panel, Person, PlannedTest, Purpose, StudyData,
    Tables, Verdict, analyse, pairs, planned,
    testing::{
        DESIGN, FASTER, SPEED, analysed, analysed_by, design, drive as drive_of, id, near, panel,
        person, plain, steered, tables,
    },
};
use maveric_domain::{
    Moment, Scale,
    design::{ScoreName, Sign},
};
use maveric_stats::{ByDesign, EffectMethod, FactorialDesign, OmnibusTest, factorial};
use std::collections::BTreeMap;

#[test]
fn the_line_against_the_score_is_the_correlation_by_hand() {
    let a = analysed(tables());
    let line = a.line.as_ref().unwrap();
    let row = |name: &str| line.rows.iter().find(|r| r.measure == name).unwrap();
    // Positions 0 to 5: Sxx = 17.5; Sxy = 446 - 6 · 2.5 · 80/3 = 46; Syy = 4418 - 6 · (80/3)² = 454/3.
    near(
        row("adb.total").correlation.r,
        46.0 / (17.5 * 454.0_f64 / 3.0).sqrt(),
    );
    near(row(SPEED).correlation.r, 1.0);
    let (low, high) = row(SPEED).ends.unwrap();
    near(Some(high / low), 30.0 / 25.0);
    // Nobody's lane changes were counted, so they are no outcome.
    assert_eq!(line.rows.len(), 2);
}

#[test]
fn accuracy_is_one_less_the_error_over_the_own_value() {
    let a = analysed(tables());
    let errors = 0.5 / 25.0 + 1.0 / 26.0 + 0.9 / 27.0 + 0.7 / 28.0 + 0.0 + 0.3 / 30.0;
    near(a.reproduction[0].mean, 1.0 - errors / 6.0);
    assert_eq!((a.reproduction[0].n, a.reproduction.len()), (6, 1));
}

#[test]
fn six_of_six_nearer_has_the_smallest_exact_p() {
    let a = analysed(tables());
    assert_eq!(a.nearer.len(), 2);
    for row in &a.nearer {
        assert_eq!((row.nearer, row.tied, row.farther), (6, 0, 0));
        near(row.effect, 1.0);
        near(row.p, 2.0 / 64.0);
        near(row.p_holm, 4.0 / 64.0);
    }
}

#[test]
fn ties_are_neither_nearer_nor_farther_and_the_direction_comes_from_the_signed_ranks() {
    // The car at 0 is as far off as the faster one for three people, nearer for the other three, farther for nobody.
    let mut tied = tables();
    let fast = tied
        .measurements
        .iter()
        .filter(|d| d.meta.condition == id("fast"));
    let fast: Vec<Option<f64>> = fast.map(|d| d.values[SPEED]).collect();
    let same = tied
        .measurements
        .iter_mut()
        .filter(|d| d.meta.condition == id("same"));
    for (drive, fast) in same.zip(fast).take(3) {
        drive.values.insert(SPEED.to_owned(), fast);
    }
    let a = analysed(tied);
    let row = a.nearer.iter().find(|r| r.than == id("fast")).unwrap();
    assert_eq!((row.nearer, row.tied, row.farther), (3, 3, 0));
    near(row.effect, 1.0);
}

#[test]
fn the_bias_of_the_own_style_car_has_the_interval_of_its_two_one_sided_tests() {
    let a = analysed(tables());
    let bias = a.reproduction[0].bias.as_ref().unwrap();
    // Differences .5, -1, .9, -.7, 0, .3 m/s: mean 0, squares 2.64, t(5) of 90 % is 2.015048.
    let kmh = 3.6;
    let half = 2.015_048_373_3 * (2.64_f64 / 5.0 / 6.0).sqrt() * kmh;
    near(Some(bias.mean + 1.0), 1.0);
    let (low, high) = bias.interval.unwrap();
    near(Some(high), half);
    near(Some(low), -half);
    // Own drives 25 to 30 m/s: half a standard deviation is √3.5 / 2.
    near(Some(bias.same_within), 3.5_f64.sqrt() / 2.0 * kmh);
    assert!(!bias.declared && bias.p_equivalent.unwrap() < 0.05);
    assert_eq!(bias.verdict, Verdict::Shown);
    let outcome = format!("[[outcome]]\nmeasure = \"{SPEED}\"\nsame_within = 0.5\n");
    let declared = analysed_by(&format!("{DESIGN}{outcome}"), tables());
    let bias = declared.reproduction[0].bias.as_ref().unwrap();
    // The only measure: nothing to correct for.
    assert!(bias.p.is_some() && bias.p_holm == bias.p);
    assert!(bias.declared && bias.verdict == Verdict::NotShown);
    near(Some(bias.same_within), 0.5);
}

#[test]
fn a_table_a_sentence_and_an_equivalence_of_one_outcome_are_of_the_same_people_the_same_way_round()
{
    // P3 has no value of a condition that the hypotheses are not about.
    let mut gap = tables();
    let drive = gap
        .measurements
        .iter_mut()
        .find(|d| d.meta.participant == person(2) && d.meta.condition == id("across"));
    drive.unwrap().values.insert(SPEED.to_owned(), None);
    for i in 6..8 {
        let own = 24.0 + i as f64;
        gap.measurements.push(drive_of(i, "own", Some(own)));
        for (condition, faster) in [
            ("same", 0.4),
            ("fast", 2.2),
            ("slow", -1.2),
            ("across", 0.1),
        ] {
            gap.measurements
                .push(drive_of(i, condition, Some(own + faster * i as f64)));
        }
    }
    let claims = hypothesis(r#"["fast", "same"]"#, "equivalent = [-9, 9]")
        + &hypothesis(r#"["slow", "same"]"#, "direction = \"-\"");
    let a = analysed_by(&format!("{DESIGN}{claims}"), gap);
    let panel = panel(&a, SPEED);
    assert_eq!((panel.n, &panel.dropped[..]), (7, &["P3".to_owned()][..]));
    assert_eq!(a.hypotheses.len(), 2);
    for judged in &a.hypotheses {
        let ids = (judged.first, judged.second);
        let contrast = panel.contrasts.iter().find(|c| (c.first, c.second) == ids);
        let contrast = contrast.expect("the way round that the hypothesis says it");
        near(judged.mean_difference, contrast.mean_difference.unwrap());
        assert_eq!((judged.n, contrast.people.iter().sum()), (7, 7));
    }
    // Of a claim that two are the same the interval is the narrower one.
    let width = |judged: &Judged| judged.interval.map(|(low, high)| high - low).unwrap();
    let (same, below) = (&a.hypotheses[0], &a.hypotheses[1]);
    let pairs = pairs::values(panel, below.first, below.second);
    let differences: Vec<f64> = pairs.iter().map(|[a, b]| a - b).collect();
    let test = crate::verdict::equivalent((-1.0, 1.0), &differences)
        .unwrap()
        .1
        .unwrap();
    near(
        Some(width(below)),
        test.ci_high.unwrap() - test.ci_low.unwrap(),
    );
    let pairs = pairs::values(panel, same.first, same.second);
    let differences: Vec<f64> = pairs.iter().map(|[a, b]| a - b).collect();
    let test = crate::verdict::equivalent((-1.0, 1.0), &differences)
        .unwrap()
        .1
        .unwrap();
    near(
        Some(width(same)),
        test.ci90_high.unwrap() - test.ci90_low.unwrap(),
    );
    let bias = a.reproduction[0].bias.as_ref().unwrap();
    assert_eq!((bias.n, a.reproduction[0].n), (7, 7));
    assert!(a.nearer.iter().all(|row| row.n == 7));
}

#[test]
fn what_was_measured_and_answered_is_described_condition_by_condition() {
    let a = analysed(tables());
    let of = |outcome: &str, condition: &str| {
        let is = |d: &&Described| d.outcome == outcome && d.condition == id(condition);
        a.descriptives.iter().find(is).unwrap()
    };
    let own = of(SPEED, "own");
    let kmh = 3.6;
    near(own.mean, 27.5 * kmh);
    near(own.median, 27.5 * kmh);
    near(own.sd, 3.5_f64.sqrt() * kmh);
    let trust = of("jian_trust.overall", "same");
    near(trust.mean, 5.0);
    assert_eq!((trust.n, own.n), (6, 6));
    // Nobody rates the own drive.
    assert!(
        a.descriptives
            .iter()
            .all(|d| d.condition != id("own") || d.outcome == SPEED)
    );
}

#[test]
fn a_panel_holds_the_differences_and_friedmans_test_by_hand() {
    let a = analysed(tables());
    let panel = panel(&a, SPEED);
    near(panel.rows[1][0], -3.6);
    let found = panel.comparison.as_ref().unwrap().one_factor().unwrap();
    // Ranks: the faster car 4 and the slower 1 for everybody, the two others 16 and 14 in all:
    // 12 / (6 · 4 · 5) · (16² + 24² + 6² + 14²) - 3 · 6 · 5.
    assert_eq!(found.chosen, OmnibusTest::Friedman);
    near(found.omnibus.statistic, 16.4);
    let mean = FASTER.map(|row| row.iter().sum::<f64>() / 6.0);
    let pair = &panel.contrasts[0];
    assert_eq!((pair.first, pair.second), (id("same"), id("fast")));
    near(pair.mean_difference, (mean[0] - mean[1]) * 3.6);
    // Speed rises with aggression, so the car turned up is the faster one.
    assert_eq!(pair.expected, Some(Sign::Minus));
    // Six of six: 1/32 for five pairs with the extremes; Holm counts all six pairs.
    near(pair.p, 2.0 / 64.0);
    near(pair.p_holm, 6.0 * 2.0 / 64.0);
    assert_eq!(panel.contrasts.len(), 6);
    assert_eq!(panel.contrasts[2].expected, None);
}

#[test]
fn a_hypothesis_about_a_contrast_the_other_way_round_adds_none() {
    let hypothesis = format!(
        "[[hypothesis]]\nsays = \"x\"\noutcome = \"{SPEED}\"\ncontrast = [\"fast\", \"same\"]\ndirection = \"+\"\n"
    );
    let a = analysed_by(&format!("{DESIGN}{hypothesis}"), tables());
    assert_eq!(panel(&a, SPEED).contrasts.len(), 6);
    near(panel(&a, SPEED).contrasts[0].p_holm, 6.0 * 2.0 / 64.0);
    assert_eq!(a.hypotheses.len(), 1);
}

#[test]
fn where_the_score_of_the_style_counts_calmness_a_car_turned_up_is_expected_to_be_slower() {
    let faster = |aggression: &str| {
        let design = format!(
            "[model]\nfile = \"lab.maveric\"\n[style]\nscore = \"adb.total\"\nrange = [11, 55]\n{aggression}\n"
        );
        let text = plain(&["same", "fast"], &design)
            .replace(
                "id = \"fast\"\n",
                "id = \"fast\"\ncar = { dial = 15, recorded = true }\n",
            )
            .replace(
                "id = \"same\"\n",
                "id = \"same\"\ncar = { dial = 0, recorded = true }\n",
            );
        let a = analysed_by(&text, tables());
        panel(&a, SPEED).contrasts[0].expected
    };
    assert_eq!(faster(""), Some(Sign::Minus));
    assert_eq!(faster("aggression = \"+\""), Some(Sign::Minus));
    assert_eq!(faster("aggression = \"-\""), Some(Sign::Plus));
}

#[test]
fn homophily_is_the_factor_against_the_difference_in_rating() {
    let a = analysed(tables());
    let row = a.homophily.iter().find(|r| r.versus == id("slow")).unwrap();
    // Differences 0, -0.5, 2, 1, 2, 1 with the factor 3, 1, 4, 2, 5, 3.5: means 5.5/6 and 18.5/6.
    let (x, y): (f64, f64) = (18.5 / 6.0, 5.5 / 6.0);
    let sxy = (0.0 - 0.5 + 8.0 + 2.0 + 10.0 + 3.5) - 6.0 * x * y;
    let sxx = (9.0 + 1.0 + 16.0 + 4.0 + 25.0 + 12.25) - 6.0 * x * x;
    let syy = (0.0 + 0.25 + 4.0 + 1.0 + 4.0 + 1.0) - 6.0 * y * y;
    assert_eq!(row.correlation.method, "pearson");
    near(row.correlation.r, sxy / (sxx * syy).sqrt());
    // Two tests in the family have answers.
    let least = row.correlation.p.unwrap();
    assert!(row.p_holm.unwrap() <= 2.0 * least + 1e-12 && row.p_holm.unwrap() >= least);
}

#[test]
fn one_of_six_preferred_the_faster_car_and_one_the_slower() {
    let a = analysed(tables());
    let trust = &a.preferences[0];
    let [fast, slow] = &trust.others[..] else {
        panic!("two conditions away from 0")
    };
    assert_eq!((trust.n, fast.above, slow.above), (6, 1, 1));
    // P1 rates both alike.
    assert_eq!(slow.not_below, 2);
    // Wilson's interval of 1/6.
    let z2 = 1.959_963_984_540_054_f64.powi(2);
    let half = (z2 * (5.0 / 36.0 / 6.0 + z2 / 144.0)).sqrt();
    let share = fast.share.as_ref().unwrap();
    assert!((share.low - (1.0 / 6.0 + z2 / 12.0 - half) / (1.0 + z2 / 6.0)).abs() < 1e-9);
}

#[test]
fn where_less_is_better_the_lower_score_is_preferred() {
    let mut with = tables();
    let scale = Scale::from_toml(
        r#"id = "jian_trust"
        title = "T"
        reference = "r"
        items = 1
        min = 1
        max = 7
        scoring = "mean"
        [[subscales]]
        id = "overall"
        title = "Distrust"
        items = [1]
        lower_is_better = true"#,
    )
    .unwrap();
    with.scales = vec![scale];
    let a = analysed(with);
    let distrust = &a.preferences[0];
    // All but P2 score the faster car lower.
    assert_eq!(
        (distrust.less_is_better, distrust.others[0].above),
        (true, 5)
    );
    assert_eq!(panel(&a, "jian_trust.overall").unit, "rating, 1 to 7");
}

#[test]
fn whoever_lacks_a_value_is_left_out_and_named() {
    let mut tables = tables();
    for drive in &mut tables.measurements {
        if drive.meta.drive.as_str() == "P4-same" {
            drive.values.insert(SPEED.to_owned(), None);
        }
    }
    let a = analysed(tables);
    assert_eq!(panel(&a, SPEED).dropped, ["P4"]);
    assert_eq!((panel(&a, SPEED).n, a.reproduction[0].dropped), (5, 1));
    let said = |e: &crate::Exclusion| e.who == "P4" && e.what == "comparison of mean velocity";
    assert!(a.exclusions.iter().any(said));
}

#[test]
fn conditions_that_were_only_recorded_are_compared_and_nothing_is_said_of_a_dial() {
    let a = analysed_by(&plain(&["same", "fast", "slow"], ""), tables());
    assert_eq!(panel(&a, SPEED).contrasts.len(), 3);
    assert!(
        panel(&a, SPEED)
            .contrasts
            .iter()
            .all(|c| c.expected.is_none())
    );
    assert!(a.line.is_none() && a.reproduction.is_empty() && a.nearer.is_empty());
    assert!(a.homophily.is_empty() && a.mixed.is_empty() && a.preferences.is_empty());
}

#[test]
fn two_conditions_get_a_paired_test() {
    let a = analysed_by(&plain(&["fast", "slow"], ""), tables());
    let panel = panel(&a, SPEED);
    let found = panel.comparison.as_ref().unwrap().one_factor().unwrap();
    assert_eq!(found.chosen, OmnibusTest::PairedT);
    assert_eq!(panel.test, Some(ContrastTest::T));
    // Differences 5, 5.5, 4.5, 5, 5, 5 m/s: mean 5, s² = 0.1.
    let [pair] = &panel.contrasts[..] else {
        panic!("one pair")
    };
    near(pair.statistic, 5.0 / (0.1_f64 / 6.0).sqrt());
    assert_eq!(pair.p, pair.p_holm);
}

#[test]
fn one_condition_is_held_against_the_baseline() {
    let a = analysed_by(&plain(&["fast"], ""), tables());
    let panel = panel(&a, SPEED);
    assert_eq!(panel.conditions, [id("fast"), id("own")]);
    near(panel.contrasts[0].mean_difference, 16.5 / 6.0 * 3.6);
    // Without a drive by hand there is nothing to hold it against.
    let alone = "[study]\ntitle = \"t\"\n[[condition]]\nid = \"fast\"\n";
    let a = analysed_by(alone, tables());
    assert!(
        a.panels
            .iter()
            .all(|p| p.contrasts.is_empty() && p.test.is_none())
    );
    assert!(a.panels[0].reasons[0].contains("nothing to compare"));
}

#[test]
fn without_a_baseline_the_values_themselves_are_compared() {
    let text = plain(&["same", "fast", "slow"], "").replace("[baseline]\nid = \"own\"\n", "");
    let a = analysed_by(&text, tables());
    let panel = panel(&a, SPEED);
    assert_eq!((panel.differences_from, panel.same), (None, None));
    near(panel.rows[0][0], 25.5 * 3.6);
}

#[test]
fn declared_contrasts_alone_make_the_family() {
    let against = "[contrasts]\ncompare = \"against slow\"\n";
    let a = analysed_by(&plain(&["same", "fast", "slow"], against), tables());
    let panel = panel(&a, SPEED);
    let pairs: Vec<_> = panel
        .contrasts
        .iter()
        .map(|c| (c.first, c.second))
        .collect();
    assert_eq!(pairs, [(id("slow"), id("same")), (id("slow"), id("fast"))]);
    // Slower than both, by every test of these six people.
    assert!(
        panel
            .contrasts
            .iter()
            .all(|c| c.mean_difference < Some(0.0))
    );
    let p: Vec<f64> = panel.contrasts.iter().filter_map(|c| c.p).collect();
    let least = p.iter().copied().fold(1.0, f64::min);
    let holm = panel.contrasts.iter().filter_map(|c| c.p_holm);
    near(Some(holm.fold(1.0, f64::min)), 2.0 * least);
}

#[test]
fn the_design_says_which_way_a_difference_should_lie() {
    let more = "[[condition]]\nid = \"fast\"\nexpected = { mean_velocity_mps = \"+\" }\n\
                [[condition]]\nid = \"slow\"\nexpected = { mean_velocity_mps = \"-\" }\n";
    let a = analysed_by(&plain(&["same"], more), tables());
    let expected = |first: &str, second: &str| {
        let mut all = panel(&a, SPEED).contrasts.iter();
        let is = |c: &&crate::Contrast| (c.first, c.second) == (id(first), id(second));
        all.find(is).unwrap().expected
    };
    assert_eq!(expected("fast", "slow"), Some(Sign::Plus));
    // Nothing is said of the first condition.
    assert_eq!(expected("same", "fast"), None);
}

/// The people with a city, and an age where it is known.
fn with_people(ages: [&str; 6]) -> Tables {
    let mut with = tables();
    let person = |i: usize| Person {
        id: person(i),
        learned: false,
        tested: true,
        order: Vec::new(),
        columns: BTreeMap::from([
            ("city".to_owned(), ["A", "B"][i % 2].to_owned()),
            ("age".to_owned(), ages[i].to_owned()),
        ]),
    };
    with.people = (0..6).map(person).collect();
    with
}

const AGES: [&str; 6] = ["30", "25", "61", "44", "38", "52"];

/// A row a person and condition of a panel.
struct Long {
    people: Vec<String>,
    conditions: Vec<String>,
    cities: Vec<Option<String>>,
    values: Vec<Option<f64>>,
}

fn long(panel: &Panel) -> Long {
    let mut long = Long {
        people: Vec::new(),
        conditions: Vec::new(),
        cities: Vec::new(),
        values: Vec::new(),
    };
    for (who, row) in panel.participants.iter().zip(&panel.rows) {
        let number: usize = who[1..].parse().unwrap();
        for (condition, value) in panel.conditions.iter().zip(row) {
            long.people.push(who.clone());
            long.conditions.push(condition.to_string());
            long.cities.push(Some(["B", "A"][number % 2].to_owned()));
            long.values.push(*value);
        }
    }
    long
}

#[test]
fn people_of_two_cities_are_one_factorial_test_and_each_city_a_panel_of_its_own() {
    let factor = "[[factor]]\ncolumn = \"city\"\n";
    let a = analysed_by(&plain(&["same", "fast", "slow"], factor), with_people(AGES));
    let panels: Vec<&Panel> = a.panels.iter().filter(|p| p.outcome == SPEED).collect();
    let groups = panels
        .iter()
        .map(|p| p.group.as_ref().map(|g| g.level.as_str()));
    assert_eq!(groups.collect::<Vec<_>>(), [None, Some("A"), Some("B")]);
    let Some(ByDesign::Factorial(found)) = &panels[0].comparison else {
        panic!("a factor between people and the conditions")
    };
    let long = long(panels[0]);
    let within = [("condition", &long.conditions[..])];
    let between = [("city", &long.cities[..])];
    let alone =
        FactorialDesign::from_columns(&long.people, &within, &between, &long.values).unwrap();
    assert_eq!(found.found.anova, factorial(&alone));
    assert!(found.found.anova.anova.get("city:condition").is_some());
    assert!(!a.notes.iter().any(|note| note.contains("city")));
    // Three contrasts over everybody are one family, six of two groups another.
    for (family, count) in [(&panels[..1], 3.0), (&panels[1..], 6.0)] {
        let contrasts = || family.iter().flat_map(|p| &p.contrasts);
        let least = contrasts().filter_map(|c| c.p).fold(1.0, f64::min);
        let holm = contrasts().filter_map(|c| c.p_holm).fold(1.0, f64::min);
        near(Some(holm), (count * least).min(1.0));
    }
}

#[test]
fn a_covariate_of_people_enters_between_them_alone_and_must_be_a_number() {
    let covariate = "[[covariate]]\ncolumn = \"age\"\n";
    let text = plain(&["same", "fast", "slow"], covariate);
    let a = analysed_by(&text, with_people(AGES));
    let Some(ByDesign::Factorial(found)) = &panel(&a, SPEED).comparison else {
        panic!("a covariate")
    };
    assert_eq!(found.found.anova.n, 6);
    let test = |name: &str| found.found.tests.get(name).unwrap();
    // 6 people less their mean and the slope.
    assert_eq!(test("age").df2, Some(4.0));
    assert!(test("age").p.is_some());
    let without = analysed_by(&plain(&["same", "fast", "slow"], ""), with_people(AGES));
    let alone = panel(&without, SPEED).comparison.as_ref().unwrap();
    let alone = alone.one_factor().unwrap().omnibus.clone();
    near(test("condition").p, alone.p.unwrap());
    let declared = "[[covariate]]\ncolumn = \"age\"\nwith = [\"condition\"]\n";
    let a = analysed_by(
        &plain(&["same", "fast", "slow"], declared),
        with_people(AGES),
    );
    let effects = panel(&a, SPEED).comparison.as_ref().unwrap().effects();
    let names: Vec<&str> = effects.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["condition", "age", "age:condition"]);
    let mut ages = AGES;
    ages[2] = "old";
    let data = StudyData::new(&design(&text), with_people(ages)).unwrap();
    let refused = analyse(&data, Purpose::Report).unwrap_err().to_string();
    assert!(refused.contains("`age` of `P3` is `old`"), "{refused}");
}

/// Names and methods of what was run, as far as each effect has one.
fn run_effects(found: &ByDesign) -> Vec<(String, Option<EffectMethod>)> {
    match found {
        ByDesign::Factorial(found) => {
            let tests = found.found.tests.iter();
            tests
                .map(|(name, test)| (name.to_owned(), Some(test.method)))
                .collect()
        }
        other => other
            .effects()
            .iter()
            .map(|(name, _)| ((*name).to_owned(), None))
            .collect(),
    }
}

#[test]
fn what_is_declared_is_what_is_run() {
    let level = |id: &str, speed: &str, side: &str| {
        format!(
            "[[condition]]\nid = \"{id}\"\nlevels = {{ speed = \"{speed}\", side = \"{side}\" }}\n"
        )
    };
    let crossed = level("same", "low", "left")
        + &level("fast", "high", "left")
        + &level("slow", "low", "right")
        + &level("across", "high", "right");
    let mut effects = 0;
    for conditions in [
        &["same", "fast"][..],
        &["same", "fast", "slow"],
        &["same", "fast", "slow", "across"],
        &[],
    ] {
        for factor in ["", "[[factor]]\ncolumn = \"city\"\n"] {
            let product = if conditions.is_empty() {
                "speed"
            } else {
                "condition"
            };
            let declared = format!("[[covariate]]\ncolumn = \"age\"\nwith = [\"{product}\"]\n");
            for covariate in ["", "[[covariate]]\ncolumn = \"age\"\n", &declared] {
                let mut text = plain(conditions, &(factor.to_owned() + covariate));
                if conditions.is_empty() {
                    text += &crossed;
                }
                let a = analysed_by(&text, with_people(AGES));
                let run = panel(&a, SPEED).comparison.as_ref();
                let run = run.unwrap_or_else(|| panic!("no test of {text}"));
                match (planned(&design(&text)), run) {
                    (PlannedTest::Effects(plan), ByDesign::Factorial(_)) => {
                        effects += 1;
                        let run = run_effects(run);
                        assert_eq!(plan.effects.len(), run.len(), "{text}");
                        for (effect, (name, method)) in plan.effects.iter().zip(run) {
                            assert_eq!(effect.effect, name, "{text}");
                            let possible = [Some(effect.normal), Some(effect.far_from_normal)];
                            assert!(possible.contains(&method), "{name} of {text}");
                        }
                    }
                    (PlannedTest::Pair, ByDesign::OneFactor(found)) => assert_eq!(found.k, 2),
                    (PlannedTest::OneFactor, ByDesign::OneFactor(found)) => assert!(found.k > 2),
                    (planned, run) => panic!("{planned:?}, but {run:?} of {text}"),
                }
            }
        }
    }
    assert_eq!(effects, 21);
}

#[test]
fn a_design_without_anything_to_compare_plans_no_test() {
    let none = planned(&design(&plain(&["same"], "")));
    assert!(matches!(none, PlannedTest::None(_)), "{none:?}");
    let city = "[[factor]]\ncolumn = \"city\"\n";
    assert_eq!(
        planned(&design(&plain(&["same"], city))),
        PlannedTest::Groups
    );
    let both = city.to_owned() + "[[covariate]]\ncolumn = \"age\"\n";
    assert_eq!(
        planned(&design(&plain(&["same"], &both))),
        PlannedTest::Covariance
    );
}

#[test]
fn conditions_that_cross_two_factors_have_main_effects_and_their_interaction() {
    let level = |id: &str, speed: &str, side: &str| {
        format!(
            "[[condition]]\nid = \"{id}\"\nlevels = {{ speed = \"{speed}\", side = \"{side}\" }}\n"
        )
    };
    let text = plain(&[], "")
        + &level("same", "low", "left")
        + &level("fast", "high", "left")
        + &level("slow", "low", "right")
        + &level("across", "high", "right");
    let a = analysed_by(&text, tables());
    let panel = panel(&a, SPEED);
    let effects = panel.comparison.as_ref().unwrap().effects();
    let names: Vec<&str> = effects.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["side", "speed", "side:speed"]);
    assert_eq!(panel.contrasts.len(), 6);
    let broken = text.replace(
        "speed = \"high\", side = \"right\"",
        "speed = \"middle\", side = \"right\"",
    );
    let a = analysed_by(&broken, tables());
    let says = |note: &String| note.contains("do not cross");
    assert!(a.notes.iter().any(says), "{:?}", a.notes);
    assert!(
        a.panels[0]
            .comparison
            .as_ref()
            .unwrap()
            .one_factor()
            .is_some()
    );
}

#[test]
fn an_item_of_few_whole_answers_is_ordinal_with_the_rank_tests_beside_it() {
    let mut with = tables();
    for (at, score) in with.post.iter_mut().enumerate() {
        score.value = Some([2.0, 4.0, 1.0, 3.0, 5.0, 2.0, 3.0][at * at % 7]);
    }
    let a = analysed_by(&plain(&["same", "fast", "slow"], ""), with);
    let panel = a.panels.iter().find(|p| p.outcome.contains('.')).unwrap();
    let Some(ByDesign::Ordinal(found)) = &panel.comparison else {
        panic!("an item: {:?}", panel.reasons)
    };
    assert_eq!(found.found.model.conditions, ["same", "fast", "slow"]);
    assert_eq!(panel.test, Some(ContrastTest::Wilcoxon));
    let pair = &panel.contrasts[0];
    let beside = found.found.beside.as_ref().unwrap();
    assert_eq!(pair.p, beside.wilcoxon.get("same|fast").unwrap().p);
}

fn hypothesis(contrast: &str, rule: &str) -> String {
    format!("[[hypothesis]]\nsays = \"so\"\noutcome = \"{SPEED}\"\ncontrast = {contrast}\n{rule}\n")
}

#[test]
fn a_hypothesis_is_judged_by_its_rule() {
    let judged = |contrast: &str, rule: &str| {
        let text = plain(
            &["same", "fast", "slow", "across"],
            &hypothesis(contrast, rule),
        );
        analysed_by(&text, tables()).hypotheses[0].verdict
    };
    let two = |contrast: &str, rule: &str| {
        let text = plain(&["fast", "slow"], &hypothesis(contrast, rule));
        analysed_by(&text, tables()).hypotheses[0].clone()
    };
    let found = two(r#"["slow", "fast"]"#, "direction = \"-\"");
    assert_eq!(found.verdict, Verdict::Shown);
    assert!(found.rule.contains("Holm"), "{}", found.rule);
    near(found.mean_difference, -5.0 * 3.6);
    assert_eq!(
        two(r#"["slow", "fast"]"#, "direction = \"+\"").verdict,
        Verdict::Fails
    );
    // Six people and six pairs by ranks: nothing can be below .05 after Holm.
    assert_eq!(
        judged(r#"["slow", "fast"]"#, "direction = \"-\""),
        Verdict::NotShown
    );
    // Means 0 and 0.07 m/s, that is 0.25 km/h apart.
    let near_to = r#"["same", "across"]"#;
    assert_eq!(judged(near_to, "equivalent = [-6.5, 6.5]"), Verdict::Shown);
    assert_eq!(
        judged(near_to, "equivalent = [-0.1, 0.1]"),
        Verdict::NotShown
    );
    assert_eq!(judged(near_to, "equivalent = [8, 15]"), Verdict::Fails);
    let nobody = plain(
        &["fast", "slow"],
        &hypothesis(r#"["slow", "fast"]"#, "direction = \"-\""),
    );
    let nobody = nobody.replace(SPEED, "lane_changes");
    assert_eq!(
        analysed_by(&nobody, tables()).hypotheses[0].verdict,
        Verdict::NotAsked
    );
    let mut few = tables();
    for drive in few.measurements.iter_mut().skip(10) {
        drive.values.clear();
    }
    let text = plain(
        &["fast", "slow"],
        &hypothesis(r#"["slow", "fast"]"#, "direction = \"-\""),
    );
    assert_eq!(
        analysed_by(&text, few).hypotheses[0].verdict,
        Verdict::TooFew
    );
}

#[test]
fn the_rule_of_an_equivalence_has_the_unit_of_what_was_measured_and_none_of_a_rating() {
    let rule = |outcome: &str| {
        let hypothesis = hypothesis(r#"["fast", "slow"]"#, "equivalent = [-1, 1]");
        let hypothesis = hypothesis.replace(SPEED, outcome);
        let mut with = tables();
        let text = "id = \"jian_trust\"\ntitle = \"Trust\"\nreference = \"made up\"\nitems = 1\nmin = 1\nmax = 7\nscoring = \"mean\"\n\
                    [[subscales]]\nid = \"overall\"\ntitle = \"Trust\"\nitems = [1]\n";
        with.scales = vec![Scale::from_toml(text).unwrap()];
        let a = analysed_by(&plain(&["fast", "slow"], &hypothesis), with);
        a.hypotheses[0].rule.clone()
    };
    assert!(
        rule(SPEED).contains("between -1 and 1 km/h (both"),
        "{}",
        rule(SPEED)
    );
    let rating = rule("jian_trust.overall");
    assert!(rating.contains("between -1 and 1 (both"), "{rating}");
    for (sign, way, expected) in [("+", "above", Sign::Plus), ("-", "below", Sign::Minus)] {
        let text = hypothesis(r#"["fast", "slow"]"#, &format!("direction = \"{sign}\""));
        let a = analysed_by(&plain(&["fast", "slow"], &text), tables());
        assert!(
            a.hypotheses[0]
                .rule
                .contains(&format!("lies {way} the second"))
        );
        let part = &a.findings[0].parts[0];
        assert_eq!(part.rule, crate::finding::Rule::Directed { expected });
        assert_eq!(part.of, format!("{SPEED}.fast-slow"));
    }
}

#[test]
fn whoever_is_excluded_is_out_of_everything_and_counted_with_the_reason() {
    let mut with = tables();
    with.people = (0..7)
        .map(|i| Person {
            id: person(i),
            learned: false,
            tested: true,
            order: Vec::new(),
            columns: BTreeMap::new(),
        })
        .collect();
    for drive in &with.measurements {
        let seconds = if drive.meta.drive.as_str() == "P5-slow" {
            100.0
        } else {
            600.0
        };
        with.durations_s.insert(drive.meta.drive.clone(), seconds);
    }
    with.measurements
        .retain(|d| d.meta.participant.as_str() != "P6" || d.meta.condition == id("own"));
    let rules = "[exclude]\npeople = { P1 = \"withdrew consent\" }\n\
                 drives = { P2-fast = \"simulator sickness\" }\n\
                 drive_shorter_than_s = 300\nfewer_conditions_than = 2\n";
    let a = analysed_by(&plain(&["same", "fast", "slow"], rules), with);
    assert_eq!(a.flow.recruited, 7);
    assert_eq!((a.flow.drove, a.flow.analysed), (6, 5));
    let why: Vec<(&str, &[String])> = a
        .flow
        .left_out
        .iter()
        .map(|l| (l.why.as_str(), &l.who[..]))
        .collect();
    assert_eq!(
        why,
        [
            ("withdrew consent", &["P1".to_owned()][..]),
            (
                "no drive and no answer in any condition",
                &["P7".to_owned()][..]
            ),
        ]
    );
    let drives: Vec<&str> = a.flow.drives.iter().map(|l| l.why.as_str()).collect();
    assert_eq!(drives, ["simulator sickness", "drive shorter than 300 s"]);
    let trust = panel(&a, "jian_trust.overall");
    assert_eq!(trust.participants, ["P2", "P3", "P4", "P5", "P6"]);
    // Neither the drive nor what was said of it is left.
    assert_eq!((trust.rows[0][1], trust.rows[3][2]), (None, None));
    assert_eq!((panel(&a, SPEED).n, trust.n), (2, 3));
}

#[test]
fn too_few_conditions_are_counted_from_drives_and_answers() {
    let mut with = tables();
    with.measurements
        .retain(|d| d.meta.participant.as_str() != "P6" || d.meta.condition == id("same"));
    with.post.retain(|s| s.participant.as_str() != "P6");
    let rules = "[exclude]\nfewer_conditions_than = 2\n";
    let a = analysed_by(&plain(&["same", "fast", "slow"], rules), with);
    assert_eq!(a.flow.left_out[0].why, "fewer than 2 conditions");
    assert_eq!((a.participants, a.flow.left_out[0].who.len()), (5, 1));
}

#[test]
fn a_condition_is_there_if_it_was_driven_or_rated_and_refused_if_it_was_neither() {
    let design = design(DESIGN.split("[homophily]").next().unwrap());
    let of = |driven: bool, rated: bool| {
        let mut tables = tables();
        let across = id("across");
        tables
            .measurements
            .retain(|d| driven || d.meta.condition != across);
        let after = Moment::after(across);
        tables.post.retain(|s| rated || s.moment != after);
        StudyData::new(&design, tables).map(|_| ())
    };
    for (driven, rated) in [(true, true), (true, false), (false, true)] {
        assert!(of(driven, rated).is_ok(), "{driven} {rated}");
    }
    // One person's rating is enough.
    let mut once = tables();
    once.measurements
        .retain(|d| d.meta.condition != id("across"));
    let after = Moment::after(id("across"));
    once.post
        .retain(|s| s.moment != after || s.participant == person(0));
    assert!(StudyData::new(&design, once).is_ok());
    assert!(matches!(
        of(false, false),
        Err(AnalysisError::NobodyThere { condition }) if condition == id("across")
    ));
}

#[test]
fn parts_of_drives_are_told_of_counts_and_extremes_alone() {
    let told = |counted_s: Option<f64>| {
        let mut cut = tables();
        for drive in &mut cut.measurements {
            drive.counted_s = counted_s;
            let speed = drive.values[SPEED];
            drive.values.insert("lane_changes".to_owned(), speed);
        }
        let a = analysed_by(&plain(&["fast", "slow"], ""), cut);
        let says = |outcome: &str| {
            let reasons = panel(&a, outcome).reasons.join("; ");
            reasons.contains("whose drives differ in length")
        };
        [says("lane_changes"), says(SPEED)]
    };
    assert_eq!(
        [told(Some(60.0)), told(None)],
        [[true, false], [false, false]]
    );
}

#[test]
fn whoever_is_learned_from_or_drove_nothing_of_the_study_takes_no_part() {
    let mut with = with_people(AGES);
    // P7 is learned from and drove the baseline; P8 is to be tested and drove something else.
    for (i, tested) in [(6, false), (7, true)] {
        with.people.push(Person {
            id: person(i),
            learned: !tested,
            tested,
            order: Vec::new(),
            columns: BTreeMap::new(),
        });
    }
    with.measurements.push(drive_of(6, "own", Some(30.0)));
    with.measurements.push(drive_of(7, "elsewhere", Some(30.0)));
    let a = analysed(with);
    assert_eq!((a.participants, a.flow.recruited, a.flow.drove), (6, 7, 6));
    assert_eq!(a.flow.left_out[0].who, ["P8"]);
}

#[test]
fn what_cannot_be_analysed_is_refused_by_name() {
    let mut two = tables();
    two.measurements
        .retain(|d| ["P1", "P2"].contains(&d.meta.participant.as_str()));
    two.post.clear();
    let error = StudyData::new(&design(DESIGN), two).unwrap_err();
    assert!(matches!(error, AnalysisError::TooFewPeople { found: 2 }));
    let error = StudyData::new(&design(&plain(&["fast", "sporty"], "")), tables()).unwrap_err();
    assert!(error.to_string().contains("`sporty`"), "{error}");
    for (factor, said) in [
        ("mdsi", "the scale `mdsi`, which nobody answered"),
        (
            "mini_ipip.pace",
            "the factors of mini_ipip are conscientiousness",
        ),
    ] {
        let text = DESIGN.replace("\"mini_ipip\"", &format!("\"{factor}\""));
        let data = StudyData::new(&design(&text), tables()).unwrap();
        let error = analyse(&data, Purpose::Report).unwrap_err();
        assert!(
            error.to_string().contains(said) && error.suggestion().is_some(),
            "{error}"
        );
    }
}

#[test]
fn a_score_is_called_by_its_questionnaire() {
    let data = StudyData::new(&design(DESIGN), tables()).unwrap();
    let name: ScoreName = "jian_trust.overall".parse().unwrap();
    assert_eq!(data.score_title(&name), "jian_trust.overall");
}

#[test]
fn of_the_cars_that_were_turned_those_beyond_the_training_are_counted() {
    let mut turned = tables();
    assert_eq!(analysed(tables()).beyond_training, None);
    turned.conditions = vec![
        steered(0, "fast", None, true),
        steered(0, "slow", None, false),
        steered(1, "fast", None, false),
        // Not turned, and not of the study.
        steered(1, "same", None, true),
        steered(9, "fast", None, true),
    ];
    near(analysed(turned).beyond_training, 1.0 / 3.0);
}

#[test]
fn habits_that_aggression_leaves_alone_are_held_against_the_angle_of_the_move() {
    const ROOM: &str = "min_headway_distance_m";
    let angle = |i: usize| 1.1 * i as f64 - 0.5;
    let off = |i: usize| if i.is_multiple_of(2) { 0.2 } else { -0.2 };
    let change = |i: usize| 3.0 + 2.0 * angle(i).cos() - angle(i).sin() + off(i);
    let mut moved = tables();
    for drive in &mut moved.measurements {
        let i = (0..6)
            .find(|i| person(*i) == drive.meta.participant)
            .unwrap();
        let room = match drive.meta.condition.as_str() {
            "own" => 40.0 - 2.0 * i as f64,
            "same" => 30.0,
            "across" => 30.0 + change(i),
            _ => continue,
        };
        drive.values.insert(ROOM.to_owned(), Some(room));
    }
    moved.conditions = (0..6)
        .map(|i| steered(i, "across", Some(angle(i)), false))
        .collect();
    let a = analysed(moved);
    let kept = a.kept.iter().find(|k| k.measure == ROOM).unwrap();
    assert_eq!((kept.across, kept.from), (id("across"), id("same")));
    near(kept.line.r, -1.0);
    // A wave once round is nearly all that the angle does.
    let r = kept.circular_r.unwrap();
    assert!(r > 0.9 && r < 0.999, "{r}");
    // The upper tail of F(2, 3) at (R² / 2) / ((1 - R²) / 3).
    near(kept.circular_p_holm, (1.0 - r * r).powf(1.5));
    assert!(kept.angle.r.unwrap().abs() < 0.9);
    let (first, second) = (kept.points[0], kept.points[1]);
    near(Some(first.0), std::f64::consts::TAU - 0.5);
    near(Some(second.0), 0.6);
    near(Some(second.1), change(1));
    // Nobody's share of time on the left was measured.
    let left = a
        .kept
        .iter()
        .find(|k| k.measure == "left_lane_fraction")
        .unwrap();
    assert!(left.circular_p_holm.is_none() && left.points.is_empty());
}

const TOR: &str = "[[measure]]\nid = \"tor_s\"\ntitle = \"Take-over time\"\nunit = \"s\"\n";

/// Six people who took over in 2 s and in 3 s and some tenths, each in a mean of two trials.
fn taken_over(conditions: &[(&str, f64)]) -> Tables {
    let mut tables = Tables::default();
    for i in 0..6 {
        for (condition, seconds) in conditions {
            tables.own.push(maveric_domain::OwnMeasurement {
                participant: person(i),
                condition: id(condition),
                measure: "tor_s".to_owned(),
                value: seconds * (1.0 + 0.1 * i as f64),
                n: 2,
            });
        }
    }
    tables
}

#[test]
fn measures_of_ones_own_are_enough_for_a_study_and_need_no_baseline() {
    let text = plain(&["calm", "sporty"], TOR);
    let a = analysed_by(&text, taken_over(&[("calm", 2.0), ("sporty", 3.0)]));
    assert_eq!(a.panels.len(), 1);
    let time = panel(&a, "tor_s");
    assert_eq!((&*time.title, &*time.unit), ("Take-over time", "s"));
    assert_eq!((time.n, time.differences_from), (6, None));
    // 1 s times 1, 1.1, … 1.5, the second condition above the first.
    near(time.contrasts[0].mean_difference, -1.25);
    assert!(time.comparison.is_some());
    assert!(
        a.notes.iter().any(|note| note.contains("no drives")),
        "{:?}",
        a.notes
    );
}

#[test]
fn where_somebody_has_a_value_in_the_baseline_differences_from_it_are_compared() {
    let text = plain(&["calm", "sporty"], TOR);
    let three = [("own", 1.0), ("calm", 2.0), ("sporty", 3.0)];
    let a = analysed_by(&text, taken_over(&three));
    let time = panel(&a, "tor_s");
    assert_eq!((time.n, time.differences_from), (6, Some(id("own"))));
    near(time.rows[5][1], 2.0 * 1.5);
    // Somebody without a value is left out, and named.
    let mut less = taken_over(&three);
    less.own
        .retain(|row| row.participant != person(2) || row.condition != id("own"));
    let less = analysed_by(&text, less);
    let time = panel(&less, "tor_s");
    assert_eq!((time.n, &time.dropped[..]), (5, &["P3".to_owned()][..]));
}

#[test]
fn whoever_was_only_measured_came_and_whom_the_design_leaves_out_has_no_value() {
    let rules = "[exclude]\nfewer_conditions_than = 2\npeople = { P1 = \"withdrew\" }\n";
    let text = plain(&["calm", "sporty"], &format!("{TOR}{rules}"));
    let mut tables = taken_over(&[("calm", 2.0), ("sporty", 3.0)]);
    tables
        .own
        .retain(|row| row.participant != person(1) || row.condition != id("calm"));
    let a = analysed_by(&text, tables);
    assert_eq!((a.flow.drove, a.flow.analysed), (6, 4));
    let rows = &panel(&a, "tor_s").participants;
    assert_eq!(rows.join(" "), "P3 P4 P5 P6");
}

#[test]
fn a_measure_that_is_declared_and_that_nobody_has_is_told_and_not_tested() {
    let text = plain(
        &["calm", "sporty"],
        &format!("{TOR}[[measure]]\nid = \"glances\"\nunit = \"1\"\n"),
    );
    let a = analysed_by(&text, taken_over(&[("calm", 2.0), ("sporty", 3.0)]));
    assert_eq!(a.panels.len(), 1);
    assert!(
        a.notes
            .iter()
            .any(|note| note.ends_with("study’s own: glances.")),
        "{:?}",
        a.notes
    );
}
