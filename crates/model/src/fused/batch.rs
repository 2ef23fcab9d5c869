//! A batch in lanes: whoever computes them, their sums are taken in the lanes' order.

use super::{
    layout::Layout,
    matrix::{Aligned, Matrix},
    product::AddTo,
    roster::Roster,
    through::{self, Gradients, Shared},
    tile::{self, Predicted, Tile},
};
use crate::{
    losses::{LossWeights, Reading, Sums},
    network::Networks,
    windows::SIGNALS,
};
use pulp::Arch;
use rayon::prelude::*;
use std::ops::Range;

/// A lane has about this many rows, ...
const LANE_ROWS: usize = 128;
/// ... and a batch no more lanes than this: each has gradients of its own.
const MOST_LANES: usize = 8;

/// A part of a batch that one thread goes through tile by tile.
#[derive(Debug)]
struct Lane {
    tile: Tile,
    gradient: Aligned,
    lines: Matrix,
    narrow: Aligned,
    sums: Sums,
    predicted: Vec<Predicted>,
}

/// The gradient of the losses over batches of rows.
#[derive(Debug)]
pub(crate) struct Batches {
    arch: Arch,
    pub(crate) layout: Layout,
    roster: Roster,
    lanes: Vec<Lane>,
    derived: Aligned,
    /// Most rows of a batch.
    most: usize,
    /// By the packed parameters, of the last batch.
    pub(crate) gradient: Aligned,
    /// By the embeddings, shape `(drivers, d)`.
    pub(crate) embedding_gradient: Vec<f32>,
}

/// What a batch is evaluated at.
#[derive(Debug, Clone, Copy)]
pub(crate) struct At<'a> {
    pub(crate) packed: &'a [f32],
    /// Shape `(drivers, d)`.
    pub(crate) embeddings: &'a [f32],
    pub(crate) weights: LossWeights,
    pub(crate) reading: Reading,
}

fn part(whole: usize, index: usize, parts: usize) -> Range<usize> {
    index * whole / parts..(index + 1) * whole / parts
}

fn lanes_of(rows: usize) -> usize {
    (rows / LANE_ROWS).clamp(1, MOST_LANES)
}

impl Batches {
    /// Room for batches of at most `most` rows of `drivers` drivers.
    pub(crate) fn new(arch: Arch, networks: &Networks, drivers: usize, most: usize) -> Self {
        let layout = Layout::new(networks);
        let a = networks.architecture;
        let d = a.embedding_size;
        let roster = Roster::new(&layout, d, drivers, most);
        let lane = |_| Lane {
            tile: Tile::new(&layout, d, SIGNALS * a.window_steps),
            gradient: Aligned::zeros(layout.packed),
            lines: Matrix::zeros(drivers.min(most), roster.columns.all),
            narrow: Aligned::zeros(through::narrow_room(&layout)),
            sums: Sums::default(),
            predicted: Vec::new(),
        };
        Self {
            arch,
            lanes: (0..lanes_of(most)).map(lane).collect(),
            derived: Aligned::zeros(layout.derived),
            gradient: Aligned::zeros(layout.packed),
            embedding_gradient: vec![0.0; drivers * d],
            roster,
            layout,
            most: most.max(1),
        }
    }

    /// The losses of a batch; leaves their gradients in [`Self::gradient`] and [`Self::embedding_gradient`].
    ///
    /// `driver_of` is asked for a row's driver; `fill` puts consecutive rows of the batch into a tile.
    pub(crate) fn evaluate(
        &mut self,
        at: &At<'_>,
        rows: usize,
        driver_of: impl Fn(usize) -> u32 + Sync,
        fill: impl Fn(&mut Tile, Range<usize>) + Sync,
    ) -> Sums {
        self.layout.derive(at.packed, &mut self.derived);
        let lanes = self.each_tile(at, rows, driver_of, fill, |tile, shared, to, _| {
            tile.backward(shared, to);
        });
        self.reduce(lanes)
    }

