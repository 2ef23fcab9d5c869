//! Where the layers of a multi-layer perceptron lie in the parameter vector: ReLU between its layers, nothing after the last.

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
    pub(crate) fn initialise(&self, parameters: &mut [f32], rng: &mut impl rand::Rng) {
        for (index, layer) in self.layers.iter().enumerate() {
            let gain = if index + 1 < self.layers.len() {
                2.0
            } else {
                1.0
            };
            let sd = (gain / layer.inputs as f64).sqrt();
            let normal = Normal::new(0.0, sd).expect("a layer has inputs, so its SD is finite");
            for weight in &mut parameters[layer.offset..layer.biases_at()] {
                *weight = normal.sample(rng) as f32;
            }
        }
    }
}
