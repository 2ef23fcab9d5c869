//! What there is of a study, by person and time, and what is awaited.

mod drives;

use drives::Drives;

use crate::{
    design::{DesignFile, People},
    error::StudyError,
    gate::analysed,
    run_folder::answer_tables,
    stages::ingest::{Ingest, logs_of_study},
    tables::{
        own_measures::{OwnMeasures, read_own_measures},
        participants::Enrolled,
        surveys::read_answers,
    },
};
use maveric_analysis::{LeftOut, Rule};
use maveric_domain::{
    Moment, Occasion, ParticipantId, Ride,
    design::{Condition, Quantity, Software},
    occasion::is_first,
};
use maveric_ingest::named_after;
use path_slash::PathExt as _;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// Why there is no drive of somebody for whom the dial was not turned.
const NOT_TURNED: &str =
    "the dial was not turned: the person drives beyond what the model has learned from";

/// Why there is no drive of a car that is made of a drive which is left out.
const NOT_MADE: &str = "the drive by hand that the car is made of is left out";

/// A person in a drive.
type Cell = (ParticipantId, Ride);

/// Whether something is there of a person at a time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Awaited {
    /// The study does not ask for it.
    No,
    There,
    /// Why it is not there.
    Missing(String),
}

impl Awaited {
    pub(super) fn reason(self) -> Option<String> {
        match self {
            Self::Missing(why) => Some(why),
            Self::No | Self::There => None,
        }
    }

    fn there_if(there: bool, why: impl FnOnce() -> String) -> Self {
        if there { Self::There } else { Self::Missing(why()) }
    }
}

/// Somebody of whom something is awaited.
pub(super) struct Person {
    pub(super) id: ParticipantId,
    tested: bool,
}

/// What the files of a study and of its results hold.
pub(super) struct Sources<'a> {
    study: &'a DesignFile,
    people: Vec<Person>,
    logs: Logs,
    drives: Drives,
    answers: Answers,
    /// The scales that are asked of those who are tested (or of the others) at a time of a kind.
    asked_scales: BTreeMap<(bool, Time), BTreeSet<String>>,
    own_measures: Option<OwnMeasures>,
    /// Whom and what the rules leave out, as far as a run has judged; who is absent is still awaited.
    left_out: LeftOut,
}

/// Kinds of times at which the same is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Time {
    Before,
    Baseline,
    Condition,
    End,
}

impl<'a> Sources<'a> {
    pub(super) fn read(
        study: &'a DesignFile,
        results: &Path,
        participants: Option<&Path>,
    ) -> Result<Self, StudyError> {
        let named = LeftOut::named(&study.design).with_stopped(&study.stopped()?);
        let mut left_out = analysed(named, results)?;
        left_out.people.retain(|_, why| why.rule != Rule::Absent);
        let mut sources = Self {
            study,
            people: Vec::new(),
            logs: Logs::read(study)?,
            drives: Drives::read(results, &study.design, &left_out)?,
            left_out,
            answers: Answers::read(study, results)?,
            asked_scales: BTreeMap::new(),
            own_measures: read_own_measures(study, participants)?,
        };
        let table = study.people_file(None);
        let beside = results.join("participants.csv");
        let is_listed = participants.is_some() || beside.is_file() || table.is_file();
        let people =
            if is_listed { study.people_of(results, participants)? } else { People::default() };
        // Before anybody is listed: whoever drove, answered or was measured.
        sources.people = if people.enrolled.is_empty() {
            sources.everybody()
        } else {
            let keeps = |id: &ParticipantId| !sources.left_out.people.contains_key(id);
            let awaited = |p: &&Enrolled| keeps(&p.id) && (p.tested || p.learned_from);
            let person = |p: &Enrolled| Person { id: p.id.clone(), tested: p.tested };
            people.enrolled.iter().filter(awaited).map(person).collect()
        };
        sources.ask();
        Ok(sources)
    }

