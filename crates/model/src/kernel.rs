//! Dense layers over tiles of rows, forward and backward, for the processor that is there.
//!
//! A [`Tile`] is a matrix with one line a feature and [`ROWS`] columns, one a row of data. Every loop runs
//! along the rows, so no layer size leaves a remainder, and `pulp` picks AVX-512, AVX2 or plain code at run
//! time. A forward sum is taken in the order of the inputs on every path; a weight's gradient is a sum over
//! rows whose order depends on the vector width, so paths agree to rounding, and one machine with itself exactly.

#![expect(
    clippy::inline_always,
    reason = "code for one processor must be inlined into the function that was compiled for it"
)]

use pulp::{Arch, Simd, WithSimd};
use std::ops::{Add, Mul, Neg, Range, Sub};

/// Rows of data in a tile: a multiple of every vector width, small enough for the near caches.
pub(crate) const ROWS: usize = 128;

/// Outputs whose sums are kept in registers together.
const BLOCK: usize = 4;

/// The two number types the networks can run in: `f32` to train, `f64` to check gradients.
pub(crate) trait Real:
    Copy
    + Default
    + PartialOrd
    + Send
    + Sync
    + std::fmt::Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// The widest vector of such numbers.
    type Vector<S: Simd>: Copy;
    fn from_f64(value: f64) -> Self;
    fn f64(self) -> f64;
    fn vectors<S: Simd>(slice: &[Self]) -> &[Self::Vector<S>];
    fn vectors_mut<S: Simd>(slice: &mut [Self]) -> &mut [Self::Vector<S>];
    fn splat<S: Simd>(simd: S, value: Self) -> Self::Vector<S>;
    fn mul_add<S: Simd>(
        simd: S,
        a: Self::Vector<S>,
        b: Self::Vector<S>,
        c: Self::Vector<S>,
    ) -> Self::Vector<S>;
    fn sum<S: Simd>(simd: S, a: Self::Vector<S>) -> Self;
}

macro_rules! real {
    ($t:ty, $vector:ident, $as:ident, $as_mut:ident, $splat:ident, $mul_add:ident, $sum:ident) => {
        impl Real for $t {
            type Vector<S: Simd> = S::$vector;
            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as Self
            }
            #[inline(always)]
            fn f64(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn vectors<S: Simd>(slice: &[Self]) -> &[Self::Vector<S>] {
                S::$as(slice).0
            }
            #[inline(always)]
            fn vectors_mut<S: Simd>(slice: &mut [Self]) -> &mut [Self::Vector<S>] {
                S::$as_mut(slice).0
            }
            #[inline(always)]
            fn splat<S: Simd>(simd: S, value: Self) -> Self::Vector<S> {
                simd.$splat(value)
            }
            #[inline(always)]
            fn mul_add<S: Simd>(
                simd: S,
                a: Self::Vector<S>,
                b: Self::Vector<S>,
                c: Self::Vector<S>,
            ) -> Self::Vector<S> {
                simd.$mul_add(a, b, c)
            }
            #[inline(always)]
            fn sum<S: Simd>(simd: S, a: Self::Vector<S>) -> Self {
                simd.$sum(a)
            }
        }
    };
}

// `mul_add_e`: fused where the processor can, a product and a sum where a fused one would be a library call.
real!(
    f32,
    f32s,
    as_simd_f32s,
    as_mut_simd_f32s,
    splat_f32s,
    mul_add_e_f32s,
    reduce_sum_f32s
);
real!(
    f64,
    f64s,
    as_simd_f64s,
    as_mut_simd_f64s,
    splat_f64s,
    mul_add_e_f64s,
    reduce_sum_f64s
);

/// A matrix of shape `(features, ROWS)`, stored feature by feature from a cache line's start.
#[derive(Debug)]
pub(crate) struct Tile<T> {
    data: Vec<T>,
    start: usize,
    features: usize,
}

impl<T: Real> Tile<T> {
    pub(crate) fn zeros(features: usize) -> Self {
        const LINE_BYTES: usize = 64;
        let spare = LINE_BYTES / size_of::<T>();
        let data = vec![T::default(); features * ROWS + spare];
        let start = data.as_ptr().align_offset(LINE_BYTES).min(spare);
        Self {
            data,
            start,
            features,
        }
    }

    pub(crate) fn features(&self) -> usize {
        self.features
    }

    pub(crate) fn all(&self) -> &[T] {
        &self.data[self.start..self.start + self.features * ROWS]
    }

    pub(crate) fn all_mut(&mut self) -> &mut [T] {
        &mut self.data[self.start..self.start + self.features * ROWS]
    }

    /// Values of one feature, shape `(ROWS,)`.
    pub(crate) fn feature(&self, index: usize) -> &[T] {
        &self.all()[index * ROWS..(index + 1) * ROWS]
    }

