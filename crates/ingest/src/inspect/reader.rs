//! The columns of a table by what their names say, and its rows by vehicles.

use super::{
    columns::{Sheet, TableColumn},
    words::{What, Whose, Words, words},
};
use std::collections::BTreeMap;

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
        columns
            .filter(move |(_, w)| w.whose == whose && w.what == Some(what))
            .map(|(c, _)| c)
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

/// Which vehicle each row is of.
pub(super) fn series(table: &Sheet, id: Option<&TableColumn>, groups: &[&TableColumn]) -> Vec<u32> {
    let mut numbers: BTreeMap<String, u32> = BTreeMap::new();
    let cell = |column: &TableColumn, row: usize| match &column.numbers {
        Some(numbers) => numbers[row].to_string(),
        None => column.words[row].clone().unwrap_or_default(),
    };
    let mut series = Vec::with_capacity(table.rows);
    for row in 0..table.rows {
        let parts = id.into_iter().chain(groups.iter().copied());
        let key: Vec<String> = parts.map(|c| cell(c, row)).collect();
        let next = numbers.len() as u32;
        series.push(*numbers.entry(key.join("\u{1}")).or_insert(next));
    }
    series
}

/// Rows of one vehicle after another row of the same: pairs of rows.
pub(super) fn steps(series: &[u32]) -> impl Iterator<Item = (usize, usize)> + '_ {
    let mut last: BTreeMap<u32, usize> = BTreeMap::new();
    series.iter().enumerate().filter_map(move |(row, vehicle)| {
        let before = last.insert(*vehicle, row)?;
        Some((before, row))
    })
}
