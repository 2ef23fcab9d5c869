use super::*;
use crate::{
    population::MeasureModel,
    testing::{design, world},
};
use maveric_participants::Trait;

/// Pearson's r of two lists.
fn r(x: &[f64], y: &[f64]) -> f64 {
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (mx, my) = (mean(x), mean(y));
    let sum = |of: &dyn Fn(usize) -> f64| (0..x.len()).map(of).sum::<f64>();
    let (dx, dy) = (|i: usize| x[i] - mx, |i: usize| y[i] - my);
    sum(&|i| dx(i) * dy(i)) / (sum(&|i| dx(i) * dx(i)) * sum(&|i| dy(i) * dy(i))).sqrt()
}

/// By how much the score of this style goes better with the positions of 200 people that were fitted with it than with the others.
fn gained(style: &str) -> f64 {
    let text =
        include_str!("../../../../study_data/designs/paper.toml").replace("adb.total", style);
    let other = World { design: Design::from_toml(&text).unwrap(), ..world() };
    let data = other.study(200, 7).unwrap().data;
    let name: ScoreName = style.parse().unwrap();
    let people = || data.participants.iter();
    let scores: Vec<f64> = people().map(|p| data.pre(p, &name).unwrap()).collect();
    let [without, with] = [false, true].map(|adb_used| {
        let position = |p| data.embedding(p, adb_used).unwrap().line_position.unwrap();
        r(&scores, &people().map(position).collect::<Vec<f64>>())
    });
    with - without
}

#[test]
fn people_come_again_and_what_is_asked_on_the_way_is_answered_without_changing_their_first_session()
{
    let paper = include_str!("../../../../study_data/designs/paper.toml");
    let repeated = format!(
        "{paper}\n[protocol]\nprobe = {{ scale = \"misc\", every_s = 30 }}\nride_s = 120\nrides_per_condition = 2\nsessions = {{ count = 2, days_between = [2, 14] }}\n"
    );
    let design = Design::from_toml(&repeated).unwrap();
    let misc = Scale::from_toml(maveric_data::scale("misc").unwrap()).unwrap();
    let once = world();
    let bare = World::new(
        design.clone(),
        once.population.clone(),
        once.effects.clone(),
        once.scales.clone(),
        ScoreRange::ADB,
    );
    assert!(matches!(bare, Err(RehearsalError::NoProbeScale { scale }) if scale == "misc"));
    let scales = [once.scales.clone(), vec![misc]].concat();
    let twice =
        World::new(design, once.population.clone(), once.effects.clone(), scales, ScoreRange::ADB)
            .unwrap();
    let (once, twice) = (once.study(40, 3).unwrap().data, twice.study(40, 3).unwrap().data);
    // Four conditions with two rides and a drive by hand, in each of two sessions.
    assert_eq!(twice.measurements().len(), 40 * 2 * (4 * 2 + 1));
    let first = |data: &StudyData| {
        let first = data
            .measurements()
            .iter()
            .filter(|d| d.meta.ride().occasion == maveric_domain::Occasion::FIRST);
        first.cloned().collect::<Vec<_>>()
    };
    assert_eq!(first(&twice), first(&once));
    let name: ScoreName = "misc.sickness".parse().unwrap();
    let mimic: ConditionId = "mimic".parse().unwrap();
    let sick = twice.participants.iter().filter_map(|p| twice.rated(p, mimic, &name));
    // Three probes in each of two rides, evenly among 0 to 10.
    let sick: Vec<f64> = sick.collect();
    let mean = sick.iter().sum::<f64>() / sick.len() as f64;
    assert!(sick.len() == 40 && (mean - 5.0).abs() < 1.0, "{mean}");
    let found = maveric_analysis::analyse(&twice, maveric_analysis::Purpose::Simulation).unwrap();
    let repeats = found.repeats.unwrap();
    assert_eq!((repeats.back, repeats.gone), (40, 0));
    let speed = repeats
        .retest
        .iter()
        .find(|r| r.outcome == "mean_velocity_mps" && r.condition.as_str() == "own");
    assert!(
        speed.unwrap().icc.as_ref().is_some_and(|icc| icc.icc.is_some_and(|r| r > 0.5)),
        "{speed:?}"
    );
}

const VELOCITY: &str = "mean_velocity_mps";

/// The paper's world with another car in its fourth condition.
fn with_car(car: &str) -> Result<World, RehearsalError> {
    let paper = include_str!("../../../../study_data/designs/paper.toml");
    let text = paper.replace("{ across = true }", car);
    with_design(&text)
}

fn with_design(text: &str) -> Result<World, RehearsalError> {
    let design = Design::from_toml(text).unwrap();
    let World { population, effects, scales, .. } = world();
    World::new(design, population, effects, scales, ScoreRange::ADB)
}