    pub(crate) fn feature_mut(&mut self, index: usize) -> &mut [T] {
        &mut self.all_mut()[index * ROWS..(index + 1) * ROWS]
    }

    /// Values of consecutive features, one feature after the other.
    pub(crate) fn range(&self, features: Range<usize>) -> &[T] {
        &self.all()[features.start * ROWS..features.end * ROWS]
    }

    pub(crate) fn range_mut(&mut self, features: Range<usize>) -> &mut [T] {
        &mut self.all_mut()[features.start * ROWS..features.end * ROWS]
    }
}

/// Adds `from` to `to`, element by element.
pub(crate) fn add_assign<T: Real>(to: &mut [T], from: &[T]) {
    for (to, &from) in to.iter_mut().zip(from) {
        *to = *to + from;
    }
}

/// `y = W x + b`.
///
/// `weights` has shape `(outputs, inputs)`, `biases` `(outputs,)`, `x` `(inputs, ROWS)`, `y` `(outputs, ROWS)`.
pub(crate) fn affine<T: Real>(weights: &[T], biases: &[T], x: &[T], y: &mut [T]) {
    Arch::new().dispatch(Affine {
        weights,
        biases,
        x,
        y,
    });
}

/// Sets negative values to zero. Written without a branch, so that it is vectorised.
pub(crate) fn relu<T: Real>(values: &mut [T]) {
    let zero = T::default();
    Arch::new().dispatch(|| {
        for value in values.iter_mut() {
            *value = if *value > zero { *value } else { zero };
        }
    });
}

/// Takes a gradient back through [`relu`]: zero where the `value` after it is zero.
pub(crate) fn back_relu<T: Real>(gradient: &mut [T], values: &[T]) {
    let zero = T::default();
    Arch::new().dispatch(|| {
        for (d, &value) in gradient.iter_mut().zip(values) {
            *d = if value > zero { *d } else { zero };
        }
    });
}

/// `dx = Wᵀ dy`; shapes as in [`affine`].
pub(crate) fn back_input<T: Real>(weights: &[T], dy: &[T], dx: &mut [T]) {
    Arch::new().dispatch(BackInput { weights, dy, dx });
}

/// `dW += dy xᵀ` and `db +=` the sum of `dy` over the rows; shapes as in [`affine`].
pub(crate) fn back_weights<T: Real>(dy: &[T], x: &[T], dw: &mut [T], db: &mut [T]) {
    Arch::new().dispatch(BackWeights { dy, x, dw, db });
}

struct Affine<'a, T> {
    weights: &'a [T],
    biases: &'a [T],
    x: &'a [T],
    y: &'a mut [T],
}

impl<T: Real> WithSimd for Affine<'_, T> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let inputs = self.x.len() / ROWS;
        let x = T::vectors::<S>(self.x);
        let blocks = self
            .y
            .chunks_mut(BLOCK * ROWS)
            .zip(self.weights.chunks(BLOCK * inputs));
        for ((y, weights), biases) in blocks.zip(self.biases.chunks(BLOCK)) {
            let y = T::vectors_mut::<S>(y);
            if biases.len() == BLOCK {
                let lines = std::array::from_fn(|m| &weights[m * inputs..(m + 1) * inputs]);
                affine_block::<S, T, BLOCK>(simd, lines, std::array::from_fn(|m| biases[m]), x, y);
            } else {
                let width = y.len() / biases.len();
                for (m, y) in y.chunks_exact_mut(width).enumerate() {
                    let line = &weights[m * inputs..(m + 1) * inputs];
                    affine_block::<S, T, 1>(simd, [line], [biases[m]], x, y);
                }
            }
        }
    }
}

/// Vectors in one line of a tile.
#[inline(always)]
const fn width<S: Simd, T: Real>() -> usize {
    ROWS * size_of::<T>() / size_of::<T::Vector<S>>()
}

#[inline(always)]
fn affine_block<S: Simd, T: Real, const M: usize>(
    simd: S,
    weights: [&[T]; M],
    biases: [T; M],
    x: &[T::Vector<S>],
    y: &mut [T::Vector<S>],
) {
    let width = width::<S, T>();
    let inputs = x.len() / width;
    let weights = weights.map(|line| &line[..inputs]);
    for j in (0..width).step_by(2) {
        let mut sums: [[T::Vector<S>; 2]; M] = biases.map(|b| [T::splat(simd, b); 2]);
        for (k, line) in x.chunks_exact(width).enumerate() {
            let (x0, x1) = (line[j], line[j + 1]);
            for m in 0..M {
                let w = T::splat(simd, weights[m][k]);
                sums[m][0] = T::mul_add(simd, w, x0, sums[m][0]);
                sums[m][1] = T::mul_add(simd, w, x1, sums[m][1]);
            }
        }
        for (line, sum) in y.chunks_exact_mut(width).zip(sums) {
            line[j] = sum[0];
            line[j + 1] = sum[1];
        }
    }
}

