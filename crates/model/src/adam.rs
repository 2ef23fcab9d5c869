//! Adam (Kingma and Ba 2015) on one vector of numbers.

use pulp::Arch;

const FIRST_DECAY: f32 = 0.9;
const SECOND_DECAY: f32 = 0.999;
const EPSILON: f32 = 1e-8;

/// Moments of a gradient.
#[derive(Debug, Clone)]
pub(crate) struct Adam {
    pub(crate) first: Vec<f32>,
    pub(crate) second: Vec<f32>,
    pub(crate) steps: i32,
}

impl Adam {
    pub(crate) fn new(size: usize) -> Self {
        Self { first: vec![0.0; size], second: vec![0.0; size], steps: 0 }
    }

    /// Moves `values` against `gradient · scale`.
    pub(crate) fn step(&mut self, values: &mut [f32], gradient: &[f32], scale: f32, rate: f64) {
        self.steps += 1;
        let correction = |decay: f32| 1.0 - f64::from(decay).powi(self.steps);
        let rate = (rate / correction(FIRST_DECAY)) as f32;
        let second_scale = (1.0 / correction(SECOND_DECAY)) as f32;
        let moments = self.first.iter_mut().zip(&mut self.second);
        let entries = values.iter_mut().zip(gradient).zip(moments);
        Arch::new().dispatch(|| {
            for ((value, &g), (first, second)) in entries {
                let g = g * scale;
                *first = FIRST_DECAY * *first + (1.0 - FIRST_DECAY) * g;
                *second = SECOND_DECAY * *second + (1.0 - SECOND_DECAY) * g * g;
                *value -= rate * *first / ((*second * second_scale).sqrt() + EPSILON);
            }
        });
    }
}

/// Adds `decay · value` to the gradient where `is_weight` is 1; the sum of the gradient's squares then.
pub(crate) fn decay_and_norm(
    gradient: &mut [f32],
    values: &[f32],
    is_weight: &[f32],
    decay: f32,
) -> f64 {
    const LANES: usize = crate::fused::matrix::LANES;
    let mut sums = [0.0_f32; LANES];
    let blocks = gradient
        .chunks_exact_mut(LANES)
        .zip(values.chunks_exact(LANES))
        .zip(is_weight.chunks_exact(LANES));
    Arch::new().dispatch(|| {
        for ((gradient, values), mask) in blocks {
            for lane in 0..LANES {
                let g = gradient[lane] + decay * mask[lane] * values[lane];
                gradient[lane] = g;
                sums[lane] += g * g;
            }
        }
    });
    sums.iter().map(|&s| f64::from(s)).sum()
}

/// From 1 at `step` 0 to 0 at `steps`, along half a cosine.
pub(crate) fn cosine(step: usize, steps: usize) -> f64 {
    0.5 * (1.0 + libm::cos(std::f64::consts::PI * step as f64 / steps.max(1) as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adam_finds_the_bottom_of_a_bowl() {
        let mut x = [5.0_f32, -3.0];
        let mut adam = Adam::new(2);
        for step in 0..400 {
            let gradient = [2.0 * (x[0] - 1.0), 20.0 * (x[1] + 2.0)];
            adam.step(&mut x, &gradient, 1.0, 0.1 * cosine(step, 400));
        }
        assert!((x[0] - 1.0).abs() < 1e-3 && (x[1] + 2.0).abs() < 1e-3);
    }
}
