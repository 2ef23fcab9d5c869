//! Every outcome over the conditions: which test, why, and the declared contrasts as one family.

use crate::{
    AnalysisError,
    balance::OrderBalance,
    contrast::from_zero,
    data::StudyData,
    design_test::{Compared, Period, Purpose, Tested, by_design},
    family::holm,
    outcomes::{Asked, outcome, outcomes_and},
    pairs::{mean_difference, model_pairs, test_of_pairs, values},
    planned::held_against_baseline,
    result::{Contrast, ContrastTest, Group, Panel},
    verdict::ALPHA,
};
use maveric_domain::{
    ConditionId, ParticipantId,
    design::{DeclaredTest, Factor},
};
use maveric_measures::{difference_from_own, objective};
use maveric_stats::{Adjustment, ByDesign, PosthocTest, WithinSubjects, posthoc};
use std::{cmp::Ordering, collections::BTreeMap};

/// A panel an outcome over everybody, and one a group of people where the design divides them; those that only a hypothesis asks for last.
pub(crate) fn panels(data: &StudyData, purpose: Purpose) -> Result<Vec<Panel>, AnalysisError> {
    let hypotheses = data.design.hypotheses().iter();
    let tested = outcomes_and(data, hypotheses.map(|h| outcome(data, &h.outcome)));
    let mut panels = Vec::new();
    for asked in &tested {
        let whole = whole(data, purpose, asked)?;
        // One condition alone compares the groups with one another, and nothing within them.
        let compared = whole.conditions.len() > 1;
        panels.push(whole);
        let mut family = Vec::new();
        for (group, people) in groups(data).into_iter().filter(|_| compared) {
            family.push(panel(data, purpose, asked, Some(group), &people)?);
        }
        correct(&mut family)?;
        panels.extend(family);
    }
    Ok(panels)
}

/// The panel of an outcome over everybody.
pub(crate) fn whole(
    data: &StudyData,
    purpose: Purpose,
    asked: &Asked,
) -> Result<Panel, AnalysisError> {
    let mut whole = panel(data, purpose, asked, None, &data.participants)?;
    correct(std::slice::from_mut(&mut whole))?;
    Ok(whole)
}

/// The people of each combination of the factors' levels, in order; nobody where no factor divides them, and without whoever lacks a level.
fn groups(data: &StudyData) -> Vec<(Group, Vec<ParticipantId>)> {
    let factors = data.design.factors();
    let mut by_levels: BTreeMap<Vec<String>, Vec<ParticipantId>> = BTreeMap::new();
    for p in data.participants.iter().filter(|_| !factors.is_empty()) {
        let level = |f: &Factor| data.column(p, &f.name).map(str::to_owned);
        if let Some(levels) = factors.iter().map(level).collect::<Option<_>>() {
            by_levels.entry(levels).or_default().push(p.clone());
        }
    }
    let title = |f: &Factor| data.design.factor_label(&f.name);
    let factor = factors.iter().map(title).collect::<Vec<_>>().join(" × ");
    let group = |levels: Vec<String>| Group {
        factor: factor.clone(),
        label: factors
            .iter()
            .zip(&levels)
            .map(|(f, level)| data.design.level_label(&f.name, level))
            .collect::<Vec<_>>()
            .join(", "),
        level: levels.join(", "),
    };
    let groups = by_levels.into_iter();
    groups.map(|(levels, people)| (group(levels), people)).collect()
}

fn panel(
    data: &StudyData,
    purpose: Purpose,
    asked: &Asked,
    group: Option<Group>,
    people: &[ParticipantId],
) -> Result<Panel, AnalysisError> {
    let mut plan = Plan::new(data, asked, group, people);
    let (subjects, values) = plan.whole_rows();
    plan.judge(purpose)?;
    plan.contrast(&subjects, &values)?;
    Ok(plan.panel)
}

/// A panel on its way, with what it is made of.
struct Plan<'a> {
    data: &'a StudyData,
    asked: &'a Asked,
    people: &'a [ParticipantId],
    /// The pairs that are compared.
    pairs: Vec<[ConditionId; 2]>,
    period: Period,
    panel: Panel,
}

