//! L1 to L5 of one driver's rows as a function of `w` alone, and their gradient.

use super::{
    encoded_rows::{EncodedRows, GridPart, Tile},
    frozen::{Frozen, HeadPass},
    lines::{Line, ROWS},
};
use crate::{
    damped_newton::Evaluated,
    losses::{
        Reading, Sum, Sums, cross_entropy, limited_log_sd, log_likelihood, normal, squared_error,
    },
    rows::Row,
};
use maveric_domain::AdbScore;
use rayon::prelude::*;
use std::sync::Mutex;

/// The losses of a drive's rows as a function of `w`.
#[derive(Debug)]
pub(crate) struct Fit<'a> {
    frozen: &'a Frozen,
    rows: EncodedRows,
    /// Standardised.
    adb: Option<f64>,
    /// Those that no thread is using.
    passes: Mutex<Vec<Pass>>,
}

/// Tiles that one thread takes at a time: fixed, so that sums do not depend on the number of threads.
const TILES_A_TASK: usize = 7;

/// What an evaluation is for, and so how much of it is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Depth {
    Value,
    Gradient,
    Curvature,
}

/// The objective at a point with all that its scatter over rows tells.
#[derive(Debug)]
pub(super) struct Close {
    pub(super) embedding_size: usize,
    pub(super) grid_rows: f64,
    pub(super) sums: Sums,
    pub(super) l4: Option<f64>,
    /// As in [`Fit::value`], shape `(d, d)`.
    pub(super) curvature: Vec<f64>,
    /// The gradient without L4, a row a block of time, shape `(blocks, d)`.
    pub(super) block_gradients: Vec<Vec<f64>>,
    /// The sum over rows of each row's gradient times itself, without L4, shape `(d, d)`.
    pub(super) squares: Vec<f64>,
}

/// One tile on its way through the heads.
#[derive(Debug)]
struct Pass {
    /// Of the evaluation under way.
    depth: Depth,
    following_distance: HeadPass,
    lane_change: HeadPass,
    velocity: HeadPass,
    mutual_information: HeadPass,
    probability: Line,
    /// How M's outputs change along each coordinate of `w`, shape `(d, 2 d)`.
    tangents: Vec<Vec<Line>>,
    /// By `w`, each row's own, shape `(d,)`.
    gradient: Vec<Line>,
    /// The curvature, summed over rows, shape `(d, d)`.
    curvature: Vec<f64>,
}

impl Pass {
    fn new(frozen: &Frozen) -> Self {
        let d = frozen.embedding_size();
        Self {
            depth: Depth::Value,
            following_distance: HeadPass::new(&frozen.following_distance),
            lane_change: HeadPass::new(&frozen.lane_change),
            velocity: HeadPass::new(&frozen.velocity),
            mutual_information: HeadPass::new(&frozen.mutual_information),
            probability: Line::ZERO,
            tangents: vec![vec![Line::ZERO; 2 * d]; d],
            gradient: vec![Line::ZERO; d],
            curvature: vec![0.0; d * d],
        }
    }

    /// How P(change) changes along coordinate `i` of `w`.
    fn probability_along(&self, i: usize) -> Line {
        let by_logit = &self.lane_change.by_moving[i].0;
        Line(std::array::from_fn(|row| {
            let p = self.probability.0[row];
            p * (1.0 - p) * by_logit[row]
        }))
    }

    /// The gradient over the tile's rows, shape `(d,)`.
    fn summed_gradient(&self) -> Vec<f64> {
        let along = |line: &Line| line.0.iter().map(|&g| f64::from(g)).sum();
        self.gradient.iter().map(along).collect()
    }

    /// Adds a row's part of the loss that depends on `w` through one number: its slope and bend by that number, and how the
    /// number changes along each coordinate.
    fn add(&mut self, row: usize, [slope, bend]: [f64; 2], along: impl Fn(&Self, usize) -> f64) {
        let d = self.gradient.len();
        for i in 0..d {
            let a = along(self, i);
            self.gradient[i].0[row] += (slope * a) as f32;
            if self.depth < Depth::Curvature {
                continue;
            }
            for j in 0..=i {
                let both = bend * a * along(self, j);
                self.curvature[i * d + j] += both;
                if j < i {
                    self.curvature[j * d + i] += both;
                }
            }
        }
    }
}

