//! What the seat is: a study's steps for each person, and where everything is kept.

use crate::{
    error::SeatError,
    files::Files,
    parts::Carried,
    person::Person,
    steps::{self, Step, Texts},
    store::Store,
    token,
};
use maveric_domain::{
    Design, Scale,
    design::{ProtocolStep, SpeedUnit, williams_rows},
    stream_seed,
};
use maveric_model::{Model, model_file, style_space::LinearHead};
use maveric_simulator::Scenario;
use std::{
    path::Path,
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
};

/// What a seat is opened with.
pub struct SeatSettings {
    /// The study.
    pub design: Design,
    /// Its scales.
    pub scales: Vec<Scale>,
    /// Its texts.
    pub texts: Texts,
    /// Its world.
    pub scenario: Scenario,
    /// The model that rides, as in its file; none in a phase in which people only drive by hand.
    pub model: Option<Vec<u8>>,
    /// Whether it learned from made-up people.
    pub made_up_model: bool,
    /// Points of the model for one point of the study's style.
    pub stretch: f64,
    /// Where logs and answers are written.
    pub files: Files,
    /// The password of the experimenter's page; none for no such page.
    pub password: Option<String>,
}

/// A seat that is open.
pub struct Seat {
    pub(crate) settings: SeatSettings,
    pub(crate) store: Store,
    pub(crate) scenario_json: String,
    pub(crate) model: Option<Model>,
    /// Whether the experimenter has closed it.
    stopping: AtomicBool,
    /// One at a time lets people in, so that each has an id and a place in the square of their own.
    door: Mutex<()>,
    /// How often the files were asked for, and which asking the last writing answered.
    asked: AtomicU64,
    written: Mutex<u64>,
}

