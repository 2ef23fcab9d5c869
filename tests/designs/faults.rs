//! What is refused, and what `status` says.

use super::*;

#[test]
fn a_fault_of_the_design_names_file_key_value_and_what_would_be_possible() {
    let study = recorded(&["calm", "sporty"]);
    let sound = study.read("mine/study.toml");
    for (from, to, words) in [
        (
            "[contrasts]",
            "[contrast]",
            &["study.toml", "unknown field `contrast`", "did you mean `contrasts`?"][..],
        ),
        (
            "compare = \"all\"",
            "compare = \"against clam\"",
            &["`contrasts.compare`", "`clam`", "did you mean `calm`?"],
        ),
        ("id = \"sporty\"", "id = \"calm\"", &["`condition.id`", "`calm` twice"]),
        (
            "car = { recorded = true }",
            "car = { dial = 1 }",
            &["`condition.calm.car`", "no `[style]`"],
        ),
    ] {
        study.write("mine/study.toml", sound.replacen(from, to, 1));
        study.mine("ingest --out d").failed(1, words);
        study.mine("run").failed(1, words);
        assert!(!study.path("mine/d").exists());
    }
    study.write("mine/study.toml", &sound);
    change(&study, "mine/participants.csv", "P02,", "P01,");
    study.mine("ingest --out d").failed(1, &["participants.csv", "row 2", "each participant once"]);
}

#[test]
fn status_says_who_is_out_and_what_nobody_drove_and_a_design_names_only_what_there_is() {
    let study = recorded(&["calm", "sporty"]);
    let rules = "[exclude]\npeople = { P02 = \"withdrew consent\" }\n";
    change(&study, "mine/study.toml", "[exclude]", rules);
    for who in PEOPLE {
        std::fs::remove_file(study.path(&format!("mine/logs/{who}-sporty.csv"))).unwrap();
    }
    study.mine(TO_THE_NUMBERS).ok();
    let said = study.mine("status").ok().stderr;
    assert!(said.contains("P02 is left out: withdrew consent"), "{said}");
    assert!(
        said.contains("sporty, drive: no log (everybody)") && !said.contains("calm, drive"),
        "{said}"
    );
    let sound = study.read("mine/study.toml");
    for (more, words) in [
        (
            "[[outcome]]\nmeasure = \"mean_velocity\"\n",
            ["`outcome.measure`", "did you mean `mean_velocity_mps`?"],
        ),
        (
            "[[outcome]]\nscale = \"comfort.totl\"\n",
            ["`outcome.scale`", "did you mean `comfort.total`?"],
        ),
        (
            "[[outcome]]\nscale = \"comfort.total\"\ndrop_items = [4]\n",
            ["`outcome[1].drop_items`: found 4", "an item of `comfort.total`: 1, 2, 3"],
        ),
        (
            "[[outcome]]\nscale = \"comfort.total\"\ndrop_items = [1, 2, 3]\n",
            ["every item of `comfort.total`", "so that one is left"],
        ),
        (
            "[homophily]\nfactors = [\"comfrt\"]\nratings = [\"hurry.total\"]\n",
            ["`homophily.factors`", "did you mean `comfort`?"],
        ),
        (
            "[style]\nscore = \"comfort.total\"\nrange = [1, 9]\n",
            ["`style.range`: found [1, 9]", "within 1 to 7"],
        ),
    ] {
        study.write("mine/study.toml", format!("{more}{sound}"));
        study.mine("run").failed(1, &words);
    }
    study.write("mine/study.toml", sound.replace("P02 =", "P20 ="));
    study.mine("run").failed(1, &["study.toml", "`exclude.people`: found `P20`"]);
    let drive = sound.replace("people = { P02 = ", "drives = { P03-clam = ");
    study.write("mine/study.toml", drive);
    let words = ["`exclude.drives`: found `P03-clam`", "did you mean `P03-calm`?"];
    study.mine("run").failed(1, &words);
}