struct BackInput<'a, T> {
    weights: &'a [T],
    dy: &'a [T],
    dx: &'a mut [T],
}

impl<T: Real> WithSimd for BackInput<'_, T> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let inputs = self.dx.len() / ROWS;
        let width = width::<S, T>();
        let dy = T::vectors::<S>(self.dy);
        for (block, dx) in self.dx.chunks_mut(BLOCK * ROWS).enumerate() {
            let dx = T::vectors_mut::<S>(dx);
            let first = block * BLOCK;
            if dx.len() == BLOCK * width {
                back_input_block::<S, T, BLOCK>(simd, self.weights, inputs, first, dy, dx);
            } else {
                for (m, dx) in dx.chunks_exact_mut(width).enumerate() {
                    back_input_block::<S, T, 1>(simd, self.weights, inputs, first + m, dy, dx);
                }
            }
        }
    }
}

#[inline(always)]
fn back_input_block<S: Simd, T: Real, const M: usize>(
    simd: S,
    weights: &[T],
    inputs: usize,
    first: usize,
    dy: &[T::Vector<S>],
    dx: &mut [T::Vector<S>],
) {
    let width = width::<S, T>();
    for j in (0..width).step_by(2) {
        let mut sums = [[T::splat(simd, T::default()); 2]; M];
        for (line, weights) in dy.chunks_exact(width).zip(weights.chunks_exact(inputs)) {
            let (d0, d1) = (line[j], line[j + 1]);
            let weights = &weights[first..first + M];
            for m in 0..M {
                let w = T::splat(simd, weights[m]);
                sums[m][0] = T::mul_add(simd, w, d0, sums[m][0]);
                sums[m][1] = T::mul_add(simd, w, d1, sums[m][1]);
            }
        }
        for (line, sum) in dx.chunks_exact_mut(width).zip(sums) {
            line[j] = sum[0];
            line[j + 1] = sum[1];
        }
    }
}

struct BackWeights<'a, T> {
    dy: &'a [T],
    x: &'a [T],
    dw: &'a mut [T],
    db: &'a mut [T],
}

impl<T: Real> WithSimd for BackWeights<'_, T> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let inputs = self.x.len() / ROWS;
        let width = width::<S, T>();
        let x = T::vectors::<S>(self.x);
        let one = T::splat(simd, T::from_f64(1.0));
        for (dy, db) in self.dy.chunks_exact(ROWS).zip(self.db.iter_mut()) {
            let mut sum = T::splat(simd, T::default());
            for &d in T::vectors::<S>(dy) {
                sum = T::mul_add(simd, one, d, sum);
            }
            *db = *db + T::sum(simd, sum);
        }
        let blocks = self
            .dw
            .chunks_mut(BLOCK * inputs)
            .zip(self.dy.chunks(BLOCK * ROWS));
        for (dw, dy) in blocks {
            let dy = T::vectors::<S>(dy);
            if dy.len() == BLOCK * width {
                let mut lines = dw.chunks_exact_mut(inputs);
                let dw: [&mut [T]; BLOCK] =
                    std::array::from_fn(|_| lines.next().unwrap_or_default());
                back_weights_block::<S, T, BLOCK>(simd, dy, x, dw);
            } else {
                for (dw, dy) in dw.chunks_exact_mut(inputs).zip(dy.chunks_exact(width)) {
                    back_weights_block::<S, T, 1>(simd, dy, x, [dw]);
                }
            }
        }
    }
}

