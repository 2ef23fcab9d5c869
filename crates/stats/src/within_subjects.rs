//! n subjects under each of k conditions, complete cases only.

use crate::{StatsError, complete, paired::t::is_constant_difference};

/// A complete table of one value per subject and condition.
///
/// Shape `(n, k)`, with n ≥ 2 and k ≥ 2, every value finite. A subject with a missing cell
/// is left out whole and kept by name in [`dropped`](Self::dropped), so that each test of
/// one analysis speaks of the same people.
#[derive(Debug, Clone, PartialEq)]
pub struct WithinSubjects {
    conditions: Vec<String>,
    subjects: Vec<String>,
    dropped: Vec<String>,
    /// Row-major: one row a subject.
    values: Vec<f64>,
}

impl WithinSubjects {
    /// Reads a tidy table: one row a cell, an empty value or no row for a missing one.
    ///
    /// The three slices have shape `(rows,)`. Conditions and subjects keep the order of
    /// their first appearance.
    ///
    /// # Errors
    /// [`StatsError::LengthMismatch`]; [`StatsError::NotFinite`];
    /// [`StatsError::TooLarge`]; [`StatsError::DoubleCell`]; [`StatsError::JoinedName`]; [`StatsError::TooFewConditions`];
    /// [`StatsError::TooFew`] if fewer than two subjects are complete.
    ///
    /// # Example
    /// ```
    /// use maveric_stats::WithinSubjects;
    /// let names = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
    /// let data = WithinSubjects::from_long(
    ///     &names("ann ann ben ben cem"),
    ///     &names("a b a b a"),
    ///     &[Some(1.0), Some(2.0), Some(4.0), Some(3.0), Some(5.0)],
    /// )?;
    /// assert_eq!((data.n(), data.k(), data.dropped()), (2, 2, &["cem".to_owned()][..]));
    /// # Ok::<(), maveric_stats::StatsError>(())
    /// ```
    pub fn from_long(
        subjects: &[String],
        conditions: &[String],
        values: &[Option<f64>],
    ) -> Result<Self, StatsError> {
        for (name, found) in [("condition", conditions.len()), ("value", values.len())] {
            StatsError::same_length(name, found, subjects.len())?;
        }
        let subject_of = Index::from_labels(subjects);
        let condition_of = Index::from_labels(conditions);
        let k = condition_of.names.len();
        let place = |row: usize| subject_of.rows[row] * k + condition_of.rows[row];
        let double = |row: usize| StatsError::DoubleCell {
            subject: subjects[row].clone(),
            condition: conditions[row].clone(),
        };
        let cells = complete::cells(values, subject_of.names.len() * k, place, double)?;
        StatsError::two_conditions(k)?;
        let (mut kept, mut dropped, mut complete) = (Vec::new(), Vec::new(), Vec::new());
        for (name, row) in subject_of.names.into_iter().zip(cells.chunks(k)) {
            match row.iter().copied().collect::<Option<Vec<f64>>>() {
                Some(row) => {
                    complete.extend(row);
                    kept.push(name);
                }
                None => dropped.push(name),
            }
        }
        Self::checked(condition_of.names, kept, dropped, complete)
    }

    /// Takes a complete table: one row a subject, one column a condition.
    ///
    /// # Errors
    /// As [`from_long`](Self::from_long), and [`StatsError::DoubleName`].
    ///
    /// # Example
    /// ```
    /// use maveric_stats::WithinSubjects;
    /// let data = WithinSubjects::from_rows(
    ///     &["a", "b"], &["ann", "ben"], &[vec![1.0, 2.0], vec![4.0, 3.0]],
    /// )?;
    /// assert_eq!(data.column(1), [2.0, 3.0]);
    /// # Ok::<(), maveric_stats::StatsError>(())
    /// ```
    pub fn from_rows<S: AsRef<str>>(
        conditions: &[S],
        subjects: &[S],
        rows: &[Vec<f64>],
    ) -> Result<Self, StatsError> {
        let owned =
            |names: &[S]| -> Vec<String> { names.iter().map(|s| s.as_ref().to_owned()).collect() };
        let (conditions, subjects) = (owned(conditions), owned(subjects));
        StatsError::same_length("rows", rows.len(), subjects.len())?;
        for (what, names) in [("condition", &conditions), ("subject", &subjects)] {
            Index::from_labels(names).distinct(what)?;
        }
        for (row, values) in rows.iter().enumerate() {
            StatsError::same_length(&subjects[row], values.len(), conditions.len())?;
            for (value, name) in values.iter().zip(&conditions) {
                complete::usable(*value, name, row)?;
            }
        }
        Self::checked(conditions, subjects, Vec::new(), rows.concat())
    }

