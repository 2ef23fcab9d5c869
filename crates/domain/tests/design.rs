//! A study's file: what is read from it, and what is refused and how.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use maveric_domain::{
    ConditionId, Design, DriveId, ParticipantId,
    design::{
        Car, Claim, Color, Compare, Condition, DeclaredTest, Donors, Factor, Mappings, Matched,
        ProtocolStep, ScoreName, Sign, Software,
    },
};
use serde_json::Value;
use std::{collections::BTreeSet, fs, path::PathBuf};

fn shipped(name: &str) -> String {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../study_data/designs");
    fs::read_to_string(PathBuf::from(folder).join(name)).unwrap()
}

fn id(text: &str) -> ConditionId {
    text.parse().unwrap()
}

const SMALL: &str = r#"
[study]
title = "Calm, normal, sporty"
[people]
learn = { study = 1 }
[style]
score = "adb.total"
points = 15
[[condition]]
id = "calm"
car = { dial = "-1" }
[[condition]]
id = "sporty"
label = "Sporty"
car = { dial = 7.5, recorded = true }
"#;

fn read(text: &str) -> Result<Design, String> {
    Design::from_toml(text).map_err(|e| match e.suggestion() {
        Some(hint) => format!("{e}; {hint}"),
        None => e.to_string(),
    })
}

/// The small design with more lines.
fn with(more: &str) -> Result<Design, String> {
    read(&format!("{SMALL}{more}"))
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
    let why = |drive: &str, person: &str| {
        let (drive, person) = (DriveId::new(drive), ParticipantId::new(person));
        let why = design.exclude().drive(&drive.unwrap(), &person.unwrap());
        why.map(str::to_owned)
    };
    assert_eq!(why("P07-calm", "P07").unwrap(), "withdrew consent");
    assert_eq!(why("P03-calm", "P03").unwrap(), "simulator sickness");
    assert_eq!(why("P03-sporty", "P03"), None);
    assert_eq!(design.protocol().steps, [ProtocolStep::Practice]);
    assert_eq!(design.protocol().practice.passes, 2);
    assert!(matches!(&design.files().mapping, Mappings::Rigs(rigs) if rigs.len() == 1));
    let columns = |factors: &[Factor]| factors.iter().map(|f| f.name.clone()).collect();
    let covariates = design
        .covariates()
        .iter()
        .map(|c| c.column.clone())
        .collect();
    let (factors, covariates): (Vec<_>, Vec<_>) = (columns(design.factors()), covariates);
    assert_eq!(
        (factors, covariates),
        (vec!["population".into()], vec!["age".into()])
    );
    assert_eq!(design.homophily().unwrap().factors, ["mini_ipip"]);
    let amended: Vec<&String> = design.amendments().keys().collect();
    assert_eq!(amended, ["exclude.straight_lined"]);
    assert_eq!(design.hypotheses()[1].claim, Claim::Equivalent([-0.5, 0.5]));
    assert!(!design.exclude().is_empty());
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
    assert!(!design.synthetic() && design.clone().made_up().synthetic());
    assert_eq!(design.people().columns(), ["arm", "study"]);
    let row = |column: &str| Some(if column == "study" { "1" } else { "y" });
    assert!(!design.people().learns_from(row), "one of two columns");
    let style = design.style().unwrap();
    assert_eq!(
        (style.label.as_str(), style.aggression),
        ("Calmness", Sign::Minus)
    );
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
    assert!(!bare.needs_a_model() && !bare.has_a_dial() && bare.exclude().is_empty());
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
    assert_eq!(
        "adb.total".parse::<ScoreName>().unwrap().to_string(),
        "adb.total"
    );
    for text in ["adb", ".", "adb.", ".total", "adb.total.x"] {
        assert!(text.parse::<ScoreName>().is_err(), "{text}");
    }
}

