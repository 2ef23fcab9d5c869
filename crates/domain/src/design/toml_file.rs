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

#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DesignToml {
    /// What heads the page.
    pub(super) study: StudyToml,
    /// Paths from this file's folder.
    #[serde(default)]
    pub(super) files: Files,
    /// Who takes part.
    #[serde(default)]
    pub(super) people: PeopleToml,
    /// The model of the study.
    #[serde(default)]
    pub(super) model: ModelToml,
    /// What the dial turns.
    pub(super) style: Option<StyleToml>,
    /// The conditions: what people sit through, or drive.
    #[serde(default)]
    pub(super) condition: Vec<ConditionToml>,
    /// The drive that differences are taken from.
    pub(super) baseline: Option<DrivenToml>,
    /// Drives by hand that were asked to be different: learned from, never tested.
    #[serde(default)]
    pub(super) role: Vec<RoleToml>,
    /// The study's own measures. Each is an outcome like those of the drives.
    #[serde(default)]
    pub(super) measure: Vec<MeasureToml>,
    /// What is tested; left out, all objective measures, the study's own and every scale asked after a condition.
    #[serde(default)]
    pub(super) outcome: Vec<OutcomeToml>,
    /// What was predicted.
    #[serde(default)]
    pub(super) hypothesis: Vec<HypothesisToml>,
    /// What is compared: one Holm family an outcome.
    #[serde(default)]
    pub(super) contrasts: ContrastsToml,
    /// Factors between people (`column`), and the labels of those that the conditions cross (`within`).
    #[serde(default)]
    pub(super) factor: Vec<FactorToml>,
    /// Columns of numbers of the people's table that go along with the outcomes.
    #[serde(default)]
    pub(super) covariate: Vec<Covariate>,
    /// Traits against ratings: one family.
    pub(super) homophily: Option<Homophily>,
    /// What a person meets in the seat: steps, texts, lengths.
    #[serde(default)]
    pub(super) validate: ValidateTables,
    #[serde(default)]
    pub(super) protocol: Protocol,
    /// What is left out before anything is computed.
    #[serde(default)]
    pub(super) exclude: Exclude,
    /// Key changed since the design was frozen = reason.
    #[serde(default)]
    pub(super) amendments: BTreeMap<String, String>,
}

#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StudyToml {
    /// Heads the page.
    pub(super) title: String,
    /// Who made the study.
    #[serde(default)]
    pub(super) authors: Vec<String>,
    /// Whether the people are made up: said on every page.
    #[serde(default)]
    pub(super) synthetic: bool,
    /// How people read speeds, on every page and in the seat: km/h (the default) or mph.
    pub(super) units: Option<Units>,
}

/// The units in which people read speeds and lengths.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Units {
    /// km/h and m.
    Metric,
    /// mph and m.
    Us,
}

#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ModelToml {
    /// A model that was learned elsewhere.
    pub(super) file: Option<PathBuf>,
    /// The file was learned from made-up people; whoever rides is told.
    pub(super) made_up: bool,
    /// What becomes of the conditions that turn the dial for somebody beyond what the model has learned from: left out and listed, or driven all the
    /// same, and every figure says so.
    pub(super) beyond: BeyondRule,
}

#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PeopleToml {
    /// A row a person; every further column may be a factor or a covariate.
    pub(super) file: Option<PathBuf>,
    /// Whose drives the networks learn from: column = value, all must hold.
    pub(super) learn: Option<BTreeMap<String, CellToml>>,
    /// Who sat through the conditions; without, everybody who is not learned from.
    pub(super) test: Option<BTreeMap<String, CellToml>>,
}

/// What stands in a cell: `1` and `"1"` are the same there.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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

