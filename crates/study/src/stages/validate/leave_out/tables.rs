//! What was found of people who were left out in turn, as tables.

use super::{Answer, Answered, InTurn};
use crate::error::StudyError;
use maveric_domain::{ConditionId, Design, design::ValidateTable};
use maveric_pages::cards::in_turn::text;
use maveric_rehearsal::leave_out::{
    AXES, By, Change, Direction, ErrorShare, Mean, Order, PersonDirection, Retest, Shipped,
    ShippedPerson, Whose,
};
use maveric_report::tables::{Cell, Table};
use minijinja::{Value, context};

/// The tables of each question, with its id.
pub(super) fn tables(
    validation: &InTurn,
    design: &Design,
) -> Result<Vec<(String, Vec<Table>)>, StudyError> {
    let section = |answered: &Answered| {
        let rule = &answered.asked;
        let words =
            Words { id: &rule.id, people: validation.people_of(rule), seen: rule.seen, design };
        let tables = match &answered.answer {
            None => Vec::new(),
            Some(Answer::Order(order)) => words.order(order)?,
            Some(Answer::Identity(rows)) => words.identity(rows)?,
            Some(Answer::Retest { measures, .. }) => words.retest(measures)?,
            Some(Answer::Errors(share)) => words.errors(share, rule)?,
            Some(Answer::Direction { found, .. }) => words.direction(found, rule)?,
            Some(Answer::Shipped(shipped)) => words.shipped(shipped, rule)?,
        };
        Ok((rule.id.clone(), tables))
    };
    validation.tables.iter().map(section).collect()
}

/// What the tables of one question say of themselves.
struct Words<'a> {
    id: &'a str,
    /// People whose drives are read.
    people: usize,
    seen: bool,
    design: &'a Design,
}

/// An interval in square brackets; nothing where there is none.
fn interval(ends: Option<(f64, f64)>, decimals: usize) -> Cell {
    ends.map_or(Cell::Missing, |(low, high)| {
        Cell::text(format!("{low:.decimals$} to {high:.decimals$}").replace('-', "−"))
    })
}

/// A share as a percentage.
fn percent(share: Option<f64>) -> Cell {
    Cell::number(share.map(|s| 100.0 * s), 1)
}

/// One of the two changes of a person.
type Side = fn(&PersonDirection) -> &Change;

