//! The drivers of a batch: what the first layers make of each one's `w`, and where the gradients of that gather.
//!
//! A line is `[F's first sums | C's | V's | ŝ, w]`: a row of data starts its first layers from its driver's line
//! instead of multiplying `w`, and adds its gradients to the same places of the driver's line of gradients.

use super::{
    layout::{Layer, Layout},
    matrix::{Matrix, View, padded},
    product::{OuterSums, Plain, RowsTimes, Start},
};
use pulp::Arch;

const ABSENT: u32 = u32::MAX;

/// Columns of a line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Columns {
    pub(crate) following_distance: usize,
    pub(crate) lane_change: usize,
    pub(crate) velocity: usize,
    /// ŝ, of which all padded outputs are computed, then `w` from the next vector on.
    pub(crate) aggression: usize,
    pub(crate) embedding: usize,
    pub(crate) all: usize,
}

impl Columns {
    fn new(layout: &Layout, d: usize) -> Self {
        let lane_change = layout.following_distance[0].width;
        let velocity = lane_change + layout.lane_head[0].width;
        let aggression = velocity + layout.speed_head[0].width;
        let embedding = aggression + layout.style[0].width;
        Self {
            following_distance: 0,
            lane_change,
            velocity,
            aggression,
            embedding,
            all: embedding + padded(d),
        }
    }
}

/// The drivers that occur in a batch.
#[derive(Debug)]
pub(crate) struct Roster {
    pub(crate) columns: Columns,
    d: usize,
    /// Place in the batch of every driver, or [`ABSENT`].
    place: Vec<u32>,
    /// Who is there, in the order of their places.
    present: Vec<u32>,
    /// A line for each who is there.
    pub(crate) table: Matrix,
    /// `w` of each who is there, shape `(drivers, padded d)`.
    embeddings: Matrix,
    /// Gradients by those.
    by_embedding: Matrix,
}

/// Where one network's part of a line is, and the layer it belongs to.
fn parts<'a>(layout: &'a Layout, columns: &Columns) -> [(&'a Layer, usize); 4] {
    [
        (&layout.following_distance[0], columns.following_distance),
        (&layout.lane_head[0], columns.lane_change),
        (&layout.speed_head[0], columns.velocity),
        (&layout.style[0], columns.aggression),
    ]
}

impl Roster {
    /// Room for `most` drivers at a time out of `drivers`.
    pub(crate) fn new(layout: &Layout, d: usize, drivers: usize, most: usize) -> Self {
        let columns = Columns::new(layout, d);
        let most = drivers.min(most);
        Self {
            columns,
            d,
            place: vec![ABSENT; drivers],
            present: Vec::with_capacity(most),
            table: Matrix::zeros(most, columns.all),
            embeddings: Matrix::zeros(most, d),
            by_embedding: Matrix::zeros(most, d),
        }
    }

    /// Drivers that are there.
    pub(crate) fn drivers(&self) -> usize {
        self.present.len()
    }

    /// Place of a driver that is there.
    pub(crate) fn place(&self, driver: u32) -> u32 {
        self.place[driver as usize]
    }

    /// Takes in the drivers of a batch; `embeddings` has shape `(all drivers, d)`.
    pub(crate) fn gather(
        &mut self,
        arch: Arch,
        layout: &Layout,
        packed: &[f32],
        drivers: impl Iterator<Item = u32>,
        embeddings: &[f32],
    ) {
        for &driver in &self.present {
            self.place[driver as usize] = ABSENT;
        }
        self.present.clear();
        for driver in drivers {
            let place = &mut self.place[driver as usize];
            if *place == ABSENT {
                *place = self.present.len() as u32;
                self.present.push(driver);
            }
        }
        let (d, columns) = (self.d, self.columns);
        for (place, &driver) in self.present.iter().enumerate() {
            let w = &embeddings[driver as usize * d..][..d];
            self.embeddings.row_mut(place)[..d].copy_from_slice(w);
            self.table.row_mut(place)[columns.embedding..][..d].copy_from_slice(w);
        }
        for (layer, first) in parts(layout, &columns) {
            arch.dispatch(RowsTimes {
                rows: self.present.len(),
                x: self.embeddings.columns(0),
                depth: d,
                b: layer.embedding_weights(packed),
                width: layer.width,
                start: Start::Bias(layer.biases(packed)),
                finish: Plain,
                y: self.table.columns_mut(first),
            });
        }
    }

    /// From the lines' gradients to those of the first layers' biases and weights of `w`, which are added to
    /// `gradient`, and of the embeddings, which are added to `embedding_gradient`, shape `(all drivers, d)`.
    pub(crate) fn scatter(
        &mut self,
        arch: Arch,
        layout: &Layout,
        derived: &[f32],
        lines: &Matrix,
        gradient: &mut [f32],
        embedding_gradient: &mut [f32],
    ) {
        let rows = self.present.len();
        let d = self.d;
        self.by_embedding.all_mut().fill(0.0);
        for (layer, first) in parts(layout, &self.columns) {
            let dy = lines.columns(first);
            arch.dispatch(OuterSums {
                rows,
                x: View::ONES,
                inputs: 1,
                dy,
                width: layer.width,
                to: layer.biases_mut(gradient),
            });
            arch.dispatch(OuterSums {
                rows,
                x: self.embeddings.columns(0),
                inputs: d,
                dy,
                width: layer.width,
                to: layer.embedding_weights_mut(gradient),
            });
            arch.dispatch(RowsTimes {
                rows,
                x: dy,
                depth: layer.native.outputs,
                b: layer.back_embedding(derived),
                width: self.by_embedding.width,
                start: Start::Add,
                finish: Plain,
                y: self.by_embedding.columns_mut(0),
            });
        }
        for (place, &driver) in self.present.iter().enumerate() {
            let direct = &lines.row(place)[self.columns.embedding..][..d];
            let through = &self.by_embedding.row(place)[..d];
            let to = &mut embedding_gradient[driver as usize * d..][..d];
            for ((to, a), b) in to.iter_mut().zip(direct).zip(through) {
                *to += a + b;
            }
        }
    }
}