    /// Takes a wide table: a name and the values of each condition, in any iterator; a value is an `f64`, or an `Option` that may be
    /// missing. Subjects are numbered from 1 in the order of the rows; one with a missing value is left out.
    ///
    /// # Errors
    /// As [`from_long`](Self::from_long), and [`StatsError::DoubleName`].
    ///
    /// # Example
    /// ```
    /// use maveric_stats::{WithinSubjects, rm_anova};
    /// let slow = [1.0, 2.0, 3.0, 1.5];
    /// let data = WithinSubjects::from_columns([
    ///     ("slow", slow.to_vec()),
    ///     ("fast", slow.iter().map(|v| v + 3.0 + 0.1 * v * v).collect()),
    /// ])?;
    /// assert!(rm_anova(&data).to_string().starts_with("F(1, 3) = "));
    /// # Ok::<(), maveric_stats::StatsError>(())
    /// ```
    pub fn from_columns<S, C>(columns: impl IntoIterator<Item = (S, C)>) -> Result<Self, StatsError>
    where
        S: Into<String>,
        C: IntoIterator,
        C::Item: Into<Option<f64>>,
    {
        let columns: Vec<(String, Vec<Option<f64>>)> = columns
            .into_iter()
            .map(|(name, values)| (name.into(), values.into_iter().map(Into::into).collect()))
            .collect();
        let n = columns.first().map_or(0, |(_, values)| values.len());
        let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
        let (mut subjects, mut conditions, mut cells) = (Vec::new(), Vec::new(), Vec::new());
        for (at, (name, values)) in columns.iter().enumerate() {
            StatsError::same_length(name, values.len(), n)?;
            StatsError::distinct("condition", &names[..=at])?;
            subjects.extend((1..=n).map(|i| i.to_string()));
            conditions.extend(std::iter::repeat_n(name.clone(), n));
            cells.extend_from_slice(values);
        }
        Self::from_long(&subjects, &conditions, &cells)
    }

    fn checked(
        conditions: Vec<String>,
        subjects: Vec<String>,
        dropped: Vec<String>,
        values: Vec<f64>,
    ) -> Result<Self, StatsError> {
        StatsError::two_conditions(conditions.len())?;
        tell_apart(&[conditions.as_slice()])?;
        complete::enough("subject", subjects.len(), dropped.len(), 2)?;
        Ok(Self { conditions, subjects, dropped, values })
    }

    /// Number of complete subjects, at least 2.
    pub fn n(&self) -> usize {
        self.subjects.len()
    }

    /// Number of conditions, at least 2.
    pub fn k(&self) -> usize {
        self.conditions.len()
    }

    /// Names of the conditions, in order.
    pub fn conditions(&self) -> &[String] {
        &self.conditions
    }

    /// Names of the complete subjects, in order of first appearance.
    pub fn subjects(&self) -> &[String] {
        &self.subjects
    }

    /// Names of the subjects left out because a cell is missing.
    pub fn dropped(&self) -> &[String] {
        &self.dropped
    }

    /// The values of condition `j` (from 0), shape `(n,)`.
    pub fn column(&self, j: usize) -> Vec<f64> {
        self.rows().map(|row| row[j]).collect()
    }

    /// The values of each subject, each of shape `(k,)`.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[f64]> + Clone {
        self.values.chunks_exact(self.conditions.len())
    }

    /// All values, row by row, shape `(n * k,)`.
    pub(crate) fn values(&self) -> &[f64] {
        &self.values
    }

    /// Condition `i` minus condition `j` of each subject, and whether that is one number but for rounding.
    pub(crate) fn differences(&self, i: usize, j: usize) -> (Vec<f64>, bool) {
        let (a, b) = (self.column(i), self.column(j));
        let differences: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - b).collect();
        let constant = is_constant_difference(&a, &b, &differences);
        (differences, constant)
    }

    /// Each pair of conditions, as [`pairs`] gives them.
    pub(crate) fn pairs(&self) -> Vec<(usize, usize, String)> {
        pairs(&self.conditions)
    }
}

/// Positions and the name `A|B` of each pair, in order.
pub(crate) fn pairs(names: &[String]) -> Vec<(usize, usize, String)> {
    let mut pairs = Vec::new();
    for (i, a) in names.iter().enumerate() {
        for (j, b) in names.iter().enumerate().skip(i + 1) {
            pairs.push((i, j, format!("{a}|{b}")));
        }
    }
    pairs
}

/// Refuses levels of which two cells of all these factors, or two pairs of cells, would have one name: results stand by name, and one
/// would be lost.
pub(crate) fn tell_apart(factors: &[&[String]]) -> Result<(), StatsError> {
    let mut levels = factors.iter().flat_map(|levels| levels.iter());
    let Some((first, others)) = factors.split_first() else {
        return Ok(());
    };
    if !levels.any(|level| level.contains([':', '|'])) {
        return Ok(());
    }
    let cells = others.iter().fold(first.to_vec(), |cells, levels| {
        let mut longer = Vec::new();
        for cell in &cells {
            longer.extend(levels.iter().map(|level| format!("{cell}:{level}")));
        }
        longer
    });
    let pairs: Vec<String> = pairs(&cells).into_iter().map(|(.., name)| name).collect();
    for (what, names) in [("cell", &cells), ("pair", &pairs)] {
        if let Some(name) = Index::from_labels(names).repeated {
            let what = what.to_owned();
            return Err(StatsError::JoinedName { what, name });
        }
    }
    Ok(())
}