    fn time(&self, moment: Moment) -> Option<Time> {
        let design = &self.study.design;
        match moment {
            Moment::Pre => Some(Time::Before),
            Moment::After(r) if design.condition(r.condition).is_some() => Some(Time::Condition),
            Moment::After(r) if design.baseline_id() == Some(r.condition) => Some(Time::Baseline),
            Moment::Post => Some(Time::End),
            // Whether a probe was answered its own row says.
            Moment::After(_) | Moment::Probe(_) => None,
        }
    }

    /// A scale is asked where somebody like this answered it, and where the design cannot do without.
    fn ask(&mut self) {
        let design = &self.study.design;
        let mut asked_scales: BTreeMap<(bool, Time), BTreeSet<String>> = BTreeMap::new();
        for person in &self.people {
            let first = (person.id.clone(), Moment::Pre);
            let theirs = self.answers.given.range(first..);
            let theirs = theirs.take_while(|((who, _), _)| *who == person.id);
            for ((_, moment), scales) in theirs {
                if let Some(time) = self.time(*moment) {
                    let known = asked_scales.entry((person.tested, time)).or_default();
                    known.extend(scales.iter().cloned());
                }
            }
        }
        let style = design.style().filter(|_| design.needs_a_model());
        let style: Vec<String> = style.map(|s| s.score.scale.clone()).into_iter().collect();
        let rated = design.outcomes().iter().filter_map(|o| match &o.quantity {
            Quantity::Score(name) => Some(name.scale.clone()),
            Quantity::Measure(_) => None,
        });
        let protocol = design.protocol();
        // Before there are answers, what the seat asks says it.
        let unasked = self.answers.none.is_some();
        let before = protocol.before.iter().filter(|_| unasked).cloned();
        let after = protocol.after.iter().filter(|_| unasked).cloned();
        let post = protocol.post.iter().filter(|_| unasked).cloned();
        let before: Vec<String> = style.into_iter().chain(before).collect();
        for (key, scales) in [
            ((true, Time::Before), before.clone()),
            ((false, Time::Before), before),
            ((true, Time::Condition), rated.chain(after).collect()),
            ((true, Time::End), post.collect()),
        ] {
            asked_scales.entry(key).or_default().extend(scales);
        }
        self.asked_scales = asked_scales;
    }

    pub(super) fn people(&self) -> &[Person] {
        &self.people
    }

    /// Everybody of whom anything is there, where no table says who takes part.
    fn everybody(&self) -> Vec<Person> {
        let logs = self.logs.named.keys().map(|(who, _)| who);
        let drives = self.drives.made.iter().map(|(who, _)| who);
        let answers = self.answers.given.keys().map(|(who, _)| who);
        let measured = self.own_measures.iter().flat_map(|own| &own.rows);
        let measured = measured.map(|(who, _)| who);
        let ids: BTreeSet<&ParticipantId> =
            logs.chain(drives).chain(answers).chain(measured).collect();
        ids.into_iter()
            .filter(|id| !self.left_out.people.contains_key(*id))
            .map(|id| Person { id: id.clone(), tested: true })
            .collect()
    }

    /// Log, drive, answers and own measures of a person at a time.
    pub(super) fn cells(&self, person: &Person, moment: Moment) -> [Awaited; 4] {
        let answers = self.answers(person, moment);
        let Moment::After(ride) = moment else {
            return [Awaited::No, Awaited::No, answers, Awaited::No];
        };
        let design = &self.study.design;
        // Whoever is learned from drives the baseline once.
        let again = ride.occasion != Occasion::FIRST;
        if !person.tested && (again || design.baseline_id() != Some(ride.condition)) {
            return [const { Awaited::No }; 4];
        }
        let cell = (person.id.clone(), ride);
        let [log, drive] = self.driven(&cell);
        let answers = match (answers, self.why_left_out(&cell)) {
            (Awaited::No, _) => Awaited::No,
            (_, Some(why)) => Awaited::Missing(why),
            (Awaited::Missing(_), None) if self.why_no_car(&cell).is_some() => Awaited::No,
            (answers, None) => answers,
        };
        [log, drive, answers, self.measured(person, &cell)]
    }

