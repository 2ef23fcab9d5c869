//! Simulated following and the way back through it: several segments abreast.
#![allow(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "code for one processor must be inlined into the function compiled for it; lanes of several arrays run abreast"
)]

use super::{
    ClosedLoopSettings,
    controller::{Parameters, of_outputs},
    lanes::{LANES, Lanes, nothing},
    layers::{Gradient, Strided, Styled, Sums},
    layout::{INPUTS, Layout, OUTPUTS},
    world::{Batch, Row, World},
};
use crate::closed_loop::{MAX_ACCEL_MPS2, MIN_ACCEL_MPS2};
use maveric_laws::Real;
use pulp::{Arch, NullaryFnOnce};

impl<T: Real> World<T> {
    /// Hidden units: a number that is known when this is compiled, but for [`ANY`].
    #[inline(always)]
    fn hidden<const HIDDEN: usize>(&self) -> usize {
        if HIDDEN == ANY {
            self.layout.hidden
        } else {
            HIDDEN
        }
    }
}

/// Hidden units of the default settings.
const USUAL_HIDDEN: usize = ClosedLoopSettings::DEFAULT.hidden_units;
/// No number of hidden units in particular.
const ANY: usize = 0;

/// Where ego is in each lane.
#[derive(Clone, Copy)]
struct Ego<T> {
    gap_m: Lanes<T>,
    speed_mps: Lanes<T>,
}

impl<T: Real> Ego<T> {
    #[inline(always)]
    fn at_first(batch: &Batch<T>) -> Self {
        Self {
            gap_m: batch.rows[0].gap_m,
            speed_mps: batch.rows[0].speed_mps,
        }
    }

    /// How far from what was recorded.
    #[inline(always)]
    fn errors(&self, row: &Row<T>) -> Self {
        Self {
            gap_m: std::array::from_fn(|l| self.gap_m[l] - row.gap_m[l]),
            speed_mps: std::array::from_fn(|l| self.speed_mps[l] - row.speed_mps[l]),
        }
    }

    /// Moves on from one row to the next, by what the network's outputs stand for.
    #[inline(always)]
    fn advance(&mut self, world: &World<T>, asked: &Asked<T>, [row, next]: [&Row<T>; 2]) {
        // By value: so that the lanes of the loop run abreast.
        let (lead, lead_moved) = (row.lead_mps, next.lead_moved_m);
        let (mut gap, mut speed, asked) = (self.gap_m, self.speed_mps, asked.values);
        for l in 0..LANES {
            let parameters = Parameters::from_array(of_lane(&asked, l));
            let accel = parameters.accel_mps2(&world.safety, gap[l], speed[l], lead[l]);
            let (moved, next) = advance(speed[l], accel, world.step_s);
            gap[l] = gap[l] + lead_moved[l] - moved;
            speed[l] = next;
        }
        (self.gap_m, self.speed_mps) = (gap, speed);
    }
}

/// What the network asks of the controller in each lane, and how that changes with its outputs.
#[derive(Clone, Copy)]
struct Asked<T> {
    values: [Lanes<T>; OUTPUTS],
    slopes: [Lanes<T>; OUTPUTS],
}

impl<T: Real> Asked<T> {
    #[inline(always)]
    fn from_outputs(outputs: &[Lanes<T>; OUTPUTS]) -> Self {
        let [values, slopes] = of_outputs(outputs);
        Self { values, slopes }
    }
}

/// What a step leaves for the way back, beside what the layers made.
#[derive(Clone, Copy)]
struct Step<T> {
    ego: Ego<T>,
    asked: Asked<T>,
    /// After the step.
    errors: Ego<T>,
}

impl<T: Real> Step<T> {
    fn nothing() -> Self {
        let ego = Ego {
            gap_m: nothing(),
            speed_mps: nothing(),
        };
        let [values, slopes] = [[nothing(); OUTPUTS]; 2];
        Self {
            ego,
            asked: Asked { values, slopes },
            errors: ego,
        }
    }
}

