use super::*;
use maveric_domain::design::{williams, williams_rows};
use std::collections::BTreeSet;

const ELSEWHERE: &str = "[model]\nfile = \"model.maveric\"\n";
const MINE: &str = "[[condition]]\nid = \"mine\"\ncar = { dial = 0, recorded = true }\n";
const CALM: &str = "[[condition]]\nid = \"calm\"\ncar = { dial = -5, recorded = true }\n";
const MEAN: &str = "[[condition]]\nid = \"mean\"\ncar = { mean = true, recorded = true }\n";

/// A design with these tables.
fn design(tables: &str) -> Design {
    let text = format!(
        "[study]\ntitle = \"Three cars\"\n[style]\nscore = \"adb.total\"\n[baseline]\nid = \"own\"\n{tables}"
    );
    Design::from_toml(&text).unwrap()
}

/// The worlds of somebody: practice, drive, then a condition and its world for each ride.
fn worlds(line: &str, participant: &str, index: usize) -> (Vec<String>, Vec<(String, String)>) {
    let design = design(&format!("{ELSEWHERE}{CALM}{MINE}{MEAN}[protocol]\n{line}\n"));
    let riding =
        Riding { order: &williams(3, index), styles: &Styles::new(), range: ScoreRange::ADB };
    let steps = of_design(&design, &[], &Texts::default(), participant, Some(riding)).unwrap();
    let by_hand = steps.iter().filter_map(|step| match step {
        Step::Practice { seed, .. } | Step::Drive { seed, .. } => Some(seed.clone()),
        _ => None,
    });
    let rides = steps.iter().filter_map(|step| match step {
        Step::Ride { condition, seed, .. } => Some((condition.to_string(), seed.clone())),
        _ => None,
    });
    (by_hand.collect(), rides.collect())
}

fn seeds(rides: &[(String, String)]) -> Vec<&String> {
    rides.iter().map(|(_, seed)| seed).collect()
}

#[test]
fn a_turn_of_the_dial_is_a_third_of_a_step_and_where_none_is_said_of_one_on_the_range() {
    let turn = |style: &str, range: ScoreRange| {
        let tables = format!(
            "{style}[[condition]]\nid = \"free\"\ncar = {{ free = true, recorded = true }}\n"
        );
        let riding = Riding { order: &[0], styles: &Styles::new(), range };
        let (design, texts) = (design(&tables), Texts::default());
        let steps = of_design(&design, &[], &texts, "P001", Some(riding)).unwrap();
        let turns = steps.iter().find_map(|step| match step {
            Step::Ride { turns, .. } => *turns,
            _ => None,
        });
        turns.unwrap()
    };
    let risky = ScoreRange::new(1.0, 6.0).unwrap();
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}");
    near(turn(ELSEWHERE, ScoreRange::ADB), 5.0);
    near(turn(ELSEWHERE, risky), 1.7 / 3.0);
}

#[test]
fn which_ride_was_in_the_own_style_is_asked_by_the_numbers_that_the_rides_had() {
    let which = "[protocol]\nwhich = [\"mean\", \"mine\"]\ndebrief = \"debrief.md\"\n";
    let design = design(&format!("{ELSEWHERE}{MINE}{CALM}{MEAN}{which}"));
    let scale = include_str!("../../../../study_data/further_scales/which.toml");
    let scale = Scale::from_toml(scale).unwrap();
    let asked = |order: &[usize]| {
        let riding = Riding { order, styles: &Styles::new(), range: ScoreRange::ADB };
        let (texts, scales) = (Texts::default(), std::slice::from_ref(&scale));
        let steps = of_design(&design, scales, &texts, "P001", Some(riding)).unwrap();
        let asked = steps.iter().find_map(|step| match step {
            Step::Scale { instruction, moment: Moment::Post, .. } => instruction.clone(),
            _ => None,
        });
        asked.unwrap()
    };
    assert!(asked(&[0, 1, 2]).starts_with("Think of ride 1 and of ride 3."));
    assert!(asked(&[1, 2, 0]).starts_with("Think of ride 2 and of ride 3."));
}

