//! What can be wrong with data handed to this crate.

/// Why an analysis was refused as a whole.
///
/// A single number that does not exist is no error: it is `None`, with its reason in
/// [`Reasons`](crate::Reasons).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StatsError {
    /// Columns of one table differ in length.
    #[error("column `{name}` has {found} rows, expected {expected}")]
    LengthMismatch {
        /// The column.
        name: String,
        /// Its rows.
        found: usize,
        /// The rows of the first column.
        expected: usize,
    },
    /// A value is NaN or infinite.
    #[error("value {value} in `{name}`, row {}, is not a finite number", .row + 1)]
    NotFinite {
        /// The column, or the condition.
        name: String,
        /// Row, counted from 0; the message counts from 1.
        row: usize,
        /// What was found.
        value: f64,
    },
    /// A value whose square is not a number of double precision.
    #[error(
        "value {value} in `{name}`, row {}, is too large to square, expected at most 1e75", .row + 1
    )]
    TooLarge {
        /// The column, or the condition.
        name: String,
        /// Row, counted from 0; the message counts from 1.
        row: usize,
        /// What was found.
        value: f64,
    },
    /// Fewer subjects than the test needs.
    #[error(
        "{found} complete {unit}{} after leaving out {dropped} with missing values, expected at least {expected}",
        if *found == 1 { "" } else { "s" }
    )]
    TooFew {
        /// What is counted: subject, pair, respondent, value, group.
        unit: String,
        /// How many are complete.
        found: usize,
        /// How many were left out because of missing values.
        dropped: usize,
        /// How many are needed.
        expected: usize,
    },
    /// Fewer than two conditions.
    #[error("{found} condition{}, expected at least 2", if *found == 1 { "" } else { "s" })]
    TooFewConditions {
        /// How many were found.
        found: usize,
    },
    /// The same subject has two values in one condition.
    #[error("subject `{subject}` has two values in condition `{condition}`, expected one")]
    DoubleCell {
        /// As it is named in the column of subjects.
        subject: String,
        /// Name of the condition, or its levels joined by `:` where there are several factors.
        condition: String,
    },
    /// Two conditions, subjects or items carry the same name.
    #[error("the name `{name}` occurs twice among the {what}s, expected distinct names")]
    DoubleName {
        /// condition, subject, item, factor or predictor.
        what: String,
        /// The one that comes twice.
        name: String,
    },
    /// Levels whose joined names coincide, so that one of two results would be lost.
    #[error("two {what}s would have the name `{name}`, expected levels whose joined names differ")]
    JoinedName {
        /// cell or pair.
        what: String,
        /// The name that both would have.
        name: String,
    },
    /// A factor whose every row has the same level.
    #[error("factor `{factor}` has one level, `{level}`, expected at least 2")]
    OneLevel {
        /// Name of its column.
        factor: String,
        /// Its only level.
        level: String,
    },
    /// A factor, or a level of one, that the design lacks.
    #[error("`{name}` is unknown, expected {what}: {}", known.join(", "))]
    UnknownLevel {
        /// What it would have to be.
        what: String,
        /// What was asked for.
        name: String,
        /// What there is.
        known: Vec<String>,
    },
    /// A cell of the design, or a group, without a complete subject.
    #[error("cell `{cell}` has no subject with all values, expected at least 1")]
    EmptyCell {
        /// Its levels, joined by `:`.
        cell: String,
    },
    /// A subject under two levels of a factor between subjects.
    #[error(
        "subject `{subject}` is in `{first}` and in `{second}` of `{factor}`, expected one of them"
    )]
    TwoGroups {
        /// As it is named in the column of subjects.
        subject: String,
        /// The factor between subjects.
        factor: String,
        /// The level of its first row.
        first: String,
        /// The other.
        second: String,
    },
    /// A factor within subjects whose level no subject changes.
    #[error(
        "no subject has two levels of `{factor}`, expected a factor within subjects to change within them"
    )]
    NeverChanges {
        /// The factor.
        factor: String,
    },
    /// A predictor that the others determine.
    #[error(
        "`{name}` is determined by the other predictors, expected columns that are not sums of each other"
    )]
    Collinear {
        /// The first column that adds nothing to those before it.
        name: String,
    },
    /// An ordered answer that is no whole number.
    #[error("value {value} in row {} is not a whole number, as ordered answers are", .row + 1)]
    NotWhole {
        /// Row, counted from 0; the message counts from 1.
        row: usize,
        /// What was found.
        value: f64,
    },
    /// A model without a best fit.
    #[error("the model cannot be fitted: {reason}")]
    NoFit {
        /// Why.
        reason: String,
    },
    /// A formula that cannot be read.
    #[error("cannot read `{text}` in the formula, expected {expected}")]
    Formula {
        /// The part.
        text: String,
        /// What is understood.
        expected: String,
    },
    /// A parameter outside its range.
    #[error("`{name}` must be {expected}, got {found}")]
    BadParameter {
        /// The parameter.
        name: String,
        /// The accepted range in words.
        expected: String,
        /// What was given.
        found: f64,
    },
    /// A printed number that cannot be read.
    #[error("row {}: cannot read {what} from `{text}`, expected {expected}", .row + 1)]
    Unreadable {
        /// Row, counted from 0; the message counts from 1.
        row: usize,
        /// Which number.
        what: String,
        /// The text as given.
        text: String,
        /// An example of what is understood.
        expected: String,
    },
    /// The statistic needs another kind of data.
    #[error("statistic {statistic} cannot be computed from {data}")]
    WrongData {
        /// Name of the [`Statistic`](crate::Statistic) that was asked for.
        statistic: String,
        /// The data given.
        data: String,
    },
}

