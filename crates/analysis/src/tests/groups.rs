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
    let text = plain(&[], "") + &crossed();
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
