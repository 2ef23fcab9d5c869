//! Simulated following and the way back through it: several segments abreast.
#![allow(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "code for one processor must be inlined into the function compiled for it; lanes of several arrays run abreast"
)]

use super::{
    controller,
    layout::{INPUTS, Layout, OUTPUTS},
};
use crate::closed_loop::{MAX_ACCEL_MPS2, MIN_ACCEL_MPS2};
use maveric_laws::Rss;
use pulp::Arch;

/// Segments simulated abreast.
pub(super) const LANES: usize = 8;
/// One number of each segment.
pub(super) type Lanes = [f64; LANES];

/// The recorded rows of up to [`LANES`] segments of equal length.
pub(super) struct Batch {
    /// Driver of each lane.
    pub(super) drivers: [usize; LANES],
    /// Weight of each lane's error in the loss; 0 for a lane that only fills up.
    pub(super) weights: Lanes,
    /// Recorded gap, in m; shape `(steps + 1,)`.
    pub(super) gap_m: Vec<Lanes>,
    /// Recorded speed, in m/s; shape `(steps + 1,)`.
    pub(super) speed_mps: Vec<Lanes>,
    /// Speed of the leader, in m/s; shape `(steps + 1,)`.
    pub(super) lead_mps: Vec<Lanes>,
    /// How far the leader moved since the row before, in m; shape `(steps + 1,)`.
    pub(super) lead_moved_m: Vec<Lanes>,
}

/// What all segments share.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct World {
    pub(super) layout: Layout,
    pub(super) scaling: controller::Scaling,
    pub(super) safety: Rss,
    pub(super) step_s: f64,
    /// Weight of a squared error of 1 m.
    pub(super) gap_weight: f64,
    /// Weight of a squared error of 1 m/s.
    pub(super) speed_weight: f64,
}

/// Loss of a batch and its gradients.
pub(super) struct Gradient {
    pub(super) loss: f64,
    pub(super) weights: Vec<f64>,
    /// One embedding's gradient a driver, shape `(drivers, d)`.
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

/// What a step leaves for the way back.
struct Step<'a> {
    gap_m: &'a mut Lanes,
    speed_mps: &'a mut Lanes,
    first: &'a mut [Lanes],
    second: &'a mut [Lanes],
    outputs: &'a mut [Lanes],
}

fn step_of(tape: &mut [Lanes], layout: Layout, at: usize) -> Step<'_> {
    let size = 2 + 2 * layout.hidden + OUTPUTS;
    let (state, rest) = tape[at * size..(at + 1) * size].split_at_mut(2);
    let (gap_m, speed_mps) = state.split_at_mut(1);
    let (first, rest) = rest.split_at_mut(layout.hidden);
    let (second, outputs) = rest.split_at_mut(layout.hidden);
    Step {
        gap_m: &mut gap_m[0],
        speed_mps: &mut speed_mps[0],
        first,
        second,
        outputs,
    }
}

/// A network with the embeddings of a batch: what comes of them is the same at every step.
struct Styled<'a> {
    first_base: Vec<Lanes>,
    last_base: Vec<Lanes>,
    first: &'a [f64],
    second: &'a [f64],
    second_bias: &'a [f64],
    last: &'a [f64],
}

