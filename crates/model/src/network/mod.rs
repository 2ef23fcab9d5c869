//! The five sub-networks of the method, their parameters in one vector.

pub(crate) mod encoded;
pub(crate) mod following_distance;
pub(crate) mod lane_change;
pub(crate) mod mlp;
pub(crate) mod mutual_information;
pub(crate) mod style;
pub(crate) mod velocity;

use following_distance::FollowingDistance;
use lane_change::LaneChange;
use mlp::Mlp;
use mutual_information::MutualInformation;
use serde::{Deserialize, Serialize};
use style::Style;
use velocity::Velocity;

/// Signals that each of C and V reads a window of.
pub(crate) const WINDOW_SIGNALS: usize = 3;

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
    /// Steps of a window.
    pub window_steps: usize,
}

impl Architecture {
    fn head_sizes(&self, inputs: usize, outputs: usize) -> Vec<usize> {
        let hidden = std::iter::repeat_n(self.hidden_units, self.hidden_layers);
        std::iter::once(inputs)
            .chain(hidden)
            .chain([outputs])
            .collect()
    }

    /// Floating-point operations that a row needs, forward and back: two for each weight forward, two for its
    /// gradient, and two for the gradient of its input where that goes on (not before the windows).
    pub fn operations_per_row(&self) -> f64 {
        let networks = Networks::new(*self);
        let count = |mlps: &[&Mlp]| -> usize {
            let layers = mlps.iter().flat_map(|mlp| mlp.layers());
            layers.map(|layer| layer.inputs * layer.outputs).sum()
        };
        let windows = [
            networks.lane_change.encoded.encoder.first(),
            networks.velocity.encoded.encoder.first(),
        ];
        let free: usize = windows.iter().map(|l| l.inputs * l.outputs).sum();
        (6 * count(&networks.all()) - 2 * free) as f64
    }

    /// Number of weights and biases of all five sub-networks.
    pub fn parameters(&self) -> usize {
        Networks::new(*self).parameters
    }
}

/// The five sub-networks; a new one is one file and one line here.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Networks {
    pub(crate) architecture: Architecture,
    pub(crate) following_distance: FollowingDistance,
    pub(crate) lane_change: LaneChange,
    pub(crate) velocity: Velocity,
    pub(crate) style: Style,
    pub(crate) mutual_information: MutualInformation,
    /// Length of the parameter vector.
    pub(crate) parameters: usize,
}

impl Networks {
    pub(crate) fn new(architecture: Architecture) -> Self {
        let mut offset = 0;
        Self {
            architecture,
            following_distance: FollowingDistance::new(&mut offset, &architecture),
            lane_change: LaneChange::new(&mut offset, &architecture),
            velocity: Velocity::new(&mut offset, &architecture),
            style: Style::new(&mut offset, &architecture),
            mutual_information: MutualInformation::new(&mut offset, &architecture),
            parameters: offset,
        }
    }

    pub(crate) fn all(&self) -> [&Mlp; 7] {
        [
            &self.following_distance.head,
            &self.lane_change.encoded.encoder,
            &self.lane_change.encoded.head,
            &self.velocity.encoded.encoder,
            &self.velocity.encoded.head,
            &self.style.layer,
            &self.mutual_information.head,
        ]
    }

    /// Fresh parameters.
    pub(crate) fn initialise(&self, rng: &mut impl rand::Rng) -> Vec<f32> {
        let mut parameters = vec![0.0; self.parameters];
        for mlp in self.all() {
            mlp.initialise(&mut parameters, rng);
        }
        parameters
    }
}
