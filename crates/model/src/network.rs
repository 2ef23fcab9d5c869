//! The five sub-networks of the method, their parameters in one vector.

use rand_distr::{Distribution, Normal};
use serde::{Deserialize, Serialize};

/// Signals that each of C and V reads a window of.
const WINDOW_SIGNALS: usize = 3;

/// Sizes of the networks.
///
/// # Source
/// Method section 3; the paper gives no sizes but that of the embedding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Architecture {
    /// Numbers in an embedding, d.
    pub embedding_size: usize,
    /// Units of each hidden layer of F, C, V and M.
    pub hidden_units: usize,
    /// Hidden layers of F, C, V and M.
    pub hidden_layers: usize,
    /// Units of the encoders' hidden layer.
    pub encoder_units: usize,
    /// Numbers in each of z_l and z_v.
    pub encoding_size: usize,
    /// Samples of each signal in a window.
    pub window_steps: usize,
}

impl Architecture {
    /// Floating-point operations that a row needs, forward and back: two for each weight forward, two for its
    /// gradient, and two for the gradient of its input where that goes on (not before the windows).
    pub fn operations_per_row(&self) -> f64 {
        let networks = Networks::new(*self);
        let weights = |layer: &Dense| layer.inputs * layer.outputs;
        let weight_count: usize = networks.all().iter().flat_map(|m| m.iter()).map(weights).sum();
        let free = weights(&networks.lane_encoder[0]) + weights(&networks.speed_encoder[0]);
        (6 * weight_count - 2 * free) as f64
    }
}

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

/// Layers one after the other: ReLU between them, nothing after the last.
pub(crate) type Mlp = Vec<Dense>;

/// Layers between consecutive `sizes`, their parameters from `*offset` on; moves `*offset` past them.
fn layers(offset: &mut usize, sizes: &[usize]) -> Mlp {
    let layer = |pair: &[usize]| {
        let layer = Dense { inputs: pair[0], outputs: pair[1], offset: *offset };
        *offset = layer.end();
        layer
    };
    sizes.windows(2).map(layer).collect()
}

/// The five sub-networks; everything that they read and predict is standardised.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Networks {
    pub(crate) architecture: Architecture,
    /// F_φ: the distance a driver keeps. `[w (d), v_lead (1)] → f̂ (1)`, by L1 over following rows.
    pub(crate) following_distance: Mlp,
    /// Windows of v_ego, v_lead and d_x → z_l.
    pub(crate) lane_encoder: Mlp,
    /// C_ψ: whether a lane change is being started. `[w, z_l] → logits {keep, change}`. L2 trains their softmax with weighted
    /// classes, so it is the probability of a world in which both are equally frequent; [`crate::Predictor`] undoes that.
    pub(crate) lane_head: Mlp,
    /// Windows of v_lead, d_x and d_y → z_v.
    pub(crate) speed_encoder: Mlp,
    /// V_β: ego's speed. `[w, z_v] → v̂ (1)`, by L3. V never reads ego's own speed: that would teach it to copy.
    pub(crate) speed_head: Mlp,
    /// S_θ: the score of the style, by one linear layer, so that its gradient is one direction everywhere. `w → ŝ (1)`, by L4.
    pub(crate) style: Mlp,
    /// M_α: a normal over `w`. `[v_lead, z_l, z_v, f̂, P(change), v̂, ŝ] → [μ (d), ln σ (d)]`, by L5, whose gradient flows on into
    /// every predictor.
    pub(crate) mutual_information: Mlp,
    /// Length of the parameter vector.
    pub(crate) parameters: usize,
}

impl Networks {
    pub(crate) fn new(architecture: Architecture) -> Self {
        let a = &architecture;
        let (d, z) = (a.embedding_size, a.encoding_size);
        let mut offset = 0;
        let head = |offset: &mut usize, inputs: usize, outputs: usize| {
            let hidden = std::iter::repeat_n(a.hidden_units, a.hidden_layers);
            let sizes = std::iter::once(inputs).chain(hidden).chain([outputs]);
            layers(offset, &sizes.collect::<Vec<usize>>())
        };
        let encoder = [WINDOW_SIGNALS * a.window_steps, a.encoder_units, z];
        Self {
            following_distance: head(&mut offset, d + 1, 1),
            lane_encoder: layers(&mut offset, &encoder),
            lane_head: head(&mut offset, d + z, 2),
            speed_encoder: layers(&mut offset, &encoder),
            speed_head: head(&mut offset, d + z, 1),
            style: layers(&mut offset, &[d, 1]),
            mutual_information: head(&mut offset, 1 + 2 * z + 4, 2 * d),
            architecture,
            parameters: offset,
        }
    }

    pub(crate) fn all(&self) -> [&Mlp; 7] {
        [
            &self.following_distance,
            &self.lane_encoder,
            &self.lane_head,
            &self.speed_encoder,
            &self.speed_head,
            &self.style,
            &self.mutual_information,
        ]
    }

    /// Fresh parameters: weights from N(0, 2/inputs) before a ReLU and N(0, 1/inputs) at the end; biases 0 (He et al. 2015).
    pub(crate) fn initialise(&self, rng: &mut impl rand::Rng) -> Vec<f32> {
        let mut parameters = vec![0.0; self.parameters];
        for mlp in self.all() {
            for (index, layer) in mlp.iter().enumerate() {
                let gain = if index + 1 < mlp.len() { 2.0 } else { 1.0 };
                let sd = (gain / layer.inputs as f64).sqrt();
                let normal = Normal::new(0.0, sd).expect("a layer has inputs, so its SD is finite");
                for weight in &mut parameters[layer.offset..layer.biases_at()] {
                    *weight = normal.sample(rng) as f32;
                }
            }
        }
        parameters
    }
}