#[inline(always)]
fn back_weights_block<S: Simd, T: Real, const M: usize>(
    simd: S,
    dy: &[T::Vector<S>],
    x: &[T::Vector<S>],
    mut dw: [&mut [T]; M],
) {
    let width = width::<S, T>();
    let dy: [&[T::Vector<S>]; M] = std::array::from_fn(|m| &dy[m * width..(m + 1) * width]);
    let zero = T::splat(simd, T::default());
    let mut pairs = x.chunks_exact(2 * width);
    let mut k = 0;
    for pair in pairs.by_ref() {
        let (x0, x1) = pair.split_at(width);
        let mut sums = [[zero; 2]; M];
        for j in 0..width {
            for m in 0..M {
                sums[m][0] = T::mul_add(simd, dy[m][j], x0[j], sums[m][0]);
                sums[m][1] = T::mul_add(simd, dy[m][j], x1[j], sums[m][1]);
            }
        }
        for (line, sum) in dw.iter_mut().zip(sums) {
            line[k] = line[k] + T::sum(simd, sum[0]);
            line[k + 1] = line[k + 1] + T::sum(simd, sum[1]);
        }
        k += 2;
    }
    let last = pairs.remainder();
    if !last.is_empty() {
        for (line, dy) in dw.iter_mut().zip(dy) {
            let mut sum = zero;
            for (&d, &x) in dy.iter().zip(last) {
                sum = T::mul_add(simd, d, x, sum);
            }
            line[k] = line[k] + T::sum(simd, sum);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers<T: Real>(n: usize, seed: usize) -> Vec<T> {
        let value = |i: usize| ((i * 7919 + seed * 104_729) % 1009) as f64 / 504.5 - 1.0;
        (0..n).map(|i| T::from_f64(value(i))).collect()
    }

    fn agrees<T: Real>(inputs: usize, outputs: usize, tolerance: f64) {
        let w = numbers::<T>(inputs * outputs, 1);
        let b = numbers::<T>(outputs, 2);
        let x = numbers::<T>(inputs * ROWS, 3);
        let dy = numbers::<T>(outputs * ROWS, 4);
        let mut y = vec![T::default(); outputs * ROWS];
        let mut dx = vec![T::default(); inputs * ROWS];
        let mut dw = numbers::<T>(inputs * outputs, 5);
        let mut db = numbers::<T>(outputs, 6);
        affine(&w, &b, &x, &mut y);
        back_input(&w, &dy, &mut dx);
        back_weights(&dy, &x, &mut dw, &mut db);
        let near = |found: T, expected: f64| {
            assert!(
                (found.f64() - expected).abs() < tolerance,
                "{found:?} {expected}"
            );
        };
        for o in 0..outputs {
            for r in 0..ROWS {
                let sum: f64 = (0..inputs)
                    .map(|k| w[o * inputs + k].f64() * x[k * ROWS + r].f64())
                    .sum();
                near(y[o * ROWS + r], b[o].f64() + sum);
            }
            for k in 0..inputs {
                let sum: f64 = (0..ROWS)
                    .map(|r| dy[o * ROWS + r].f64() * x[k * ROWS + r].f64())
                    .sum();
                near(
                    dw[o * inputs + k],
                    numbers::<T>(inputs * outputs, 5)[o * inputs + k].f64() + sum,
                );
            }
            let sum: f64 = (0..ROWS).map(|r| dy[o * ROWS + r].f64()).sum();
            near(db[o], numbers::<T>(outputs, 6)[o].f64() + sum);
        }
        for k in 0..inputs {
            for r in 0..ROWS {
                let sum: f64 = (0..outputs)
                    .map(|o| w[o * inputs + k].f64() * dy[o * ROWS + r].f64())
                    .sum();
                near(dx[k * ROWS + r], sum);
            }
        }
    }

    #[test]
    fn every_shape_agrees_with_plain_sums() {
        for (inputs, outputs) in [(1, 1), (4, 64), (19, 2), (64, 64), (37, 6), (60, 17)] {
            agrees::<f64>(inputs, outputs, 1e-12);
            agrees::<f32>(inputs, outputs, 1e-4);
        }
    }

    #[test]
    fn plain_code_agrees_with_the_vectors_of_this_processor() {
        let (inputs, outputs) = (37, 18);
        let weights = &numbers::<f32>(inputs * outputs, 1)[..];
        let biases = &numbers::<f32>(outputs, 2)[..];
        let x = &numbers::<f32>(inputs * ROWS, 3)[..];
        let dy = &numbers::<f32>(outputs * ROWS, 4)[..];
        let run = |plain: bool| {
            let mut y = vec![0.0; outputs * ROWS];
            let mut dx = vec![0.0; inputs * ROWS];
            let mut dw = vec![0.0; inputs * outputs];
            let mut db = vec![0.0; outputs];
            let forward = Affine {
                weights,
                biases,
                x,
                y: &mut y,
            };
            let back_input = BackInput {
                weights,
                dy,
                dx: &mut dx,
            };
            let back_weights = BackWeights {
                dy,
                x,
                dw: &mut dw,
                db: &mut db,
            };
            if plain {
                forward.with_simd(pulp::Scalar);
                back_input.with_simd(pulp::Scalar);
                back_weights.with_simd(pulp::Scalar);
            } else {
                Arch::new().dispatch(forward);
                Arch::new().dispatch(back_input);
                Arch::new().dispatch(back_weights);
            }
            [y, dx, dw, db].concat()
        };
        for (a, b) in run(true).iter().zip(run(false)) {
            assert!((a - b).abs() < 1e-5 * (1.0 + a.abs()), "{a} {b}");
        }
    }

    #[test]
    fn a_tile_starts_on_a_cache_line() {
        let tile = Tile::<f32>::zeros(3);
        assert_eq!(tile.all().as_ptr().align_offset(64), 0);
        assert_eq!(tile.all().len(), 3 * ROWS);
    }
}
