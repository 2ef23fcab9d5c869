//! What can keep the seat from running a study.

use maveric_domain::{
    ConditionId,
    design::{FEWEST_DONORS, ScoreName, Software},
    survey::Kind,
};

/// Answers of a probe: 0 to 100 by 5 still is one row of buttons.
pub(crate) const MOST_PROBE_ANSWERS: usize = 21;

/// One thing that a study lacks, or that the seat cannot do.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Hindrance {
    /// Answers that another program is to export, where the seat writes its own.
    #[error("`files.software` is `{software:?}`, and the seat writes its answers as a plain table")]
    Software { software: Software },
    /// A scale that no file has.
    #[error("[protocol] asks scale `{scale}`, and there are {}", known.join(", "))]
    UnknownScale {
        scale: String,
        known: Vec<String>,
        /// The scale that is nearest to it.
        nearest: Option<String>,
    },
    /// A scale whose items nobody could read.
    #[error(
        "[protocol] asks scale `{scale}`, whose file has wording for {worded} of {items} items"
    )]
    NoWording { scale: String, worded: usize, items: usize },
    /// A scale without the study's language.
    #[error(
        "[protocol] asks scale `{scale}` in `{language}`, and its file has it in {}", languages.join(", ")
    )]
    NoTranslation { scale: String, language: String, languages: Vec<String> },
    /// The score that the style is learned by is never asked.
    #[error("the style is learned by `{score}`, and [protocol] does not ask scale `{}` before the drives", score.scale)]
    StyleNotAsked { score: ScoreName },
    /// Somebody is to be learned from and drives nowhere by hand.
    #[error("people are learned from, and [protocol] `steps` has no `drive`")]
    NoDrive,
    /// Rides, and nothing that could drive them.
    #[error("the study has rides and no model that could drive them")]
    NoModel,
    /// Rides of which nobody is told whose style or whose drive they are, and no text that says so afterwards.
    #[error(
        "condition `{condition}` shows people somebody else's style or their own drive, and they are not told so before: found no `protocol.debrief`, expected a text that says it afterwards"
    )]
    NoDebriefing { condition: ConditionId },
    /// A condition that asks of the model what it does not have.
    #[error("condition `{condition}` cannot be driven by the model: {why}")]
    NotByModel { condition: ConditionId, why: String },
    /// A condition in which somebody else's style is lent, and too few who could lend theirs.
    #[error(
        "condition `{condition}` lends somebody else's style: {donors} drives that the model learned from may be lent, expected {FEWEST_DONORS} or more"
    )]
    FewDonors {
        condition: ConditionId,
        /// Drives that the model learned from, but for those whose people do not let their style be lent.
        donors: usize,
        /// Whether the model is this study's.
        learned_here: bool,
    },
    /// A condition whose file of styles cannot be used.
    #[error("condition `{condition}`: {problem}")]
    Styles { condition: ConditionId, problem: String, remedy: String },
    /// A condition whose drives the program would make again.
    #[error(
        "condition `{condition}`: its drives would be simulated again by `maveric run`, expected those of the seat"
    )]
    SimulatedAgain { condition: ConditionId },
    /// A condition that the seat cannot drive.
    #[error("condition `{condition}`: {problem}")]
    Car { condition: ConditionId, problem: &'static str },
    /// A scale of more than one item that is to be asked on the way.
    #[error("[protocol] `probe` asks scale `{scale}`, which has {items} items, expected one")]
    ProbeItems { scale: String, items: u32 },
    /// A scale that is to be asked on the way, and whose answer would have to be written.
    #[error(
        "[protocol] `probe` asks scale `{scale}`, whose item is a `{}`, expected one that is answered by pressing a button",
        kind.name()
    )]
    ProbeKind { scale: String, kind: Kind },
    /// A scale that is to be asked on the way with more buttons than one can choose from while riding.
    #[error(
        "[protocol] `probe` asks scale `{scale}`, whose item has {answers} answers, expected {MOST_PROBE_ANSWERS} at most: each is a button over the road"
    )]
    ProbeAnswers { scale: String, answers: usize },
    /// A rule on an item that is not asked, or on an answer that it does not have.
    #[error("[protocol] `{key}`: `{rule}`: {problem}")]
    Rule {
        /// The key of the design.
        key: &'static str,
        /// The rule, as the design has it.
        rule: String,
        problem: String,
    },
    /// A consent that names a day which the study does not have.
    #[error("the consent says {{withdraw_until}}, and [protocol] has no `withdraw_until`")]
    NoLastDay,
    /// A crash that is heard and seen, and people who are not told so before they agree.
    #[error("[protocol] `crash` is \"felt\", and the consent does not name it")]
    CrashNotNamed,
    /// A consent that names a crash which nobody hears or sees.
    #[error(
        "the consent says {{crash}}, and [protocol] `crash` is \"ends\": nobody hears or sees one"
    )]
    NoCrash,
}

