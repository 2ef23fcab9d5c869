//! What the seat is: a study's steps for each person, and where everything is kept.

use crate::{
    error::SeatError,
    files::Files,
    person::Person,
    steps::{self, Step, Texts},
    store::Store,
    token,
};
use maveric_domain::{Design, Scale, design::SpeedUnit};
use maveric_simulator::Scenario;
use std::path::Path;

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
}

impl Seat {
    /// Opens a seat whose state is kept in `path`.
    ///
    /// # Errors
    /// [`SeatError::Store`] if the file cannot be opened; [`SeatError::Protocol`] if the study cannot be run in the seat.
    pub fn open(path: &Path, settings: SeatSettings) -> Result<Self, SeatError> {
        let seat = Self {
            store: Store::open(path)?,
            scenario_json: serde_json::to_string(&settings.scenario).map_err(|e| {
                SeatError::Protocol {
                    problem: format!("the scenario cannot be written: {e}"),
                    help: None,
                }
            })?,
            settings,
        };
        let steps = seat.steps_of("P001", 0)?;
        let rides = steps.iter().any(|s| matches!(s, Step::Ride { .. }));
        if rides && seat.settings.model.is_none() {
            return Err(SeatError::Protocol {
                problem: "the study has rides and no model that could drive them".to_owned(),
                help: Some(
                    "name one in [model], or leave `rides` out of [protocol] steps while the people drive who are learned from".to_owned(),
                ),
            });
        }
        Ok(seat)
    }

    fn steps_of(&self, participant: &str, index: usize) -> Result<Vec<Step>, SeatError> {
        let s = &self.settings;
        steps::of_design(&s.design, &s.scales, &s.texts, participant, index)
    }

    /// Lets the next person in: their token.
    ///
    /// # Errors
    /// [`SeatError::Store`], [`SeatError::Random`].
    pub fn let_in(&self) -> Result<String, SeatError> {
        let index = self.store.people()?;
        let participant = format!("P{:03}", index + 1);
        let steps = self.steps_of(&participant, index)?;
        let token = token::new()?;
        // Steps are made of what was checked.
        let steps = serde_json::to_string(&steps).unwrap_or_default();
        self.store.add(&token, &participant, &steps)?;
        Ok(token)
    }

    /// Writes answers and people as `maveric run` reads them; what of them was written before is written anew.
    ///
    /// # Errors
    /// [`SeatError::Store`]; [`SeatError::Study`] if a file cannot be written.
    pub fn write_files(&self) -> Result<(), SeatError> {
        let mut given = Vec::new();
        for person in self.store.everybody()? {
            let answers = self.store.answers(&person.participant)?;
            given.push((person, answers));
        }
        self.settings.files.write(&given)
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
