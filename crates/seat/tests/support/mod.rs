//! A study in a folder, a server for it, and somebody who goes through it without a browser.

#![allow(dead_code, reason = "each test file takes what it needs")]
#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

#[path = "../../../seat-page/tests/support/mod.rs"]
mod made;

use made::model;
use maveric_domain::{DrivenBy, Embedding, Seconds};
use maveric_model::{Model, model_file};
use maveric_seat::{Seat, SeatSettings, Wire, files, serve};
use maveric_seat_page::{Frames, Keyboard, Keys, Record, RideStyle, Rider, SeatDrive, Signal, fit};
use maveric_simulator::Scenario;
use maveric_study::{DesignFile, run_folder::read_scales};
use serde_json::Value;
use std::{
    fs,
    io::{Read as _, Write as _},
    net::{SocketAddr, TcpStream},
    path::Path,
    rc::Rc,
    sync::Arc,
};

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
        stretch: 1.0,
        files,
        password: Some("open & see".to_owned()),
        design: study.design,
    }
}

/// The seat of the study in a folder.
pub(crate) fn seat(folder: &Path) -> Seat {
    Seat::open(&folder.join("seat/seat.db"), settings(folder)).unwrap()
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
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(2)
            .enable_all()
            .build()
            .unwrap();
        let any = SocketAddr::from(([127, 0, 0, 1], 0));
        let serving = runtime
            .block_on(serve(Arc::clone(&seat), any, Wire::Here, tell))
            .unwrap();
        let address = serving.address;
        runtime.spawn(serving.forever());
        Self {
            runtime: Some(runtime),
            seat,
            address,
        }
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
        all.extend(
            headers
                .iter()
                .map(|(name, value)| (*name, (*value).to_owned())),
        );
        all.retain(|(name, value)| !(name == &"Origin" && value.is_empty()));
        let mut text = format!(
            "{method} {path} HTTP/1.1\r\nContent-Length: {}\r\n",
            body.len()
        );
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
        let status = reply
            .split(' ')
            .nth(1)
            .and_then(|s| s.parse().ok())
            .unwrap_or(0);
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

/// Somebody at the wheel without hands, and what they answer.
pub(crate) struct Script {
    /// What learns of them and drives them.
    pub(crate) model: Rc<Model>,
    /// Their style; none: as it was learned.
    pub(crate) own: Option<Embedding>,
    /// How fast they drive, in m/s; none: the foot down for six seconds.
    pub(crate) speed: Option<f64>,
    /// After how many steps of a ride they stop, and why.
    pub(crate) stops: Option<(u64, &'static str)>,
    /// What they answer to the item of this number, of a scale from the lowest answer to the highest.
    pub(crate) answers: fn(usize, i64, i64) -> Option<i64>,
}

impl Default for Script {
    fn default() -> Self {
        Self {
            model: Rc::new(model()),
            own: None,
            speed: None,
            stops: None,
            answers: |item, _, _| (item == 0).then_some(4),
        }
    }
}

/// The lines of a drive of `step`, a line a second, and what it was learned as.
pub(crate) fn driven(step: &Value) -> (Vec<String>, Option<String>) {
    Script::default().driven(step, &Value::Null)
}

/// Does the step that the person is at; false once there is none.
pub(crate) fn go_on(server: &Server, token: &str) -> bool {
    Script::default().go_on(server, token)
}

impl Script {
    /// As [`driven`], of somebody in this state.
    pub(crate) fn driven(&self, step: &Value, state: &Value) -> (Vec<String>, Option<String>) {
        let seconds = step["seconds"].as_f64().unwrap();
        let seed: u64 = step["seed"].as_str().unwrap().parse().unwrap();
        let scenario = Scenario::paper().with_duration(Seconds(seconds)).unwrap();
        let settings = &scenario.settings().controllers;
        let by_hand = step["kind"] != "ride";
        let mean = || self.model.mean_embedding().clone();
        let own = self.own.clone().unwrap_or_else(|| {
            serde_json::from_value(state["fit"]["embedding"].clone()).unwrap_or_else(|_| mean())
        });
        let stretch = step["stretch"].as_f64().unwrap_or(1.0);
        let points = step["points"].as_f64().unwrap_or(0.0) * stretch;
        let style = serde_json::from_value(step["style"].clone()).unwrap_or(RideStyle::Own);
        let mut rider = Rider::new(Rc::clone(&self.model), own, (style, points), settings).unwrap();
        let controllers = rider.controllers();
        let begins_with = rider.begins_with();
        let mut shown = state["own"].as_str().map(|lines| {
            let record = Record::from_lines(lines).unwrap();
            let inputs = record
                .held()
                .flat_map(|held| vec![held.input; held.steps as usize]);
            inputs.collect::<Vec<_>>().into_iter()
        });
        let mut drive = if shown.is_some() {
            SeatDrive::shown(&scenario, seed).unwrap()
        } else if by_hand {
            SeatDrive::by_hand(&scenario, seed, DrivenBy::Scripted).unwrap()
        } else {
            let ride = SeatDrive::ride(&scenario, seed, &mut rider, &controllers).unwrap();
            ride.in_style(begins_with)
        };
        let mut keyboard = Keyboard::new(&scenario);
        let mut lines = vec![serde_json::to_string(&drive.begun().header).unwrap()];
        loop {
            if !by_hand && drive.ticks() == 300 && step["turns"].is_number() {
                drive.note("dial", Some(5.0));
            }
            if let Some((what, answer)) = probed(&step["probe"], drive.ticks()) {
                drive.note(&what, answer);
            }
            let stops = self
                .stops
                .filter(|(tick, _)| !by_hand && drive.ticks() == *tick);
            if let Some((_, reason)) = stops {
                drive.note(&format!("stopped: {reason}"), None);
            }
            let now = drive.session().car().speed_mps;
            let input = if by_hand {
                keyboard.input(self.keys(&drive), Signal::Off, now)
            } else {
                let again = shown.as_mut().and_then(Iterator::next);
                again.unwrap_or_default()
            };
            let goes_on = drive.tick(input) && stops.is_none();
            if !goes_on || drive.ticks().is_multiple_of(100) {
                let chunk = drive.chunk(Frames {
                    drawn: 60,
                    ..Frames::default()
                });
                if chunk.ticks > 0 {
                    lines.push(serde_json::to_string(&chunk).unwrap());
                }
            }
            if !goes_on {
                break;
            }
        }
        let driven = drive.finish().unwrap();
        lines.push(serde_json::to_string(&driven.end).unwrap());
        let style = (step["kind"] == "drive").then(|| {
            let recording = &driven.rollout.recording;
            let fit = fit(&self.model, recording, DrivenBy::Scripted).unwrap();
            serde_json::to_string(&fit).unwrap()
        });
        (lines, style)
    }

    /// The keys that are down: in the middle of the right lane at the speed, behind whoever is slower.
    fn keys(&self, drive: &SeatDrive<'_>) -> Keys {
        let Some(wanted) = self.speed else {
            return Keys {
                faster: drive.ticks() < 600,
                ..Keys::default()
            };
        };
        let (car, scene) = (drive.session().car(), drive.session().scene());
        let ahead = scene.vehicles.iter().filter(|v| {
            let gap_m = v.x_m - car.x_m;
            (v.y_m - car.y_m).abs() < 2.0 && gap_m > 0.0 && gap_m < 6.0 + 1.5 * car.speed_mps
        });
        let wanted = ahead.map(|v| v.speed_mps - 1.0).fold(wanted, f64::min);
        let off_m = car.y_m + 1.2 * car.heading_rad * car.speed_mps;
        Keys {
            left: off_m < -0.25,
            right: off_m > 0.25,
            faster: car.speed_mps < wanted - 0.3,
            slower: car.speed_mps > wanted + 0.3,
            emergency: false,
        }
    }

    /// As [`go_on`].
    pub(crate) fn go_on(&self, server: &Server, token: &str) -> bool {
        let mut state = server.state(token);
        let at = state["at"].as_u64().unwrap();
        let Some(step) = state["steps"].get(at as usize).cloned() else {
            return false;
        };
        if step["style"] == "replay" {
            let (_, reply) = server.ask("GET", &format!("/api/{token}/own"), "", &[]);
            state["own"] = reply.split("\r\n\r\n").nth(1).unwrap().into();
        }
        let sent = |path: String, body: &str| {
            let (status, reply) = server.post(&path, body);
            assert_eq!(status, 200, "{path}: {reply}");
        };
        match step["kind"].as_str().unwrap() {
            "text" if step["agree"] == true => {
                let mut sheet = serde_json::json!({"agreed": true, "seconds": 4.5});
                if step["lend"].is_string() {
                    sheet["style_lent"] = true.into();
                }
                sent(format!("/api/{token}/answer/{at}"), &sheet.to_string());
            }
            "break" => {
                let rested = serde_json::json!({"seconds": step["at_least_s"]});
                sent(format!("/api/{token}/answer/{at}"), &rested.to_string());
            }
            "elsewhere" => sent(format!("/api/{token}/answer/{at}"), "{\"seconds\":300}"),
            "screen" | "computer" => sent(
                format!("/api/{token}/answer/{at}"),
                r#"{"refused":null,"seconds":4.5}"#,
            ),
            "scale" => {
                let items = step["items"].as_array().unwrap().iter();
                let end = |item: &Value, key: &str| item[key].as_i64().unwrap();
                let answers: Vec<Option<i64>> = items
                    .enumerate()
                    .map(|(i, item)| (self.answers)(i, end(item, "min"), end(item, "max")))
                    .collect();
                let sheet = serde_json::json!({"answers": answers, "seconds": 6});
                sent(format!("/api/{token}/answer/{at}"), &sheet.to_string());
            }
            "practice" | "drive" | "ride" => {
                let (lines, style) = self.driven(&step, &state);
                let attempt = state["attempts"].as_u64().unwrap() + 1;
                for part in lines.chunks(3) {
                    sent(
                        format!("/api/{token}/drive/{at}/{attempt}/{TAB}"),
                        &(part.join("\n") + "\n"),
                    );
                }
                // Nothing is learned of a further session's drive.
                if let Some(style) = style.filter(|_| step["session"].is_null()) {
                    sent(format!("/api/{token}/fit"), &style);
                }
                sent(format!("/api/{token}/done/{at}"), "null");
            }
            _ => sent(format!("/api/{token}/done/{at}"), "null"),
        }
        true
    }
}

/// What a script answers to a probe, two seconds after it was asked: its number, but for every second one, which it lets pass.
fn probed(probe: &Value, ticks: u64) -> Option<(String, Option<f64>)> {
    let every = (probe["every_s"].as_f64()? * 100.0) as u64;
    let number = ticks / every;
    (number > 0 && ticks % every == 200).then(|| {
        let answer = (number % 2 == 1).then_some(number as f64);
        (
            format!("probe:{}", probe["scale"].as_str().unwrap()),
            answer,
        )
    })
}

/// The cookie of who gave the password of the experimenter's page.
pub(crate) fn entered(server: &Server) -> String {
    let (_, reply) = server.post("/lab/enter", "password=open+%26+see");
    let cookie = reply.lines().find_map(|l| l.strip_prefix("set-cookie: "));
    cookie.unwrap().split(';').next().unwrap().to_owned()
}

pub(crate) fn opened(server: &Server) -> String {
    let token = server.seat.let_in().unwrap();
    assert_eq!(
        server.post(&format!("/api/{token}/open/{TAB}"), "null").0,
        200
    );
    token
}
