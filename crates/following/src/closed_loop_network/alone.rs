//! The network in one place, for whoever drives by it.

use super::{
    controller::{Parameters, of_outputs},
    lanes::{Lanes, nothing},
    layers::Styled,
    unrolled::inputs,
    world::World,
};

/// The network in one place, asked one moment after the other.
pub(super) struct Alone<'a> {
    world: &'a World,
    network: Styled<'a, f64, 1>,
    first: Vec<Lanes<f64, 1>>,
    second: Vec<Lanes<f64, 1>>,
}

impl<'a> Alone<'a> {
    pub(super) fn new(world: &'a World, weights: &'a [f64], embedding: &[f64]) -> Self {
        let h = world.layout.hidden;
        Self {
            world,
            network: Styled::new(world.layout, weights, |_, k| embedding[k]),
            first: vec![nothing(); h],
            second: vec![nothing(); h],
        }
    }

    /// What the network asks for at a speed.
    pub(super) fn parameters(&mut self, speed: f64) -> Parameters<f64> {
        let inputs = inputs(self.world, &[speed]);
        let outputs =
            (self.network).forward(self.first.len(), &inputs, &mut self.first, &mut self.second);
        let [values, _] = of_outputs(&outputs);
        Parameters::from_array(values.map(|value| value[0]))
    }

    /// Acceleration, in m/s², from gap (m), ego speed and lead speed (m/s).
    pub(super) fn accel_mps2(&mut self, gap: f64, speed: f64, lead: f64) -> f64 {
        let safety = &self.world.safety;
        self.parameters(speed).accel_mps2(safety, gap, speed, lead)
    }
}
