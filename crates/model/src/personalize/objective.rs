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

/// The losses of a drive's rows as a function of `w`.
#[derive(Debug)]
pub(crate) struct Fit<'a> {
    frozen: &'a Frozen,
    rows: EncodedRows,
    /// Standardised.
    adb: Option<f64>,
    /// One for each task of [`TILES_A_TASK`] tiles.
    passes: Vec<Pass>,
}

/// Tiles that one thread takes at a time: fixed, so that sums do not depend on the number of threads.
const TILES_A_TASK: usize = 7;

/// One tile on its way through the heads.
#[derive(Debug)]
struct Pass {
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

    /// Adds a row's part of the loss that depends on `w` through one number: its slope and bend by that number, and how the
    /// number changes along each coordinate.
    fn add(&mut self, row: usize, [slope, bend]: [f64; 2], along: impl Fn(&Self, usize) -> f64) {
        let d = self.gradient.len();
        for i in 0..d {
            let a = along(self, i);
            self.gradient[i].0[row] += (slope * a) as f32;
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
    /// Encodes `rows`; `rows_per_block` of them on the grid make one of [`Fit::block_gradients`].
    pub(super) fn with_blocks(
        frozen: &'a Frozen,
        rows: &[Row],
        adb: Option<AdbScore>,
        rows_per_block: usize,
    ) -> Self {
        let scaling = frozen.scaling.aggression;
        let rows = EncodedRows::new(frozen, rows, rows_per_block);
        let tasks = rows.tiles.len().div_ceil(TILES_A_TASK).max(1);
        Self {
            passes: (0..tasks).map(|_| Pass::new(frozen)).collect(),
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

    pub(super) fn grid_rows(&self) -> f64 {
        self.rows.grid_rows
    }

    /// Runs every tile at `w` and reads something off each, with its rows' gradients, without L4; in the tiles' order.
    fn each<R: Send>(
        &mut self,
        w: &[f64],
        read: impl Fn(&Tile, &Pass) -> R + Sync,
    ) -> (Sums, Vec<R>) {
        let frozen = self.frozen;
        let at = At::new(frozen, w);
        let scale = 1.0 / self.rows.grid_rows;
        let run = |tiles: &[Tile], pass: &mut Pass| -> Vec<(Sums, R)> {
            let one = |tile| {
                let sums = evaluate(frozen, &at, tile, scale, pass);
                (sums, read(tile, pass))
            };
            tiles.iter().map(one).collect()
        };
        let chunks: Vec<Vec<(Sums, R)>> = match self.passes.as_mut_slice() {
            [only] => vec![run(&self.rows.tiles, only)],
            passes => self
                .rows
                .tiles
                .par_chunks(TILES_A_TASK)
                .zip(passes)
                .map(|(tiles, pass)| run(tiles, pass))
                .collect(),
        };
        let mut total = Sums::default();
        let mut results = Vec::with_capacity(self.rows.tiles.len());
        for (sums, result) in chunks.into_iter().flatten() {
            total.merge(&sums);
            results.push(result);
        }
        (total, results)
    }

    /// Sums over all rows, gradient and curvature by `w` without L4, and L4.
    fn at(&mut self, w: &[f64]) -> (Sums, Vec<f64>, Vec<f64>, Option<f64>) {
        let d = w.len();
        let (sums, tiles) = self.each(w, |_, pass| {
            let along = |line: &Line| line.0.iter().map(|&g| f64::from(g)).sum();
            let gradient: Vec<f64> = pass.gradient.iter().map(along).collect();
            (gradient, pass.curvature.clone())
        });
        let l4 = self
            .adb
            .map(|score| (self.frozen.aggression(w) - score).powi(2));
        let gradient = total(tiles.iter().map(|(g, _)| g.as_slice()), d);
        let curvature = total(tiles.iter().map(|(_, c)| c.as_slice()), d * d);
        (sums, gradient, curvature, l4)
    }

    /// Sums over all rows, the gradient by `w` without L4, and L4.
    pub(crate) fn sums(&mut self, w: &[f64]) -> (Sums, Vec<f64>, Option<f64>) {
        let (sums, gradient, _, l4) = self.at(w);
        (sums, gradient, l4)
    }

    /// The objective, its gradient, and Gauss's and Newton's idea of its curvature.
    pub(super) fn value(&mut self, w: &[f64]) -> Evaluated {
        let (sums, mut gradient, mut curvature, l4) = self.at(w);
        let d = w.len();
        let weights = &self.frozen.weights;
        let mut value = sums.weighted(weights) / self.rows.grid_rows;
        if let (Some(l4), Some(score)) = (l4, self.adb) {
            let twice = 2.0 * weights.aggression;
            value += weights.aggression * l4;
            let slope = twice * (self.frozen.aggression(w) - score);
            let s = &self.frozen.style.0;
            for i in 0..d {
                gradient[i] += slope * s[i];
                for j in 0..d {
                    curvature[i * d + j] += twice * s[i] * s[j];
                }
            }
        }
        Evaluated {
            value,
            gradient,
            curvature,
        }
    }

    /// The gradient without L4, a row a block of time, shape `(blocks, d)`, and the sum over rows of each row's
    /// gradient times itself, shape `(d, d)`.
    pub(super) fn block_gradients(&mut self, w: &[f64]) -> (Vec<Vec<f64>>, Vec<f64>) {
        let d = w.len();
        let (_, tiles) = self.each(w, |tile, pass| (tile.block, pass.gradient.clone()));
        let mut blocks = vec![vec![0.0; d]; self.rows.blocks];
        let mut squares = vec![0.0; d * d];
        for (block_of, gradient) in tiles {
            for (row, block) in block_of.into_iter().enumerate() {
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
        (blocks, squares)
    }

    /// Mean of M's μ over the grid rows, read at `w`, in whitened coordinates.
    pub(super) fn reading(&mut self, w: &[f64]) -> Vec<f64> {
        let grid_rows = self.rows.grid_rows;
        let (_, tiles) = self.each(w, |tile, pass| -> Vec<f64> {
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

/// The losses of one tile; leaves each row's gradient and the curvature by `w`, times `scale`, in `pass`.
fn evaluate(frozen: &Frozen, at: &At, tile: &Tile, scale: f64, pass: &mut Pass) -> Sums {
    let mut sums = Sums::default();
    let weights = &frozen.weights;
    pass.gradient.fill(Line::ZERO);
    pass.curvature.fill(0.0);
    let head = &frozen.lane_change;
    head.forward_shifted(&tile.lane_change, &at.lane_change, &mut pass.lane_change);
    // Softmax and cross-entropy see the logits' difference alone.
    head.backward(&[-1.0, 1.0], &mut pass.lane_change);
    sums.lane_change = lane_change(tile, weights.lane_change * scale, pass);
    if let Some(grid) = &tile.grid {
        let head = &frozen.following_distance;
        let of_head = &mut pass.following_distance;
        head.forward_shifted(&grid.following_distance, &at.following_distance, of_head);
        head.backward(&[1.0], of_head);
        let head = &frozen.velocity;
        head.forward_shifted(&grid.velocity, &at.velocity, &mut pass.velocity);
        head.backward(&[1.0], &mut pass.velocity);
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
        if c > 0.0 {
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
        if c > 0.0 {
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
    for i in 0..d {
        let by_logit = &pass.lane_change.by_moving[i].0;
        let by_probability = std::array::from_fn(|row| {
            let p = pass.probability.0[row];
            p * (1.0 - p) * by_logit[row]
        });
        let tangent = [
            pass.following_distance.by_moving[i],
            Line(by_probability),
            pass.velocity.by_moving[i],
            Line([frozen.style.0[i] as f32; ROWS]),
        ];
        head.tangent(
            &tangent,
            &mut pass.mutual_information,
            &mut pass.tangents[i],
        );
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        linear_algebra::dot,
        personalize::reference::{Problem, Reference},
    };

    #[test]
    fn value_and_gradient_are_those_of_plain_loops_in_double_precision() {
        for problem in Problem::all() {
            let frozen = Frozen::of(&problem.model);
            let mut fit = Fit::new(&frozen, &problem.rows, problem.adb);
            let reference = Reference::new(&problem.model, &problem.rows, problem.adb);
            for w in problem.points() {
                let found = fit.value(&w);
                let expected = reference.value(&w);
                assert!(
                    (found.value - expected).abs() < 1e-5 * (1.0 + expected.abs()),
                    "{}: {} {expected}",
                    problem.name,
                    found.value
                );
                for (i, slope) in found.gradient.iter().enumerate() {
                    let numeric = reference.slope(&w, i);
                    assert!(
                        (slope - numeric).abs()
                            < 1e-3 * (1.0 + dot(&found.gradient, &found.gradient).sqrt()),
                        "{}: {slope} {numeric}",
                        problem.name
                    );
                }
            }
        }
    }

    #[test]
    fn blocks_share_out_the_whole_gradient() {
        let problem = Problem::all().remove(0);
        let frozen = Frozen::of(&problem.model);
        let mut fit = Fit::with_blocks(&frozen, &problem.rows, None, 20);
        let w = [0.2, -0.4, 0.1];
        let (blocks, _) = fit.block_gradients(&w);
        let (_, gradient, _) = fit.sums(&w);
        assert_eq!(blocks.len(), (fit.grid_rows() / 20.0).ceil() as usize);
        for (i, whole) in gradient.iter().enumerate() {
            let sum: f64 = blocks.iter().map(|b| b[i]).sum();
            assert!((sum - whole).abs() < 1e-9 * (1.0 + whole.abs()));
        }
    }
}
