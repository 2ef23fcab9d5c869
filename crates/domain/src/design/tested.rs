//! Reading a design: what is tested and compared.

use super::{
    condition::Condition,
    contrast::{Claim, Compare, Hypothesis},
    error::{Checked, DesignError, refuse},
    factors::crossed,
    outcome::{DeclaredTest, Outcome, Quantity, ScoreName},
    people::{Covariate, Factor},
    toml_file::{CompareToml, HypothesisToml, OutcomeToml},
};
use crate::condition::ConditionId;
use std::collections::BTreeSet;

/// Refuses the second of two that are called the same.
pub(super) fn once(key: &str, names: impl IntoIterator<Item = String>) -> Checked<()> {
    let mut seen = BTreeSet::new();
    for name in names {
        if seen.contains(&name) {
            return refuse(key, format!("`{name}` twice"), "each once");
        }
        seen.insert(name);
    }
    Ok(())
}

/// Refuses a condition that is none.
pub(super) fn known(key: &str, id: ConditionId, conditions: &[Condition]) -> Checked<()> {
    if conditions.iter().any(|c| c.id == id) {
        return Ok(());
    }
    let ids = conditions.iter().map(|c| c.id.as_str());
    Err(DesignError::word(key, id.as_str(), ids))
}

pub(super) fn outcomes(
    raw: Vec<OutcomeToml>,
    conditions: &[Condition],
    pairs: &[[ConditionId; 2]],
) -> Checked<Vec<Outcome>> {
    let whole = |(at, raw): (usize, OutcomeToml)| {
        if let Some(within) = raw.same_within.filter(|w| !w.is_finite() || *w <= 0.0) {
            let expected = "a number above 0, in the unit of the page";
            return refuse("outcome.same_within", within, expected);
        }
        let key = |field: &str| format!("outcome[{}].{field}", at + 1);
        once(&key("drop_items"), raw.drop_items.iter().map(u32::to_string))?;
        if let (Some(measure), [_, ..]) = (&raw.measure, raw.drop_items.as_slice()) {
            let expected = "none: only a score has items";
            let dropped = format!("items of the measure `{measure}`");
            return refuse(key("drop_items"), dropped, expected);
        }
        Ok(Outcome {
            primary: primary(&raw, key, conditions, pairs)?,
            drop_items: raw.drop_items,
            test: raw.test,
            label: raw.label,
            same_within: raw.same_within,
            quantity: quantity(raw.measure, raw.scale)?,
        })
    };
    let raw = raw.into_iter().enumerate();
    let outcomes: Vec<Outcome> = raw.map(whole).collect::<Checked<_>>()?;
    once("outcome", outcomes.iter().map(Outcome::id))?;
    Ok(outcomes)
}

fn quantity(measure: Option<String>, scale: Option<ScoreName>) -> Checked<Quantity> {
    match (measure, scale) {
        (Some(measure), None) => Ok(Quantity::Measure(measure)),
        (None, Some(score)) => Ok(Quantity::Score(score)),
        (Some(measure), Some(score)) => refuse(
            "outcome",
            format!("measure `{measure}` and scale `{score}`"),
            "one of them; two outcomes stand in two [[outcome]]",
        ),
        (None, None) => refuse("outcome", "neither `measure` nor `scale`", "one of them"),
    }
}

/// The contrast that decides about a primary outcome: it and the test have to be declared.
fn primary(
    raw: &OutcomeToml,
    key: impl Fn(&str) -> String,
    conditions: &[Condition],
    pairs: &[[ConditionId; 2]],
) -> Checked<Option<[ConditionId; 2]>> {
    const TESTS: &str = "\"mixed\" or \"ordinal\", or without orders \"rm-anova\" or \"friedman\": the test of a primary outcome is declared, not chosen by what \
                         the data look like";
    if !raw.primary {
        return match raw.contrast {
            None => Ok(None),
            Some([first, second]) => refuse(
                key("contrast"),
                format!("`{first}` and `{second}`, of an outcome that is not primary"),
                "`primary = true` beside it; other outcomes are compared as `[contrasts]` says",
            ),
        };
    }
    match raw.test {
        None => {
            return refuse(key("test"), "none of a primary outcome", TESTS);
        }
        Some(DeclaredTest::Auto) => {
            return refuse(key("test"), "`auto` of a primary outcome", TESTS);
        }
        Some(_) => {}
    }
    let Some(contrast) = raw.contrast else {
        return refuse(
            key("contrast"),
            "none of a primary outcome",
            "the one pair of conditions that decides, such as [\"sporty\", \"calm\"]",
        );
    };
    compared(&key("contrast"), contrast, conditions, pairs)?;
    Ok(Some(contrast))
}

