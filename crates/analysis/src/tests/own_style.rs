//! The car in the own style and those beside it: the line, what was reproduced, what was preferred.

use super::*;

#[test]
fn the_line_against_the_score_is_the_correlation_by_hand() {
    let a = analysed(tables());
    let line = a.line.as_ref().unwrap();
    let row = |name: &str| line.rows.iter().find(|r| r.measure == name).unwrap();
    // Positions 0 to 5: Sxx = 17.5; Sxy = 446 - 6 · 2.5 · 80/3 = 46; Syy = 4418 - 6 · (80/3)² = 454/3.
    near(row("adb.total").correlation.r, 46.0 / (17.5 * 454.0_f64 / 3.0).sqrt());
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
    let fast = tied.measurements.iter().filter(|d| d.meta.condition == id("fast"));
    let fast: Vec<Option<f64>> = fast.map(|d| d.values[SPEED]).collect();
    let same = tied.measurements.iter_mut().filter(|d| d.meta.condition == id("same"));
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
    let [fast, slow] = &trust.others[..] else { panic!("two conditions away from 0") };
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
    assert_eq!((distrust.less_is_better, distrust.others[0].above), (true, 5));
    assert_eq!(panel(&a, "jian_trust.overall").unit, "rating, 1 to 7");
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
        let i = (0..6).find(|i| person(*i) == drive.meta.participant).unwrap();
        let room = match drive.meta.condition.as_str() {
            "own" => 40.0 - 2.0 * i as f64,
            "same" => 30.0,
            "across" => 30.0 + change(i),
            _ => continue,
        };
        drive.values.insert(ROOM.to_owned(), Some(room));
    }
    moved.conditions = (0..6).map(|i| steered(i, "across", Some(angle(i)), false)).collect();
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
    let left = a.kept.iter().find(|k| k.measure == "left_lane_fraction").unwrap();
    assert!(left.circular_p_holm.is_none() && left.points.is_empty());
}
