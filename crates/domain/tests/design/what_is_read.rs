//! What is read from the file, and what follows where it says nothing.

use super::*;

fn shipped(name: &str) -> String {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../study_data/designs");
    fs::read_to_string(PathBuf::from(folder).join(name)).unwrap()
}

#[test]
fn the_papers_design_is_four_cars_against_a_drive_by_hand() {
    let design = read(&shipped("paper.toml")).unwrap();
    let dials = design.conditions().iter().map(Condition::dial);
    let expected = [Some(0.0), Some(15.0), Some(-15.0), None];
    assert!(dials.eq(expected));
    assert_eq!(design.conditions()[3].car, Some(Car::Across));
    assert_eq!(design.baseline_id(), Some(id("own")));
    assert_eq!(design.contrasts().len(), 6);
    assert_eq!(design.contrasts()[0], [id("mimic"), id("aggressive")]);
    assert_eq!(design.label(id("own")), "Own");
    let sides: Vec<Option<Sign>> = design.conditions().iter().map(Condition::side).collect();
    assert_eq!(sides, [None, Some(Sign::Plus), Some(Sign::Minus), None]);
    // The roles share their ids with conditions: five labels in all.
    assert_eq!((design.roles().len(), design.labels().len()), (2, 5));
    let study = |value: &'static str| move |column: &str| (column == "study").then_some(value);
    let people = design.people();
    assert!(people.learns_from(study("1")) && !people.tests(study("1")));
    assert!(people.tests(study("2")) && !people.learns_from(study("2")));
}

#[test]
fn what_is_left_out_has_its_usual_place() {
    let design = with("").unwrap();
    let files = design.files();
    assert_eq!(files.answers, PathBuf::from("surveys/answers.csv"));
    assert_eq!(files.mapping, Mappings::One("mapping.toml".into()));
    assert_eq!((files.software, &files.claims), (Software::Table, &None));
    assert_eq!(design.conditions()[0].label, "calm");
    assert!(design.conditions()[0].dial() == Some(-15.0));
    assert!(design.conditions()[0].simulated() && !design.conditions()[1].simulated());
    assert_eq!(design.compare(), &Compare::All);
    // Without `test`, everybody who is not learned from is tested.
    let nobody = |_: &str| None;
    assert!(design.people().tests(nobody) && !design.people().learns_from(nobody));
}

#[test]
fn everything_of_the_page_is_read() {
    let design = with(
        r#"
[[outcome]]
measure = "mean_headway_time_s"
[[outcome]]
scale = "comfort.total"
label = "Comfort"
[[hypothesis]]
says = "Sporty leaves less room"
outcome = "mean_headway_time_s"
contrast = ["sporty", "calm"]
direction = "-"
[[hypothesis]]
says = "Both are as comfortable"
outcome = "comfort.total"
contrast = ["calm", "sporty"]
equivalent = [-0.5, 0.5]
[contrasts]
compare = "against calm"
[[factor]]
column = "population"
[[covariate]]
column = "age"
[homophily]
factors = ["mini_ipip"]
ratings = ["jian_trust.overall"]
[protocol]
steps = ["practice"]
practice = { passes = 2 }
[exclude]
people = { P07 = "withdrew consent" }
drives = { "P03-calm" = "simulator sickness" }
drive_shorter_than_s = 300
straight_lined = true
fewer_conditions_than = 2
[amendments]
"exclude.straight_lined" = "seen after the pilot"
[[files.mapping]]
logs = "logs/rig2"
file = "rig2.toml"
"#,
    )
    .unwrap();
    assert_eq!(design.outcomes()[1].id(), "comfort.total");
    assert_eq!(design.hypotheses()[0].claim, Claim::Direction(Sign::Minus));
    assert_eq!(design.contrasts(), [[id("calm"), id("sporty")]]);
    assert_eq!(design.exclude().fewer_conditions_than, Some(2));
    let (person, drives) = (ParticipantId::new("P07").unwrap(), &design.exclude().drives);
    assert_eq!(design.exclude().person(&person), Some("withdrew consent"));
    assert_eq!(drives.len(), 1);
    assert_eq!(drives[&DriveId::new("P03-calm").unwrap()], "simulator sickness");
    assert_eq!(design.protocol().steps, [ProtocolStep::Practice]);
    assert_eq!(design.protocol().practice.passes, 2);
    assert!(matches!(&design.files().mapping, Mappings::Rigs(rigs) if rigs.len() == 1));
    let columns = |factors: &[Factor]| factors.iter().map(|f| f.name.clone()).collect();
    let covariates = design.covariates().iter().map(|c| c.column.clone()).collect();
    let (factors, covariates): (Vec<_>, Vec<_>) = (columns(design.factors()), covariates);
    assert_eq!((factors, covariates), (vec!["population".into()], vec!["age".into()]));
    assert_eq!(design.homophily().unwrap().factors, ["mini_ipip"]);
    let amended: Vec<&String> = design.amendments().keys().collect();
    assert_eq!(amended, ["exclude.straight_lined"]);
    assert_eq!(design.hypotheses()[1].claim, Claim::Equivalent([-0.5, 0.5]));
}

