//! What the conditions did, and which habits they left alone.

use super::{
    StudyPage,
    tested::{contrast, tested},
    titled,
};
use crate::{
    texts::value,
    words::{capital, in_unit_of, omnibus, with_unit},
};
use maveric_analysis::{BesideLent, Contrast, Described, Kept, LentContrast, Panel};
use maveric_domain::{ConditionId, design::Compare};
use maveric_report::{
    ReportError,
    figures::{
        difference_panels::{DifferencePanel, DifferencePanels, PairTest, difference_panels},
        perpendicular::{AngleChange, PerpendicularChanges, PerpendicularPanel, perpendicular},
        time_space::{TimeSpace, time_space},
    },
    html::Section,
    tables::Table,
};
use minijinja::{Value, context};
use serde::Serialize;

/// What was answered to an item of a score that is tested without some of its items.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ItemInCondition {
    /// The outcome, as results call it.
    pub outcome: String,
    /// What the page calls the score.
    pub title: String,
    /// Its number in the scale.
    pub item: u32,
    /// Its words, where the scale has them.
    pub words: String,
    /// Whether the other test leaves it out.
    pub is_dropped: bool,
    pub condition: ConditionId,
    pub n: usize,
    pub mean: f64,
    /// Its standard deviation over people.
    pub sd: Option<f64>,
}

/// Up to so many conditions every pair has its bracket.
const MOST_WITH_ALL_PAIRS: usize = 4;

/// What was measured with its unit; of an answer what its scale is.
pub(super) fn amount(panel: &Panel, unit: &str) -> String {
    if panel.measured || unit.is_empty() { with_unit(&panel.title, unit) } else { capital(unit) }
}

/// The ends of the scale; of what was measured those that its values show.
pub(super) fn ends(panel: &Panel) -> Option<(f64, f64)> {
    let values = panel.rows.iter().flatten().flatten().copied();
    let measured = panel.differences_from.is_none().then_some(values);
    panel.range.or_else(|| ends_of(&measured?))
}

/// What is never below 0 has its lower end there; what is 0 or 1 alone ends at 1.
fn ends_of(values: &(impl Iterator<Item = f64> + Clone)) -> Option<(f64, f64)> {
    let is_yes_or_no = values.clone().all(|v| [0.0, 1.0].contains(&v));
    let most = if is_yes_or_no { 1.0 } else { f64::INFINITY };
    values.clone().all(|v| v >= 0.0).then_some((0.0, most))
}

/// A tested contrast as a figure of these conditions has it: the condition that stands further right less the other, whichever way round it
/// was declared.
fn bracket(conditions: &[ConditionId], contrast: &Contrast) -> Option<PairTest> {
    let place = |id| conditions.iter().position(|c| *c == id);
    let from_the_left = place(contrast.first) < place(contrast.second);
    let effect = contrast.effect.as_ref().and_then(|e| e.value);
    Some(PairTest {
        first: contrast.first,
        second: contrast.second,
        p_holm: contrast.p_holm?,
        effect: effect.map(|v| if from_the_left { -v } else { v }),
    })
}

