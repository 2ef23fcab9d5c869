//! The network's layers, there and back.
#![allow(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "code for one processor must be inlined into the function compiled for it; lanes of several arrays run abreast"
)]

use super::{
    lanes::{LANES, Lanes, add, add_product, add_scaled, nothing, softsign, through_softsign},
    layout::{INPUTS, Layout, OUTPUTS},
};
use maveric_laws::Real;

/// A network with the embeddings of several lanes: what comes of them is the same at every step.
pub(super) struct Styled<'a, T, const N: usize = LANES> {
    first_base: Vec<Lanes<T, N>>,
    last_base: Vec<Lanes<T, N>>,
    first: &'a [T],
    second: &'a [T],
    second_bias: &'a [T],
    last: &'a [T],
}

impl<'a, T: Real, const N: usize> Styled<'a, T, N> {
    /// `w` gives number `k` of the embedding of a lane.
    #[inline(always)]
    pub(super) fn new(layout: Layout, weights: &'a [T], w: impl Fn(usize, usize) -> T) -> Self {
        let d = layout.embedding;
        let base = |matrix: &[T], biases: &[T]| -> Vec<Lanes<T, N>> {
            let line = |(line, &bias): (&[T], &T)| -> Lanes<T, N> {
                std::array::from_fn(|lane| (0..d).fold(bias, |sum, k| sum + line[k] * w(lane, k)))
            };
            matrix.chunks_exact(d).zip(biases).map(line).collect()
        };
        Self {
            first_base: base(&weights[layout.style()], &weights[layout.first_bias()]),
            last_base: base(&weights[layout.direct()], &weights[layout.last_bias()]),
            first: &weights[layout.first()],
            second: &weights[layout.second()],
            second_bias: &weights[layout.second_bias()],
            last: &weights[layout.last()],
        }
    }

    /// From the inputs to the outputs; `first` and `second` are left with what the `h` units of the layers made of them.
    #[inline(always)]
    pub(super) fn forward(
        &self,
        h: usize,
        inputs: &[Lanes<T, N>; INPUTS],
        first: &mut [Lanes<T, N>],
        second: &mut [Lanes<T, N>],
    ) -> [Lanes<T, N>; OUTPUTS] {
        // Of a length that may be known when this is compiled.
        let (first, second) = (&mut first[..h], &mut second[..h]);
        let (first_base, bias) = (&self.first_base[..h], &self.second_bias[..h]);
        let (from_inputs, from_first) = (&self.first[..h * INPUTS], &self.second[..h * h]);
        let (last_base, last) = (&self.last_base[..OUTPUTS], &self.last[..OUTPUTS * h]);
        for unit in 0..h {
            let mut sum = first_base[unit];
            for k in 0..INPUTS {
                add_scaled(&mut sum, from_inputs[unit * INPUTS + k], &inputs[k]);
            }
            first[unit] = sum;
        }
        softsign(first);
        for unit in 0..h {
            let mut sum = [bias[unit]; N];
            for from in 0..h {
                add_scaled(&mut sum, from_first[unit * h + from], &first[from]);
            }
            second[unit] = sum;
        }
        softsign(second);
        let mut outputs = [nothing(); OUTPUTS];
        for (k, output) in outputs.iter_mut().enumerate() {
            let mut sum = last_base[k];
            for from in 0..h {
                add_scaled(&mut sum, last[k * h + from], &second[from]);
            }
            *output = sum;
        }
        outputs
    }
}

/// Loss of a batch and its gradients.
pub(super) struct Gradient {
    pub(super) loss: f64,
    pub(super) weights: Vec<f64>,
    /// Shape `(embeddings, d)`.
    pub(super) embeddings: Vec<f64>,
}

impl Gradient {
    pub(super) fn zero(weights: usize, embeddings: usize) -> Self {
        Self {
            loss: 0.0,
            weights: vec![0.0; weights],
            embeddings: vec![0.0; embeddings],
        }
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.loss += other.loss;
        for (mine, theirs) in self.weights.iter_mut().zip(&other.weights) {
            *mine += theirs;
        }
        for (mine, theirs) in self.embeddings.iter_mut().zip(&other.embeddings) {
            *mine += theirs;
        }
    }
}

/// Gradients of a network's layers, lane by lane.
pub(super) struct Sums<T> {
    first: Vec<Lanes<T>>,
    first_weights: Vec<Lanes<T>>,
    second: Vec<Lanes<T>>,
    second_weights: Vec<Lanes<T>>,
    last: [Lanes<T>; OUTPUTS],
    last_weights: Vec<Lanes<T>>,
}

impl<T: Real> Sums<T> {
    pub(super) fn zero(h: usize) -> Self {
        let zeros = |n: usize| vec![nothing(); n];
        Self {
            first: zeros(h),
            first_weights: zeros(h * INPUTS),
            second: zeros(h),
            second_weights: zeros(h * h),
            last: [nothing(); OUTPUTS],
            last_weights: zeros(OUTPUTS * h),
        }
    }