/// Its cars drive without an error, and everybody's dial is alike.
fn exact(car: &str) -> World {
    let mut world = with_car(car).unwrap();
    for measure in world.population.measures.values_mut() {
        if let MeasureModel::Drawn(drawn) = measure {
            drawn.error_sd = 0.0;
            (drawn.up.sd, drawn.down.sd) = (0.0, 0.0);
        }
    }
    world
}

fn id(condition: &str) -> ConditionId {
    condition.parse().unwrap()
}

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9, "{found} instead of {expected}");
}

#[test]
fn a_lent_style_has_the_riders_score_and_the_donors_habits() {
    let world = exact("{ other = \"matched\" }");
    let PopulationModel { line, measures, .. } = &world.population;
    let MeasureModel::Drawn(velocity) = &measures[VELOCITY] else {
        panic!("the velocity is drawn");
    };
    let Rehearsed { people, data } = world.study(30, 4).unwrap();
    let mut times = BTreeMap::new();
    for person in &people {
        let row = data.condition(&person.id, id("perpendicular")).unwrap();
        let own = data.condition(&person.id, id("mimic")).unwrap();
        assert_eq!((row.adb_hat, row.moved_points), (own.adb_hat, Some(0.0)));
        let lent = row.lent.as_ref().unwrap();
        let is_donor = |p: &&Participant| format!("{}-own", p.id) == lent.donor.as_str();
        let donor = people.iter().find(is_donor).unwrap();
        assert_ne!(donor.id, person.id);
        *times.entry(donor.id.clone()).or_insert(0) += 1;
        // 8.5 points of the ADB score a standard deviation; a step of the dial is 15.
        let position =
            |p: &Participant| data.embedding(&p.id, true).unwrap().line_position.unwrap();
        let shift = 8.5 * (position(person) - position(donor));
        near(lent.donor_shift_points, shift);
        let step = if shift > 0.0 { velocity.up.step } else { -velocity.down.step };
        let measured = |p: &Participant, c: &str| data.measured(&p.id, id(c), VELOCITY).unwrap();
        near(
            measured(person, "perpendicular"),
            measured(donor, "own") + velocity.sd * (velocity.bias + shift / 15.0 * step),
        );
        // What of both people's traits lies across the line.
        let traits = [Trait::Aggressiveness, Trait::Spacing, Trait::Pace];
        let apart = traits.map(|t| donor.latent(t) - person.latent(t));
        let along = traits.map(|t| line.loadings[&t]);
        let product = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let on_the_line = product(&apart, &along).powi(2) / product(&along, &along);
        let across = product(&apart, &apart) - on_the_line;
        near(lent.donor_distance_sd, across.sqrt());
        let within = shift.abs() <= 8.0 && (0.7..=2.5).contains(&lent.donor_distance_sd);
        assert_eq!(lent.donor_within_reach, within);
    }
    assert!(times.len() > 10, "{times:?}");
    let again = world.study(30, 4).unwrap().data;
    for person in &people {
        let row = |data: &StudyData| data.condition(&person.id, id("perpendicular")).cloned();
        assert_eq!(row(&again), row(&data));
    }
}

#[test]
fn another_style_of_ones_own_score_is_felt_as_unlike_and_without_effects_is_the_own() {
    let world = with_car("{ other = \"matched\" }").unwrap();
    let data = world.study(200, 6).unwrap().data;
    let similarity: ScoreName = "similarity.similarity".parse().unwrap();
    let rated = |condition: &str| {
        let ratings =
            data.participants.iter().filter_map(|p| data.rated(p, id(condition), &similarity));
        let ratings: Vec<f64> = ratings.collect();
        ratings.iter().sum::<f64>() / ratings.len() as f64
    };
    let (own, other) = (rated("mimic"), rated("perpendicular"));
    assert!(own - other > 0.3, "{own} {other}");
    for car in ["{ other = \"matched\" }", "{ mean = true }"] {
        let none = exact(car).scaled(0.0).study(20, 6).unwrap().data;
        for p in &none.participants {
            let measured = |c: &str| none.measured(p, id(c), VELOCITY).unwrap();
            near(measured("perpendicular"), measured("mimic"));
        }
    }
}

#[test]
fn the_average_drivers_car_drives_everybody_alike_and_lies_in_the_middle_of_the_line() {
    let world = exact("{ mean = true }");
    let MeasureModel::Drawn(velocity) = &world.population.measures[VELOCITY] else {
        panic!("the velocity is drawn");
    };
    let data = world.study(20, 4).unwrap().data;
    for p in &data.participants {
        let driven = data.measured(p, id("perpendicular"), VELOCITY).unwrap();
        near(driven, velocity.mean + velocity.sd * velocity.bias);
        let row = data.condition(p, id("perpendicular")).unwrap();
        let own = data.condition(p, id("mimic")).unwrap().adb_hat.unwrap();
        near(row.adb_hat.unwrap(), 28.0);
        near(row.moved_points.unwrap(), 28.0 - own);
        assert_eq!(row.lent, None);
    }
}

