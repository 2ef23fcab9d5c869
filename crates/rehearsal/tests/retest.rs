//! The shipped populations are as much alike from one drive to the next as their files say.

#[path = "../examples/made_up/mod.rs"]
mod made_up;

use made_up::{again, cohort, driven};
use maveric_rehearsal::validation::{Values, retest, values};
use maveric_simulator::{People, Scenario};

/// Other people than those whom the files were fitted to.
const SEED: u64 = 12;
const PEOPLE: usize = 120;

#[test]
fn two_drives_agree_as_far_as_the_file_says_in_speed_and_headway_time() {
    let scenario = Scenario::paper();
    let planned = cohort(0, PEOPLE, SEED).unwrap().drives;
    let next = again(&planned).unwrap();
    let mut before = 0.0;
    for (asked, text) in [
        (0.5, maveric_data::POPULATION_RETEST_05),
        (0.7, maveric_data::POPULATION_RETEST_07),
        (0.9, maveric_data::POPULATION_RETEST_09),
    ] {
        let people: People = toml::from_str(text).unwrap();
        let measure = |planned: &[_]| -> Vec<Values> {
            driven(planned, &people, &scenario, SEED, |drive| values(&drive)).unwrap()
        };
        let found = retest(&measure(&planned), &measure(&next));
        for row in &found[..2] {
            let (low, high) = row.interval.unwrap();
            assert!(low < asked && asked < high, "{asked}: {row:?}");
        }
        let speed = found[0].icc.unwrap();
        assert!(speed > before + 0.1, "{asked}: {speed} after {before}");
        before = speed;
    }
}