/// What is alike in every row once `w` is given.
struct At {
    following_distance: Vec<f32>,
    lane_change: Vec<f32>,
    velocity: Vec<f32>,
    aggression: f64,
    /// `w` in the coordinates of M.
    raw: Vec<f64>,
}

impl At {
    fn new(frozen: &Frozen, w: &[f64]) -> Self {
        Self {
            following_distance: frozen.following_distance.moving.product(w),
            lane_change: frozen.lane_change.moving.product(w),
            velocity: frozen.velocity.moving.product(w),
            aggression: frozen.aggression(w),
            raw: frozen.whitening.undo(w),
        }
    }
}

impl<'a> Fit<'a> {
    /// Encodes `rows`; `rows_per_block` of them on the grid make one of [`Close::block_gradients`].
    pub(super) fn with_blocks(
        frozen: &'a Frozen,
        rows: &[Row],
        adb: Option<AdbScore>,
        rows_per_block: usize,
    ) -> Self {
        let scaling = frozen.scaling.aggression;
        let rows = EncodedRows::new(frozen, rows, rows_per_block);
        Self {
            passes: Mutex::default(),
            adb: adb.map(|score| scaling.apply(score.points())),
            rows,
            frozen,
        }
    }

    #[cfg(test)]
    pub(crate) fn new(frozen: &'a Frozen, rows: &[Row], adb: Option<AdbScore>) -> Self {
        Self::with_blocks(frozen, rows, adb, usize::MAX)
    }

    pub(super) fn frozen(&self) -> &Frozen {
        self.frozen
    }

    /// Runs every tile at `w` and reads something off each, with its rows' gradients, without L4; in the tiles' order.
    fn each<R: Send>(
        &self,
        w: &[f64],
        depth: Depth,
        read: impl Fn(&Tile, &Pass) -> R + Sync,
    ) -> (Sums, Vec<R>) {
        let frozen = self.frozen;
        let at = At::new(frozen, w);
        let scale = 1.0 / self.rows.grid_rows;
        let run = |tiles: &[Tile]| -> Vec<(Sums, R)> {
            let idle = self.passes.lock().ok().and_then(|mut idle| idle.pop());
            let mut pass = idle.unwrap_or_else(|| Pass::new(frozen));
            let one = |tile| {
                let sums = evaluate(frozen, &at, tile, (scale, depth), &mut pass);
                (sums, read(tile, &pass))
            };
            let results = tiles.iter().map(one).collect();
            if let Ok(mut idle) = self.passes.lock() {
                idle.push(pass);
            }
            results
        };
        let chunks = self.rows.tiles.par_chunks(TILES_A_TASK);
        let chunks: Vec<Vec<(Sums, R)>> = chunks.map(run).collect();
        let mut total = Sums::default();
        let mut results = Vec::with_capacity(self.rows.tiles.len());
        for (sums, result) in chunks.into_iter().flatten() {
            total.merge(&sums);
            results.push(result);
        }
        (total, results)
    }

    /// L4, unweighted.
    fn l4(&self, w: &[f64]) -> Option<f64> {
        self.adb
            .map(|score| (self.frozen.aggression(w) - score).powi(2))
    }

    /// Sums over all rows, and L4.
    pub(crate) fn sums(&self, w: &[f64]) -> (Sums, Option<f64>) {
        let (sums, _) = self.each(w, Depth::Value, |_, _| ());
        (sums, self.l4(w))
    }

    /// The objective and its gradient, without a curvature.
    pub(super) fn slope(&self, w: &[f64]) -> Evaluated {
        let (sums, tiles) = self.each(w, Depth::Gradient, |_, pass| pass.summed_gradient());
        let gradient = total(tiles.iter().map(Vec::as_slice), w.len());
        self.with_l4(w, &sums, gradient, Vec::new())
    }