fn held<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    // What is guarded is written in one go, or made anew.
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Seat {
    /// Opens a seat whose state is kept in `path`.
    ///
    /// # Errors
    /// [`SeatError::Store`] if the file cannot be opened; [`SeatError::Model`] for a model that is none; [`SeatError::Protocol`] if the
    /// study cannot be run in the seat; [`SeatError::Study`] if its tables cannot be read.
    pub fn open(path: &Path, settings: SeatSettings) -> Result<Self, SeatError> {
        let model = settings.model.as_deref().map(model_file::from_bytes);
        let seat = Self {
            store: Store::open(path)?,
            scenario_json: serde_json::to_string(&settings.scenario).map_err(|e| {
                SeatError::Protocol {
                    problem: format!("the scenario cannot be written: {e}"),
                    help: None,
                }
            })?,
            model: model.transpose()?,
            settings,
            stopping: AtomicBool::new(false),
            door: Mutex::new(()),
            asked: AtomicU64::new(0),
            written: Mutex::new(0),
        };
        seat.check()?;
        // What a killed seat had promised to take away.
        for person in seat.store.everybody()?.iter().filter(|p| !p.kept()) {
            seat.settings.files.forget(&person.participant)?;
        }
        // What a killed seat had taken in and not written yet.
        seat.write_files()?;
        Ok(seat)
    }

    /// Closes the seat: whoever serves it ends.
    pub(crate) fn stop(&self) {
        self.stopping.store(true, Ordering::Relaxed);
    }

    /// Whether it was closed.
    pub(crate) fn stopping(&self) -> bool {
        self.stopping.load(Ordering::Relaxed)
    }

    /// Whether people ride, or drive by hand alone so that a model can learn from them.
    pub fn rides(&self) -> bool {
        self.model.is_some() && self.asks(ProtocolStep::Rides)
    }

    fn asks(&self, step: ProtocolStep) -> bool {
        self.settings.design.protocol().steps.contains(&step)
    }

    fn check(&self) -> Result<(), SeatError> {
        let refused = |problem: &str, help: &str| {
            Err(SeatError::Protocol {
                problem: problem.to_owned(),
                help: Some(help.to_owned()),
            })
        };
        let steps = self.steps_of("P001", 0)?;
        let learns_itself = self.settings.design.people().learn.is_some();
        if self.asks(ProtocolStep::Rides) && self.model.is_none() && !learns_itself {
            return refused(
                "the study has rides and no model that could drive them",
                "name one in [model], or say in [people] learn who is learned from first",
            );
        }
        let turned = |step: &Step| match step {
            Step::Ride { points, turns, .. } => points.abs() > 0.0 || turns.is_some(),
            _ => false,
        };
        let dial = self.model.as_ref().map(LinearHead::aggression);
        if let Some(Err(error)) = dial
            && steps.iter().any(turned)
        {
            return refused(
                &format!("a condition turns the dial, and the model has none: {error}"),
                "learn a model from people who answered the scale of [style]",
            );
        }
        Ok(())
    }

    fn steps_of(&self, participant: &str, index: usize) -> Result<Vec<Step>, SeatError> {
        let root = self.settings.design.protocol().seed;
        let world = |what: &str| stream_seed(root, &[participant, what, "world"]).to_string();
        self.steps_in(index, &world)
    }

    /// The steps in the row `index` of the square, each in the world that `world` gives it.
    pub(crate) fn steps_in(
        &self,
        index: usize,
        world: &dyn Fn(&str) -> String,
    ) -> Result<Vec<Step>, SeatError> {
        let s = &self.settings;
        let rides = self.rides().then_some((index, s.stretch));
        steps::of_design(&s.design, &s.scales, &s.texts, world, rides)
    }

    /// Rows of the square; one while nobody rides.
    pub(crate) fn orders(&self) -> usize {
        if self.rides() {
            williams_rows(self.settings.design.conditions().len()).max(1)
        } else {
            1
        }
    }

    /// The next id that nobody has, here or in the study's table of people.
    fn next_id(&self, here: &[Person]) -> Result<String, SeatError> {
        let elsewhere = self.settings.files.people()?;
        let taken =
            |id: &String| elsewhere.contains(id) || here.iter().any(|p| p.participant == *id);
        let mut ids = (here.len() + 1..).map(|number| format!("P{number:03}"));
        Ok(ids.find(|id| !taken(id)).unwrap_or_default())
    }

    /// Lets in somebody who took part elsewhere, with all that they gave, or not at all.
    pub(crate) fn take_in(
        &self,
        token: &str,
        steps: &[Step],
        given: &Carried,
    ) -> Result<Person, SeatError> {
        let _alone = held(&self.door);
        let person = Person {
            token: token.to_owned(),
            participant: self.next_id(&self.store.everybody()?)?,
            steps: steps.to_vec(),
            at: steps.len(),
            ended: Some(given.ended.clone()),
            fit: given.style.clone(),
        };
        self.store.take_in(&person, given)?;
        Ok(person)
    }

    /// Lets the next person in: their token. The id is the next that nobody has, here or in the study's table of people.
    ///
    /// # Errors
    /// [`SeatError::Store`], [`SeatError::Random`]; [`SeatError::Study`] if the table cannot be read.
    pub fn let_in(&self) -> Result<String, SeatError> {
        let _alone = held(&self.door);
        let here = self.store.everybody()?;
        let participant = self.next_id(&here)?;
        let riders = here.iter().filter(|p| !p.rides().is_empty()).count();
        let steps = self.steps_of(&participant, riders)?;
        let token = token::new()?;
        // Steps are made of what was checked.
        let steps = serde_json::to_string(&steps).unwrap_or_default();
        self.store.add(&token, &participant, &steps)?;
        Ok(token)
    }

    /// Writes answers and people as `maveric run` reads them; who asks while they are being written waits for one further writing.
    ///
    /// # Errors
    /// [`SeatError::Store`]; [`SeatError::Study`] if a file cannot be written.
    pub fn write_files(&self) -> Result<(), SeatError> {
        let wanted = self.asked.fetch_add(1, Ordering::SeqCst) + 1;
        let mut written = held(&self.written);
        if *written >= wanted {
            return Ok(());
        }
        let answered = self.asked.load(Ordering::SeqCst);
        let mut given = Vec::new();
        for person in self.store.everybody()? {
            let answers = self.store.answers(&person.participant)?;
            given.push((person, answers));
        }
        if !given.is_empty() {
            self.settings.files.write(&given)?;
        }
        *written = answered;
        Ok(())
    }

    /// Whether speeds are shown in miles an hour.
    pub(crate) fn mph(&self) -> bool {
        self.settings.design.protocol().speed == SpeedUnit::Mph
    }

    /// The first person, let in if nobody was: for a seat that one person uses.
    ///
    /// # Errors
    /// As [`Seat::let_in`].
    pub fn only_person(&self) -> Result<String, SeatError> {
        match self
            .store
            .everybody()?
            .into_iter()
            .find(|p: &Person| p.ended.is_none())
        {
            Some(person) => Ok(person.token),
            None => self.let_in(),
        }
    }
}
