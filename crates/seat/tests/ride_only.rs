//! Studies in which nobody drives: rides in styles that nobody has to be learned for, and questionnaires after rides in another rig.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod support;

use std::fs;
use support::{STUDY, Server, folder_of, go_on, opened};

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
    assert_eq!(
        kinds,
        [
            "text",
            "scale",
            "ride",
            "scale",
            "ride",
            "scale",
            "aftercare",
            "thanks"
        ]
    );
    while go_on(&server, &token) {}
    assert_eq!(server.state(&token)["ended"], "done");
    for log in ["logs/seat/P001-calm.mcap", "logs/seat/P001-sporty.mcap"] {
        assert!(folder.path().join(log).is_file(), "{log}");
    }
    // In one's own style nobody rides who has not driven.
    let own = study(
        "car = { dial = -8, recorded = true }\n",
        mean,
        "[\"before\", \"rides\"]",
    );
    let told = maveric_domain::Design::from_toml(&own).unwrap_err();
    assert!(told.to_string().contains("learned from it"), "{told}");
}

#[test]
fn after_rides_in_another_rig_the_questionnaires_are_asked_in_the_persons_order_without_a_model() {
    let design = study("", "", "[\"consent\", \"rides\"]").replace(
        "[model]\nfile = \"lab.maveric\"\n[style]\nscore = \"adb.total\"\n",
        "",
    );
    let folder = folder_of(&design);
    let settings = || maveric_seat::SeatSettings {
        model: None,
        ..support::settings(folder.path())
    };
    let path = folder.path().join("seat/seat.db");
    let seat = maveric_seat::Seat::open(&path, settings()).unwrap();
    let server = Server::of(seat, |_| {});
    let (one, other) = (opened(&server), opened(&server));
    for token in [&one, &other] {
        let at = loop {
            let state = server.state(token);
            let at = state["at"].as_u64().unwrap();
            let step = &state["steps"][at as usize];
            if step["kind"] == "elsewhere" {
                // Who rides is not told the condition.
                assert_eq!(step["condition"], "ride-1");
                break at;
            }
            assert!(go_on(&server, token));
        };
        let (status, reply) = server.post(&format!("/api/{token}/done/{at}"), "null");
        assert!(status == 400 && reply.contains("asked here"), "{reply}");
        while go_on(&server, token) {}
        assert_eq!(server.state(token)["ended"], "done");
    }
    let people = fs::read_to_string(folder.path().join("participants.csv")).unwrap();
    assert!(
        people.contains("calm sporty") && people.contains("sporty calm"),
        "{people}"
    );
    let answers = fs::read_to_string(folder.path().join("surveys/answers.csv")).unwrap();
    for condition in ["calm", "sporty"] {
        assert!(answers.contains(condition), "{answers}");
    }
    let events = fs::read_to_string(folder.path().join("seat/events.csv")).unwrap();
    assert!(
        events.contains(",calm,") && events.contains(",300.0,"),
        "{events}"
    );
}
