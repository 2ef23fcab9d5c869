//! What the server takes, from whom, how much and how long; and that whoever runs the study is told of what it does not take.

use crate::support::{
    STUDY, Server, TAB, entered, folder, folder_of, lab, one_person, open, opened, read, replies,
    script::{driven, finish, piece, until, up_to},
    settings, tells,
};
use std::{
    fs,
    io::{Read as _, Write as _},
    net::TcpStream,
    sync::{Arc, Mutex},
    time::Duration,
};

/// Connections of which the other end has hung up.
fn closed(streams: &mut [TcpStream]) -> usize {
    let mut byte = [0_u8; 4096];
    let mut count = 0;
    for stream in streams {
        stream.set_nonblocking(true).unwrap();
        loop {
            match stream.read(&mut byte) {
                Ok(0) => count += 1,
                Ok(_) => continue,
                Err(e) if e.kind() == std::io::ErrorKind::WouldBlock => {}
                Err(_) => count += 1,
            }
            break;
        }
    }
    count
}

#[test]
fn connections_that_ask_nothing_and_bodies_that_never_end_leave_the_others_served() {
    let folder = folder();
    let server = Server::open(folder.path());
    let (token, slow) = (opened(&server), opened(&server));
    let connect = || TcpStream::connect(server.address).unwrap();
    let mut idle: Vec<TcpStream> = (0..1_200).map(|_| connect()).collect();
    let mut bodies: Vec<TcpStream> = (0..200)
        .map(|_| {
            let mut stream = connect();
            let head = format!(
                "POST /api/{slow}/answer/0 HTTP/1.1\r\nHost: {0}\r\nOrigin: http://{0}\r\nContent-Length: 60000\r\n\r\n{{",
                server.address
            );
            // The server may have hung up already.
            let _ = stream.write_all(head.as_bytes());
            stream
        })
        .collect();
    finish(&server, &token);
    // What has asked nothing for a second goes when somebody else comes.
    std::thread::sleep(Duration::from_millis(1_100));
    server.state(&token);
    assert!(closed(&mut idle) >= 900, "{} idle ones are closed", closed(&mut idle));
    assert!(closed(&mut bodies) >= 100, "{} bodies are closed", closed(&mut bodies));
}

/// Nothing can be written into these tables of the seat's file any more.
fn fill(disk: &rusqlite::Connection, tables: &[&str]) {
    for table in tables {
        for change in ["INSERT", "UPDATE"] {
            let full = format!(
                "CREATE TRIGGER full_{table}_{change} BEFORE {change} ON {table} BEGIN SELECT RAISE(FAIL, 'database or disk is full'); END"
            );
            disk.execute_batch(&full).unwrap();
        }
    }
}

