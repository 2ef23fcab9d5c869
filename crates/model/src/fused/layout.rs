//! Where the weights of every layer lie for [`super::product`], and the way there and back.
//!
//! A layer's weights lie input by input, each input's line padded with zeros to whole vectors; its biases are one
//! more line. Going back needs them output by output as well: those copies are [`Layout::derive`]d each step.

use super::matrix::{Aligned, padded};
use crate::network::{Dense, Mlp, Networks};

/// One dense layer as the products read it.
#[derive(Debug, Clone)]
pub(crate) struct Layer {
    pub(crate) native: Dense,
    /// The native input of each line; `None` is a line of zeros.
    lines: Vec<Option<usize>>,
    /// The first lines read `w`; the roster's table takes them and the biases.
    embedding: usize,
    /// Padded outputs.
    pub(crate) width: usize,
    weights: usize,
    biases: usize,
    /// Copies output by output: of the lines of `w`, and of the others; where a gradient goes that way.
    back_embedding: Option<usize>,
    back: Option<usize>,
}

impl Layer {
    /// Lines that do not read `w`.
    pub(crate) fn inputs(&self) -> usize {
        self.lines.len() - self.embedding
    }

    /// Their padded number: the width of the gradient by the inputs.
    pub(crate) fn back_width(&self) -> usize {
        padded(self.inputs())
    }

    /// Weights of the inputs other than `w`, shape `(inputs, width)`.
    pub(crate) fn weights<'a>(&self, packed: &'a [f32]) -> &'a [f32] {
        &packed[self.weights + self.embedding * self.width..self.biases]
    }

    pub(crate) fn weights_mut<'a>(&self, packed: &'a mut [f32]) -> &'a mut [f32] {
        &mut packed[self.weights + self.embedding * self.width..self.biases]
    }

    /// Weights of `w`, shape `(d, width)`.
    pub(crate) fn embedding_weights<'a>(&self, packed: &'a [f32]) -> &'a [f32] {
        &packed[self.weights..][..self.embedding * self.width]
    }

    pub(crate) fn embedding_weights_mut<'a>(&self, packed: &'a mut [f32]) -> &'a mut [f32] {
        &mut packed[self.weights..][..self.embedding * self.width]
    }

    pub(crate) fn biases<'a>(&self, packed: &'a [f32]) -> &'a [f32] {
        &packed[self.biases..][..self.width]
    }

    pub(crate) fn biases_mut<'a>(&self, packed: &'a mut [f32]) -> &'a mut [f32] {
        &mut packed[self.biases..][..self.width]
    }

    /// Weights output by output, shape `(outputs, back_width)`; empty where no gradient goes back.
    pub(crate) fn back<'a>(&self, derived: &'a [f32]) -> &'a [f32] {
        let size = self.native.outputs * self.back_width();
        self.back.map_or(&[], |offset| &derived[offset..][..size])
    }

    /// Weights of `w` output by output, shape `(outputs, padded d)`.
    pub(crate) fn back_embedding<'a>(&self, derived: &'a [f32]) -> &'a [f32] {
        let size = self.native.outputs * padded(self.embedding);
        self.back_embedding.map_or(&[], |offset| &derived[offset..][..size])
    }
}

/// Columns of M's input: the two codes, each padded, then single numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MutualInformationInput {
    /// Padded width of a code; z_l begins at 0, z_v here.
    pub(crate) code: usize,
    pub(crate) lead_speed: usize,
    pub(crate) following_distance: usize,
    pub(crate) probability: usize,
    pub(crate) speed: usize,
    pub(crate) aggression: usize,
    pub(crate) columns: usize,
}

/// All layers.
#[derive(Debug, Clone)]
pub(crate) struct Layout {
    pub(crate) following_distance: Vec<Layer>,
    pub(crate) lane_encoder: Vec<Layer>,
    pub(crate) lane_head: Vec<Layer>,
    pub(crate) speed_encoder: Vec<Layer>,
    pub(crate) speed_head: Vec<Layer>,
    pub(crate) style: Vec<Layer>,
    pub(crate) mutual_information: Vec<Layer>,
    pub(crate) reads: MutualInformationInput,
    /// Numbers in the packed vector.
    pub(crate) packed: usize,
    /// Numbers in the derived one.
    pub(crate) derived: usize,
}

/// Hands out room.
#[derive(Default)]
struct Room {
    packed: usize,
    derived: usize,
}

impl Room {
    /// Layers of `mlp`; `lines` are the first one's inputs, of which `embedding` read `w`.
    fn stack(
        &mut self,
        mlp: &Mlp,
        lines: Vec<Option<usize>>,
        embedding: usize,
        to_input: bool,
    ) -> Vec<Layer> {
        let mut lines = Some(lines);
        let layers = mlp.iter().enumerate().map(|(index, &native)| {
            let all_inputs = || (0..native.inputs).map(Some).collect();
            let lines = lines.take().unwrap_or_else(all_inputs);
            let embedding = if index == 0 { embedding } else { 0 };
            let width = padded(native.outputs);
            let weights = self.packed;
            let biases = weights + lines.len() * width;
            self.packed = biases + width;
            let mut reserve = |wanted: bool, columns: usize| {
                let offset = self.derived;
                self.derived += usize::from(wanted) * native.outputs * padded(columns);
                wanted.then_some(offset)
            };
            Layer {
                back_embedding: reserve(embedding > 0, embedding),
                back: reserve(index > 0 || to_input, lines.len() - embedding),
                native,
                lines,
                embedding,
                width,
                weights,
                biases,
            }
        });
        layers.collect()
    }
}

