//! Questionnaires: what is asked, what was answered, what it scores.

use crate::{ConditionId, error::DomainError, ids::ParticipantId};
use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};

/// When a questionnaire was answered.
///
/// In a word it is `pre`, `post`, `probe:` with the id of the condition, or that id alone. Only a condition that is itself called `pre` or
/// `post` is written `after:pre`; `after:` may stand before any other, too.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Moment {
    /// Before the drives; about oneself.
    Pre,
    /// After a drive in this condition; about that drive.
    After(ConditionId),
    /// During a drive in this condition, again and again.
    Probe(ConditionId),
    /// At the end, after all drives.
    Post,
}

impl Moment {
    /// The words for [`Moment::Pre`] and [`Moment::Post`].
    const PRE: &str = "pre";
    const POST: &str = "post";
    /// What tells a condition from those words; no condition's id has a colon.
    const AFTER: &str = "after:";
    const PROBE: &str = "probe:";

    /// Whether a condition's id is also the word for [`Moment::Pre`].
    pub fn is_shared_word(condition: ConditionId) -> bool {
        condition.as_str() == Self::PRE
    }

    /// The condition that it is about.
    pub fn condition(self) -> Option<ConditionId> {
        match self {
            Self::After(condition) | Self::Probe(condition) => Some(condition),
            Self::Pre | Self::Post => None,
        }
    }
}

impl fmt::Display for Moment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pre => f.write_str(Self::PRE),
            Self::Post => f.write_str(Self::POST),
            Self::Probe(condition) => write!(f, "{}{condition}", Self::PROBE),
            Self::After(condition) if [Self::PRE, Self::POST].contains(&condition.as_str()) => {
                write!(f, "{}{condition}", Self::AFTER)
            }
            Self::After(condition) => condition.fmt(f),
        }
    }
}

impl FromStr for Moment {
    type Err = DomainError;
    fn from_str(text: &str) -> Result<Self, DomainError> {
        let (make, id): (fn(ConditionId) -> Self, &str) = match text {
            Self::PRE => return Ok(Self::Pre),
            Self::POST => return Ok(Self::Post),
            other => match other.strip_prefix(Self::PROBE) {
                Some(id) => (Self::Probe, id),
                None => (
                    Self::After,
                    other.strip_prefix(Self::AFTER).unwrap_or(other),
                ),
            },
        };
        id.parse()
            .map(make)
            .map_err(|_| DomainError::UnknownMoment {
                found: text.to_owned(),
            })
    }
}

impl TryFrom<String> for Moment {
    type Error = DomainError;
    fn try_from(text: String) -> Result<Self, DomainError> {
        text.parse()
    }
}

impl From<Moment> for String {
    fn from(moment: Moment) -> Self {
        moment.to_string()
    }
}

/// A group of items that are scored together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Subscale {
    /// Code name, such as `high_velocity`.
    pub id: String,
    /// Name for people.
    pub title: String,
    /// Its items, numbered from 1.
    pub items: Vec<u32>,
    /// Items reversed in this subscale only, beside those of the scale.
    #[serde(default)]
    pub reversed: Vec<u32>,
    /// Whether less of it is better, as of discomfort.
    #[serde(default)]
    pub lower_is_better: bool,
    /// The score that means "as I do", where items compare with oneself.
    #[serde(default)]
    pub same: Option<f64>,
    /// What a sample usually scores; made-up people are made to.
    #[serde(default)]
    pub norms: Option<Norms>,
}

/// What samples score on a subscale, in the unit of its score.
///
/// A number that was looked up names its publication; one that was not says `chosen`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Norms {
    /// Mean score.
    pub mean: f64,
    /// Standard deviation of the score.
    pub sd: f64,
    /// Cronbach's alpha.
    pub alpha: f64,
    /// Where mean and standard deviation are from: a publication, or `chosen`.
    pub source: String,
    /// Where alpha is from, if from elsewhere.
    #[serde(default)]
    pub alpha_source: Option<String>,
}

/// The usual correlation of two subscales' scores.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NormCorrelation {
    /// The two subscales.
    pub of: [String; 2],
    /// Pearson's r.
    pub r: f64,
    /// A publication, or `chosen`.
    pub source: String,
}