#[test]
fn what_could_not_be_kept_is_told_at_the_laboratory_and_where_the_seat_was_opened() {
    let folder = folder();
    let told = Arc::new(Mutex::new(Vec::new()));
    let heard = Arc::clone(&told);
    let server = Server::telling(folder.path(), move |line| {
        heard.lock().unwrap().push(line.to_owned());
    });
    let (token, driver) = (opened(&server), opened(&server));
    let cookie = entered(&server);
    let (at, step) = until(&server, &driver, "practice");
    let disk = rusqlite::Connection::open(folder.path().join("seat/seat.db")).unwrap();
    fill(&disk, &["answer", "event", "drive", "piece"]);
    for _ in 0..3 {
        let (status, reply) =
            server.post(&format!("/api/{token}/answer/0"), r#"{"agreed":true,"seconds":1}"#);
        assert!(status == 500 && !reply.contains("disk"), "{reply}");
    }
    let (status, _) = server.post(&format!("/api/{token}/answer/7"), "{}");
    assert_eq!(status, 400);
    // As every second while somebody drives.
    let (lines, _) = driven(&step);
    let path = format!("/api/{driver}/drive/{at}/1/{TAB}");
    let sent = piece(&lines[..2]);
    assert_eq!(server.post(&path, &sent).0, 500);
    let (_, lab) = server.ask("GET", "/lab", "", &[("Cookie", &cookie)]);
    assert!(lab.contains("database or disk is full"), "{lab}");
    assert!(lab.contains("<td>3 ×"), "{lab}");
    assert!(lab.contains("step 7"), "{lab}");
    let full = |who: &str| {
        let told = told.lock().unwrap();
        let of_them = |line: &&String| line.contains(who) && line.contains("disk is full");
        told.iter().filter(of_them).count()
    };
    assert_eq!((full("P001"), full("P002")), (1, 1), "{told:?}");
    // What was not acknowledged is taken once there is room again.
    disk.execute_batch(
        "DROP TRIGGER full_drive_INSERT; DROP TRIGGER full_drive_UPDATE; DROP TRIGGER full_piece_INSERT; DROP TRIGGER full_piece_UPDATE",
    )
    .unwrap();
    let (status, reply) = server.post(&path, &sent);
    assert!(status == 200 && reply.ends_with("\r\n\r\n100"), "{reply}");
}

#[test]
fn the_last_reply_may_be_lost_without_losing_the_code() {
    let (_folder, server, token) = one_person();
    up_to(&server, &token, 10);
    let done = format!("/api/{token}/done/10");
    let first = server.post(&done, "null");
    assert_eq!(first.0, 200, "{}", first.1);
    assert_eq!(server.post(&done, "null").0, 200);
    assert_eq!(server.state(&token)["steps"][10]["code"], "C0DE");
    // What was given before the end stands, and nothing else is taken.
    let answer =
        |step: u64, body: &str| server.post(&format!("/api/{token}/answer/{step}"), body).0;
    assert_eq!(answer(1, r#"{"answers":[4,null],"seconds":6}"#), 200);
    assert_eq!(answer(11, "{}"), 400);
    let fit = r#"{"embedding":[0.1],"covariance":null,"score":null,"readings":1}"#;
    assert_eq!(server.post(&format!("/api/{token}/fit"), fit).0, 400);
}

#[test]
fn one_tab_at_a_time_drives_an_attempt_and_the_other_is_told() {
    let (folder, server, token) = one_person();
    up_to(&server, &token, 4);
    let (lines, _) = driven(&server.state(&token)["steps"][4]);
    let other = "f".repeat(32);
    let path = |attempt: u32, tab: &str| format!("/api/{token}/drive/4/{attempt}/{tab}");
    assert_eq!(server.post(&path(1, TAB), &lines[..3].join("\n")).0, 200);
    assert_eq!(server.post(&format!("/api/{token}/open/{other}"), "null").0, 200);
    // The tab that was left goes on driving: it is told, and nothing of it is kept.
    assert_eq!(server.post(&path(1, TAB), &lines[3]).0, 409);
    // The new tab brings what the old one had kept, but drives an attempt of its own.
    assert_eq!(server.post(&path(1, &other), &lines[1..4].join("\n")).0, 200);
    let elsewhere = lines[1].replace("\"drawn\":60", "\"drawn\":59");
    assert_ne!(elsewhere, lines[1]);
    assert_eq!(server.post(&path(1, &other), &elsewhere).0, 409);
    assert_eq!(server.post(&path(2, &other), &lines.join("\n")).0, 200);
    assert_eq!(server.post(&path(1, TAB), lines.last().unwrap()).0, 409);
    assert_eq!(server.post(&format!("/api/{token}/done/4"), "null").0, 200);
    assert!(folder.path().join("seat/P001-own.cut1.jsonl").is_file());
}

#[test]
fn a_drive_can_hold_only_so_much_beside_its_inputs() {
    let (folder, server, token) = one_person();
    up_to(&server, &token, 4);
    let (lines, _) = driven(&server.state(&token)["steps"][4]);
    let path = format!("/api/{token}/drive/4/1/{TAB}");
    assert_eq!(server.post(&path, &lines[0]).0, 200);
    let event = |tick: u64| format!(r#"{{"tick":{tick},"what":"{}"}}"#, "x".repeat(120));
    let events: Vec<String> = (0..100).map(event).collect();
    let events = events.join(",");
    let piece = |from: u64| {
        format!(r#"{{"from_tick":{from},"ticks":1,"held":[[1,0,0,0,0]],"events":[{events}]}}"#)
    };
    let sent: Vec<u16> = (0..20).map(|from| server.post(&path, &piece(from)).0).collect();
    assert!(sent.iter().filter(|s| **s == 400).count() >= 10, "{sent:?}");
    let kept = fs::metadata(folder.path().join("seat/seat.db-wal")).unwrap();
    assert!(kept.len() > 0);
}

#[test]
fn the_password_is_asked_however_it_is_given_and_is_never_empty() {
    let folder = folder();
    let server = Server::open(folder.path());
    replies(server.post("/lab/enter", "password=guess"), 401, "not the password");
    // What opens the page is no digest of the password, which could be guessed as fast as one can ask.
    let digest = "96f5bcad337376e08aeb4108dd7d701e0873a0ab4529ea433f285c3946be1909";
    let (_, page) = server.ask("GET", "/lab", "", &[("Cookie", &format!("lab={digest}"))]);
    assert!(page.contains("Password") && !page.contains("What happened"), "{page}");
    let (_, page) = server.ask("GET", "/lab", "", &[("Cookie", &entered(&server))]);
    assert!(page.contains("What happened"), "{page}");
    for empty in ["", "  "] {
        let with = maveric_seat::SeatSettings {
            password: Some(empty.to_owned()),
            ..settings(folder.path())
        };
        let refused = maveric_seat::Seat::open(&folder.path().join("other.db"), with);
        assert!(refused.is_err_and(|e| e.to_string().contains("empty")));
    }
}

#[test]
fn the_seat_is_closed_only_when_that_was_meant() {
    let (_folder, server, token) = one_person();
    let cookie = entered(&server);
    let with = &[("Cookie", cookie.as_str())];
    let (_, asks) = server.ask("GET", "/lab/stop", "", with);
    assert!(asks.contains("1 person has not ended"), "{asks}");
    let (_, lab) = server.ask("GET", "/lab", "", with);
    assert!(!lab.contains("action=\"/lab/stop\""), "{lab}");
    assert_eq!(server.state(&token)["at"], 0);
}

#[test]
fn the_page_travels_packed_and_is_kept_by_browsers_until_it_changes() {
    let (_folder, server, token) = one_person();
    let (_, page) = server.ask("GET", &format!("/p/{token}"), "", &[]);
    assert!(page.contains("cache-control: no-store"), "{page}");
    let script = page.split("src=\"").nth(1).unwrap().split('"').next().unwrap();
    assert_eq!(script.split('/').count(), 4, "{script}");
    let packed = &[("Accept-Encoding", "gzip, deflate, br")];
    let (status, sent) = server.ask("GET", script, "", packed);
    let head = sent.split("\r\n\r\n").next().unwrap();
    assert_eq!(status, 200);
    assert!(head.contains("content-encoding: gzip"), "{head}");
    assert!(head.contains("cache-control: public, max-age=31536000, immutable"), "{head}");
    let length = |head: &str| -> usize {
        let length = head.split("content-length: ").nth(1).unwrap();
        length.split("\r\n").next().unwrap().parse().unwrap()
    };
    let (_, plain) = server.ask("GET", script, "", &[]);
    let plain = plain.split("\r\n\r\n").next().unwrap();
    assert!(!plain.contains("content-encoding"), "{plain}");
    assert!(2 * length(head) < length(plain));
    // Another version's name is no file of this one.
    let (status, _) = server.ask("GET", "/page/0123456789abcdef/page.js", "", &[]);
    assert_eq!(status, 404);
}

#[test]
fn every_reply_says_what_a_page_may_do_and_whoever_comes_to_the_front_door_is_told_where_to_go() {
    let folder = folder();
    let server = Server::open(folder.path());
    replies(server.ask("GET", "/", "", &[]), 200, "link");
    let strange: [(&str, &[(&str, &str)]); 3] = [
        ("/nothing", &[]),
        ("/lab", &[("Host", "rebound.example")]),
        ("/lab/next", &[("Origin", "http://evil.example")]),
    ];
    for (path, headers) in strange {
        let method = if path == "/lab/next" { "POST" } else { "GET" };
        let (status, reply) = server.ask(method, path, "", headers);
        assert!(status >= 400, "{reply}");
        for header in ["content-security-policy", "x-content-type-options", "referrer-policy"] {
            assert_eq!(reply.matches(header).count(), 1, "{path} {header}: {reply}");
        }
    }
}

#[test]
fn who_rides_cannot_read_the_condition_in_what_the_page_is_told() {
    let (_folder, server, token) = one_person();
    let state = server.state(&token);
    for (at, step) in state["steps"].as_array().unwrap().iter().enumerate() {
        for key in ["condition", "moment"] {
            let value = step[key].as_str().unwrap_or_default();
            assert!(!["calm", "sporty"].contains(&value), "step {at}: {key} = {value}");
        }
    }
    assert_eq!(state["steps"][7]["condition"], "ride-2");
    assert_eq!(state["steps"][8]["moment"], "ride-2");
}

#[test]
fn a_style_that_the_page_made_up_does_not_replace_what_was_driven() {
    let (_folder, server, token) = one_person();
    up_to(&server, &token, 4);
    let (lines, style) = driven(&server.state(&token)["steps"][4]);
    let path = format!("/api/{token}/drive/4/1/{TAB}");
    assert_eq!(server.post(&path, &piece(&lines)).0, 200);
    let made_up = r#"{"embedding":[9.5],"covariance":null,"score":99.0,"readings":7}"#;
    assert_eq!(server.post(&format!("/api/{token}/fit"), made_up).0, 200);
    assert_eq!(server.post(&format!("/api/{token}/done/4"), "null").0, 200);
    let learned: serde_json::Value = serde_json::from_str(&style.unwrap()).unwrap();
    assert_eq!(server.state(&token)["fit"], learned);
}

#[cfg(unix)]
#[test]
fn what_people_gave_can_be_read_by_the_owner_of_the_seat_alone() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = folder();
    let server = Server::open(folder.path());
    opened(&server);
    for name in ["seat.db", "seat.db-wal", "seat.db-shm"] {
        let path = folder.path().join("seat").join(name);
        let mode = fs::metadata(&path).unwrap().permissions().mode();
        assert_eq!(mode & 0o077, 0, "{name}: {mode:o}");
    }
    let mode = fs::metadata(folder.path().join("seat")).unwrap().permissions().mode();
    assert_eq!(mode & 0o077, 0, "the folder: {mode:o}");
}

#[test]
fn a_condition_without_a_car_is_named_with_what_the_seat_drives() {
    let design = STUDY.replace("car = { dial = 8, recorded = true }\n", "");
    let folder = folder_of(&design);
    let refused = open(folder.path());
    let told = refused.err().unwrap().to_string();
    tells(&told, &["`sporty`", "no `car`"]);
}

#[test]
fn a_study_is_open_in_one_seat_at_a_time() {
    let folder = folder();
    let _server = Server::open(folder.path());
    std::thread::sleep(Duration::from_millis(1));
    let second = open(folder.path());
    assert!(second.is_err_and(|e| e.to_string().contains("open")));
}

#[test]
fn the_same_answers_again_are_a_lost_reply_and_others_are_refused_and_told() {
    let (folder, server, token) = one_person();
    let (at, _) = until(&server, &token, "scale");
    let path = format!("/api/{token}/answer/{at}");
    let first = r#"{"answers":[4,null],"seconds":6}"#;
    for _ in 0..2 {
        replies(server.post(&path, first), 200, &(at + 1).to_string());
    }
    let told = format!("step {} was answered before", at + 1);
    // Another browser with the same link, later.
    let later = first.replace("\"seconds\":6", "\"seconds\":9.5");
    replies(server.post(&path, &later), 200, &(at + 1).to_string());
    assert!(!lab(&server).contains(&told));
    let others = r#"{"answers":[1,2],"seconds":6}"#;
    replies(server.post(&path, others), 409, "maveric-refused: other-tab");
    tells(&lab(&server), &[&told]);
    server.seat.write_files().unwrap();
    let answers = read(folder.path(), "surveys/answers.csv");
    tells(&answers, &["P001,pre,mood,1,4,3.000\nP001,pre,mood,2,,3.000\n"]);
}
