//! What the seat is: a study's steps for each person, and where everything is kept.

use crate::{
    books::Books,
    collected::NOTE,
    consent,
    error::SeatError,
    files::Files,
    held::held,
    hindrance::Hindrance,
    known::Known,
    listed::Listed,
    person::Person,
    plan::{self, Riding, Styles},
    servable::hindrances,
    steps::{Step, Texts},
    store::Store,
    tables::{Given, Standing},
    token, unnamed,
    withdrawal::Withdrawal,
};
use maveric_domain::{Design, DriveId, Scale, ScoreRange, SpeedUnit, design::ProtocolStep};
use maveric_model::{Model, model_file};
use maveric_simulator::Scenario;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
};

/// What a seat is opened with.
pub struct SeatSettings {
    pub design: Design,
    /// The scales that the study may ask.
    pub scales: Vec<Scale>,
    /// Its texts, in the study's language and in the others among which people choose.
    pub texts: Texts,
    /// As `texts`.
    pub in_others: Vec<Texts>,
    pub scenario: Scenario,
    /// The model that rides, as in its file; none in a phase in which people only drive by hand.
    pub model: Option<Vec<u8>>,
    /// Whether it learned from made-up people.
    pub made_up_model: bool,
    /// The scale of the score that the study's dial turns; the model's own where the study says none.
    pub range: Option<ScoreRange>,
    /// Where logs and answers are written.
    pub files: Files,
    /// The password of the experimenter's page; none for no such page.
    pub password: Option<String>,
}

#[derive(Debug, Default)]
struct Links {
    people: BTreeMap<String, Arc<Known>>,
    /// Digests of the tokens of who is forgotten.
    forgotten: BTreeSet<String>,
}

/// A seat that is open.
pub struct Seat {
    pub(crate) settings: SeatSettings,
    pub(crate) store: Store,
    pub(crate) scenario_json: String,
    pub(crate) model: Option<Model>,
    styles: Styles,
    /// The drives of this study that the model learned from, whose style may not be lent.
    pub(crate) withheld: BTreeSet<DriveId>,
    links: Mutex<Links>,
    /// Whether the experimenter has closed it.
    stopping: AtomicBool,
    /// Whether the model that rides learned from somebody who is forgotten since.
    model_refused: AtomicBool,
    /// How often the files were asked for, and which asking the last writing answered.
    asked: AtomicU64,
    written: Mutex<u64>,
}

impl SeatSettings {
    /// All that keeps the seat from running the study; nothing is opened or written.
    ///
    /// # Errors
    /// [`SeatError::Model`] for a model that is none.
    pub fn hindrances(&self) -> Result<Vec<Hindrance>, SeatError> {
        Ok(self.examined()?.2)
    }

    /// The model, the styles that conditions name, and what keeps the seat from running the study.
    fn examined(&self) -> Result<(Option<Model>, Styles, Vec<Hindrance>), SeatError> {
        let model = self.model.as_deref().map(model_file::from_bytes);
        let model = model.transpose()?.map(|model| model.on_range(self.range));
        let mut in_the_way = Vec::new();
        for texts in [&self.texts].into_iter().chain(&self.in_others) {
            let words = (&self.scales[..], texts);
            for hindrance in hindrances(&self.design, words, model.as_ref()) {
                if !in_the_way.contains(&hindrance) {
                    in_the_way.push(hindrance);
                }
            }
        }
        let styles = self.files.styles(model.as_ref(), &mut in_the_way);
        Ok((model, styles, in_the_way))
    }
}

