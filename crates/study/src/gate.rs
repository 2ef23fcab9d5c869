//! Who and what a design lets in: its people, its conditions, and not what its rules leave out.

use crate::{
    atomic_write::read_json,
    design::{DesignFile, People},
    error::StudyError,
    forgotten::ForgottenList,
    once::{count, names},
};
use maveric_analysis::{
    Driven, Flow, LeftOut, Rule, Why,
    exclusions::{too_short, unknown_ride},
};
use maveric_domain::{
    Answer, ConditionId, Design, DriveId, DriveMeta, Moment, ParticipantId, Scale, nearest,
    occasion::is_first,
};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// What lets drives and answers into a study.
#[derive(Debug, Clone)]
pub struct Gate {
    design: Design,
    people: People,
    /// Whom the table of people lists, where there is one: then nobody else is let in.
    listed: Option<BTreeSet<ParticipantId>>,
    forgotten: ForgottenList,
    left_out: LeftOut,
}

/// What is read of an analysis.
#[derive(serde::Deserialize)]
struct Counted {
    flow: Flow,
}

/// Whom and which drives the analysis among the results of a study left out, after those that the design and the list of stopped rides leave
/// out by name, who are `left_out` already: of these the analysis says nothing, so that a line that was taken back leaves out nobody.
///
/// # Errors
/// [`StudyError`] for an analysis that cannot be read.
pub(crate) fn analysed(mut left_out: LeftOut, results: &Path) -> Result<LeftOut, StudyError> {
    let file = results.join("analysis.json");
    if !file.is_file() {
        return Ok(left_out);
    }
    let flow = read_json::<Counted>(&file)?.flow;
    let by_name = |rule: Rule| Rule::BY_NAME.contains(&rule);
    // Whoever had no drive left is out by the rule of a drive.
    let still: BTreeSet<Why> = left_out.drives.values().cloned().collect();
    for row in flow.left_out {
        let why = Why::by(row.rule, &row.why);
        if by_name(row.rule) && !still.contains(&why) {
            continue;
        }
        for id in row.who {
            left_out.and_person(ParticipantId::new(id)?, why.clone());
        }
    }
    for row in flow.drives.into_iter().filter(|row| !by_name(row.rule)) {
        for id in row.who {
            left_out.and_drive(DriveId::new(id)?, Why::by(row.rule, &row.why));
        }
    }
    Ok(left_out)
}

/// What there is to say of a table of people without a row.
pub(crate) fn nobody_listed(table: &Path) -> StudyError {
    let problem = "has no row: nobody takes part";
    let help = "write a row for each who takes part, with the id of their logs and answers; `maveric design orders --people 24` writes P01 to P24, and `maveric seat` writes its own";
    StudyError::file(table, problem).with_help(help)
}

impl Gate {
    /// The gate of a design; people are `given`, or the design's own table.
    ///
    /// A table without a row lets nobody in, which is refused: whoever was taken out of it, the last one too, stays out.
    ///
    /// # Errors
    /// As [`DesignFile::people`]; [`StudyError::BadFile`] for a table without a row.
    pub fn new(study: &DesignFile, given: Option<&Path>) -> Result<Self, StudyError> {
        let people = study.people(given)?;
        if people.enrolled.is_empty() {
            return Err(nobody_listed(&study.people_file(given)));
        }
        Ok(Self {
            listed: Some(people.enrolled.iter().map(|p| p.id.clone()).collect()),
            people,
            design: study.design.clone(),
            forgotten: study.forgotten()?,
            left_out: LeftOut::named(&study.design).with_stopped(&study.stopped()?),
        })
    }

    /// As [`Gate::new`]; where no table is `given` and the design's own is not there, whoever is not left out by name is let in.
    pub fn where_listed(study: &DesignFile, given: Option<&Path>) -> Result<Self, StudyError> {
        if given.is_some() || study.people_file(None).is_file() {
            return Self::new(study, given);
        }
        Ok(Self {
            people: People::default(),
            design: study.design.clone(),
            listed: None,
            forgotten: study.forgotten()?,
            left_out: LeftOut::named(&study.design).with_stopped(&study.stopped()?),
        })
    }

    /// As [`Gate::new`]; a design that tells nobody apart by a column of its table needs none.
    pub(crate) fn of_drives(study: &DesignFile, given: Option<&Path>) -> Result<Self, StudyError> {
        if study.design.people().columns().is_empty() {
            return Self::where_listed(study, given);
        }
        Self::new(study, given)
    }

    /// The same, without whom and what the rules left out of the analysis among these results.
    pub(crate) fn with_analysis(mut self, results: &Path) -> Result<Self, StudyError> {
        self.left_out = analysed(self.left_out, results)?;
        Ok(self)
    }

    /// The same, without those who answered without reading and what was said of drives that are too short.
    #[must_use]
    pub(crate) fn with_sheets(
        mut self,
        scales: &[Scale],
        answers: &[Answer],
        drives: &[Driven],
    ) -> Self {
        self.left_out = self
            .left_out
            .with_careless(&self.design, scales, answers)
            .with_short(&self.design, drives);
        self
    }

    /// The people of the study, those who are left out among them.
    pub fn people(&self) -> &People {
        &self.people
    }