/// How the answers of a subscale become one score.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scoring {
    /// The sum over its items (a missing item counts as the mean of the answered ones).
    Sum,
    /// The mean of the answered items.
    Mean,
}

/// A questionnaire: its items, their range, and how they are scored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scale {
    /// Code name, such as `mini_ipip`.
    pub id: String,
    /// Name for people.
    pub title: String,
    /// Where the scale was published.
    pub reference: String,
    /// Number of items; they are numbered from 1.
    pub items: u32,
    /// Lowest answer.
    pub min: i32,
    /// Highest answer.
    pub max: i32,
    /// Sum or mean.
    pub scoring: Scoring,
    /// Items scored as `min + max - answer`.
    #[serde(default)]
    pub reversed: Vec<u32>,
    /// Share of a subscale's items that must be answered for it to be scored.
    #[serde(default = "default_min_answered")]
    pub min_answered: f64,
    /// What is scored; at least one.
    pub subscales: Vec<Subscale>,
    /// Item wording, where it is in the public domain; empty, or one text an item.
    #[serde(default)]
    pub wording: Vec<String>,
    /// How survey software names the column of an item: a pattern with `{item}`; without it `ID_{item}`.
    #[serde(default)]
    pub column: Option<String>,
    /// Usual correlations between subscales; made-up people are made to have them.
    #[serde(default)]
    pub correlations: Vec<NormCorrelation>,
}

fn default_min_answered() -> f64 {
    0.8
}

impl Scale {
    /// Says whether the definition agrees with itself.
    ///
    /// # Errors
    /// [`DomainError::BadScale`] naming the first contradiction.
    pub fn validate(&self) -> Result<(), DomainError> {
        let bad = |problem: String| DomainError::BadScale {
            scale: self.id.clone(),
            problem,
        };
        if self.items == 0 || self.subscales.is_empty() {
            return Err(bad("needs at least one item and one subscale".to_owned()));
        }
        if self.min >= self.max {
            return Err(bad(format!(
                "min {} is not below max {}",
                self.min, self.max
            )));
        }
        if !(self.min_answered > 0.0 && self.min_answered <= 1.0) {
            return Err(bad(format!(
                "min_answered {} is not in (0, 1]",
                self.min_answered
            )));
        }
        if !self.wording.is_empty() && self.wording.len() != self.items as usize {
            let found = self.wording.len();
            return Err(bad(format!(
                "wording has {found} texts for {} items",
                self.items
            )));
        }
        let known = |item: &u32| (1..=self.items).contains(item);
        if let Some(item) = self.reversed.iter().find(|i| !known(i)) {
            return Err(bad(format!(
                "reversed item {item} is not among its {} items",
                self.items
            )));
        }
        for sub in &self.subscales {
            if sub.items.is_empty() {
                return Err(bad(format!("subscale `{}` has no items", sub.id)));
            }
            if let Some(item) = sub.items.iter().chain(&sub.reversed).find(|i| !known(i)) {
                let id = &sub.id;
                return Err(bad(format!(
                    "subscale `{id}` names item {item} of {}",
                    self.items
                )));
            }
            let mut sorted = sub.items.clone();
            sorted.sort_unstable();
            if let Some([twice, ..]) = sorted.windows(2).find(|w| w[0] == w[1]) {
                return Err(bad(format!(
                    "subscale `{}` names item {twice} twice",
                    sub.id
                )));
            }
            let (low, high) = self.score_range(sub);
            if let Some(same) = sub.same.filter(|s| !(low..=high).contains(s)) {
                return Err(bad(format!(
                    "subscale `{}`: same is {same}, expected {low} to {high}",
                    sub.id
                )));
            }
            if let Some(norms) = &sub.norms {
                self.check_norms(sub, norms).map_err(bad)?;
            }
        }
        if let Some(column) = self.column.as_deref().filter(|c| !c.contains("{item}")) {
            return Err(bad(format!(
                "column `{column}` has no `{{item}}` where the item's number stands"
            )));
        }
        self.check_correlations().map_err(bad)
    }