#[test]
fn a_design_says_of_itself_what_stands_in_it() {
    let text = r##"
[study]
title = "Four cars"
authors = ["A", "B"]
[people]
learn = { study = 1, arm = "x" }
test = { study = 2 }
[model]
file = "lab.maveric"
[style]
score = "calm.total"
label = "Calmness"
range = [1, 7]
points = 2
aggression = "-"
[[condition]]
id = "mean"
car = { mean = true }
color = "#0072B2"
levels = { traffic = "dense" }
expected = { speed = "-" }
[[condition]]
id = "file"
car = { embedding = "e.csv" }
levels = { traffic = "thin" }
[[condition]]
id = "free"
car = { free = true }
levels = { traffic = "thin" }
[baseline]
id = "own"
label = "By hand"
[[role]]
id = "hurried"
label = "In a hurry"
"##;
    let design = read(text).unwrap();
    assert_eq!((design.title(), design.authors().len()), ("Four cars", 2));
    assert!(!design.synthetic());
    assert_eq!(design.people().columns(), ["arm", "study"]);
    let row = |column: &str| Some(if column == "study" { "1" } else { "y" });
    assert!(!design.people().learns_from(row), "one of two columns");
    let style = design.style().unwrap();
    assert_eq!((style.label.as_str(), style.aggression), ("Calmness", Sign::Minus));
    assert_eq!((style.range, style.points), (Some([1.0, 7.0]), Some(2.0)));
    let cars: Vec<&Option<Car>> = design.conditions().iter().map(|c| &c.car).collect();
    let file = Car::Embedding("e.csv".into());
    assert_eq!(cars, [&Some(Car::Mean), &Some(file), &Some(Car::Free)]);
    let simulated = design.conditions().iter().map(Condition::simulated);
    assert!(simulated.eq([true, true, false]));
    let mean = design.condition(id("mean")).unwrap();
    assert_eq!(mean.color.unwrap().to_string(), "#0072b2");
    assert_eq!(mean.expected["speed"], Sign::Minus);
    assert_eq!((mean.place, design.conditions()[2].place), (0, 2));
    assert!(design.needs_a_model() && design.has_a_dial() && design.model().is_some());
    assert!(design.knows(id("hurried")) && design.knows(id("own")) && !design.knows(id("x")));
    let labels = ["own", "hurried", "mean", "x"].map(|label| design.label(id(label)));
    assert_eq!(labels, ["By hand", "In a hurry", "mean", "x"]);
    let bare = read("[study]\ntitle = \"x\"\n[[condition]]\nid = \"a\"").unwrap();
    assert!(!bare.needs_a_model() && !bare.has_a_dial());
    assert!(bare.people().columns().is_empty() && bare.baseline().is_none());
}

#[test]
fn signs_multiply_colours_have_six_digits_and_a_score_has_two_names() {
    use Sign::{Minus, Plus};
    for (a, b) in [(Plus, Plus), (Plus, Minus), (Minus, Plus), (Minus, Minus)] {
        let product = a.factor() * b.factor();
        assert_eq!(Sign::of(product), Some(a * b));
    }
    assert_eq!((Plus.factor(), Minus.factor()), (1.0, -1.0));
    assert_eq!((Sign::of(0.0), Sign::of(f64::NAN)), (None, None));
    assert_eq!("#0a0B10".parse(), Ok(Color([10, 11, 16])));
    for text in ["0a0b10", "#0a0b1", "#0a0b100", "#0a0b1g", "#é0b1"] {
        assert_eq!(text.parse::<Color>(), Err(()), "{text}");
    }
    assert_eq!("adb.total".parse::<ScoreName>().unwrap().to_string(), "adb.total");
    for text in ["adb", ".", "adb.", ".total", "adb.total.x"] {
        assert!(text.parse::<ScoreName>().is_err(), "{text}");
    }
}

#[test]
fn a_study_of_roles_alone_has_their_scores_and_which_repeats_which() {
    let text = "[study]\ntitle = \"x\"\n[style]\nscore = \"adb.total\"\nrange = [11, 55]\n\
                [[role]]\nid = \"own\"\nscore = 30\n[[role]]\nid = \"again\"\nrepeats = \"own\"\n";
    let design = Design::from_toml(text).unwrap();
    let role = |id: &str| design.role(id.parse().unwrap());
    assert_eq!(role("again").map(|r| r.id.as_str()), Some("own"));
    assert_eq!(role("again").and_then(|r| r.score), Some(30.0));
    assert!(role("other").is_none() && design.contrasts().is_empty());
    let error = read(&text.replace("30", "60")).unwrap_err();
    assert!(error.contains("within the range of `[style]`"), "{error}");
    let error =
        read(&text.replace("[style]\nscore = \"adb.total\"\nrange = [11, 55]\n", "")).unwrap_err();
    assert!(error.contains("`role.score`"), "{error}");
}
