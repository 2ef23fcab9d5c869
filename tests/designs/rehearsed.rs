//! Designs that are rehearsed.

use super::*;
use path_slash::PathExt as _;

#[test]
fn a_design_says_the_power_that_a_rehearsal_of_it_found_and_recorded_cars_cannot_be_rehearsed() {
    let study = recorded(&["calm", "sporty"]);
    let describe = ["design", "describe"];
    let said = study.maveric_in("mine", &describe).ok().stdout;
    tells(&said, &["## Sample size", "cannot be rehearsed"]);
    let rehearse =
        argv("rehearse --participants 6,8 --effects-times 1 --studies 4 --out rehearsal");
    study
        .maveric_in("mine", &rehearse)
        .failed(1, &["study.toml", "`condition.calm.car`", "maveric stats power"]);
    let init = argv("init dial --conditions calm,sporty --style adb.total --synthetic");
    study.maveric(&init).ok();
    let outcomes = "[[outcome]]\nmeasure = \"mean_velocity_mps\"\n\n[contrasts]";
    change(&study, "dial/study.toml", "[contrasts]", outcomes);
    let said = study.maveric_in("dial", &describe).ok().stdout;
    tells(&said, &["Not settled: no rehearsal of this design was found"]);
    study.maveric_in("dial", &rehearse).ok();
    let said = study.maveric_in("dial", &describe).ok().stdout;
    tells(
        &said,
        &[
            "4 made-up studies of each size, analysed as declared here. Its effects are assumed, not known",
            "Power, Mean velocity, Calm against Sporty: ",
            " with 6 people, ",
            " with 8 people.",
        ],
    );
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
fn a_study_that_lends_styles_is_rehearsed_with_six_people_and_refused_with_five() {
    let study = TempStudy::new();
    let shipped = crate::support::root().join("study_data");
    let paper = std::fs::read_to_string(shipped.join("designs/paper.toml")).unwrap();
    let paper = paper.replace("\"../", &format!("\"{}/", shipped.to_slash_lossy()));
    let lent = paper.replace("{ across = true }", "{ other = \"matched\" }");
    study.write("d/study.toml", lent);
    let rehearse = |people: &str| {
        let sizes = format!("--participants {people} --studies 2 --effects-times 1");
        study.maveric_in("d", &argv(&format!("rehearse {sizes} --out rehearsal")))
    };
    rehearse("5,8").failed(
        1,
        &[
            "`condition.perpendicular.car` lends somebody else's style",
            "a study of 5 has 4 who could lend theirs, expected 5 or more",
            "--participants 6",
        ],
    );
    rehearse("6").ok();
    let found = study.read("d/rehearsal/rehearsal.json");
    assert!(found.contains("perpendicular"), "{found}");
}