#[test]
fn the_dial_of_a_score_of_calmness_makes_the_car_slower() {
    let paper = include_str!("../../../../study_data/designs/paper.toml");
    let score = "score = \"adb.total\"\n";
    let calmness = paper.replace(score, &format!("{score}aggression = \"-\"\n"));
    let faster = |text: &str| {
        let data = with_design(text).unwrap().study(40, 3).unwrap().data;
        let speed = |condition: &str| {
            let people = data.participants.iter();
            let speeds = people.filter_map(|p| data.measured(p, id(condition), VELOCITY));
            speeds.sum::<f64>()
        };
        speed("aggressive") - speed("cautious")
    };
    assert!(faster(paper) > 0.0 && faster(&calmness) < 0.0);
}

#[test]
fn a_step_of_the_dial_and_of_a_loan_is_as_large_a_share_of_a_scale_from_1_to_6_as_of_the_adb() {
    let paper = include_str!("../../../../study_data/designs/paper.toml");
    let on_adb = paper.replace("{ across = true }", "{ other = \"matched\" }");
    let points = 15.0 * 5.0 / 44.0;
    let on_risky = on_adb
        .replace("adb.total", "mdsi.risky")
        .replace("range = [11, 55]", "range = [1, 6]")
        .replace("points = 15", &format!("points = {points}"));
    let made = |text: &str, range: ScoreRange| {
        let World { population, effects, scales, .. } = world();
        let design = Design::from_toml(text).unwrap();
        World::new(design, population, effects, scales, range).unwrap()
    };
    let adb = made(&on_adb, ScoreRange::ADB);
    let risky = made(&on_risky, ScoreRange::new(1.0, 6.0).unwrap());
    near(adb.points, 15.0);
    near(risky.points, points);
    let [adb, risky] = [adb, risky].map(|world| world.study(30, 4).unwrap().data);
    for p in &adb.participants {
        for (condition, steps) in [("aggressive", 1.0), ("cautious", -1.0), ("mimic", 0.0)] {
            let measured = |data: &StudyData| data.measured(p, id(condition), VELOCITY).unwrap();
            near(measured(&risky), measured(&adb));
            let row = risky.condition(p, id(condition)).unwrap();
            near(row.moved_points.unwrap(), steps * points);
        }
        let row = risky.condition(p, id("perpendicular")).unwrap();
        let lent = row.lent.as_ref().unwrap();
        // Two elevenths of 5 points.
        let within = lent.donor_shift_points.abs() <= 10.0 / 11.0
            && (0.7..=2.5).contains(&lent.donor_distance_sd);
        assert_eq!(lent.donor_within_reach, within);
    }
}

#[test]
fn what_cannot_be_made_up_is_refused_with_the_reason() {
    for (car, why) in [
        ("{ free = true }", "how people turn the dial"),
        ("{ embedding = \"styles.csv\" }", "a point of a trained model"),
        ("{ recorded = true }", "was recorded elsewhere"),
    ] {
        let said = with_car(car).unwrap_err().to_string();
        let head = "`condition.perpendicular.car` cannot be rehearsed, since ";
        assert!(said.starts_with(head) && said.contains(why), "{said}");
    }
    let again = "[study]\ntitle = \"Again\"\n[[condition]]\nid = \"again\"\ncar = { replay = \"own\" }\n[protocol]\n\
                     steps = [\"drive\", \"rides\"]\ndrive_s = 120\nride_s = 120\nworld = \"same\"\n";
    let said = with_design(again).unwrap_err().to_string();
    assert!(said.contains("a drive moment by moment"), "{said}");
}

#[test]
fn too_few_donors_and_people_who_differ_along_the_line_alone_are_refused() {
    let matched = with_car("{ other = \"matched\", from = \"learned\" }").unwrap();
    assert!(matches!(
        matched.study(5, 1),
        Err(RehearsalError::FewDonors { people: 5, donors: 4, .. })
    ));
    assert!(matched.enough_donors(5).is_err() && matched.enough_donors(6).is_ok());
    assert!(world().enough_donors(4).is_ok());
    let World { design, mut population, effects, scales, .. } = matched;
    for measure in population.measures.values_mut() {
        if let MeasureModel::Drawn(drawn) = measure {
            drawn.loadings.retain(|name, _| *name == Trait::Aggressiveness);
        }
    }
    population.line.loadings = BTreeMap::from([(Trait::Aggressiveness, 0.8), (Trait::Pace, 0.0)]);
    let refused = World::new(design, population, effects, scales, ScoreRange::ADB).unwrap_err();
    assert!(matches!(refused, RehearsalError::NothingAcross { found: 1, .. }));
}

#[test]
fn people_lie_on_the_line_of_the_design_s_own_score_whatever_it_is() {
    assert_eq!(design().style().unwrap().score.to_string(), "adb.total");
    let (adb, risky) = (gained("adb.total"), gained("mdsi.risky"));
    assert!(adb > 0.1 && risky > 0.1, "{adb} {risky}");
}
