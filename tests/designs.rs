//! Studies that are not the paper's, walked with the program: what a `study.toml` says is what happens.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at the first surprise"
)]

mod support;

use support::own_logs::{
    PEOPLE, TABLE, TO_THE_NUMBERS, change, measured, read, recorded, speed, table,
};
use support::page::Page;

#[test]
fn the_folders_name_or_a_column_may_say_the_condition() {
    let study = recorded(&["calm", "sporty"]);
    for (i, who) in PEOPLE.iter().enumerate() {
        for (place, condition) in ["own", "calm", "sporty"].iter().enumerate() {
            let old = study.path(&format!("mine/logs/{who}-{condition}.csv"));
            std::fs::remove_file(old).unwrap();
            study.write(
                &format!("mine/logs/{condition}/{who}.csv"),
                table(speed(i, place), 30.0, &condition.to_uppercase()),
            );
        }
    }
    let people = "file = \"{who}\"\ndrive = \"{who}-{condition}\"\nparticipant = \"{who}\"\ncondition = \"{condition}\"\n";
    study.write(
        "mine/mapping.toml",
        format!("[names]\nfolder = \"{{condition}}\"\n{people}{TABLE}"),
    );
    study.maveric_in("mine", &["run", "ingest"]).ok();
    let by_folder = measured(&study);
    assert_eq!(by_folder.len(), 12);
    let words = "columns = { condition = \"car\" }\nwords = { OWN = \"own\", CALM = \"calm\", SPORTY = \"sporty\" }\n";
    study.write(
        "mine/mapping.toml",
        format!("[names]\n{words}{people}{TABLE}"),
    );
    study.maveric_in("mine", &["run", "ingest"]).ok();
    // The drives are called by the column's words now; those of before are gone.
    assert_eq!(measured(&study), by_folder);
    assert!(study.path("mine/results/drives/P01-CALM.parquet").exists());
    assert!(!study.path("mine/results/drives/P01-calm.parquet").exists());
}

#[test]
fn a_fault_of_the_design_names_file_key_value_and_what_would_be_possible() {
    let study = recorded(&["calm", "sporty"]);
    let sound = read(&study, "mine/study.toml");
    for (from, to, words) in [
        (
            "[contrasts]",
            "[contrast]",
            &[
                "study.toml",
                "unknown field `contrast`",
                "did you mean `contrasts`?",
            ][..],
        ),
        (
            "compare = \"all\"",
            "compare = \"against clam\"",
            &["`contrasts.compare`", "`clam`", "did you mean `calm`?"],
        ),
        (
            "id = \"sporty\"",
            "id = \"calm\"",
            &["`condition.id`", "`calm` twice"],
        ),
        (
            "car = { recorded = true }",
            "car = { dial = 1 }",
            &["`condition.calm.car`", "no `[style]`"],
        ),
    ] {
        study.write("mine/study.toml", sound.replacen(from, to, 1));
        study
            .maveric_in("mine", &["ingest", "--out", "d"])
            .failed(1, words);
        study.maveric_in("mine", &["run"]).failed(1, words);
        assert!(!study.path("mine/d").exists());
    }
    study.write("mine/study.toml", &sound);
    change(&study, "mine/participants.csv", "P02,", "P01,");
    study
        .maveric_in("mine", &["ingest", "--out", "d"])
        .failed(1, &["participants.csv", "row 2", "each participant once"]);
}

#[test]
fn status_says_who_is_out_and_what_nobody_drove_and_a_design_names_only_what_there_is() {
    let study = recorded(&["calm", "sporty"]);
    let rules = "[exclude]\npeople = { P02 = \"withdrew consent\" }\n";
    change(&study, "mine/study.toml", "[exclude]", rules);
    for who in PEOPLE {
        std::fs::remove_file(study.path(&format!("mine/logs/{who}-sporty.csv"))).unwrap();
    }
    study.maveric_in("mine", &TO_THE_NUMBERS).ok();
    let said = study.maveric_in("mine", &["status"]).ok().stderr;
    assert!(said.contains("P02 is left out: withdrew consent"), "{said}");
    assert!(
        said.contains("condition sporty: nobody drove it") && !said.contains("calm: nobody"),
        "{said}"
    );
    let sound = read(&study, "mine/study.toml");
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
            "[homophily]\nfactors = [\"comfrt\"]\nratings = [\"hurry.total\"]\n",
            ["`homophily.factors`", "did you mean `comfort`?"],
        ),
        (
            "[style]\nscore = \"comfort.total\"\nrange = [1, 9]\n",
            ["`style.range`: found [1, 9]", "within 1 to 7"],
        ),
    ] {
        study.write("mine/study.toml", format!("{more}{sound}"));
        study.maveric_in("mine", &["run"]).failed(1, &words);
    }
    study.write("mine/study.toml", sound.replace("P02 =", "P20 ="));
    study
        .maveric_in("mine", &["run"])
        .failed(1, &["study.toml", "`exclude.people`: found `P20`"]);
    let drive = sound.replace("people = { P02 = ", "drives = { P03-clam = ");
    study.write("mine/study.toml", drive);
    let words = [
        "`exclude.drives`: found `P03-clam`",
        "did you mean `P03-calm`?",
    ];
    study.maveric_in("mine", &["run"]).failed(1, &words);
}

