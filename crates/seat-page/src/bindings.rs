//! What a page's script calls; see `page/src` of the crate `seat` for the other side.
//!
//! A drive borrows its scenario and its rider, and what a script holds can borrow nothing: both are given away for the life of the page,
//! some kilobytes a drive, a handful of drives a page.

use crate::{
    drive::{Driven, SeatDrive},
    error::SeatPageError,
    input::{Input, Signal},
    keyboard::{Keyboard, Keys, Stick},
    practised::Practised,
    record::{Frames, Record},
    rider::Rider,
};
use maveric_domain::{DrivenBy, Embedding, Seconds};
use maveric_model::{Model, model_file, style_space::LinearHead};
use maveric_simulator::{ControllerSettings, LEFT_SHOULDER_M, RIGHT_SHOULDER_M, Scenario};
use std::{cell::Cell, rc::Rc};
use wasm_bindgen::prelude::wasm_bindgen;

fn text_of(error: impl std::fmt::Display) -> String {
    error.to_string()
}

fn scenario(json: &str, seconds: f64) -> Result<&'static Scenario, String> {
    let scenario: Scenario = serde_json::from_str(json).map_err(text_of)?;
    let scenario = scenario.with_duration(Seconds(seconds)).map_err(text_of)?;
    Ok(Box::leak(Box::new(scenario)))
}

fn signal(way: i8) -> Signal {
    Signal::try_from(way).unwrap_or_default()
}

/// A trained model.
#[wasm_bindgen]
pub struct PageModel(Rc<Model>);

#[wasm_bindgen]
impl PageModel {
    /// Reads a model file.
    #[wasm_bindgen(constructor)]
    pub fn new(bytes: &[u8]) -> Result<PageModel, String> {
        model_file::from_bytes(bytes).map(|m| Self(Rc::new(m))).map_err(text_of)
    }
}

/// The dial of a ride.
struct Dial {
    points: Rc<Cell<f64>>,
    own: Embedding,
    model: Rc<Model>,
}

/// A drive or a ride under way.
#[wasm_bindgen]
pub struct PageDrive {
    drive: SeatDrive<'static>,
    scenario: &'static Scenario,
    keyboard: Keyboard,
    practised: Practised,
    dial: Option<Dial>,
    driven_by: DrivenBy,
    /// What is shown again, the first last; empty where somebody drives, or a model.
    shown: Vec<Input>,
}

#[wasm_bindgen]
impl PageDrive {
    /// A person (`human`) or a script (`scripted`) at the wheel.
    pub fn by_hand(
        json: &str,
        seconds: f64,
        seed: &str,
        driven_by: &str,
    ) -> Result<PageDrive, String> {
        let scenario = scenario(json, seconds)?;
        let driven_by: DrivenBy = driven_by.parse().map_err(text_of)?;
        let drive = SeatDrive::by_hand(scenario, seed.parse().map_err(text_of)?, driven_by);
        Ok(Self {
            drive: drive.map_err(text_of)?,
            scenario,
            keyboard: Keyboard::new(scenario),
            practised: Practised::new(scenario),
            dial: None,
            driven_by,
            shown: Vec::new(),
        })
    }

    /// A drive by hand once more, as a ride: `lines` is its record.
    pub fn shown(json: &str, seconds: f64, seed: &str, lines: &str) -> Result<PageDrive, String> {
        let scenario = scenario(json, seconds)?;
        let record = Record::from_lines(lines).map_err(text_of)?;
        let given = record.held();
        let mut shown: Vec<Input> =
            given.flat_map(|held| std::iter::repeat_n(held.input, held.steps as usize)).collect();
        shown.reverse();
        let drive = SeatDrive::shown(scenario, seed.parse().map_err(text_of)?).map_err(text_of)?;
        Ok(Self {
            drive,
            scenario,
            keyboard: Keyboard::new(scenario),
            practised: Practised::new(scenario),
            dial: None,
            driven_by: DrivenBy::Automated,
            shown,
        })
    }

