//! What a page says of a question: the parts that were judged, the rule of each, and what became of all together.

use crate::verdict::{Verdict, directed, significant, within};
use maveric_domain::design::Sign;
use maveric_stats::{Proportion, proportion_exact};
use serde::{Deserialize, Serialize};
use std::fmt;

/// What is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
#[non_exhaustive]
pub enum Question {
    /// What was declared before the study, by its place in the design, from 1.
    Hypothesis(usize),
    /// Does a primary outcome differ as declared, by its place among them, from 1?
    Primary(usize),
    /// Does the car at 0 on the dial drive as its driver does?
    OwnStyle,
    /// Is it nearer to its driver than the other cars are?
    Nearer,
    /// Does turning the dial change the driving as it says?
    Dial,
    /// Do the conditions drive the way that was expected?
    Expected,
    /// Do people feel the difference that was meant?
    Noticed,
    /// Do the conditions differ at all?
    Differ,
    /// Do the differences of an outcome stay by another choice, such as a score without some items?
    Stays,
    /// Does driving alone tell the score of the style?
    Style,
    /// Does moving across the dial change a habit that the dial leaves alone?
    Across,
    /// Do people like best a car near their own style?
    Congruence,
    /// Do people tell which of two rides was in their own style?
    Which,
    /// Do people prefer their own style?
    Preferred,
    /// Does personality tell which style one wants?
    Personality,
    /// Do people press more in some conditions than in others?
    Pressed,
    /// Was the ride another one just before they press?
    BeforePress,
    /// Does a person drive in the second session as in the first?
    Retest,
    /// Do the paper's numbers come out?
    Paper,
    /// Is a driver recognised on another day?
    Recognised,
    /// Does the car stay clear of others?
    Safe,
    /// Is every part of the model worth having?
    Parts,
    /// Is anything found where there is nothing?
    Families,
    /// Is each test as strict as it says?
    Single,
    /// Would a study of this size show what is there?
    Power,
    /// Does knowing the driver help?
    Personal,
    /// Does the follower stay behind its leader?
    Reached,
    /// Does the line place the drives of people whom the model has not met as they were told to drive?
    Order,
    /// Does the line say more of that than speed alone?
    BeyondSpeed,
    /// Does the dial point the way in which people themselves differ between the roles?
    Direction,
}

/// Ids of the questions that are asked once, in JSON and on pages; a hypothesis is `hypothesis-1`, and so on.
const IDS: [(Question, &str); 28] = [
    (Question::OwnStyle, "own-style"),
    (Question::Nearer, "nearer"),
    (Question::Dial, "dial"),
    (Question::Expected, "expected"),
    (Question::Noticed, "noticed"),
    (Question::Differ, "differ"),
    (Question::Stays, "stays"),
    (Question::Style, "style"),
    (Question::Across, "across"),
    (Question::Congruence, "congruence"),
    (Question::Which, "which"),
    (Question::Preferred, "preferred"),
    (Question::Personality, "personality"),
    (Question::Pressed, "pressed"),
    (Question::BeforePress, "before-press"),
    (Question::Retest, "retest"),
    (Question::Paper, "paper"),
    (Question::Recognised, "recognised"),
    (Question::Safe, "safe"),
    (Question::Parts, "parts"),
    (Question::Families, "families"),
    (Question::Single, "single"),
    (Question::Power, "power"),
    (Question::Personal, "personal"),
    (Question::Reached, "reached"),
    (Question::Order, "order"),
    (Question::BeyondSpeed, "beyond-speed"),
    (Question::Direction, "direction"),
];
const HYPOTHESIS: &str = "hypothesis-";
const PRIMARY: &str = "primary-";

impl fmt::Display for Question {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Hypothesis(number) => return write!(f, "{HYPOTHESIS}{number}"),
            Self::Primary(number) => return write!(f, "{PRIMARY}{number}"),
            _ => {}
        }
        let id = IDS.iter().find(|(question, _)| question == self);
        f.write_str(id.map_or("", |(_, id)| id))
    }
}

impl From<Question> for String {
    fn from(question: Question) -> Self {
        question.to_string()
    }
}

impl TryFrom<String> for Question {
    type Error = String;

    fn try_from(id: String) -> Result<Self, String> {
        let number = |prefix: &str| id.strip_prefix(prefix).and_then(|n| n.parse().ok());
        let named = IDS.iter().find(|(_, known)| *known == id);
        let hypothesis = number(HYPOTHESIS).map(Self::Hypothesis);
        hypothesis
            .or_else(|| number(PRIMARY).map(Self::Primary))
            .or_else(|| named.map(|(question, _)| *question))
            .ok_or_else(|| format!("`{id}` is not a known question"))
    }
}

/// How many of the parts have to hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Needed {
    /// Every part: it fails where one does.
    Every,
    /// One is enough; it fails where all do.
    One,
}