impl Words<'_> {
    fn name(&self, part: &str) -> String {
        format!("in-turn-{}{part}", self.id)
    }

    fn listed(&self, roles: &[ConditionId]) -> String {
        let labels: Vec<String> = roles.iter().map(|role| self.design.label(*role)).collect();
        maveric_pages::words::listed(&labels)
    }

    fn order(&self, order: &Order) -> Result<Vec<Table>, StudyError> {
        let sure = order.people.iter().filter(|p| p.wrong_and_sure());
        let wrong_and_sure: Vec<String> = sure.map(|p| p.participant.to_string()).collect();
        let values = context! {
            higher => self.design.label(order.asked.higher),
            lower => self.listed(&order.asked.lower),
            n => order.people.len(),
            people => self.people,
            seen => self.seen,
            chance => order.chance,
            permutations => order.permutations,
            wrong_and_sure,
        };
        let named = |by: By| {
            let key = match by {
                By::Line => "by_line",
                By::Speed => "by_speed",
                By::TimeGap => "by_time_gap",
            };
            text("order", key, &values)
        };
        let mut rows = Vec::new();
        for read in &order.readings {
            rows.push((named(read.by)?, read));
        }
        let mean = |mean: Option<Mean>| Cell::number(mean.map(|m| m.mean), 2);
        let ends = |mean: Option<Mean>| interval(mean.and_then(|m| m.low.zip(m.high)), 2);
        let table = Table::of(self.name(""), text("order", "title", &values)?, rows)
            .text("Read by", |(name, _)| name.clone())
            .right("Right", |(_, r)| Cell::count(r.right))
            .right("Of", |(_, r)| Cell::count(r.n))
            .right("%", |(_, r)| percent(r.share.map(|s| s.estimate)))
            .right("95% CI (%)", |(_, r)| {
                interval(r.share.map(|s| (100.0 * s.low, 100.0 * s.high)), 0)
            })
            .right("*p*", |(_, r)| Cell::p(r.p))
            .right("Difference (SD)", |(_, r)| mean(r.difference))
            .right("95% CI", |(_, r)| ends(r.difference))
            .right("*d*_{z}", |(_, r)| Cell::number(r.difference.and_then(|d| d.dz), 2))
            .right("Beyond speed (SD)", |(_, r)| mean(r.beyond_speed))
            .right("95% CI ", |(_, r)| ends(r.beyond_speed))
            .noted(text("order", "note", &values)?);
        let people =
            Table::of(self.name("-people"), text("people", "title", &values)?, &order.people)
                .text("Person", |p| p.participant.as_str())
                .right("Right", |p| Cell::word(p.right, "yes", "no"))
                .right("Line", |p| Cell::number(p.line, 2))
                .right("SE", |p| Cell::number(p.line_se, 2))
                .right("Mean speed (m/s)", |p| Cell::number(p.speed_mps, 2))
                .right("Median time gap (s)", |p| Cell::number(p.time_gap_s, 2))
                .noted(text("people", "note", &values)?);
        Ok(vec![table, people])
    }

    fn identity(&self, rows: &[Whose]) -> Result<Vec<Table>, StudyError> {
        let Some(first) = rows.first() else {
            return Ok(Vec::new());
        };
        let values = context! {
            sought => self.design.label(first.sought),
            among => self.design.label(first.among),
            n => first.n,
            people => self.people,
            seen => self.seen,
            chance => first.chance,
        };
        let mut named = Vec::new();
        for row in rows {
            let key = match row.by {
                By::Line => "by_style",
                By::Speed => "by_speed",
                By::TimeGap => "by_time_gap",
            };
            named.push((text("identity", key, &values)?, row));
        }
        let table = Table::of(self.name(""), text("identity", "title", &values)?, named)
            .text("Read by", |(name, _)| name.clone())
            .right("Found", |(_, r)| Cell::count(r.hits))
            .right("Of", |(_, r)| Cell::count(r.n))
            .right("Chance (%)", |(_, r)| percent((r.n > 0).then_some(r.chance)))
            .right("%", |(_, r)| percent(r.share.map(|s| s.estimate)))
            .right("95% CI (%)", |(_, r)| {
                interval(r.share.map(|s| (100.0 * s.low, 100.0 * s.high)), 0)
            })
            .noted(text("identity", "note", &values)?);
        Ok(vec![table])
    }

    fn retest(&self, measures: &[Retest]) -> Result<Vec<Table>, StudyError> {
        let Some(first) = measures.first() else {
            return Ok(Vec::new());
        };
        let values = context! {
            role => self.design.label(first.role),
            n => measures.iter().map(|m| m.n).max(),
            seen => self.seen,
        };
        let icc = |m: &Retest, value: fn(&maveric_stats::Icc) -> Option<f64>| {
            m.icc.as_ref().and_then(value)
        };
        let table = Table::of(self.name(""), text("retest", "title", &values)?, measures)
            .text("Measure", |m| m.title.as_str())
            .text("Unit", |m| m.unit.as_str())
            .right("*n*", |m| Cell::count(m.n))
            .right("SEM", |m| Cell::number(icc(m, |i| Some(i.sem)), 3))
            .right("95% CI", |m| {
                interval(icc(m, |i| i.sem_ci.low).zip(icc(m, |i| i.sem_ci.high)), 3)
            })
            .right("SDC", |m| Cell::number(icc(m, |i| Some(i.sdc)), 3))
            .right("ICC(2,1)", |m| Cell::bounded(icc(m, |i| i.icc), 2))
            .right("95% CI ", |m| interval(icc(m, |i| i.ci.low).zip(icc(m, |i| i.ci.high)), 2))
            .noted(text("retest", "note", &values)?);
        Ok(vec![table])
    }

    fn errors(&self, share: &ErrorShare, rule: &ValidateTable) -> Result<Vec<Table>, StudyError> {
        let values = context! {
            role => rule.role.map(|role| self.design.label(role)),
            pairs => share.pairs,
            coordinates => share.coordinates,
            seen => self.seen,
        };
        let rows = [(1, share.within_1, 68.3), (2, share.within_2, 95.4)];
        let fraction =
            |count: usize| (share.coordinates > 0).then(|| count as f64 / share.coordinates as f64);
        let table = Table::of(self.name(""), text("errors", "title", &values)?, rows)
            .right("Within standard errors", |(k, _, _)| Cell::count(*k))
            .right("Coordinates", |(_, count, _)| Cell::count(*count))
            .right("%", |(_, count, _)| percent(fraction(*count)))
            .right("Expected (%)", |(_, _, expected)| Cell::number(Some(*expected), 1))
            .noted(text("errors", "note", &values)?);
        Ok(vec![table])
    }

    /// What a table of two roles says of them.
    fn of_pair(&self, rule: &ValidateTable) -> Value {
        context! {
            higher => rule.higher.map(|role| self.design.label(role)),
            lower => rule.lower.first().map(|role| self.design.label(*role)),
            people => self.people,
            seen => self.seen,
        }
    }

    fn direction(
        &self,
        direction: &Direction,
        rule: &ValidateTable,
    ) -> Result<Vec<Table>, StudyError> {
        let values = context! {
            n => direction.n,
            points => rule.points,
            directions => direction.directions,
            ..self.of_pair(rule)
        };
        let mut rows = Vec::new();
        for (key, cosine, p) in [
            ("driven", direction.driven, None),
            ("dial", direction.dial, direction.p),
            ("drawn", direction.drawn, None),
            ("speed", direction.speed, None),
            ("speed_and_gap", direction.speed_and_gap, None),
        ] {
            rows.push((text("direction", key, &values)?, cosine, p));
        }
        let table = Table::of(self.name(""), text("direction", "title", &values)?, rows)
            .text("Change", |(name, _, _)| name.clone())
            .right("Mean cosine", |(_, cosine, _)| Cell::bounded(*cosine, 2))
            .right("*p*", |(_, _, p)| Cell::p(*p))
            .noted(text("direction", "note", &values)?);
        let mut people = Table::of(
            self.name("-people"),
            text("direction", "people", &values)?,
            &direction.people,
        )
        .text("Person", |p| p.participant.as_str())
        .right("Cosine", |p| Cell::bounded(p.cosine, 2));
        let sides: [(&str, Side); 2] = [("own", |p| &p.own), ("car", |p| &p.dial)];
        let names = ["speed_axis", "gap_axis", "moving_out_axis", "changes_axis"];
        for (side, change) in sides {
            for (axis, name) in names.iter().enumerate().take(AXES) {
                let head = format!(
                    "{}: {}",
                    text("direction", name, &values)?,
                    text("direction", side, &values)?
                );
                people = people.right(head, move |p| Cell::number(change(p)[axis], 2));
            }
        }
        Ok(vec![table, people.noted(text("direction", "people_note", &values)?)])
    }

    fn shipped(&self, shipped: &Shipped, rule: &ValidateTable) -> Result<Vec<Table>, StudyError> {
        let values = context! {
            n => shipped.n,
            unknown => shipped.unknown,
            people_learned_from => shipped.people_learned_from,
            ordinary => shipped.ordinary,
            ordinary_beyond => shipped.ordinary_beyond,
            low => shipped.share.map(|s| 100.0 * s.low),
            high => shipped.share.map(|s| 100.0 * s.high),
            wrong_and_sure => shipped.wrong_and_sure.iter().map(ToString::to_string).collect::<Vec<_>>(),
            ..self.of_pair(rule)
        };
        let mut rows = Vec::new();
        for (key, within, beyond) in [
            ("right", shipped.right_within, shipped.right_beyond),
            ("wrong", shipped.wrong_within, shipped.wrong_beyond),
        ] {
            rows.push((text("shipped", key, &values)?, within, beyond));
        }
        let table = Table::of(self.name(""), text("shipped", "title", &values)?, rows)
            .text("Read", |(name, _, _)| name.clone())
            .right("Neither drive beyond", |(_, within, _)| Cell::count(*within))
            .right("One of them beyond", |(_, _, beyond)| Cell::count(*beyond))
            .noted(text("shipped", "note", &values)?);
        let word = |beyond| Cell::word(beyond, "yes", "no");
        let people =
            Table::of(self.name("-people"), text("shipped", "people", &values)?, &shipped.people)
                .text("Person", |p: &&ShippedPerson| p.participant.as_str())
                .right("Line", |p| Cell::number(p.line, 2))
                .right("SE", |p| Cell::number(p.line_se, 2))
                .right("Ordinary drive beyond", |p| word(p.ordinary_beyond))
                .right("Other drive beyond", |p| word(p.higher_beyond))
                .noted(text("shipped", "people_note", &values)?);
        Ok(vec![table, people])
    }
}

/// What a section says before its tables.
pub(super) fn intro(answered: &Answered) -> Result<Vec<String>, StudyError> {
    let values: Value = context! {
        seen => answered.asked.seen,
        unanswered => answered.unanswered.clone(),
    };
    let intro = text("page", "intro", &values)?;
    Ok(Some(intro).filter(|i| !i.trim().is_empty()).into_iter().collect())
}