    /// A ride in a style (as a step has it, in JSON) of somebody whose own is `own` (empty: nothing was learned), at so many points on the dial.
    pub fn ride(
        json: &str,
        seconds: f64,
        seed: &str,
        model: &PageModel,
        own: Vec<f64>,
        style: &str,
        points: f64,
    ) -> Result<PageDrive, String> {
        let scenario = scenario(json, seconds)?;
        let given = &scenario.settings().controllers;
        let model = Rc::clone(&model.0);
        let embedding = if own.is_empty() {
            model.mean_embedding().clone()
        } else {
            Embedding::new(own).map_err(text_of)?
        };
        let style = (serde_json::from_str(style).map_err(text_of)?, points);
        let rider =
            Rider::new(Rc::clone(&model), embedding.clone(), style, given).map_err(text_of)?;
        let dial = Dial { points: rider.dial(), own: embedding, model };
        let controllers: &'static ControllerSettings = Box::leak(Box::new(rider.controllers()));
        let rider: &'static mut Rider = Box::leak(Box::new(rider));
        let seed = seed.parse().map_err(text_of)?;
        let style = rider.begins_with();
        let drive = SeatDrive::ride(scenario, seed, rider, controllers).map_err(text_of)?;
        let drive = drive.in_style(style);
        Ok(Self {
            drive,
            scenario,
            keyboard: Keyboard::new(scenario),
            practised: Practised::new(scenario),
            dial: Some(dial),
            driven_by: DrivenBy::Automated,
            shown: Vec::new(),
        })
    }

    /// First line of the record.
    pub fn header(&self) -> Result<String, String> {
        serde_json::to_string(&self.drive.begun().header).map_err(text_of)
    }

    /// Drives so many steps by keys: bits 1 left, 2 right, 4 faster, 8 slower, 16 emergency brake. False once it is over.
    pub fn keys(&mut self, down: u8, way: i8, steps: u32) -> bool {
        let keys = Keys {
            left: down & 1 != 0,
            right: down & 2 != 0,
            faster: down & 4 != 0,
            slower: down & 8 != 0,
            emergency: down & 16 != 0,
        };
        self.drive_on(steps, |keyboard, speed| keyboard.input(keys, signal(way), speed))
    }

    /// Drives so many steps by a gamepad's stick and triggers.
    pub fn pad(&mut self, steering: f64, throttle: f64, brake: f64, way: i8, steps: u32) -> bool {
        let stick = Stick { steering, throttle, brake };
        self.drive_on(steps, |keyboard, speed| keyboard.pad(stick, signal(way), speed))
    }

    /// Drives so many steps by a wheel turned so far (rad, left positive) and pedals.
    pub fn wheel(
        &mut self,
        turned_rad: f64,
        throttle: f64,
        brake: f64,
        way: i8,
        steps: u32,
    ) -> bool {
        let pedals = Stick { steering: 0.0, throttle, brake };
        self.drive_on(steps, |keyboard, _| keyboard.wheel(turned_rad, pedals, signal(way)))
    }

    /// Rides so many steps. What is shown again is over where it was.
    pub fn rides(&mut self, steps: u32) -> bool {
        if self.dial.is_some() {
            return self.drive_on(steps, |_, _| Input::default());
        }
        let mut shown = std::mem::take(&mut self.shown);
        let there = steps.min(u32::try_from(shown.len()).unwrap_or(u32::MAX));
        let goes_on = self.drive_on(there, |_, _| shown.pop().unwrap_or_default());
        self.shown = shown;
        goes_on && there == steps
    }

    fn drive_on(&mut self, steps: u32, mut input: impl FnMut(&mut Keyboard, f64) -> Input) -> bool {
        (0..steps).all(|_| {
            let speed_mps = self.drive.session().car().speed_mps;
            let input = input(&mut self.keyboard, speed_mps);
            let goes_on = self.drive.tick(input);
            if goes_on {
                self.practised.look(&self.drive);
            }
            goes_on
        })
    }

    /// What can be seen: time since the row, row time, x, y, heading, speed, wheel angle, collisions, barrier touches, ego's lane, the lane a
    /// change came from (-1: none), turn signal, throttle, brake; then id, x, y, speed of each vehicle at the row's time.
    pub fn seen(&self) -> Vec<f64> {
        let session = self.drive.session();
        let (car, scene) = (session.car(), session.scene());
        let (collisions, touches) = session.contacts();
        let (lane, from) = session.lane();
        let input = self.drive.input();
        let mut seen = vec![
            car.since_row_s,
            scene.time_s,
            car.x_m,
            car.y_m,
            car.heading_rad,
            car.speed_mps,
            car.steering_rad,
            f64::from(collisions),
            f64::from(touches),
            f64::from(lane),
            from.map_or(-1.0, f64::from),
            f64::from(i8::from(input.signal)),
            input.hands().throttle,
            input.hands().brake,
        ];
        for v in &scene.vehicles {
            seen.extend([f64::from(v.id.0), v.x_m, v.y_m, v.speed_mps]);
        }
        seen
    }

