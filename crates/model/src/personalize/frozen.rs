//! The weights of a trained model, laid out for moving nothing but `w`.
//!
//! Each of F, C, V and M is a [`Head`]: what its first layer makes of inputs that do not depend on `w` is computed
//! once a row; what depends on `w` is added at each evaluation.

use super::lines::{Line, add_product, back_relu, fill, relu, shifted_relu};
use crate::{
    losses::{LossWeights, MutualInformationLoss, Reading},
    model::Model,
    network::mlp::{Dense, Mlp},
    rows::RowWeights,
    scaling::Scaling,
    whitening::Whitening,
};
use std::ops::Range;

/// One dense layer, and its transpose for the way back.
#[derive(Debug, Clone)]
pub(super) struct Layer {
    /// Shape `(outputs, inputs)`.
    pub(super) weights: Vec<f32>,
    /// Shape `(inputs, outputs)`.
    transposed: Vec<f32>,
    pub(super) biases: Vec<f32>,
    inputs: usize,
}

impl Layer {
    /// The columns `inputs` of `dense`.
    fn new(dense: Dense, parameters: &[f32], inputs: &[usize]) -> Self {
        let all = dense.weights(parameters);
        let at = |output: usize, input: usize| all[output * dense.inputs + input];
        let outputs = 0..dense.outputs;
        Self {
            weights: outputs
                .clone()
                .flat_map(|o| inputs.iter().map(move |&i| at(o, i)))
                .collect(),
            transposed: inputs
                .iter()
                .flat_map(|&i| outputs.clone().map(move |o| at(o, i)))
                .collect(),
            biases: dense.biases(parameters).to_vec(),
            inputs: inputs.len(),
        }
    }

    fn whole(dense: Dense, parameters: &[f32]) -> Self {
        let inputs: Vec<usize> = (0..dense.inputs).collect();
        Self::new(dense, parameters, &inputs)
    }

    pub(super) fn outputs(&self) -> usize {
        self.biases.len()
    }

    /// `y = W x + b`.
    pub(super) fn forward(&self, x: &[Line], y: &mut [Line]) {
        fill(y, &self.biases);
        add_product(&self.weights, x, y);
    }

    /// `y = W x`.
    fn product_of_lines(&self, x: &[Line], y: &mut [Line]) {
        y.fill(Line::ZERO);
        add_product(&self.weights, x, y);
    }

    /// `dx = Wᵀ dy`.
    fn backward(&self, dy: &[Line], dx: &mut [Line]) {
        dx.fill(Line::ZERO);
        add_product(&self.transposed, dy, dx);
    }

    /// `W x` for one row.
    pub(super) fn product(&self, x: &[f64]) -> Vec<f32> {
        let lines = self.weights.chunks_exact(self.inputs.max(1));
        lines
            .map(|line| {
                line.iter()
                    .zip(x)
                    .map(|(&w, x)| f64::from(w) * x)
                    .sum::<f64>() as f32
            })
            .collect()
    }
}

/// An encoder of windows: dense layers with ReLU between them.
#[derive(Debug, Clone)]
pub(super) struct Encoder {
    layers: Vec<Layer>,
}

impl Encoder {
    fn new(mlp: &Mlp, parameters: &[f32]) -> Self {
        let layers = mlp.layers().iter();
        Self {
            layers: layers.map(|&l| Layer::whole(l, parameters)).collect(),
        }
    }

    pub(super) fn run(&self, window: &[Line]) -> Vec<Line> {
        let mut x = window.to_vec();
        for (index, layer) in self.layers.iter().enumerate() {
            let mut y = vec![Line::ZERO; layer.outputs()];
            layer.forward(&x, &mut y);
            if index + 1 < self.layers.len() {
                relu(&mut y);
            }
            x = y;
        }
        x
    }
}