    /// Goes back through the layers of one step, which gave `first_y` and `second_y`, from the gradients of its outputs to those of its
    /// inputs. `kept` is left with the gradients of the outputs and of the second layer.
    #[inline(always)]
    pub(super) fn add_step(
        &mut self,
        h: usize,
        network: &Styled<'_, T>,
        (first_y, second_y): (&[Lanes<T>], &[Lanes<T>]),
        inputs: &[Lanes<T>; INPUTS],
        d_outputs: &[Lanes<T>; OUTPUTS],
        kept: &mut [Lanes<T>],
    ) -> [Lanes<T>; INPUTS] {
        // Of a length that may be known when this is compiled.
        let (first_y, second_y) = (&first_y[..h], &second_y[..h]);
        let (from_inputs, from_first) = (&network.first[..h * INPUTS], &network.second[..h * h]);
        let last = &network.last[..OUTPUTS * h];
        let (sums_first, sums_second) = (&mut self.first[..h], &mut self.second[..h]);
        let first_weights = &mut self.first_weights[..h * INPUTS];
        let (kept_outputs, d_second) = kept[..OUTPUTS + h].split_at_mut(OUTPUTS);
        kept_outputs.copy_from_slice(d_outputs);
        for k in 0..OUTPUTS {
            add(&mut self.last[k], &d_outputs[k]);
        }
        for unit in 0..h {
            let mut d = nothing();
            for k in 0..OUTPUTS {
                add_scaled(&mut d, last[k * h + unit], &d_outputs[k]);
            }
            through_softsign(&mut d, &second_y[unit]);
            add(&mut sums_second[unit], &d);
            d_second[unit] = d;
        }
        let mut d_inputs = [nothing(); INPUTS];
        for from in 0..h {
            let mut d = nothing();
            for unit in 0..h {
                add_scaled(&mut d, from_first[unit * h + from], &d_second[unit]);
            }
            through_softsign(&mut d, &first_y[from]);
            add(&mut sums_first[from], &d);
            for k in 0..INPUTS {
                let line = from * INPUTS + k;
                add_product(&mut first_weights[line], &d, &inputs[k]);
                add_scaled(&mut d_inputs[k], from_inputs[line], &d);
            }
        }
        d_inputs
    }

    /// Adds what the weights between layers gather over the steps: of the outputs of the layers, and of what [`Sums::add_step`] kept.
    #[inline(always)]
    pub(super) fn add_between(
        &mut self,
        h: usize,
        first_y: &Strided<'_, T>,
        second_y: &Strided<'_, T>,
        kept: &[Lanes<T>],
    ) {
        let d = |at| Strided {
            tape: kept,
            size: OUTPUTS + h,
            at,
        };
        add_over_steps(&mut self.last_weights, h, &d(0), second_y);
        add_over_steps(&mut self.second_weights, h, &d(OUTPUTS), first_y);
    }

    /// Adds the lanes up: gradients of the weights, and of the embedding of each lane.
    #[inline(always)]
    pub(super) fn put(
        &self,
        layout: Layout,
        weights: &[T],
        embeddings: &[T],
        of_lane: &[usize; LANES],
        out: &mut Gradient,
    ) {
        let d = layout.embedding;
        for (range, sums) in [
            (layout.first(), &self.first_weights[..]),
            (layout.first_bias(), &self.first),
            (layout.second(), &self.second_weights),
            (layout.second_bias(), &self.second),
            (layout.last(), &self.last_weights),
            (layout.last_bias(), &self.last),
        ] {
            for (weight, sum) in out.weights[range].iter_mut().zip(sums) {
                *weight = sum.iter().map(|x| x.wide()).sum();
            }
        }
        for (range, sums) in [
            (layout.style(), &self.first[..]),
            (layout.direct(), &self.last),
        ] {
            for (line, sum) in sums.iter().enumerate() {
                for k in 0..d {
                    let index = range.start + line * d + k;
                    for l in 0..LANES {
                        let number = of_lane[l] * d + k;
                        out.weights[index] += sum[l].wide() * embeddings[number].wide();
                        out.embeddings[number] += sum[l].wide() * weights[index].wide();
                    }
                }
            }
        }
    }
}

/// Some of the numbers of each step of a tape.
pub(super) struct Strided<'a, T> {
    pub(super) tape: &'a [Lanes<T>],
    /// Numbers of a step.
    pub(super) size: usize,
    /// The first of them that is meant.
    pub(super) at: usize,
}

/// Sums that stay in registers.
const TILE: usize = 4;

/// Adds up from the last step to the first what each gradient `d` makes with each of the `inputs` numbers `x`; shape `(outputs, inputs)`.
#[inline(always)]
fn add_over_steps<T: Real>(
    sums: &mut [Lanes<T>],
    inputs: usize,
    d: &Strided<'_, T>,
    x: &Strided<'_, T>,
) {
    for (output, line) in sums.chunks_exact_mut(inputs).enumerate() {
        let (tiles, rest) = line.as_chunks_mut::<TILE>();
        let done = TILE * tiles.len();
        for (i, tile) in tiles.iter_mut().enumerate() {
            add_tile(tile, (d, d.at + output), (x, x.at + i * TILE));
        }
        for (i, sum) in rest.iter_mut().enumerate() {
            let one = std::array::from_mut(sum);
            add_tile(one, (d, d.at + output), (x, x.at + done + i));
        }
    }
}

#[inline(always)]
fn add_tile<T: Real, const N: usize>(
    sums: &mut [Lanes<T>; N],
    (d, output): (&Strided<'_, T>, usize),
    (x, input): (&Strided<'_, T>, usize),
) {
    let mut tile = *sums;
    let steps = d.tape.chunks_exact(d.size).zip(x.tape.chunks_exact(x.size));
    for (d, x) in steps.rev() {
        let d = d[output];
        for (sum, x) in tile.iter_mut().zip(&x[input..input + N]) {
            add_product(sum, &d, x);
        }
    }
    *sums = tile;
}