#[test]
fn every_length_and_angle_of_the_protocol_ends_where_it_says() {
    let of = |key: &str, value: f64| {
        let value = format!("{value:?}").to_lowercase();
        match key.rsplit_once('.') {
            Some((table, key)) => with(&format!("[protocol.{table}]\n{key} = {value}")),
            None => with(&format!("[protocol]\n{key} = {value}")),
        }
    };
    for (key, low, high) in [
        ("drive_s", 10.0, 7200.0),
        ("ride_s", 10.0, 7200.0),
        ("practice.at_most_s", 30.0, 7200.0),
        ("practice.lane_kept_s", 0.0, 300.0),
        ("view.eye_m", 0.5, 4.0),
        ("view.field_deg", 10.0, 100.0),
        ("view.side_deg", 0.0, 90.0),
    ] {
        assert!(of(key, low).is_ok() && of(key, high).is_ok(), "{key}");
        for beyond in [low - 0.1, high + 0.1, f64::NAN] {
            let text = of(key, beyond).unwrap_err();
            assert!(text.contains("`protocol."), "{key} {beyond}: {text}");
        }
    }
    let screens = |n: u32| with(&format!("[protocol.view]\nscreens = {n}"));
    assert!(screens(1).is_ok() && screens(3).is_ok());
    assert!(screens(2).unwrap_err().contains("1 or 3"));
    let steps = |steps: &str| with(&format!("[protocol]\nsteps = {steps}"));
    assert!(steps("[\"drive\", \"rides\"]").is_ok());
    assert!(steps("[\"rides\"]").is_err());
}

#[test]
fn fifty_conditions_are_a_study_and_one_more_is_none() {
    let study = |n: usize| {
        let conditions = (0..n).map(|i| format!("[[condition]]\nid = \"c{i}\"\n"));
        read(&format!(
            "[study]\ntitle = \"x\"\n{}",
            conditions.collect::<String>()
        ))
    };
    assert_eq!(study(50).unwrap().contrasts().len(), 1225);
    assert!(study(51).unwrap_err().contains("at most 50"));
}

