//! The table of a factorial design: who has which value in which cell.

use super::sets::sets_of_factors;
use crate::{
    StatsError, complete,
    within_subjects::{Index, tell_apart},
};

/// A factor and its levels, in order of first appearance.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Factor {
    /// As in the data; effects are named after it.
    pub name: String,
    /// Its levels, at least two.
    pub levels: Vec<String>,
}

/// Subjects in groups (the cells of the factors between subjects), each with one value in every cell of the factors within.
///
/// Only complete subjects: one with a missing cell, or without a level of a factor between subjects, is left out whole and kept by
/// name in [`dropped`](Self::dropped). Every group has a subject, and there are more subjects than groups.
#[derive(Debug, Clone, PartialEq)]
pub struct FactorialDesign {
    pub(super) between: Vec<Factor>,
    pub(super) within: Vec<Factor>,
    pub(super) subjects: Vec<String>,
    dropped: Vec<String>,
    /// Of each subject: its group, the last factor counting fastest.
    pub(super) group: Vec<usize>,
    /// Row-major, one row a subject, one column a cell within; the last factor counts fastest.
    pub(super) values: Vec<f64>,
}

/// A factor that changes within subjects: its name and its level in each row.
pub type WithinColumn<'a> = (&'a str, &'a [String]);

/// A factor that does not: its name and its level in each row, which may be missing.
pub type BetweenColumn<'a> = (&'a str, &'a [Option<String>]);

/// Factors of a kind at most.
const MOST_FACTORS: usize = 2;

impl FactorialDesign {
    /// Reads a tidy table: one row a cell, an empty value or no row for a missing one. All columns have shape `(rows,)`.
    ///
    /// Levels keep the order of their first appearance. Without a factor within subjects every row is a subject.
    ///
    /// # Errors
    /// [`StatsError::LengthMismatch`]; [`StatsError::BadParameter`] unless there is a factor, and at most two of each kind;
    /// [`StatsError::OneLevel`]; [`StatsError::NotFinite`]; [`StatsError::DoubleCell`]; [`StatsError::TwoGroups`] if a subject
    /// changes its level of a factor between subjects; [`StatsError::EmptyCell`]; [`StatsError::DoubleName`];
    /// [`StatsError::TooFew`] unless there are more complete subjects than groups.
    ///
    /// # Example
    /// ```
    /// use maveric_stats::FactorialDesign;
    /// let names = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
    /// let design = FactorialDesign::from_columns(
    ///     &names("ann ann ben ben cem cem"),
    ///     &[("mode", &names("calm sporty calm sporty calm sporty"))],
    ///     &[],
    ///     &[Some(1.0), Some(2.0), Some(4.0), Some(3.0), Some(5.0), None],
    /// )?;
    /// assert_eq!((design.n(), design.dropped()), (2, &["cem".to_owned()][..]));
    /// # Ok::<(), maveric_stats::StatsError>(())
    /// ```
    pub fn from_columns(
        subjects: &[String],
        within: &[WithinColumn],
        between: &[BetweenColumn],
        values: &[Option<f64>],
    ) -> Result<Self, StatsError> {
        check_shape(subjects, within, between, values)?;
        let within_index: Vec<Index> =
            within.iter().map(|(_, cells)| Index::from_labels(*cells)).collect();
        let within: Vec<Factor> = within
            .iter()
            .zip(&within_index)
            .map(|((name, _), index)| factor(name, index.names.clone()))
            .collect::<Result<_, _>>()?;
        let people = Index::from_labels(subjects);
        if within.is_empty() {
            people.distinct("subject")?;
        }
        let n = people.names.len();
        let levels: Vec<Levels> = between
            .iter()
            .map(|column| Levels::new(column, &people.names, &people.rows))
            .collect::<Result<_, _>>()?;
        let factors = levels.iter().map(|l| &l.factor).chain(&within);
        let factors: Vec<&Factor> = factors.collect();
        for set in sets_of_factors(factors.len()) {
            let inside = factors.iter().enumerate();
            let inside = inside.filter(|(f, _)| set >> f & 1 == 1);
            let inside: Vec<&[String]> = inside.map(|(_, factor)| &factor.levels[..]).collect();
            tell_apart(&inside)?;
        }
        let counts: Vec<usize> = within.iter().map(|f| f.levels.len()).collect();
        let width: usize = counts.iter().product();
        let cell = |row: usize| {
            let of_row: Vec<usize> = within_index.iter().map(|index| index.rows[row]).collect();
            position(&counts, &of_row)
        };
        let place = |row: usize| people.rows[row] * width + cell(row);
        let double = |row: usize| StatsError::DoubleCell {
            subject: subjects[row].clone(),
            condition: name_of(&within, cell(row)),
        };
        let cells = complete::cells(values, n * width, place, double)?;
        for cell in 0..width {
            if (0..n).all(|i| cells[i * width + cell].is_none()) {
                let cell = name_of(&within, cell);
                return Err(StatsError::EmptyCell { cell });
            }
        }
        let between: Vec<Factor> = levels.iter().map(|l| l.factor.clone()).collect();
        let group_counts: Vec<usize> = between.iter().map(|f| f.levels.len()).collect();
        let mut design = Self {
            between,
            within,
            subjects: Vec::new(),
            dropped: Vec::new(),
            group: Vec::new(),
            values: Vec::new(),
        };
        for (i, name) in people.names.into_iter().enumerate() {
            let row = cells[i * width..(i + 1) * width].iter().copied();
            let row: Option<Vec<f64>> = row.collect();
            let levels: Option<Vec<usize>> = levels.iter().map(|l| l.of_subject[i]).collect();
            if let (Some(row), Some(levels)) = (row, levels) {
                design.values.extend(row);
                design.group.push(position(&group_counts, &levels));
                design.subjects.push(name);
            } else {
                design.dropped.push(name);
            }
        }
        design.check_groups()
    }