/// By what a part is judged.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "rule")]
pub enum Rule {
    /// The estimate has this sign with p below .05; fails if it has the other.
    Directed {
        /// The sign.
        expected: Sign,
    },
    /// p is below .05, whichever way.
    Differs,
    /// The interval lies within these ends; fails if all of it lies outside. No end: nothing on that side.
    Within {
        /// Lower end.
        low: Option<f64>,
        /// Upper end.
        high: Option<f64>,
    },
    /// Two one-sided tests place the estimate within these ends; fails if one of them places it outside.
    Same {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// It never happens.
    Never,
}

/// One comparison, correlation or share that was judged.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// What it is of, in ids: an outcome, and the conditions where it is of two; words of its own where there are no ids.
    pub of: String,
    /// People, drivers, drives or studies.
    pub n: usize,
    /// What was estimated, such as a mean difference, an effect, a correlation or a share; none where there is none.
    pub estimate: Option<f64>,
    /// Lower and upper end of its interval.
    pub interval: Option<(f64, f64)>,
    /// The p that decides.
    pub p: Option<f64>,
    /// By what it is judged.
    #[serde(flatten)]
    pub rule: Rule,
    /// What became of it.
    pub verdict: Verdict,
}

impl Part {
    /// An estimate that should have a sign, by its p.
    pub fn directed(
        of: impl Into<String>,
        n: usize,
        (estimate, p): (Option<f64>, Option<f64>),
        expected: Sign,
    ) -> Self {
        Self {
            of: of.into(),
            n,
            estimate,
            interval: None,
            p,
            rule: Rule::Directed { expected },
            verdict: directed(n, estimate, p, expected),
        }
    }

    /// An estimate that should not be 0, whichever way, by its p.
    pub fn differs(
        of: impl Into<String>,
        n: usize,
        (estimate, p): (Option<f64>, Option<f64>),
    ) -> Self {
        Self {
            of: of.into(),
            n,
            estimate,
            interval: None,
            p,
            rule: Rule::Differs,
            verdict: significant(n, p),
        }
    }

    /// An estimate whose interval should lie within ends; an infinite one asks for nothing on its side.
    pub fn within(
        of: impl Into<String>,
        n: usize,
        (estimate, interval): (Option<f64>, Option<(f64, f64)>),
        (low, high): (f64, f64),
    ) -> Self {
        let finite = |end: f64| Some(end).filter(|end| end.is_finite());
        Self {
            of: of.into(),
            n,
            estimate,
            interval,
            p: None,
            rule: Rule::Within { low: finite(low), high: finite(high) },
            verdict: within(n, interval, (low, high)),
        }
    }

    /// A share of `n` whose interval should lie within ends.
    pub fn share(
        of: impl Into<String>,
        n: usize,
        share: Option<&Proportion>,
        ends: (f64, f64),
    ) -> Self {
        let estimate = share.map(|share| share.estimate);
        Self::within(of, n, (estimate, share.map(Proportion::ends)), ends)
    }

    /// What must never happen, and came `hits` times in `n`: one is enough to fail. The interval is exact, since it bounds what was never
    /// seen.
    pub fn never(of: impl Into<String>, hits: usize, n: usize) -> Self {
        let share = proportion_exact(hits, n, 0.95).ok();
        let part = Self::share(of, n, share.as_ref(), (0.0, 1.0));
        Self {
            rule: Rule::Never,
            verdict: if hits > 0 { Verdict::Fails } else { part.verdict },
            ..part
        }
    }

    /// The same with an interval that does not decide.
    #[must_use]
    pub fn with_interval(mut self, interval: Option<(f64, f64)>) -> Self {
        self.interval = interval;
        self
    }
}

/// What became of a question: the verdict follows from the parts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// What is asked.
    #[serde(rename = "id")]
    pub question: Question,
    /// What became of it.
    pub verdict: Verdict,
    /// How many of the parts have to hold.
    pub needed: Needed,
    /// What was judged, a row each.
    pub parts: Vec<Part>,
}

impl Finding {
    /// Every part has to hold.
    pub fn every(question: Question, parts: Vec<Part>) -> Self {
        Self {
            question,
            verdict: Verdict::all(parts.iter().map(|part| part.verdict)),
            needed: Needed::Every,
            parts,
        }
    }

    /// One part is enough.
    pub fn one(question: Question, parts: Vec<Part>) -> Self {
        Self {
            question,
            verdict: Verdict::any(parts.iter().map(|part| part.verdict)),
            needed: Needed::One,
            parts,
        }
    }

    /// How many parts came out so.
    pub fn count(&self, verdict: Verdict) -> usize {
        let parts = self.parts.iter().filter(|part| part.verdict == verdict);
        parts.count()
    }

