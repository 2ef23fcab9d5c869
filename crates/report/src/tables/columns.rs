//! A table told column by column: a header, and what stands below it in each row.

use super::{Cell, Column, Table};

/// A table of rows of one kind whose columns are being told.
#[derive(Debug)]
pub struct TableOf<T> {
    rows: Vec<T>,
    table: Table,
}

impl Table {
    /// A table of these rows, a cell a row for every column that is told; names and titles as [`Table`] has them.
    ///
    /// # Example
    /// ```
    /// use maveric_report::tables::{Cell, Table};
    /// let counts = [("seen", 3), ("missed", 1)];
    /// let table = Table::of("counts", "How often", &counts)
    ///     .text("", |(what, _)| *what)
    ///     .right("*n*", |(_, n)| Cell::count(*n))
    ///     .noted("Of four.");
    /// assert_eq!((table.columns.len(), table.rows.len()), (2, 2));
    /// ```
    pub fn of<T>(
        name: impl Into<String>,
        title: impl Into<String>,
        rows: impl IntoIterator<Item = T>,
    ) -> TableOf<T> {
        let rows: Vec<T> = rows.into_iter().collect();
        TableOf {
            table: Self {
                name: name.into(),
                title: title.into(),
                columns: Vec::new(),
                rows: vec![Vec::new(); rows.len()],
                notes: Vec::new(),
                data: None,
            },
            rows,
        }
    }

    /// The table with one more note below it, with marks.
    #[must_use]
    pub fn noted(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }
}

impl<T> TableOf<T> {
    fn column(mut self, head: Column, cell: impl Fn(&T) -> Cell) -> Self {
        self.table.columns.push(head);
        for (cells, row) in self.table.rows.iter_mut().zip(&self.rows) {
            cells.push(cell(row));
        }
        self
    }

    /// A column of words.
    #[must_use]
    pub fn left(self, header: impl Into<String>, cell: impl Fn(&T) -> Cell) -> Self {
        self.column(Column::left(header), cell)
    }

    /// A column of numbers.
    #[must_use]
    pub fn right(self, header: impl Into<String>, cell: impl Fn(&T) -> Cell) -> Self {
        self.column(Column::right(header), cell)
    }

    /// A column of words, taken as they are.
    #[must_use]
    pub fn text<S: Into<String>>(self, header: impl Into<String>, text: impl Fn(&T) -> S) -> Self {
        self.left(header, |row| Cell::text(text(row)))
    }

    /// Further columns, if they are wanted.
    #[must_use]
    pub fn and_if(self, wanted: bool, columns: impl FnOnce(Self) -> Self) -> Self {
        if wanted { columns(self) } else { self }
    }

    /// The table, with a note below it.
    pub fn noted(self, note: impl Into<String>) -> Table {
        self.done().noted(note)
    }

    /// The table.
    pub fn done(self) -> Table {
        self.table
    }
}
