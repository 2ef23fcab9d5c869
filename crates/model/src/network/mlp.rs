//! A multi-layer perceptron over one tile: ReLU between its layers, nothing after the last.

use crate::kernel::{Real, Tile, affine, back_input, back_relu, back_weights, relu};
use rand_distr::{Distribution, Normal};

/// One dense layer; its weights `(outputs, inputs)` and then its biases `(outputs,)` lie in the parameter
/// vector from `offset` on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Dense {
    pub(crate) inputs: usize,
    pub(crate) outputs: usize,
    pub(crate) offset: usize,
}

impl Dense {
    pub(crate) fn biases_at(&self) -> usize {
        self.offset + self.inputs * self.outputs
    }

    pub(crate) fn end(&self) -> usize {
        self.biases_at() + self.outputs
    }

    pub(crate) fn weights<'a, T>(&self, parameters: &'a [T]) -> &'a [T] {
        &parameters[self.offset..self.biases_at()]
    }

    pub(crate) fn biases<'a, T>(&self, parameters: &'a [T]) -> &'a [T] {
        &parameters[self.biases_at()..self.end()]
    }
}

/// Layers one after the other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Mlp {
    layers: Vec<Dense>,
}

impl Mlp {
    /// Layers between consecutive `sizes`, their parameters from `*offset` on; moves `*offset` past them.
    pub(crate) fn new(offset: &mut usize, sizes: &[usize]) -> Self {
        let layers = sizes.windows(2).map(|pair| {
            let layer = Dense {
                inputs: pair[0],
                outputs: pair[1],
                offset: *offset,
            };
            *offset = layer.end();
            layer
        });
        Self {
            layers: layers.collect(),
        }
    }

    pub(crate) fn layers(&self) -> &[Dense] {
        &self.layers
    }

    pub(crate) fn first(&self) -> Dense {
        self.layers[0]
    }

    /// Weights from N(0, 2/inputs) before a ReLU and N(0, 1/inputs) at the end; biases 0 (He et al. 2015).
    pub(crate) fn initialise<T: Real>(&self, parameters: &mut [T], rng: &mut impl rand::Rng) {
        for (index, layer) in self.layers.iter().enumerate() {
            let gain = if index + 1 < self.layers.len() {
                2.0
            } else {
                1.0
            };
            let sd = (gain / layer.inputs as f64).sqrt();
            let normal = Normal::new(0.0, sd).expect("a layer has inputs, so its SD is finite");
            for weight in &mut parameters[layer.offset..layer.biases_at()] {
                *weight = T::from_f64(normal.sample(rng));
            }
        }
    }

    /// Takes `pass.input()` through the layers to `pass.output()`.
    pub(crate) fn forward<T: Real>(&self, parameters: &[T], pass: &mut MlpPass<T>) {
        for (index, layer) in self.layers.iter().enumerate() {
            let (before, after) = pass.values.split_at_mut(index + 1);
            affine(
                layer.weights(parameters),
                layer.biases(parameters),
                before[index].all(),
                after[0].all_mut(),
            );
            if index + 1 < self.layers.len() {
                relu(after[0].all_mut());
            }
        }
    }

    /// Takes `pass.output_gradient()` back; adds the parameters' gradient to `gradient`, and fills
    /// `pass.input_gradient()` if `to_input`.
    pub(crate) fn backward<T: Real>(
        &self,
        parameters: &[T],
        mut gradient: Option<&mut [T]>,
        pass: &mut MlpPass<T>,
        to_input: bool,
    ) {
        for (index, layer) in self.layers.iter().enumerate().rev() {
            let (before, after) = pass.gradients.split_at_mut(index + 1);
            let dy = after[0].all_mut();
            if index + 1 < self.layers.len() {
                back_relu(dy, pass.values[index + 1].all());
            }
            if let Some(gradient) = gradient.as_deref_mut() {
                let (dw, db) =
                    gradient[layer.offset..layer.end()].split_at_mut(layer.inputs * layer.outputs);
                back_weights(dy, pass.values[index].all(), dw, db);
            }
            if index > 0 || to_input {
                back_input(layer.weights(parameters), dy, before[index].all_mut());
            }
        }
    }
}

/// What one tile leaves behind on its way through an [`Mlp`].
#[derive(Debug)]
pub(crate) struct MlpPass<T> {
    /// Input, then every layer's output.
    values: Vec<Tile<T>>,
    /// Gradients of the same.
    gradients: Vec<Tile<T>>,
}

impl<T: Real> MlpPass<T> {
    pub(crate) fn new(mlp: &Mlp) -> Self {
        let sizes = std::iter::once(mlp.first().inputs).chain(mlp.layers.iter().map(|l| l.outputs));
        let tiles = || sizes.clone().map(Tile::zeros).collect();
        Self {
            values: tiles(),
            gradients: tiles(),
        }
    }

    pub(crate) fn input(&mut self) -> &mut Tile<T> {
        &mut self.values[0]
    }

    pub(crate) fn output(&self) -> &Tile<T> {
        &self.values[self.values.len() - 1]
    }

    pub(crate) fn input_gradient(&self) -> &Tile<T> {
        &self.gradients[0]
    }

    pub(crate) fn output_gradient(&mut self) -> &mut Tile<T> {
        let last = self.gradients.len() - 1;
        &mut self.gradients[last]
    }
}