#[test]
fn the_consent_asks_for_a_style_where_it_may_be_lent_to_others_who_take_part_and_nowhere_else() {
    const HERE: &str = "[people]\nlearn = { part = \"learn\" }\ntest = { part = \"test\" }\n";
    const BOTH: &str = "[people]\nlearn = { part = \"all\" }\ntest = { part = \"all\" }\n";
    let asked = |learned: &str, car: &str, rides: bool| {
        let other = format!("[[condition]]\nid = \"other\"\ncar = {{ {car}, recorded = true }}\n");
        let design = design(&format!("{learned}{MINE}{other}"));
        let texts = Texts { consent: Some("You drive.".to_owned()), ..Texts::default() };
        let styles = Styles::new();
        let riding =
            rides.then_some(Riding { order: &[0, 1], styles: &styles, range: ScoreRange::ADB });
        let steps = of_design(&design, &[], &texts, "P001", riding).unwrap();
        let lend = steps.into_iter().find_map(|step| match step {
            Step::Text { agree: true, lend, .. } => Some(lend),
            _ => None,
        });
        lend.unwrap()
    };
    let tested = "other = \"matched\"";
    let learned = "other = \"matched\", from = \"learned\"";
    let sentence = asked(ELSEWHERE, tested, true).unwrap();
    assert!(sentence.contains("without my name"), "{sentence}");
    // Where the model is of people elsewhere, nobody who only drives is a donor, and nobody is whose styles are not lent.
    assert_eq!(asked(ELSEWHERE, tested, false), None);
    assert_eq!(asked(ELSEWHERE, learned, true), None);
    // Whoever is learned from here is a donor, in either case; whoever rides then, where those who ride are, or are learned from too.
    assert!(asked(HERE, tested, false).is_some() && asked(HERE, learned, false).is_some());
    assert!(asked(HERE, tested, true).is_some());
    assert_eq!(asked(HERE, learned, true), None);
    assert!(asked(BOTH, learned, true).is_some());
    for rides in [false, true] {
        assert_eq!(asked(HERE, "mean = true", rides), None);
    }
}

#[test]
fn the_same_ride_of_everybody_is_in_the_same_world_and_nothing_is_met_twice() {
    let (by_hand, rides) = worlds("", "P001", 0);
    let (other_by_hand, other_rides) = worlds("", "P002", 1);
    assert_ne!(rides[0].0, other_rides[0].0, "another order");
    assert_eq!(seeds(&rides), seeds(&other_rides));
    assert_eq!(by_hand[1], other_by_hand[1], "the drive");
    assert_ne!(by_hand[0], other_by_hand[0], "practice");
    let met: BTreeSet<&String> = by_hand.iter().chain(seeds(&rides)).collect();
    assert_eq!(met.len(), 5);
    // Another study has other worlds.
    let (_, elsewhere) = worlds("seed = 2", "P001", 0);
    assert!(seeds(&rides).iter().all(|seed| !seeds(&elsewhere).contains(seed)));
}

#[test]
fn each_condition_meets_each_world_of_a_ride_equally_often() {
    let rows = (0..williams_rows(3)).map(|row| worlds("", "P001", row).1);
    let mut met: BTreeMap<(String, String), usize> = BTreeMap::new();
    for ride in rows.flatten() {
        *met.entry(ride).or_default() += 1;
    }
    assert_eq!(met.len(), 9);
    assert!(met.values().all(|times| *times == 2));
}

#[test]
fn the_same_world_is_that_of_all_rides_and_not_that_of_the_drive() {
    let (by_hand, rides) = worlds("world = \"same\"", "P001", 0);
    let (other_by_hand, other_rides) = worlds("world = \"same\"", "P002", 1);
    let met: BTreeSet<&String> = seeds(&rides).into_iter().chain(seeds(&other_rides)).collect();
    assert_eq!(met.len(), 1);
    assert_eq!(by_hand[1], other_by_hand[1]);
    assert!(!met.contains(&by_hand[1]));
}

#[test]
fn a_world_of_ones_own_is_by_person_and_condition() {
    let own = "world = \"own\"";
    let (by_hand, rides) = worlds(own, "P001", 0);
    let (other_by_hand, other_rides) = worlds(own, "P002", 0);
    let all = [&by_hand, &other_by_hand].into_iter().flatten();
    let all: BTreeSet<&String> = all.chain(seeds(&rides)).chain(seeds(&other_rides)).collect();
    assert_eq!(all.len(), 10);
    let mut reordered = worlds(own, "P001", 1).1;
    reordered.sort();
    let mut sorted = rides.clone();
    sorted.sort();
    assert_eq!(sorted, reordered, "whatever the order");
}
