//! Where a study's files are.

use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Paths, from the folder of the design's file.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Files {
    /// Every recording below it, whosever it is.
    pub logs: PathBuf,
    /// What the columns of logs mean: one file, or one a folder of logs.
    pub mapping: Mappings,
    /// Answers, before and after the conditions.
    pub answers: PathBuf,
    /// What wrote the answers.
    pub software: Software,
    /// Which column of the answers is which item.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub columns: Option<PathBuf>,
    /// Values of the study's own measures: participant, condition, perhaps session and trial, and a column for each `[[measure]]`.
    pub measures: PathBuf,
    /// Folder of questionnaires.
    pub scales: PathBuf,
    /// The world in which a learned style drives.
    pub scenario: PathBuf,
    /// The ledger of claims; without it there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub claims: Option<PathBuf>,
    /// Sizes of the effects by which made-up people answer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub effects: Option<PathBuf>,
}

impl Default for Files {
    fn default() -> Self {
        Self {
            logs: "logs".into(),
            mapping: Mappings::default(),
            answers: "surveys/answers.csv".into(),
            software: Software::default(),
            columns: None,
            measures: "measures.csv".into(),
            scales: "scales".into(),
            scenario: "scenario.toml".into(),
            claims: None,
            effects: None,
        }
    }
}

/// One mapping for all logs, or one a rig.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Mappings {
    /// One file for all.
    One(PathBuf),
    /// A file a folder of logs.
    Rigs(Vec<RigMapping>),
}

impl Default for Mappings {
    fn default() -> Self {
        Self::One("mapping.toml".into())
    }
}

/// The mapping of one folder of logs.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigMapping {
    /// The folder.
    pub logs: PathBuf,
    /// Its mapping; ours without.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
}

/// What wrote the answers.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Software {
    /// The table that is scored: a row an answer.
    #[default]
    Table,
    /// An export of oTree: a row a participant.
    Otree,
    /// The JSON of jsPsych: an array of trials a session.
    Jspsych,
    /// An export of Qualtrics: a row a response, with head rows of its own.
    Qualtrics,
    /// An export of `LimeSurvey`: a row a response.
    Limesurvey,
    /// `SoSci` Survey.
    Sosci,
    /// Anything else that writes a row a participant.
    Wide,
}

impl Software {
    /// Everything whose exports are imported: all but the table that is scored.
    pub const IMPORTED: [Self; 6] =
        [Self::Otree, Self::Jspsych, Self::Qualtrics, Self::Limesurvey, Self::Sosci, Self::Wide];

    /// Its word in a design and on the command line.
    pub fn id(self) -> &'static str {
        match self {
            Self::Table => "table",
            Self::Otree => "otree",
            Self::Jspsych => "jspsych",
            Self::Qualtrics => "qualtrics",
            Self::Limesurvey => "limesurvey",
            Self::Sosci => "sosci",
            Self::Wide => "wide",
        }
    }
}

/// A model that was learned elsewhere.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModelFile {
    /// The model, from the folder of the design's file. The score that it learned is put on the range of the study's style, end on end.
    pub file: PathBuf,
    /// Whether it learned from made-up people: whoever rides is told.
    pub made_up: bool,
}

/// What becomes of the conditions that turn the dial for somebody beyond what the model has learned from.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BeyondRule {
    /// They are left out, and listed.
    #[default]
    LeaveOut,
    /// They are driven all the same, and every figure says so.
    Drive,
}