#[test]
fn a_fault_is_named_with_its_key_and_what_would_be_possible() {
    for (more, said) in [
        (
            "[contrast]\ncompare = \"all\"",
            "line 16: unknown field `contrast`",
        ),
        ("[contrast]\ncompare = \"all\"", "did you mean `contrasts`?"),
        (
            "[exclude]\nstraightlined = true",
            "did you mean `straight_lined`?",
        ),
        (
            "[[condition]]\nid = \"calm\"",
            "`condition.id`: found `calm` twice",
        ),
        (
            "[[condition]]\nid = \"so calm\"",
            "line 17: condition `so calm` must be",
        ),
        (
            "[[condition]]\nid = \"x\"\ncar = { dial = 1, mean = true }",
            "`condition.x.car`: found `dial` and `mean`",
        ),
        (
            "[[condition]]\nid = \"x\"\ncar = { dial = \"far\" }",
            "number of steps",
        ),
        (
            "[[condition]]\nid = \"x\"\ncar = { dial = true }",
            "points, such as -15",
        ),
        ("[[condition]]\nid = \"x\"\ncar = {}", "found no car"),
        (
            "[[condition]]\nid = \"x\"\nlevels = { traffic = \"dense\" }",
            "`condition.x.levels`: found traffic, expected no factor, as in `calm`",
        ),
        ("[[condition]]\nid = \"x\"\ncolor = \"blue\"", "#rrggbb"),
        (
            "[contrasts]\ncompare = \"against calmm\"",
            "found `calmm`, expected one of `calm`, `sporty`; did you mean `calm`?",
        ),
        (
            "[contrasts]\ncompare = [[\"calm\", \"spotry\"]]",
            "did you mean `sporty`?",
        ),
        (
            "[contrasts]\ncompare = [[\"calm\", \"sporty\"], [\"sporty\", \"calm\"]]",
            "twice",
        ),
        (
            "[protocol]\nsteps = [\"rides\", \"drive\"]",
            "`protocol.steps`: found rides without a drive before them",
        ),
        (
            "[protocol]\nsteps = [\"drive\", \"drive\"]",
            "found drive twice, expected each once",
        ),
        (
            "[protocol]\nride_s = 1",
            "`protocol.ride_s`: found 1, expected 10 to 7200 s",
        ),
        (
            "[protocol]\nconsnet = \"consent.md\"",
            "did you mean `consent`?",
        ),
        ("[contrasts]\ncompare = \"some\"", "\"against ID\""),
        (
            "[[outcome]]\nmeasure = \"a\"\nscale = \"b.c\"",
            "one of them",
        ),
        (
            "[[outcome]]\nscale = \"comfort\"",
            "expected SCALE.SUBSCALE",
        ),
        (
            "[[outcome]]\nmeasure = \"speed\"\n[[hypothesis]]\nsays = \"x\"\noutcome = \"sped\"\ncontrast = [\"calm\", \"sporty\"]\ndirection = \"+\"",
            "`hypothesis[1].outcome`: found `sped`, expected `speed`; did you mean `speed`?",
        ),
        (
            "[[hypothesis]]\nsays = \"x\"\noutcome = \"speed\"\ncontrast = [\"calm\", \"own\"]\ndirection = \"+\"",
            "`hypothesis[1].contrast`: found `own`",
        ),
        (
            "[[hypothesis]]\nsays = \"x\"\noutcome = \"speed\"\ncontrast = [\"calm\", \"sporty\"]",
            "neither `direction` nor `equivalent`",
        ),
        (
            "[contrasts]\ncompare = [[\"calm\", \"calm\"]]",
            "`calm` with itself",
        ),
        (
            "[contrasts]\ncompare = \"against calm\"\n[[condition]]\nid = \"x\"\n[[hypothesis]]\nsays = \"x\"\noutcome = \"speed\"\ncontrast = [\"x\", \"sporty\"]\ndirection = \"+\"",
            "a pair that `[contrasts]` compares: calm and sporty; calm and x",
        ),
        (
            "[[hypothesis]]\nsays = \"x\"\noutcome = \"speed\"\ncontrast = [\"calm\", \"sporty\"]\ndirection = \"+\"\nequivalent = [0, 1]",
            "both `direction` and `equivalent`",
        ),
        (
            "[[hypothesis]]\nsays = \"x\"\noutcome = \"speed\"\ncontrast = [\"calm\", \"sporty\"]\nequivalent = [1, 1]",
            "`hypothesis[1].equivalent`",
        ),
        (
            "[[outcome]]\nmeasure = \"speed\"\nsame_within = 0",
            "`outcome.same_within`",
        ),
        (
            "[[outcome]]\nmeasure = \"speed\"\n[[outcome]]\nmeasure = \"speed\"",
            "`outcome`: found `speed` twice",
        ),
        (
            "[[outcome]]\nlabel = \"x\"",
            "neither `measure` nor `scale`",
        ),
        ("[exclude]\ndrive_shorter_than_s = 0", "seconds above 0"),
        ("[exclude]\ndrives = { d = \" \" }", "`exclude: d`"),
        ("[exclude]\npeople = { P07 = \"\" }", "expected the reason"),
        ("[exclude]\ndrive_shorter_than_s = -1", "seconds above 0"),
        (
            "[baseline]\nid = \"own\"\n[[role]]\nid = \"own\"",
            "the baseline's",
        ),
        (
            "[[role]]\nid = \"fast\"\nscore = inf",
            "`role.score`: found inf of `fast`",
        ),
        (
            "[[role]]\nid = \"fast\"\nrepeats = \"fast\"",
            "`role.repeats`: found `fast` of `fast`",
        ),
        (
            "[[role]]\nid = \"a\"\n[[role]]\nid = \"b\"\nrepeats = \"a\"\nscore = 20",
            "it has that of the role it repeats",
        ),
        (
            "[[role]]\nid = \"a\"\n[[role]]\nid = \"b\"\nrepeats = \"a\"\n[[role]]\nid = \"c\"\nrepeats = \"b\"",
            "another role that repeats none itself",
        ),
    ] {
        let error = with(more).unwrap_err();
        assert!(error.contains(said), "{more}\n{error}\nhas no: {said}");
    }
}