/// Every pair of items, in order.
pub(crate) fn each_pair<T>(items: &[T]) -> impl Iterator<Item = (&T, &T)> {
    let firsts = items.iter().enumerate();
    firsts.flat_map(move |(i, a)| items[i + 1..].iter().map(move |b| (a, b)))
}

/// Names in order of first appearance, and for each row which name it carries.
pub(crate) struct Index {
    pub(crate) names: Vec<String>,
    pub(crate) rows: Vec<usize>,
    pub(crate) repeated: Option<String>,
}

impl Index {
    pub(crate) fn from_labels<'l>(labels: impl IntoIterator<Item = &'l String>) -> Self {
        let mut positions = std::collections::HashMap::new();
        let mut index = Self { names: Vec::new(), rows: Vec::new(), repeated: None };
        for label in labels {
            let next = index.names.len();
            let position = *positions.entry(label.as_str()).or_insert(next);
            if position == next {
                index.names.push(label.clone());
            } else if index.repeated.is_none() {
                index.repeated = Some(label.clone());
            }
            index.rows.push(position);
        }
        index
    }

    /// The rows of each name.
    pub(crate) fn members(&self) -> Vec<Vec<usize>> {
        let mut members = vec![Vec::new(); self.names.len()];
        for (row, &name) in self.rows.iter().enumerate() {
            members[name].push(row);
        }
        members
    }

    /// Refuses a name that comes twice.
    pub(crate) fn distinct(&self, what: &str) -> Result<(), StatsError> {
        let twice = self.repeated.as_ref();
        twice.map_or(Ok(()), |name| Err(StatsError::double_name(what, name)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(text: &str) -> Vec<String> {
        text.split(' ').map(str::to_owned).collect()
    }

    #[test]
    fn a_second_value_in_a_cell_is_refused() {
        let error =
            WithinSubjects::from_long(&names("a a a"), &names("x y x"), &[Some(1.0), None, None]);
        assert!(matches!(error, Err(StatsError::DoubleCell { .. })));
    }

    #[test]
    fn levels_whose_joined_names_coincide_are_refused_and_others_are_not() {
        let said = |factors: &[&str]| {
            let levels: Vec<Vec<String>> = factors.iter().map(|text| names(text)).collect();
            let levels: Vec<&[String]> = levels.iter().map(Vec::as_slice).collect();
            let refused = tell_apart(&levels).err();
            refused.map(|e| (e.to_string(), e.suggestion().is_some()))
        };
        let (pair, helped) = said(&["x y|z x|y z"]).unwrap();
        assert!(pair.contains("two pairs") && pair.contains("`x|y|z`") && helped);
        let (cell, helped) = said(&["a a:b", "b:c c"]).unwrap();
        assert!(cell.contains("two cells") && cell.contains("`a:b:c`") && helped);
        for fine in [&["x y|z z"][..], &["a a:b", "c d"], &["x y z", "a b"]] {
            assert_eq!(said(fine), None, "{fine:?}");
        }
        let rows = [vec![1.0, 2.0, 3.0, 4.0], vec![2.0, 3.0, 5.0, 4.0]];
        let conditions = ["x", "y|z", "x|y", "z"];
        let data = WithinSubjects::from_rows(&conditions, &["1", "2"], &rows);
        assert!(matches!(data, Err(StatsError::JoinedName { .. })));
    }

    #[test]
    fn one_subject_one_condition_and_infinities_are_refused() {
        let one = WithinSubjects::from_long(&names("a a"), &names("x y"), &[Some(1.0), Some(2.0)]);
        assert!(matches!(one, Err(StatsError::TooFew { .. })));
        let one = WithinSubjects::from_long(&names("a b"), &names("x x"), &[Some(1.0), Some(2.0)]);
        assert!(matches!(one, Err(StatsError::TooFewConditions { found: 1 })));
        let bad = WithinSubjects::from_long(&names("a b"), &names("x y"), &[Some(f64::NAN), None]);
        assert!(matches!(bad, Err(StatsError::NotFinite { row: 0, .. })));
        assert!(matches!(
            WithinSubjects::from_long(&[], &[], &[]),
            Err(StatsError::TooFewConditions { found: 0 })
        ));
    }

    #[test]
    fn columns_with_holes_leave_their_subject_out_and_of_other_lengths_are_refused() {
        let data = WithinSubjects::from_columns([
            ("x", vec![Some(1.0), None, Some(3.0)]),
            ("y", vec![Some(2.0), Some(5.0), Some(4.0)]),
        ])
        .unwrap();
        assert_eq!((data.subjects(), data.dropped()), (&names("1 3")[..], &names("2")[..]));
        let short = WithinSubjects::from_columns([("x", vec![1.0, 2.0]), ("y", vec![1.0])]);
        assert!(matches!(short, Err(StatsError::LengthMismatch { found: 1, .. })));
        let twice = WithinSubjects::from_columns([("x", vec![1.0, 2.0]), ("x", vec![1.0, 2.0])]);
        assert!(matches!(twice, Err(StatsError::DoubleName { .. })));
    }
}
