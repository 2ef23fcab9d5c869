//! A drive under way in the seat: stepped, and everything written down that it needs to be driven again.

use crate::{
    digest::Digest,
    error::SeatPageError,
    input::Input,
    record::{Asked, Chunk, End, Event, Frames, Header, Held},
};
use maveric_domain::{DrivenBy, Embedding};
use maveric_simulator::{ControllerSettings, Driver, Planner, Rollout, Scenario, Session};

/// A drive by a person, or a ride, one step of 0.01 s at a time.
///
/// # Example
/// ```
/// # use maveric_seat_page::{Input, SeatDrive, Signal, replay, Record};
/// # use maveric_domain::{DrivenBy, Seconds};
/// # use maveric_simulator::{Hands, Scenario};
/// let scenario = Scenario::paper().with_duration(Seconds(5.0))?;
/// let mut drive = SeatDrive::by_hand(&scenario, 7, DrivenBy::Scripted)?;
/// let foot_down = Input::new(Hands { throttle: 0.5, ..Hands::default() }, Signal::Off);
/// while drive.tick(foot_down) {}
/// let mut record = drive.begun();
/// record.chunks.push(drive.chunk(Default::default()));
/// let driven = drive.finish()?;
/// record.end = Some(driven.end);
/// assert!(replay(&record)?.same());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct SeatDrive<'a> {
    session: Session<'a>,
    header: Header,
    tick: u64,
    sent: u64,
    held: Vec<Held>,
    asked: Vec<Asked>,
    events: Vec<Event>,
    digest: Digest,
    rows: usize,
    input: Input,
}

/// A drive that is over.
#[derive(Debug)]
pub struct Driven {
    pub rollout: Rollout,
    /// The last line of its record.
    pub end: End,
}

impl<'a> SeatDrive<'a> {
    /// Puts a person, or a script, at the wheel.
    ///
    /// # Errors
    /// [`SeatPageError::Simulator`] if the scenario cannot be driven, [`SeatPageError::Record`] if `driven_by` is no one with hands.
    pub fn by_hand(
        scenario: &'a Scenario,
        seed: u64,
        driven_by: DrivenBy,
    ) -> Result<Self, SeatPageError> {
        if !matches!(driven_by, DrivenBy::Human | DrivenBy::Scripted) {
            let driver = driven_by.as_str();
            return Err(SeatPageError::Record {
                problem: format!("driven by `{driver}` with hands, expected human or scripted"),
            });
        }
        let session = Session::new(scenario, Driver::Hands, seed)?;
        Ok(Self::new(session, scenario, seed, driven_by, None))
    }

    /// Shows a drive by hand again, as a ride: [`SeatDrive::tick`] is given its inputs.
    ///
    /// # Errors
    /// [`SeatPageError::Simulator`] if the scenario cannot be driven.
    pub fn shown(scenario: &'a Scenario, seed: u64) -> Result<Self, SeatPageError> {
        let session = Session::new(scenario, Driver::Hands, seed)?;
        Ok(Self::new(session, scenario, seed, DrivenBy::Automated, None))
    }

    /// Lets `planner` drive.
    ///
    /// # Errors
    /// [`SeatPageError::Simulator`] if the scenario cannot be driven or the controllers' settings are out of range.
    pub fn ride(
        scenario: &'a Scenario,
        seed: u64,
        planner: &'a mut dyn Planner,
        controllers: &'a ControllerSettings,
    ) -> Result<Self, SeatPageError> {
        let session = Session::new(scenario, Driver::Automated(planner, controllers), seed)?;
        let kept = Some(controllers.clone());
        Ok(Self::new(session, scenario, seed, DrivenBy::Automated, kept))
    }

    fn new(
        session: Session<'a>,
        scenario: &Scenario,
        seed: u64,
        driven_by: DrivenBy,
        controllers: Option<ControllerSettings>,
    ) -> Self {
        Self {
            session,
            header: Header {
                maveric_seat_drive: Header::VERSION,
                driven_by,
                seed,
                scenario: scenario.clone(),
                controllers,
                style: None,
            },
            tick: 0,
            sent: 0,
            held: Vec::new(),
            asked: Vec::new(),
            events: Vec::new(),
            digest: Digest::default(),
            rows: 0,
            input: Input::default(),
        }
    }

    /// Writes down in which style a ride begins.
    #[must_use]
    pub fn in_style(mut self, style: Embedding) -> Self {
        self.header.style = Some(style);
        self
    }

    /// The record so far: its first line.
    pub fn begun(&self) -> crate::record::Record {
        crate::record::Record { header: self.header.clone(), chunks: Vec::new(), end: None }
    }

    pub fn session(&self) -> &Session<'a> {
        &self.session
    }

    pub fn ticks(&self) -> u64 {
        self.tick
    }

    /// The input of the last step.
    pub fn input(&self) -> Input {
        self.input
    }

    /// Drives one step on; false, and nothing done, once the drive is over. In a ride by a planner the input is not looked at.
    pub fn tick(&mut self, input: Input) -> bool {
        if !self.session.tick(input.hands()) {
            return false;
        }
        self.tick += 1;
        self.input = input;
        if self.header.holds_inputs() {
            match self.held.last_mut() {
                Some(last) if last.input == input => last.steps += 1,
                _ => self.held.push(Held { steps: 1, input }),
            }
        } else {
            self.note_asked();
        }
        let car = self.session.car();
        for number in [car.x_m, car.y_m, car.heading_rad, car.speed_mps] {
            self.digest.add(number);
        }
        let scene = self.session.scene();
        for vehicle in &scene.vehicles {
            for number in [vehicle.x_m, vehicle.y_m, vehicle.speed_mps] {
                self.digest.add(number);
            }
        }
        true
    }

    fn note_asked(&mut self) {
        // A row has begun if it was decided on since.
        let Some(decided) = self.session.decided() else {
            return;
        };
        let row = (decided.time_s * maveric_simulator::PLANNING_RATE_HZ).round() as usize + 1;
        if row <= self.rows {
            return;
        }
        self.rows = row;
        match self.asked.last_mut() {
            Some(last) if last.setpoints == decided.asked => last.rows += 1,
            _ => self.asked.push(Asked { rows: 1, setpoints: decided.asked }),
        }
    }

    /// Writes down something that the person did beside driving.
    pub fn note(&mut self, what: &str, points: Option<f64>) {
        self.events.push(Event {
            tick: self.tick,
            what: what.to_owned(),
            points: points.filter(|p| p.is_finite()),
        });
    }

    /// What was given since the last piece.
    pub fn chunk(&mut self, frames: Frames) -> Chunk {
        let chunk = Chunk {
            from_tick: self.sent,
            ticks: self.tick - self.sent,
            held: std::mem::take(&mut self.held),
            asked: std::mem::take(&mut self.asked),
            events: std::mem::take(&mut self.events),
            frames,
        };
        self.sent = self.tick;
        chunk
    }

    /// Ends the drive.
    ///
    /// # Errors
    /// [`SeatPageError::Simulator`] if fewer than two rows were driven.
    pub fn finish(self) -> Result<Driven, SeatPageError> {
        let end = End { end_tick: self.tick, states: self.digest.to_string() };
        let rollout = self.session.finish()?;
        Ok(Driven { rollout, end })
    }
}
