//! Rows of data side by side in vectors, and the one product that the frozen networks are made of.

#![expect(
    clippy::inline_always,
    reason = "code for one processor must be inlined into the function that was compiled for it"
)]

use pulp::{Arch, Simd, WithSimd};

/// Rows of data in a [`Line`]: a multiple of every vector width, so few that a hidden layer and its weights stay in
/// the nearest cache.
pub(super) const ROWS: usize = 32;

/// Outputs whose sums are kept in registers together.
const BLOCK: usize = 4;

/// One feature of [`ROWS`] rows.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Line(pub(super) [f32; ROWS]);

impl Line {
    pub(super) const ZERO: Self = Self([0.0; ROWS]);
}

/// `y += W x`, with `weights` of shape `(outputs, inputs)`, `x` `(inputs,)` and `y` `(outputs,)` lines.
pub(super) fn add_product(weights: &[f32], x: &[Line], y: &mut [Line]) {
    Arch::new().dispatch(AddProduct { weights, x, y });
}

/// `y = max(x + shift, 0)`, a shift a line.
pub(super) fn shifted_relu(x: &[Line], shift: &[f32], y: &mut [Line]) {
    Arch::new().dispatch(|| {
        for ((y, x), &shift) in y.iter_mut().zip(x).zip(shift) {
            for (y, x) in y.0.iter_mut().zip(&x.0) {
                *y = (x + shift).max(0.0);
            }
        }
    });
}

/// Sets negative values to zero.
pub(super) fn relu(lines: &mut [Line]) {
    Arch::new().dispatch(|| {
        for x in lines.iter_mut().flat_map(|line| &mut line.0) {
            *x = x.max(0.0);
        }
    });
}

/// Takes a gradient back through a ReLU: zero where the `value` after it is zero.
pub(super) fn back_relu(gradient: &mut [Line], value: &[Line]) {
    Arch::new().dispatch(|| {
        for (g, v) in gradient.iter_mut().zip(value) {
            for (g, &v) in g.0.iter_mut().zip(&v.0) {
                *g = if v > 0.0 { *g } else { 0.0 };
            }
        }
    });
}

/// Fills each line with its value.
pub(super) fn fill(lines: &mut [Line], values: &[f32]) {
    for (line, &value) in lines.iter_mut().zip(values) {
        line.0.fill(value);
    }
}

struct AddProduct<'a> {
    weights: &'a [f32],
    x: &'a [Line],
    y: &'a mut [Line],
}

impl WithSimd for AddProduct<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let inputs = self.x.len();
        let whole = self.y.len() / BLOCK * BLOCK;
        let (blocks, rest) = self.y.split_at_mut(whole);
        let (weights, rest_weights) = self.weights.split_at(whole * inputs);
        let lines = weights.chunks_exact(BLOCK * inputs);
        for (y, weights) in blocks.chunks_exact_mut(BLOCK).zip(lines) {
            add_block::<S, BLOCK>(simd, weights, self.x, y);
        }
        let lines = rest_weights.chunks_exact(inputs);
        for (y, weights) in rest.chunks_exact_mut(1).zip(lines) {
            add_block::<S, 1>(simd, weights, self.x, y);
        }
    }
}

#[inline(always)]
fn add_block<S: Simd, const M: usize>(simd: S, weights: &[f32], x: &[Line], y: &mut [Line]) {
    let inputs = x.len();
    let weights: [&[f32]; M] = std::array::from_fn(|m| &weights[m * inputs..(m + 1) * inputs]);
    let vectors = ROWS * size_of::<f32>() / size_of::<S::f32s>();
    for j in (0..vectors).step_by(2) {
        let mut sums: [[S::f32s; 2]; M] = std::array::from_fn(|m| {
            let line = S::as_simd_f32s(&y[m].0).0;
            [line[j], line[j + 1]]
        });
        for (k, line) in x.iter().enumerate() {
            let line = S::as_simd_f32s(&line.0).0;
            let (x0, x1) = (line[j], line[j + 1]);
            for (sum, weights) in sums.iter_mut().zip(&weights) {
                let w = simd.splat_f32s(weights[k]);
                // `mul_add_e`: a library call nowhere.
                sum[0] = simd.mul_add_e_f32s(w, x0, sum[0]);
                sum[1] = simd.mul_add_e_f32s(w, x1, sum[1]);
            }
        }
        for (y, sum) in y.iter_mut().zip(sums) {
            let line = S::as_mut_simd_f32s(&mut y.0).0;
            line[j] = sum[0];
            line[j + 1] = sum[1];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_size_of_product_is_the_naive_one() {
        for (outputs, inputs) in [(1, 1), (3, 5), (4, 1), (7, 9), (64, 64)] {
            let value = |i: usize| ((i * 37 + 11) % 19) as f32 - 9.0;
            let weights: Vec<f32> = (0..outputs * inputs).map(value).collect();
            let line = |k: usize| Line(std::array::from_fn(|r| value(k * 5 + r)));
            let x: Vec<Line> = (0..inputs).map(line).collect();
            let mut y: Vec<Line> = (0..outputs).map(line).collect();
            add_product(&weights, &x, &mut y);
            for (o, y) in y.iter().enumerate() {
                for (r, found) in y.0.iter().enumerate() {
                    let product = (0..inputs).map(|k| weights[o * inputs + k] * x[k].0[r]);
                    let expected = value(o * 5 + r) + product.sum::<f32>();
                    assert!((found - expected).abs() < 1e-3, "{found} {expected}");
                }
            }
        }
    }

    #[test]
    fn relu_forward_and_back() {
        let x = [Line(std::array::from_fn(|r| r as f32 - 10.0))];
        let mut y = [Line::ZERO];
        shifted_relu(&x, &[-2.0], &mut y);
        assert_eq!((y[0].0[12], y[0].0[13]), (0.0, 1.0));
        let mut gradient = [Line([1.0; ROWS])];
        back_relu(&mut gradient, &y);
        assert_eq!((gradient[0].0[12], gradient[0].0[13]), (0.0, 1.0));
        let mut z = x;
        relu(&mut z);
        assert_eq!((z[0].0[9], z[0].0[11]), (0.0, 1.0));
        fill(&mut z, &[3.0]);
        assert!(z[0].0.iter().all(|x| (x - 3.0).abs() < 1e-9));
    }
}
