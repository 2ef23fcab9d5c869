//! Measures that a study brings along: columns of a table of its own.

use super::{
    condition::Sign,
    error::{Checked, DesignError, refuse},
    toml_file::{AggressionToml, MeasureToml},
};
use std::collections::BTreeSet;

/// A measure of the study's own: take-over time, glances, whatever another program counted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OwnMeasure {
    /// Its column in the table of `[files] measures`, and its id as an outcome.
    pub id: String,
    /// On the page; the id where none was given.
    pub title: String,
    /// Unit of its values; `1` for counts and shares.
    pub unit: String,
    /// Which way a more aggressive drive moves it; `None` where that is not known.
    pub aggression: Option<Sign>,
}

impl OwnMeasure {
    /// The unit as people read it: nothing for counts and shares.
    pub fn shown_unit(&self) -> &str {
        if self.unit == "1" { "" } else { &self.unit }
    }
}

/// Columns of the table of own measures that say of whom and when a row is.
pub const ABOUT_A_ROW: [&str; 4] = ["participant", "condition", "session", "trial"];

/// The measures with ids that can be columns and outcomes, each once and with its unit.
pub(super) fn own_measures(raw: Vec<MeasureToml>) -> Checked<Vec<OwnMeasure>> {
    let mut ids = BTreeSet::new();
    let measure = |raw: MeasureToml| {
        let id = raw.id;
        let letter = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        // A dot would make it a score, `SCALE.SUBSCALE`.
        if id.is_empty() || !id.chars().all(letter) || ABOUT_A_ROW.contains(&id.as_str()) {
            let expected = format!(
                "the name of its column: letters, digits, `_` and `-`, and none of `{}`, which say whose a row is",
                ABOUT_A_ROW.join("`, `")
            );
            return refuse("measure.id", format!("`{id}`"), expected);
        }
        if !ids.insert(id.clone()) {
            let twice = format!("`{id}` twice");
            return refuse("measure.id", twice, "each once");
        }
        let unit = raw.unit.filter(|unit| !unit.trim().is_empty());
        let unit = unit.ok_or_else(|| {
            let expected = "its unit, such as \"s\"; \"1\" for a count or a share";
            DesignError::key(format!("measure.{id}.unit"), "nothing", expected)
        })?;
        Ok(OwnMeasure {
            title: raw.title.unwrap_or_else(|| id.clone()),
            id,
            unit: unit.trim().to_owned(),
            aggression: match raw.aggression {
                Some(AggressionToml::Up) => Some(Sign::Plus),
                Some(AggressionToml::Down) => Some(Sign::Minus),
                Some(AggressionToml::Unknown) | None => None,
            },
        })
    };
    raw.into_iter().map(measure).collect()
}
