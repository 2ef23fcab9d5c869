//! What was declared to decide, and what a condition leaves behind for the next.

use super::{StudyPage, titled};
use crate::{
    texts::value,
    words::{
        closed_as, closed_by, declared_test, in_unit_of, interval, label_of_id, other_choice,
        outcome_decimals,
    },
};
use maveric_analysis::{Balance, Panel, PrimaryOutcome, SensitivityRow};
use maveric_domain::design::World;
use maveric_report::{ReportError, apa, tables::Table};
use maveric_stats::CarryOver;
use minijinja::{Value, context};

impl StudyPage<'_> {
    /// The primary outcomes in the order written; none where none is declared.
    pub(super) fn primary(&self) -> Result<Option<Table>, ReportError> {
        self.texts.table_if_any("primary", self.primary_rows())
    }

    pub(super) fn primary_rows(&self) -> Vec<Value> {
        let outcomes = &self.analysis.primary;
        let row = |o: &PrimaryOutcome| {
            context! {
                declared => declared_test(o.test),
                closed_by => closed_by(o, outcomes),
                closed_as => closed_as(o, outcomes),
                divided => !self.design.factors().is_empty(),
                ..context! { ..in_unit_of(self.analysis, &o.outcome), ..value(o) }
            }
        };
        outcomes.iter().map(row).collect()
    }

    /// What each condition leaves behind, an outcome a row; none where no test takes the period.
    pub(super) fn carry_over(&self) -> Result<Option<Table>, ReportError> {
        let rows = self.carry_over_rows();
        self.texts.table_if_any("carry-over", rows)
    }

    /// Declared contrasts by another choice; none where the design asks for none.
    pub(super) fn sensitivity(&self) -> Result<Option<Table>, ReportError> {
        let mut rows = Vec::new();
        for by_choice in &self.analysis.sensitivity {
            let choice = other_choice(&by_choice.choice);
            let row = |row: &SensitivityRow| {
                context! {
                    outcome => by_choice.outcome.as_str(),
                    title => by_choice.title.as_str(),
                    choice => choice.as_str(),
                    choice_id => value(&by_choice.choice).get_attr("choice").ok(),
                    first_id => row.first.as_str(),
                    second_id => row.second.as_str(),
                    first => self.label(row.first),
                    second => self.label(row.second),
                    n => by_choice.n[0],
                    other_n => by_choice.n[1],
                    ..context! { ..in_unit_of(self.analysis, &by_choice.outcome), ..value(row) }
                }
            };
            rows.extend(by_choice.rows.iter().map(row));
        }
        self.texts.table_if_any("sensitivity", rows)
    }

    /// Whether rides of the same number met the same world: whatever could be pressed in was ridden in the seat, as its protocol says.
    pub(super) fn worlds_by_ride(&self) -> bool {
        self.analysis.presses.is_some() && self.design.protocol().world == World::ByRide
    }

    pub(super) fn carry_over_rows(&self) -> Vec<Value> {
        let row = |panel: &Panel| {
            let carried = panel.carry_over.as_ref()?;
            let (fitted, why_not) = match carried {
                CarryOver::Fitted(fitted) => (Some(fitted), None),
                CarryOver::NotFitted { why_not } => (None, Some(why_not.to_string())),
            };
            let test = fitted.map(|f| &f.test);
            let sentence = test.and_then(|t| Some(t.statement()?.markup().to_owned()));
            let decimals = outcome_decimals(&self.analysis.descriptives, &panel.outcome);
            let left = fitted.map(|f| {
                let effects = f.effects.iter().map(|(id, effect)| {
                    let label = label_of_id(self.design, id);
                    let ends = interval(effect.ci.ends(), decimals, false);
                    format!("{label} {}{ends}", apa::number(effect.estimate, decimals))
                });
                effects.collect::<Vec<_>>()
            });
            Some(context! {
                outcome => panel.outcome.as_str(),
                title => titled(panel),
                unit => panel.unit.as_str(),
                n => panel.n,
                sentence,
                why_not,
                left,
                statistic => test.map(|t| t.f),
                df1 => test.map(|t| t.df1),
                df2 => test.and_then(|t| t.df2),
                p => test.and_then(|t| t.p),
                ratio => fitted.map(|f| f.variance_ratio),
                worlds_by_ride => self.worlds_by_ride(),
                uneven => panel.balance.is_some_and(|b| b != Balance::PlacesAndSuccession),
            })
        };
        self.analysis.panels.iter().filter_map(row).collect()
    }
}
