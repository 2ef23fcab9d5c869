//! A study in a folder, a server for it, and the page of its experimenter.

#![allow(dead_code, reason = "each test file takes what it needs")]
#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

#[path = "../../../seat-page/tests/support/mod.rs"]
mod made;
pub(crate) mod script;

use made::model;
use maveric_domain::ScoreRange;
use maveric_model::{Model, model_file};
use maveric_seat::{Seat, SeatError, SeatSettings, Wire, files, serve};
use maveric_simulator::Scenario;
use maveric_study::DesignFile;
use maveric_study::run_folder::read_scales;
use serde_json::{Value, json};
use std::fs;
use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::path::Path;
use std::sync::Arc;

pub(crate) const STUDY: &str = r#"
[study]
title = "Calm & <b>sporty</b>"
[people]
test = { study = "2" }
[model]
file = "lab.maveric"
[style]
score = "adb.total"
[[condition]]
id = "calm"
car = { dial = -8, recorded = true }
[[condition]]
id = "sporty"
car = { dial = 8, recorded = true }
[baseline]
id = "own"
[protocol]
consent = "consent.md"
before = ["mood"]
after = ["mood"]
practice = { lane_kept_s = 1, passes = 0, at_most_s = 10 }
drive_s = 20
ride_s = 10
code = "C0DE"
"#;

pub(crate) const MOOD: &str = r#"
id = "mood"
title = "Mood"
reference = "made for this test"
items = 2
min = 1
max = 5
scoring = "mean"
wording = ["I am <i>calm</i>.", "I am tense."]
[[subscales]]
id = "total"
title = "Mood"
items = [1, 2]
"#;

pub(crate) const MISC: &str = "id = \"misc\"\ntitle = \"Misery\"\nreference = \"made for this test\"\nitems = 1\nmin = 0\nmax = 10\nscoring = \"mean\"\n\
    wording = [\"How sick do you feel?\"]\n[[subscales]]\nid = \"total\"\ntitle = \"Misery\"\nitems = [1]\n";

pub(crate) fn folder() -> tempfile::TempDir {
    folder_of(STUDY)
}

/// The folder of the study that `design` says.
pub(crate) fn folder_of(design: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &[u8]| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    write("study.toml", design.as_bytes());
    write("scales/mood.toml", MOOD.as_bytes());
    write("consent.md", b"You may leave at any time.");
    write("lab.maveric", &model_file::to_bytes(&model()).unwrap());
    fs::create_dir_all(folder.path().join("seat")).unwrap();
    folder
}

/// A model of two numbers that learned from these drives.
pub(crate) fn learned_from(folder: &Path, drives: &[&str]) -> Vec<u8> {
    let made = fs::read(folder.join("lab.maveric")).unwrap();
    let mut made = serde_json::to_value(model_file::from_bytes(&made).unwrap()).unwrap();
    let training = (0_i32..).zip(drives).map(|(i, drive)| {
        let place = [f64::from(i % 3), f64::from(i % 2)];
        json!({"drive": drive, "embedding": place, "mean_speed_mps": 27.0})
    });
    made["training"] = training.collect();
    made["embedding_size"] = 2.into();
    let linear = &mut made["heads"]["linear"];
    for head in linear["heads"].as_array_mut().unwrap() {
        head["slopes"] = json!([head["slopes"][0], 0.1]);
    }
    linear["style"]["gradient"] = json!([10.0, 0.0]);
    linear["style"]["covariance"] = json!([0.01, 0.0, 0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.01]);
    let model: Model = serde_json::from_value(made).unwrap();
    model_file::to_bytes(&model).unwrap()
}

/// What the seat of the study in a folder is opened with.
pub(crate) fn settings(folder: &Path) -> SeatSettings {
    let study = DesignFile::read(&folder.join("study.toml")).unwrap();
    let files = files::Files::of(&study, folder.join("seat"));
    let (texts, in_others) = files::texts(&study).unwrap();
    SeatSettings {
        scales: read_scales(&folder.join("scales")).unwrap(),
        texts,
        in_others,
        scenario: Scenario::paper(),
        model: Some(fs::read(folder.join("lab.maveric")).unwrap()),
        made_up_model: true,
        range: Some(ScoreRange::ADB),
        files,
        password: Some("open & see".to_owned()),
        design: study.design,
    }
}

/// The seat of the study in a folder, or why it does not open.
pub(crate) fn open(folder: &Path) -> Result<Seat, SeatError> {
    Seat::open(&folder.join("seat/seat.db"), settings(folder))
}

/// As [`open`], with this model.
pub(crate) fn open_with(folder: &Path, model: Option<Vec<u8>>) -> Result<Seat, SeatError> {
    let settings = SeatSettings { model, ..settings(folder) };
    Seat::open(&folder.join("seat/seat.db"), settings)
}

/// The seat of the study in a folder.
pub(crate) fn seat(folder: &Path) -> Seat {
    open(folder).unwrap()
}

/// A file of the study in a folder.
pub(crate) fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

