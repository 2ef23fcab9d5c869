//! What the experimenter decides of somebody: something is driven longer, or all that they drove is out of the analysis; and what a crash and a
//! rest become.

use crate::support::{
    STUDY, Server, TAB, folder_of, lab, lab_post, one_person, open, opened, replies,
    script::{finish, go_on, here, piece, until},
    tells,
};
use maveric_domain::{DrivenBy, Seconds};
use maveric_seat_page::{Frames, Input, SeatDrive};
use maveric_simulator::Scenario;
use std::{fs, path::Path};

fn text(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap_or_default()
}

#[test]
fn a_ride_is_driven_longer_for_a_reason_before_it_begins_and_within_what_a_drive_can_be() {
    let (folder, server, token) = one_person();
    let (ride, step) = until(&server, &token, "ride");
    assert_eq!(step["seconds"], 10.0);
    let extends = |minutes: &str, reason: &str| {
        let body = format!("act=extend&minutes={minutes}&reason={reason}");
        lab_post(&server, &format!("/lab/step/P001/{ride}"), &body)
    };
    for (minutes, reason, said) in [
        ("1", "+", "say why"),
        ("0", "late", "more than 0"),
        ("-1", "late", "more than 0"),
        ("soon", "late", "more than 0"),
        ("NaN", "late", "more than 0"),
        ("120", "late", "at most 119.8"),
    ] {
        replies(extends(minutes, reason), 400, said);
    }
    let seconds = |step: u64| server.state(&token)["steps"][step as usize]["seconds"].clone();
    assert_eq!(seconds(ride), 10.0);
    assert_eq!(extends("0.5", "late").0, 303);
    assert_eq!(seconds(ride), 40.0);
    // Your page says the length that it has now.
    let lab = lab(&server);
    assert!(lab.contains("extended by 0.5 min: late"), "{lab}");
    assert!(go_on(&server, &token), "it is driven as long as it is now");
    let (next, _) = until(&server, &token, "ride");
    let head = {
        let seed = server.state(&token)["steps"][next as usize]["seed"].clone();
        let scenario = Scenario::paper().with_duration(Seconds(10.0)).unwrap();
        let mut planner = |_: &maveric_simulator::View<'_>| unreachable!("nothing is planned");
        let controllers = scenario.settings().controllers.clone();
        let seed = seed.as_str().unwrap().parse().unwrap();
        let drive = SeatDrive::ride(&scenario, seed, &mut planner, &controllers).unwrap();
        serde_json::to_string(&drive.begun().header).unwrap()
    };
    let path = format!("/api/{token}/drive/{next}/1/{TAB}");
    let (status, reply) = server.post(&path, &(head + "\n"));
    assert_eq!(status, 200, "{reply}");
    let body = "act=extend&minutes=1&reason=late";
    replies(lab_post(&server, &format!("/lab/step/P001/{next}"), body), 400, "has begun");
    server.seat.write_files().unwrap();
    drop(server);
    let server = Server::open(folder.path());
    let events = text(folder.path(), "seat/events.csv");
    assert!(events.contains("extended by 0.5 min: late"), "{events}");
    assert_eq!(server.state(&token)["steps"][ride as usize]["seconds"], 40.0);
}

#[test]
fn who_is_marked_is_out_of_the_analysis_by_name_until_it_is_taken_back() {
    let (folder, server, token) = one_person();
    while go_on(&server, &token) {}
    let stopped = || text(folder.path(), "seat/stopped.csv");
    let exclude = |who: &str, reason: &str| {
        lab_post(&server, &format!("/lab/exclude/{who}"), &format!("reason={reason}"))
    };
    assert_eq!(stopped(), "");
    replies(exclude("P001", "+"), 400, "say why");
    let (status, reply) = exclude("P009", "asleep");
    assert!(status == 404 || status == 400, "{reply}");
    // Nobody is left out without the password.
    server.post("/lab/exclude/P001", "reason=asleep");
    assert_eq!(stopped(), "");
    assert_eq!(exclude("P001", "fell+asleep").0, 303);
    let rows = stopped();
    for condition in ["own", "calm", "sporty"] {
        let row = rows.lines().find(|l| l.contains(&format!(",{condition},")));
        assert!(row.is_some_and(|row| row.ends_with("excluded: fell asleep")), "{rows}");
    }
    assert_eq!(rows.lines().count(), 4, "{rows}");
    assert!(text(folder.path(), "seat/events.csv").contains("excluded: fell asleep"));
    replies(exclude("P001", "again"), 400, "left out already");
    assert_eq!(exclude("P001", "").0, 303);
    assert_eq!(stopped().lines().count(), 1, "{}", stopped());
    // Both stand in the record.
    let events = text(folder.path(), "seat/events.csv");
    for what in ["excluded: fell asleep", "counts again"] {
        assert_eq!(events.matches(what).count(), 1, "{events}");
    }
}

