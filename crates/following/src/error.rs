//! What a following run, or an evaluation of runs, refuses.

/// Why a run cannot be made, simulated or evaluated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FollowingError {
    /// A row without a reference vehicle: there is nothing to follow.
    #[error(
        "drive `{driver}` has no lead vehicle in {missing} of {rows} rows, first in row {row}; cut it to one stretch of following"
    )]
    NoLead {
        driver: String,
        /// First zero-based row without a lead.
        row: usize,
        /// How many rows lack one.
        missing: usize,
        rows: usize,
    },
    /// A row whose lead vehicle is not that of the row before.
    #[error("drive `{driver}` changes its lead vehicle at row {row}, expected one leader a run")]
    LeaderChanged {
        driver: String,
        /// First zero-based row behind another leader.
        row: usize,
    },
    /// Too few rows to split into two parts of at least two.
    #[error("drive `{driver}` has {found} rows, expected at least {expected}")]
    TooShort { driver: String, found: usize, expected: usize },
    /// Columns that differ in length.
    #[error("drive `{driver}` column `{column}` has {found} rows, expected {expected}")]
    LengthMismatch {
        driver: String,
        /// Name of the field of [`FollowingColumns`](crate::FollowingColumns).
        column: &'static str,
        found: usize,
        /// Rows of `time_s`.
        expected: usize,
    },
    /// A number that a column cannot hold.
    #[error("drive `{driver}` column `{column}` row {row} is {found}, expected {expected}")]
    BadValue {
        driver: String,
        /// Name of the field of [`FollowingColumns`](crate::FollowingColumns).
        column: &'static str,
        row: usize,
        found: f64,
        /// What may stand there, in words.
        expected: &'static str,
    },
    /// A sampling rate that is no rate.
    #[error("drive `{driver}` has a rate of {found} Hz, expected a finite number above 0")]
    BadRate { driver: String, found: f64 },
    /// Rows that are not one sampling step apart, as at a hole in a recording.
    #[error("drive `{driver}` steps {found_s} s to row {row}, expected {expected_s} s")]
    UnevenTime {
        driver: String,
        /// Zero-based row at the end of the step.
        row: usize,
        /// The step found, in s.
        found_s: f64,
        /// One over the rate, in s.
        expected_s: f64,
    },
    /// A part of a drive in which ego never moves: it has no time gap.
    #[error("drive `{driver}` never exceeds {above_mps} m/s in its first two thirds: no time gap")]
    NeverMoves {
        driver: String,
        /// The speed to exceed, in m/s.
        above_mps: f64,
    },
    /// An acceleration law that returned NaN or infinity.
    #[error("the law `{law}` gave an acceleration of {found} at row {row} of drive `{driver}`")]
    LawNotFinite {
        driver: String,
        /// Name of the law that was simulated.
        law: String,
        row: usize,
        /// What it returned, in m/s².
        found: f64,
    },
    /// Fewer drivers than a population needs.
    #[error("{found} drivers, expected at least {expected}: a population is the other drivers")]
    TooFewDrivers { found: usize, expected: usize },
    /// A setting outside its range.
    #[error("`{name}` is {found}, expected {expected}")]
    BadSetting { name: &'static str, found: f64, expected: &'static str },
}

/// Refuses fewer drivers than are needed.
pub(crate) fn enough_drivers(found: usize, expected: usize) -> Result<(), FollowingError> {
    if found < expected {
        return Err(FollowingError::TooFewDrivers { found, expected });
    }
    Ok(())
}
