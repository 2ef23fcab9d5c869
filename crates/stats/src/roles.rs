//! Whether the columns of a table are what a call says: within subjects, or between them.

use crate::{StatsError, factorial::check_between, within_subjects::Index};

/// How the values of one column differ within subjects.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Changes {
    /// Different values in the column.
    pub levels: usize,
    /// Subjects with one value.
    pub with_one: usize,
    /// Subjects with several values.
    pub with_several: usize,
    /// The first subject with several values, and two of them.
    pub example: Option<(String, String, String)>,
}

impl Changes {
    /// Counts the subjects with one value and with several; an empty cell counts as no value.
    ///
    /// Both columns have shape `(rows,)`.
    pub fn new(subjects: &[String], cells: &[Option<String>]) -> Self {
        let people = Index::from_labels(subjects);
        let mut first: Vec<Option<&str>> = vec![None; people.names.len()];
        let mut second: Vec<Option<&str>> = vec![None; people.names.len()];
        for (&person, cell) in people.rows.iter().zip(cells) {
            let Some(cell) = cell else { continue };
            let known = *first[person].get_or_insert(cell);
            if known != cell.as_str() {
                second[person].get_or_insert(cell);
            }
        }
        let pairs = people.names.iter().zip(first.iter().zip(&second));
        let mut several = pairs.filter_map(|(name, (first, second))| {
            let both = (*first)?.to_owned();
            Some((name.clone(), both, (*second)?.to_owned()))
        });
        let example = several.next();
        let with_several = second.iter().flatten().count();
        Self {
            levels: Index::from_labels(cells.iter().flatten()).names.len(),
            with_one: first.iter().flatten().count() - with_several,
            with_several,
            example,
        }
    }
}

/// Refuses a factor within subjects of which no subject has two levels.
///
/// # Errors
/// [`StatsError::NeverChanges`] if the column has two levels and no subject has two of them.
pub fn check_within(
    subjects: &[String],
    (name, cells): (&str, &[Option<String>]),
) -> Result<(), StatsError> {
    let changes = Changes::new(subjects, cells);
    if changes.levels < 2 || changes.with_several > 0 {
        return Ok(());
    }
    Err(StatsError::NeverChanges { factor: name.to_owned() })
}

/// Refuses a factor between subjects of which a subject has two levels.
///
/// # Errors
/// [`StatsError::TwoGroups`] if a subject has two levels; [`StatsError::OneLevel`].
pub fn check_groups(
    subjects: &[String],
    column: (&str, &[Option<String>]),
) -> Result<(), StatsError> {
    check_between(subjects, &column)
}