    /// The losses of any number of rows and the predictions for them; as [`Self::evaluate`] without gradients.
    pub(crate) fn predict(
        &mut self,
        at: &At<'_>,
        rows: usize,
        driver_of: impl Fn(usize) -> u32 + Sync,
        fill: impl Fn(&mut Tile, Range<usize>) + Sync,
    ) -> (Sums, Vec<Predicted>) {
        let mut sums = Sums::default();
        let mut predicted = Vec::with_capacity(rows);
        for first in (0..rows).step_by(self.most) {
            let count = self.most.min(rows - first);
            let lanes = self.each_tile(
                at,
                count,
                |row| driver_of(first + row),
                |tile, rows| fill(tile, first + rows.start..first + rows.end),
                |tile, shared, _, predicted| predicted.extend(tile.predicted(shared.layout)),
            );
            for lane in &mut self.lanes[..lanes] {
                sums.merge(&lane.sums);
                predicted.append(&mut lane.predicted);
            }
        }
        (sums, predicted)
    }

    /// Takes every tile of a batch forward and gives it to `then`; the lanes used.
    fn each_tile(
        &mut self,
        at: &At<'_>,
        rows: usize,
        driver_of: impl Fn(usize) -> u32 + Sync,
        fill: impl Fn(&mut Tile, Range<usize>) + Sync,
        then: impl Fn(&mut Tile, &Shared<'_>, &mut Gradients<'_>, &mut Vec<Predicted>) + Sync,
    ) -> usize {
        let arch = self.arch;
        let (layout, roster) = (&self.layout, &mut self.roster);
        let drivers = (0..rows).map(&driver_of);
        roster.gather(arch, layout, at.packed, drivers, at.embeddings);
        let shared = Shared {
            arch,
            layout,
            packed: at.packed,
            derived: &self.derived,
            roster,
            weights: at.weights,
            reading: at.reading,
            scale: 1.0 / rows as f64,
        };
        let lanes = lanes_of(rows).min(self.lanes.len());
        let work = self.lanes[..lanes].par_iter_mut().enumerate();
        work.for_each(|(index, lane)| {
            lane.gradient.fill(0.0);
            let lines = shared.roster.drivers() * lane.lines.width;
            lane.lines.all_mut()[..lines].fill(0.0);
            lane.sums = Sums::default();
            let range = part(rows, index, lanes);
            let tiles = range.len().div_ceil(tile::ROWS);
            for number in 0..tiles {
                let within = part(range.len(), number, tiles);
                let rows = range.start + within.start..range.start + within.end;
                for (place, row) in lane.tile.place.iter_mut().zip(rows.clone()) {
                    *place = shared.roster.place(driver_of(row));
                }
                lane.tile.set_rows(rows.len());
                fill(&mut lane.tile, rows);
                lane.sums.merge(&lane.tile.forward(&shared));
                let mut to = Gradients {
                    packed: &mut lane.gradient,
                    lines: &mut lane.lines,
                    narrow: &mut lane.narrow,
                };
                then(&mut lane.tile, &shared, &mut to, &mut lane.predicted);
            }
        });
        lanes
    }

    /// Sums over the lanes, in their order.
    fn reduce(&mut self, lanes: usize) -> Sums {
        let arch = self.arch;
        let mut sums = Sums::default();
        let lines = self.roster.drivers() * self.roster.columns.all;
        self.gradient.fill(0.0);
        self.embedding_gradient.fill(0.0);
        let Some((first, others)) = self.lanes[..lanes].split_first_mut() else {
            return sums;
        };
        sums.merge(&first.sums);
        self.gradient.copy_from_slice(&first.gradient);
        for lane in others {
            sums.merge(&lane.sums);
            arch.dispatch(AddTo { to: &mut self.gradient, from: &lane.gradient });
            arch.dispatch(AddTo {
                to: &mut first.lines.all_mut()[..lines],
                from: &lane.lines.all()[..lines],
            });
        }
        self.roster.scatter(
            arch,
            &self.layout,
            &self.derived,
            &first.lines,
            &mut self.gradient,
            &mut self.embedding_gradient,
        );
        sums
    }
}