    /// The part with the smallest of a number; parts without one come last.
    pub fn least(&self, number: impl Fn(&Part) -> Option<f64>) -> Option<&Part> {
        let value_of = |part: &Part| number(part).unwrap_or(f64::INFINITY);
        let mut parts = self.parts.iter();
        let first = parts.next()?;
        Some(parts.fold(
            first,
            |least, part| {
                if value_of(part) < value_of(least) { part } else { least }
            },
        ))
    }
}

/// The finding of a question, among several.
pub fn by_question(findings: &[Finding], question: Question) -> Option<&Finding> {
    findings.iter().find(|finding| finding.question == question)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verdict::FEWEST;
    use Verdict::{Fails, NotAsked, NotShown, NotTestable, Shown, TooFew};
    use maveric_stats::proportion;

    #[test]
    fn every_question_has_an_id_of_its_own() {
        for (question, id) in IDS {
            assert_eq!(question.to_string(), id);
            assert_eq!(Question::try_from(id.to_owned()), Ok(question));
        }
        let ids: std::collections::BTreeSet<&str> = IDS.iter().map(|(_, id)| *id).collect();
        assert_eq!(ids.len(), IDS.len());
        assert!(Question::try_from("primary-x".to_owned()).unwrap_err().contains("`primary-x`"));
        for numbered in [Question::Primary(2), Question::Hypothesis(2)] {
            assert_eq!(Question::try_from(numbered.to_string()), Ok(numbered));
        }
        assert!(Question::try_from("own".to_owned()).unwrap_err().contains("`own`"));
    }

    #[test]
    fn a_part_is_judged_by_its_rule_either_way_and_at_the_border() {
        let directed = |n, d, p| Part::directed("x", n, (Some(d), Some(p)), Sign::Plus).verdict;
        assert_eq!(
            [
                directed(24, 1.0, 0.01),
                directed(24, 1.0, 0.05),
                directed(24, -1.0, 0.01),
                directed(FEWEST - 1, 1.0, 0.01)
            ],
            [Shown, NotShown, Fails, TooFew]
        );
        let differs = |n, p| Part::differs("x", n, (Some(-1.0), p)).verdict;
        assert_eq!(
            [
                differs(24, Some(0.049)),
                differs(24, Some(0.05)),
                differs(FEWEST - 1, Some(0.01)),
                differs(0, None),
                differs(24, None)
            ],
            [Shown, NotShown, TooFew, NotAsked, NotTestable]
        );
        let share = |hits, n| {
            let share = proportion(hits, n, 0.95).ok();
            Part::share("x", n, share.as_ref(), (0.5, f64::INFINITY)).verdict
        };
        assert_eq!(
            [share(20, 24), share(12, 24), share(3, 24), share(5, 5), share(0, 0)],
            [Shown, NotShown, Fails, TooFew, NotAsked]
        );
        let never = |hits, n| Part::never("x", hits, n).verdict;
        assert_eq!(
            [never(0, 24), never(1, 24), never(0, 4), never(1, 4), never(0, 0)],
            [Shown, Fails, TooFew, Fails, NotAsked]
        );
    }

    #[test]
    fn a_finding_needs_every_part_or_one() {
        let part = |d, p| Part::directed("x", 24, (Some(d), Some(p)), Sign::Plus);
        let (yes, open, no) = (part(1.0, 0.01), part(1.0, 0.5), part(-1.0, 0.01));
        let both = |parts: Vec<Part>| {
            let [every, one] =
                [Finding::every, Finding::one].map(|f| f(Question::Nearer, parts.clone()).verdict);
            (every, one)
        };
        assert_eq!(both(vec![yes.clone(), yes.clone()]), (Shown, Shown));
        assert_eq!(both(vec![yes.clone(), open.clone()]), (NotShown, Shown));
        assert_eq!(both(vec![yes, no.clone()]), (Fails, Shown));
        assert_eq!(both(vec![open, no]), (Fails, NotShown));
        assert_eq!(both(Vec::new()), (NotAsked, NotAsked));
    }

    #[test]
    fn a_finding_reads_back_as_it_was_written_with_its_question_by_name() {
        let found = Finding::one(
            Question::Hypothesis(2),
            vec![
                Part::never("collision", 0, 24),
                Part::within("x", 9, (Some(0.7), Some((0.6, 0.8))), (0.5, f64::INFINITY)),
            ],
        );
        let json = serde_json::to_value(&found).unwrap();
        assert_eq!((&json["id"], &json["verdict"]), (&"hypothesis-2".into(), &"shown".into()));
        assert_eq!(
            (&json["parts"][1]["rule"], &json["parts"][1]["high"]),
            (&"within".into(), &serde_json::Value::Null)
        );
        assert_eq!(serde_json::from_value::<Finding>(json).unwrap(), found);
    }
}
