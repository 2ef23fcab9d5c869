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
use pulp::{Arch, NullaryFnOnce};
use std::cell::Cell;

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
    outputs: &'a mut [Lanes; OUTPUTS],
}

/// Numbers of a step: gap and speed, both layers and the outputs.
fn step_size(layout: Layout) -> usize {
    2 + 2 * layout.hidden + OUTPUTS
}

#[inline(always)]
fn step_of(tape: &mut [Lanes], layout: Layout, at: usize) -> Step<'_> {
    let size = step_size(layout);
    let (state, rest) = tape[at * size..(at + 1) * size].split_at_mut(2);
    let (gap_m, speed_mps) = state.split_at_mut(1);
    let (first, rest) = rest.split_at_mut(layout.hidden);
    let (second, outputs) = rest.split_at_mut(layout.hidden);
    let Some(outputs) = outputs.first_chunk_mut() else {
        unreachable!("a step ends in the outputs")
    };
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
    let mut room = ROOM.take();
    let found = Arch::new().dispatch(ThereAndBack {
        world,
        weights,
        embeddings,
        batch,
        room: &mut room,
    });
    ROOM.set(room);
    found
}

/// What a way there leaves for the way back; asked for anew each time, it takes longer than to compute what it holds.
#[derive(Default)]
struct Room {
    /// Each step's state and what the layers made of it: see [`step_of`].
    tape: Vec<Lanes>,
    /// Errors of gap and speed after each step.
    errors: Vec<(Lanes, Lanes)>,
    /// Gradients of each step: see [`Sums::add_step`].
    kept: Vec<Lanes>,
}

thread_local! {
    static ROOM: Cell<Room> = Cell::default();
}

/// What is compiled for the processor it runs on: a closure that is called through a reference would not be inlined there.
struct ThereAndBack<'a> {
    world: &'a World,
    weights: &'a [f64],
    embeddings: &'a [f64],
    batch: &'a Batch,
    room: &'a mut Room,
}

impl NullaryFnOnce for ThereAndBack<'_> {
    type Output = Gradient;

    #[inline(always)]
    fn call(self) -> Gradient {
        let Self {
            world,
            weights,
            embeddings,
            batch,
            room,
        } = self;
        let layout = world.layout;
        let steps = batch.gap_m.len() - 1;
        let nothing = [0.0; LANES];
        room.tape.resize(steps * step_size(layout), nothing);
        room.errors.resize(steps, (nothing, nothing));
        room.kept.resize(steps * (OUTPUTS + layout.hidden), nothing);
        let mut out = Gradient::zero(layout.len(), embeddings.len());
        let w = |lane: usize, k: usize| embeddings[batch.drivers[lane] * layout.embedding + k];
        let network = Styled::of(layout, weights, w);
        out.loss = there(world, &network, batch, room);
        let sums = back(world, &network, batch, room);
        sums.put(layout, weights, w, &batch.drivers, &mut out);
        out
    }
}

/// Simulates the batch onto the tape and gives the loss.
#[inline(always)]
fn there(world: &World, network: &Styled<'_>, batch: &Batch, room: &mut Room) -> f64 {
    let steps = batch.gap_m.len() - 1;
    let mut loss = 0.0;
    let (mut gap, mut speed) = (batch.gap_m[0], batch.speed_mps[0]);
    for (at, errors) in room.errors.iter_mut().enumerate() {
        let step = step_of(&mut room.tape, world.layout, at);
        *step.gap_m = gap;
        *step.speed_mps = speed;
        let inputs = inputs(world, &speed);
        network.forward(&inputs, step.first, step.second, step.outputs);
        // By value, and the sum on its own: so that the lanes of the loop run abreast.
        let (outputs, lead, lead_moved) = (
            *step.outputs,
            batch.lead_mps[at],
            batch.lead_moved_m[at + 1],
        );
        let (recorded_gap, recorded_speed) = (batch.gap_m[at + 1], batch.speed_mps[at + 1]);
        let (mut gap_errors, mut speed_errors) = ([0.0; LANES], [0.0; LANES]);
        for l in 0..LANES {
            let asked = controller::Parameters::of(of_lane(&outputs, l)).accel_mps2(
                &world.safety,
                gap[l],
                speed[l],
                lead[l],
            );
            let (moved, next) = advance(speed[l], asked, world.step_s);
            gap[l] = gap[l] + lead_moved[l] - moved;
            speed[l] = next;
            gap_errors[l] = gap[l] - recorded_gap[l];
            speed_errors[l] = next - recorded_speed[l];
        }
        *errors = (gap_errors, speed_errors);
        for l in 0..LANES {
            let square = world.gap_weight * gap_errors[l] * gap_errors[l]
                + world.speed_weight * speed_errors[l] * speed_errors[l];
            loss += batch.weights[l] * square / steps as f64;
        }
    }
    loss
}