    /// Why nothing of a ride counts, whatever there is of it.
    fn why_left_out(&self, cell: &Cell) -> Option<String> {
        let listed = self.drives.kept_out.get(cell).cloned();
        listed.or_else(|| self.ruled_out(cell))
    }

    /// The same by what is known of people and rides, whatever became of their logs.
    fn ruled_out(&self, (who, ride): &Cell) -> Option<String> {
        self.left_out.about(who, *ride).map(ToString::to_string)
    }

    /// The same of a condition: each of its rides in the first session, which alone is compared, is left out.
    fn condition_left_out(&self, (who, ride): &Cell) -> Option<String> {
        let rides = self.study.design.rides(ride.condition);
        let rides = rides.filter(|ride| is_first(&ride.occasion.session));
        let whys: Option<Vec<String>> =
            rides.map(|ride| self.why_left_out(&(who.clone(), ride))).collect();
        whys?.into_iter().next()
    }

    /// Why no car could be made for a ride, where none could.
    fn why_no_car(&self, cell: &Cell) -> Option<&'static str> {
        let design = &self.study.design;
        design.condition(cell.1.condition).filter(|c| c.simulated())?;
        if self.not_turned(cell) {
            return Some(NOT_TURNED);
        }
        let by_hand = Ride { condition: design.baseline_id()?, occasion: Occasion::FIRST };
        self.why_left_out(&(cell.0.clone(), by_hand)).map(|_| NOT_MADE)
    }

    /// Whether there was no ride to answer after, since the dial was not turned for the person.
    fn not_turned(&self, (who, ride): &Cell) -> bool {
        let condition = self.study.design.condition(ride.condition);
        let turns = condition.is_some_and(|c| c.simulated() && c.side().is_some());
        turns && self.drives.not_turned.contains(who)
    }

    fn driven(&self, cell: &Cell) -> [Awaited; 2] {
        let condition = self.study.design.condition(cell.1.condition);
        let simulated = condition.is_some_and(Condition::simulated);
        let is_made = self.drives.made.contains(cell);
        // A drive that was kept out is not one that was made in the same condition.
        let left_out = if is_made { self.ruled_out(cell) } else { self.why_left_out(cell) };
        if is_made && left_out.is_none() {
            // Whatever was driven had a log.
            let log = if simulated { Awaited::No } else { Awaited::There };
            return [log, Awaited::There];
        }
        if simulated {
            let why_no_car = || self.why_no_car(cell).unwrap_or("not simulated yet").to_owned();
            let why = left_out.unwrap_or_else(why_no_car);
            return [Awaited::No, Awaited::Missing(why)];
        }
        let file = self.logs.named.get(cell);
        let came = is_made || file.is_some() || self.drives.kept_out.contains_key(cell);
        let log =
            Awaited::there_if(came, || left_out.clone().unwrap_or_else(|| self.logs.why_none()));
        let failed = || self.drives.failed.get(file?).cloned();
        let why = match (left_out.or_else(failed), file) {
            (Some(why), _) => why,
            (None, Some(_)) => "its log is not ingested yet".to_owned(),
            (None, None) => "no log".to_owned(),
        };
        [log, Awaited::Missing(why)]
    }

    fn answers(&self, person: &Person, moment: Moment) -> Awaited {
        let time = self.time(moment);
        let scales = time.and_then(|time| self.asked_scales.get(&(person.tested, time)));
        let Some(scales) = scales.filter(|scales| !scales.is_empty()) else {
            return Awaited::No;
        };
        if let Some(why) = &self.answers.none {
            return Awaited::Missing(why.clone());
        }
        let given = self.answers.given.get(&(person.id.clone(), moment));
        let lacking = |scale: &&String| given.is_none_or(|given| !given.contains(*scale));
        let lacking: Vec<&str> = scales.iter().filter(lacking).map(String::as_str).collect();
        Awaited::there_if(lacking.is_empty(), || {
            if lacking.len() == scales.len() {
                "no answers".to_owned()
            } else {
                format!("not answered: {}", lacking.join(", "))
            }
        })
    }

    fn measured(&self, person: &Person, cell: &Cell) -> Awaited {
        let (design, files) = (&self.study.design, self.study.design.files());
        if design.measures().is_empty() || !person.tested {
            return Awaited::No;
        }
        // The study's own measures are averaged over sessions and trials.
        if cell.1.occasion != Occasion::FIRST {
            return Awaited::No;
        }
        let left_out = self.condition_left_out(cell);
        let cell = &(cell.0.clone(), cell.1.condition);
        let is_condition = design.condition(cell.1).is_some();
        let table = self.own_measures.as_ref();
        let mut rows = table.into_iter().flat_map(|table| &table.rows);
        if !is_condition && !rows.any(|(_, condition)| *condition == cell.1) {
            return Awaited::No;
        }
        if let Some(why) = left_out {
            return Awaited::Missing(why);
        }
        let Some(table) = table else {
            let measures = files.measures.to_slash_lossy();
            return Awaited::Missing(format!("{measures} is not there"));
        };
        if !table.rows.contains(cell) {
            return Awaited::Missing("no row".to_owned());
        }
        let has = |id: &str| {
            let mut rows = table.measurements.iter();
            rows.any(|m| m.participant == cell.0 && m.condition == cell.1 && m.measure == id)
        };
        let lacking = design.measures().iter().filter(|m| !has(&m.id));
        let lacking: Vec<&str> = lacking.map(|m| m.id.as_str()).collect();
        Awaited::there_if(lacking.is_empty(), || format!("no value: {}", lacking.join(", ")))
    }
}

