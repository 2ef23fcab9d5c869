//! The check of the roles of columns, before any test reads them.

use crate::{error::StudyError, tables::Table};
use maveric_stats::{Changes, StatsError, check_groups, check_within};
use serde_json::{Value, json};

/// What a column is in a call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Subject,
    Within,
    Between,
    Covariate,
    /// A predictor of a formula, which states neither within nor between.
    Predictor,
    /// The value, or one of two columns of numbers.
    Number,
}

/// The columns of a call with their roles.
#[derive(Debug, Clone, Default)]
pub struct Roles {
    columns: Vec<(Role, String)>,
}

impl Roles {
    /// The columns of conditions of the same people, or of groups where there is no subject.
    pub(super) fn of_long(long: super::input::Long<'_>) -> Self {
        let factor = if long.subject.is_some() { Role::Within } else { Role::Between };
        Self::default()
            .and(Role::Subject, long.subject)
            .and(factor, [long.within])
            .and(Role::Number, [long.value])
    }

    /// Adds columns of one role.
    pub(super) fn and<T: Into<String>>(
        mut self,
        role: Role,
        columns: impl IntoIterator<Item = T>,
    ) -> Self {
        self.columns.extend(columns.into_iter().map(|name| (role, name.into())));
        self
    }

    fn of(&self, role: Role) -> impl Iterator<Item = &str> {
        self.columns.iter().filter(move |(of, _)| *of == role).map(|(_, name)| name.as_str())
    }

    /// Refuses a column with two roles, and factors that are not what their role says.
    ///
    /// A column that the table lacks is left to the test, which names it.
    pub(super) fn check(&self, table: &Table) -> Result<(), StudyError> {
        let names: Vec<&str> = self.columns.iter().map(|(_, name)| name.as_str()).collect();
        if let Some(twice) = (1..names.len()).find(|&i| names[..i].contains(&names[i])) {
            let problem = format!("`{}` has two roles in this call, expected one", names[twice]);
            let help = "name another column for one of them";
            return Err(StudyError::not_possible(problem).with_help(help));
        }
        for role in [Role::Subject, Role::Within, Role::Between, Role::Predictor] {
            for name in self.of(role).filter(|name| table.has(name)) {
                table.one_case(name)?;
            }
        }
        let Some(subjects) = self.subjects(table)? else {
            return Ok(());
        };
        for name in self.of(Role::Within).filter(|name| table.has(name)) {
            check_within(&subjects, (name, &table.text(name)?))?;
        }
        for name in self.of(Role::Between).filter(|name| table.has(name)) {
            match check_groups(&subjects, (name, &table.text(name)?)) {
                // The test states which levels it needs.
                Err(StatsError::OneLevel { .. }) => {}
                checked => checked?,
            }
        }
        Ok(())
    }

    /// The column of subjects; `None` if there is none, or a cell of it is empty, which the test reports.
    fn subjects(&self, table: &Table) -> Result<Option<Vec<String>>, StudyError> {
        let subject = self.of(Role::Subject).find(|name| table.has(name));
        let cells = subject.map(|name| table.text(name)).transpose()?;
        Ok(cells.and_then(|cells| cells.into_iter().collect()))
    }

    /// Which predictors change within subjects and which do not, with warnings about those that may come of ids used twice.
    pub(super) fn found(&self, table: &Table) -> Result<FoundRoles, StudyError> {
        let mut found = FoundRoles::default();
        let Some(subjects) = self.subjects(table)? else {
            return Ok(found);
        };
        for (role, name) in &self.columns {
            if matches!(role, Role::Subject | Role::Number) {
                continue;
            }
            let changes = Changes::new(&subjects, &table.text(name)?);
            let Some((who, first, second)) = changes.example else {
                found.between.push(name.clone());
                continue;
            };
            found.within.push(name.clone());
            let (one, several) = (changes.with_one, changes.with_several);
            if *role == Role::Covariate {
                found.warnings.push(format!(
                    "the covariate `{name}` changes within subjects (`{who}`: {first} and {second}): if it belongs to the person, two people share an id"
                ));
            } else if one > several {
                let more = match several - 1 {
                    0 => String::new(),
                    more => format!(" and {more} more"),
                };
                found.warnings.push(format!(
                    "`{name}` has several values for `{who}`{more}, and one for {one} others: if it belongs to the person, two people share an id"
                ));
            }
        }
        Ok(found)
    }
}

/// What the predictors of a model are.
#[derive(Debug, Default)]
pub(super) struct FoundRoles {
    within: Vec<String>,
    between: Vec<String>,
    pub(super) warnings: Vec<String>,
}

impl FoundRoles {
    /// As JSON.
    pub(super) fn value(&self) -> Value {
        json!({ "within": self.within, "between": self.between })
    }

    /// As a line of the report.
    pub(super) fn line(&self) -> String {
        let part = |names: &[String], verb: &str| {
            (!names.is_empty()).then(|| format!("{verb}: {}", names.join(", ")))
        };
        let parts = [
            part(&self.within, "change within subjects"),
            part(&self.between, "differ between subjects"),
        ];
        parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
    }
}