/// A declared test of the conditions alone, with what the design has beside them: over everybody it can never be run. None where it can.
pub(super) fn never_run(
    test: DeclaredTest,
    factors: &[Factor],
    covariates: &[Covariate],
    conditions: &[Condition],
) -> Option<String> {
    let test = match test {
        DeclaredTest::Ordinal => "ordinal",
        DeclaredTest::RmAnova => "rm-anova",
        DeclaredTest::Friedman => "friedman",
        DeclaredTest::Auto | DeclaredTest::Mixed => return None,
    };
    let conditions: Vec<&Condition> = conditions.iter().collect();
    match (factors.first(), covariates.first()) {
        (Some(factor), _) => Some(format!("`{test}` beside the [[factor]] `{}`", factor.name)),
        (None, Some(covariate)) => {
            Some(format!("`{test}` beside the [[covariate]] `{}`", covariate.column))
        }
        (None, None) => {
            crossed(&conditions).map(|_| format!("`{test}` of conditions that cross two factors"))
        }
    }
}

/// Refuses a pair that the design does not compare.
fn compared(
    key: &str,
    [first, second]: [ConditionId; 2],
    conditions: &[Condition],
    pairs: &[[ConditionId; 2]],
) -> Checked<()> {
    known(key, first, conditions)?;
    known(key, second, conditions)?;
    if pairs.contains(&[first, second]) || pairs.contains(&[second, first]) {
        return Ok(());
    }
    let compared: Vec<String> = pairs.iter().map(|[a, b]| format!("{a} and {b}")).collect();
    refuse(
        key,
        format!("`{first}` and `{second}`"),
        format!("a pair that `[contrasts]` compares: {}", compared.join("; ")),
    )
}

pub(super) fn compare(raw: Option<CompareToml>, conditions: &[Condition]) -> Checked<Compare> {
    const KEY: &str = "contrasts.compare";
    match raw {
        None => Ok(Compare::All),
        Some(CompareToml::Word(word)) => match word.split_whitespace().collect::<Vec<_>>()[..] {
            ["all"] => Ok(Compare::All),
            ["against", one] => {
                let id =
                    ConditionId::new(one).map_err(|e| DesignError::key(KEY, e, "a condition"))?;
                known(KEY, id, conditions)?;
                Ok(Compare::Against(id))
            }
            _ => refuse(
                KEY,
                format!("`{word}`"),
                "\"all\", \"against ID\", or a list of pairs of conditions",
            ),
        },
        Some(CompareToml::Pairs(pairs)) => {
            for &[first, second] in &pairs {
                known(KEY, first, conditions)?;
                known(KEY, second, conditions)?;
                if first == second {
                    return refuse(KEY, format!("`{first}` with itself"), "two conditions");
                }
            }
            once(KEY, pairs.iter().map(|&[a, b]| format!("{} and {}", a.min(b), a.max(b))))?;
            Ok(Compare::Pairs(pairs))
        }
    }
}

pub(super) fn hypothesis(
    at: usize,
    raw: HypothesisToml,
    conditions: &[Condition],
    pairs: &[[ConditionId; 2]],
    outcomes: &[Outcome],
) -> Checked<Hypothesis> {
    let key = |field: &str| format!("hypothesis[{}].{field}", at + 1);
    compared(&key("contrast"), raw.contrast, conditions, pairs)?;
    if !outcomes.is_empty() && !outcomes.iter().any(|o| o.id() == raw.outcome) {
        let ids: Vec<String> = outcomes.iter().map(Outcome::id).collect();
        let ids = ids.iter().map(String::as_str);
        return Err(DesignError::word(key("outcome"), &raw.outcome, ids));
    }
    let claim = match (raw.direction, raw.equivalent) {
        (Some(sign), None) => Claim::Direction(sign),
        (None, Some([low, high])) if low < high => Claim::Equivalent([low, high]),
        (None, Some([low, high])) => {
            return refuse(
                key("equivalent"),
                format!("[{low}, {high}]"),
                "a lower bound, then a higher one",
            );
        }
        (found, _) => {
            return refuse(
                key("direction"),
                if found.is_some() {
                    "both `direction` and `equivalent`"
                } else {
                    "neither `direction` nor `equivalent`"
                },
                "one of them",
            );
        }
    };
    Ok(Hypothesis { says: raw.says, outcome: raw.outcome, contrast: raw.contrast, claim })
}
