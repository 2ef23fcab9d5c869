//! The two products of the kernel, blocked so that their sums stay in registers.
//!
//! Both load a few vectors of one operand and multiply each by several single numbers of the other, so a block of
//! 6 × 4 vectors (6 × 2 where there are 16 registers) does 24 multiplications for 10 loads. Every sum is taken in
//! the order of its index, so its bits do not depend on the vectors' width.

#![expect(
    clippy::inline_always,
    reason = "code for one processor must be inlined into the function that was compiled for it"
)]

use super::matrix::{View, ViewMut};
use pulp::{Simd, WithSimd};

/// Rows of a block.
const TALL: usize = 6;

/// Calls `$panel` with the widest panels that the registers hold until all vectors are done.
macro_rules! panels {
    ($self:ident, $simd:ident, $S:ident, $vectors:expr) => {
        let vectors = $vectors;
        let many = $S::REGISTER_COUNT >= 32;
        let mut vector = 0;
        while vector < vectors {
            vector += match vectors - vector {
                4.. if many => $self.panel::<$S, 4>($simd, vector),
                3 if many => $self.panel::<$S, 3>($simd, vector),
                2.. => $self.panel::<$S, 2>($simd, vector),
                _ => $self.panel::<$S, 1>($simd, vector),
            };
        }
    };
}

/// What the sums of [`RowsTimes`] begin with.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Start<'a> {
    /// The same for every row, shape `(width,)`.
    Bias(&'a [f32]),
    /// Row `index[r]` of a table for row `r`.
    Table { table: View<'a>, index: &'a [u32] },
    /// What is there.
    Add,
}

/// What happens to the sums of [`RowsTimes`] at the end. A type and not a choice: with a choice in their loop the
/// sums leave the registers.
pub(crate) trait Finish: Copy {
    /// Of the sums in one vector of a row.
    fn apply<S: Simd>(self, simd: S, sums: S::f32s, row: usize, vector: usize) -> S::f32s;
}

/// Nothing happens.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plain;

/// Negative values become zero.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Relu;

/// Back through a ReLU: zero where its output was not above zero.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BackRelu<'a>(pub(crate) View<'a>);

impl Finish for Plain {
    #[inline(always)]
    fn apply<S: Simd>(self, _: S, sums: S::f32s, _: usize, _: usize) -> S::f32s {
        sums
    }
}

impl Finish for Relu {
    #[inline(always)]
    fn apply<S: Simd>(self, simd: S, sums: S::f32s, _: usize, _: usize) -> S::f32s {
        let zero = simd.splat_f32s(0.0);
        simd.select_f32s(simd.greater_than_f32s(sums, zero), sums, zero)
    }
}

impl Finish for BackRelu<'_> {
    #[inline(always)]
    fn apply<S: Simd>(self, simd: S, sums: S::f32s, row: usize, vector: usize) -> S::f32s {
        let zero = simd.splat_f32s(0.0);
        let from = row * self.0.stride + self.0.first;
        let output = S::as_simd_f32s(self.0.data).0[from / S::F32_LANES + vector];
        simd.select_f32s(simd.greater_than_f32s(output, zero), sums, zero)
    }
}

/// `y[r] = finish(start[r] + Σ_k x[r][k] · b[k])`.
///
/// `b` has shape `(depth, width)`; `width`, and strides and first columns of all but `x`, are multiples of
/// [`super::matrix::LANES`].
#[derive(Debug)]
pub(crate) struct RowsTimes<'a, F> {
    pub(crate) rows: usize,
    pub(crate) x: View<'a>,
    pub(crate) depth: usize,
    pub(crate) b: &'a [f32],
    pub(crate) width: usize,
    pub(crate) start: Start<'a>,
    pub(crate) finish: F,
    pub(crate) y: ViewMut<'a>,
}

impl<F: Finish> WithSimd for RowsTimes<'_, F> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        panels!(self, simd, S, self.width / S::F32_LANES);
    }
}

impl<F: Finish> RowsTimes<'_, F> {
    #[inline(always)]
    fn panel<S: Simd, const N: usize>(&mut self, simd: S, vector: usize) -> usize {
        let mut row = 0;
        while row + TALL <= self.rows {
            self.block::<S, TALL, N>(simd, row, vector);
            row += TALL;
        }
        while row + 2 <= self.rows {
            self.block::<S, 2, N>(simd, row, vector);
            row += 2;
        }
        if row < self.rows {
            self.block::<S, 1, N>(simd, row, vector);
        }
        N
    }

    /// Where the sums of a row begin.
    #[inline(always)]
    fn first(&self, row: usize) -> (&[f32], usize) {
        match self.start {
            Start::Bias(bias) => (bias, 0),
            Start::Table { table, index } => {
                let line = index[row] as usize;
                (table.data, line * table.stride + table.first)
            }
            Start::Add => (self.y.data, row * self.y.stride + self.y.first),
        }
    }

    #[inline(always)]
    #[expect(
        clippy::needless_range_loop,
        reason = "counted loops over constants are unrolled, and the sums then live in registers"
    )]
    fn block<S: Simd, const M: usize, const N: usize>(
        &mut self,
        simd: S,
        row: usize,
        vector: usize,
    ) {
        let vectors = self.width / S::F32_LANES;
        // Loops, and no closures: a closure that is not inlined is compiled without the vectors.
        let zero = simd.splat_f32s(0.0);
        let mut sums = [[zero; N]; M];
        for m in 0..M {
            let (data, from) = self.first(row + m);
            let line = &S::as_simd_f32s(data).0[from / S::F32_LANES + vector..][..N];
            sums[m].copy_from_slice(line);
        }
        let x = self.x;
        let mut lines: [&[f32]; M] = [&[]; M];
        for (m, line) in lines.iter_mut().enumerate() {
            *line = &x.data[(row + m) * x.stride + x.first..][..self.depth];
        }
        let b = S::as_simd_f32s(self.b).0;
        for (k, line) in b.chunks_exact(vectors).take(self.depth).enumerate() {
            let mut b = [zero; N];
            b.copy_from_slice(&line[vector..][..N]);
            for m in 0..M {
                let one = simd.splat_f32s(lines[m][k]);
                for n in 0..N {
                    sums[m][n] = simd.mul_add_e_f32s(one, b[n], sums[m][n]);
                }
            }
        }
        let y = S::as_mut_simd_f32s(self.y.data).0;
        for (m, sum) in sums.iter().enumerate() {
            let to = ((row + m) * self.y.stride + self.y.first) / S::F32_LANES + vector;
            for (n, (y, &sum)) in y[to..][..N].iter_mut().zip(sum).enumerate() {
                *y = self.finish.apply(simd, sum, row + m, vector + n);
            }
        }
    }
}