impl Seat {
    /// Opens a seat whose state is kept in `path`.
    ///
    /// # Errors
    /// [`SeatError::Unfit`] with all that keeps the seat from running the study, before anything is written; [`SeatError::Store`] if the file
    /// cannot be opened; [`SeatError::Model`] for a model that is none; [`SeatError::Study`] if its tables cannot be read or made.
    pub fn open(path: &Path, mut settings: SeatSettings) -> Result<Self, SeatError> {
        if settings.password.as_ref().is_some_and(|p| p.trim().is_empty()) {
            return Err(SeatError::cannot(
                "the password of the experimenter's page is empty",
                "give one, or leave it out: then one is made up and printed",
            ));
        }
        let (model, styles, hindrances) = settings.examined()?;
        if !hindrances.is_empty() {
            return Err(SeatError::Unfit(hindrances));
        }
        if let Some(model) = &model {
            settings.model = Some(unnamed::model(model)?);
        }
        settings.files.begin()?;
        let store = Store::open(path)?;
        let mut withheld = BTreeSet::new();
        // A model that was learned elsewhere may know others by the same ids.
        if let Some(model) = model.as_ref().filter(|_| settings.design.model().is_none()) {
            withheld = store.look(consent::withheld)?;
            let is_learned = |id: &DriveId| model.training().iter().any(|t| t.drive == *id);
            withheld.retain(is_learned);
            withheld.extend(store.look(|b| consent::of_forgotten(b, &settings.design, model))?);
        }
        let seat = Self {
            store,
            scenario_json: serde_json::to_string(&settings.scenario).map_err(|e| {
                SeatError::Protocol {
                    problem: format!("the scenario cannot be written: {e}"),
                    help: None,
                }
            })?,
            model,
            styles,
            withheld,
            settings,
            links: Mutex::default(),
            stopping: AtomicBool::new(false),
            model_refused: AtomicBool::new(false),
            asked: AtomicU64::new(0),
            written: Mutex::new(0),
        };
        *held(&seat.links) = seat.store.within(|b| {
            let mut people = b.everybody()?;
            // The model may have been learned anew, of others.
            for person in people.iter_mut().filter(|p| p.ended.is_none()) {
                if seat.withhold(&mut person.steps) {
                    b.set_steps(&person.participant, &person.steps)?;
                }
            }
            let known = |p: &Person| (p.token.clone(), Arc::new(Known::from_person(p)));
            Ok::<_, SeatError>(Links {
                people: people.iter().map(known).collect(),
                forgotten: b.links_forgotten()?,
            })
        })?;
        // What a killed seat had promised to take away.
        seat.forget_the_rest()?;
        // What a killed seat had taken in and not written yet.
        seat.write_all()?;
        Ok(seat)
    }

    /// The id of whoever has a link.
    pub(crate) fn whose(&self, token: &str) -> Option<String> {
        self.known(token).map(|known| known.participant.clone())
    }

    /// What is kept at hand of whoever has a link.
    pub(crate) fn known(&self, token: &str) -> Option<Arc<Known>> {
        held(&self.links).people.get(token).cloned()
    }

    /// Whether a link leads, or once led, to somebody.
    pub(crate) fn has_link(&self, token: &str) -> bool {
        let links = held(&self.links);
        links.people.contains_key(token)
            || token::possible(token) && links.forgotten.contains(&token::sha256(token))
    }

    pub(crate) fn add_link(&self, person: &Person) {
        let known = Arc::new(Known::from_person(person));
        held(&self.links).people.insert(person.token.clone(), known);
    }

    pub(crate) fn forget_link(&self, token: &str) {
        let mut links = held(&self.links);
        links.people.remove(token);
        links.forgotten.insert(token::sha256(token));
    }

    /// Until when people can take back what they gave.
    pub(crate) fn withdrawal(&self) -> Withdrawal {
        Withdrawal::new(self.settings.design.protocol().withdraw_until.as_deref())
    }

    /// What to know before somebody is let in whose consent names a last day for taking back that is over; none where it is not.
    pub fn withdrawal_over(&self) -> Option<String> {
        let Withdrawal { until, open } = self.withdrawal();
        let until = until.filter(|_| !open)?;
        Some(format!(
            "[protocol] `withdraw_until` was {until}: whoever agrees now cannot take anything back after the end"
        ))
    }

    /// Closes the seat: whoever serves it ends.
    pub(crate) fn stop(&self) {
        self.stopping.store(true, Ordering::Relaxed);
    }

    pub(crate) fn stopping(&self) -> bool {
        self.stopping.load(Ordering::Relaxed)
    }

    /// Nobody rides any more by a model that learned from somebody who is forgotten.
    pub(crate) fn refuse_model(&self) {
        self.model_refused.store(true, Ordering::Relaxed);
    }

    /// The model for a page, as [`unnamed::model`] has it.
    ///
    /// # Errors
    /// [`SeatError::Protocol`] if it learned from somebody who is forgotten.
    pub(crate) fn model_for_page(&self) -> Result<Vec<u8>, SeatError> {
        if self.model_refused.load(Ordering::Relaxed) {
            return Err(SeatError::cannot(
                "the model that rides learned from somebody who is forgotten",
                "close the seat, learn it anew (`maveric run train`), and open the seat again",
            ));
        }
        Ok(self.settings.model.clone().unwrap_or_default())
    }

    /// Whether people ride, or drive by hand alone so that a model can learn from them.
    pub fn rides(&self) -> bool {
        let can_ride = self.model.is_some() || !self.settings.design.needs_a_model();
        let steps = &self.settings.design.protocol().steps;
        can_ride && steps.contains(&ProtocolStep::Rides)
    }

    /// What is said in a language; in the study's where nobody chose, or it is not spoken any more.
    pub(crate) fn texts_in(&self, language: Option<&str>) -> &Texts {
        let mut others = self.settings.in_others.iter();
        let chosen = others.find(|texts| Some(texts.words.language.as_str()) == language);
        chosen.unwrap_or(&self.settings.texts)
    }

