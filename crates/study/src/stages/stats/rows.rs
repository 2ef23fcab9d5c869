//! The columns of any design, read from a table.

use super::{
    columns,
    input::{Long, ROW},
    roles::{Role, Roles},
};
use crate::{error::StudyError, tables::Table};
use clap::builder::ArgPredicate;
use maveric_stats::{DesignColumns, FactorialDesign};

/// Which columns a design has.
#[derive(Debug, Clone, Default, clap::Args)]
pub(super) struct FactorColumns {
    /// Column that says whose row it is; without --within every row is a subject
    #[arg(
        long,
        required_unless_present_any = ["between", "wide"],
        default_value_if("wide", ArgPredicate::IsPresent, ROW)
    )]
    pub(super) subject: Option<String>,
    /// Columns of the factors within subjects, one or two
    #[arg(
        long,
        value_delimiter = ',',
        required_unless_present_any = ["between", "wide"],
        default_value_if("wide", ArgPredicate::IsPresent, "condition")
    )]
    pub(super) within: Vec<String>,
    /// Columns of the factors between subjects, one or two
    #[arg(long, value_delimiter = ',', conflicts_with = "wide")]
    pub(super) between: Vec<String>,
    /// Columns of numbers whose influence is taken out.
    #[arg(skip)]
    pub(super) covariates: Vec<String>,
    /// Products that are tested: a covariate, and the effect within subjects that it is multiplied by.
    #[arg(skip)]
    pub(super) products: Vec<(String, String)>,
    /// Column with the value; several, as in score,speed, are analysed one by one
    #[arg(
        long,
        required = false,
        required_unless_present = "wide",
        default_value_if("wide", ArgPredicate::IsPresent, "value")
    )]
    pub(super) value: String,
}

impl FactorColumns {
    /// What else a factor within subjects asks for: whose rows they are.
    pub(super) fn lacks(&self) -> Option<&'static str> {
        let nobody = self.subject.is_none() && !self.within.is_empty();
        nobody.then_some("--subject with --within")
    }

    /// Each column with its role.
    pub(super) fn roles(&self) -> Roles {
        Roles::default()
            .and(Role::Subject, self.subject.as_deref())
            .and(Role::Within, &self.within)
            .and(Role::Between, &self.between)
            .and(Role::Covariate, &self.covariates)
            .and(Role::Number, [&self.value])
    }

    /// As conditions, where there is one factor within subjects.
    pub(super) fn long(&self) -> Option<Long<'_>> {
        let [within] = &self.within[..] else {
            return None;
        };
        Some(Long { subject: self.subject.as_deref(), within, value: &self.value })
    }
}

#[derive(Debug)]
pub(super) struct DesignRows {
    subjects: Vec<String>,
    within: Vec<NamedColumn<String>>,
    between: Vec<NamedColumn<Option<String>>>,
    covariates: Vec<NamedColumn<Option<f64>>>,
    products: Vec<(String, String)>,
    values: Vec<Option<f64>>,
}

impl DesignRows {
    pub(super) fn read(table: &Table, columns: &FactorColumns) -> Result<Self, StudyError> {
        let subjects = match &columns.subject {
            Some(subject) => columns::labels(table, subject)?,
            None => (1..=table.rows()).map(|row| row.to_string()).collect(),
        };
        Ok(Self {
            subjects,
            within: named(&columns.within, |f| columns::labels(table, f))?,
            between: named(&columns.between, |f| table.text(f))?,
            covariates: named(&columns.covariates, |f| table.numbers(f))?,
            products: columns.products.clone(),
            values: table.numbers(&columns.value)?,
        })
    }

    /// One factor: conditions of the same people, or groups of different ones.
    pub(super) fn one_factor(
        table: &Table,
        subject: Option<&str>,
        factor: &str,
        value: &str,
    ) -> Result<Self, StudyError> {
        let columns = FactorColumns {
            subject: subject.map(str::to_owned),
            between: vec![factor.to_owned()],
            value: value.to_owned(),
            ..FactorColumns::default()
        };
        Self::read(table, &columns)
    }