    /// The objective, its gradient, and Gauss's and Newton's idea of its curvature.
    pub(super) fn value(&self, w: &[f64]) -> Evaluated {
        let d = w.len();
        let (sums, tiles) = self.each(w, Depth::Curvature, |_, pass| {
            (pass.summed_gradient(), pass.curvature.clone())
        });
        let gradient = total(tiles.iter().map(|(g, _)| g.as_slice()), d);
        let curvature = total(tiles.iter().map(|(_, c)| c.as_slice()), d * d);
        self.with_l4(w, &sums, gradient, curvature)
    }

    /// The objective from what the rows add to it; `curvature` may be empty.
    fn with_l4(
        &self,
        w: &[f64],
        sums: &Sums,
        mut gradient: Vec<f64>,
        mut curvature: Vec<f64>,
    ) -> Evaluated {
        let weights = &self.frozen.weights;
        let mut value = sums.weighted(weights) / self.rows.grid_rows;
        if let (Some(l4), Some(score)) = (self.l4(w), self.adb) {
            let twice = 2.0 * weights.aggression;
            value += weights.aggression * l4;
            let slope = twice * (self.frozen.aggression(w) - score);
            let s = &self.frozen.style.0;
            for (to, s) in gradient.iter_mut().zip(s) {
                *to += slope * s;
            }
            let pairs = s.iter().flat_map(|a| s.iter().map(move |b| a * b));
            for (to, both) in curvature.iter_mut().zip(pairs) {
                *to += twice * both;
            }
        }
        Evaluated {
            value,
            gradient,
            curvature,
        }
    }

    /// All of it at `w` in one evaluation.
    pub(super) fn close(&self, w: &[f64]) -> Close {
        let d = w.len();
        let (sums, tiles) = self.each(w, Depth::Curvature, |tile, pass| {
            (tile.block, pass.gradient.clone(), pass.curvature.clone())
        });
        let mut blocks = vec![vec![0.0; d]; self.rows.blocks];
        let mut squares = vec![0.0; d * d];
        for (block_of, gradient, _) in &tiles {
            for (row, &block) in block_of.iter().enumerate() {
                let of_row = |i: usize| f64::from(gradient[i].0[row]);
                for i in 0..d {
                    if let Some(to) = blocks.get_mut(block) {
                        to[i] += of_row(i);
                    }
                    for j in 0..d {
                        squares[i * d + j] += of_row(i) * of_row(j);
                    }
                }
            }
        }
        let curvature = total(tiles.iter().map(|(_, _, c)| c.as_slice()), d * d);
        Close {
            embedding_size: d,
            grid_rows: self.rows.grid_rows,
            l4: self.l4(w),
            curvature: self.with_l4(w, &sums, vec![0.0; d], curvature).curvature,
            sums,
            block_gradients: blocks,
            squares,
        }
    }

    /// Mean of M's μ over the grid rows, read at `w`, in whitened coordinates.
    pub(super) fn reading(&self, w: &[f64]) -> Vec<f64> {
        let grid_rows = self.rows.grid_rows;
        let (_, tiles) = self.each(w, Depth::Value, |tile, pass| -> Vec<f64> {
            let mean = |line: &Line| {
                let weighted = line.0.iter().zip(&tile.weights[3].0);
                weighted
                    .map(|(&m, &c)| f64::from(m) * f64::from(c))
                    .sum::<f64>()
                    / grid_rows
            };
            let lines = &pass.mutual_information.output[..w.len()];
            // M is not run on tiles that are there for their lane changes alone; their weights are 0.
            lines.iter().map(mean).collect()
        });
        let tiles = tiles.iter().map(Vec::as_slice);
        self.frozen.whitening.apply(&total(tiles, w.len()))
    }
}

/// Sum of vectors of length `n`, in order.
fn total<'a>(parts: impl Iterator<Item = &'a [f64]>, n: usize) -> Vec<f64> {
    let mut sum = vec![0.0; n];
    for part in parts {
        for (to, x) in sum.iter_mut().zip(part) {
            *to += x;
        }
    }
    sum
}