impl StudyPage<'_> {
    /// What the conditions did; `drive` is one of them from above, `items` those of scores that are tested without some.
    ///
    /// # Errors
    /// [`ReportError`] for a figure that cannot be drawn, or a text that asks for a value which is not given.
    pub fn conditions(
        &self,
        drive: Option<&TimeSpace>,
        items: &[ItemInCondition],
    ) -> Result<Section, ReportError> {
        // A panel without a single value has nothing to show: the exclusions say who is missing and why.
        let has_values = |p: &&Panel| p.rows.iter().flatten().any(Option::is_some);
        let drawn: Vec<&Panel> = self.analysis.panels.iter().filter(has_values).collect();
        let from = drawn.iter().find_map(|p| p.differences_from);
        let mut figures = Vec::new();
        if !drawn.is_empty() {
            let panels = drawn.iter().map(|p| self.panel(p));
            let panels =
                DifferencePanels { panels: panels.collect::<Result<_, _>>()?, from, part: None };
            for part in panels.parts() {
                figures.push(difference_panels(&part, self.context)?);
            }
        }
        figures.extend(self.interaction()?);
        if let Some(drive) = drive {
            figures.push(time_space(drive, self.context)?);
        }
        let mut tables: Vec<Table> = self.primary()?.into_iter().collect();
        tables.extend([self.descriptives()?, self.omnibus()?]);
        tables.extend(self.factor_tables()?);
        tables.extend(self.contrasts()?);
        tables.extend(self.carry_over()?);
        tables.extend(self.sensitivity()?);
        tables.extend(self.texts.table_if_any("items", items)?);
        for lent in &self.analysis.lent {
            tables.push(self.beside_lent(lent)?);
        }
        tables.extend(self.accuracy()?);
        let values = context! { from => from.map(|id| id.to_string()), drawn => drawn.len() };
        self.texts.with(&values).section("conditions", figures, tables)
    }

    fn descriptives(&self) -> Result<Table, ReportError> {
        let rows = self.analysis.descriptives.iter();
        let row = |d: &Described| context! { ..in_unit_of(self.analysis, &d.outcome), ..value(d) };
        self.texts.table("descriptives", rows.map(row))
    }

    /// Which test answered each effect of each panel, and why.
    fn omnibus(&self) -> Result<Table, ReportError> {
        let panels = self.analysis.panels.iter();
        let rows = panels.flat_map(|panel| tested(self.design, panel));
        let values = context! { compares => self.compares() };
        self.texts.with(&values).table("omnibus", rows)
    }

    /// The own style beside somebody else's of the same score.
    fn beside_lent(&self, lent: &BesideLent) -> Result<Table, ReportError> {
        let values = context! {
            own => lent.own.to_string(),
            condition => lent.condition.to_string(),
            people => lent.people,
            donors => lent.donors,
            beyond_reach => lent.beyond_reach,
            distance_sd => lent.distance_sd,
        };
        let row =
            |r: &LentContrast| context! { ..in_unit_of(self.analysis, &r.outcome), ..value(r) };
        let rows = lent.rows.iter().map(row);
        self.texts.with(&values).table("beside-lent", rows)
    }

    /// Every declared contrast with its test; none where nothing is compared.
    fn contrasts(&self) -> Result<Option<Table>, ReportError> {
        let panels = self.analysis.panels.iter();
        let rows = panels.flat_map(|panel| {
            panel.contrasts.iter().map(move |pair| contrast(self.analysis, panel, pair))
        });
        let rows: Vec<Value> = rows.collect();
        self.texts.table_if_any("contrasts", rows)
    }

    /// Which habits a move across the dial changes; `None` where no car moves across it.
    pub fn kept(&self) -> Result<Option<Section>, ReportError> {
        let kept = &self.analysis.kept;
        let Some(first) = kept.first() else {
            return Ok(None);
        };
        let change = self.axis("change_axis", first.from)?;
        let panel = |k: &Kept| {
            let points = k.points.iter();
            Ok(PerpendicularPanel {
                title: k.title.clone(),
                axis: with_unit(&change, &k.unit),
                points: points
                    .map(|&(angle_rad, change)| AngleChange { angle_rad, change })
                    .collect(),
                statistic: self.texts.with(k).text("angle")?,
            })
        };
        let drawn = kept.iter().filter(|k| !k.points.is_empty());
        let changes = PerpendicularChanges {
            panels: drawn.map(panel).collect::<Result<_, ReportError>>()?,
            across: first.across,
            from: first.from,
        };
        let mut figures = Vec::new();
        if !changes.panels.is_empty() {
            figures.push(perpendicular(&changes, self.context)?);
        }
        let intro = kept.iter().map(|k| self.texts.with(k).text("kept"));
        Ok(Some(Section {
            intro: intro.collect::<Result<_, _>>()?,
            ..self.texts.section("kept", figures, Vec::new())?
        }))
    }

    fn axis(&self, key: &str, from: ConditionId) -> Result<String, ReportError> {
        let values: Value = context! { from => from.to_string() };
        self.texts.with(&values).text(key)
    }

    fn panel(&self, panel: &Panel) -> Result<DifferencePanel, ReportError> {
        let axis = match (panel.differences_from, panel.unit.as_str()) {
            (None, unit) => amount(panel, unit),
            (Some(from), unit) => with_unit(&self.axis("difference_axis", from)?, unit),
        };
        // Of many conditions those pairs alone have brackets that somebody asked for.
        let many = panel.conditions.len() > MOST_WITH_ALL_PAIRS;
        let undeclared = many && *self.design.compare() == Compare::All;
        let brackets = panel.contrasts.iter().filter(|_| !undeclared);
        Ok(DifferencePanel {
            title: titled(panel),
            axis,
            conditions: panel.conditions.clone(),
            rows: panel.rows.clone(),
            omnibus: omnibus(self.design, panel, true),
            pairs: brackets.filter_map(|c| bracket(&panel.conditions, c)).collect(),
            reference: panel.same,
            range: ends(panel),
            of_group: panel.group.is_some(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_stats::{Effect, EffectName, Interval};

    #[test]
    fn what_is_0_or_1_alone_ends_there_and_an_amount_at_0_only() {
        let ends = |values: &[f64]| ends_of(&values.iter().copied());
        assert_eq!(ends(&[0.0, 1.0, 1.0]), Some((0.0, 1.0)));
        assert_eq!(ends(&[0.0, 1.0, 0.5]), Some((0.0, f64::INFINITY)));
        assert_eq!(ends(&[0.0, -1.0]), None);
    }

    #[test]
    fn a_bracket_has_one_sign_whichever_way_round_its_contrast_was_declared() {
        let [calm, sporty]: [ConditionId; 2] = ["calm", "sporty"].map(|id| id.parse().unwrap());
        let contrast = |[first, second]: [ConditionId; 2], size: f64| Contrast {
            first,
            second,
            expected: None,
            people: [0; 3],
            mean_difference: None,
            statistic: None,
            df: None,
            se: None,
            interval: None,
            odds: None,
            unbounded: false,
            effect: Some(Effect {
                name: EffectName::Dz,
                value: Some(size),
                ci: Interval::default(),
                confidence: 0.95,
            }),
            p: Some(0.01),
            p_holm: Some(0.02),
        };
        let drawn = |contrast: &Contrast| bracket(&[calm, sporty], contrast).unwrap().effect;
        // Sporty lies higher.
        assert_eq!(drawn(&contrast([calm, sporty], -0.69)), Some(0.69));
        assert_eq!(drawn(&contrast([sporty, calm], 0.69)), Some(0.69));
        let untested = Contrast { p_holm: None, ..contrast([calm, sporty], 1.0) };
        assert!(bracket(&[calm, sporty], &untested).is_none());
    }
}
