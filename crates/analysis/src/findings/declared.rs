//! What was declared before the study.

use crate::{
    finding::{Finding, Part, Question, Rule},
    result::{Judged, PrimaryOutcome},
};

/// A finding a primary outcome: its contrast differs, does not, or was not tested.
pub(super) fn primary(outcomes: &[PrimaryOutcome]) -> Vec<Finding> {
    let one = |(number, o): (usize, &PrimaryOutcome)| {
        let part = Part {
            of: format!("{}.{}-{}", o.outcome, o.first, o.second),
            n: o.n,
            estimate: o.mean_difference,
            interval: o.interval,
            p: o.p,
            rule: Rule::Differs,
            verdict: o.verdict,
        };
        Finding::every(Question::Primary(number), vec![part])
    };
    (1..).zip(outcomes).map(one).collect()
}

/// A finding a hypothesis, as it was judged.
pub(super) fn hypotheses(judged: &[Judged]) -> Vec<Finding> {
    let one = |(number, h): (usize, &Judged)| {
        let directed = h.expected.map(|expected| Rule::Directed { expected });
        let same = h.bounds.map(|(low, high)| Rule::Same { low, high });
        let part = Part {
            of: format!("{}.{}-{}", h.outcome, h.first, h.second),
            n: h.n,
            estimate: h.mean_difference,
            interval: h.interval,
            p: h.p,
            rule: same.or(directed).unwrap_or(Rule::Differs),
            verdict: h.verdict,
        };
        Finding::every(Question::Hypothesis(number), vec![part])
    };
    (1..).zip(judged).map(one).collect()
}