/// The losses of one tile; leaves each row's gradient and the curvature by `w`, times `scale`, in `pass`, as far as `depth`
/// goes.
fn evaluate(
    frozen: &Frozen,
    at: &At,
    tile: &Tile,
    (scale, depth): (f64, Depth),
    pass: &mut Pass,
) -> Sums {
    let mut sums = Sums::default();
    let weights = &frozen.weights;
    pass.depth = depth;
    let slopes = depth >= Depth::Gradient;
    pass.gradient.fill(Line::ZERO);
    pass.curvature.fill(0.0);
    let head = &frozen.lane_change;
    head.forward_shifted(&tile.lane_change, &at.lane_change, &mut pass.lane_change);
    // Softmax and cross-entropy see the logits' difference alone.
    if slopes {
        head.backward(&[-1.0, 1.0], &mut pass.lane_change);
    }
    sums.lane_change = lane_change(tile, weights.lane_change * scale, pass);
    if let Some(grid) = &tile.grid {
        let head = &frozen.following_distance;
        let of_head = &mut pass.following_distance;
        head.forward_shifted(&grid.following_distance, &at.following_distance, of_head);
        if slopes {
            head.backward(&[1.0], of_head);
        }
        let head = &frozen.velocity;
        head.forward_shifted(&grid.velocity, &at.velocity, &mut pass.velocity);
        if slopes {
            head.backward(&[1.0], &mut pass.velocity);
        }
        sums.following_distance = squared(
            (tile, 0),
            weights.following_distance * scale,
            pass,
            |pass| &pass.following_distance,
        );
        sums.velocity = squared((tile, 2), weights.velocity * scale, pass, |pass| {
            &pass.velocity
        });
        if weights.mutual_information > 0.0 {
            mutual_information(frozen, at, (tile, grid), scale, &mut sums, pass);
        }
    }
    sums
}

/// L1 or L3.
fn squared(
    (tile, index): (&Tile, usize),
    weight: f64,
    pass: &mut Pass,
    head: impl Fn(&Pass) -> &HeadPass,
) -> Sum {
    let mut sum = Sum::default();
    for row in 0..ROWS {
        let c = f64::from(tile.weights[index].0[row]);
        let (found, target) = (head(pass).output[0].0[row], tile.targets[index].0[row]);
        let (loss, slope) = squared_error(f64::from(found), f64::from(target), c * weight);
        sum.add(loss, c);
        if c > 0.0 && pass.depth >= Depth::Gradient {
            pass.add(row, [slope, 2.0 * c * weight], |pass, i| {
                f64::from(head(pass).by_moving[i].0[row])
            });
        }
    }
    sum
}

/// L2; fills P.
fn lane_change(tile: &Tile, weight: f64, pass: &mut Pass) -> Sum {
    let mut sum = Sum::default();
    for row in 0..ROWS {
        let c = f64::from(tile.weights[1].0[row]);
        let logit = |i: usize| f64::from(pass.lane_change.output[i].0[row]);
        let (keep, change) = (logit(0), logit(1));
        let p = 1.0 / (1.0 + (keep - change).exp());
        let target = f64::from(tile.targets[1].0[row]);
        let (loss, [_, slope]) = cross_entropy(keep, change, p, target, c * weight);
        pass.probability.0[row] = p as f32;
        sum.add(loss, c);
        if c > 0.0 && pass.depth >= Depth::Gradient {
            pass.add(row, [slope, c * weight * p * (1.0 - p)], |pass, i| {
                f64::from(pass.lane_change.by_moving[i].0[row])
            });
        }
    }
    sum
}

