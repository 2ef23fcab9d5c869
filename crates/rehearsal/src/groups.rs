//! Made-up people in the groups that a design divides, with their covariates.

use maveric_analysis::Person;
use maveric_domain::Design;
use maveric_participants::Participant;

/// A row a person, dealt evenly into the levels that the design labels, or into two; their age stands for every covariate.
///
/// Groups differ in nothing: how often a test of them says yes is how often it errs. Empty where the design has neither.
pub(crate) fn rows(design: &Design, people: &[Participant]) -> Vec<Person> {
    if design.tested_columns().next().is_none() {
        return Vec::new();
    }
    let row = |(place, person): (usize, &Participant)| {
        let mut place = place;
        let groups = design.factors().iter().map(|factor| {
            let mut levels: Vec<&str> = factor.levels.keys().map(String::as_str).collect();
            if levels.len() < 2 {
                levels = vec!["1", "2"];
            }
            let level = levels[place % levels.len()];
            place /= levels.len();
            (factor.name.clone(), level.to_owned())
        });
        let groups: Vec<(String, String)> = groups.collect();
        let covariates = design.covariates().iter();
        let ages = covariates.map(|c| (c.column.clone(), person.age_years.to_string()));
        Person {
            id: person.id.clone(),
            learned: false,
            tested: true,
            order: person.order.clone(),
            columns: groups.into_iter().chain(ages).collect(),
        }
    };
    people.iter().enumerate().map(row).collect()
}

#[cfg(test)]
mod tests {
    use crate::{World, found_in, testing};
    use maveric_analysis::{Purpose, analyse};
    use maveric_domain::Design;

    const CROSSED: &str = r#"
        [study]
        title = "Two styles in two kinds of traffic"
        [people]
        learn = { study = "1" }
        [style]
        score = "adb.total"
        points = 15
        [baseline]
        id = "own"
        [[condition]]
        id = "a"
        car = { dial = -15 }
        levels = { style = "calm", traffic = "free" }
        [[condition]]
        id = "b"
        car = { dial = -15 }
        levels = { style = "calm", traffic = "dense" }
        [[condition]]
        id = "c"
        car = { dial = 15 }
        levels = { style = "sporty", traffic = "free" }
        [[condition]]
        id = "d"
        car = { dial = 15 }
        levels = { style = "sporty", traffic = "dense" }
        [[outcome]]
        measure = "mean_velocity_mps"
        [[hypothesis]]
        says = "Traffic changes nothing"
        outcome = "mean_velocity_mps"
        contrast = ["a", "b"]
        equivalent = [-5, 5]
    "#;
    const GROUPS: &str = "[[factor]]\ncolumn = \"vehicle\"\nlevels = { c = \"Car\", t = \"Truck\" }\n[[covariate]]\ncolumn = \"age\"\n";

    fn world(more: &str) -> World {
        let design = Design::from_toml(&format!("{CROSSED}{more}")).unwrap();
        let known = testing::world();
        World { design, ..known }
    }

    #[test]
    fn a_rehearsal_tests_every_effect_of_factors_groups_and_covariates_and_judges_equivalence() {
        let effects = |more: &str| -> Vec<(String, bool)> {
            let study = world(more).study(12, 3).unwrap();
            let found = found_in(&analyse(&study.data, Purpose::Simulation).unwrap());
            assert_eq!(found.judged.len(), 1);
            let panel = "panel.mean_velocity_mps.";
            let tests = found.tests.iter().filter_map(|t| {
                // Over everybody: within a group the key has its level before a point.
                let effect = t.key.strip_prefix(panel).filter(|e| !e.contains('.'))?;
                t.family.is_none().then(|| (effect.to_owned(), t.p.is_some()))
            });
            tests.collect()
        };
        let named = |names: &[&str]| -> Vec<(String, bool)> {
            names.iter().map(|n| ((*n).to_owned(), true)).collect()
        };
        assert_eq!(effects(""), named(&["style", "traffic", "style:traffic"]));
        let all = [
            "vehicle",
            "style",
            "traffic",
            "vehicle:style",
            "vehicle:traffic",
            "style:traffic",
            "vehicle:style:traffic",
            "age",
        ];
        assert_eq!(effects(GROUPS), named(&all));
    }

    #[test]
    fn people_are_dealt_evenly_and_a_design_without_groups_has_no_table_of_people() {
        let study = world(GROUPS).study(12, 3).unwrap();
        let cars = study.people.iter().filter(|p| study.data.column(&p.id, "vehicle") == Some("c"));
        assert_eq!(cars.count(), 6);
        let plain = world("").study(12, 3).unwrap();
        let first = &plain.people[0].id;
        assert_eq!(plain.data.column(first, "vehicle"), None);
    }
}
