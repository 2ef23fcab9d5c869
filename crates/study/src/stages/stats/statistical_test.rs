//! What a test is: columns, and what it makes of them.

use super::{input::Long, ran::Ran, roles::Roles};
use crate::{error::StudyError, tables::Table};

/// A test: its fields are the columns that it reads and how it does so, with their help and defaults.
pub trait Test: clap::Args + Clone {
    /// Its name on the command line.
    const NAME: &'static str;
    /// Whether it draws: conditions, groups, contrasts, or two columns.
    const HAS_FIGURE: bool = true;
    /// Whether it says what it found in a sentence.
    const HAS_SENTENCE: bool = true;

    /// Options without which it cannot run, if one is lacking.
    fn lacks(&self) -> Option<&'static str> {
        None
    }

    /// The columns that a wide table becomes; none if the test compares no conditions.
    fn long(&self) -> Option<Long<'_>> {
        None
    }

    /// The columns that it reads, each with its role.
    fn roles(&self) -> Roles {
        self.long().map(Roles::of_long).unwrap_or_default()
    }

    /// The column of values, if there is one; several are tested one by one.
    fn value(&mut self) -> Option<&mut String> {
        None
    }

    /// Whether this call of it has something to draw.
    fn has_figure(&self) -> bool {
        Self::HAS_FIGURE
    }

    /// The result: its numbers, sentences, tables and figure.
    ///
    /// # Errors
    /// [`StudyError`] naming the column that is not there or is not as it should be, or what the test refuses.
    fn run(&self, table: &Table) -> Result<Ran, StudyError>;
}

/// What a test compares, and its values, where its columns are in a field `columns`.
macro_rules! by_its_columns {
    () => {
        fn long(&self) -> Option<$crate::stages::stats::input::Long<'_>> {
            self.columns.long().into()
        }

        fn value(&mut self) -> Option<&mut String> {
            Some(&mut self.columns.value)
        }
    };
}
pub(super) use by_its_columns;
