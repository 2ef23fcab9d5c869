//! Every outcome over the conditions: which test, why, and the declared contrasts as one family.

use crate::{
    AnalysisError, Friedman,
    data::StudyData,
    outcomes::{Asked, outcome, outcomes},
    result::{Contrast, Group, Panel},
};
use maveric_domain::{
    ConditionId, ParticipantId,
    design::{Column, Sign},
};
use maveric_measures::difference_from_own;
use maveric_stats::{
    Adjustment, Comparison, Posthoc, PosthocTest, WithinSubjects, adjust, compare,
    compare_without_exact, normality, posthoc,
};
use std::collections::BTreeMap;

/// Level of the assumption checks and of `reject`.
pub(crate) const ALPHA: f64 = 0.05;

/// A panel an outcome, and a group of people where the design divides them; those that only a hypothesis asks for last.
pub(crate) fn panels(data: &StudyData, friedman: Friedman) -> Result<Vec<Panel>, AnalysisError> {
    let mut asked = outcomes(data);
    for hypothesis in data.design.hypotheses() {
        if !asked.iter().any(|a| a.id == hypothesis.outcome) {
            asked.push(outcome(data, &hypothesis.outcome));
        }
    }
    let mut found = Vec::new();
    for asked in &asked {
        let mut family = Vec::new();
        for (group, people) in groups(data) {
            family.push(panel(data, friedman, asked, group, &people)?);
        }
        correct(&mut family)?;
        found.extend(family);
    }
    Ok(found)
}

/// Everybody, or the people of each combination of the factors' levels, in order.
fn groups(data: &StudyData) -> Vec<(Option<Group>, Vec<ParticipantId>)> {
    let factors = data.design.factors();
    if factors.is_empty() {
        return vec![(None, data.participants.clone())];
    }
    let mut found: BTreeMap<Vec<String>, Vec<ParticipantId>> = BTreeMap::new();
    for p in &data.participants {
        let level = |f: &Column| {
            let level = data.column(p, &f.column);
            level.unwrap_or("not given").to_owned()
        };
        found
            .entry(factors.iter().map(level).collect())
            .or_default()
            .push(p.clone());
    }
    let title = |f: &Column| f.label.clone().unwrap_or_else(|| f.column.clone());
    found
        .into_iter()
        .map(|(levels, people)| {
            let group = Group {
                factor: factors.iter().map(title).collect::<Vec<_>>().join(" × "),
                level: levels.join(", "),
            };
            (Some(group), people)
        })
        .collect()
}

fn panel(
    data: &StudyData,
    friedman: Friedman,
    asked: &Asked,
    group: Option<Group>,
    people: &[ParticipantId],
) -> Result<Panel, AnalysisError> {
    let mut conditions: Vec<ConditionId> = data.design.conditions().iter().map(|c| c.id).collect();
    let baseline = data.design.baseline_id();
    let mut contrasts = contrasts(data, &asked.id);
    // One condition is held against the baseline itself.
    if let (&[one], Some(baseline)) = (conditions.as_slice(), baseline)
        && one != baseline
    {
        contrasts = vec![[one, baseline]];
        conditions.push(baseline);
    }
    let from = baseline.filter(|b| asked.column().is_some() && !conditions.contains(b));
    let value = |p, c| match from {
        Some(b) => difference_from_own(asked.value(data, p, c), asked.value(data, p, b)),
        None => asked.value(data, p, c),
    };
    let rows: Vec<Vec<Option<f64>>> = people
        .iter()
        .map(|p| {
            let shown = |c: &ConditionId| value(p, *c).map(|v| v * asked.factor);
            conditions.iter().map(shown).collect()
        })
        .collect();
    let mut panel = Panel {
        outcome: asked.id.clone(),
        title: asked.title.clone(),
        unit: asked.unit.clone(),
        same: from.map(|_| 0.0).or(asked.same),
        differences_from: from,
        group,
        participants: people.iter().map(ToString::to_string).collect(),
        conditions,
        rows,
        n: 0,
        dropped: Vec::new(),
        test: None,
        reasons: Vec::new(),
        comparison: None,
        contrasts: Vec::new(),
    };
    let (mut subjects, mut values) = (Vec::new(), Vec::new());
    for (who, row) in panel.participants.iter().zip(&panel.rows) {
        match row.iter().copied().collect::<Option<Vec<f64>>>() {
            Some(full) => {
                subjects.push(who.clone());
                values.push(full);
            }
            None => panel.dropped.push(who.clone()),
        }
    }
    panel.n = subjects.len();
    let expected = |[first, second]: [ConditionId; 2]| asked.expected(data, first, second);
    if panel.n < 2 || panel.conditions.len() < 2 {
        let untested = |pair: [ConditionId; 2]| Contrast::untested(pair, expected(pair));
        panel.contrasts = contrasts.into_iter().map(untested).collect();
        panel.reasons.push(if panel.conditions.len() < 2 {
            "one condition and no baseline: nothing to compare it with".to_owned()
        } else {
            format!("{} with a value in every condition", panel.n)
        });
        return Ok(panel);
    }
    let names: Vec<String> = panel.conditions.iter().map(ToString::to_string).collect();
    let tested = WithinSubjects::from_rows(&names, &subjects, &values)?;
    let pairs = if names.len() > 2 {
        let found: Comparison = match friedman {
            Friedman::Exact => compare(&tested, ALPHA)?,
            Friedman::Approximate => compare_without_exact(&tested, ALPHA)?,
        };
        panel.reasons.clone_from(&found.reasons);
        let pairs = found.posthoc.clone();
        panel.comparison = Some(found);
        pairs
    } else {
        let (test, why) = of_two(&values)?;
        panel.reasons.push(why);
        posthoc(&tested, test, Adjustment::None, ALPHA)?
    };
    panel.test = Some(pairs.test);
    for pair in contrasts {
        let against = |b| pair.contains(&b);
        panel.contrasts.push(match from.filter(|b| against(*b)) {
            Some(baseline) => {
                from_zero(&panel.conditions, &values, baseline, pair, expected(pair))?
            }
            None => Contrast::of(&pairs, pair, expected(pair)),
        });
    }
    Ok(panel)
}

