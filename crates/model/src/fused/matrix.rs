//! Rows of numbers as the vectors want them: from a cache line's start, a whole number of vectors wide.

use std::ops::{Deref, DerefMut};

/// Widths are multiples of this, the lanes of the widest vectors.
pub(crate) const LANES: usize = 16;

/// The least multiple of [`LANES`] that holds `columns`.
pub(crate) const fn padded(columns: usize) -> usize {
    columns.next_multiple_of(LANES)
}

/// Numbers that begin at a cache line's start, zero at first.
#[derive(Debug)]
pub(crate) struct Aligned {
    data: Vec<f32>,
    start: usize,
    length: usize,
}

impl Aligned {
    pub(crate) fn zeros(length: usize) -> Self {
        let data = vec![0.0; length + LANES];
        let start = data.as_ptr().align_offset(LANES * size_of::<f32>());
        Self { start: start.min(LANES), data, length }
    }
}

impl Deref for Aligned {
    type Target = [f32];
    fn deref(&self) -> &[f32] {
        &self.data[self.start..self.start + self.length]
    }
}

impl DerefMut for Aligned {
    fn deref_mut(&mut self) -> &mut [f32] {
        &mut self.data[self.start..self.start + self.length]
    }
}

/// Rows of one width, one after the other.
#[derive(Debug)]
pub(crate) struct Matrix {
    data: Aligned,
    pub(crate) width: usize,
}

impl Matrix {
    /// Zeros; `columns` is rounded up by [`padded`].
    pub(crate) fn zeros(rows: usize, columns: usize) -> Self {
        let width = padded(columns);
        Self { data: Aligned::zeros(rows * width), width }
    }

    pub(crate) fn all(&self) -> &[f32] {
        &self.data
    }

    pub(crate) fn all_mut(&mut self) -> &mut [f32] {
        &mut self.data
    }

    pub(crate) fn row(&self, index: usize) -> &[f32] {
        &self.data[index * self.width..(index + 1) * self.width]
    }

    pub(crate) fn row_mut(&mut self, index: usize) -> &mut [f32] {
        let width = self.width;
        &mut self.data[index * width..(index + 1) * width]
    }

    /// The columns from `first` on.
    pub(crate) fn columns(&self, first: usize) -> View<'_> {
        View { data: &self.data, stride: self.width, first }
    }

    /// The columns from `first` on, to write to.
    pub(crate) fn columns_mut(&mut self, first: usize) -> ViewMut<'_> {
        ViewMut { stride: self.width, first, data: &mut self.data }
    }
}

/// Some columns of consecutive rows; row `r` begins at `r · stride + first`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View<'a> {
    pub(crate) data: &'a [f32],
    pub(crate) stride: usize,
    pub(crate) first: usize,
}

impl View<'static> {
    /// A column of ones, of as many rows as are asked for.
    pub(crate) const ONES: Self = View { data: &[1.0], stride: 0, first: 0 };
}

/// A [`View`] to write to.
#[derive(Debug)]
pub(crate) struct ViewMut<'a> {
    pub(crate) data: &'a mut [f32],
    pub(crate) stride: usize,
    pub(crate) first: usize,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_start_on_cache_lines_and_are_whole_vectors_wide() {
        let matrix = Matrix::zeros(3, 37);
        assert_eq!(matrix.width, 48);
        assert_eq!(matrix.all().as_ptr().align_offset(64), 0);
        assert_eq!(matrix.row(1).as_ptr().align_offset(64), 0);
    }
}
