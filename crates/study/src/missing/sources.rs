//! What there is of a study, by person and time, and what is awaited.

use crate::{
    atomic_write::if_there,
    beyond::turned_for,
    design::{DesignFile, People},
    error::StudyError,
    run_folder::{answer_tables, lists},
    stages::ingest::{Ingest, logs_of_study},
    tables::{
        Table,
        conditions::read_conditions,
        drives::ExclusionRow,
        embeddings::read_embeddings,
        own_measures::{OwnMeasures, read_own_measures},
        participants::Enrolled,
        read_rows,
        surveys::read_answers,
    },
};
use maveric_domain::{
    Design, DriveMeta, Moment, Occasion, ParticipantId, Ride,
    design::{Condition, Quantity, Software},
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
        if there {
            Self::There
        } else {
            Self::Missing(why())
        }
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
        let mut sources = Self {
            study,
            people: Vec::new(),
            logs: Logs::read(study)?,
            drives: Drives::read(results, &study.design)?,
            answers: Answers::read(study, results)?,
            asked_scales: BTreeMap::new(),
            own_measures: read_own_measures(study, participants)?,
        };
        let table = study.people_file(None);
        let beside = results.join("participants.csv");
        let is_listed = participants.is_some() || beside.is_file() || table.is_file();
        let people = if is_listed {
            study.people_of(results, participants)?
        } else {
            People::default()
        };
        // Before anybody is listed: whoever drove, answered or was measured.
        sources.people = if people.enrolled.is_empty() {
            sources.everybody()
        } else {
            let awaited = |p: &&Enrolled| p.excluded.is_none() && (p.tested || p.learned_from);
            let person = |p: &Enrolled| Person {
                id: p.id.clone(),
                tested: p.tested,
            };
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
        let excluded = self.study.design.exclude();
        ids.into_iter()
            .filter(|id| excluded.person(id).is_none())
            .map(|id| Person {
                id: id.clone(),
                tested: true,
            })
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
        let answers = match answers {
            Awaited::Missing(_) if self.not_turned(&cell) => Awaited::No,
            answers => answers,
        };
        [log, drive, answers, self.measured(person, &cell)]
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
        if self.drives.made.contains(cell) {
            // Whatever was driven had a log.
            let log = if simulated {
                Awaited::No
            } else {
                Awaited::There
            };
            return [log, Awaited::There];
        }
        let kept_out = self.drives.kept_out.get(cell);
        if simulated {
            let why = match kept_out {
                Some(why) => why.as_str(),
                None if self.not_turned(cell) => NOT_TURNED,
                None => "not simulated yet",
            };
            return [Awaited::No, Awaited::Missing(why.to_owned())];
        }
        let file = self.logs.named.get(cell);
        let log = Awaited::there_if(file.is_some() || kept_out.is_some(), || {
            self.logs.why_none()
        });
        let failed = file.and_then(|name| self.drives.failed.get(name));
        let why = match (kept_out.or(failed), file) {
            (Some(why), _) => why.clone(),
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
        let cell = &(cell.0.clone(), cell.1.condition);
        let is_condition = design.condition(cell.1).is_some();
        let Some(own) = &self.own_measures else {
            let why = || format!("{} is not there", files.measures.to_slash_lossy());
            return is_condition.then(why).map_or(Awaited::No, Awaited::Missing);
        };
        if !is_condition && !own.rows.iter().any(|(_, condition)| *condition == cell.1) {
            return Awaited::No;
        }
        if !own.rows.contains(cell) {
            return Awaited::Missing("no row".to_owned());
        }
        let has = |id: &str| {
            let mut rows = own.measurements.iter();
            rows.any(|m| m.participant == cell.0 && m.condition == cell.1 && m.measure == id)
        };
        let lacking = design.measures().iter().filter(|m| !has(&m.id));
        let lacking: Vec<&str> = lacking.map(|m| m.id.as_str()).collect();
        Awaited::there_if(lacking.is_empty(), || {
            format!("no value: {}", lacking.join(", "))
        })
    }
}

/// The logs of the design's folders.
#[derive(Default)]
struct Logs {
    /// File names of those whose names say whose they are.
    named: BTreeMap<Cell, String>,
    /// How many do not.
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

/// The drives among the results.
#[derive(Default)]
struct Drives {
    made: BTreeSet<Cell>,
    /// Those that a rule left out, with the reason.
    kept_out: BTreeMap<Cell, String>,
    /// Logs that could not be ingested, by their names.
    failed: BTreeMap<String, String>,
    /// For whom `steer` did not turn the dial.
    not_turned: BTreeSet<ParticipantId>,
}

impl Drives {
    fn read(results: &Path, design: &Design) -> Result<Self, StudyError> {
        let mut drives = Self {
            not_turned: not_turned(results, design)?,
            ..Self::default()
        };
        for list in lists(results) {
            let listed: Vec<DriveMeta> = read_rows(&list)?;
            let cell = |m: &DriveMeta| (m.participant.clone(), m.ride());
            drives.made.extend(listed.iter().map(cell));
            let path = list.with_file_name("exclusions.csv");
            if !path.is_file() {
                continue;
            }
            let table = Table::read(&path)?;
            // Other stages list their exclusions in fewer columns.
            if !table.has("rule") {
                continue;
            }
            for row in table.records::<ExclusionRow>()? {
                if !row.participant.is_empty() {
                    let ride = row.ride()?;
                    let cell = (ParticipantId::new(row.participant)?, ride);
                    drives.kept_out.insert(cell, row.what);
                } else if row.drive.is_empty() {
                    drives.failed.insert(row.log, row.what);
                }
            }
        }
        Ok(drives)
    }
}

/// For whom `steer` did not turn the dial, of those whom it has looked at.
fn not_turned(results: &Path, design: &Design) -> Result<BTreeSet<ParticipantId>, StudyError> {
    let conditions = results.join("conditions.csv");
    if !conditions.is_file() {
        return Ok(BTreeSet::new());
    }
    let conditions = read_conditions(&conditions)?;
    let rows = if_there(&results.join("embeddings.csv"), read_embeddings)?;
    let strangers = turned_for(&rows, &conditions, design).into_iter();
    let not_turned = strangers.filter(|(_, turned)| !turned);
    Ok(not_turned.map(|(who, _)| who).collect())
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
            let why = if waits {
                "not imported yet"
            } else {
                "not there"
            };
            answers.none = Some(format!("{} is {why}", files.answers.to_slash_lossy()));
        }
        Ok(answers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn for_whom_the_dial_was_not_turned_is_known_once_conditions_are_placed() {
        let design = Design::from_toml(
            "[study]\ntitle = \"t\"\n[people]\nlearn = { part = \"learn\" }\n[style]\nscore = \"adb.total\"\npoints = 15\n\
             [baseline]\nid = \"own\"\n[[condition]]\nid = \"mine\"\ncar = { dial = 0 }\n[[condition]]\nid = \"sporty\"\ncar = { dial = \"+1\" }\n",
        )
        .unwrap();
        let results = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(results.path().join(name), text);
        let of = || {
            let people = not_turned(results.path(), &design).unwrap().into_iter();
            people.map(|who| who.to_string()).collect::<Vec<_>>()
        };
        write(
            "embeddings.csv",
            "drive,participant,condition,adb_used,adb,adb_hat,line_position,readings,beyond_why,w1\n\
             P1-own,P1,own,false,,30,0.1,9,scale,0.5\nP2-own,P2,own,false,,30,0.1,9,,0.5\n",
        )
        .unwrap();
        assert!(of().is_empty());
        let header = "participant,condition,adb_hat,moved_points,moved_points_sd,clamped,angle_rad,beyond_training,w1\n";
        let placed =
            |who: &str, condition: &str| format!("{who},{condition},30,0,,false,,false,0.5\n");
        let mine = header.to_owned() + &placed("P1", "mine") + &placed("P2", "mine");
        write("conditions.csv", &mine).unwrap();
        assert_eq!(of(), ["P1"]);
        write("conditions.csv", &(mine + &placed("P1", "sporty"))).unwrap();
        assert!(of().is_empty());
    }
}