#[test]
fn a_dial_needs_a_style_and_a_learned_car_somebody_to_learn_from() {
    let no_style = SMALL.replace("[style]\nscore = \"adb.total\"\npoints = 15\n", "");
    let error = read(&no_style).unwrap_err();
    let said = "`condition.calm.car`: found a place on the dial, and no `[style]`";
    assert!(error.contains(said), "{error}");
    for car in ["across", "free"] {
        let text = no_style.replace("dial = \"-1\"", &format!("{car} = true"));
        let error = read(&text).unwrap_err();
        assert!(error.contains(said), "{car}: {error}");
    }
    let nobody = SMALL.replace("learn = { study = 1 }", "");
    let error = read(&nobody).unwrap_err();
    assert!(error.contains("people to learn from"), "{error}");
    let elsewhere = format!("{nobody}[model]\nfile = \"lab.maveric\"\n");
    assert!(read(&elsewhere).is_ok());
    let no_step = SMALL.replace("points = 15", "range = [11, 66]");
    let error = read(&no_step).unwrap_err();
    assert!(error.contains("points of a step"), "{error}");
    // The dial reaches from one end of the score to the other, no further, and its steps are above 0.
    let within = |to: &str| read(&SMALL.replace("points = 15", to));
    assert!(within("points = 7.5\nrange = [1, 8.5]").is_ok());
    assert!(within("points = 0").unwrap_err().contains("`style.points`"));
    assert!(
        within("points = 1\nrange = [6, 6]")
            .unwrap_err()
            .contains("`style.range`")
    );
    let narrow = SMALL.replace("points = 15", "points = 1\nrange = [1, 6]");
    let error = read(&narrow).unwrap_err();
    let said = "`condition.sporty.car.dial`: found 7.5, expected at most 5";
    assert!(error.contains(said), "{error}");
    let reversed = SMALL.replace("points = 15", "points = 1\nrange = [6, 1]");
    let error = read(&reversed).unwrap_err();
    assert!(error.contains("`style.range`"), "{error}");
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

#[test]
fn a_car_varies_as_its_person_does_only_where_the_program_drives_that_person() {
    let with = |car: &str| {
        let head = "[study]\ntitle = \"t\"\n[people]\nlearn = { part = \"l\" }\n[style]\nscore = \"adb.total\"\n";
        let text = format!(
            "{head}[[condition]]\nid = \"a\"\ncar = {{ {car} }}\n[[condition]]\nid = \"b\"\n"
        );
        Design::from_toml(&text).map_err(|e| e.to_string())
    };
    let varies = |car: &str| with(car).unwrap().conditions()[0].vary;
    assert!(varies("dial = 0, vary = true") && varies("across = true, vary = true"));
    assert!(!varies("dial = 0"));
    for car in ["mean = true", "free = true", "dial = 0, recorded = true"] {
        let error = with(&format!("{car}, vary = true")).unwrap_err();
        assert!(error.contains("`condition.a.car.vary`"), "{error}");
    }
}

#[test]
fn a_study_without_conditions_or_title_is_none() {
    for (text, said) in [
        (
            "[study]\ntitle = \"x\"".to_owned(),
            "at least one [[condition]]",
        ),
        (
            "[[condition]]\nid = \"x\"".to_owned(),
            "missing field `study`",
        ),
        (SMALL.replace("Calm, normal, sporty", " "), "study.title"),
        ("[study".to_owned(), "line 1: "),
    ] {
        let error = read(&text).unwrap_err();
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn a_covariate_is_multiplied_by_an_effect_within_people_alone() {
    let covariate = |with: &str| format!("[[covariate]]\ncolumn = \"age\"\nwith = [\"{with}\"]\n");
    let design = with(&covariate("condition")).unwrap();
    assert_eq!(design.covariates()[0].with, ["condition"]);
    let error = with(&covariate("conditon")).unwrap_err();
    assert!(
        error.contains("`conditon` of `age`") && error.contains("did you mean `condition`"),
        "{error}"
    );
    let level = |id: &str, speed: &str, light: &str| {
        format!(
            "[[condition]]\nid = \"{id}\"\nlevels = {{ speed = \"{speed}\", light = \"{light}\" }}\n"
        )
    };
    let crossed = "[study]\ntitle = \"x\"\n".to_owned()
        + &level("a", "low", "day")
        + &level("b", "low", "night")
        + &level("c", "high", "day")
        + &level("d", "high", "night");
    for name in ["speed", "light", "light:speed"] {
        assert!(
            read(&(crossed.clone() + &covariate(name))).is_ok(),
            "{name}"
        );
    }
    let error = read(&(crossed + &covariate("condition"))).unwrap_err();
    assert!(error.contains("`light`, `speed`, `light:speed`"), "{error}");
    assert!(with("[[factor]]\ncolumn = \"city\"\nwith = [\"condition\"]\n").is_err());
}

/// The keys that the reader knows of a table: it lists them when it meets another.
fn known(table: &str) -> BTreeSet<String> {
    let error = Design::from_toml(table).unwrap_err().to_string();
    assert!(error.contains("unknown field `zzz`"), "{error}");
    let words = error.split('`').skip(1).step_by(2).skip(1);
    words.map(str::to_owned).collect()
}

#[test]
fn the_schema_for_editors_has_the_keys_of_the_reader() {
    let schema: Value = serde_json::from_str(&shipped("schema.json")).unwrap();
    let keys = |at: &str| -> BTreeSet<String> {
        let found = schema.pointer(at).and_then(Value::as_object);
        found.unwrap().keys().cloned().collect()
    };
    for (table, at) in [
        ("zzz = 1", ""),
        ("[study]\nzzz = 1", "/study"),
        ("[files]\nzzz = 1", "/files"),
        ("[people]\nzzz = 1", "/people"),
        ("[model]\nzzz = 1", "/model"),
        ("[style]\nzzz = 1", "/style"),
        ("[[condition]]\nzzz = 1", "/condition/items"),
        (
            "[[condition]]\ncar = { zzz = 1 }",
            "/condition/items/properties/car",
        ),
        ("[baseline]\nzzz = 1", "/baseline"),
        ("[[role]]\nzzz = 1", "/role/items"),
        ("[[measure]]\nzzz = 1", "/measure/items"),
        ("[[outcome]]\nzzz = 1", "/outcome/items"),
        ("[[hypothesis]]\nzzz = 1", "/hypothesis/items"),
        ("[contrasts]\nzzz = 1", "/contrasts"),
        ("[[factor]]\nzzz = 1", "/factor/items"),
        ("[[covariate]]\nzzz = 1", "/covariate/items"),
        ("[homophily]\nzzz = 1", "/homophily"),
        ("[exclude]\nzzz = 1", "/exclude"),
        ("[protocol]\nzzz = 1", "/protocol"),
        ("[protocol.view]\nzzz = 1", "/protocol/properties/view"),
        ("[protocol.probe]\nzzz = 1", "/protocol/properties/probe"),
        (
            "[protocol.practice]\nzzz = 1",
            "/protocol/properties/practice",
        ),
    ] {
        let at = if at.is_empty() {
            "/properties".to_owned()
        } else {
            format!("/properties{at}/properties")
        };
        assert_eq!(known(table), keys(&at), "{at}");
    }
}

#[test]
fn labels_are_given_once_factors_have_levels_and_a_car_is_of_one_kind() {
    let two = |first: &str, second: &str| {
        let head = "[study]\ntitle = \"t\"\n[people]\nlearn = { part = \"l\" }\n[style]\nscore = \"adb.total\"\n";
        let text = format!("{head}[[condition]]\nid = \"a\"\n{first}\n[[condition]]\n{second}\n");
        Design::from_toml(&text).map_err(|e| e.to_string())
    };
    assert!(two("", "id = \"b\"").is_ok());
    let matched = |more: &str| {
        let design = two(
            &format!("car = {{ other = \"matched\"{more} }}"),
            "id = \"b\"",
        );
        design.unwrap().conditions()[0].car.clone().unwrap()
    };
    let lent = |from, apart_sd| Car::Matched(Matched { from, apart_sd });
    assert_eq!(matched(""), lent(Donors::Tested, [0.7, 2.5]));
    let learned = ", from = \"learned\", apart = [1, 3]";
    assert_eq!(matched(learned), lent(Donors::Learned, [1.0, 3.0]));
    // The word for before the drives is as good an id as any.
    assert!(two("", "id = \"pre\"").is_ok());
    for (first, second, expected) in [
        (
            "label = \"Calm\"",
            "id = \"b\"\nlabel = \"Calm\"",
            "`Calm` twice",
        ),
        (
            "levels = { pace = \"slow\" }",
            "id = \"b\"\nlevels = { pace = \"slow\" }",
            "`slow` in every condition",
        ),
        (
            "car = { dial = 1, across = true }",
            "id = \"b\"",
            "`dial` and `across`",
        ),
        (
            "car = { other = \"matched\", mean = true }",
            "id = \"b\"",
            "`mean` and `other`",
        ),
        (
            "car = { dial = 0, apart = [1, 2] }",
            "id = \"b\"",
            "`condition.a.car.apart`: found a car that has nobody else's style",
        ),
        (
            "car = { other = \"matched\", apart = [2.5, 0.7] }",
            "id = \"b\"",
            "found [2.5, 0.7]",
        ),
        (
            "car = { other = \"alike\" }",
            "id = \"b\"",
            "unknown variant `alike`",
        ),
    ] {
        let refused = two(first, second).unwrap_err();
        assert!(refused.contains(expected), "{refused}");
    }
}

#[test]
fn a_measure_of_the_studys_own_has_a_unit_a_name_and_perhaps_a_direction() {
    let design = with(
        "[[measure]]\nid = \"tor_s\"\ntitle = \"Take-over time\"\nunit = \"s\"\naggression = \"-\"\n\
         [[measure]]\nid = \"glances\"\nunit = \"1\"\naggression = \"none\"\n",
    )
    .unwrap();
    let measures = design.measures();
    assert_eq!(measures.len(), 2);
    let (time, glances) = (&measures[0], &measures[1]);
    assert_eq!((&*time.title, time.shown_unit()), ("Take-over time", "s"));
    assert_eq!(time.aggression, Some(Sign::Minus));
    assert_eq!((&*glances.title, glances.shown_unit()), ("glances", ""));
    assert_eq!(glances.aggression, None);
    assert_eq!(design.measure("tor_s"), Some(time));
    assert!(design.measure("tor").is_none());
    let refused = |more: &str| with(&format!("[[measure]]\n{more}")).unwrap_err();
    for (more, said) in [
        ("id = \"tor\"", "`measure.tor.unit`: found nothing"),
        (
            "id = \"tor\"\nunit = \" \"",
            "`measure.tor.unit`: found nothing",
        ),
        ("id = \"a.b\"\nunit = \"s\"", "`measure.id`: found `a.b`"),
        (
            "id = \"trial\"\nunit = \"s\"",
            "`measure.id`: found `trial`",
        ),
        (
            "id = \"a\"\nunit = \"s\"\n[[measure]]\nid = \"a\"\nunit = \"m\"",
            "`a` twice",
        ),
        (
            "id = \"a\"\nunit = \"s\"\naggression = \"up\"",
            "unknown variant `up`",
        ),
    ] {
        let error = refused(more);
        assert!(error.contains(said), "{error}");
    }
}

const CROSSED: &str = "[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"\nlevels = { style = \"sporty\", road = \"town\" }\n\
    [[condition]]\nid = \"b\"\nlevels = { style = \"sporty\", road = \"land\" }\n[[condition]]\nid = \"c\"\nlevels = { style = \"calm\", road = \"town\" }\n\
    [[condition]]\nid = \"d\"\nlevels = { style = \"calm\", road = \"land\" }\n";

#[test]
fn factors_and_levels_are_called_by_their_labels_and_stand_in_the_order_of_the_conditions() {
    let labels = "[[factor]]\nwithin = \"style\"\nlabel = \"Driving style\"\nlevels = { calm = \"Calm\" }\n\
        [[factor]]\ncolumn = \"group\"\n[[covariate]]\ncolumn = \"age\"\nlabel = \"Age\"\n";
    let design = Design::from_toml(&format!("{CROSSED}{labels}")).unwrap();
    let within = design.factors_within();
    let levels = |factor: &str| {
        within
            .iter()
            .find(|(name, _)| name == factor)
            .unwrap()
            .1
            .clone()
    };
    assert_eq!(levels("style"), ["sporty", "calm"]);
    assert_eq!(levels("road"), ["town", "land"]);
    let label = |name| design.factor_label(name);
    assert_eq!(
        [label("style"), label("group"), label("age")],
        ["Driving style", "group", "Age"]
    );
    let level = |level| design.level_label("style", level);
    assert_eq!([level("calm"), level("sporty")], ["Calm", "sporty"]);
    // A label of a factor within people makes no group of people.
    assert_eq!(design.factors().len(), 1);
    let plain = Design::from_toml(
        "[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"\nlabel = \"First\"\n[[condition]]\nid = \"b\"\n",
    );
    let plain = plain.unwrap();
    assert_eq!(plain.factors_within()[0].0, "condition");
    assert_eq!(plain.level_label("condition", "a"), "First");
}

#[test]
fn a_contrast_of_levels_names_what_is_there_and_holds_at_least_one_pair() {
    let with = |contrast: &str| {
        let text = format!(
            "{CROSSED}[[factor]]\ncolumn = \"group\"\n[contrasts]\nfactors = [{contrast}]\n"
        );
        Design::from_toml(&text)
    };
    let sound = "{ style = [\"calm\", \"sporty\"], group = [\"x\", \"y\"], road = \"town\" }";
    assert_eq!(with(sound).unwrap().level_contrasts().len(), 1);
    for (contrast, words) in [
        ("{ road = \"town\" }", "no pair of levels"),
        ("{ style = [\"calm\", \"calm\"] }", "`calm` with itself"),
        (
            "{ style = [\"calm\", \"brisk\"] }",
            "one of `sporty`, `calm`",
        ),
        ("{ colour = [\"red\", \"blue\"] }", "`group`"),
        (&format!("{sound}, {sound}"), "stands above"),
    ] {
        let refused = with(contrast).unwrap_err().to_string();
        assert!(refused.contains(words), "{contrast}: {refused}");
    }
    for (factor, words) in [
        ("label = \"x\"", "neither `column` nor `within`"),
        (
            "column = \"a\"\nwithin = \"road\"",
            "both `column` and `within`",
        ),
        ("within = \"rode\"", "did you mean `road`?"),
    ] {
        let refused = Design::from_toml(&format!("{CROSSED}[[factor]]\n{factor}\n"));
        let refused = refused.unwrap_err();
        let said = format!("{refused} {}", refused.suggestion().unwrap_or_default());
        assert!(said.contains(words), "{factor}: {said}");
    }
}

#[test]
fn a_primary_outcome_declares_its_test_and_one_contrast_and_is_refused_without() {
    let outcome = |more: &str| {
        with(&format!(
            "[[outcome]]\nmeasure = \"mean_velocity_mps\"\n{more}\n"
        ))
    };
    let design = outcome("primary = true\ntest = \"mixed\"\ncontrast = [\"sporty\", \"calm\"]");
    let declared = &design.unwrap().outcomes()[0].clone();
    assert_eq!(declared.test, Some(DeclaredTest::Mixed));
    assert_eq!(declared.primary, Some([id("sporty"), id("calm")]));
    for (more, key, said) in [
        (
            "primary = true\ntest = \"auto\"\ncontrast = [\"sporty\", \"calm\"]",
            "outcome[1].test",
            "`auto` of a primary outcome",
        ),
        (
            "primary = true\ncontrast = [\"sporty\", \"calm\"]",
            "outcome[1].test",
            "none of a primary outcome",
        ),
        (
            "primary = true\ntest = \"mixed\"",
            "outcome[1].contrast",
            "none of a primary outcome",
        ),
        (
            "primary = true\ntest = \"mixed\"\ncontrast = [\"sporty\", \"clam\"]",
            "outcome[1].contrast",
            "`clam`",
        ),
        (
            "primary = true\ntest = \"mixed\"\ncontrast = [\"calm\", \"calm\"]",
            "outcome[1].contrast",
            "a pair that `[contrasts]` compares",
        ),
        (
            "test = \"mixed\"\ncontrast = [\"sporty\", \"calm\"]",
            "outcome[1].contrast",
            "not primary",
        ),
        ("test = \"anova\"", "", "rm-anova"),
    ] {
        let refused = outcome(more).unwrap_err();
        assert!(
            refused.contains(key) && refused.contains(said),
            "{more}: {refused}"
        );
    }
    // Others may leave the test to what the data look like, or to the design.
    for (more, test) in [("test = \"auto\"", Some(DeclaredTest::Auto)), ("", None)] {
        assert_eq!(outcome(more).unwrap().outcomes()[0].test, test);
    }
}
