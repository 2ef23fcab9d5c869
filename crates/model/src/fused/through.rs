//! Rows of a tile through a stack of layers and back.

use super::{
    layout::{Layer, Layout},
    matrix::{LANES, Matrix, View, ViewMut},
    product::{BackRelu, Finish, OuterSums, Plain, Relu, RowsTimes, ScatterRows, Start},
    roster::Roster,
};
use crate::losses::{LossWeights, Reading};
use pulp::Arch;

/// Sums that begin with nothing: as many zeros as the widest layer has outputs.
pub(super) const ZERO: Start<'static> = Start::Bias(&[0.0; 8256]);

/// What stays the same from tile to tile of a batch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shared<'a> {
    pub(crate) arch: Arch,
    pub(crate) layout: &'a Layout,
    pub(crate) packed: &'a [f32],
    pub(crate) derived: &'a [f32],
    pub(crate) roster: &'a Roster,
    pub(crate) weights: LossWeights,
    pub(crate) reading: Reading,
    /// Of the gradients: one over the rows of the batch.
    pub(crate) scale: f64,
}

/// Where the gradients of a lane gather.
#[derive(Debug)]
pub(crate) struct Gradients<'a> {
    /// By the packed parameters.
    pub(crate) packed: &'a mut [f32],
    /// By the roster's lines.
    pub(crate) lines: &'a mut Matrix,
    /// Room for the sums of a layer with few outputs, see [`narrow_room`].
    pub(crate) narrow: &'a mut [f32],
}

/// A layer with so few outputs, padded to a whole vector, would waste most of it.
const NARROW: usize = 8;

/// Numbers that [`Gradients::narrow`] needs.
pub(crate) fn narrow_room(layout: &Layout) -> usize {
    let widest = layout.layers().map(Layer::back_width).max();
    NARROW * widest.unwrap_or(0)
}

/// The rows of a tile on their way through a stack of layers.
#[derive(Clone, Copy)]
pub(super) struct Through<'a> {
    shared: &'a Shared<'a>,
    rows: usize,
    /// The roster's line of each row.
    place: &'a [u32],
}

impl<'a> Through<'a> {
    pub(super) fn new(shared: &'a Shared<'a>, place: &'a [u32]) -> Self {
        let rows = place.len();
        Self { shared, rows, place }
    }

    /// From `x` to `output`; with a `table` the first layer starts from the roster's lines, from that column on.
    pub(super) fn forward(
        &self,
        stack: &[Layer],
        x: View<'_>,
        table: Option<usize>,
        hidden: &mut [Matrix],
        output: ViewMut<'_>,
    ) {
        let Some((last, others)) = stack.split_last() else {
            return;
        };
        let start = |index: usize, layer: &Layer| match table {
            Some(column) if index == 0 => {
                Start::Table { table: self.shared.roster.table.columns(column), index: self.place }
            }
            _ => Start::Bias(layer.biases(self.shared.packed)),
        };
        for (index, layer) in others.iter().enumerate() {
            let (before, after) = hidden.split_at_mut(index);
            let x = before.last().map_or(x, |matrix| matrix.columns(0));
            let y = after[0].columns_mut(0);
            self.layer(layer, x, start(index, layer), Relu, y);
        }
        let x = hidden.last().map_or(x, |matrix| matrix.columns(0));
        self.layer(last, x, start(others.len(), last), Plain, output);
    }

    fn layer(
        &self,
        layer: &Layer,
        x: View<'_>,
        start: Start<'_>,
        finish: impl Finish,
        y: ViewMut<'_>,
    ) {
        self.shared.arch.dispatch(RowsTimes {
            rows: self.rows,
            x,
            depth: layer.inputs(),
            b: layer.weights(self.shared.packed),
            width: layer.width,
            start,
            finish,
            y,
        });
    }

    /// The gradient by the weights of a layer with few outputs: output by output, along its inputs.
    fn narrow(&self, layer: &Layer, x: View<'_>, dy: View<'_>, to: &mut Gradients<'_>) {
        let (outputs, width) = (layer.native.outputs, layer.back_width());
        let sums = &mut to.narrow[..outputs * width];
        sums.fill(0.0);
        self.shared.arch.dispatch(OuterSums {
            rows: self.rows,
            x: dy,
            inputs: outputs,
            dy: x,
            width,
            to: sums,
        });
        let lines = layer.weights_mut(to.packed).chunks_exact_mut(layer.width);
        for (input, line) in lines.enumerate() {
            for (output, to) in line[..outputs].iter_mut().enumerate() {
                *to += sums[output * width + input];
            }
        }
    }

    /// The gradient by a layer's inputs.
    fn back(
        &self,
        layer: &Layer,
        dy: View<'_>,
        start: Start<'_>,
        finish: impl Finish,
        y: ViewMut<'_>,
    ) {
        self.shared.arch.dispatch(RowsTimes {
            rows: self.rows,
            x: dy,
            depth: layer.native.outputs,
            b: layer.back(self.shared.derived),
            width: layer.back_width(),
            start,
            finish,
            y,
        });
    }

    /// From the gradient `by_output` back to `x`, and to `input` where it is asked for.
    pub(super) fn backward(
        &self,
        stack: &[Layer],
        (x, hidden, by_output): (View<'_>, &[Matrix], View<'_>),
        table: Option<usize>,
        mut input: Option<(ViewMut<'_>, Start<'_>)>,
        scratch: &mut [Matrix; 2],
        to: &mut Gradients<'_>,
    ) {
        let arch = self.shared.arch;
        for (index, layer) in stack.iter().enumerate().rev() {
            let [even, odd] = scratch;
            let (read, write) = if index % 2 == 0 { (&*odd, even) } else { (&*even, odd) };
            let dy = if index + 1 == stack.len() { by_output } else { read.columns(0) };
            let before = index.checked_sub(1).map(|i| &hidden[i]);
            let x = before.map_or(x, |matrix| matrix.columns(0));
            if layer.native.outputs <= NARROW && x.first % LANES == 0 {
                self.narrow(layer, x, dy, to);
            } else {
                arch.dispatch(OuterSums {
                    rows: self.rows,
                    x,
                    inputs: layer.inputs(),
                    dy,
                    width: layer.width,
                    to: layer.weights_mut(to.packed),
                });
            }
            match table {
                Some(column) if index == 0 => arch.dispatch(ScatterRows {
                    from: dy,
                    index: self.place,
                    width: layer.width,
                    to: to.lines.columns_mut(column),
                }),
                _ => arch.dispatch(OuterSums {
                    rows: self.rows,
                    x: View::ONES,
                    inputs: 1,
                    dy,
                    width: layer.width,
                    to: layer.biases_mut(to.packed),
                }),
            }
            match before {
                Some(values) => {
                    let finish = BackRelu(values.columns(0));
                    self.back(layer, dy, ZERO, finish, write.columns_mut(0));
                }
                None => {
                    if let Some((y, start)) = input.take() {
                        self.back(layer, dy, start, Plain, y);
                    }
                }
            }
        }
    }
}