/// What a way there leaves for the way back; asked for anew each time, it takes longer than to compute what it holds.
pub(super) struct Room<T> {
    steps: Vec<Step<T>>,
    /// What both layers made in each step.
    layers: Vec<Lanes<T>>,
    /// Gradients of some steps: see [`Sums::add_step`].
    kept: Vec<Lanes<T>>,
}

impl<T> Default for Room<T> {
    fn default() -> Self {
        Self {
            steps: Vec::new(),
            layers: Vec::new(),
            kept: Vec::new(),
        }
    }
}

/// Steps whose gradients are kept before the weights between layers gather them: no more than the nearest memory holds.
const TOGETHER: usize = 16;

/// Simulates the batch and goes back through it.
///
/// # Source
/// Backpropagation through time (Werbos 1990), over whole segments: the error of a gap reaches every command before it.
pub(super) fn gradient<T: Real>(
    world: &World<T>,
    weights: &[T],
    embeddings: &[T],
    batch: &Batch<T>,
    room: &mut Room<T>,
) -> Gradient {
    Arch::new().dispatch(ThereAndBack {
        world,
        weights,
        embeddings,
        batch,
        room,
    })
}

/// What is compiled for the processor it runs on: a closure that is called through a reference would not be inlined there.
struct ThereAndBack<'a, T> {
    world: &'a World<T>,
    weights: &'a [T],
    embeddings: &'a [T],
    batch: &'a Batch<T>,
    room: &'a mut Room<T>,
}

/// The network as its lanes are driven.
#[inline(always)]
fn styled<'a, T: Real>(
    layout: Layout,
    weights: &'a [T],
    embeddings: &[T],
    batch: &Batch<T>,
) -> Styled<'a, T> {
    let d = layout.embedding;
    let w = |lane: usize, k: usize| embeddings[batch.embeddings[lane] * d + k];
    Styled::new(layout, weights, w)
}

impl<T: Real> NullaryFnOnce for ThereAndBack<'_, T> {
    type Output = Gradient;

    #[inline(always)]
    fn call(self) -> Gradient {
        // Compiled apart for the usual number of hidden units: loops of known length are unrolled.
        match self.world.layout.hidden {
            USUAL_HIDDEN => self.through::<USUAL_HIDDEN>(),
            _ => self.through::<ANY>(),
        }
    }
}

impl<T: Real> ThereAndBack<'_, T> {
    #[inline(always)]
    fn through<const HIDDEN: usize>(self) -> Gradient {
        let Self {
            world,
            weights,
            embeddings,
            batch,
            room,
        } = self;
        let h = world.hidden::<HIDDEN>();
        let layout = world.layout;
        let mut out = Gradient::zero(layout.len(), embeddings.len());
        let network = styled(layout, weights, embeddings, batch);
        out.loss = there(h, world, &network, batch, room);
        let sums = back(h, world, &network, batch, room);
        sums.put(layout, weights, embeddings, &batch.embeddings, &mut out);
        out
    }
}

/// Simulates the batch onto the tape and gives the loss.
#[inline(always)]
fn there<T: Real>(
    h: usize,
    world: &World<T>,
    network: &Styled<'_, T>,
    batch: &Batch<T>,
    room: &mut Room<T>,
) -> f64 {
    let steps = batch.rows.len() - 1;
    room.steps.resize(steps, Step::nothing());
    room.layers.resize(2 * h * steps, nothing());
    let mut squares = nothing::<T, LANES>();
    let mut ego = Ego::at_first(batch);
    let tape = room
        .steps
        .iter_mut()
        .zip(room.layers.chunks_exact_mut(2 * h));
    for (rows, (step, layers)) in batch.rows.windows(2).zip(tape) {
        let (first, second) = layers.split_at_mut(h);
        let outputs = network.forward(h, &inputs(world, &ego.speed_mps), first, second);
        step.ego = ego;
        let wanted = Asked::from_outputs(&outputs);
        step.asked = wanted;
        ego.advance(world, &wanted, [&rows[0], &rows[1]]);
        let errors = ego.errors(&rows[1]);
        let (gap, speed) = (errors.gap_m, errors.speed_mps);
        let sums = squares;
        squares = std::array::from_fn(|l| {
            sums[l]
                + (world.gap_weight * gap[l] * gap[l] + world.speed_weight * speed[l] * speed[l])
        });
        step.errors = errors;
    }
    let weighted = batch.weights.iter().zip(&squares);
    let sum: f64 = weighted
        .map(|(weight, square)| weight * square.wide())
        .sum();
    sum / steps as f64
}

