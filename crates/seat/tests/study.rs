//! A whole study through the server: by a scripted person, by a person whose server is killed, and by people who try what they should not.

use crate::support::{
    STUDY, Server, TAB, folder, folder_of, lab, lab_post, one_person, open_with, opened, read,
    script::{driven, finish, go_on, piece, until, up_to},
    seat, settings, tells,
};
use maveric_domain::DrivenBy;
use maveric_ingest::{IngestSettings, read_log};
use maveric_seat::{Seat, SeatSettings, Wire, replay, serve};
use maveric_study::tables::dial::read_turns;
use serde_json::{Value, json};
use std::{fs, net::SocketAddr, path::Path, sync::Arc};

#[test]
fn a_whole_study_becomes_the_files_that_a_run_reads() {
    let folder = folder();
    let server = Server::open(folder.path());
    for _ in 0..2 {
        let token = opened(&server);
        finish(&server, &token);
    }
    let at = |name: &str| folder.path().join(name);
    let answers = fs::read_to_string(at("surveys/answers.csv")).unwrap();
    assert!(answers.starts_with("participant,moment,scale,item,answer,seconds\nP001,pre,mood,1,4,3.000\nP001,pre,mood,2,,3.000\n"));
    assert_eq!(answers.lines().count(), 1 + 2 * 3 * 2);
    let people = fs::read_to_string(at("participants.csv")).unwrap();
    assert_eq!(people, "participant,study,order\nP001,2,calm sporty\nP002,2,sporty calm\n");
    for drive in ["own", "calm", "sporty"] {
        let log = at(&format!("logs/seat/P002-{drive}.mcap"));
        let read = read_log(&log, &IngestSettings::default()).unwrap();
        let meta = &read[0].meta;
        let by = if drive == "own" { DrivenBy::Scripted } else { DrivenBy::Automated };
        assert_eq!(
            (meta.participant.as_str(), meta.condition.as_str(), meta.driven_by),
            ("P002", drive, by)
        );
        let record = at(&format!("seat/P002-{drive}.jsonl"));
        let again = replay::repeat(&record).unwrap();
        assert_eq!(again.same, Some(true));
        assert_eq!(replay::repeat(&log).unwrap(), again);
        // The log, ingested, is the drive to a nanometre.
        let record =
            maveric_seat_page::Record::from_lines(&fs::read_to_string(&record).unwrap()).unwrap();
        let again = maveric_seat_page::replay(&record).unwrap().rollout.recording;
        let (there, here) = (read[0].recording.ego(), again.ego());
        assert_eq!(there.x_m.len(), here.x_m.len());
        for (a, b) in there.x_m.iter().zip(&here.x_m).chain(there.y_m.iter().zip(&here.y_m)) {
            assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
    }
}

#[test]
fn a_server_that_was_killed_goes_on_at_the_step_and_loses_nothing_that_it_acknowledged() {
    let (folder, mut server, token) = one_person();
    let mut steps = 0;
    loop {
        // Killed before each step, and in the middle of each drive.
        let state = server.state(&token);
        let step = state["steps"].get(state["at"].as_u64().unwrap() as usize).cloned();
        if let Some(step) = step.filter(|s| s["kind"] == "drive" || s["kind"] == "ride") {
            let (lines, _) = driven(&step);
            let path = format!("/api/{token}/drive/{}/1/{TAB}", state["at"]);
            let (_, reply) = server.post(&path, &piece(&lines[..6]));
            assert!(reply.ends_with("\r\n\r\n500"), "{reply}");
            drop(server);
            server = Server::open(folder.path());
            assert_eq!(server.state(&token)["attempts"], 1);
            // What the browser had kept comes again, from another tab, twice.
            for _ in 0..2 {
                let (status, reply) = server.post(&path, &piece(&lines[4..8]));
                assert!(status == 200 && reply.ends_with("\r\n\r\n700"), "{reply}");
            }
        }
        if !go_on(&server, &token) {
            break;
        }
        steps += 1;
        drop(server);
        server = Server::open(folder.path());
    }
    assert_eq!(steps, 10);
    assert_eq!(server.state(&token)["ended"], "done");
    assert_eq!(read(folder.path(), "surveys/answers.csv").lines().count(), 7);
}

#[test]
fn what_a_step_does_not_ask_is_refused() {
    let folder = folder();
    let server = Server::open(folder.path());
    let (mine, other) = (opened(&server), opened(&server));
    let refused = |path: &str, body: &str, expected: u16| {
        let (status, reply) = server.post(path, body);
        assert_eq!(status, expected, "{path} {}: {reply}", &body[..body.len().min(60)]);
    };
    // Somebody who guesses, and paths that lead elsewhere.
    for token in ["0".repeat(32), "..%2f..%2fetc".to_owned(), "x".to_owned()] {
        refused(&format!("/api/{token}/answer/0"), "{}", 404);
    }
    for path in ["/page/..%2fCargo.toml", "/page/seat.db", "/p/../seat/seat.db", "/seat/seat.db"] {
        assert_ne!(server.ask("GET", path, "", &[]).0, 200, "{path}");
    }
    let answer = |step: u64| format!("/api/{mine}/answer/{step}");
    refused(&answer(0), r#"{"answers":[1],"seconds":1,"agreed":true}"#, 400);
    refused(&answer(0), r#"{"seconds":1}"#, 400);
    refused(&answer(1), r#"{"answers":[1,1],"seconds":1}"#, 400);
    refused(&format!("/api/{mine}/done/0"), "null", 400);
    // Other pages.
    let body = r#"{"agreed":true,"seconds":1}"#;
    for origin in ["http://evil.example", "null", ""] {
        assert_eq!(server.ask("POST", &answer(0), body, &[("Origin", origin)]).0, 403, "{origin}");
    }
    assert_eq!(server.post(&answer(0), body).0, 200);
    for sheet in [
        r#"{"answers":[1,6],"seconds":1}"#,
        r#"{"answers":[1],"seconds":1}"#,
        r#"{"answers":["<script>",1],"seconds":1}"#,
        r#"{"answers":[1,1],"seconds":-1}"#,
        r#"{"answers":[1,1],"seconds":1,"more":1}"#,
        "[",
    ] {
        refused(&answer(1), sheet, 400);
    }
    refused(&answer(1), &" ".repeat(3 << 20), 413);
    assert_eq!(server.state(&other)["at"], 0, "somebody else's step moved");
    // Up to the drive by hand, and there what is no part of it.
    let (at, step) = until(&server, &mine, "drive");
    let (lines, _) = driven(&step);
    let path = |attempt: u32, tab: &str| format!("/api/{mine}/drive/{at}/{attempt}/{tab}");
    refused(&path(1, &"f".repeat(32)), &lines[0], 409);
    refused(&path(2, TAB), &lines[0], 400);
    refused(&path(1, TAB), &lines[1], 400);
    let mut elsewhere = step.clone();
    elsewhere["seed"] = json!("99");
    refused(&path(1, TAB), &driven(&elsewhere).0[0], 400);
    elsewhere = step.clone();
    elsewhere["seconds"] = json!(40.0);
    refused(&path(1, TAB), &driven(&elsewhere).0[0], 400);
    assert_eq!(server.post(&path(1, TAB), &lines[0]).0, 200);
    let long = r#"{"from_tick":0,"ticks":9000,"held":[[9000,0,0,0,0]]}"#;
    for piece in [long, r#"{"from_tick":0,"ticks":5,"held":[[4,0,0,0,0]]}"#, "{\"x\":1}", "\u{0}"] {
        refused(&path(1, TAB), piece, 400);
    }
    let padded = format!("{}{}", lines[1], " ".repeat(20 << 10));
    refused(&path(1, TAB), &padded, 400);
    refused(&format!("/api/{mine}/done/{at}"), "null", 400);
    let style = r#"{"embedding":[0.1],"covariance":null,"score":null,"readings":1}"#;
    refused(&format!("/api/{other}/fit"), style, 400);
    refused(
        &format!("/api/{mine}/fit"),
        r#"{"embedding":[],"covariance":null,"score":null,"readings":1}"#,
        400,
    );
}

#[test]
fn a_drive_that_cannot_be_driven_again_is_kept_and_said_and_holds_nobody_up() {
    let (folder, server, token) = one_person();
    up_to(&server, &token, 5);
    let step = server.state(&token)["steps"][5].clone();
    let (lines, _) = driven(&step);
    // A ride whose set-points somebody took out.
    let lines: Vec<String> = lines
        .iter()
        .map(|line| {
            let mut line: Value = serde_json::from_str(line).unwrap();
            line.as_object_mut().unwrap().remove("asked");
            line.to_string()
        })
        .collect();
    let path = format!("/api/{token}/drive/5/1/{TAB}");
    assert_eq!(server.post(&path, &piece(&lines)).0, 200);
    assert_eq!(server.post(&format!("/api/{token}/done/5"), "null").0, 200);
    assert_eq!(server.state(&token)["at"], 6);
    assert!(folder.path().join("seat/P001-calm.jsonl").is_file());
    assert!(!folder.path().join("logs/seat/P001-calm.mcap").exists());
    lab_post(&server, "/lab/note", "note=%3Cb%3Elate");
    let page = lab(&server);
    assert!(page.contains("P001-calm: cannot be driven again"), "{page}");
    assert!(page.contains("note: &lt;b&gt;late"), "{page}");
}

#[test]
fn a_drive_whose_style_never_came_is_learned_from_here() {
    let (folder, server, token) = one_person();
    up_to(&server, &token, 4);
    let (lines, style) = driven(&server.state(&token)["steps"][4]);
    let path = format!("/api/{token}/drive/4/1/{TAB}");
    assert_eq!(server.post(&path, &piece(&lines[..9])).0, 200);
    // The tab was closed; another one begins again, drives to the end, and is closed before it learns.
    let path = format!("/api/{token}/drive/4/2/{TAB}");
    assert_eq!(server.post(&path, &piece(&lines)).0, 200);
    assert_eq!(server.state(&token)["whole"], true);
    assert_eq!(server.post(&format!("/api/{token}/done/4"), "null").0, 200);
    let page: Value = serde_json::from_str(&style.unwrap()).unwrap();
    assert_eq!(server.state(&token)["fit"], page);
    let cut = folder.path().join("seat/P001-own.cut1.jsonl");
    assert_eq!(replay::repeat(&cut).unwrap().same, None);
    assert_eq!(replay::repeat(&cut).unwrap().ticks, 800);
}

#[test]
fn what_others_wrote_into_the_tables_of_the_study_stays() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir_all(at("surveys")).unwrap();
    fs::write(at("participants.csv"), "participant,study,age\nP001,1,40\n").unwrap();
    let before = "participant,moment,scale,item,answer\nP001,pre,mood,1,5\n";
    fs::write(at("surveys/answers.csv"), before).unwrap();
    let server = Server::open(folder.path());
    let token = opened(&server);
    assert!(go_on(&server, &token) && go_on(&server, &token));
    server.seat.write_files().unwrap();
    let people = fs::read_to_string(at("participants.csv")).unwrap();
    assert_eq!(people, "participant,study,age,order\nP001,1,40,\nP002,2,,calm sporty\n");
    let answers = fs::read_to_string(at("surveys/answers.csv")).unwrap();
    assert_eq!(
        answers,
        "participant,moment,scale,item,answer,seconds\nP001,pre,mood,1,5,\nP002,pre,mood,1,4,3.000\nP002,pre,mood,2,,3.000\n"
    );
}

#[test]
fn turns_of_the_dial_are_written_for_whoever_recommends() {
    let free = STUDY.replace("{ dial = 8, recorded = true }", "{ free = true }");
    let folder = folder_of(&free);
    let server = Server::open(folder.path());
    let token = opened(&server);
    while go_on(&server, &token) {}
    let turns = read_turns(&folder.path().join("seat")).unwrap();
    let [ride] = &turns[..] else {
        panic!("{turns:?}");
    };
    assert_eq!(ride.participant.as_str(), "P001");
    assert_eq!(ride.turned, [(3.0, 5.0)]);
    assert!((ride.duration_s - 10.0).abs() < 1e-9 && (ride.step - 5.0).abs() < 1e-9);
    assert!((ride.settled().unwrap().points - 5.0).abs() < 1e-9);
    assert!(folder.path().join("seat/P001-sporty.dial.csv").is_file());
}

#[test]
fn while_nobody_was_learned_from_nobody_rides() {
    let design = STUDY
        .replace("[model]\nfile = \"lab.maveric\"\n", "")
        .replace("test = {", "learn = { study = \"1\" }\ntest = {")
        .replace("score = \"adb.total\"", "score = \"mood.total\"");
    let folder = folder_of(&design);
    let one_more = |seat: Seat| {
        let server = Server::of(seat, |_| {});
        let token = opened(&server);
        assert!(go_on(&server, &token));
        server.seat.write_files().unwrap();
        server.seat.rides()
    };
    assert!(!one_more(open_with(folder.path(), None).unwrap()));
    assert!(one_more(seat(folder.path())));
    let people = read(folder.path(), "participants.csv");
    assert_eq!(people, "participant,study,order\nP001,1,\nP002,2,calm sporty\n");
    // A study that learns of nobody and names no model has nobody to ride with.
    let other = crate::support::folder();
    let without = SeatSettings { model: None, ..settings(other.path()) };
    let refused = Seat::open(&folder.path().join("seat/seat.db"), without);
    let refused = refused.err().unwrap();
    assert!(refused.to_string().contains("no model"), "{refused}");
}

#[test]
fn the_laboratory_asks_its_password_and_shows_text_as_text() {
    let (_folder, server, token) = one_person();
    let (_, closed) = server.ask("GET", "/lab", "", &[]);
    assert!(closed.contains("Password") && !closed.contains(&token));
    let (_, wrong) = server.post("/lab/enter", "password=guess");
    assert!(!wrong.to_lowercase().contains("set-cookie"));
    server.post("/lab/next", "");
    let (status, entered) = server.post("/lab/enter", "password=open+%26+see");
    assert_eq!(status, 303);
    let cookie = entered.lines().find_map(|l| l.strip_prefix("set-cookie: ")).unwrap();
    assert!(cookie.contains("HttpOnly") && cookie.contains("SameSite=Strict"));
    let cookie = cookie.split(';').next().unwrap();
    let (_, page) = server.ask("GET", "/lab", "", &[("Cookie", cookie)]);
    assert!(page.contains(&token) && page.contains("Calm &amp; &lt;b&gt;sporty"));
    assert_eq!(page.matches("/p/").count(), 2, "nobody without a password let anyone in");
    server.ask("POST", "/lab/next", "", &[("Cookie", cookie)]);
    let (_, page) = server.ask("GET", "/lab", "", &[("Cookie", cookie)]);
    assert_eq!(page.matches("/p/").count(), 4);
    assert!(page.contains("content-security-policy: default-src 'none'"));
    // Nothing of it without the password: not from above, not the answers, not the end.
    for path in ["/lab/above/P001", "/lab/answers.csv"] {
        assert_eq!(server.ask("GET", path, "", &[]).0, 303, "{path}");
    }
    let (status, stopped) = server.post("/lab/stop", "");
    assert!(status == 303 && !stopped.contains("is closed"), "{stopped}");
    while go_on(&server, &token) {}
    let entered = &[("Cookie", cookie)];
    let (_, above) = server.ask("GET", "/lab/above/P001", "", entered);
    tells(&above, &["<svg", "refresh: 2"]);
    assert!(above.contains("10 s; "), "{above}");
    for strange in ["P999", "%3Cscript%3E", "..%2f..%2fetc"] {
        assert_eq!(server.ask("GET", &format!("/lab/above/{strange}"), "", entered).0, 400);
    }
    let (_, answers) = server.ask("GET", "/lab/answers.csv", "", entered);
    assert!(answers.contains("P001,pre,mood,1,4,3.000"), "{answers}");
}

#[test]
fn who_leaves_is_asked_what_is_kept() {
    let (folder, server, token) = one_person();
    up_to(&server, &token, 6);
    assert!(folder.path().join("logs/seat/P001-own.mcap").is_file());
    server.seat.write_files().unwrap();
    let people = || read(folder.path(), "participants.csv");
    assert!(people().contains("P001"));
    assert_eq!(server.post(&format!("/api/{token}/leave"), r#"{"keep":false}"#).0, 200);
    assert!(!folder.path().join("logs/seat/P001-own.mcap").exists());
    assert!(!folder.path().join("seat/P001-own.jsonl").exists());
    let answers = read(folder.path(), "surveys/answers.csv");
    assert_eq!(answers.lines().count(), 1);
    assert!(!people().contains("P001"));
    assert_eq!(server.state(&token)["ended"], "deleted");
    assert_eq!(server.post(&format!("/api/{token}/done/2"), "null").0, 404);
}

#[test]
fn other_computers_are_served_only_where_that_was_said() {
    let folder = folder();
    let server = Server::open(folder.path());
    let runtime = server.runtime.as_ref().unwrap();
    let everywhere = SocketAddr::from(([0, 0, 0, 0], 0));
    let refused = runtime.block_on(serve(Arc::clone(&server.seat), everywhere, Wire::Here, |_| {}));
    assert!(refused.is_err_and(|e| e.to_string().contains("--plain-http")));
    let (own, rebound) = (server.address.to_string(), "rebound.example");
    for hosts in [
        &[("Host", rebound)][..],
        &[("Host", &own), ("Host", rebound)],
        &[("Host", rebound), ("Host", &own)],
    ] {
        assert_ne!(server.ask("GET", "/lab", "", hosts).0, 200, "{hosts:?}");
    }
    assert_eq!(server.ask("GET", "/lab", "", &[("Host", &own)]).0, 200);
}

#[test]
fn a_study_in_german_is_served_in_german_with_its_own_sentences() {
    let keys = "[protocol]
language = \"de\"
words = \"words.toml\"
withdraw_until = \"2999-12-31\"";
    let german = STUDY.replace("[protocol]", keys);
    let folder = folder_of(&german);
    fs::write(folder.path().join("words.toml"), "begin = \"Los <los>\"").unwrap();
    let scale = folder.path().join("scales/mood.toml");
    let mood = format!("language = \"de\"\n{}", fs::read_to_string(&scale).unwrap());
    fs::write(&scale, mood).unwrap();
    let server = Server::open(folder.path());
    let token = opened(&server);
    let (_, page) = server.ask("GET", &format!("/p/{token}"), "", &[]);
    assert!(page.contains("lang=\"de\"") && !page.contains("lang=\"en\""));
    assert!(page.contains("\"continue\":\"Weiter\""), "{page}");
    assert!(page.contains("\"begin\":\"Los \\u003clos>\""), "{page}");
    let consent = server.state(&token)["steps"][0]["text"].to_string();
    assert!(consent.contains("Bis 2999-12-31 können Sie"), "{consent}");
}

#[test]
fn the_built_page_is_made_from_the_sources_that_stand_here() {
    use sha2::Digest as _;
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    let mut take = |folder: &str, ending: &str| {
        for file in fs::read_dir(here.join(folder)).unwrap() {
            let path = file.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if name.ends_with(ending) {
                files.push((format!("{}/{name}", folder.trim_start_matches("page/")), path));
            }
        }
    };
    take("page/src", "");
    take("../seat-page/src", ".rs");
    for name in ["package-lock.json", "tsconfig.json"] {
        files.push((name.to_owned(), here.join("page").join(name)));
    }
    // As `ls` names them from the page's folder, in the order of bytes.
    for file in &mut files {
        if let Some(rest) = file.0.strip_prefix("../") {
            file.0 = format!("../../{rest}");
        }
    }
    files.sort();
    let mut hash = sha2::Sha256::new();
    for (_, path) in &files {
        hash.update(fs::read(path).unwrap());
    }
    let found = hash.finalize().iter().fold(String::new(), |mut text, byte| {
        let _ = std::fmt::Write::write_fmt(&mut text, format_args!("{byte:02x}"));
        text
    });
    let built = fs::read_to_string(here.join("page/built/sources.sha256")).unwrap();
    assert_eq!(built.trim(), found, "the page's sources have changed: tools/build-page.sh");
}