#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StyleToml {
    /// SCALE.SUBSCALE, asked before the drives.
    pub(super) score: ScoreName,
    /// On the page.
    pub(super) label: Option<String>,
    /// Lowest and highest score; of the scale's file without.
    pub(super) range: Option<[f64; 2]>,
    /// A step of the dial.
    #[cfg_attr(feature = "schema", schemars(extend("exclusiveMinimum" = 0)))]
    pub(super) points: Option<f64>,
    /// Which way a more aggressive driver scores; + without. A dial above 0 is a higher score either way.
    pub(super) aggression: Option<Sign>,
}

#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ConditionToml {
    /// In file names, orders and answers.
    pub(super) id: ConditionId,
    /// On the page.
    pub(super) label: Option<String>,
    /// What the car does; left out, it was yours and only its logs are read.
    pub(super) car: Option<CarToml>,
    /// Factor = level, where conditions cross factors.
    #[serde(default)]
    pub(super) levels: BTreeMap<String, String>,
    /// Its colour in figures, as `#rrggbb`.
    #[cfg_attr(feature = "schema", schemars(extend("pattern" = "^#[0-9A-Fa-f]{6}$")))]
    pub(super) color: Option<String>,
    /// Outcome = which way it turns against the baseline.
    #[serde(default)]
    pub(super) expected: BTreeMap<String, Sign>,
}

#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(clippy::struct_excessive_bools, reason = "each stands for a word of the file")]
pub(super) struct CarToml {
    /// Points of the style, or steps in quotes; 0 is the person's own style.
    pub(super) dial: Option<DialToml>,
    /// At right angles to the dial.
    #[serde(default)]
    pub(super) across: bool,
    /// The average driver.
    #[serde(default)]
    pub(super) mean: bool,
    /// A style from a file.
    pub(super) embedding: Option<PathBuf>,
    /// The person turns the dial while riding.
    #[serde(default)]
    pub(super) free: bool,
    /// Somebody else's style, moved along the dial to the person's own score.
    pub(super) other: Option<OtherToml>,
    /// Beside other: who lends theirs; tested (default): the others who are tested once ten have driven, until then those whom the model learned
    /// from.
    pub(super) from: Option<Donors>,
    /// Beside other: how far donor and person lie apart across the dial, least and most, in standard deviations; `[0.7, 2.5]` without.
    pub(super) apart: Option<[f64; 2]>,
    /// The person's own drive by hand once more, shown as automation; every ride in its world (protocol.world = "same") and as long as it
    /// (protocol.ride_s = drive_s).
    pub(super) replay: Option<ReplayToml>,
    /// Driven elsewhere: logs are read, nothing is simulated.
    #[serde(default)]
    pub(super) recorded: bool,
}

/// How somebody else's style is brought to the person's.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum OtherToml {
    /// Moved along the dial to the person's own score.
    Matched,
}

/// Whose drive is shown again.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum ReplayToml {
    /// Their own by hand.
    Own,
}

#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "points, such as -15, or steps in quotes, such as \"-1\"")]
pub(super) enum DialToml {
    Points(f64),
    Steps(String),
}

#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DrivenToml {
    /// In file names; may be a condition's.
    pub(super) id: ConditionId,
    /// On the page.
    pub(super) label: Option<String>,
    /// Who drove; by hand without.
    #[serde(default)]
    pub(super) by: By,
}

#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RoleToml {
    /// In file names; may be a condition's.
    pub(super) id: ConditionId,
    /// On the page.
    pub(super) label: Option<String>,
    /// Who drove; by hand without.
    #[serde(default)]
    pub(super) by: By,
    /// The score that everybody's drive in it has, in points of `[style]`, where it was the instruction that gave it.
    pub(super) score: Option<f64>,
    /// The role that it is driven once more; it has that one's score.
    pub(super) repeats: Option<ConditionId>,
}

#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeasureToml {
    /// Its column, and its id as an outcome.
    #[cfg_attr(feature = "schema", schemars(extend("pattern" = "^[A-Za-z0-9_-]+$")))]
    pub(super) id: String,
    /// On the page; the id without.
    pub(super) title: Option<String>,
    /// Unit of its values; "1" for a count or a share.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub(super) unit: Option<String>,
    /// Which way a more aggressive drive moves it; none where that is not known.
    pub(super) aggression: Option<AggressionToml>,
}

