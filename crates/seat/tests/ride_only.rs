//! Studies in which nobody drives: rides in styles that nobody has to be learned for, and questionnaires after rides in another rig.

use crate::support::{
    STUDY, Server, folder_of, open_with, opened, read, replies,
    script::{finish, until},
    tells,
};

/// The study with these cars and steps.
fn study(calm: &str, sporty: &str, steps: &str) -> String {
    STUDY
        .replace("car = { dial = -8, recorded = true }\n", calm)
        .replace("car = { dial = 8, recorded = true }\n", sporty)
        .replace("[protocol]\n", &format!("[protocol]\nsteps = {steps}\n"))
}

#[test]
fn rides_in_the_average_style_need_no_drive_and_their_logs_are_written() {
    let mean = "car = { mean = true, recorded = true }\n";
    let design = study(mean, mean, "[\"consent\", \"before\", \"rides\"]");
    let folder = folder_of(&design);
    let server = Server::open(folder.path());
    let token = opened(&server);
    let state = server.state(&token);
    let kinds: Vec<&str> = state["steps"]
        .as_array()
        .unwrap()
        .iter()
        .map(|step| step["kind"].as_str().unwrap())
        .collect();
    assert_eq!(kinds, ["text", "scale", "ride", "scale", "ride", "scale", "aftercare", "thanks"]);
    finish(&server, &token);
    for log in ["logs/seat/P001-calm.mcap", "logs/seat/P001-sporty.mcap"] {
        assert!(folder.path().join(log).is_file(), "{log}");
    }
    // In one's own style nobody rides who has not driven.
    let own = study("car = { dial = -8, recorded = true }\n", mean, "[\"before\", \"rides\"]");
    let told = maveric_domain::Design::from_toml(&own).unwrap_err();
    assert!(told.to_string().contains("learned from it"), "{told}");
}

#[test]
fn after_rides_in_another_rig_the_questionnaires_are_asked_in_the_persons_order_without_a_model() {
    let design = study("", "", "[\"consent\", \"rides\"]")
        .replace("[model]\nfile = \"lab.maveric\"\n[style]\nscore = \"adb.total\"\n", "");
    let folder = folder_of(&design);
    let server = Server::of(open_with(folder.path(), None).unwrap(), |_| {});
    let (one, other) = (opened(&server), opened(&server));
    for token in [&one, &other] {
        let (at, step) = until(&server, token, "elsewhere");
        // Who rides is not told the condition.
        assert_eq!(step["condition"], "ride-1");
        replies(server.post(&format!("/api/{token}/done/{at}"), "null"), 400, "asked here");
        finish(&server, token);
    }
    let people = read(folder.path(), "participants.csv");
    tells(&people, &["calm sporty", "sporty calm"]);
    let answers = read(folder.path(), "surveys/answers.csv");
    for condition in ["calm", "sporty"] {
        assert!(answers.contains(condition), "{answers}");
    }
    let events = read(folder.path(), "seat/events.csv");
    tells(&events, &[",calm,", ",300.0,"]);
}