/// The logs of the design's folders.
#[derive(Default)]
struct Logs {
    /// File names of those whose names say whose they are.
    named: BTreeMap<Cell, String>,
    unnamed: usize,
}

impl Logs {
    fn read(study: &DesignFile) -> Result<Self, StudyError> {
        let mut logs = Self::default();
        for log in logs_of_study(&Ingest::default(), study)? {
            let names = log.settings.mapping.as_ref().and_then(|m| m.names.as_ref());
            let name = log.path.file_name().unwrap_or_default();
            match names.and_then(|names| named_after(&log.path, names)) {
                Some(meta) => {
                    let ride = meta.ride();
                    let cell = (meta.participant, ride);
                    let name = name.to_string_lossy().into_owned();
                    logs.named.insert(cell, name);
                }
                None => logs.unnamed += 1,
            }
        }
        Ok(logs)
    }

    fn why_none(&self) -> String {
        match self.unnamed {
            0 => "no log".to_owned(),
            n => format!("no log by its name; {n} do not say there whose they are"),
        }
    }
}

/// What the tables of answers hold.
#[derive(Default)]
struct Answers {
    /// Scales of which somebody answered anything.
    given: BTreeMap<(ParticipantId, Moment), BTreeSet<String>>,
    /// Why nothing is known of any answer.
    none: Option<String>,
}

impl Answers {
    fn read(study: &DesignFile, results: &Path) -> Result<Self, StudyError> {
        let mut answers = Self::default();
        let tables = answer_tables(results, study);
        for path in &tables {
            for answer in read_answers(path)? {
                if answer.answer.is_some() {
                    let sheet = (answer.participant, answer.moment);
                    answers.given.entry(sheet).or_default().insert(answer.scale);
                }
            }
        }
        if tables.is_empty() {
            let files = study.design.files();
            let is_export = files.software != Software::Table;
            let waits = is_export && study.resolve(&files.answers).is_file();
            let why = if waits { "not imported yet" } else { "not there" };
            answers.none = Some(format!("{} is {why}", files.answers.to_slash_lossy()));
        }
        Ok(answers)
    }
}

#[cfg(test)]
mod tests;