    /// What was practised until now: time for which a lane was kept (s), vehicles passed.
    pub fn practised(&self) -> Vec<f64> {
        vec![self.practised.kept_s(), f64::from(self.practised.passes())]
    }

    /// Where places of the road lie on the map: for each (x, y) given, (x, y, heading).
    pub fn places(&self, road: &[f64]) -> Vec<f64> {
        let line = self.scenario.centre_line();
        let places = road.chunks_exact(2).flat_map(|at| {
            let pose = line.map_pose(at[0], at[1]);
            [pose.x_m, pose.y_m, pose.heading_rad]
        });
        places.collect()
    }

    /// Lanes, their width, posted speed (m/s), the shoulders right and left, length and width of the cars, duration (s).
    pub fn road(&self) -> Vec<f64> {
        let (road, settings) = (self.scenario.road(), self.scenario.settings());
        vec![
            f64::from(road.lanes),
            road.lane_width_m,
            road.posted_speed_mps,
            RIGHT_SHOULDER_M,
            LEFT_SHOULDER_M,
            settings.vehicle.length_m,
            settings.vehicle.width_m,
            settings.duration_s,
        ]
    }

    /// Steps driven.
    pub fn ticks(&self) -> f64 {
        self.drive.ticks() as f64
    }

    /// Turns the dial of a ride to so many points from the person's own style, as far as it goes: gives where it is now.
    pub fn turn(&mut self, points: f64) -> Result<f64, String> {
        let Some(dial) = &self.dial else {
            return Err("nothing is ridden here".to_owned());
        };
        let head = LinearHead::aggression(&dial.model).map_err(text_of)?;
        let moved = head.shift(&dial.own, points).map_err(text_of)?;
        let now = moved.effective_points;
        dial.points.set(now);
        self.drive.note("dial", Some(now));
        Ok(now)
    }

    /// Writes something down, with a number where it has one.
    pub fn note(&mut self, what: &str, number: Option<f64>) {
        self.drive.note(what, number);
    }

    /// The piece of the record since the last, as a line; `frames` as in [`Frames`]: drawn, late, left out, longest, input.
    pub fn chunk(&mut self, frames: &[u32]) -> Result<String, String> {
        let &[drawn, late, dropped_steps, longest_ms, input_ms] = frames else {
            return Err(format!("{} numbers of pictures, expected 5", frames.len()));
        };
        let frames = Frames { drawn, late, dropped_steps, longest_ms, input_ms };
        serde_json::to_string(&self.drive.chunk(frames)).map_err(text_of)
    }

    /// Ends the drive.
    pub fn finish(self) -> Result<PageDriven, String> {
        let driven_by = self.driven_by;
        let driven = self.drive.finish().map_err(text_of)?;
        Ok(PageDriven { driven, driven_by })
    }
}

/// A drive that is over.
#[wasm_bindgen]
pub struct PageDriven {
    driven: Driven,
    driven_by: DrivenBy,
}

#[wasm_bindgen]
impl PageDriven {
    /// Last line of the record.
    pub fn end(&self) -> Result<String, String> {
        serde_json::to_string(&self.driven.end).map_err(text_of)
    }

    /// Learns a style from it: a [`Fit`](crate::Fit) as JSON.
    pub fn fit(&self, model: &PageModel) -> Result<String, String> {
        let fit = crate::fit(&model.0, &self.driven.rollout.recording, self.driven_by);
        serde_json::to_string(&fit.map_err(text_of)?).map_err(text_of)
    }
}

/// Drives the record in `lines` again: `{"same": …, "end_tick": …, "states": …}`.
#[wasm_bindgen]
#[expect(unreachable_pub, reason = "the page calls it")]
pub fn replay(lines: &str) -> Result<String, String> {
    let again = |lines| -> Result<_, SeatPageError> { crate::replay(&Record::from_lines(lines)?) };
    let replayed = again(lines).map_err(text_of)?;
    let end = serde_json::json!({
        "same": replayed.same(),
        "end_tick": replayed.end.end_tick,
        "states": replayed.end.states,
    });
    Ok(end.to_string())
}