impl<'a> Plan<'a> {
    /// Who has what in which condition, before anything is tested.
    fn new(
        data: &'a StudyData,
        asked: &'a Asked,
        group: Option<Group>,
        people: &'a [ParticipantId],
    ) -> Self {
        let mut conditions: Vec<ConditionId> = data.design.condition_ids().collect();
        let baseline = data.design.baseline_id();
        let mut pairs = contrasts(data, &asked.id);
        if let Some(pair) = held_against_baseline(&data.design) {
            pairs = vec![pair];
            conditions.push(pair[1]);
        }
        let from = baseline
            .filter(|b| asked.column().is_some() && !conditions.contains(b))
            .filter(|b| has_baseline(data, asked, *b, people));
        let value = |p, c| match from {
            Some(b) => difference_from_own(asked.value(data, p, c), asked.value(data, p, b)),
            None => asked.value(data, p, c),
        };
        let period = Period::for_outcome(data, asked, (&conditions, people), group.is_some());
        let placed = |p: &ParticipantId| conditions.iter().all(|c| data.period(p, *c).is_some());
        let unplaced = |p: &&ParticipantId| period == Period::Taken && !placed(p);
        let without_order = people.iter().filter(unplaced).map(ToString::to_string).collect();
        let lacked = |p: &ParticipantId| {
            let column = lacked_column(data, p, group.is_some())?;
            Some((p.to_string(), column.to_owned()))
        };
        let placed_people = people.iter().filter(|p| !unplaced(p));
        let without_column: BTreeMap<String, String> = placed_people.filter_map(lacked).collect();
        let rows: Vec<Vec<Option<f64>>> = people
            .iter()
            .map(|p| {
                if unplaced(&p) || without_column.contains_key(&p.to_string()) {
                    return vec![None; conditions.len()];
                }
                let shown = |c: &ConditionId| value(p, *c).map(|v| v * asked.factor);
                conditions.iter().map(shown).collect()
            })
            .collect();
        let panel = Panel {
            outcome: asked.id.clone(),
            title: asked.title.clone(),
            unit: asked.unit.clone(),
            measured: asked.column().is_some(),
            same: from.map(|_| 0.0).or(asked.same),
            range: asked.range.filter(|_| from.is_none()),
            differences_from: from,
            group,
            participants: people.iter().map(ToString::to_string).collect(),
            conditions,
            rows,
            n: 0,
            dropped: Vec::new(),
            without_order,
            without_column,
            test: None,
            reasons: Vec::new(),
            comparison: None,
            balance: None,
            carry_over: None,
            contrasts: Vec::new(),
            by_factor: None,
        };
        Self { data, asked, people, pairs, period, panel }
    }

    /// The people with a value in every condition, and their values; the others are named in the panel.
    fn whole_rows(&mut self) -> (Vec<String>, Vec<Vec<f64>>) {
        let panel = &mut self.panel;
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
        if self.period == Period::Taken {
            let dropped = |p: &&ParticipantId| panel.dropped.contains(&p.to_string());
            let tested = self.people.iter().filter(|p| !dropped(p));
            let orders = OrderBalance::of(&self.data.design, tested.map(|p| self.data.order(p)));
            panel.balance = orders.map(|orders| orders.balance);
        }
        (subjects, values)
    }

    /// Tests all conditions at once.
    fn judge(&mut self, purpose: Purpose) -> Result<(), AnalysisError> {
        let tested = Tested {
            data: self.data,
            asked: self.asked,
            panel: &self.panel,
            people: self.people,
            purpose,
            period: self.period,
        };
        let compared = by_design(&tested)?;
        let panel = &mut self.panel;
        match compared {
            Ok(Compared { comparison, by_factor, carry_over }) => {
                panel.reasons = comparison.reasons().to_vec();
                panel.carry_over = carry_over;
                let of_test = match &comparison {
                    ByDesign::Factorial(_) if by_factor.is_some() => None,
                    ByDesign::Mixed(_) => Some("a mixed model gives none"),
                    _ => Some("this test is not one of several factors"),
                };
                let is_declared = !self.data.design.level_contrasts().is_empty();
                if let (None, true, Some(why)) = (&panel.group, is_declared, of_test) {
                    let why = format!("the declared contrasts of factors have no test: {why}");
                    panel.reasons.push(why);
                }
                if let Some((by_factor, untested)) = by_factor {
                    panel.reasons.extend(untested);
                    panel.by_factor = Some(by_factor);
                }
                panel.comparison = Some(comparison);
            }
            Err(why) => panel.reasons.push(why),
        }
        let reasons = &mut panel.reasons;
        reasons.extend(self.period.reason().map(str::to_owned));
        reasons.extend(cut_drives(self.data, self.asked, self.people));
        Ok(())
    }