    /// Lowest and highest possible score of a subscale.
    pub fn score_range(&self, subscale: &Subscale) -> (f64, f64) {
        let times = match self.scoring {
            Scoring::Mean => 1.0,
            Scoring::Sum => subscale.items.len() as f64,
        };
        (times * f64::from(self.min), times * f64::from(self.max))
    }

    fn check_norms(&self, sub: &Subscale, norms: &Norms) -> Result<(), String> {
        let (low, high) = self.score_range(sub);
        let key = |field: &str| format!("subscale `{}`: norms.{field}", sub.id);
        if !(norms.mean > low && norms.mean < high) {
            let (key, found) = (key("mean"), norms.mean);
            return Err(format!(
                "{key} is {found}, expected between {low} and {high}"
            ));
        }
        let widest = (high - low) / 2.0;
        if !(norms.sd > 0.0 && norms.sd < widest) {
            let (key, found) = (key("sd"), norms.sd);
            return Err(format!(
                "{key} is {found}, expected above 0 and below {widest}"
            ));
        }
        if !(norms.alpha > 0.0 && norms.alpha < 1.0) {
            let (key, found) = (key("alpha"), norms.alpha);
            return Err(format!("{key} is {found}, expected between 0 and 1"));
        }
        if norms.source.trim().is_empty() {
            let key = key("source");
            return Err(format!(
                "{key} is empty, expected a publication or `chosen`"
            ));
        }
        Ok(())
    }

    fn check_correlations(&self) -> Result<(), String> {
        for (n, found) in self.correlations.iter().enumerate() {
            let [a, b] = &found.of;
            let pair = format!("correlation of `{a}` and `{b}`");
            for id in [a, b] {
                if !self.subscales.iter().any(|s| s.id == *id) {
                    return Err(format!("{pair}: there is no subscale `{id}`"));
                }
            }
            let same = |c: &NormCorrelation| {
                c.of == [a.clone(), b.clone()] || c.of == [b.clone(), a.clone()]
            };
            if a == b || self.correlations[..n].iter().any(same) {
                return Err(format!("{pair} is given twice, or of one subscale"));
            }
            if !(found.r > -1.0 && found.r < 1.0) {
                return Err(format!("{pair} is {}, expected between -1 and 1", found.r));
            }
            if found.source.trim().is_empty() {
                return Err(format!(
                    "{pair}: source is empty, expected a publication or `chosen`"
                ));
            }
        }
        Ok(())
    }

    /// The column in which survey software keeps an item's answer, by the scale's pattern.
    pub fn column_of(&self, item: u32) -> String {
        let pattern = self.column.clone();
        let pattern = pattern.unwrap_or_else(|| format!("{}_{{item}}", self.id));
        pattern.replace("{item}", &item.to_string())
    }

    /// Whether `item` is reversed in `subscale`.
    pub fn is_reversed(&self, subscale: &Subscale, item: u32) -> bool {
        self.reversed.contains(&item) || subscale.reversed.contains(&item)
    }
}

/// One answer to one item.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    /// Who answered.
    pub participant: ParticipantId,
    /// When.
    pub moment: Moment,
    /// Code name of the scale.
    pub scale: String,
    /// Item number, from 1.
    pub item: u32,
    /// The answer; `None` where it was left out.
    pub answer: Option<i32>,
}

/// The score of one subscale for one participant at one moment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// Who answered.
    pub participant: ParticipantId,
    /// When.
    pub moment: Moment,
    /// Code name of the scale.
    pub scale: String,
    /// Code name of the subscale.
    pub subscale: String,
    /// The score; `None` where too few items were answered.
    pub value: Option<f64>,
    /// Items answered.
    pub answered: u32,
    /// Items of the subscale.
    pub items: u32,
}

/// A score on the Aggressive Driving Behavior scale: 11 to 55 points.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(try_from = "f64", into = "f64")]
pub struct AdbScore(f64);

impl AdbScore {
    /// Lowest score, in points.
    pub const MIN: f64 = 11.0;
    /// Highest score, in points.
    pub const MAX: f64 = 55.0;