    pub(super) fn columns(&self) -> DesignColumns<'_> {
        DesignColumns {
            subjects: &self.subjects,
            within: borrowed(&self.within),
            between: borrowed(&self.between),
            covariates: borrowed(&self.covariates),
            with: (self.products.iter())
                .map(|(covariate, effect)| (covariate.as_str(), vec![effect.as_str()]))
                .collect(),
            labels: Vec::new(),
            periods: &[],
            values: &self.values,
        }
    }

    pub(super) fn design(&self) -> Result<FactorialDesign, StudyError> {
        let (within, between) = (borrowed(&self.within), borrowed(&self.between));
        let values = &self.values;
        Ok(FactorialDesign::from_columns(&self.subjects, &within, &between, values)?)
    }

    /// Its factors, those between subjects first.
    pub(super) fn factors(&self) -> Vec<&str> {
        let between = self.between.iter().map(|(name, _)| name.as_str());
        let within = self.within.iter().map(|(name, _)| name.as_str());
        between.chain(within).collect()
    }

    /// Its columns of numbers whose influence is taken out.
    pub(super) fn covariates(&self) -> Vec<String> {
        self.covariates.iter().map(|(n, _)| n.clone()).collect()
    }

    /// Levels of each factor in order of appearance, those between subjects first.
    pub(super) fn levels(&self) -> Vec<Vec<&str>> {
        let between = self.between.iter();
        let between = between.map(|(_, cells)| distinct(cells.iter().flatten()));
        let within = self.within.iter().map(|(_, cells)| distinct(cells));
        between.chain(within).collect()
    }

    /// The cell of a row, the last factor counting fastest.
    fn cell(&self, row: usize, levels: &[Vec<&str>]) -> Option<usize> {
        let between = self.between.iter().map(|(_, cells)| cells[row].as_deref());
        let within = self.within.iter().map(|(_, cells)| Some(cells[row].as_str()));
        let mut cell = 0;
        for (level, levels) in between.chain(within).zip(levels) {
            let level = level?;
            cell = cell * levels.len() + levels.iter().position(|known| *known == level)?;
        }
        Some(cell)
    }

    /// A row a person, a column a cell; whoever has several values in a cell has several rows.
    pub(super) fn people(&self, levels: &[Vec<&str>]) -> Vec<Vec<Option<f64>>> {
        let count: usize = levels.iter().map(Vec::len).product();
        let mut people: Vec<(&str, Vec<Option<f64>>)> = Vec::new();
        for (row, (who, value)) in self.subjects.iter().zip(&self.values).enumerate() {
            let (Some(cell), Some(value)) = (self.cell(row, levels), value) else {
                continue;
            };
            let unfilled =
                people.iter_mut().find(|(known, cells)| known == who && cells[cell].is_none());
            if let Some((_, cells)) = unfilled {
                cells[cell] = Some(*value);
            } else {
                let mut cells = vec![None; count];
                cells[cell] = Some(*value);
                people.push((who, cells));
            }
        }
        people.into_iter().map(|(_, row)| row).collect()
    }
}

/// Cells of a column under its name.
type NamedColumn<T> = (String, Vec<T>);

fn named<T>(
    names: &[String],
    cells: impl Fn(&str) -> Result<Vec<T>, StudyError>,
) -> Result<Vec<NamedColumn<T>>, StudyError> {
    let column = |name: &String| Ok((name.clone(), cells(name)?));
    names.iter().map(column).collect()
}

fn borrowed<T>(columns: &[NamedColumn<T>]) -> Vec<(&str, &[T])> {
    columns.iter().map(|(n, c)| (n.as_str(), &c[..])).collect()
}

fn distinct<'a>(cells: impl IntoIterator<Item = &'a String>) -> Vec<&'a str> {
    let mut seen: Vec<&str> = Vec::new();
    for cell in cells {
        if !seen.contains(&cell.as_str()) {
            seen.push(cell);
        }
    }
    seen
}
