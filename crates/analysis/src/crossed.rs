//! The factors within people: those that the conditions cross.

use maveric_domain::{
    ConditionId, Design,
    design::{CONDITION, Condition},
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

/// The two factors that the conditions cross, if they do so completely.
pub(crate) fn crossed(conditions: &[&Condition]) -> Option<Vec<Within>> {
    let names: Vec<&String> = conditions.first()?.levels.keys().collect();
    if names.len() != MOST_FACTORS {
        return None;
    }
    let mut factors = Vec::new();
    let mut cells = 1;
    for name in names {
        let levels = conditions.iter().map(|c| c.levels.get(name).cloned());
        let levels: Vec<String> = levels.collect::<Option<_>>()?;
        let mut different = levels.clone();
        different.sort_unstable();
        different.dedup();
        if different.len() < 2 {
            return None;
        }
        cells *= different.len();
        factors.push((name.clone(), levels));
    }
    let cell = |index: usize| [&factors[0].1[index], &factors[1].1[index]];
    let twice = (1..conditions.len()).any(|b| (0..b).any(|a| cell(a) == cell(b)));
    (cells == conditions.len() && !twice).then_some(factors)
}

/// The factors that these conditions cross; else the conditions themselves are one.
pub(crate) fn factors_within(design: &Design, conditions: &[ConditionId]) -> Vec<Within> {
    let known: Option<Vec<&Condition>> =
        conditions.iter().map(|id| design.condition(*id)).collect();
    known.and_then(|known| crossed(&known)).unwrap_or_else(|| {
        let names = conditions.iter().map(ToString::to_string).collect();
        vec![(CONDITION.to_owned(), names)]
    })
}