    fn check_groups(self) -> Result<Self, StatsError> {
        let groups = self.groups();
        let empty = (0..groups).find(|g| !self.group.contains(g));
        if let Some(group) = empty.filter(|_| groups > 1) {
            let cell = name_of(&self.between, group);
            return Err(StatsError::EmptyCell { cell });
        }
        complete::enough("subject", self.n(), self.dropped.len(), groups + 1)?;
        Ok(self)
    }

    /// Number of complete subjects.
    pub fn n(&self) -> usize {
        self.subjects.len()
    }

    /// Names of the complete subjects, in order of first appearance.
    pub fn subjects(&self) -> &[String] {
        &self.subjects
    }

    /// Names of the subjects left out because a cell or a level is missing.
    pub fn dropped(&self) -> &[String] {
        &self.dropped
    }

    /// The factors within subjects.
    pub fn within(&self) -> &[Factor] {
        &self.within
    }

    /// The factors between subjects.
    pub fn between(&self) -> &[Factor] {
        &self.between
    }

    /// Each subject's sums over the factors within subjects that are not `kept`; of those that are, the last counts fastest.
    pub(crate) fn sums(&self, kept: &[bool]) -> Vec<Vec<f64>> {
        let width = self.cells();
        let mut place = vec![0; width];
        let mut columns = 1;
        let mut below = width;
        for (factor, kept) in self.within.iter().zip(kept) {
            let k = factor.levels.len();
            below /= k;
            if *kept {
                for (cell, place) in place.iter_mut().enumerate() {
                    *place = *place * k + cell / below % k;
                }
                columns *= k;
            }
        }
        let sums = |values: &[f64]| {
            let mut sums = vec![0.0; columns];
            for (value, &at) in values.iter().zip(&place) {
                sums[at] += value;
            }
            sums
        };
        self.values.chunks_exact(width).map(sums).collect()
    }

    /// The level of a factor between subjects, a subject each.
    pub(crate) fn levels_of(&self, between: usize) -> Vec<String> {
        let levels = &self.between[between].levels;
        let level = |&g: &usize| levels[level_in(&self.between, between, g)].clone();
        self.group.iter().map(level).collect()
    }

