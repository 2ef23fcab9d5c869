//! The tables of `validate --leave-out people`, where a design declares them.

use super::error::{Checked, DesignError, refuse};
use crate::{condition::ConditionId, ids::ParticipantId};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// The tables about people who are left out in turn.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ValidateTables {
    /// Where the recordings come from, and how they are cited.
    pub source: Option<String>,
    /// In which order people drove.
    pub order_of_drives: Option<String>,
    /// How often roles are exchanged within people; 1000 by default.
    pub permutations: Option<usize>,
    /// The tables, in the order of the page; by default they follow from the roles.
    #[serde(default, rename = "table")]
    pub tables: Vec<ValidateTable>,
}

/// The question of a table.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Asks {
    /// Is one role's drive above the others of its driver?
    #[default]
    Order,
    /// Does the dial point where the driver's own drives of two roles differ?
    Direction,
    /// Whose drive is it?
    Identity,
    /// How alike are two drives in one role?
    Retest,
    /// Do standard errors hold?
    Errors,
    /// What does a model say that was learned elsewhere?
    Shipped,
}

/// One table: a question, and the drives that answer it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ValidateTable {
    /// Its name on the page, in files and in warnings.
    pub id: String,
    /// What it asks.
    pub asks: Asks,
    /// Its numbers were seen while the method was made: no verdict rests on them.
    #[serde(default)]
    pub seen: bool,
    /// The people whose drives it reads; everybody by default.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<String>"))]
    pub people: Vec<ParticipantId>,
    /// The people whom a direction counts; all whom it reads by default.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<String>"))]
    pub judged: Vec<ParticipantId>,
    /// The roles that are learned from; all that were driven by default.
    #[serde(default)]
    pub learn: Vec<ConditionId>,
    /// Roles that are read as well.
    #[serde(default)]
    pub read: Vec<ConditionId>,
    /// Order, direction, shipped: the role that has to be higher.
    pub higher: Option<ConditionId>,
    /// Order, direction, shipped: the roles that it has to be above.
    #[serde(default)]
    pub lower: Vec<ConditionId>,
    /// Identity: the role in which everybody is known.
    pub among: Option<ConditionId>,
    /// Identity: the role whose driver is looked for.
    pub sought: Option<ConditionId>,
    /// Retest and errors: the role that was driven twice.
    pub role: Option<ConditionId>,
    /// Direction: how far the dial is turned, in points.
    pub points: Option<f64>,
    /// Direction: how many directions are drawn beside it.
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub directions: Option<usize>,
}

impl ValidateTable {
    /// Every role whose drives it reads.
    pub fn roles(&self) -> impl Iterator<Item = ConditionId> {
        self.learn.iter().chain(&self.read).copied()
    }

    /// The first key that its question needs and that it lacks.
    fn missing(&self) -> Option<&'static str> {
        let pair = [("higher", self.higher.is_some()), ("lower", !self.lower.is_empty())];
        let needed = match self.asks {
            Asks::Order | Asks::Shipped => pair.to_vec(),
            Asks::Direction => {
                let drawn =
                    [("points", self.points.is_some()), ("directions", self.directions.is_some())];
                [pair, drawn].concat()
            }
            Asks::Identity => {
                vec![("among", self.among.is_some()), ("sought", self.sought.is_some())]
            }
            Asks::Retest | Asks::Errors => vec![("role", self.role.is_some())],
        };
        let mut needed = needed.into_iter();
        needed.find(|(_, is_there)| !is_there).map(|(key, _)| key)
    }
}

/// Tables with ids of their own, the keys that they need, and roles that the design knows.
pub(super) fn validate(raw: &ValidateTables, known: &[ConditionId]) -> Checked<()> {
    let mut ids = BTreeSet::new();
    for table in &raw.tables {
        let key = |name: &str| format!("validate.table.{}.{name}", table.id);
        if table.id.trim().is_empty() || !ids.insert(&table.id) {
            let found = format!("`{}`", table.id);
            return refuse("validate.table.id", found, "an id that no other table has");
        }
        if let Some(missing) = table.missing() {
            return refuse(key(missing), "nothing", "it, for what the table asks");
        }
        for (name, roles) in [
            ("learn", table.learn.as_slice()),
            ("read", &table.read),
            ("higher", table.higher.as_slice()),
            ("lower", &table.lower),
            ("among", table.among.as_slice()),
            ("sought", table.sought.as_slice()),
            ("role", table.role.as_slice()),
        ] {
            if let Some(role) = roles.iter().find(|role| !known.contains(role)) {
                let known = known.iter().map(ConditionId::as_str);
                return Err(DesignError::word(key(name), role.as_str(), known));
            }
        }
        if let Some(points) = table.points.filter(|p| !p.is_finite() || *p == 0.0) {
            return refuse(key("points"), points, "points of the dial other than 0");
        }
        if table.directions == Some(0) {
            return refuse(key("directions"), 0, "at least 1");
        }
    }
    Ok(())
}