/// A perceptron whose first layer is split into inputs that move with `w` and inputs that do not.
#[derive(Debug, Clone)]
pub(super) struct Head {
    /// First layer, columns that move; its biases are with the fixed ones.
    pub(super) moving: Layer,
    /// First layer, columns that do not move, and the biases.
    pub(super) fixed: Layer,
    /// The layers after it; one at least.
    rest: Vec<Layer>,
}

impl Head {
    fn new(mlp: &Mlp, parameters: &[f32], moving: Range<usize>) -> Self {
        let first = mlp.first();
        let fixed: Vec<usize> = (0..first.inputs).filter(|i| !moving.contains(i)).collect();
        let moving: Vec<usize> = moving.collect();
        let rest = mlp.layers()[1..].iter();
        Self {
            moving: Layer::new(first, parameters, &moving),
            fixed: Layer::new(first, parameters, &fixed),
            rest: rest.map(|&l| Layer::whole(l, parameters)).collect(),
        }
    }

    /// What the first layer makes of the inputs that do not move.
    pub(super) fn prepare(&self, fixed: &[Line]) -> Vec<Line> {
        let mut y = vec![Line::ZERO; self.fixed.outputs()];
        self.fixed.forward(fixed, &mut y);
        y
    }

    /// From a prepared tile and `shift`, the moving inputs' part, alike in every row, to `pass.output`.
    pub(super) fn forward_shifted(&self, prepared: &[Line], shift: &[f32], pass: &mut HeadPass) {
        shifted_relu(prepared, shift, &mut pass.hidden[0]);
        self.forward_rest(pass);
    }

    /// As [`Self::forward_shifted`] with moving inputs of their own in each row.
    pub(super) fn forward(&self, prepared: &[Line], moving: &[Line], pass: &mut HeadPass) {
        pass.hidden[0].copy_from_slice(prepared);
        add_product(&self.moving.weights, moving, &mut pass.hidden[0]);
        relu(&mut pass.hidden[0]);
        self.forward_rest(pass);
    }

    fn forward_rest(&self, pass: &mut HeadPass) {
        let last = self.rest.len() - 1;
        for (index, layer) in self.rest.iter().enumerate() {
            if index < last {
                let (before, after) = pass.hidden.split_at_mut(index + 1);
                layer.forward(&before[index], &mut after[0]);
                relu(&mut after[0]);
            } else {
                layer.forward(&pass.hidden[index], &mut pass.output);
            }
        }
    }

    /// How the sum over outputs, each times its `seed`, changes with the moving inputs: to `pass.by_moving`, row by row.
    pub(super) fn backward(&self, seeds: &[f32], pass: &mut HeadPass) {
        fill(&mut pass.seeds, seeds);
        self.backward_of_seeds(pass);
    }

    /// As [`Self::backward`] with seeds of their own in each row, those in `pass.seeds`.
    pub(super) fn backward_of_seeds(&self, pass: &mut HeadPass) {
        let last = self.rest.len() - 1;
        for (index, layer) in self.rest.iter().enumerate().rev() {
            if index == last {
                layer.backward(&pass.seeds, &mut pass.scratch[index]);
            } else {
                let (before, after) = pass.scratch.split_at_mut(index + 1);
                layer.backward(&after[0], &mut before[index]);
            }
            back_relu(&mut pass.scratch[index], &pass.hidden[index]);
        }
        self.moving.backward(&pass.scratch[0], &mut pass.by_moving);
    }

    /// How the outputs change where the moving inputs change by `tangent`, row by row.
    pub(super) fn tangent(&self, tangent: &[Line], pass: &mut HeadPass, outputs: &mut [Line]) {
        let last = self.rest.len() - 1;
        self.moving.product_of_lines(tangent, &mut pass.scratch[0]);
        back_relu(&mut pass.scratch[0], &pass.hidden[0]);
        for (index, layer) in self.rest.iter().enumerate() {
            if index < last {
                let (before, after) = pass.scratch.split_at_mut(index + 1);
                layer.product_of_lines(&before[index], &mut after[0]);
                back_relu(&mut after[0], &pass.hidden[index + 1]);
            } else {
                layer.product_of_lines(&pass.scratch[index], outputs);
            }
        }
    }
}