/// `to[k] += Σ_r x[r][k] · dy[r]`: a gradient by weights, or with `x` of ones by biases.
///
/// `to` has shape `(inputs, width)`; what must be a multiple of [`super::matrix::LANES`] is as in [`RowsTimes`].
#[derive(Debug)]
pub(crate) struct OuterSums<'a> {
    pub(crate) rows: usize,
    pub(crate) x: View<'a>,
    pub(crate) inputs: usize,
    pub(crate) dy: View<'a>,
    pub(crate) width: usize,
    pub(crate) to: &'a mut [f32],
}

impl WithSimd for OuterSums<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        panels!(self, simd, S, self.width / S::F32_LANES);
    }
}

impl OuterSums<'_> {
    #[inline(always)]
    fn panel<S: Simd, const N: usize>(&mut self, simd: S, vector: usize) -> usize {
        let mut input = 0;
        while input + TALL <= self.inputs {
            self.block::<S, TALL, N>(simd, input, vector);
            input += TALL;
        }
        while input + 2 <= self.inputs {
            self.block::<S, 2, N>(simd, input, vector);
            input += 2;
        }
        if input < self.inputs {
            self.block::<S, 1, N>(simd, input, vector);
        }
        N
    }

    #[inline(always)]
    #[expect(
        clippy::needless_range_loop,
        reason = "counted loops over constants are unrolled, and the sums then live in registers"
    )]
    fn block<S: Simd, const M: usize, const N: usize>(
        &mut self,
        simd: S,
        input: usize,
        vector: usize,
    ) {
        let zero = simd.splat_f32s(0.0);
        let mut sums = [[zero; N]; M];
        for m in 0..M {
            let first = (input + m) * self.width / S::F32_LANES + vector;
            sums[m].copy_from_slice(&S::as_simd_f32s(self.to).0[first..][..N]);
        }
        let (x, dy) = (self.x, self.dy);
        let dy_vectors = S::as_simd_f32s(dy.data).0;
        for row in 0..self.rows {
            let ones = &x.data[row * x.stride + x.first + input..][..M];
            let from = (row * dy.stride + dy.first) / S::F32_LANES + vector;
            let mut line = [zero; N];
            line.copy_from_slice(&dy_vectors[from..][..N]);
            for m in 0..M {
                let one = simd.splat_f32s(ones[m]);
                for n in 0..N {
                    sums[m][n] = simd.mul_add_e_f32s(one, line[n], sums[m][n]);
                }
            }
        }
        let to = S::as_mut_simd_f32s(self.to).0;
        for (m, sum) in sums.iter().enumerate() {
            let first = (input + m) * self.width / S::F32_LANES + vector;
            for (to, &sum) in to[first..][..N].iter_mut().zip(sum) {
                *to = sum;
            }
        }
    }
}

/// `to[index[r]] += from[r]` over `width` columns, row after row.
#[derive(Debug)]
pub(crate) struct ScatterRows<'a> {
    pub(crate) from: View<'a>,
    pub(crate) index: &'a [u32],
    pub(crate) width: usize,
    pub(crate) to: ViewMut<'a>,
}

impl WithSimd for ScatterRows<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let from = self.from;
        for (row, &index) in self.index.iter().enumerate() {
            let from = &from.data[row * from.stride + from.first..][..self.width];
            let start = index as usize * self.to.stride + self.to.first;
            let to = S::as_mut_simd_f32s(&mut self.to.data[start..][..self.width]).0;
            for (to, &from) in to.iter_mut().zip(S::as_simd_f32s(from).0) {
                *to = simd.add_f32s(*to, from);
            }
        }
    }
}

/// Adds number by number.
#[derive(Debug)]
pub(crate) struct AddTo<'a> {
    pub(crate) to: &'a mut [f32],
    pub(crate) from: &'a [f32],
}

impl WithSimd for AddTo<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let to = S::as_mut_simd_f32s(self.to).0;
        for (to, &from) in to.iter_mut().zip(S::as_simd_f32s(self.from).0) {
            *to = simd.add_f32s(*to, from);
        }
    }
}
