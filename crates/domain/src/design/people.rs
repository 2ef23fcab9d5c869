//! Who is learned from, and who is tested.

use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, path::PathBuf};

/// Column of the people's table → what must stand there; all must hold.
pub(crate) type Wanted = BTreeMap<String, String>;

/// The people of a study.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct People {
    /// Their table: a row a person, from the folder of the design's file.
    pub file: PathBuf,
    /// Those whose drives the networks learn from; nobody without.
    pub learn: Option<BTreeMap<String, String>>,
    /// Those who sat through the conditions; without, everybody who is not learned from.
    pub test: Option<BTreeMap<String, String>>,
}

impl People {
    /// Whether the networks learn from a person; `cell` is what stands in a column of the person's row.
    pub fn learns_from<'a>(&self, cell: impl Fn(&str) -> Option<&'a str>) -> bool {
        self.learn.as_ref().is_some_and(|w| all_hold(w, cell))
    }

    /// Whether a person sat through the conditions.
    pub fn tests<'a>(&self, cell: impl Fn(&str) -> Option<&'a str>) -> bool {
        match &self.test {
            Some(wanted) => all_hold(wanted, cell),
            None => !self.learns_from(cell),
        }
    }

    /// The words by which those columns tell who is learned from and who is tested, by column.
    pub fn values(&self) -> BTreeMap<&str, Vec<&str>> {
        let mut values: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for (column, value) in self.learn.iter().chain(&self.test).flatten() {
            values.entry(column).or_default().push(value);
        }
        values
    }

    /// The columns that tell who is learned from and who is tested.
    pub fn columns(&self) -> Vec<&str> {
        let both = self.learn.iter().chain(&self.test);
        let mut columns: Vec<&str> = both.flat_map(|w| w.keys().map(String::as_str)).collect();
        columns.sort_unstable();
        columns.dedup();
        columns
    }
}

fn all_hold<'a>(wanted: &Wanted, cell: impl Fn(&str) -> Option<&'a str>) -> bool {
    wanted.iter().all(|(column, value)| cell(column) == Some(value.as_str()))
}

/// The factor whose levels are the conditions, where those cross no others.
pub const CONDITION: &str = "condition";

/// A factor: a column of the people's table, or one that the conditions cross.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Factor {
    /// The column of the people's table, or what the design calls it.
    pub name: String,
    /// On the page, where it was given.
    pub label: Option<String>,
    /// Level → what the page calls it, where that is not the level itself.
    pub levels: BTreeMap<String, String>,
}

/// A column of numbers of the people's table that goes along with the outcomes.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Covariate {
    /// A column of the people's table.
    pub column: String,
    /// On the page.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// The effects within people (`condition`, or factors that the conditions cross, `a:b`) whose product with it is
    /// tested; each costs that effect's error a degree of freedom.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub with: Vec<String>,
}
