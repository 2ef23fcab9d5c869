//! Factors between people, covariates, and conditions that cross.

use super::*;

/// A row a person and condition of a panel.
struct Long {
    people: Vec<String>,
    conditions: Vec<String>,
    cities: Vec<Option<String>>,
    values: Vec<Option<f64>>,
}

fn long(panel: &Panel) -> Long {
    let mut long =
        Long { people: Vec::new(), conditions: Vec::new(), cities: Vec::new(), values: Vec::new() };
    let city = |who: &str| ["B", "A"][who[1..].parse::<usize>().unwrap() % 2];
    let mut people: Vec<_> = panel.participants.iter().zip(&panel.rows).collect();
    people.sort_by_key(|(who, _)| city(who));
    for (who, row) in people {
        for (condition, value) in panel.conditions.iter().zip(row) {
            long.people.push(who.clone());
            long.conditions.push(condition.to_string());
            long.cities.push(Some(city(who).to_owned()));
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
    let groups = panels.iter().map(|p| p.group.as_ref().map(|g| g.level.as_str()));
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
    // An interval of a city is of its own people, one of both does not pool them.
    let means = &panels[0].by_factor.as_ref().unwrap().means;
    let interval_at = |levels: &[&str]| {
        let mean = means.iter().find(|mean| mean.levels == levels);
        mean.unwrap().interval
    };
    let fast_in = |city: &str| -> Vec<f64> {
        let rows = long.cities.iter().zip(&long.conditions).zip(&long.values);
        let fast = rows.filter(|((of, condition), _)| {
            of.as_deref() == Some(city) && condition.as_str() == "fast"
        });
        fast.filter_map(|(_, value)| *value).collect()
    };
    let [_, low, _] = maveric_stats::mean_interval(&fast_in("A"), 0.95).unwrap();
    near(interval_at(&["A", "fast"]).map(|ends| ends.0), low);
    let cities = ["A", "B"].map(fast_in);
    let [_, _, high] = maveric_stats::mean_of_groups_interval(&cities, 0.95).unwrap();
    near(interval_at(&["fast"]).map(|ends| ends.1), high);
    // Three contrasts over everybody are one family, six of two groups another.
    for (family, count) in [(&panels[..1], 3.0), (&panels[1..], 6.0)] {
        let contrasts = || family.iter().flat_map(|p| &p.contrasts);
        let least = contrasts().filter_map(|c| c.p).fold(1.0, f64::min);
        let holm = contrasts().filter_map(|c| c.p_holm).fold(1.0, f64::min);
        near(Some(holm), (count * least).min(1.0));
    }
}

#[test]
fn a_primary_outcome_whose_test_can_never_be_run_is_not_testable_and_says_why() {
    let primary = |test: &str, more: &str| {
        let outcome = format!(
            "[[outcome]]\nmeasure = \"{SPEED}\"\nprimary = true\ntest = \"{test}\"\ncontrast = [\"fast\", \"slow\"]\n"
        );
        let text = plain(&["same", "fast", "slow"], &(outcome + more));
        let mut a = analysed_by(&text, with_people(AGES));
        a.primary.remove(0)
    };
    for (more, said) in [
        ("[[factor]]\ncolumn = \"city\"\n", "[[factor]] `city`"),
        ("[[covariate]]\ncolumn = \"age\"\n", "[[covariate]] `age`"),
    ] {
        for test in ["ordinal", "rm-anova", "friedman"] {
            let judged = primary(test, more);
            assert_eq!(judged.verdict, Verdict::NotTestable, "{test} {more}");
            let why = judged.why_not.unwrap();
            assert!(why.contains(&format!("`{test}` beside the {said}")), "{why}");
        }
        let why = primary("mixed", more).why_not.unwrap_or_default();
        assert!(!why.contains("beside the"), "{why}");
    }
    let friedman = primary("friedman", "");
    assert_ne!(friedman.verdict, Verdict::NotTestable, "{:?}", friedman.why_not);
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
    let a = analysed_by(&plain(&["same", "fast", "slow"], declared), with_people(AGES));
    let effects = panel(&a, SPEED).comparison.as_ref().unwrap().effects();
    let names: Vec<&str> = effects.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["condition", "age", "age:condition"]);
    let mut ages = AGES;
    ages[2] = "old";
    let data = StudyData::new(&design(&text), with_people(ages)).unwrap();
    let refused = analyse(&data, Purpose::Report).unwrap_err().to_string();
    assert!(refused.contains("`age` of `P3` is `old`"), "{refused}");
}

#[test]
fn whoever_lacks_a_factor_or_a_covariate_is_in_no_test_is_named_and_not_counted() {
    let text = |more: &str| plain(&["same", "fast", "slow"], more);
    let without = |column: &str| {
        let mut people = with_people(AGES);
        let columns = &mut people.people[1].columns;
        columns.insert(column.to_owned(), String::new());
        people
    };
    for (column, more) in [
        ("city", "[[factor]]\ncolumn = \"city\"\nlabel = \"City\"\n"),
        ("age", "[[covariate]]\ncolumn = \"age\"\nlabel = \"Age\"\n"),
    ] {
        let label = if column == "city" { "City" } else { "Age" };
        let a = analysed_by(&text(more), without(column));
        let speed = panel(&a, SPEED);
        assert_eq!((speed.n, speed.lacking()), (5, 0), "{column}");
        assert_eq!(speed.dropped, ["P2"]);
        assert_eq!(speed.without_column.get("P2").map(String::as_str), Some(column));
        let Some(ByDesign::Factorial(found)) = &speed.comparison else { panic!("several effects") };
        assert_eq!(found.found.anova.n, speed.n);
        for contrast in &speed.contrasts {
            assert_eq!(contrast.people.iter().sum::<usize>(), speed.n);
        }
        let left_out = a.exclusions.iter().find(|e| e.who == "P2").unwrap();
        assert!(left_out.why.contains(&format!("no value of {label}")), "{}", left_out.why);
        // Nobody makes a group of those without one.
        let levels = a.panels.iter().filter_map(|p| p.group.as_ref());
        assert!(levels.clone().all(|g| g.level != "not given"));
        // What the test does not take is of no matter.
        let plain = analysed_by(&text(""), without(column));
        assert_eq!(panel(&plain, SPEED).n, 6);
        let whole = analysed_by(&text(more), with_people(AGES));
        assert!(panel(&whole, SPEED).without_column.is_empty() && panel(&whole, SPEED).n == 6);
    }
}

#[test]
fn groups_alone_have_means_of_their_own_in_alphabetical_order_and_no_card_on_conditions() {
    let text = plain(&["fast"], "[[factor]]\ncolumn = \"city\"\n");
    let text = text.replace("[baseline]\nid = \"own\"\n", "");
    let of = |first: &str, second: &str| {
        let mut people = with_people(AGES);
        for (i, person) in people.people.iter_mut().enumerate() {
            let city = [first, second][i % 2];
            person.columns.insert("city".to_owned(), city.to_owned());
        }
        analysed_by(&text, people)
    };
    for (first, second) in [("A", "B"), ("B", "A")] {
        let a = of(first, second);
        let speeds: Vec<&Panel> = a.panels.iter().filter(|p| p.outcome == SPEED).collect();
        // Within a group there is nothing to compare.
        assert_eq!((speeds.len(), speeds[0].contrasts.len()), (1, 0));
        assert!(matches!(speeds[0].comparison, Some(ByDesign::Groups(_))));
        let by_factor = speeds[0].by_factor.as_ref().unwrap();
        assert_eq!(by_factor.factors[0].levels, ["A", "B"]);
        let of_first = by_factor.means.iter().find(|m| m.levels == [first]).unwrap();
        let values: Vec<f64> = [0, 2, 4].map(|i| (OWN[i] + FASTER[1][i]) * 3.6).to_vec();
        near(Some(of_first.mean), values.iter().sum::<f64>() / 3.0);
        let [_, low, _] = mean_interval(&values, 0.95).unwrap();
        near(of_first.interval.map(|i| i.0), low);
        assert_eq!((of_first.n, of_first.within), (3, None));
        assert!(a.findings.iter().all(|f| f.question != Question::Differ));
    }
    // Two groups are no two factors: a contrast of them is said to have no test.
    for (declared, said) in
        [("", false), ("[contrasts]\nfactors = [{ city = [\"A\", \"B\"] }]\n", true)]
    {
        let a = analysed_by(&format!("{text}{declared}"), with_people(AGES));
        let panel = panel(&a, SPEED);
        let why = |reason: &String| reason.contains("contrasts of factors have no test");
        assert_eq!(panel.reasons.iter().any(why), said, "{:?}", panel.reasons);
        assert!(panel.by_factor.is_some());
    }
    let both = analysed_by(&plain(&["fast", "slow"], ""), tables());
    assert!(both.findings.iter().any(|f| f.question == Question::Differ));
}

/// The four conditions as two speeds on two sides.
fn crossed() -> String {
    let levels = [
        ("same", "low", "left"),
        ("fast", "high", "left"),
        ("slow", "low", "right"),
        ("across", "high", "right"),
    ];
    let condition = |(id, speed, side): (&str, &str, &str)| {
        format!(
            "[[condition]]\nid = \"{id}\"\nlevels = {{ speed = \"{speed}\", side = \"{side}\" }}\n"
        )
    };
    levels.map(condition).concat()
}

/// Names and methods of what was run, as far as each effect has one.
fn run_effects(found: &ByDesign) -> Vec<(String, Option<EffectMethod>)> {
    match found {
        ByDesign::Factorial(found) => {
            let tests = found.found.tests.iter();
            tests.map(|(name, test)| (name.to_owned(), Some(test.method))).collect()
        }
        other => other.effects().iter().map(|(name, _)| ((*name).to_owned(), None)).collect(),
    }
}

#[test]
fn what_is_declared_is_what_is_run() {
    let mut effects = 0;
    for conditions in
        [&["same", "fast"][..], &["same", "fast", "slow"], &["same", "fast", "slow", "across"], &[]]
    {
        for factor in ["", "[[factor]]\ncolumn = \"city\"\n"] {
            let product = if conditions.is_empty() { "speed" } else { "condition" };
            let declared = format!("[[covariate]]\ncolumn = \"age\"\nwith = [\"{product}\"]\n");
            for covariate in ["", "[[covariate]]\ncolumn = \"age\"\n", &declared] {
                let mut text = plain(conditions, &(factor.to_owned() + covariate));
                if conditions.is_empty() {
                    text += &crossed();
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
fn a_design_without_anything_to_compare_plans_no_test_and_one_condition_beside_a_baseline_does() {
    let of_one = |baseline: &str, more: &str| {
        let text = plain(&["same"], more).replace("id = \"own\"", baseline);
        planned(&design(&text.replace("[baseline]\n\n", "")))
    };
    let none = of_one("", "");
    assert!(matches!(none, PlannedTest::None(_)), "{none:?}");
    let city = "[[factor]]\ncolumn = \"city\"\n";
    assert_eq!(of_one("", city), PlannedTest::Groups);
    let both = city.to_owned() + "[[covariate]]\ncolumn = \"age\"\n";
    assert_eq!(of_one("", &both), PlannedTest::Covariance);
    // One condition is held against the baseline, in the run as in the plan.
    let own = "id = \"own\"";
    assert_eq!(of_one(own, ""), PlannedTest::Pair);
    let by_city = of_one(own, city);
    let PlannedTest::Effects(plan) = &by_city else {
        panic!("{by_city:?}");
    };
    let planned: Vec<&str> = plan.effects.iter().map(|e| e.effect.as_str()).collect();
    let a = analysed_by(&plain(&["same"], city), with_people(AGES));
    let run = panel(&a, SPEED).comparison.as_ref().unwrap();
    let run = run_effects(run);
    let run: Vec<&str> = run.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(planned, run);
}

#[test]
fn conditions_that_cross_two_factors_have_main_effects_and_their_interaction() {
    let text = plain(&[], "") + &crossed();
    let a = analysed_by(&text, tables());
    let panel = panel(&a, SPEED);
    let effects = panel.comparison.as_ref().unwrap().effects();
    let names: Vec<&str> = effects.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["side", "speed", "side:speed"]);
    assert_eq!(panel.contrasts.len(), 6);
    let broken =
        text.replace("speed = \"high\", side = \"right\"", "speed = \"middle\", side = \"right\"");
    let a = analysed_by(&broken, tables());
    let says = |note: &String| note.contains("do not cross");
    assert!(a.notes.iter().any(says), "{:?}", a.notes);
    assert!(a.panels[0].comparison.as_ref().unwrap().one_factor().is_some());
}
