//! The columns of a table by what their names say.

use super::{
    columns::{Sheet, TableColumn},
    words::{What, Whose, Words, words},
};

/// The columns of a table with what their names say.
pub(super) struct Reader<'a> {
    pub(super) table: &'a Sheet,
    pub(super) words: Vec<Words>,
}

impl<'a> Reader<'a> {
    pub(super) fn new(table: &'a Sheet) -> Self {
        let words = table.columns.iter().map(|c| words(&c.name)).collect();
        Self { table, words }
    }

    /// The columns of which the names say whose and what they are.
    pub(super) fn all(
        &self,
        whose: Whose,
        what: What,
    ) -> impl Iterator<Item = &'a TableColumn> + '_ {
        let columns = self.table.columns.iter().zip(&self.words);
        columns.filter(move |(_, w)| w.whose == whose && w.what == Some(what)).map(|(c, _)| c)
    }

    /// The first of them that holds something.
    pub(super) fn first(&self, whose: Whose, what: What) -> Option<&'a TableColumn> {
        self.all(whose, what).find(|c| c.count() > 0)
    }

    /// The first of them that holds numbers.
    pub(super) fn number(&self, whose: Whose, what: What) -> Option<&'a TableColumn> {
        self.all(whose, what).find(|c| c.filled().next().is_some())
    }
}
