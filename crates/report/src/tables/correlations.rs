//! The correlation table of the homophily analysis.

use super::{Cell, Table};
use crate::apa;
use serde::{Deserialize, Serialize};

/// Which coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Coefficient {
    /// Pearson's r.
    Pearson,
    /// Spearman's ρ.
    Spearman,
    /// Repeated-measures correlation: several rows of one person.
    RepeatedMeasures,
}

/// A computed correlation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Correlation {
    /// Which coefficient.
    pub coefficient: Coefficient,
    /// Its value.
    pub value: f64,
    /// Degrees of freedom.
    pub df: usize,
    /// Two-sided p.
    pub p: f64,
}

impl Correlation {
    /// As APA writes it.
    pub fn statement(&self) -> apa::Statement {
        match self.coefficient {
            Coefficient::Pearson => apa::r(self.value, self.df, self.p),
            Coefficient::Spearman => apa::rho(self.value, self.df, self.p),
            Coefficient::RepeatedMeasures => apa::r_rm(self.value, self.df, self.p),
        }
    }

    /// The same as a cell of a table; missing where there is none.
    pub fn cell(found: Option<Self>) -> Cell {
        found.map_or(Cell::Missing, |c| {
            Cell::Marked(c.statement().markup().to_owned())
        })
    }
}

/// One pair of variables.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CorrelationRow {
    /// Such as `Conscientiousness`.
    pub independent: String,
    /// Such as `Mimic − Cautious, competence`.
    pub dependent: String,
    /// Ours; `None` if it could not be computed.
    pub ours: Option<Correlation>,
    /// Ours with the repeated answers of one person taken as such, where they are.
    pub repeated: Option<Correlation>,
    /// What the paper printed for this pair, if it did.
    pub paper: Option<Correlation>,
}

/// Builds the table `correlations`.
pub fn correlations(rows: &[CorrelationRow], participants: usize) -> Table {
    let title = "Personality, driving style and similarity against ratings";
    Table::of("correlations", title, rows)
        .text("Independent", |row| &row.independent)
        .text("Dependent", |row| &row.dependent)
        .left("Here", |row| Correlation::cell(row.ours))
        .left("Here, repeated measures", |row| {
            Correlation::cell(row.repeated)
        })
        .left("Paper", |row| Correlation::cell(row.paper))
        .noted(format!(
            "*n* = {participants} participants. Pearson’s *r* where assumptions hold, else \
             Spearman’s *ρ*; *p* values are not adjusted. Rows with more pairs than participants \
             repeat each participant once a condition: *r*_{{rm}} takes that into account. Paper: \
             its own, real participants."
        ))
}
