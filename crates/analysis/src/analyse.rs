//! Every analysis of a study.

use crate::{
    Analysis, AnalysisError, Exclusion, Panel, Reproduction, StudyData, by_factor, compare,
    congruence, describe, design_test::Purpose, findings, homophily, hypotheses, lent, line, mixed,
    presses, primary, reproduction, retest, sensitivity, which,
};
use maveric_domain::{
    Design, ParticipantId,
    design::{Condition, DeclaredTest, Outcome, Quantity, crossed},
};
use maveric_measures::objective;

/// Every analysis that the design of a study asks for.
///
/// # Errors
/// [`AnalysisError`] if the design names a factor that nobody answered, or a test refuses its data.
///
/// # Source
/// Method section 9.
pub fn analyse(data: &StudyData, purpose: Purpose) -> Result<Analysis, AnalysisError> {
    if let Some(outcome) = data.design.outcomes().iter().find(|o| unanswered(data, o)) {
        return Err(AnalysisError::Unanswered { outcome: outcome.id() });
    }
    by_factor::check(data)?;
    without_periods(data)?;
    let panels = compare::panels(data, purpose)?;
    let mut reproduction = reproduction::reproduction(data, &panels)?;
    let nearer = reproduction::nearer(data, &panels)?;
    let exclusions = exclusions(&data.design, &panels, &reproduction);
    // What nobody has of both drives is listed as left out, and nothing was asked of it.
    reproduction.retain(|row| row.n > 0 || row.bias.is_some());
    let primary = primary::primary(data, &panels);
    let mut analysis = Analysis {
        synthetic: data.is_synthetic(),
        scripted: data.is_scripted(),
        participants: data.participants.len(),
        partly: names(data.partly()),
        flow: data.flow.clone(),
        orders: data.order_balance(),
        hypotheses: hypotheses::verdicts(data, &panels, &primary)?,
        sensitivity: sensitivity::sensitivity(data, purpose, &panels, &primary)?,
        primary,
        line: line::line(data, true)?,
        line_without_adb: line::line(data, false)?,
        reproduction,
        panels,
        descriptives: describe::describe(data),
        nearer,
        kept: line::kept(data)?,
        congruence: congruence::by_rating(data, purpose)?,
        homophily: homophily::homophily(data)?,
        mixed: mixed::mixed(data)?,
        similarity: homophily::similarity(data)?,
        preferences: homophily::preferences(data),
        presses: presses::presses(data)?,
        repeats: retest::repeats(data)?,
        lent: lent::beside_lent(data)?,
        which: which::which_ride(data)?,
        beyond_training: beyond_training(data),
        notes: notes(data),
        exclusions,
        without_baseline: names(data.without_baseline()),
        without_answer: names(data.without_answer()),
        findings: Vec::new(),
    };
    analysis.findings = findings::of_study(&data.design, &analysis);
    Ok(analysis)
}

fn names<'a>(people: impl Iterator<Item = &'a ParticipantId>) -> Vec<String> {
    people.map(ToString::to_string).collect()
}

/// Refuses a declared test that takes no period, where orders are known.
fn without_periods(data: &StudyData) -> Result<(), AnalysisError> {
    let people = data.participants.iter().filter(|p| !data.order(p).is_empty()).count();
    for outcome in data.design.outcomes() {
        let test = match outcome.test {
            Some(DeclaredTest::RmAnova) => "rm-anova",
            Some(DeclaredTest::Friedman) => "friedman",
            _ => continue,
        };
        if people > 0 {
            return Err(AnalysisError::NoPeriod { outcome: outcome.id(), test, people });
        }
    }
    Ok(())
}

/// Whether an outcome is a score that nobody has of any condition.
fn unanswered(data: &StudyData, outcome: &Outcome) -> bool {
    let Quantity::Score(name) = &outcome.quantity else {
        return false;
    };
    let conditions = || data.design.conditions().iter();
    let answered = |p| conditions().any(|c| data.rated(p, c.id, name).is_some());
    !data.participants.iter().any(answered)
}

