//! What the tables say of people who were left out in turn, whom they cannot count, and what became of the questions.

use crate::{
    beyond,
    once::{names, together},
};
use maveric_analysis::Finding;
use maveric_rehearsal::{
    findings,
    leave_out::{Direction, ErrorShare, Order, Retest, Shipped, Uncounted, Whose},
};
use serde::Serialize;

#[derive(Debug, Clone, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    /// Whether the drive in one role lies above the others of its driver.
    Order(Order),
    Identity(Vec<Whose>),
    /// How alike two drives are.
    Retest {
        measures: Vec<Retest>,
        uncounted: Vec<Uncounted>,
    },
    /// Which share of standard errors holds.
    Errors(ErrorShare),
    Direction {
        found: Direction,
        uncounted: Vec<Uncounted>,
    },
    /// What a model says that was learned elsewhere.
    Shipped(Shipped),
}

impl Answer {
    fn uncounted(&self) -> Vec<&Uncounted> {
        match self {
            Self::Order(order) => order.uncounted.iter().collect(),
            Self::Identity(rows) => rows.iter().flat_map(|row| &row.uncounted).collect(),
            Self::Retest { uncounted, .. } | Self::Direction { uncounted, .. } => {
                uncounted.iter().collect()
            }
            Self::Errors(share) => share.uncounted.iter().collect(),
            Self::Shipped(shipped) => shipped.uncounted.iter().collect(),
        }
    }

    /// Whoever a table cannot count, those of one reason together, and whether its model can say whom it has met.
    pub(super) fn warnings(&self, id: &str) -> Vec<String> {
        let rows = self.uncounted().into_iter();
        let rows = rows.map(|u| (u.participant.to_string(), u.why.to_string()));
        let not_counted = |(who, why): (Vec<String>, String)| {
            let are = if who.len() == 1 { "is" } else { "are" };
            format!("{id}: {} {are} not counted: {why}", names(&who))
        };
        let mut warnings: Vec<String> = together(rows).into_iter().map(not_counted).collect();
        if let Self::Shipped(shipped) = self
            && shipped.unknown > 0
        {
            let why = beyond::unknown(shipped.people_learned_from);
            warnings.push(format!("{id}: support is not known: {why}"));
        }
        warnings
    }
}

/// What became of the questions of these answers; of a question that no table asks there is none.
pub(super) fn findings_of(answers: &[&Answer]) -> Vec<Finding> {
    let orders: Vec<&Order> = answers
        .iter()
        .filter_map(|answer| match answer {
            Answer::Order(order) => Some(order),
            _ => None,
        })
        .collect();
    let whose = answers.iter().filter_map(|answer| match answer {
        Answer::Identity(rows) => Some(rows),
        _ => None,
    });
    let directions: Vec<&Direction> = answers
        .iter()
        .filter_map(|answer| match answer {
            Answer::Direction { found, .. } => Some(found),
            _ => None,
        })
        .collect();
    let by_question = [
        findings::ordered(&orders),
        findings::beyond_speed(&orders),
        findings::recognised_unmet(whose.flatten()),
        findings::pointed(&directions),
    ];
    by_question.into_iter().filter(|f| !f.parts.is_empty()).collect()
}
