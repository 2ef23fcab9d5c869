//! Who and what a design lets in: its people, its conditions, and not what `[exclude]` names.

use crate::{
    atomic_write::read_json,
    design::{DesignFile, People},
    error::StudyError,
    forgotten::ForgottenList,
    once::count,
};
use maveric_analysis::{Flow, LeftOutFor};
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
    analysed: Analysed,
}

/// Whom and which drives the rules of `[exclude]` left out of the analysis, each with the reason.
#[derive(Debug, Clone, Default)]
pub(crate) struct Analysed {
    people: BTreeMap<String, String>,
    drives: BTreeMap<String, String>,
}

/// What is read of an analysis.
#[derive(serde::Deserialize)]
struct Counted {
    flow: Flow,
}

impl Analysed {
    /// Those of the analysis among the results of a study; none where nothing is analysed yet.
    ///
    /// # Errors
    /// [`StudyError`] for an analysis that cannot be read.
    pub(crate) fn of(results: &Path) -> Result<Self, StudyError> {
        let file = results.join("analysis.json");
        if !file.is_file() {
            return Ok(Self::default());
        }
        let flow = read_json::<Counted>(&file)?.flow;
        let by_id = |rows: Vec<LeftOutFor>| {
            let ids = |row: LeftOutFor| {
                let LeftOutFor { why, who } = row;
                who.into_iter().map(move |id| (id, why.clone()))
            };
            rows.into_iter().flat_map(ids).collect()
        };
        Ok(Self {
            people: by_id(flow.left_out),
            drives: by_id(flow.drives),
        })
    }

    /// Ids of people, then of drives, with the reason.
    pub(crate) fn all(&self) -> impl Iterator<Item = (&str, &str)> {
        let all = self.people.iter().chain(&self.drives);
        all.map(|(id, why)| (id.as_str(), why.as_str()))
    }
}

/// The rule for drives that did not last long enough.
pub(crate) const TOO_SHORT: &str = "exclude.drive_shorter_than_s";
/// The rule for sheets of one answer.
const STRAIGHT_LINED: &str = "exclude.straight_lined";
/// The rules that look at all that somebody did, as the analysis applied them.
const RULES: &str = "the rules of exclude";

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
            analysed: Analysed::default(),
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
            analysed: Analysed::default(),
        })
    }

    /// The same, without whom and what the rules left out of the analysis among these results.
    ///
    /// # Errors
    /// As [`Analysed::of`].
    pub(crate) fn with_analysis(mut self, results: &Path) -> Result<Self, StudyError> {
        self.analysed = Analysed::of(results)?;
        Ok(self)
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
        let short = exclude.drive_shorter_than_s.filter(|s| duration_s < *s);
        if let Some(shortest) = short {
            let why = format!("{duration_s:.0} s long, expected at least {shortest} s");
            return Some(LeftOut::by(TOO_SHORT, why));
        }
        let why = self.analysed.drives.get(meta.drive.as_str())?;
        Some(LeftOut::by(RULES, why))
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
        if let Some((_, why)) = drives.find(|(drive, _)| drive.as_str() == about) {
            return Some(LeftOut::by("exclude.drives", why));
        }
        let why = self.analysed.drives.get(&about)?;
        Some(LeftOut::by(RULES, why))
    }

    /// Why somebody is left out by name, or as unknown.
    pub fn person(&self, id: &ParticipantId) -> Option<LeftOut> {
        if self.forgotten.has(id) {
            return Some(LeftOut::by("forgotten", "the person was forgotten"));
        }
        if let Some(why) = self.design.exclude().person(id) {
            return Some(LeftOut::by("exclude.people", why));
        }
        if let Some(why) = self.analysed.people.get(id.as_str()) {
            return Some(LeftOut::by(RULES, why));
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
pub fn counted<'a>(
    [one, several]: [&str; 2],
    left_out: impl IntoIterator<Item = &'a LeftOut>,
) -> Vec<String> {
    let mut rules: BTreeMap<&str, usize> = BTreeMap::new();
    for out in left_out {
        *rules.entry(&out.rule).or_default() += 1;
    }
    let line = |(rule, n): (&str, usize)| format!("{} left out by {rule}", count(n, one, several));
    rules.into_iter().map(line).collect()
}