/// A tile on its way through a [`Head`].
#[derive(Debug, Clone)]
pub(super) struct HeadPass {
    /// After each hidden layer.
    hidden: Vec<Vec<Line>>,
    scratch: Vec<Vec<Line>>,
    pub(super) output: Vec<Line>,
    /// For [`Head::backward_of_seeds`].
    pub(super) seeds: Vec<Line>,
    /// After [`Head::backward`].
    pub(super) by_moving: Vec<Line>,
}

impl HeadPass {
    pub(super) fn new(head: &Head) -> Self {
        let lines = |n: usize| vec![Line::ZERO; n];
        let last = head.rest.len() - 1;
        let sizes = std::iter::once(head.moving.outputs())
            .chain(head.rest[..last].iter().map(Layer::outputs));
        let hidden: Vec<Vec<Line>> = sizes.map(lines).collect();
        let outputs = head.rest[last].outputs();
        Self {
            scratch: hidden.clone(),
            hidden,
            output: lines(outputs),
            seeds: lines(outputs),
            by_moving: lines(head.moving.inputs),
        }
    }
}

/// Everything of a model that fitting an embedding reads.
#[derive(Debug, Clone)]
pub(crate) struct Frozen {
    pub(super) following_distance: Head,
    pub(super) lane_encoder: Encoder,
    pub(super) lane_change: Head,
    pub(super) speed_encoder: Encoder,
    pub(super) velocity: Head,
    pub(super) mutual_information: Head,
    /// S, shape `(d,)`, and its bias.
    pub(super) style: (Vec<f64>, f64),
    pub(super) weights: LossWeights,
    pub(super) reading: Reading,
    pub(super) whitening: Whitening,
    pub(super) scaling: Scaling,
    pub(super) row_weights: RowWeights,
    pub(super) window_steps: usize,
}

impl Frozen {
    pub(crate) fn of(model: &Model) -> Self {
        let n = model.networks();
        let p = model.parameters();
        let a = model.architecture();
        let d = a.embedding_size;
        let outputs_at = 1 + 2 * a.encoding_size;
        let style = n.style.dense();
        Self {
            following_distance: Head::new(&n.following_distance.head, p, 0..d),
            lane_encoder: Encoder::new(&n.lane_change.encoded.encoder, p),
            lane_change: Head::new(&n.lane_change.encoded.head, p, 0..d),
            speed_encoder: Encoder::new(&n.velocity.encoded.encoder, p),
            velocity: Head::new(&n.velocity.encoded.head, p, 0..d),
            mutual_information: Head::new(
                &n.mutual_information.head,
                p,
                outputs_at..outputs_at + 4,
            ),
            style: (
                style.weights(p).iter().map(|&w| f64::from(w)).collect(),
                f64::from(style.biases(p)[0]),
            ),
            weights: model.active_weights(),
            reading: match model.mutual_information_loss() {
                // In expectation over M's sample: drawing it would make the objective noisy, and a line search on
                // noise stops anywhere.
                MutualInformationLoss::MeanSquared => Reading::Expected,
                MutualInformationLoss::GaussianLikelihood => Reading::Likelihood,
            },
            whitening: model.whitening().clone(),
            scaling: *model.scaling(),
            row_weights: *model.row_weights(),
            window_steps: a.window_steps,
        }
    }

    /// d.
    pub(super) fn embedding_size(&self) -> usize {
        self.style.0.len()
    }

    /// S at `w`, standardised.
    pub(super) fn aggression(&self, w: &[f64]) -> f64 {
        self.style.1 + crate::linear_algebra::dot(&self.style.0, w)
    }
}