impl<'a> Styled<'a> {
    /// `w` gives number `k` of the embedding of a lane.
    #[inline(always)]
    fn of(layout: Layout, weights: &'a [f64], w: impl Fn(usize, usize) -> f64) -> Self {
        let d = layout.embedding;
        let base = |matrix: &[f64], biases: &[f64]| -> Vec<Lanes> {
            let line = |(line, &bias): (&[f64], &f64)| -> Lanes {
                std::array::from_fn(|lane| bias + (0..d).map(|k| line[k] * w(lane, k)).sum::<f64>())
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

    #[inline(always)]
    fn forward(
        &self,
        inputs: &[Lanes; INPUTS],
        first: &mut [Lanes],
        second: &mut [Lanes],
        outputs: &mut [Lanes],
    ) {
        let h = first.len();
        for (unit, y) in first.iter_mut().enumerate() {
            let mut sum = self.first_base[unit];
            multiply_add(
                &mut sum,
                &self.first[unit * INPUTS..(unit + 1) * INPUTS],
                inputs,
            );
            *y = softsign(sum);
        }
        for (unit, y) in second.iter_mut().enumerate() {
            let mut sum = [self.second_bias[unit]; LANES];
            multiply_add(&mut sum, &self.second[unit * h..(unit + 1) * h], first);
            *y = softsign(sum);
        }
        for (unit, y) in outputs.iter_mut().enumerate() {
            *y = self.last_base[unit];
            multiply_add(y, &self.last[unit * h..(unit + 1) * h], second);
        }
    }
}

/// Simulates the batch and goes back through it.
///
/// # Source
/// Backpropagation through time (Werbos 1990), over whole segments: the error of a gap reaches every command before it.
pub(super) fn gradient(
    world: &World,
    weights: &[f64],
    embeddings: &[f64],
    batch: &Batch,
) -> Gradient {
    Arch::new().dispatch(
        #[inline(always)]
        || there_and_back(world, weights, embeddings, batch),
    )
}

#[inline(always)]
fn there_and_back(world: &World, weights: &[f64], embeddings: &[f64], batch: &Batch) -> Gradient {
    let layout = world.layout;
    let steps = batch.gap_m.len() - 1;
    let mut out = Gradient::zero(layout.len(), embeddings.len());
    let mut tape = vec![[0.0; LANES]; steps * (2 + 2 * layout.hidden + OUTPUTS)];
    let w = |lane: usize, k: usize| embeddings[batch.drivers[lane] * layout.embedding + k];
    let network = Styled::of(layout, weights, w);
    let errors = there(world, &network, batch, &mut tape, &mut out.loss);
    let sums = back(world, &network, batch, &mut tape, &errors);
    sums.put(layout, weights, w, &batch.drivers, &mut out);
    out
}

/// Simulates the batch onto the tape; the errors of gap and speed after each step.
#[inline(always)]
fn there(
    world: &World,
    network: &Styled<'_>,
    batch: &Batch,
    tape: &mut [Lanes],
    loss: &mut f64,
) -> Vec<(Lanes, Lanes)> {
    let steps = batch.gap_m.len() - 1;
    let (mut gap, mut speed) = (batch.gap_m[0], batch.speed_mps[0]);
    let mut errors = vec![([0.0; LANES], [0.0; LANES]); steps];
    for at in 0..steps {
        let step = step_of(tape, world.layout, at);
        *step.gap_m = gap;
        *step.speed_mps = speed;
        let inputs = inputs(world, &speed);
        network.forward(&inputs, step.first, step.second, step.outputs);
        for l in 0..LANES {
            let o = std::array::from_fn(|k| step.outputs[k][l]);
            let (g, v, lead) = (gap[l], speed[l], batch.lead_mps[at][l]);
            let asked = controller::Parameters::of(o).accel_mps2(&world.safety, g, v, lead);
            let (moved, next) = advance(v, asked, world.step_s);
            gap[l] = g + batch.lead_moved_m[at + 1][l] - moved;
            speed[l] = next;
            let (gap_error, speed_error) = (
                gap[l] - batch.gap_m[at + 1][l],
                next - batch.speed_mps[at + 1][l],
            );
            errors[at].0[l] = gap_error;
            errors[at].1[l] = speed_error;
            let square = world.gap_weight * gap_error * gap_error
                + world.speed_weight * speed_error * speed_error;
            *loss += batch.weights[l] * square / steps as f64;
        }
    }
    errors
}

/// Gradients of a network's layers, lane by lane.
struct Sums {
    first: Vec<Lanes>,
    first_weights: Vec<Lanes>,
    second: Vec<Lanes>,
    second_weights: Vec<Lanes>,
    last: [Lanes; OUTPUTS],
    last_weights: Vec<Lanes>,
}

impl Sums {
    fn zero(h: usize) -> Self {
        let zeros = |n: usize| vec![[0.0; LANES]; n];
        Self {
            first: zeros(h),
            first_weights: zeros(h * INPUTS),
            second: zeros(h),
            second_weights: zeros(h * h),
            last: [[0.0; LANES]; OUTPUTS],
            last_weights: zeros(OUTPUTS * h),
        }
    }

    /// Goes back through the layers of one step from the gradients of its outputs, to those of its inputs; `d_first` and
    /// `d_second` are room for those between.
    #[inline(always)]
    fn add_step(
        &mut self,
        network: &Styled<'_>,
        step: &Step<'_>,
        inputs: &[Lanes; INPUTS],
        d_outputs: &[Lanes; OUTPUTS],
        (d_first, d_second): (&mut [Lanes], &mut [Lanes]),
    ) -> [Lanes; INPUTS] {
        let h = d_first.len();
        let (first, second, last) = (network.first, network.second, network.last);
        d_second.fill([0.0; LANES]);
        for k in 0..OUTPUTS {
            let d = &d_outputs[k];
            add(&mut self.last[k], d);
            for unit in 0..h {
                let line = k * h + unit;
                add_product(&mut self.last_weights[line], d, &step.second[unit]);
                add_scaled(&mut d_second[unit], last[line], d);
            }
        }
        d_first.fill([0.0; LANES]);
        for unit in 0..h {
            let d = &mut d_second[unit];
            through_softsign(d, &step.second[unit]);
            add(&mut self.second[unit], d);
            for from in 0..h {
                let line = unit * h + from;
                add_product(&mut self.second_weights[line], d, &step.first[from]);
                add_scaled(&mut d_first[from], second[line], d);
            }
        }
        let mut d_inputs = [[0.0; LANES]; INPUTS];
        for unit in 0..h {
            let d = &mut d_first[unit];
            through_softsign(d, &step.first[unit]);
            add(&mut self.first[unit], d);
            for k in 0..INPUTS {
                let line = unit * INPUTS + k;
                add_product(&mut self.first_weights[line], d, &inputs[k]);
                add_scaled(&mut d_inputs[k], first[line], d);
            }
        }
        d_inputs
    }

    /// Adds the lanes up: gradients of the weights, and of each driver's embedding.
    #[inline(always)]
    fn put(
        &self,
        layout: Layout,
        weights: &[f64],
        w: impl Fn(usize, usize) -> f64,
        drivers: &[usize; LANES],
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
                *weight = sum.iter().sum();
            }
        }
        for (range, sums) in [
            (layout.style(), &self.first[..]),
            (layout.direct(), &self.last),
        ] {
            for (line, sum) in sums.iter().enumerate() {
                for k in 0..d {
                    let at = range.start + line * d + k;
                    for l in 0..LANES {
                        out.weights[at] += sum[l] * w(l, k);
                        out.embeddings[drivers[l] * d + k] += sum[l] * weights[at];
                    }
                }
            }
        }
    }
}

/// Goes back over the tape from the last step to the first.
#[inline(always)]
fn back(
    world: &World,
    network: &Styled<'_>,
    batch: &Batch,
    tape: &mut [Lanes],
    errors: &[(Lanes, Lanes)],
) -> Sums {
    let (h, steps) = (world.layout.hidden, errors.len());
    let mut sums = Sums::zero(h);
    let (mut d_first, mut d_second) = (vec![[0.0; LANES]; h], vec![[0.0; LANES]; h]);
    let (mut d_gap, mut d_speed) = ([0.0; LANES], [0.0; LANES]);
    for at in (0..steps).rev() {
        let step = step_of(tape, world.layout, at);
        let mut d_outputs = [[0.0; LANES]; OUTPUTS];
        for l in 0..LANES {
            let scale = 2.0 * batch.weights[l] / steps as f64;
            d_gap[l] += scale * world.gap_weight * errors[at].0[l];
            d_speed[l] += scale * world.speed_weight * errors[at].1[l];
            let o = std::array::from_fn(|k| step.outputs[k][l]);
            let parameters = controller::Parameters::of(o);
            let (g, v, lead) = (step.gap_m[l], step.speed_mps[l], batch.lead_mps[at][l]);
            let asked = parameters.accel_mps2(&world.safety, g, v, lead);
            let (d_v, d_a) = advance_back(v, asked, world.step_s, -d_gap[l], d_speed[l]);
            let back = parameters.back(o, &world.safety, (g, v, lead), d_a);
            d_gap[l] += back.gap;
            d_speed[l] = d_v + back.speed;
            for k in 0..OUTPUTS {
                d_outputs[k][l] = back.outputs[k];
            }
        }
        let inputs = inputs(world, step.speed_mps);
        let between = (&mut d_first[..], &mut d_second[..]);
        let d_inputs = sums.add_step(network, &step, &inputs, &d_outputs, between);
        for l in 0..LANES {
            d_speed[l] += d_inputs[0][l] / world.scaling.speed_sd_mps;
        }
    }
    sums
}

#[inline(always)]
fn inputs(world: &World, speed: &Lanes) -> [Lanes; INPUTS] {
    let s = &world.scaling;
    [std::array::from_fn(|l| s.input(speed[l]))]
}

#[inline(always)]
fn multiply_add(sum: &mut Lanes, line: &[f64], x: &[Lanes]) {
    for (weight, x) in line.iter().zip(x) {
        add_scaled(sum, *weight, x);
    }
}

#[inline(always)]
fn add(sum: &mut Lanes, x: &Lanes) {
    for l in 0..LANES {
        sum[l] += x[l];
    }
}

#[inline(always)]
fn add_scaled(sum: &mut Lanes, weight: f64, x: &Lanes) {
    for l in 0..LANES {
        sum[l] += weight * x[l];
    }
}

#[inline(always)]
fn add_product(sum: &mut Lanes, x: &Lanes, y: &Lanes) {
    for l in 0..LANES {
        sum[l] += x[l] * y[l];
    }
}

/// x/(1 + |x|): unlike tanh the same few instructions on every machine, and so the same bytes.
#[inline(always)]
fn softsign(mut x: Lanes) -> Lanes {
    for x in &mut x {
        *x /= 1.0 + x.abs();
    }
    x
}

#[inline(always)]
fn through_softsign(d: &mut Lanes, y: &Lanes) {
    for l in 0..LANES {
        let rest = 1.0 - y[l].abs();
        d[l] *= rest * rest;
    }
}

/// Distance moved and the next speed, as in [`simulate`](crate::simulate).
#[inline(always)]
fn advance(speed: f64, asked: f64, step_s: f64) -> (f64, f64) {
    let a = asked.clamp(MIN_ACCEL_MPS2, MAX_ACCEL_MPS2);
    let next = speed + a * step_s;
    if next < 0.0 {
        (speed * speed / (-2.0 * a), 0.0)
    } else {
        (0.5 * (speed + next) * step_s, next)
    }
}

/// Derivatives by the speed and by the command, from those by the distance moved and by the next speed.
#[inline(always)]
fn advance_back(speed: f64, asked: f64, step_s: f64, d_moved: f64, d_next: f64) -> (f64, f64) {
    let a = asked.clamp(MIN_ACCEL_MPS2, MAX_ACCEL_MPS2);
    let (d_speed, d_a) = if speed + a * step_s < 0.0 {
        (
            -d_moved * speed / a,
            d_moved * speed * speed / (2.0 * a * a),
        )
    } else {
        let d_next = d_next + 0.5 * step_s * d_moved;
        (0.5 * step_s * d_moved + d_next, d_next * step_s)
    };
    let free = asked > MIN_ACCEL_MPS2 && asked < MAX_ACCEL_MPS2;
    (d_speed, if free { d_a } else { 0.0 })
}

/// What the network asks for at one moment.
pub(super) fn parameters(
    world: &World,
    weights: &[f64],
    embedding: &[f64],
    speed: f64,
) -> controller::Parameters {
    let h = world.layout.hidden;
    let network = Styled::of(world.layout, weights, |_, k| embedding[k]);
    let (mut first, mut second) = (vec![[0.0; LANES]; h], vec![[0.0; LANES]; h]);
    let mut outputs = [[0.0; LANES]; OUTPUTS];
    network.forward(
        &inputs(world, &[speed; LANES]),
        &mut first,
        &mut second,
        &mut outputs,
    );
    controller::Parameters::of(outputs.map(|lanes| lanes[0]))
}

#[cfg(test)]
mod tests;
