//! The factors within people: those that the conditions cross.

use maveric_domain::{
    ConditionId, Design,
    design::{CONDITION, Condition, crossed},
};

/// Factors of a kind that a test can take.
const MOST_FACTORS: usize = 2;

/// Why no test takes so many factors between people; none where one does.
pub(crate) fn too_many_between(count: usize) -> Option<String> {
    let reason = || format!("{count} factors between people: a test takes at most {MOST_FACTORS}");
    (count > MOST_FACTORS).then(reason)
}

/// A factor within people: its name, and its level in each condition.
pub(crate) type Within = (String, Vec<String>);

/// The factors that these conditions cross; else the conditions themselves are one.
pub(crate) fn factors_within(design: &Design, conditions: &[ConditionId]) -> Vec<Within> {
    let known: Option<Vec<&Condition>> =
        conditions.iter().map(|id| design.condition(*id)).collect();
    known.and_then(|known| crossed(&known)).unwrap_or_else(|| {
        let names = conditions.iter().map(ToString::to_string).collect();
        vec![(CONDITION.to_owned(), names)]
    })
}