#[test]
fn a_crash_ends_a_drive_which_counts_as_far_as_it_went_and_is_said() {
    let (folder, server, token) = one_person();
    assert_eq!(server.state(&token)["crash"], "ends");
    let (at, step) = until(&server, &token, "drive");
    let seconds = step["seconds"].as_f64().unwrap();
    let scenario = Scenario::paper().with_duration(Seconds(seconds)).unwrap();
    let seed = step["seed"].as_str().unwrap().parse().unwrap();
    let mut drive = SeatDrive::by_hand(&scenario, seed, DrivenBy::Scripted).unwrap();
    let mut lines = vec![serde_json::to_string(&drive.begun().header).unwrap()];
    while drive.ticks() < 700 {
        assert!(drive.tick(Input::default()));
    }
    drive.note("crash", None);
    lines.push(serde_json::to_string(&drive.chunk(Frames::default())).unwrap());
    lines.push(serde_json::to_string(&drive.finish().unwrap().end).unwrap());
    let path = format!("/api/{token}/drive/{at}/1/{TAB}");
    assert_eq!(server.post(&path, &piece(&lines)).0, 200);
    let (status, reply) = server.post(&format!("/api/{token}/done/{at}"), "null");
    assert_eq!(status, 200, "{reply}");
    assert_eq!(here(&server, &token).1["kind"], "ride");
    assert!(folder.path().join("logs/seat/P001-own.mcap").is_file());
    let lab = lab(&server);
    tells(&lab, &["P001-own: the car hit another vehicle after 7 s, and the drive ended there"]);
    // What was driven without one is said nothing of.
    while go_on(&server, &token) {}
    let events = text(folder.path(), "seat/events.csv");
    assert_eq!(events.matches(",crash,").count(), 1, "{events}");
}

#[test]
fn a_crash_that_is_felt_is_told_to_the_page_and_named_in_the_consent() {
    let design = STUDY.replace("[protocol]\n", "[protocol]\ncrash = \"felt\"\n");
    let folder = folder_of(&design);
    let refused = open(folder.path());
    let told = refused.err().unwrap().to_string();
    assert!(told.contains("the consent does not name it"), "{told}");
    fs::write(folder.path().join("consent.md"), "You drive. {crash}").unwrap();
    let server = Server::open(folder.path());
    let token = opened(&server);
    let state = server.state(&token);
    assert_eq!(state["crash"], "felt");
    let (_, consent) = until(&server, &token, "text");
    let shown = consent["text"].as_str().unwrap();
    assert!(shown.contains("you will hear it"), "{shown}");
}

#[test]
fn a_rest_lasts_as_long_as_the_study_says_and_stands_in_the_events() {
    let steps = "[protocol]\nsteps = [\"consent\", \"break\", \"before\", \"drive\", \"break\", \"rides\"]\nbreak_s = 30\n";
    let folder = folder_of(&STUDY.replace("[protocol]\n", steps));
    let server = Server::open(folder.path());
    let token = opened(&server);
    let (at, step) = until(&server, &token, "break");
    assert_eq!(step["at_least_s"], 30.0);
    replies(server.post(&format!("/api/{token}/done/{at}"), "null"), 400, "asked here");
    let rest = |seconds: u32| {
        let path = format!("/api/{token}/answer/{at}");
        server.post(&path, &format!("{{\"seconds\":{seconds}}}"))
    };
    replies(rest(29), 400, "30 s or more");
    assert_eq!(rest(31).0, 200);
    // The other rest, and all else.
    finish(&server, &token);
    let events = text(folder.path(), "seat/events.csv");
    let rests = events.lines().filter(|line| line.contains(",break,"));
    assert_eq!(rests.count(), 2, "{events}");
    // A rest is no questionnaire.
    let answers = text(folder.path(), "surveys/answers.csv");
    assert!(!answers.contains("break"), "{answers}");
}
