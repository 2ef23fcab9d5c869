//! Who and what a design lets in: its people, its conditions, and not what `[exclude]` names.

use crate::{
    design::{DesignFile, People},
    error::StudyError,
    forgotten::ForgottenList,
};
use maveric_domain::{ConditionId, Design, DriveId, DriveMeta, Moment, ParticipantId};
use std::{collections::BTreeMap, fmt, path::Path};

/// What lets drives and answers into a study.
#[derive(Debug, Clone)]
pub struct Gate {
    design: Design,
    people: People,
    /// Whether there is a table of people: then nobody else is let in.
    listed: bool,
    forgotten: ForgottenList,
}

/// The rule for drives that did not last long enough.
pub(crate) const TOO_SHORT: &str = "exclude.drive_shorter_than_s";
/// The rule for sheets of one answer.
const STRAIGHT_LINED: &str = "exclude.straight_lined";

/// Why something is left out: a rule of the design, and the reason.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
pub struct LeftOut {
    /// The key of the rule, or `unknown condition`, `unknown participant`.
    pub rule: String,
    /// The reason.
    pub why: String,
}

impl LeftOut {
    /// With all that somebody answered who gave one answer to every item of a scale.
    pub(crate) fn straight_lined(scale: &str) -> Self {
        Self::by(
            STRAIGHT_LINED,
            format!("one answer to every item of `{scale}`, reversed ones too"),
        )
    }

    /// With what was said of a drive that did not last long enough.
    pub(crate) fn short(drive: &DriveId) -> Self {
        Self::by(
            TOO_SHORT,
            format!("about the drive {drive}, which is too short"),
        )
    }

    fn by(rule: &str, why: impl Into<String>) -> Self {
        Self {
            rule: rule.to_owned(),
            why: why.into(),
        }
    }
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "left out by {}: {}", self.rule, self.why)
    }
}

impl Gate {
    /// The gate of a design; people are `given`, or the design's own table.
    ///
    /// # Errors
    /// As [`DesignFile::people`].
    pub fn of(study: &DesignFile, given: Option<&Path>) -> Result<Self, StudyError> {
        Ok(Self {
            people: study.people(given)?,
            design: study.design.clone(),
            listed: true,
            forgotten: study.forgotten()?,
        })
    }

    /// As [`Gate::of`]; where no table is `given` and the design's own is not there, whoever is not left out by name is let in.
    ///
    /// # Errors
    /// As [`DesignFile::people`].
    pub fn where_listed(study: &DesignFile, given: Option<&Path>) -> Result<Self, StudyError> {
        let own = study.resolve(&study.design.people().file);
        if given.is_some() || own.is_file() {
            return Self::of(study, given);
        }
        Ok(Self {
            people: People::default(),
            design: study.design.clone(),
            listed: false,
            forgotten: study.forgotten()?,
        })
    }

    /// The people of the study, those who are left out among them.
    pub fn people(&self) -> &People {
        &self.people
    }

    /// Why a drive of this length (s) is left out; none where it is let in.
    pub fn drive(&self, meta: &DriveMeta, duration_s: f64) -> Option<LeftOut> {
        let exclude = self.design.exclude();
        if let Some(why) = exclude.drives.get(&meta.drive) {
            return Some(LeftOut::by("exclude.drives", why));
        }
        if let Some(out) = self.person(&meta.participant) {
            return Some(out);
        }
        if !self.design.knows(meta.condition) {
            return Some(self.unknown(meta.condition));
        }
        let shortest = exclude.drive_shorter_than_s?;
        (duration_s < shortest).then(|| {
            let why = format!("{duration_s:.0} s long, expected at least {shortest} s");
            LeftOut::by(TOO_SHORT, why)
        })
    }

    /// Why an answer is left out; one about an excluded drive goes with the drive.
    pub fn answer(&self, participant: &ParticipantId, moment: Moment) -> Option<LeftOut> {
        if let Some(out) = self.person(participant) {
            return Some(out);
        }
        let Moment::After(condition) = moment else {
            return None;
        };
        if !self.design.knows(condition) {
            return Some(self.unknown(condition));
        }
        let about = format!("{participant}-{condition}");
        let mut drives = self.design.exclude().drives.iter();
        let (_, why) = drives.find(|(drive, _)| drive.as_str() == about)?;
        Some(LeftOut::by("exclude.drives", why))
    }

    /// Why somebody is left out by name, or as unknown.
    pub fn person(&self, id: &ParticipantId) -> Option<LeftOut> {
        if self.forgotten.has(id) {
            return Some(LeftOut::by("forgotten", "the person was forgotten"));
        }
        if let Some(why) = self.design.exclude().person(id) {
            return Some(LeftOut::by("exclude.people", why));
        }
        let stranger = self.listed && self.people.find(id).is_none();
        stranger.then(|| {
            let why = format!("{id} is not in the table of people");
            LeftOut::by("unknown participant", why)
        })
    }

    fn unknown(&self, condition: ConditionId) -> LeftOut {
        let labels = ConditionId::listed(&self.design.labels());
        let why = format!("`{condition}` is none of the design's: {labels}");
        LeftOut::by("unknown condition", why)
    }
}

/// How many each rule left out, a line each: `2 drives left out by exclude.people`.
pub fn counted<'a>(what: &str, left_out: impl IntoIterator<Item = &'a LeftOut>) -> Vec<String> {
    let mut rules: BTreeMap<&str, usize> = BTreeMap::new();
    for out in left_out {
        *rules.entry(&out.rule).or_default() += 1;
    }
    let line = |(rule, n): (&str, usize)| format!("{n} {what} left out by {rule}");
    rules.into_iter().map(line).collect()
}
