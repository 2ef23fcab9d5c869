//! The standard errors of a style are of the person where those learned from drove twice.

#[path = "../examples/made_up/mod.rs"]
mod made_up;

use made_up::errors::errors;
use maveric_model::HeadsKind;
use maveric_rehearsal::validation::{Held, ShareOfPeople};
use maveric_simulator::{People, Scenario};

/// Other people than those on whom the method was made.
const SEED: u64 = 13;
const SIZES: (usize, usize) = (30, 60);

/// Whether 68.3 and 95.4 % lie within what 60 people leave open (SD of a share some 3.5 and 1.7 %).
fn hold(held: &Held) -> bool {
    let near = |share: Option<ShareOfPeople>, right: f64, open: f64| {
        share.is_some_and(|share| (share.estimate - right).abs() < open)
    };
    near(held.within_1, 0.683, 0.11) && near(held.within_2, 0.954, 0.055)
}

#[test]
fn errors_of_the_person_hold_whether_people_vary_from_day_to_day_or_not() {
    let steady = People::Drivers(Box::new(Scenario::paper().settings().drivers.clone()));
    let vary: People = toml::from_str(maveric_data::POPULATION_RETEST_07).unwrap();
    for (who, drive_is_enough) in [(steady, true), (vary, false)] {
        let errors = errors(&who, HeadsKind::Linear, SIZES, SEED).unwrap();
        assert!(errors.days.is_some());
        assert!(hold(&errors.of_person), "{:?}", errors.of_person);
        assert_eq!(hold(&errors.of_drive), drive_is_enough, "{:?}", errors.of_drive);
    }
}