/// The declared contrasts, and those that a hypothesis about this outcome adds.
fn contrasts(data: &StudyData, id: &str) -> Vec<[ConditionId; 2]> {
    let mut found = data.design.contrasts();
    for hypothesis in data.design.hypotheses().iter().filter(|h| h.outcome == id) {
        let [first, second] = hypothesis.contrast;
        if !found.contains(&[first, second]) && !found.contains(&[second, first]) {
            found.push([first, second]);
        }
    }
    found
}

/// Paired t where the differences look normal, else Wilcoxon's test; and why.
fn of_two(values: &[Vec<f64>]) -> Result<(PosthocTest, String), AnalysisError> {
    let differences: Vec<Option<f64>> = values.iter().map(|row| Some(row[0] - row[1])).collect();
    let p = normality(&differences)?.shapiro.p;
    Ok(match p {
        Some(p) if p >= ALPHA => (
            PosthocTest::T,
            format!("the differences look normal (Shapiro-Wilk p = {p:.3}): paired t test"),
        ),
        Some(p) => (
            PosthocTest::Wilcoxon,
            format!("the differences are not normal (Shapiro-Wilk p = {p:.3}): Wilcoxon's test"),
        ),
        None => (
            PosthocTest::Wilcoxon,
            "normality of the differences cannot be tested: Wilcoxon's test".to_owned(),
        ),
    })
}

/// A condition against the baseline, where the values are differences from it.
fn from_zero(
    conditions: &[ConditionId],
    values: &[Vec<f64>],
    baseline: ConditionId,
    pair: [ConditionId; 2],
    expected: Option<Sign>,
) -> Result<Contrast, AnalysisError> {
    let [first, second] = pair;
    let other = if first == baseline { second } else { first };
    let Some(at) = conditions.iter().position(|c| *c == other) else {
        return Ok(Contrast::untested(pair, expected));
    };
    let rows: Vec<Vec<f64>> = values.iter().map(|row| vec![row[at], 0.0]).collect();
    let subjects: Vec<String> = (0..rows.len()).map(|i| i.to_string()).collect();
    let names = [other.to_string(), baseline.to_string()];
    let tested = WithinSubjects::from_rows(&names, &subjects, &rows)?;
    let (test, _) = of_two(&rows)?;
    let found = posthoc(&tested, test, Adjustment::None, ALPHA)?;
    Ok(Contrast::of(&found, pair, expected))
}

/// Holm's correction over all contrasts of an outcome.
fn correct(family: &mut [Panel]) -> Result<(), AnalysisError> {
    let mut tested: Vec<&mut Contrast> = family
        .iter_mut()
        .flat_map(|panel| &mut panel.contrasts)
        .filter(|c| c.p.is_some())
        .collect();
    let p: Vec<f64> = tested.iter().filter_map(|c| c.p).collect();
    if p.is_empty() {
        return Ok(());
    }
    for (contrast, holm) in tested.iter_mut().zip(adjust(&p)?.holm) {
        contrast.p_holm = Some(holm);
    }
    Ok(())
}

impl Contrast {
    fn untested([first, second]: [ConditionId; 2], expected: Option<Sign>) -> Self {
        Self {
            first,
            second,
            expected,
            mean_difference: None,
            statistic: None,
            df: None,
            effect: None,
            p: None,
            p_holm: None,
        }
    }

    /// First minus second, whichever way round the test looked at them.
    fn of(tested: &Posthoc, [first, second]: [ConditionId; 2], expected: Option<Sign>) -> Self {
        let found = tested.pairs.get(&format!("{first}|{second}"));
        let (found, sign) = match found {
            Some(found) => (Some(found), 1.0),
            None => (tested.pairs.get(&format!("{second}|{first}")), -1.0),
        };
        let Some(found) = found else {
            return Self::untested([first, second], expected);
        };
        let mut effect = found.effect.clone();
        if sign < 0.0 {
            effect.value = effect.value.map(|v| -v);
            (effect.ci_low, effect.ci_high) =
                (effect.ci_high.map(|v| -v), effect.ci_low.map(|v| -v));
        }
        // Wilcoxon's sum of positive ranks turns into that of the negative ones.
        let statistic = found.statistic.map(|s| match (tested.test, sign < 0.0) {
            (PosthocTest::Wilcoxon, true) => (found.n_used * (found.n_used + 1)) as f64 / 2.0 - s,
            (_, true) => -s,
            (_, false) => s,
        });
        Self {
            first,
            second,
            expected,
            mean_difference: Some(sign * found.mean_diff).filter(|d| d.is_finite()),
            statistic,
            df: found.df,
            effect: Some(effect),
            p: found.p,
            p_holm: None,
        }
    }
}