#[inline(always)]
fn of_lane<T: Real>(numbers: &[Lanes<T>; OUTPUTS], l: usize) -> [T; OUTPUTS] {
    let [a, b, c, d] = numbers;
    [a[l], b[l], c[l], d[l]]
}

/// Goes back over the tape from the last step to the first.
#[inline(always)]
fn back<T: Real>(
    h: usize,
    world: &World<T>,
    network: &Styled<'_, T>,
    batch: &Batch<T>,
    room: &mut Room<T>,
) -> Sums<T> {
    let steps = room.steps.len();
    room.kept.resize(TOGETHER * (OUTPUTS + h), nothing());
    let mut sums = Sums::zero(h);
    let (mut d_gap, mut d_speed) = (nothing::<T, LANES>(), nothing::<T, LANES>());
    let scale: Lanes<T> = batch.weights.map(|w| T::of(2.0 * w / steps as f64));
    let some = room
        .steps
        .chunks(TOGETHER)
        .zip(room.layers.chunks(TOGETHER * 2 * h));
    for (block, (steps, layers)) in some.enumerate().rev() {
        let kept = &mut room.kept[..steps.len() * (OUTPUTS + h)];
        let each = steps.iter().zip(layers.chunks_exact(2 * h)).enumerate();
        for (of_some, (step, layers)) in each.rev() {
            let Step { ego, asked, errors } = *step;
            let lead = batch.rows[block * TOGETHER + of_some].lead_mps;
            let [mut d_0, mut d_1, mut d_2, mut d_3] = [nothing::<T, LANES>(); OUTPUTS];
            let (values, slopes) = (asked.values, asked.slopes);
            for l in 0..LANES {
                d_gap[l] = d_gap[l] + scale[l] * world.gap_weight * errors.gap_m[l];
                d_speed[l] = d_speed[l] + scale[l] * world.speed_weight * errors.speed_mps[l];
                let parameters = Parameters::from_array(of_lane(&values, l));
                let (g, v, lead) = (ego.gap_m[l], ego.speed_mps[l], lead[l]);
                let accel = parameters.accel_mps2(&world.safety, g, v, lead);
                let (d_v, d_a) = advance_back(v, accel, world.step_s, -d_gap[l], d_speed[l]);
                let back = parameters.back(&world.safety, (g, v, lead), d_a);
                d_gap[l] = d_gap[l] + back.gap;
                d_speed[l] = d_v + back.speed;
                let slopes = of_lane(&slopes, l);
                let [p_0, p_1, p_2, p_3] = back.parameters;
                d_0[l] = p_0 * slopes[0];
                d_1[l] = p_1 * slopes[1];
                d_2[l] = p_2 * slopes[2];
                d_3[l] = p_3 * slopes[3];
            }
            let of_step = of_some * (OUTPUTS + h)..(of_some + 1) * (OUTPUTS + h);
            let d_inputs = sums.add_step(
                h,
                network,
                layers.split_at(h),
                &inputs(world, &ego.speed_mps),
                &[d_0, d_1, d_2, d_3],
                &mut kept[of_step],
            );
            for l in 0..LANES {
                d_speed[l] = d_speed[l] + d_inputs[0][l] / world.scaling.speed_sd_mps;
            }
        }
        let of_layer = |at| Strided {
            tape: layers,
            size: 2 * h,
            at,
        };
        sums.add_between(h, &of_layer(0), &of_layer(h), kept);
    }
    sums
}

/// Simulates the batch and gives what every lane adds to the errors whose squares make the loss: of each step that of the gap, then that
/// of the speed; each weighted so that they make it.
pub(super) fn errors<T: Real>(
    world: &World<T>,
    weights: &[T],
    embeddings: &[T],
    batch: &Batch<T>,
) -> Vec<Lanes<T>> {
    Arch::new().dispatch(There {
        world,
        weights,
        embeddings,
        batch,
    })
}

