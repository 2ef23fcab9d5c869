//! Somebody who goes through a study without a browser.

use super::made::model;
use super::{Server, TAB};
use maveric_domain::{DrivenBy, Embedding, Seconds};
use maveric_model::Model;
use maveric_seat_page::{Frames, Keyboard, Keys, Record, RideStyle, Rider, SeatDrive, Signal, fit};
use maveric_simulator::Scenario;
use serde_json::{Value, json};
use std::rc::Rc;

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

/// The number from 0 of the step that somebody is at, and the step.
pub(crate) fn here(server: &Server, token: &str) -> (u64, Value) {
    let state = server.state(token);
    let at = state["at"].as_u64().unwrap();
    (at, state["steps"][at as usize].clone())
}

/// Goes on until the step has this number.
pub(crate) fn up_to(server: &Server, token: &str, number: u64) {
    while server.state(token)["at"].as_u64().unwrap() < number {
        assert!(go_on(server, token));
    }
}

/// Goes on until the step is of this kind; its number from 0, and the step.
pub(crate) fn until(server: &Server, token: &str, kind: &str) -> (u64, Value) {
    loop {
        let (at, step) = here(server, token);
        if step["kind"] == kind {
            return (at, step);
        }
        assert!(go_on(server, token), "no step is {kind}");
    }
}

/// Goes on to the end.
pub(crate) fn finish(server: &Server, token: &str) {
    while go_on(server, token) {}
    assert_eq!(server.state(token)["ended"], "done");
}

/// Lines of a drive, as a page sends them.
pub(crate) fn piece(lines: &[String]) -> String {
    lines.join("\n") + "\n"
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
        let points = step["points"].as_f64().unwrap_or(0.0);
        let style = serde_json::from_value(step["style"].clone()).unwrap_or(RideStyle::Own);
        let mut rider = Rider::new(Rc::clone(&self.model), own, (style, points), settings).unwrap();
        let controllers = rider.controllers();
        let begins_with = rider.begins_with();
        let mut shown = state["own"].as_str().map(|lines| {
            let record = Record::from_lines(lines).unwrap();
            let inputs = record.held().flat_map(|held| vec![held.input; held.steps as usize]);
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
            let stops = self.stops.filter(|(tick, _)| !by_hand && drive.ticks() == *tick);
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
                let chunk = drive.chunk(Frames { drawn: 60, ..Frames::default() });
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
            return Keys { faster: drive.ticks() < 600, ..Keys::default() };
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
                let mut sheet = json!({"agreed": true, "seconds": 4.5});
                if step["lend"].is_string() {
                    sheet["style_lent"] = true.into();
                }
                sent(format!("/api/{token}/answer/{at}"), &sheet.to_string());
            }
            "break" => {
                let rested = json!({"seconds": step["at_least_s"]});
                sent(format!("/api/{token}/answer/{at}"), &rested.to_string());
            }
            "elsewhere" => sent(format!("/api/{token}/answer/{at}"), "{\"seconds\":300}"),
            "screen" | "computer" => {
                sent(format!("/api/{token}/answer/{at}"), r#"{"refused":null,"seconds":4.5}"#);
            }
            "scale" => {
                let items = step["items"].as_array().unwrap().iter();
                let end = |item: &Value, key: &str| item[key].as_i64().unwrap();
                let answers: Vec<Option<i64>> = items
                    .enumerate()
                    .map(|(i, item)| (self.answers)(i, end(item, "min"), end(item, "max")))
                    .collect();
                let sheet = json!({"answers": answers, "seconds": 6});
                sent(format!("/api/{token}/answer/{at}"), &sheet.to_string());
            }
            "practice" | "drive" | "ride" => {
                let (lines, style) = self.driven(&step, &state);
                let attempt = state["attempts"].as_u64().unwrap() + 1;
                for part in lines.chunks(3) {
                    sent(format!("/api/{token}/drive/{at}/{attempt}/{TAB}"), &piece(part));
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
        (format!("probe:{}", probe["scale"].as_str().unwrap()), answer)
    })
}
