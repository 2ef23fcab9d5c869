//! The shape of `study.toml`, before it is checked.

use super::{
    condition::{By, Donors, Sign},
    contrast::LevelContrast,
    exclude::Exclude,
    files::{BeyondRule, Files},
    outcome::{DeclaredTest, Homophily, ScoreName},
    people::Covariate,
    protocol::Protocol,
    validate::ValidateTables,
};
use crate::condition::ConditionId;
use serde::Deserialize;
use std::{collections::BTreeMap, path::PathBuf};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DesignToml {
    pub(super) study: StudyToml,
    #[serde(default)]
    pub(super) files: Files,
    #[serde(default)]
    pub(super) people: PeopleToml,
    #[serde(default)]
    pub(super) model: ModelToml,
    pub(super) style: Option<StyleToml>,
    #[serde(default)]
    pub(super) condition: Vec<ConditionToml>,
    pub(super) baseline: Option<DrivenToml>,
    #[serde(default)]
    pub(super) role: Vec<RoleToml>,
    #[serde(default)]
    pub(super) measure: Vec<MeasureToml>,
    #[serde(default)]
    pub(super) outcome: Vec<OutcomeToml>,
    #[serde(default)]
    pub(super) hypothesis: Vec<HypothesisToml>,
    #[serde(default)]
    pub(super) contrasts: ContrastsToml,
    #[serde(default)]
    pub(super) factor: Vec<FactorToml>,
    #[serde(default)]
    pub(super) covariate: Vec<Covariate>,
    pub(super) homophily: Option<Homophily>,
    #[serde(default)]
    pub(super) validate: ValidateTables,
    #[serde(default)]
    pub(super) protocol: Protocol,
    #[serde(default)]
    pub(super) exclude: Exclude,
    #[serde(default)]
    pub(super) amendments: BTreeMap<String, String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StudyToml {
    pub(super) title: String,
    #[serde(default)]
    pub(super) authors: Vec<String>,
    #[serde(default)]
    pub(super) synthetic: bool,
    pub(super) units: Option<Units>,
}

/// The units in which people read speeds and lengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Units {
    /// km/h and m.
    Metric,
    /// mph and m.
    Us,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ModelToml {
    pub(super) file: Option<PathBuf>,
    pub(super) made_up: bool,
    pub(super) beyond: BeyondRule,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PeopleToml {
    pub(super) file: Option<PathBuf>,
    pub(super) learn: Option<BTreeMap<String, CellToml>>,
    pub(super) test: Option<BTreeMap<String, CellToml>>,
}

/// What stands in a cell: `1` and `"1"` are the same there.
#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "a word, a whole number, true or false")]
pub(super) enum CellToml {
    Text(String),
    Number(i64),
    Flag(bool),
}

impl CellToml {
    pub(super) fn text(self) -> String {
        match self {
            Self::Text(text) => text,
            Self::Number(number) => number.to_string(),
            Self::Flag(flag) => flag.to_string(),
        }
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StyleToml {
    pub(super) score: ScoreName,
    pub(super) label: Option<String>,
    pub(super) range: Option<[f64; 2]>,
    pub(super) points: Option<f64>,
    pub(super) aggression: Option<Sign>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ConditionToml {
    pub(super) id: ConditionId,
    pub(super) label: Option<String>,
    pub(super) car: Option<CarToml>,
    #[serde(default)]
    pub(super) levels: BTreeMap<String, String>,
    pub(super) color: Option<String>,
    #[serde(default)]
    pub(super) expected: BTreeMap<String, Sign>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each stands for a word of the file"
)]
pub(super) struct CarToml {
    pub(super) dial: Option<DialToml>,
    #[serde(default)]
    pub(super) across: bool,
    #[serde(default)]
    pub(super) mean: bool,
    pub(super) embedding: Option<PathBuf>,
    #[serde(default)]
    pub(super) free: bool,
    pub(super) other: Option<OtherToml>,
    pub(super) from: Option<Donors>,
    pub(super) apart: Option<[f64; 2]>,
    pub(super) replay: Option<ReplayToml>,
    #[serde(default)]
    pub(super) recorded: bool,
    #[serde(default)]
    pub(super) vary: bool,
}

/// How somebody else's style is brought to the person's.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum OtherToml {
    Matched,
}

/// Whose drive is shown again.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum ReplayToml {
    Own,
}

#[derive(Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "points, such as -15, or steps in quotes, such as \"-1\""
)]
pub(super) enum DialToml {
    Points(f64),
    Steps(String),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DrivenToml {
    pub(super) id: ConditionId,
    pub(super) label: Option<String>,
    #[serde(default)]
    pub(super) by: By,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RoleToml {
    pub(super) id: ConditionId,
    pub(super) label: Option<String>,
    #[serde(default)]
    pub(super) by: By,
    pub(super) score: Option<f64>,
    pub(super) repeats: Option<ConditionId>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeasureToml {
    pub(super) id: String,
    pub(super) title: Option<String>,
    pub(super) unit: Option<String>,
    pub(super) aggression: Option<AggressionToml>,
}

/// Which way aggression moves it, as the file says it.
#[derive(Debug, Deserialize)]
pub(super) enum AggressionToml {
    #[serde(rename = "+")]
    Up,
    #[serde(rename = "-")]
    Down,
    #[serde(rename = "none")]
    Unknown,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OutcomeToml {
    pub(super) measure: Option<String>,
    pub(super) scale: Option<ScoreName>,
    pub(super) label: Option<String>,
    pub(super) same_within: Option<f64>,
    #[serde(default)]
    pub(super) primary: bool,
    pub(super) test: Option<DeclaredTest>,
    pub(super) contrast: Option<[ConditionId; 2]>,
    #[serde(default)]
    pub(super) drop_items: Vec<u32>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct HypothesisToml {
    pub(super) says: String,
    pub(super) outcome: String,
    pub(super) contrast: [ConditionId; 2],
    pub(super) direction: Option<Sign>,
    pub(super) equivalent: Option<[f64; 2]>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ContrastsToml {
    pub(super) compare: Option<CompareToml>,
    #[serde(default)]
    pub(super) factors: Vec<LevelContrast>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FactorToml {
    pub(super) column: Option<String>,
    pub(super) within: Option<String>,
    pub(super) label: Option<String>,
    #[serde(default)]
    pub(super) levels: BTreeMap<String, String>,
}

#[derive(Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "\"all\", \"against ID\", or a list of pairs of conditions"
)]
pub(super) enum CompareToml {
    Word(String),
    Pairs(Vec<[ConditionId; 2]>),
}