    /// What styles are scored on here: the study's range, else the model's.
    pub(crate) fn score_range(&self) -> Option<ScoreRange> {
        let models = || self.model.as_ref().map(Model::score_range);
        self.settings.range.or_else(models)
    }

    /// The steps of somebody who rides in this order of the conditions, in a language as [`Seat::texts_in`] takes it.
    pub(crate) fn steps_of(
        &self,
        language: Option<&str>,
        participant: &str,
        order: &[usize],
    ) -> Result<Vec<Step>, SeatError> {
        let s = &self.settings;
        let riding = self.rides().then_some(Riding {
            order,
            styles: &self.styles,
            range: self.score_range().unwrap_or(ScoreRange::ADB),
        });
        let texts = self.texts_in(language);
        let mut steps = plan::of_design(&s.design, &s.scales, texts, participant, riding)?;
        self.withhold(&mut steps);
        Ok(steps)
    }

    /// Does something to the study's files while nobody writes answers and people into them.
    pub(crate) fn without_writing<T>(&self, work: impl FnOnce(&Files) -> T) -> T {
        let _alone = held(&self.written);
        work(&self.settings.files)
    }

    /// Writes answers and people as `maveric run` reads them; who asks while they are being written waits for one further writing.
    ///
    /// # Errors
    /// [`SeatError::Store`]; [`SeatError::Study`] if a file cannot be written.
    pub fn write_files(&self) -> Result<(), SeatError> {
        self.write(false)
    }

    /// The same where the seat opens or closes: what was collected of people whose part goes on is written too.
    pub(crate) fn write_all(&self) -> Result<(), SeatError> {
        self.write(true)
    }

    fn write(&self, unfinished: bool) -> Result<(), SeatError> {
        let wanted = self.asked.fetch_add(1, Ordering::SeqCst) + 1;
        let mut written = held(&self.written);
        if *written >= wanted {
            return Ok(());
        }
        let answered = self.asked.load(Ordering::SeqCst);
        let (given, listed_before, not_admitted, not_agreed) = self.store.look(|b| {
            let (mut given, mut listed_before) = (Vec::new(), Vec::new());
            for person in b.everybody()? {
                if b.takes_part(&person)? {
                    let answers = b.answers(&person.participant)?;
                    given.push((person, answers));
                } else if person.listed == Listed::Written && person.ended.is_some() {
                    // Where nothing is agreed to, whoever opened their link was written, also who never came to the first step's end.
                    listed_before.push(person.participant);
                }
            }
            Ok::<_, SeatError>((given, listed_before, b.not_admitted()?, b.not_agreed()?))
        })?;
        let files = &self.settings.files;
        files.held_back(&not_admitted, &not_agreed)?;
        self.store.look(|b| files.ended(b))?;
        if !given.is_empty() || !listed_before.is_empty() {
            let listed = files.write(&given, &listed_before)?;
            self.store.within(|b| {
                for who in &listed_before {
                    b.list_person(who, Listed::NotYet)?;
                    let table = files.name_of_people();
                    let text = format!("taken out of {table}: they never came");
                    b.event(Some(who), &text)?;
                }
                self.keep_listed(b, &given, &listed)
            })?;
            let before = files.events();
            let people = (&given[..], &listed);
            let collected = self.store.look(|b| b.collected(people, &before, unfinished))?;
            files.collected(&collected)?;
        }
        *written = answered;
        Ok(())
    }

    /// Keeps what stands in the study's tables now; says whose rows somebody took out by hand.
    fn keep_listed(
        &self,
        b: &Books<'_>,
        given: &[Given],
        listed: &Standing,
    ) -> Result<(), SeatError> {
        for (person, sheets) in given {
            let who = &person.participant;
            let now = listed.person(person);
            if now != person.listed {
                b.list_person(who, now)?;
                if now == Listed::TakenOut {
                    let table = self.settings.files.name_of_people();
                    let text = format!(
                        "taken out of {table} by hand: not written back; what the seat has of them goes when they are forgotten"
                    );
                    b.event(Some(who), &text)?;
                }
            }
            for sheet in sheets {
                let now = listed.sheet(person, sheet);
                if now != sheet.listed {
                    b.list_answer((who, sheet.step), now)?;
                }
            }
        }
        Ok(())
    }

    /// Keeps a note of the experimenter's.
    pub fn note(&self, text: &str) -> Result<(), SeatError> {
        self.store.within(|b| b.event(None, &format!("{NOTE}{text}")))
    }

    /// Whether speeds are shown in miles an hour.
    pub(crate) fn mph(&self) -> bool {
        self.settings.design.speed_unit() == SpeedUnit::Mph
    }
}