impl Layout {
    pub(crate) fn new(networks: &Networks) -> Self {
        let a = networks.architecture;
        let d = a.embedding_size;
        let code = padded(a.encoding_size);
        let reads = MutualInformationInput {
            code,
            lead_speed: 2 * code,
            following_distance: 2 * code + 1,
            probability: 2 * code + 2,
            speed: 2 * code + 3,
            aggression: 2 * code + 4,
            columns: 2 * code + 5,
        };
        // A line for each column of a code, those past its end without weights.
        let of_code =
            |first: usize| (0..code).map(move |k| (k < a.encoding_size).then_some(first + k));
        let head = || (0..d).map(Some).chain(of_code(d)).collect();
        let outputs = 1 + 2 * a.encoding_size;
        let m_lines = of_code(1)
            .chain(of_code(1 + a.encoding_size))
            .chain([Some(0)])
            .chain((outputs..outputs + 4).map(Some));
        let n = networks;
        let windows = |mlp: &Mlp| (0..mlp[0].inputs).map(Some).collect();
        let mut room = Room::default();
        let m = &n.mutual_information;
        Self {
            following_distance: room.stack(
                &n.following_distance,
                (0..=d).map(Some).collect(),
                d,
                false,
            ),
            lane_encoder: room.stack(&n.lane_encoder, windows(&n.lane_encoder), 0, false),
            lane_head: room.stack(&n.lane_head, head(), d, true),
            speed_encoder: room.stack(&n.speed_encoder, windows(&n.speed_encoder), 0, false),
            speed_head: room.stack(&n.speed_head, head(), d, true),
            style: room.stack(&n.style, (0..d).map(Some).collect(), d, false),
            mutual_information: room.stack(m, m_lines.collect(), 0, true),
            reads,
            packed: room.packed,
            derived: room.derived,
        }
    }

    pub(crate) fn layers(&self) -> impl Iterator<Item = &Layer> {
        [
            &self.following_distance,
            &self.lane_encoder,
            &self.lane_head,
            &self.speed_encoder,
            &self.speed_head,
            &self.style,
            &self.mutual_information,
        ]
        .into_iter()
        .flatten()
    }

    /// Every native parameter's index and its packed one.
    fn pairs(&self) -> impl Iterator<Item = (usize, usize)> {
        self.layers().flat_map(|layer| {
            let native = layer.native;
            let lines = layer.lines.iter().enumerate();
            let weights = lines.flat_map(move |(line, &input)| {
                let each = (0..native.outputs).filter_map(move |o| Some((o, input?)));
                each.map(move |(o, input)| {
                    let packed = layer.weights + line * layer.width + o;
                    (native.offset + o * native.inputs + input, packed)
                })
            });
            let biases =
                (0..native.outputs).map(move |o| (native.biases_at() + o, layer.biases + o));
            weights.chain(biases)
        })
    }

    /// Native parameters as the products read them.
    pub(crate) fn pack(&self, native: &[f32]) -> Aligned {
        let mut packed = Aligned::zeros(self.packed);
        for (from, to) in self.pairs() {
            packed[to] = native[from];
        }
        packed
    }

    /// Back from [`Self::pack`].
    pub(crate) fn unpack(&self, packed: &[f32]) -> Vec<f32> {
        let count = self.layers().map(|layer| layer.native.end()).max();
        let mut native = vec![0.0; count.unwrap_or(0)];
        for (to, from) in self.pairs() {
            native[to] = packed[from];
        }
        native
    }

    /// 1 where a packed number is a weight, 0 at biases: what weight decay concerns.
    pub(crate) fn is_weight(&self) -> Aligned {
        let mut mask = Aligned::zeros(self.packed);
        for layer in self.layers() {
            mask[layer.weights..layer.biases].fill(1.0);
        }
        mask
    }

    /// Copies the weights output by output.
    pub(crate) fn derive(&self, packed: &[f32], derived: &mut [f32]) {
        for layer in self.layers() {
            let e = layer.embedding;
            let parts = [(layer.back_embedding, 0, e), (layer.back, e, layer.inputs())];
            for (offset, first, lines) in parts {
                let Some(offset) = offset else { continue };
                let back_width = padded(lines);
                let to = &mut derived[offset..][..layer.native.outputs * back_width];
                let from = &packed[layer.weights + first * layer.width..];
                for (o, to) in to.chunks_exact_mut(back_width).enumerate() {
                    let lines = from.chunks_exact(layer.width).take(lines);
                    for (to, line) in to.iter_mut().zip(lines) {
                        *to = line[o];
                    }
                }
            }
        }
    }
}
