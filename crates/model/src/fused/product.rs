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
        let mut at = 0;
        while at < vectors {
            at += match vectors - at {
                4.. if many => $self.panel::<$S, 4>($simd, at),
                3 if many => $self.panel::<$S, 3>($simd, at),
                2.. => $self.panel::<$S, 2>($simd, at),
                _ => $self.panel::<$S, 1>($simd, at),
            };
        }
    };
}

/// What the sums of [`RowsTimes`] begin with.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Start<'a> {
    Zero,
    /// The same for every row, shape `(width,)`.
    Bias(&'a [f32]),
    /// Row `index[r]` of a table for row `r`.
    Table {
        table: View<'a>,
        index: &'a [u32],
    },
    /// What is there.
    Add,
}

/// What happens to the sums of [`RowsTimes`] at the end.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Finish<'a> {
    Plain,
    /// Negative values become zero.
    Relu,
    /// Back through a ReLU: zero where its output was not above zero.
    BackRelu(View<'a>),
}

/// `y[r] = finish(start[r] + Σ_k x[r][k] · b[k])`.
///
/// `b` has shape `(depth, width)`; `width`, and strides and first columns of all but `x`, are multiples of
/// [`super::matrix::LANES`].
#[derive(Debug)]
pub(crate) struct RowsTimes<'a> {
    pub(crate) rows: usize,
    pub(crate) x: View<'a>,
    pub(crate) depth: usize,
    pub(crate) b: &'a [f32],
    pub(crate) width: usize,
    pub(crate) start: Start<'a>,
    pub(crate) finish: Finish<'a>,
    pub(crate) y: ViewMut<'a>,
}

impl WithSimd for RowsTimes<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        panels!(self, simd, S, self.width / S::F32_LANES);
    }
}

impl RowsTimes<'_> {
    #[inline(always)]
    fn panel<S: Simd, const N: usize>(&mut self, simd: S, at: usize) -> usize {
        let mut row = 0;
        while row + TALL <= self.rows {
            self.block::<S, TALL, N>(simd, row, at);
            row += TALL;
        }
        while row + 2 <= self.rows {
            self.block::<S, 2, N>(simd, row, at);
            row += 2;
        }
        if row < self.rows {
            self.block::<S, 1, N>(simd, row, at);
        }
        N
    }

    #[inline(always)]
    fn block<S: Simd, const M: usize, const N: usize>(&mut self, simd: S, row: usize, at: usize) {
        let vectors = self.width / S::F32_LANES;
        let zero = simd.splat_f32s(0.0);
        let mut sums = match self.start {
            Start::Zero => [[zero; N]; M],
            Start::Bias(bias) => [load::<S, N>(bias, 0, at); M],
            Start::Table { table, index } => std::array::from_fn(|m| {
                let from = index[row + m] as usize * table.stride + table.first;
                load::<S, N>(table.data, from, at)
            }),
            Start::Add => {
                let y = &self.y;
                std::array::from_fn(|m| load::<S, N>(y.data, (row + m) * y.stride + y.first, at))
            }
        };
        let x = self.x;
        let lines: [&[f32]; M] =
            std::array::from_fn(|m| &x.data[(row + m) * x.stride + x.first..][..self.depth]);
        let b = S::as_simd_f32s(self.b).0;
        for (k, line) in b.chunks_exact(vectors).take(self.depth).enumerate() {
            let line: [S::f32s; N] = std::array::from_fn(|n| line[at + n]);
            for m in 0..M {
                let one = simd.splat_f32s(lines[m][k]);
                for n in 0..N {
                    sums[m][n] = simd.mul_add_e_f32s(one, line[n], sums[m][n]);
                }
            }
        }
        for (m, sum) in sums.iter_mut().enumerate() {
            match self.finish {
                Finish::Plain => {}
                Finish::Relu => {
                    for value in sum.iter_mut() {
                        let above = simd.greater_than_f32s(*value, zero);
                        *value = simd.select_f32s(above, *value, zero);
                    }
                }
                Finish::BackRelu(of) => {
                    let of = load::<S, N>(of.data, (row + m) * of.stride + of.first, at);
                    for (value, of) in sum.iter_mut().zip(of) {
                        *value = simd.select_f32s(simd.greater_than_f32s(of, zero), *value, zero);
                    }
                }
            }
            let to = ((row + m) * self.y.stride + self.y.first) / S::F32_LANES + at;
            let y = &mut S::as_mut_simd_f32s(self.y.data).0[to..][..N];
            for (y, &value) in y.iter_mut().zip(sum.iter()) {
                *y = value;
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
    fn panel<S: Simd, const N: usize>(&mut self, simd: S, at: usize) -> usize {
        let mut input = 0;
        while input + TALL <= self.inputs {
            self.block::<S, TALL, N>(simd, input, at);
            input += TALL;
        }
        while input + 2 <= self.inputs {
            self.block::<S, 2, N>(simd, input, at);
            input += 2;
        }
        if input < self.inputs {
            self.block::<S, 1, N>(simd, input, at);
        }
        N
    }

    #[inline(always)]
    fn block<S: Simd, const M: usize, const N: usize>(&mut self, simd: S, input: usize, at: usize) {
        let mut sums: [[S::f32s; N]; M] =
            std::array::from_fn(|m| load::<S, N>(self.to, (input + m) * self.width, at));
        let (x, dy) = (self.x, self.dy);
        let dy_vectors = S::as_simd_f32s(dy.data).0;
        for row in 0..self.rows {
            let ones = &x.data[row * x.stride + x.first + input..][..M];
            let line = &dy_vectors[(row * dy.stride + dy.first) / S::F32_LANES + at..][..N];
            let line: [S::f32s; N] = std::array::from_fn(|n| line[n]);
            for m in 0..M {
                let one = simd.splat_f32s(ones[m]);
                for n in 0..N {
                    sums[m][n] = simd.mul_add_e_f32s(one, line[n], sums[m][n]);
                }
            }
        }
        let to = S::as_mut_simd_f32s(self.to).0;
        for (m, sum) in sums.iter().enumerate() {
            let first = (input + m) * self.width / S::F32_LANES + at;
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
            let at = index as usize * self.to.stride + self.to.first;
            let to = S::as_mut_simd_f32s(&mut self.to.data[at..][..self.width]).0;
            for (to, &from) in to.iter_mut().zip(S::as_simd_f32s(from).0) {
                *to = simd.add_f32s(*to, from);
            }
        }
    }
}

/// `N` vectors from number `from` plus vector `at` on.
#[inline(always)]
fn load<S: Simd, const N: usize>(data: &[f32], from: usize, at: usize) -> [S::f32s; N] {
    let vectors = &S::as_simd_f32s(data).0[from / S::F32_LANES + at..][..N];
    std::array::from_fn(|n| vectors[n])
}