    /// All factors, those between subjects first.
    pub(super) fn factors(&self) -> Vec<&Factor> {
        self.between.iter().chain(&self.within).collect()
    }

    /// Cells of the factors between subjects, 1 without any.
    pub(super) fn groups(&self) -> usize {
        cells_of(&self.between)
    }

    /// Cells of the factors within subjects, 1 without any.
    pub(super) fn cells(&self) -> usize {
        cells_of(&self.within)
    }
}

/// The levels of one factor between subjects.
struct Levels {
    factor: Factor,
    of_subject: Vec<Option<usize>>,
}

impl Levels {
    fn new(
        (name, column): &BetweenColumn,
        people: &[String],
        rows: &[usize],
    ) -> Result<Self, StatsError> {
        let index = Index::from_labels(column.iter().flatten());
        let mut of_subject = vec![None; people.len()];
        let mut next = index.rows.iter();
        for (&person, cell) in rows.iter().zip(*column) {
            let Some(level) = cell.as_ref().and_then(|_| next.next()) else {
                continue;
            };
            let known = *of_subject[person].get_or_insert(*level);
            if known != *level {
                return Err(StatsError::TwoGroups {
                    subject: people[person].clone(),
                    factor: (*name).to_owned(),
                    first: index.names[known].clone(),
                    second: index.names[*level].clone(),
                });
            }
        }
        let factor = factor(name, index.names)?;
        Ok(Self { factor, of_subject })
    }
}

/// Refuses a factor between subjects that has one level, or changes within a subject.
pub(crate) fn check_between(subjects: &[String], column: &BetweenColumn) -> Result<(), StatsError> {
    let people = Index::from_labels(subjects);
    Levels::new(column, &people.names, &people.rows).map(|_| ())
}

fn factor(name: &str, levels: Vec<String>) -> Result<Factor, StatsError> {
    StatsError::two_levels(name, &levels)?;
    let name = name.to_owned();
    Ok(Factor { name, levels })
}

/// The place of a cell, the last factor counting fastest.
fn position(counts: &[usize], levels: &[usize]) -> usize {
    counts.iter().zip(levels).fold(0, |place, (count, level)| place * count + level)
}

fn cells_of(factors: &[Factor]) -> usize {
    factors.iter().map(|f| f.levels.len()).product()
}

/// The level of factor `f` in a cell, the last factor counting fastest.
pub(super) fn level_in(factors: &[Factor], f: usize, cell: usize) -> usize {
    cell / cells_of(&factors[f + 1..]) % factors[f].levels.len()
}

/// The levels of a cell, joined by `:`.
fn name_of(factors: &[Factor], cell: usize) -> String {
    let level = |f: usize| factors[f].levels[level_in(factors, f, cell)].as_str();
    let names: Vec<&str> = (0..factors.len()).map(level).collect();
    names.join(":")
}

fn check_shape(
    subjects: &[String],
    within: &[WithinColumn],
    between: &[BetweenColumn],
    values: &[Option<f64>],
) -> Result<(), StatsError> {
    let columns = within.iter().map(|(name, c)| (*name, c.len()));
    let columns = columns.chain(between.iter().map(|(name, c)| (*name, c.len())));
    for (name, found) in columns.chain([("value", values.len())]) {
        StatsError::same_length(name, found, subjects.len())?;
    }
    for (name, found, least) in [
        ("factors within subjects", within.len(), 0),
        ("factors between subjects", between.len(), 0),
        ("factors", (within.len() + between.len()).min(MOST_FACTORS), 1),
    ] {
        if found < least || found > MOST_FACTORS {
            let expected = if found < least {
                format!("at least {least}")
            } else {
                format!("at most {MOST_FACTORS}")
            };
            return Err(StatsError::parameter(name, &expected, found as f64));
        }
    }
    let mut names: Vec<&str> = within.iter().map(|(name, _)| *name).collect();
    names.extend(between.iter().map(|(name, _)| *name));
    StatsError::distinct("factor", &names)
}