struct There<'a, T> {
    world: &'a World<T>,
    weights: &'a [T],
    embeddings: &'a [T],
    batch: &'a Batch<T>,
}

impl<T: Real> NullaryFnOnce for There<'_, T> {
    type Output = Vec<Lanes<T>>;

    #[inline(always)]
    fn call(self) -> Vec<Lanes<T>> {
        match self.world.layout.hidden {
            USUAL_HIDDEN => self.through::<USUAL_HIDDEN>(),
            _ => self.through::<ANY>(),
        }
    }
}

impl<T: Real> There<'_, T> {
    #[inline(always)]
    fn through<const HIDDEN: usize>(self) -> Vec<Lanes<T>> {
        let Self {
            world,
            weights,
            embeddings,
            batch,
        } = self;
        let (h, steps) = (world.hidden::<HIDDEN>(), batch.rows.len() - 1);
        let network = styled(world.layout, weights, embeddings, batch);
        let mut layers = vec![nothing(); 2 * h];
        let mut weighted = Vec::with_capacity(2 * steps);
        let root = |weight: T| -> Lanes<T> {
            batch
                .weights
                .map(|w| (T::of(w / steps as f64) * weight).sqrt())
        };
        let (by_gap, by_speed) = (root(world.gap_weight), root(world.speed_weight));
        let mut ego = Ego::at_first(batch);
        for rows in batch.rows.windows(2) {
            let (first, second) = layers.split_at_mut(h);
            let outputs = network.forward(h, &inputs(world, &ego.speed_mps), first, second);
            ego.advance(world, &Asked::from_outputs(&outputs), [&rows[0], &rows[1]]);
            let errors = ego.errors(&rows[1]);
            weighted.push(std::array::from_fn(|l| by_gap[l] * errors.gap_m[l]));
            weighted.push(std::array::from_fn(|l| by_speed[l] * errors.speed_mps[l]));
        }
        weighted
    }
}

#[inline(always)]
pub(super) fn inputs<T: Real, const N: usize>(
    world: &World<T>,
    speed: &Lanes<T, N>,
) -> [Lanes<T, N>; INPUTS] {
    let s = &world.scaling;
    [std::array::from_fn(|l| s.input(speed[l]))]
}

#[inline(always)]
fn within_bounds<T: Real>(wanted: T) -> T {
    // Not `max` and `min`, which hide what is no number.
    if wanted < T::of(MIN_ACCEL_MPS2) {
        T::of(MIN_ACCEL_MPS2)
    } else if wanted > T::of(MAX_ACCEL_MPS2) {
        T::of(MAX_ACCEL_MPS2)
    } else {
        wanted
    }
}

/// Distance moved and the next speed, as in [`simulate`](crate::simulate).
#[inline(always)]
fn advance<T: Real>(speed: T, wanted: T, step_s: T) -> (T, T) {
    let a = within_bounds(wanted);
    let next = speed + a * step_s;
    if next < T::of(0.0) {
        (speed * speed / (T::of(-2.0) * a), T::of(0.0))
    } else {
        (T::of(0.5) * (speed + next) * step_s, next)
    }
}

/// Derivatives by the speed and by the command, from those by the distance moved and by the next speed.
#[inline(always)]
fn advance_back<T: Real>(speed: T, wanted: T, step_s: T, d_moved: T, d_next: T) -> (T, T) {
    let a = within_bounds(wanted);
    let (d_speed, d_a) = if speed + a * step_s < T::of(0.0) {
        let stops = d_moved * speed / a;
        (-stops, stops * speed / (T::of(2.0) * a))
    } else {
        let half = T::of(0.5) * step_s * d_moved;
        (half + (d_next + half), (d_next + half) * step_s)
    };
    let free = wanted > T::of(MIN_ACCEL_MPS2) && wanted < T::of(MAX_ACCEL_MPS2);
    (d_speed, if free { d_a } else { T::of(0.0) })
}

#[cfg(test)]
mod tests;