#[inline(always)]
fn of_lane(outputs: &[Lanes; OUTPUTS], l: usize) -> [f64; OUTPUTS] {
    let [a, b, c, d] = outputs;
    [a[l], b[l], c[l], d[l]]
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

    /// Goes back through the layers of one step from the gradients of its outputs, to those of its inputs. `kept` is left with the gradients of the outputs and of the second layer.
    #[inline(always)]
    fn add_step(
        &mut self,
        network: &Styled<'_>,
        step: &Step<'_>,
        inputs: &[Lanes; INPUTS],
        d_outputs: &[Lanes; OUTPUTS],
        kept: &mut [Lanes],
    ) -> [Lanes; INPUTS] {
        let h = self.first.len();
        let (first, second, last) = (network.first, network.second, network.last);
        let (kept_outputs, d_second) = kept.split_at_mut(OUTPUTS);
        kept_outputs.copy_from_slice(d_outputs);
        for k in 0..OUTPUTS {
            add(&mut self.last[k], &d_outputs[k]);
        }
        for unit in 0..h {
            let mut d = [0.0; LANES];
            for k in 0..OUTPUTS {
                add_scaled(&mut d, last[k * h + unit], &d_outputs[k]);
            }
            through_softsign(&mut d, &step.second[unit]);
            add(&mut self.second[unit], &d);
            d_second[unit] = d;
        }
        let mut d_inputs = [[0.0; LANES]; INPUTS];
        for from in 0..h {
            let mut d = [0.0; LANES];
            for unit in 0..h {
                add_scaled(&mut d, second[unit * h + from], &d_second[unit]);
            }
            through_softsign(&mut d, &step.first[from]);
            add(&mut self.first[from], &d);
            for k in 0..INPUTS {
                let line = from * INPUTS + k;
                add_product(&mut self.first_weights[line], &d, &inputs[k]);
                add_scaled(&mut d_inputs[k], first[line], &d);
            }
        }
        d_inputs
    }

    /// Adds what the weights between layers gather over the steps, of the tape and of what [`Sums::add_step`] kept of each step.
    #[inline(always)]
    fn add_between(&mut self, layout: Layout, tape: &[Lanes], kept: &[Lanes]) {
        let h = layout.hidden;
        let d = |at| Strided {
            tape: kept,
            size: OUTPUTS + h,
            at,
        };
        let x = |at| Strided {
            tape,
            size: step_size(layout),
            at,
        };
        add_over_steps(&mut self.last_weights, h, &d(0), &x(2 + h));
        add_over_steps(&mut self.second_weights, h, &d(OUTPUTS), &x(2));
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

/// Some of the numbers of each step of a tape.
struct Strided<'a> {
    tape: &'a [Lanes],
    /// Numbers of a step.
    size: usize,
    /// The first of them that is meant.
    at: usize,
}

/// Sums that stay in registers.
const TILE: usize = 4;

/// Adds up from the last step to the first what each gradient `d` makes with each of the `inputs` numbers `x`; shape `(outputs, inputs)`.
#[inline(always)]
fn add_over_steps(sums: &mut [Lanes], inputs: usize, d: &Strided<'_>, x: &Strided<'_>) {
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
fn add_tile<const N: usize>(
    sums: &mut [Lanes; N],
    (d, output): (&Strided<'_>, usize),
    (x, input): (&Strided<'_>, usize),
) {
    let mut tile = *sums;
    let steps = d.tape.chunks_exact(d.size).zip(x.tape.chunks_exact(x.size));
    for (d, x) in steps.rev() {
        let d = &d[output];
        for (sum, x) in tile.iter_mut().zip(&x[input..input + N]) {
            add_product(sum, d, x);
        }
    }
    *sums = tile;
}

/// Goes back over the tape from the last step to the first.
#[inline(always)]
fn back(world: &World, network: &Styled<'_>, batch: &Batch, room: &mut Room) -> Sums {
    let (h, steps) = (world.layout.hidden, room.errors.len());
    let mut sums = Sums::zero(h);
    let (mut d_gap, mut d_speed) = ([0.0; LANES], [0.0; LANES]);
    let kept_steps = room.kept.chunks_exact_mut(OUTPUTS + h).enumerate();
    for (at, kept) in kept_steps.rev() {
        let step = step_of(&mut room.tape, world.layout, at);
        let [mut d_0, mut d_1, mut d_2, mut d_3] = [[0.0; LANES]; OUTPUTS];
        let (gap_errors, speed_errors) = room.errors[at];
        let (outputs, gap, speed, lead) = (
            *step.outputs,
            *step.gap_m,
            *step.speed_mps,
            batch.lead_mps[at],
        );
        for l in 0..LANES {
            let scale = 2.0 * batch.weights[l] / steps as f64;
            d_gap[l] += scale * world.gap_weight * gap_errors[l];
            d_speed[l] += scale * world.speed_weight * speed_errors[l];
            let o = of_lane(&outputs, l);
            let parameters = controller::Parameters::of(o);
            let (g, v, lead) = (gap[l], speed[l], lead[l]);
            let asked = parameters.accel_mps2(&world.safety, g, v, lead);
            let (d_v, d_a) = advance_back(v, asked, world.step_s, -d_gap[l], d_speed[l]);
            let back = parameters.back(o, &world.safety, (g, v, lead), d_a);
            d_gap[l] += back.gap;
            d_speed[l] = d_v + back.speed;
            [d_0[l], d_1[l], d_2[l], d_3[l]] = back.outputs;
        }
        let d_outputs = [d_0, d_1, d_2, d_3];
        let inputs = inputs(world, step.speed_mps);
        let d_inputs = sums.add_step(network, &step, &inputs, &d_outputs, kept);
        for l in 0..LANES {
            d_speed[l] += d_inputs[0][l] / world.scaling.speed_sd_mps;
        }
    }
    sums.add_between(world.layout, &room.tape, &room.kept);
    sums
}

#[inline(always)]
fn inputs(world: &World, speed: &Lanes) -> [Lanes; INPUTS] {
    let s = &world.scaling;
    [std::array::from_fn(|l| s.input(speed[l]))]
}

/// What `of` makes of two numbers, lane by lane. All is read before anything is written, so that lanes run abreast wherever they lie.
#[inline(always)]
fn lanes(x: &Lanes, y: &Lanes, of: impl Fn(f64, f64) -> f64) -> Lanes {
    let (x, y) = (*x, *y);
    std::array::from_fn(|l| of(x[l], y[l]))
}

#[inline(always)]
fn multiply_add(sum: &mut Lanes, line: &[f64], x: &[Lanes]) {
    for (weight, x) in line.iter().zip(x) {
        add_scaled(sum, *weight, x);
    }
}

#[inline(always)]
fn add(sum: &mut Lanes, x: &Lanes) {
    *sum = lanes(sum, x, |sum, x| sum + x);
}

#[inline(always)]
fn add_scaled(sum: &mut Lanes, weight: f64, x: &Lanes) {
    *sum = lanes(sum, x, |sum, x| sum + weight * x);
}

#[inline(always)]
fn add_product(sum: &mut Lanes, x: &Lanes, y: &Lanes) {
    let product = lanes(x, y, |x, y| x * y);
    *sum = lanes(sum, &product, |sum, product| sum + product);
}

/// x/(1 + |x|): unlike tanh the same few instructions on every machine, and so the same bytes.
#[inline(always)]
fn softsign(x: Lanes) -> Lanes {
    lanes(&x, &x, |x, _| x / (1.0 + x.abs()))
}

#[inline(always)]
fn through_softsign(d: &mut Lanes, y: &Lanes) {
    *d = lanes(d, y, |d, y| {
        let rest = 1.0 - y.abs();
        d * (rest * rest)
    });
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