    /// Compares the pairs, by the values of the people who have all.
    fn contrast(&mut self, subjects: &[String], values: &[Vec<f64>]) -> Result<(), AnalysisError> {
        let (data, asked, period) = (self.data, self.asked, self.period);
        let expected = |[first, second]: [ConditionId; 2]| asked.expected(data, first, second);
        let contrasts = std::mem::take(&mut self.pairs);
        let panel = &mut self.panel;
        // No other test steps in for one that was declared, or that takes the period, and has no result.
        let declared = asked.test.is_some_and(|t| t != DeclaredTest::Auto);
        let no_result = (period == Period::Taken || declared) && panel.comparison.is_none();
        if panel.n < 2 || panel.conditions.len() < 2 || no_result {
            let measured = &*panel;
            let untested = |pair: [ConditionId; 2]| Contrast {
                mean_difference: mean_difference(measured, pair).filter(|_| no_result),
                ..Contrast::untested(pair, expected(pair))
            };
            let untested = contrasts.into_iter().map(untested).collect();
            panel.contrasts = untested;
            return Ok(());
        }
        if let Some(pairs) = model_pairs(data, asked, panel, period) {
            let of_model = |pair| {
                let contrast = pairs.contrast(pair, mean_difference(panel, pair), expected(pair));
                let people = counted(panel, &contrast);
                Contrast { people, ..contrast }
            };
            let compared = contrasts.into_iter().map(of_model).collect();
            (panel.test, panel.contrasts) = (Some(pairs.test), compared);
            return Ok(());
        }
        let names: Vec<String> = panel.conditions.iter().map(ToString::to_string).collect();
        let tested = WithinSubjects::from_rows(&names, subjects, values)?;
        let test = test_of_pairs(panel.comparison.as_ref());
        let pairs = match panel.comparison.as_ref().and_then(ByDesign::one_factor) {
            Some(one_factor) => one_factor.posthoc.clone(),
            None => posthoc(&tested, test, Adjustment::None, ALPHA)?,
        };
        panel.test = Some(match pairs.test {
            PosthocTest::Wilcoxon => ContrastTest::Wilcoxon,
            _ => ContrastTest::T,
        });
        let from = panel.differences_from;
        for pair in contrasts {
            let contrast = match from.filter(|b| pair.contains(b)) {
                Some(baseline) => {
                    from_zero(&panel.conditions, values, baseline, pair, expected(pair))?
                }
                None => Contrast::from_posthoc(&pairs, pair, expected(pair)),
            };
            let people = counted(panel, &contrast);
            panel.contrasts.push(Contrast { people, ..contrast });
        }
        Ok(())
    }
}

/// The first column that the test takes of people and that this one has no value of: of a group the levels of its factors are its own.
fn lacked_column<'d>(data: &'d StudyData, p: &ParticipantId, grouped: bool) -> Option<&'d str> {
    let factors = data.design.factors().iter().filter(|_| !grouped);
    let covariates = data.design.covariates().iter();
    let columns = factors.map(|f| f.name.as_str());
    let mut columns = columns.chain(covariates.map(|c| c.column.as_str()));
    columns.find(|column| data.column(p, column).is_none())
}

/// Whether differences from the baseline can be taken: a measure of the study's own may exist in the conditions alone, as the time to take
/// over from a car does.
fn has_baseline(
    data: &StudyData,
    asked: &Asked,
    baseline: ConditionId,
    people: &[ParticipantId],
) -> bool {
    let measured = |p| asked.value(data, p, baseline).is_some();
    data.design.measure(&asked.id).is_none() || people.iter().any(measured)
}

/// Says of a count or an extreme that it was taken from parts of drives, where a person's drives differ in length.
fn cut_drives(data: &StudyData, asked: &Asked, people: &[ParticipantId]) -> Option<String> {
    let grows = asked.column().and_then(objective::find)?.grows;
    let ids = data.design.condition_ids();
    let ids: Vec<ConditionId> = ids.chain(data.design.baseline_id()).collect();
    let cut_count =
        |p: &ParticipantId| ids.iter().filter(|c| data.counted_s(p, **c).is_some()).count();
    let cut: Vec<usize> = people.iter().map(cut_count).filter(|drives| *drives > 0).collect();
    (grows && !cut.is_empty()).then(|| {
        format!(
            "people whose drives differ in length ({}): their values are those of the part of each drive ({} in all) that is as long as the \
             person’s shortest and meets as many lead vehicles",
            cut.len(),
            cut.iter().sum::<usize>()
        )
    })
}

/// People whose first value lies above the second, at it, and below it.
fn counted(panel: &Panel, contrast: &Contrast) -> [usize; 3] {
    let mut counts = [0; 3];
    for [first, second] in values(panel, contrast.first, contrast.second) {
        counts[match first.total_cmp(&second) {
            Ordering::Greater => 0,
            Ordering::Equal => 1,
            Ordering::Less => 2,
        }] += 1;
    }
    counts
}

/// The declared contrasts, and those that a hypothesis about this outcome adds; each that one is about the way round it says it, so that
/// a table and the sentence about it have one sign.
fn contrasts(data: &StudyData, id: &str) -> Vec<[ConditionId; 2]> {
    let mut pairs = data.design.contrasts();
    let of_this = data.design.hypotheses().iter().filter(|h| h.outcome == id);
    // The first of several hypotheses about a pair has its way.
    for hypothesis in of_this.rev() {
        let [first, second] = hypothesis.contrast;
        let same = |pair: &&mut [ConditionId; 2]| pair.contains(&first) && pair.contains(&second);
        match pairs.iter_mut().find(same) {
            Some(pair) => *pair = [first, second],
            None => pairs.push([first, second]),
        }
    }
    pairs
}

/// Holm's correction over all contrasts of an outcome.
fn correct(family: &mut [Panel]) -> Result<(), AnalysisError> {
    let contrasts = family.iter_mut().flat_map(|panel| &mut panel.contrasts);
    holm(contrasts.map(|c| (c.p, &mut c.p_holm)))
}