/// M and how it changes with `w` through the four outputs it reads, and L5.
fn mutual_information(
    frozen: &Frozen,
    at: &At,
    (tile, grid): (&Tile, &GridPart),
    scale: f64,
    sums: &mut Sums,
    pass: &mut Pass,
) {
    let d = at.raw.len();
    let head = &frozen.mutual_information;
    let outputs = [
        pass.following_distance.output[0],
        pass.probability,
        pass.velocity.output[0],
        Line([at.aggression as f32; ROWS]),
    ];
    head.forward(
        &grid.mutual_information,
        &outputs,
        &mut pass.mutual_information,
    );
    if pass.depth == Depth::Curvature {
        tangents(frozen, pass);
    }
    let root = &frozen.whitening.root;
    let share = frozen.weights.mutual_information * scale / d as f64;
    for row in 0..ROWS {
        let c = f64::from(tile.weights[3].0[row]);
        let (mut loss, mut likelihood) = (0.0, 0.0);
        for (k, &target) in at.raw.iter().enumerate() {
            let output = &pass.mutual_information.output;
            let mean = f64::from(output[k].0[row]);
            let log_sd = f64::from(output[d + k].0[row]);
            let (one, slope) = normal(frozen.reading, [mean, log_sd, 0.0, target], c * share);
            loss += one;
            likelihood += log_likelihood(mean, log_sd, target);
            if pass.depth < Depth::Curvature {
                // Of weight 0 in rows past the data.
                pass.mutual_information.seeds[k].0[row] = slope.mean as f32;
                pass.mutual_information.seeds[d + k].0[row] = slope.log_sd as f32;
                continue;
            }
            if c <= 0.0 {
                continue;
            }
            let (limited, moves) = limited_log_sd(log_sd);
            let variance = (2.0 * limited).exp();
            let [by_mean, by_log_sd] = match frozen.reading {
                Reading::Sample | Reading::Expected => [2.0, 4.0 * variance],
                // Fisher's information, where second derivatives can be negative.
                Reading::Likelihood => [1.0 / variance, 2.0],
            };
            // μ − w, in M's coordinates: the slopes by μ and by w are one, but for the sign.
            pass.add(row, [slope.mean, by_mean * c * share], |pass, i| {
                f64::from(pass.tangents[i][k].0[row]) - root[k * d + i]
            });
            pass.add(
                row,
                [slope.log_sd, by_log_sd * c * share * moves],
                |pass, i| f64::from(pass.tangents[i][d + k].0[row]),
            );
        }
        sums.mutual_information.add(loss / d as f64, c);
        sums.log_likelihood.add(likelihood, c);
    }
    if pass.depth == Depth::Gradient {
        through_outputs(frozen, pass);
    }
}

/// How M's outputs change along each coordinate of `w`, through the four outputs it reads.
fn tangents(frozen: &Frozen, pass: &mut Pass) {
    for i in 0..pass.gradient.len() {
        let tangent = [
            pass.following_distance.by_moving[i],
            pass.probability_along(i),
            pass.velocity.by_moving[i],
            Line([frozen.style.0[i] as f32; ROWS]),
        ];
        frozen.mutual_information.tangent(
            &tangent,
            &mut pass.mutual_information,
            &mut pass.tangents[i],
        );
    }
}

/// Adds L5's gradient, given its slopes by M's outputs as seeds: one way back through M instead of d ways along.
fn through_outputs(frozen: &Frozen, pass: &mut Pass) {
    let d = pass.gradient.len();
    frozen
        .mutual_information
        .backward_of_seeds(&mut pass.mutual_information);
    for i in 0..d {
        let by_probability = pass.probability_along(i);
        let of_m = &pass.mutual_information;
        let inputs = [
            &pass.following_distance.by_moving[i],
            &by_probability,
            &pass.velocity.by_moving[i],
        ];
        for row in 0..ROWS {
            let mut slope = of_m.by_moving[3].0[row] * frozen.style.0[i] as f32;
            for (by_input, input) in of_m.by_moving.iter().zip(inputs) {
                slope += by_input.0[row] * input.0[row];
            }
            // μ − w, in M's coordinates: the slopes by μ and by w are one, but for the sign.
            for (k, seed) in of_m.seeds[..d].iter().enumerate() {
                slope -= seed.0[row] * frozen.whitening.root[k * d + i] as f32;
            }
            pass.gradient[i].0[row] += slope;
        }
    }
}

#[cfg(test)]
mod tests;