pub(crate) fn runtime() -> tokio::runtime::Runtime {
    tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build().unwrap()
}

/// A server, and the runtime that it ends with.
pub(crate) struct Server {
    pub(crate) runtime: Option<tokio::runtime::Runtime>,
    pub(crate) seat: Arc<Seat>,
    pub(crate) address: SocketAddr,
}

impl Server {
    pub(crate) fn open(folder: &Path) -> Self {
        Self::telling(folder, |_| {})
    }

    /// As [`Server::open`]; `tell` hears what is printed where the seat was opened.
    pub(crate) fn telling(folder: &Path, tell: impl Fn(&str) + Send + Sync + 'static) -> Self {
        Self::of(seat(folder), tell)
    }

    /// A server of this seat.
    pub(crate) fn of(seat: Seat, tell: impl Fn(&str) + Send + Sync + 'static) -> Self {
        let seat = Arc::new(seat);
        let runtime = runtime();
        let any = SocketAddr::from(([127, 0, 0, 1], 0));
        let serving = runtime.block_on(serve(Arc::clone(&seat), any, Wire::Here, tell)).unwrap();
        let address = serving.address;
        runtime.spawn(serving.forever());
        Self { runtime: Some(runtime), seat, address }
    }

    pub(crate) fn ask(
        &self,
        method: &str,
        path: &str,
        body: &str,
        headers: &[(&str, &str)],
    ) -> (u16, String) {
        let address = self.address;
        let mut all = vec![("Connection", "close".to_owned())];
        if headers.iter().all(|(name, _)| *name != "Host") {
            all.push(("Host", address.to_string()));
        }
        if !headers.iter().any(|(name, _)| *name == "Origin") {
            all.push(("Origin", format!("http://{address}")));
        }
        all.extend(headers.iter().map(|(name, value)| (*name, (*value).to_owned())));
        all.retain(|(name, value)| !(name == &"Origin" && value.is_empty()));
        let mut text = format!("{method} {path} HTTP/1.1\r\nContent-Length: {}\r\n", body.len());
        for (name, value) in all {
            text += name;
            text += ": ";
            text += &value;
            text += "\r\n";
        }
        let mut stream = TcpStream::connect(address).unwrap();
        // A server that refuses a large body may close before all of it was sent: what it answered stands in the reply.
        let _ = stream.write_all((text + "\r\n" + body).as_bytes());
        let mut reply = Vec::new();
        let _ = stream.read_to_end(&mut reply);
        let reply = String::from_utf8_lossy(&reply).into_owned();
        let status = reply.split(' ').nth(1).and_then(|s| s.parse().ok()).unwrap_or(0);
        (status, reply)
    }

    pub(crate) fn post(&self, path: &str, body: &str) -> (u16, String) {
        self.ask("POST", path, body, &[])
    }

    pub(crate) fn state(&self, token: &str) -> Value {
        let (status, reply) = self.ask("GET", &format!("/api/{token}"), "", &[]);
        assert_eq!(status, 200, "{reply}");
        serde_json::from_str(reply.split("\r\n\r\n").nth(1).unwrap()).unwrap()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // As `kill -9`: nothing is told to end.
        self.runtime.take().unwrap().shutdown_background();
    }
}

pub(crate) const TAB: &str = "00112233445566778899aabbccddeeff";

/// The study's folder, its server, and the link of somebody who was let in.
pub(crate) fn one_person() -> (tempfile::TempDir, Server, String) {
    let folder = folder();
    let server = Server::open(folder.path());
    let token = opened(&server);
    (folder, server, token)
}

/// The cookie of who gave the password of the experimenter's page.
pub(crate) fn entered(server: &Server) -> String {
    let (_, reply) = server.post("/lab/enter", "password=open+%26+see");
    let cookie = reply.lines().find_map(|l| l.strip_prefix("set-cookie: "));
    cookie.unwrap().split(';').next().unwrap().to_owned()
}

/// A text has every one of these words.
#[track_caller]
pub(crate) fn tells(text: &str, words: &[&str]) {
    for word in words {
        assert!(text.contains(word), "no `{word}` in: {text}");
    }
}

/// A reply has this status and these words.
#[track_caller]
pub(crate) fn replies((status, reply): (u16, String), expected: u16, words: &str) {
    assert!(status == expected && reply.contains(words), "{status}, no `{words}` in: {reply}");
}

/// As [`Server::post`], with the password of the experimenter's page.
pub(crate) fn lab_post(server: &Server, path: &str, body: &str) -> (u16, String) {
    server.ask("POST", path, body, &[("Cookie", &entered(server))])
}

/// What the experimenter's page says.
pub(crate) fn lab(server: &Server) -> String {
    let cookie = entered(server);
    server.ask("GET", "/lab", "", &[("Cookie", &cookie)]).1
}

pub(crate) fn opened(server: &Server) -> String {
    let token = server.seat.let_in().unwrap();
    assert_eq!(server.post(&format!("/api/{token}/open/{TAB}"), "null").0, 200);
    token
}
