//! What was declared before the study.

use crate::{
    finding::{Finding, Part, Question, Rule},
    result::Judged,
};
use maveric_domain::design::Sign;

/// A finding a hypothesis, as it was judged.
pub(super) fn hypotheses(judged: &[Judged]) -> Vec<Finding> {
    let one = |(number, h): (usize, &Judged)| {
        let rule = match (h.bounds, h.expected) {
            (Some((low, high)), _) => Rule::Same { low, high },
            (None, expected) => Rule::Directed {
                expected: expected.unwrap_or(Sign::Plus),
            },
        };
        let part = Part {
            of: format!("{}.{}-{}", h.outcome, h.first, h.second),
            n: h.n,
            estimate: h.mean_difference,
            interval: h.interval,
            p: h.p,
            rule,
            verdict: h.verdict,
        };
        Finding::every(Question::Hypothesis(number), vec![part])
    };
    (1..).zip(judged).map(one).collect()
}
