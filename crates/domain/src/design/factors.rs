//! Factors between people and within them, their labels, and the contrasts of their levels: checked against the conditions.

use super::{
    condition::Condition,
    contrast::{LevelContrast, Levels},
    error::{Checked, DesignError, refuse},
    people::{CONDITION, Covariate, Factor},
    toml_file::FactorToml,
};
use crate::nearest;

/// The factors that the conditions cross, each with its levels in the order of the conditions; else the conditions themselves are one.
pub(super) fn within(conditions: &[Condition]) -> Vec<(String, Vec<String>)> {
    let names: Vec<&String> = conditions.iter().take(1).flat_map(|c| c.levels.keys()).collect();
    if names.is_empty() {
        let ids = conditions.iter().map(|c| c.id.to_string());
        return vec![(CONDITION.to_owned(), ids.collect())];
    }
    let levels = |name: &String| {
        let mut levels: Vec<String> = Vec::new();
        for level in conditions.iter().filter_map(|c| c.levels.get(name)) {
            if !levels.contains(level) {
                levels.push(level.clone());
            }
        }
        levels
    };
    names.into_iter().map(|name| (name.clone(), levels(name))).collect()
}

/// Factors that conditions can cross in a test.
const CROSSED: usize = 2;

/// The two factors that these conditions cross, each with its level in each of them, if they do so completely.
pub fn crossed(conditions: &[&Condition]) -> Option<Vec<(String, Vec<String>)>> {
    let names: Vec<&String> = conditions.first()?.levels.keys().collect();
    if names.len() != CROSSED {
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

/// Splits factors into those between people and the labels of those within them.
pub(super) fn factors(
    raw: Vec<FactorToml>,
    conditions: &[Condition],
) -> Checked<(Vec<Factor>, Vec<Factor>)> {
    let known = within(conditions);
    let (mut between, mut crossed) = (Vec::new(), Vec::new());
    for raw in raw {
        let factor = |name| Factor { name, label: raw.label, levels: raw.levels };
        match (raw.column, raw.within) {
            (Some(column), None) => between.push(factor(column)),
            (None, Some(name)) => {
                let names = known.iter().map(|(name, _)| name.as_str());
                let (_, levels) = known
                    .iter()
                    .find(|(known, _)| *known == name)
                    .ok_or_else(|| DesignError::word("factor.within", &name, names))?;
                let factor = factor(name);
                let other = factor.levels.keys().find(|level| !levels.contains(level));
                if let Some(level) = other {
                    let key = format!("factor.{}.levels", factor.name);
                    let levels = levels.iter().map(String::as_str);
                    return Err(DesignError::word(key, level, levels));
                }
                crossed.push(factor);
            }
            (column, _) => {
                return refuse(
                    "factor",
                    if column.is_some() {
                        "both `column` and `within`"
                    } else {
                        "neither `column` nor `within`"
                    },
                    "`column`, of the people's table, or `within`, a factor that the conditions cross",
                );
            }
        }
    }
    Ok((between, crossed))
}

/// Refuses a contrast of an unknown factor or level, of a level with itself, and one without a pair.
///
/// The levels of factors between people are known to those who hold the people's table.
pub(super) fn contrasts(
    raw: &[LevelContrast],
    between: &[Factor],
    conditions: &[Condition],
) -> Checked<()> {
    let within = within(conditions);
    for (at, contrast) in raw.iter().enumerate() {
        let key = format!("contrasts.factors[{}]", at + 1);
        let expected =
            "two levels of at least one factor, such as { style = [\"calm\", \"sporty\"] }";
        if !contrast.values().any(|levels| matches!(levels, Levels::Pair(_))) {
            return refuse(key, "no pair of levels", expected);
        }
        if raw[..at].contains(contrast) {
            return refuse(key, "a contrast that stands above", "each once");
        }
        for (factor, levels) in contrast {
            let key = format!("{key}.{factor}");
            if let Levels::Pair([first, second]) = levels
                && first == second
            {
                let pair = format!("`{first}` with itself");
                return refuse(key, pair, "two levels");
            }
            if between.iter().any(|f| f.name == *factor) {
                continue;
            }
            let names = within.iter().map(|(name, _)| name.as_str());
            let names = names.chain(between.iter().map(|f| f.name.as_str()));
            let known = within.iter().find(|(name, _)| name == factor);
            let (_, known) = known.ok_or_else(|| DesignError::word(&key, factor, names))?;
            if let Some(level) = levels.named().iter().find(|level| !known.contains(level)) {
                let known = known.iter().map(String::as_str);
                return Err(DesignError::word(key, level, known));
            }
        }
    }
    Ok(())
}

/// Refuses a product of a covariate with what is no effect within people.
pub(super) fn products(covariates: &[Covariate], conditions: &[Condition]) -> Checked<()> {
    let crossed = within(conditions);
    let known: Vec<String> = (1..1_usize << crossed.len())
        .map(|mask| {
            let parts = crossed.iter().enumerate();
            let parts = parts.filter(|(f, _)| mask >> f & 1 == 1);
            parts.map(|(_, (name, _))| name.as_str()).collect::<Vec<_>>().join(":")
        })
        .collect();
    for covariate in covariates {
        let unknown = covariate.with.iter().find(|name| !known.contains(name));
        let Some(unknown) = unknown else { continue };
        let nearest = nearest(unknown, known.iter().map(String::as_str));
        let meant = nearest.map_or_else(String::new, |n| format!("; did you mean `{n}`?"));
        return refuse(
            "covariate.with",
            format!("`{unknown}` of `{}`", covariate.column),
            format!("an effect within people: `{}`{meant}", known.join("`, `")),
        );
    }
    Ok(())
}

/// Most letters of a label: a longer one fits neither below an axis nor into a cell.
const LONGEST_LABEL: usize = 60;

/// Refuses a label that cannot be printed.
pub(super) fn printable<'a>(labels: impl IntoIterator<Item = (String, &'a str)>) -> Checked<()> {
    for (key, label) in labels {
        let letters = label.chars().count();
        if letters > LONGEST_LABEL {
            let start: String = label.chars().take(20).collect();
            return refuse(
                key,
                format!("`{start}…`, {letters} letters"),
                format!("at most {LONGEST_LABEL}: it has to fit below an axis and into a table"),
            );
        }
    }
    Ok(())
}