    /// Takes 11 to 55 points.
    ///
    /// # Errors
    /// [`DomainError::OutOfRange`] for anything else.
    pub fn new(points: f64) -> Result<Self, DomainError> {
        if (Self::MIN..=Self::MAX).contains(&points) {
            Ok(Self(points))
        } else {
            Err(DomainError::OutOfRange {
                name: "ADB score",
                found: points,
                expected: "11 to 55 points",
            })
        }
    }

    /// Whether the scale has such a score, in points; one that only rounding puts outside counts as its end.
    pub fn has(points: f64) -> bool {
        const ROUNDING: f64 = 1e-9 * (AdbScore::MAX - AdbScore::MIN);
        (Self::MIN - ROUNDING..=Self::MAX + ROUNDING).contains(&points)
    }

    /// The points.
    pub fn points(self) -> f64 {
        self.0
    }
}

impl TryFrom<f64> for AdbScore {
    type Error = DomainError;
    fn try_from(points: f64) -> Result<Self, DomainError> {
        Self::new(points)
    }
}

impl From<AdbScore> for f64 {
    fn from(score: AdbScore) -> Self {
        score.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_survive_their_text() {
        for text in [
            "pre",
            "own",
            "mimic",
            "after:pre",
            "post",
            "after:post",
            "probe:mimic",
            "probe:post",
        ] {
            assert_eq!(text.parse::<Moment>().unwrap().to_string(), text);
        }
        let after = |id: &str| Moment::After(id.parse().unwrap());
        assert_eq!("pre".parse::<Moment>().unwrap(), Moment::Pre);
        assert_eq!("post".parse::<Moment>().unwrap(), Moment::Post);
        assert_eq!("after:pre".parse::<Moment>().unwrap(), after("pre"));
        assert_eq!("after:post".parse::<Moment>().unwrap(), after("post"));
        let probe = "probe:mimic".parse::<Moment>().unwrap();
        assert_eq!(
            (probe.condition(), Moment::Post.condition()),
            (after("mimic").condition(), None)
        );
        assert_eq!("after:mimic".parse::<Moment>().unwrap(), after("mimic"));
        assert!("probe:".parse::<Moment>().is_err() && "probe:after:a".parse::<Moment>().is_err());
        assert!("after:".parse::<Moment>().is_err() && "after:after:a".parse::<Moment>().is_err());
        assert!("after the drive".parse::<Moment>().is_err());
    }

    #[test]
    fn adb_scores_end_at_11_and_55() {
        assert!(AdbScore::new(10.9).is_err());
        assert!(AdbScore::new(f64::NAN).is_err());
        assert!(AdbScore::new(55.0).is_ok());
        assert!(AdbScore::has(55.0 + 1e-12) && AdbScore::has(11.0));
        for none in [55.1, 10.9, f64::NAN, f64::INFINITY] {
            assert!(!AdbScore::has(none), "{none}");
        }
    }

    const TWO_OF_FOUR: &str = r#"
id = "trust"
title = "Trust"
reference = "chosen"
items = 4
min = 1
max = 7
scoring = "sum"
reversed = [4]
min_answered = 1.0
wording = ["a", "b", "c", "d"]
column = "q{item}"
[[subscales]]
id = "own"
title = "Own"
items = [1, 2]
reversed = [1]
same = 14.0
norms = { mean = 8.0, sd = 2.5, alpha = 0.8, source = "chosen" }
[[subscales]]
id = "other"
title = "Other"
items = [3, 4]
[[correlations]]
of = ["own", "other"]
r = 0.4
source = "chosen"
"#;

    /// The scale with one line changed, and what is said of it.
    fn said(from: &str, to: &str) -> Result<Scale, String> {
        assert!(TWO_OF_FOUR.contains(from), "{from}");
        let scale: Scale = toml::from_str(&TWO_OF_FOUR.replacen(from, to, 1)).unwrap();
        scale.validate().map_err(|e| e.to_string())?;
        Ok(scale)
    }

    #[test]
    fn a_scale_that_agrees_with_itself_is_taken_up_to_its_ends() {
        let scale = said("alpha = 0.8", "alpha = 0.99").unwrap();
        assert_eq!(scale.score_range(&scale.subscales[0]), (2.0, 14.0));
        let reversed = |sub: usize| {
            let items = 1..=4;
            let is = |item: &u32| scale.is_reversed(&scale.subscales[sub], *item);
            items.filter(is).collect::<Vec<u32>>()
        };
        assert_eq!((reversed(0), reversed(1)), (vec![1, 4], vec![4]));
        assert_eq!(scale.column_of(3), "q3");
        let mean = said(
            "scoring = \"sum\"\nreversed",
            "scoring = \"mean\"\nreversed",
        );
        assert!(mean.unwrap_err().contains("same is 14, expected 1 to 7"));
        let plain = said("column = \"q{item}\"\n", "").unwrap();
        assert_eq!(plain.column_of(3), "trust_3");
        for (from, to) in [
            ("same = 14.0", "same = 2.0"),
            ("wording = [\"a\", \"b\", \"c\", \"d\"]\n", ""),
            ("min_answered = 1.0", "min_answered = 0.01"),
            ("mean = 8.0, sd = 2.5", "mean = 2.1, sd = 5.9"),
            ("r = 0.4", "r = -0.99"),
        ] {
            assert!(said(from, to).is_ok(), "{to}");
        }
    }

    #[test]
    fn each_contradiction_of_a_scale_is_named() {
        let twice =
            "of = [\"other\", \"own\"]\nr = 0.1\nsource = \"x\"\n[[correlations]]\nof = [\"own\"";
        for (from, to, word) in [
            ("items = 4", "items = 0", "at least one item"),
            ("max = 7", "max = 1", "min 1 is not below max 1"),
            ("min_answered = 1.0", "min_answered = 0.0", "not in (0, 1]"),
            ("min_answered = 1.0", "min_answered = 1.1", "not in (0, 1]"),
            ("\"c\", \"d\"]", "\"c\"]", "3 texts for 4 items"),
            ("reversed = [4]", "reversed = [5]", "reversed item 5"),
            ("reversed = [4]", "reversed = [0]", "reversed item 0"),
            ("items = [1, 2]", "items = []", "`own` has no items"),
            ("items = [1, 2]", "items = [1, 5]", "names item 5 of 4"),
            ("reversed = [1]", "reversed = [9]", "names item 9 of 4"),
            ("items = [1, 2]", "items = [2, 1, 2]", "item 2 twice"),
            ("same = 14.0", "same = 14.5", "expected 2 to 14"),
            ("same = 14.0", "same = 1.5", "expected 2 to 14"),
            ("mean = 8.0", "mean = 14.0", "norms.mean is 14"),
            ("mean = 8.0", "mean = 2.0", "norms.mean is 2"),
            ("sd = 2.5", "sd = 6.0", "above 0 and below 6"),
            ("sd = 2.5", "sd = 0.0", "norms.sd is 0"),
            ("alpha = 0.8", "alpha = 1.0", "norms.alpha is 1"),
            ("alpha = 0.8", "alpha = 0.0", "norms.alpha is 0"),
            ("source = \"chosen\" }", "source = \" \" }", "norms.source"),
            ("column = \"q{item}\"", "column = \"q\"", "no `{item}`"),
            (
                "\"own\", \"other\"]",
                "\"own\", \"own\"]",
                "of one subscale",
            ),
            (
                "\"own\", \"other\"]",
                "\"own\", \"so\"]",
                "no subscale `so`",
            ),
            ("of = [\"own\"", twice, "given twice"),
            ("r = 0.4", "r = 1.0", "is 1, expected between -1 and 1"),
            ("r = 0.4", "r = -1.0", "is -1, expected between"),
            (
                "0.4\nsource = \"chosen\"",
                "0.4\nsource = \"\"",
                "source is empty",
            ),
        ] {
            let error = said(from, to).unwrap_err();
            assert!(error.contains(word), "{to}: {error}");
        }
        let none = toml::from_str::<Scale>(TWO_OF_FOUR).unwrap();
        let none = Scale {
            subscales: Vec::new(),
            ..none
        };
        assert!(none.validate().is_err());
    }
}