#[test]
fn a_run_says_that_nobody_is_listed_yet_and_shows_its_stages_all_the_same() {
    let study = TempStudy::new();
    let init = "init mine --conditions calm,sporty --style none";
    study.maveric(&argv(init)).ok();
    let words = ["participants.csv: has no row: nobody takes part", "maveric design orders"];
    study.mine("run").failed(1, &words);
    study.mine("run --show").ok();
    study.mine("status").ok();
    study.write("mine/participants.csv", "participant\nP01\nP02\n");
    let needed = study.mine("run").failed(1, &["surveys/answers.csv"]).stderr;
    assert!(!needed.contains("has no row"), "{needed}");
}

#[test]
fn status_says_what_the_seat_lacks_unless_people_drive_elsewhere() {
    let study = TempStudy::new();
    let init = argv("init mine --conditions calm,sporty --style none");
    study.maveric(&init).ok();
    let lacks = "the seat cannot open this study: ";
    let told = |study: &TempStudy| study.mine("status").ok().stderr;
    assert!(!told(&study).contains(lacks));
    change(&study, "mine/study.toml", "# after = [\"jian_trust\"]", "after = [\"mod\"]");
    let line = format!("{lacks}[protocol] asks scale `mod`, and there are ");
    assert!(told(&study).contains(&line), "{}", told(&study));
    let json = study.mine("status --format json").ok();
    let json: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!(json["seat"].as_array().unwrap().len(), 1, "{json}");
    // Logs of another rig: nobody needs the seat.
    study.write("mine/logs/P01-calm.csv", "time,speed\n");
    assert!(!told(&study).contains(lacks));
    std::fs::create_dir(study.path("mine/seat")).unwrap();
    assert!(told(&study).contains(&line));
}

#[test]
fn a_person_whose_part_is_misspelt_is_named_and_one_of_another_part_is_told() {
    let study = recorded(&["calm", "sporty"]);
    let text = study.read("mine/study.toml");
    let people = "[people]\ntest = { part = \"test\" }\n";
    let text = if text.contains("[people]") {
        text.replace("[people]", people)
    } else {
        format!("{people}{text}")
    };
    study.write("mine/study.toml", text);
    let table = |part: &str| format!("participant,part\nP01,test\nP02,{part}\nP03,test\n");
    study.write("mine/participants.csv", table("Test"));
    study
        .mine("status")
        .failed(1, &["participants.csv", "row 2", "`part`", "`Test`", "`test`, as [people]"]);
    study.write("mine/participants.csv", table("pilot"));
    let said = study.mine("status").ok().stderr;
    tells(&said, &["P02: neither learned from nor tested"]);
}

#[test]
fn answers_out_of_range_and_outcomes_that_nobody_answered_are_refused_by_name() {
    let study = recorded(&["calm", "sporty"]);
    let sound = study.read("mine/surveys/answers.csv");
    let first = sound.lines().nth(1).unwrap();
    let (head, _) = first.rsplit_once(',').unwrap();
    study.write("mine/surveys/answers.csv", sound.replacen(first, &format!("{head},9"), 1));
    let ran = study.mine("run score");
    assert_eq!(ran.status, Some(1));
    tells(&ran.stderr, &["P01", "comfort", "9", "1 to 7"]);
    // A questionnaire that is declared and was never asked after a condition.
    study.write("mine/surveys/answers.csv", sound);
    study.write("mine/scales/ease.toml", scale("ease", 1, 1, 5, "mean"));
    let outcome = "[[outcome]]\nscale = \"ease.total\"\n\n[contrasts]";
    change(&study, "mine/study.toml", "[contrasts]", outcome);
    let ran = study.mine("run");
    assert_eq!(ran.status, Some(1));
    let words = "names `ease.total`, which nobody answered after any condition";
    assert!(ran.stderr.contains(words), "{}", ran.stderr);
    assert!(!study.path("mine/results/analysis.json").exists());
}