/// Which way aggression moves it, as the file says it.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Deserialize)]
pub(super) enum AggressionToml {
    /// Up.
    #[serde(rename = "+")]
    Up,
    /// Down.
    #[serde(rename = "-")]
    Down,
    /// Not known.
    #[serde(rename = "none")]
    Unknown,
}

#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OutcomeToml {
    /// A column of the measurements, or the id of a `[[measure]]`.
    pub(super) measure: Option<String>,
    /// SCALE.SUBSCALE, asked after a condition.
    pub(super) scale: Option<ScoreName>,
    /// On the page.
    pub(super) label: Option<String>,
    /// A mean difference of the own-style car from the own drive of at most this much counts as none, in the unit of the page; half a standard
    /// deviation between people without.
    #[cfg_attr(feature = "schema", schemars(extend("exclusiveMinimum" = 0)))]
    pub(super) same_within: Option<f64>,
    /// Whether it decides: its test and one contrast are declared. Several are tested in the order written, each at .05, until the first that is not
    /// below it, or that cannot be tested.
    #[serde(default)]
    pub(super) primary: bool,
    /// Its test: a mixed or an ordinal model with the period where orders are known; rm-anova and friedman where none are; auto, by what the data
    /// look like and without the period, not of a primary outcome. Where conditions cross two factors, or beside a `[[factor]]` of people or a
    /// `[[covariate]]`, a primary outcome takes mixed alone. Left out: with the period where orders are known, else auto.
    pub(super) test: Option<DeclaredTest>,
    /// Of a primary outcome: the pair that decides, first minus second.
    pub(super) contrast: Option<[ConditionId; 2]>,
    /// Items of the score that name what the conditions turn, such as `aggressive` of a rating of discomfort: everything is tested once more without
    /// them, beside the verdict.
    #[cfg_attr(feature = "schema", schemars(extend("uniqueItems" = true)))]
    #[cfg_attr(feature = "schema", schemars(inner(range(min = 1))))]
    #[serde(default)]
    pub(super) drop_items: Vec<u32>,
}

#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct HypothesisToml {
    /// In words.
    pub(super) says: String,
    /// Of an outcome.
    pub(super) outcome: String,
    /// First minus second.
    pub(super) contrast: [ConditionId; 2],
    /// Which way the contrast is predicted to turn.
    pub(super) direction: Option<Sign>,
    /// Claimed to lie within, in the unit of the page: a speed in km/h, or in mph with units = "us".
    pub(super) equivalent: Option<[f64; 2]>,
}

#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ContrastsToml {
    /// "all", "against ID", or pairs of conditions.
    pub(super) compare: Option<CompareToml>,
    /// Contrasts of factors' levels: `factor = ["first", "second"]` is a difference, of two factors a difference of differences; `factor = "level"`
    /// holds it there; every other factor is averaged.
    #[serde(default)]
    pub(super) factors: Vec<LevelContrast>,
}

#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FactorToml {
    /// A column of the people's table.
    pub(super) column: Option<String>,
    /// A factor that the conditions cross.
    pub(super) within: Option<String>,
    /// On the page.
    #[cfg_attr(feature = "schema", schemars(length(max = 60)))]
    pub(super) label: Option<String>,
    /// Level = what the page calls it.
    #[serde(default)]
    pub(super) levels: BTreeMap<String, String>,
}

#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "\"all\", \"against ID\", or a list of pairs of conditions")]
pub(super) enum CompareToml {
    /// `all`, or `against` one.
    #[cfg_attr(feature = "schema", schemars(extend("pattern" = "^(all|against .+)$")))]
    Word(String),
    /// These, and no others.
    Pairs(Vec<[ConditionId; 2]>),
}
