use super::*;
use crate::{
    heads_kind::HeadsKind,
    params::TrainSettings,
    test_drives::{Habits, drive_apart, drivers_apart},
    train::tests::trained,
};
use maveric_domain::ScoreRange;

/// Linear heads of twelve drivers.
pub(crate) fn linear_model() -> Model {
    let drives = drivers_apart(12, 300.0);
    let settings = TrainSettings { heads: HeadsKind::Linear, ..TrainSettings::default() };
    trained(&drives, &settings)
}

const FAST: Habits = Habits { speed_mps: 33.0, time_gap_s: 1.2, passes: true };

#[test]
fn who_drives_faster_with_shorter_gaps_is_read_as_more_aggressive() {
    let model = linear_model();
    let personalizer = Personalizer::new(&model);
    let of = |habits: &Habits| personalizer.fit(&drive_apart("new", habits, 300.0), None).unwrap();
    let slow = Habits { speed_mps: 27.0, time_gap_s: 2.0, passes: true };
    let (fast, slow) = (of(&FAST), of(&slow));
    assert!(fast.aggression_hat.unwrap() > slow.aggression_hat.unwrap() + 8.0);
    assert!(!fast.used_adb);
    // A longer drive says more.
    let short = personalizer.fit(&drive_apart("new", &FAST, 60.0), None).unwrap();
    let sum = |p: &Personalized| p.standard_error().unwrap().iter().sum::<f64>();
    assert!(sum(&fast) < sum(&short), "{} {}", sum(&fast), sum(&short));
}

#[test]
fn a_score_draws_the_style_its_way_and_makes_it_surer() {
    let model = linear_model();
    let personalizer = Personalizer::new(&model);
    let new = drive_apart("new", &FAST, 120.0);
    let plain = personalizer.fit(&new, None).unwrap();
    let scored = personalizer.fit(&new, Some(ScoreRange::ADB.score(16.0).unwrap())).unwrap();
    assert!(scored.used_adb);
    assert!(scored.aggression_hat.unwrap() < plain.aggression_hat.unwrap());
    let axis = LinearHead::aggression(&model).unwrap();
    let along = |p: &Personalized| p.sd_along(axis.gradient()).unwrap();
    assert!(along(&scored) < along(&plain));
}

#[test]
fn a_drive_that_shows_nothing_leaves_what_is_known_of_everybody_and_a_score_is_read_all_the_same() {
    let model = linear_model();
    let personalizer = Personalizer::new(&model);
    let blank = drive_apart("new", &FAST, 6.0);
    let found = personalizer.fit(&blank, None).unwrap();
    assert_eq!(found.readings, 0);
    assert!(found.embedding.coordinates().iter().all(|w| w.abs() < 1e-12));
    let sds = found.standard_error().unwrap();
    assert!(sds.iter().all(|sd| (sd - 1.0).abs() < 1e-12), "{sds:?}");
    let score = ScoreRange::ADB.score(45.0).unwrap();
    let scored = personalizer.fit(&blank, Some(score)).unwrap();
    assert!(scored.aggression_hat.unwrap() > found.aggression_hat.unwrap());
}