fn beyond_training(data: &StudyData) -> Option<f64> {
    let shifted = data.shifted();
    let rows = data.conditions.iter().filter(|row| {
        let tested = data.participants.binary_search(&row.participant);
        shifted.contains(&row.condition) && tested.is_ok()
    });
    let beyond: Vec<bool> = rows.map(|row| row.beyond_training).collect();
    let share = beyond.iter().filter(|b| **b).count() as f64 / beyond.len() as f64;
    Some(share).filter(|s| s.is_finite())
}

/// What the design asks for and is done in another way.
fn notes(data: &StudyData) -> Vec<String> {
    let conditions: Vec<&Condition> = data.design.conditions().iter().collect();
    let cross = conditions.iter().any(|c| !c.levels.is_empty());
    let mut notes = Vec::new();
    let undeclared = data.design.outcomes().is_empty();
    let driven = !data.measurements.is_empty();
    let nowhere: Vec<String> = objective::all()
        .iter()
        .filter(|m| undeclared && driven && !data.is_measured(m.name))
        .map(|m| format!("{} ({})", m.title.to_lowercase(), m.why_missing))
        .collect();
    if !nowhere.is_empty() {
        notes.push(format!(
            "No drive has a value of these measures, so they are not tested: {}.",
            nowhere.join("; ")
        ));
    }
    if !driven {
        notes.push("There are no drives: nothing that a drive shows is measured.".to_owned());
    }
    let unmeasured = data.design.measures().iter();
    let unmeasured = unmeasured.filter(|m| !data.is_measured(&m.id));
    let unmeasured: Vec<&str> = unmeasured.map(|m| m.title.as_str()).collect();
    if !unmeasured.is_empty() {
        notes.push(format!(
            "Nobody has a value of these measures of the study’s own: {}.",
            unmeasured.join("; ")
        ));
    }
    if data.design.homophily().is_some() && !data.design.has_style_differences() {
        notes.push(
            "The design declares `[homophily]`, but no car at 0 on the dial beside one elsewhere on it: there are no differences from the own \
             style, and nothing is correlated with them."
                .to_owned(),
        );
    }
    if cross && conditions.len() > 1 && crossed(&conditions).is_none() {
        notes.push(
            "The conditions name levels, but do not cross two factors completely: they are tested as one row of conditions, without main \
             effects and interactions."
                .to_owned(),
        );
    }
    notes
}

fn exclusions(design: &Design, panels: &[Panel], reproduction: &[Reproduction]) -> Vec<Exclusion> {
    let mut exclusions = Vec::new();
    // Whoever is left out of everybody's panel is left out of the group's as well.
    for panel in panels.iter().filter(|p| p.group.is_none()) {
        for who in &panel.dropped {
            exclusions.push(Exclusion {
                who: who.clone(),
                what: format!("comparison of {}", panel.title.to_lowercase()),
                why: if panel.without_order.contains(who) {
                    "the order in which the conditions were met is not known".to_owned()
                } else if let Some(column) = panel.without_column.get(who) {
                    let label = design.factor_label(column);
                    format!("no value of {label}, which the test takes")
                } else if panel.differences_from.is_some() {
                    "no value in at least one condition or in the baseline drive".to_owned()
                } else {
                    "no value in at least one condition".to_owned()
                },
            });
        }
    }
    for row in reproduction {
        let title = row.title.to_lowercase();
        let untested = reproduction::left_out(panels, &row.measure).len();
        for (n, why) in [
            (untested, format!("not in the comparison of {title}")),
            (
                row.dropped.saturating_sub(untested),
                "no value in the baseline drive or in that condition, or a baseline of zero"
                    .to_owned(),
            ),
        ] {
            if n > 0 {
                let people = if n == 1 { "participant" } else { "participants" };
                exclusions.push(Exclusion {
                    who: format!("{n} {people}"),
                    what: format!("accuracy of {title} in {}", row.condition),
                    why,
                });
            }
        }
    }
    exclusions
}
