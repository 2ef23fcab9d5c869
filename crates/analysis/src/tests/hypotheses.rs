//! What the design claims, judged by its rule.

use super::*;

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
        for (condition, faster) in [("same", 0.4), ("fast", 2.2), ("slow", -1.2), ("across", 0.1)] {
            gap.measurements.push(drive_of(i, condition, Some(own + faster * i as f64)));
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
    let test_of = |judged: &Judged| {
        let pairs = pairs::values(panel, judged.first, judged.second);
        let differences: Vec<f64> = pairs.iter().map(|[a, b]| a - b).collect();
        let (_, test) = crate::verdict::equivalent((-1.0, 1.0), &differences).unwrap();
        test.unwrap()
    };
    let test = test_of(below);
    near(Some(width(below)), test.ci.high.unwrap() - test.ci.low.unwrap());
    let test = test_of(same);
    near(Some(width(same)), test.ci90.high.unwrap() - test.ci90.low.unwrap());
    let bias = a.reproduction[0].bias.as_ref().unwrap();
    assert_eq!((bias.n, a.reproduction[0].n), (7, 7));
    assert!(a.nearer.iter().all(|row| row.n == 7));
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
fn a_hypothesis_turns_its_own_contrast_and_no_other_of_one_of_its_conditions() {
    let pairs = |declared: &str| -> Vec<[String; 2]> {
        let a = analysed_by(&format!("{DESIGN}{declared}"), tables());
        let pairs = panel(&a, SPEED).contrasts.iter();
        pairs.map(|c| [c.first.to_string(), c.second.to_string()]).collect()
    };
    let declared = pairs("");
    for [first, second] in &declared {
        for (first, second) in [(first, second), (second, first)] {
            let rule = format!("[\"{first}\", \"{second}\"]");
            let turned = pairs(&hypothesis(&rule, "direction = \"+\""));
            let expected = declared.iter().map(|[a, b]| {
                if [a, b] == [second, first] {
                    [b.clone(), a.clone()]
                } else {
                    [a.clone(), b.clone()]
                }
            });
            assert_eq!(turned, expected.collect::<Vec<_>>(), "{first} {second}");
        }
    }
}

fn hypothesis(contrast: &str, rule: &str) -> String {
    format!("[[hypothesis]]\nsays = \"so\"\noutcome = \"{SPEED}\"\ncontrast = {contrast}\n{rule}\n")
}

#[test]
fn a_hypothesis_is_judged_by_its_rule() {
    let judged = |contrast: &str, rule: &str| {
        let text = plain(&["same", "fast", "slow", "across"], &hypothesis(contrast, rule));
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
    assert_eq!(two(r#"["slow", "fast"]"#, "direction = \"+\"").verdict, Verdict::Fails);
    // Six people and six pairs by ranks: nothing can be below .05 after Holm.
    assert_eq!(judged(r#"["slow", "fast"]"#, "direction = \"-\""), Verdict::NotShown);
    // Means 0 and 0.07 m/s, that is 0.25 km/h apart.
    let near_to = r#"["same", "across"]"#;
    assert_eq!(judged(near_to, "equivalent = [-6.5, 6.5]"), Verdict::Shown);
    assert_eq!(judged(near_to, "equivalent = [-0.1, 0.1]"), Verdict::NotShown);
    assert_eq!(judged(near_to, "equivalent = [8, 15]"), Verdict::Fails);
    let nobody = plain(&["fast", "slow"], &hypothesis(r#"["slow", "fast"]"#, "direction = \"-\""));
    let nobody = nobody.replace(SPEED, "lane_changes");
    assert_eq!(analysed_by(&nobody, tables()).hypotheses[0].verdict, Verdict::NotAsked);
    let mut few = tables();
    for drive in few.measurements.iter_mut().skip(10) {
        drive.values.clear();
    }
    let text = plain(&["fast", "slow"], &hypothesis(r#"["slow", "fast"]"#, "direction = \"-\""));
    assert_eq!(analysed_by(&text, few).hypotheses[0].verdict, Verdict::TooFew);
}

#[test]
fn what_fails_to_be_the_same_has_the_p_that_says_so_and_only_a_direction_is_corrected() {
    let judged = |rule: &str| {
        let claim = hypothesis(r#"["same", "across"]"#, rule);
        let text = plain(&["same", "fast", "slow", "across"], &claim);
        analysed_by(&text, tables()).hypotheses[0].clone()
    };
    let fails = judged("equivalent = [8, 15]");
    assert_eq!(fails.verdict, Verdict::Fails);
    near(fails.p_outside, 1.0 - fails.p.unwrap());
    assert!(fails.p_outside.unwrap() < 0.05 && fails.p.unwrap() > 0.95);
    let shown = judged("equivalent = [-6.5, 6.5]");
    assert_eq!(shown.verdict, Verdict::Shown);
    assert!(shown.p_outside.unwrap() > 0.95 && shown.p.unwrap() < 0.05);
    assert!(!fails.holm && !shown.holm);
    let directed = judged("direction = \"+\"");
    assert!(directed.holm && directed.p_outside.is_none());
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
    assert!(rule(SPEED).contains("between −1 and 1 km/h (both"), "{}", rule(SPEED));
    let rating = rule("jian_trust.overall");
    assert!(rating.contains("between −1 and 1 (both"), "{rating}");
    for (sign, way, expected) in [("+", "above", Sign::Plus), ("-", "below", Sign::Minus)] {
        let text = hypothesis(r#"["fast", "slow"]"#, &format!("direction = \"{sign}\""));
        let a = analysed_by(&plain(&["fast", "slow"], &text), tables());
        assert!(a.hypotheses[0].rule.contains(&format!("lies {way} the second")));
        let part = &a.findings[0].parts[0];
        assert_eq!(part.rule, crate::finding::Rule::Directed { expected });
        assert_eq!(part.of, format!("{SPEED}.fast-slow"));
    }
}