impl Hindrance {
    pub(crate) fn no_car(condition: ConditionId, problem: &'static str) -> Self {
        Self::Car { condition, problem }
    }

    /// What is wrong and what to do, in a line.
    pub fn with_remedy(&self) -> String {
        format!("{self}: {}", self.remedy())
    }

    pub fn remedy(&self) -> String {
        match self {
            Self::Software { .. } => {
                "leave `software` and `columns` out of [files], or give the seat a study of its own".to_owned()
            }
            Self::UnknownScale { scale, nearest, .. } => match nearest {
                Some(nearest) => format!("did you mean `{nearest}`?"),
                None => format!("write scales/{scale}.toml, or take it out of `before` or `after`"),
            },
            Self::NoWording { scale, .. } => format!(
                "write what is asked into `wording` or `pairs` of scales/{scale}.toml, a text an item, from the publication that the file names"
            ),
            Self::NoTranslation { scale, language, .. } => format!(
                "write [translation.{language}] into scales/{scale}.toml, from a translation that was published; if its words are in `{language}`, language = \"{language}\""
            ),
            Self::StyleNotAsked { score } => {
                format!("write before = [\"{}\"] into [protocol], and \"before\" into its `steps`", score.scale)
            }
            Self::NoDebriefing { .. } => "write `debrief = \"debrief.md\"` into [protocol], and beside the design the text that says it".to_owned(),
            Self::NoDrive => "write \"drive\" into `steps`".to_owned(),
            Self::NoModel => {
                "name one in [model] file, or say in [people] learn who is learned from first".to_owned()
            }
            Self::NotByModel { .. } => {
                "learn a model of two numbers or more from people who answered the scale of [style]".to_owned()
            }
            Self::FewDonors {
                learned_here: false,
                ..
            } => format!(
                "name a model in [model] `file` that learned from {FEWEST_DONORS} drives or more, or give the condition another `car`"
            ),
            Self::FewDonors { .. } => {
                "learn a model from more people who tick that their style may be lent, or give the condition another `car`".to_owned()
            }
            Self::Styles { remedy, .. } => remedy.clone(),
            Self::SimulatedAgain { .. } => {
                "write `recorded = true` into its `car`: what was ridden in the seat is what is analysed".to_owned()
            }
            Self::Car { .. } => {
                "the seat drives `car = { dial = 8, recorded = true }`, `across`, `mean`, `embedding`, `other` and `free`".to_owned()
            }
            Self::ProbeItems { .. } => {
                "name a scale of one item, such as probe = { scale = \"misc\", every_s = 60 }".to_owned()
            }
            Self::ProbeKind { .. } => {
                "name a scale with kind = \"likert\", \"bipolar\", \"slider\", \"ladder\" or \"choice\"".to_owned()
            }
            Self::ProbeAnswers { scale, .. } => {
                format!("write a larger `step` into scales/{scale}.toml, such as 5 of 0 to 100")
            }
            Self::Rule { .. } => "write SCALE.NUMBER, or SCALE.SUBSCALE of one item".to_owned(),
            Self::NoLastDay => {
                "write withdraw_until = \"2027-01-31\" there, or leave it out of the text".to_owned()
            }
            Self::CrashNotNamed => {
                "write {crash} where the consent says what happens, and \"consent\" into `steps`: a sentence stands in its place; or leave `crash` out".to_owned()
            }
            Self::NoCrash => {
                "leave {crash} out of the text, or write crash = \"felt\" there".to_owned()
            }
        }
    }
}