    /// Why a drive of this length (s) is left out; none where it is let in.
    pub fn drive(&self, meta: &DriveMeta, duration_s: f64) -> Option<Why> {
        let (who, ride) = (&meta.participant, meta.ride());
        let rules = self.left_out.drives.get(&meta.drive);
        rules
            .cloned()
            .or_else(|| self.person(who))
            .or_else(|| unknown_ride(&self.design, ride))
            .or_else(|| self.left_out.about(who, ride).cloned())
            .or_else(|| too_short(&self.design, duration_s))
    }

    /// Why an answer is left out; one about an excluded drive goes with the drive.
    pub fn answer(&self, participant: &ParticipantId, moment: Moment) -> Option<Why> {
        let person = self.person(participant);
        let Some(ride) = moment.ride() else {
            return person;
        };
        person
            .or_else(|| unknown_ride(&self.design, ride))
            .or_else(|| self.left_out.about(participant, ride).cloned())
    }

    /// Why what was measured of somebody in a condition is left out: the person is, or each of their rides in it in the first session, which
    /// alone is compared.
    pub(crate) fn condition(
        &self,
        participant: &ParticipantId,
        condition: ConditionId,
    ) -> Option<Why> {
        let rides = self.design.rides(condition);
        let rides = rides.filter(|ride| is_first(&ride.occasion.session));
        let about = |ride| self.answer(participant, Moment::After(ride));
        let whys: Option<Vec<Why>> = rides.map(about).collect();
        whys?.into_iter().next()
    }

    /// The ids that the table of people lacks, a line each, with where they are and the nearest id of the table.
    pub(crate) fn unknown_people<'a>(
        &self,
        found: impl IntoIterator<Item = (&'a ParticipantId, String)>,
    ) -> Vec<String> {
        let mut places: BTreeMap<&ParticipantId, Vec<String>> = BTreeMap::new();
        for (id, place) in found {
            let of_id = places.entry(id).or_default();
            if !of_id.contains(&place) {
                of_id.push(place);
            }
        }
        let is_unknown = |id: &ParticipantId| {
            self.person(id).is_some_and(|why| why.rule == Rule::UnknownParticipant)
        };
        places.retain(|id, _| is_unknown(id));
        let line = |(id, places): (&ParticipantId, Vec<String>)| {
            let known = self.people.enrolled.iter().map(|person| person.id.as_str());
            let meant = nearest(id.as_str(), known);
            let meant = meant.map_or_else(String::new, |id| format!("; did you mean `{id}`?"));
            format!(
                "`{id}` is not in the table of people and is left out ({}){meant}",
                names(&places)
            )
        };
        places.into_iter().map(line).collect()
    }

    /// Why somebody is left out, or unknown.
    pub fn person(&self, id: &ParticipantId) -> Option<Why> {
        if self.forgotten.has(id) {
            return Some(Why::by(Rule::Forgotten, "the person was forgotten"));
        }
        let stranger = self.listed.as_ref().is_some_and(|ids| !ids.contains(id));
        let unknown = || {
            let reason = format!("{id} is not in the table of people");
            stranger.then(|| Why::by(Rule::UnknownParticipant, reason))
        };
        self.left_out.people.get(id).cloned().or_else(unknown)
    }
}

/// How many each rule left out, a line each: `2 drives left out by exclude.people`.
pub fn counted<'a>(
    [one, several]: [&str; 2],
    left_out: impl IntoIterator<Item = &'a Why>,
) -> Vec<String> {
    let mut rules: BTreeMap<&str, usize> = BTreeMap::new();
    for out in left_out {
        *rules.entry(out.rule.key()).or_default() += 1;
    }
    let line = |(rule, n): (&str, usize)| format!("{} left out by {rule}", count(n, one, several));
    rules.into_iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_an_analysis_counts_what_it_alone_judges_and_not_a_rule_that_was_taken_back() {
        let results = tempfile::tempdir().unwrap();
        let flow = r#"{"flow": {"not_admitted": [], "recruited": 4, "drove": 4, "analysed": 1, "left_out": [
            {"rule": "exclude.people", "why": "sick", "who": ["P1"]},
            {"rule": "exclude.drives", "why": "no sound", "who": ["P2"]},
            {"rule": "exclude.straight_lined", "why": "one answer", "who": ["P3"]}], "drives": [
            {"rule": "exclude.drives", "why": "no sound", "who": ["P2-calm"]},
            {"rule": "exclude.drive_shorter_than_s", "why": "drive shorter than 60 s", "who": ["P4-calm"]}]}}"#;
        std::fs::write(results.path().join("analysis.json"), flow).unwrap();
        let of = |rules: &str| {
            let text =
                format!("[study]\ntitle = \"t\"\n[[condition]]\nid = \"calm\"\n[exclude]\n{rules}");
            let named = LeftOut::named(&Design::from_toml(&text).unwrap());
            let all = analysed(named, results.path()).unwrap();
            let people = all.people.keys().map(ToString::to_string);
            let drives = all.drives.keys().map(ToString::to_string);
            people.chain(drives).collect::<Vec<_>>()
        };
        let rules = "people = { P1 = \"sick\" }\ndrives = { P2-calm = \"no sound\" }\n";
        assert_eq!(of(rules), ["P1", "P2", "P3", "P2-calm", "P4-calm"]);
        assert_eq!(of(""), ["P3", "P4-calm"]);
    }
}
