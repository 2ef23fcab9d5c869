//! Conditions within people: values, differences and contrasts.

use super::*;

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
    assert!(a.descriptives.iter().all(|d| d.condition != id("own") || d.outcome == SPEED));
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
fn where_the_score_of_the_style_counts_calmness_a_car_turned_up_is_expected_to_be_slower() {
    let faster = |aggression: &str| {
        let design = format!(
            "[model]\nfile = \"lab.maveric\"\n[style]\nscore = \"adb.total\"\nrange = [11, 55]\n{aggression}\n"
        );
        let text = plain(&["same", "fast"], &design)
            .replace("id = \"fast\"\n", "id = \"fast\"\ncar = { dial = 15, recorded = true }\n")
            .replace("id = \"same\"\n", "id = \"same\"\ncar = { dial = 0, recorded = true }\n");
        let a = analysed_by(&text, tables());
        panel(&a, SPEED).contrasts[0].expected
    };
    assert_eq!(faster(""), Some(Sign::Minus));
    assert_eq!(faster("aggression = \"+\""), Some(Sign::Minus));
    assert_eq!(faster("aggression = \"-\""), Some(Sign::Plus));
}

#[test]
fn conditions_that_were_only_recorded_are_compared_and_nothing_is_said_of_a_dial() {
    let a = analysed_by(&plain(&["same", "fast", "slow"], ""), tables());
    assert_eq!(panel(&a, SPEED).contrasts.len(), 3);
    assert!(panel(&a, SPEED).contrasts.iter().all(|c| c.expected.is_none()));
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
    let [pair] = &panel.contrasts[..] else { panic!("one pair") };
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
    assert!(a.panels.iter().all(|p| p.contrasts.is_empty() && p.test.is_none()));
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
    let pairs: Vec<_> = panel.contrasts.iter().map(|c| (c.first, c.second)).collect();
    assert_eq!(pairs, [(id("slow"), id("same")), (id("slow"), id("fast"))]);
    // Slower than both, by every test of these six people.
    assert!(panel.contrasts.iter().all(|c| c.mean_difference < Some(0.0)));
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
    assert_eq!([told(Some(60.0)), told(None)], [[true, false], [false, false]]);
}

#[test]
fn a_family_of_correlations_without_differences_from_the_own_style_is_told() {
    let family = "[homophily]\nfactors = [\"mini_ipip\"]\nratings = [\"jian_trust.overall\"]\n";
    let told = |text: &str| {
        let a = analysed_by(text, tables());
        let told = a.notes.iter().any(|note| note.contains("`[homophily]`"));
        (told, a.homophily.is_empty())
    };
    assert_eq!(told(&plain(&["fast", "slow"], family)), (true, true));
    assert_eq!(told(&plain(&["fast", "slow"], "")), (false, true));
    assert_eq!(told(DESIGN), (false, false));
}