impl StatsError {
    /// Refuses a column that is not as long as the first.
    pub(crate) fn same_length(name: &str, found: usize, expected: usize) -> Result<(), Self> {
        if found == expected {
            return Ok(());
        }
        Err(Self::LengthMismatch { name: name.to_owned(), found, expected })
    }

    /// Refuses fewer than two conditions.
    pub(crate) fn two_conditions(found: usize) -> Result<(), Self> {
        let enough = (found >= 2).then_some(());
        enough.ok_or(Self::TooFewConditions { found })
    }

    /// Refuses a name that comes twice.
    pub(crate) fn distinct(what: &str, names: &[&str]) -> Result<(), Self> {
        let twice = (1..names.len()).find(|&i| names[..i].contains(&names[i]));
        twice.map_or(Ok(()), |i| Err(Self::double_name(what, names[i])))
    }

    /// Refuses a level of significance, or a confidence, that is not between 0 and 1.
    pub(crate) fn between_0_and_1(name: &str, found: f64) -> Result<(), Self> {
        let fine = (found > 0.0 && found < 1.0).then_some(());
        fine.ok_or_else(|| Self::parameter(name, "between 0 and 1", found))
    }

    /// A name that comes twice.
    pub(crate) fn double_name(what: &str, name: &str) -> Self {
        Self::DoubleName { what: what.to_owned(), name: name.to_owned() }
    }

    /// Refuses a factor with fewer than two levels.
    pub(crate) fn two_levels(factor: &str, levels: &[String]) -> Result<(), Self> {
        if levels.len() >= 2 {
            return Ok(());
        }
        Err(Self::OneLevel {
            factor: factor.to_owned(),
            level: levels.first().cloned().unwrap_or_default(),
        })
    }

    /// A model without a best fit.
    pub(crate) fn no_fit(reason: impl Into<String>) -> Self {
        Self::NoFit { reason: reason.into() }
    }

    /// A part of a formula that cannot be read.
    pub(crate) fn formula(text: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::Formula { text: text.into(), expected: expected.into() }
    }

    /// A parameter outside its range.
    pub(crate) fn parameter(name: &str, expected: &str, found: f64) -> Self {
        Self::BadParameter { name: name.to_owned(), expected: expected.to_owned(), found }
    }

    /// The next step, where one is known.
    pub fn suggestion(&self) -> Option<&'static str> {
        match self {
            Self::DoubleCell { .. } => {
                Some("average repeated trials first, so that there is one value a cell")
            }
            Self::TooFew { dropped, .. } if *dropped > 0 => Some(
                "a subject with a missing cell is left out: fill in or drop the condition that misses",
            ),
            Self::TwoGroups { .. } => Some(
                "a factor that changes within a subject is a within factor; or two people share a name",
            ),
            Self::NeverChanges { .. } => Some(
                "name it by --between (`stats compare`, `factorial`, `mixed`, `groups`); or one person has several ids",
            ),
            Self::EmptyCell { .. } => {
                Some("leave out its level, or a factor, or subjects' missing values")
            }
            Self::JoinedName { .. } => {
                Some("rename a level: `:` joins the levels of a cell, `|` the names of a pair")
            }
            Self::Collinear { .. } => {
                Some("leave it out: it has one value, or follows from the others")
            }
            Self::DoubleName { what, .. } if what == "subject" => Some(
                "a row a subject is expected: name the factor that changes within subjects, or average each subject's rows first",
            ),
            Self::NotFinite { .. } => Some("leave the cell empty if the value is missing"),
            _ => None,
        }
    }
}