#[test]
fn a_person_whose_part_is_misspelt_is_named_and_one_of_another_part_is_told() {
    let study = recorded(&["calm", "sporty"]);
    let text = read(&study, "mine/study.toml");
    let people = "[people]\ntest = { part = \"test\" }\n";
    let text = if text.contains("[people]") {
        text.replace("[people]", people)
    } else {
        format!("{people}{text}")
    };
    study.write("mine/study.toml", text);
    let table = |part: &str| format!("participant,part\nP01,test\nP02,{part}\nP03,test\n");
    study.write("mine/participants.csv", table("Test"));
    study.maveric_in("mine", &["status"]).failed(
        1,
        &[
            "participants.csv",
            "row 2",
            "`part`",
            "`Test`",
            "`test`, as [people]",
        ],
    );
    study.write("mine/participants.csv", table("pilot"));
    let said = study.maveric_in("mine", &["status"]).ok().stderr;
    assert!(
        said.contains("P02: neither learned from nor tested"),
        "{said}"
    );
}

#[test]
fn a_design_says_the_power_that_a_rehearsal_of_it_found_and_recorded_cars_cannot_be_rehearsed() {
    let study = recorded(&["calm", "sporty"]);
    let describe = ["design", "describe"];
    let said = study.maveric_in("mine", &describe).ok().stdout;
    assert!(
        said.contains("## Sample size") && said.contains("cannot be rehearsed"),
        "{said}"
    );
    let rehearse = [
        "rehearse",
        "--participants",
        "6,8",
        "--effects-times",
        "1",
        "--studies",
        "4",
    ];
    let rehearse = [&rehearse[..], &["--out", "rehearsal"]].concat();
    study.maveric_in("mine", &rehearse).failed(
        1,
        &["study.toml", "`condition.calm.car`", "maveric stats power"],
    );
    let init = [
        "init",
        "dial",
        "--conditions",
        "calm,sporty",
        "--style",
        "adb.total",
        "--synthetic",
    ];
    study.maveric(&init).ok();
    let outcomes = "[[outcome]]\nmeasure = \"mean_velocity_mps\"\n\n[contrasts]";
    change(&study, "dial/study.toml", "[contrasts]", outcomes);
    let said = study.maveric_in("dial", &describe).ok().stdout;
    assert!(
        said.contains("Not settled: no rehearsal of this design was found"),
        "{said}"
    );
    study.maveric_in("dial", &rehearse).ok();
    let said = study.maveric_in("dial", &describe).ok().stdout;
    for words in [
        "4 made-up studies of each size, analysed as declared here. Its effects are assumed, not known",
        "Power, Mean velocity, Calm against Sporty: ",
        " with 6 people, ",
        " with 8 people.",
    ] {
        assert!(said.contains(words), "no `{words}` in {said}");
    }
    // What is declared decides, not the best of all tests, and an effect that is not there has no power.
    let declared = "[[hypothesis]]\nsays = \"Calm is faster than sporty\"\noutcome = \"mean_velocity_mps\"\ncontrast = [\"calm\", \"sporty\"]\n\
                    direction = \"+\"\n\n[contrasts]";
    change(&study, "dial/study.toml", "[contrasts]", declared);
    let ran = study.maveric_in("dial", &rehearse).ok();
    let words = "n = 8: “Calm is faster than sporty” is shown in 0.00 of studies";
    assert!(ran.stdout.contains(words), "{}", ran.stdout);
    Page::read(&study.path("dial/rehearsal/index.html"))
        .says(&[
            "Would 8 people show what the design declares?",
            "“Calm is faster than sporty” would be shown in 0.0% of studies",
            "Line of the style",
        ])
        .is_silent_of(&["aggression line", "what the paper’s design can show"]);
    let said = study.maveric_in("dial", &describe).ok().stdout;
    let words =
        "Power, “Calm is faster than sporty” is shown: 0.00 with 6 people, 0.00 with 8 people.";
    assert!(said.contains(words), "no `{words}` in {said}");
}

#[test]
fn answers_out_of_range_and_outcomes_that_nobody_answered_are_refused_by_name() {
    let study = recorded(&["calm", "sporty"]);
    let sound = read(&study, "mine/surveys/answers.csv");
    let first = sound.lines().nth(1).unwrap();
    let (head, _) = first.rsplit_once(',').unwrap();
    study.write(
        "mine/surveys/answers.csv",
        sound.replacen(first, &format!("{head},9"), 1),
    );
    let ran = study.maveric_in("mine", &["run", "score"]);
    assert_eq!(ran.status, Some(1));
    for words in ["P01", "comfort", "9", "1 to 7"] {
        assert!(ran.stderr.contains(words), "no `{words}` in {}", ran.stderr);
    }
    // A questionnaire that is declared and was never asked after a condition.
    study.write("mine/surveys/answers.csv", sound);
    let asked = "id = \"ease\"\ntitle = \"Ease\"\nreference = \"ours\"\nitems = 1\nmin = 1\nmax = 5\nscoring = \"mean\"\n\
                 [[subscales]]\nid = \"total\"\ntitle = \"Ease\"\nitems = [1]\n";
    study.write("mine/scales/ease.toml", asked);
    let outcome = "[[outcome]]\nscale = \"ease.total\"\n\n[contrasts]";
    change(&study, "mine/study.toml", "[contrasts]", outcome);
    let ran = study.maveric_in("mine", &["run"]);
    assert_eq!(ran.status, Some(1));
    let words = "names `ease.total`, which nobody answered after any condition";
    assert!(ran.stderr.contains(words), "{}", ran.stderr);
    assert!(!study.path("mine/results/analysis.json").exists());
}
