//! L1 + L2 + L3 + L5 over one tile of rows, and their gradient by the parameters and by `w`.
//!
//! Training and personalising share it: one has a driver a row, windows to encode and parameters to
//! move; the other has one `w`, codes made once, and frozen parameters.

use crate::{
    kernel::{ROWS, Real, Tile, add_assign, affine, back_input},
    losses::{LossWeights, Reading, Sums, cross_entropy, log_likelihood, normal, squared_error},
    network::{
        Networks, WINDOW_SIGNALS,
        encoded::EncodedPass,
        lane_change::LaneChangePass,
        mlp::MlpPass,
        mutual_information::{Output, Reads},
        style::Style,
    },
};

/// What is known about the rows of a tile; rows past the data have weight 0 everywhere.
#[derive(Debug)]
pub(crate) struct Inputs<T> {
    /// ε of the reparameterised sample, `(d, ROWS)`.
    pub(crate) noise: Tile<T>,
    /// v_lead now, standardised.
    pub(crate) lead_speed: Tile<T>,
    /// Targets of F, C and V: standardised distance, 1 for a change, standardised speed; `(3, ROWS)`.
    pub(crate) targets: Tile<T>,
    /// Weights of each row in L1, L2, L3 and L5; `(4, ROWS)`.
    pub(crate) weights: Tile<T>,
}

impl<T: Real> Inputs<T> {
    pub(crate) fn new(embedding_size: usize) -> Self {
        Self {
            noise: Tile::zeros(embedding_size),
            lead_speed: Tile::zeros(1),
            targets: Tile::zeros(3),
            weights: Tile::zeros(4),
        }
    }
}

/// A tile on its way through all five sub-networks.
#[derive(Debug)]
pub(crate) struct Pass<T> {
    following_distance: MlpPass<T>,
    pub(crate) lane_change: LaneChangePass<T>,
    pub(crate) velocity: EncodedPass<T>,
    style: MlpPass<T>,
    mutual_information: MlpPass<T>,
    /// `w` in the coordinates of M.
    raw: Tile<T>,
    raw_gradient: Tile<T>,
    scratch: Tile<T>,
    /// Gradient by `w` of each row, `(d, ROWS)`.
    pub(crate) embedding_gradient: Tile<T>,
}

impl<T: Real> Pass<T> {
    pub(crate) fn new(networks: &Networks) -> Self {
        let d = networks.architecture.embedding_size;
        Self {
            following_distance: MlpPass::new(&networks.following_distance.head),
            lane_change: LaneChangePass::new(&networks.lane_change),
            velocity: EncodedPass::new(&networks.velocity.encoded),
            style: MlpPass::new(&networks.style.layer),
            mutual_information: MlpPass::new(&networks.mutual_information.head),
            raw: Tile::zeros(d),
            raw_gradient: Tile::zeros(d),
            scratch: Tile::zeros(d),
            embedding_gradient: Tile::zeros(d),
        }
    }

    /// Puts windows, shape `(4 × steps, ROWS)` in the order v_ego, v_lead, d_x, d_y, before both encoders.
    pub(crate) fn set_windows(&mut self, windows: &Tile<T>) {
        let all = windows.features();
        let read = self.lane_change.encoded.encoder.input().features();
        self.lane_change
            .encoded
            .encoder
            .input()
            .all_mut()
            .copy_from_slice(windows.range(0..read));
        self.velocity
            .encoder
            .input()
            .all_mut()
            .copy_from_slice(windows.range(all - read..all));
    }
}

/// Signals in the order of a window; C reads the first three, V the last three.
const _: () = assert!(WINDOW_SIGNALS == 3);

/// `raw = root · w + mean`: from the coordinates of an embedding to those M was trained in.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RawMap<T> {
    /// Shape `(d, d)`, row by row.
    pub(crate) root: Vec<T>,
    /// Shape `(d,)`.
    pub(crate) mean: Vec<T>,
}

/// The losses as a function of parameters and embeddings.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Objective<'a, T> {
    pub(crate) networks: &'a Networks,
    pub(crate) parameters: &'a [T],
    pub(crate) weights: LossWeights,
    pub(crate) reading: Reading,
    /// `None` while training, when both coordinates are one.
    pub(crate) raw: Option<&'a RawMap<T>>,
}

impl<T: Real> Objective<'_, T> {
    /// Encodes the windows that [`Pass::set_windows`] put there.
    pub(crate) fn encode(&self, pass: &mut Pass<T>) {
        let n = self.networks;
        n.lane_change
            .encoded
            .encoder
            .forward(self.parameters, &mut pass.lane_change.encoded.encoder);
        n.velocity
            .encoded
            .encoder
            .forward(self.parameters, &mut pass.velocity.encoder);
    }

    /// From codes and `w`, shape `(d, ROWS)`, to the losses; gradients are of the weighted sum times `scale`. Adds the heads'
    /// gradient to `gradient`; fills `pass.embedding_gradient` and the codes' gradients.
    pub(crate) fn evaluate(
        &self,
        w: &Tile<T>,
        inputs: &Inputs<T>,
        pass: &mut Pass<T>,
        scale: f64,
        mut gradient: Option<&mut [T]>,
    ) -> Sums {
        let n = self.networks;
        let p = self.parameters;
        n.following_distance
            .forward(p, w, &inputs.lead_speed, &mut pass.following_distance);
        n.lane_change.forward(p, w, &mut pass.lane_change);
        n.velocity.encoded.forward(p, w, &mut pass.velocity);
        let mut sums = Sums::default();
        self.predictor_losses(inputs, pass, scale, &mut sums);

        pass.embedding_gradient.all_mut().fill(T::default());
        if self.weights.mutual_information > 0.0 {
            sums = self.mutual_information(w, inputs, pass, (scale, sums), gradient.as_deref_mut());
        } else {
            let codes = [&mut pass.lane_change.encoded, &mut pass.velocity];
            for code in codes {
                code.encoder.output_gradient().all_mut().fill(T::default());
            }
        }

        let to_w = &mut pass.embedding_gradient;
        n.following_distance.backward(
            p,
            gradient.as_deref_mut(),
            &mut pass.following_distance,
            to_w,
        );
        n.lane_change.encoded.backward(
            p,
            gradient.as_deref_mut(),
            &mut pass.lane_change.encoded,
            to_w,
        );
        n.velocity
            .encoded
            .backward(p, gradient, &mut pass.velocity, to_w);
        sums
    }

    /// Takes the codes' gradients that [`Self::evaluate`] left back through the encoders.
    #[cfg(test)]
    pub(crate) fn encoders_backward(&self, pass: &mut Pass<T>, gradient: &mut [T]) {
        let n = self.networks;
        let p = self.parameters;
        let lane_change = &mut pass.lane_change.encoded.encoder;
        n.lane_change
            .encoded
            .encoder
            .backward(p, Some(gradient), lane_change, false);
        n.velocity
            .encoded
            .encoder
            .backward(p, Some(gradient), &mut pass.velocity.encoder, false);
    }

    /// L1, L2 and L3; fills the output gradients of F, C and V.
    fn predictor_losses(
        &self,
        inputs: &Inputs<T>,
        pass: &mut Pass<T>,
        scale: f64,
        sums: &mut Sums,
    ) {
        let squared = |pass: &mut MlpPass<T>, index: usize, row_weights: &[T], weight: f64| {
            let mut sum = crate::losses::Sum::default();
            let targets = inputs.targets.feature(index);
            for (row, (&c, &target)) in row_weights.iter().zip(targets).enumerate() {
                let scaled = T::from_f64(c.f64() * weight * scale);
                let (loss, slope) = squared_error(pass.output().all()[row], target, scaled);
                pass.output_gradient().all_mut()[row] = slope;
                sum.add(loss, c.f64());
            }
            sum
        };
        sums.following_distance = squared(
            &mut pass.following_distance,
            0,
            inputs.weights.feature(0),
            self.weights.following_distance,
        );
        sums.velocity = squared(
            &mut pass.velocity.head,
            2,
            inputs.weights.feature(2),
            self.weights.velocity,
        );
        let head = &mut pass.lane_change.encoded.head;
        for row in 0..ROWS {
            let c = inputs.weights.feature(1)[row];
            let scaled = T::from_f64(c.f64() * self.weights.lane_change * scale);
            let (keep, change) = (head.output().feature(0)[row], head.output().feature(1)[row]);
            let probability = pass.lane_change.probability.all()[row];
            let target = inputs.targets.feature(1)[row];
            let (loss, slopes) = cross_entropy(keep, change, probability, target, scaled);
            head.output_gradient().feature_mut(0)[row] = slopes[0];
            head.output_gradient().feature_mut(1)[row] = slopes[1];
            sums.lane_change.add(loss, c.f64());
        }
    }

    /// S and M forward, L5, and both backward: adds to the output gradients of F, C and V, sets those of
    /// the codes, adds to `w`'s.
    fn mutual_information(
        &self,
        w: &Tile<T>,
        inputs: &Inputs<T>,
        pass: &mut Pass<T>,
        (scale, mut sums): (f64, Sums),
        mut gradient: Option<&mut [T]>,
    ) -> Sums {
        let (n, p) = (self.networks, self.parameters);
        let m = &n.mutual_information;
        n.style.forward(p, w, &mut pass.style);
        let reads = Reads {
            lead_speed: &inputs.lead_speed,
            lane_context: pass.lane_change.encoded.encoder.output(),
            speed_context: pass.velocity.encoder.output(),
            following_distance: pass.following_distance.output(),
            probability: &pass.lane_change.probability,
            speed: pass.velocity.head.output(),
            aggression: pass.style.output(),
        };
        m.forward(p, &reads, &mut pass.mutual_information);
        match self.raw {
            Some(map) => affine(&map.root, &map.mean, w.all(), pass.raw.all_mut()),
            None => pass.raw.all_mut().copy_from_slice(w.all()),
        }
        let d = pass.raw.features();
        let weights = inputs.weights.feature(3);
        let share = self.weights.mutual_information * scale / d as f64;
        for (row, &c) in weights.iter().enumerate() {
            let c = c.f64();
            let (mut loss, mut likelihood, mut error) = (0.0, 0.0, 0.0);
            for i in 0..d {
                let out = pass.mutual_information.output();
                let (mean, log_sd) = (out.feature(i)[row], out.feature(d + i)[row]);
                let (noise, target) = (inputs.noise.feature(i)[row], pass.raw.feature(i)[row]);
                let (one, slope) = normal(
                    self.reading,
                    [mean, log_sd, noise, target],
                    T::from_f64(c * share),
                );
                loss += one;
                likelihood += log_likelihood(mean, log_sd, target);
                error += (mean - target).f64().powi(2);
                let gradient = pass.mutual_information.output_gradient();
                gradient.feature_mut(i)[row] = slope.mean;
                gradient.feature_mut(d + i)[row] = slope.log_sd;
                pass.raw_gradient.feature_mut(i)[row] = slope.embedding;
            }
            sums.mutual_information.add(loss / d as f64, c);
            sums.log_likelihood.add(likelihood, c);
            sums.reading.add(error / d as f64, c);
        }

        m.backward(p, gradient.as_deref_mut(), &mut pass.mutual_information);
        match self.raw {
            Some(map) => {
                let scratch = pass.scratch.all_mut();
                back_input(&map.root, pass.raw_gradient.all(), scratch);
                add_assign(pass.embedding_gradient.all_mut(), scratch);
            }
            None => add_assign(pass.embedding_gradient.all_mut(), pass.raw_gradient.all()),
        }
        let mi = &pass.mutual_information;
        m.add_output_gradient(
            mi,
            Output::FollowingDistance,
            pass.following_distance.output_gradient(),
        );
        m.add_output_gradient(mi, Output::Speed, pass.velocity.head.output_gradient());
        let by_probability = m.output_gradient(mi, Output::Probability);
        let logits = pass.lane_change.encoded.head.output_gradient();
        for (row, &slope) in by_probability.iter().enumerate() {
            let p = pass.lane_change.probability.all()[row];
            let slope = slope * p * (T::from_f64(1.0) - p);
            let keep = &mut logits.feature_mut(0)[row];
            *keep = *keep - slope;
            let change = &mut logits.feature_mut(1)[row];
            *change = *change + slope;
        }
        let encoder = &mut pass.lane_change.encoded.encoder;
        encoder
            .output_gradient()
            .all_mut()
            .copy_from_slice(m.lane_context_gradient(mi));
        let encoder = &mut pass.velocity.encoder;
        encoder
            .output_gradient()
            .all_mut()
            .copy_from_slice(m.speed_context_gradient(mi));
        pass.style
            .output_gradient()
            .all_mut()
            .copy_from_slice(m.output_gradient(mi, Output::Aggression));
        n.style
            .backward(p, gradient, &mut pass.style, &mut pass.embedding_gradient);
        sums
    }
}

/// L4, the mean of `(S(w) − s)²` over the drives with a score `s`; `None` without any.
///
/// `embeddings` has shape `(drives, d)`. Adds `weight` times the gradients to those of the parameters and
/// of the embeddings.
pub(crate) fn aggression<T: Real>(
    style: &Style,
    (parameters, embeddings): (&[T], &[T]),
    scores: &[Option<T>],
    weight: f64,
    gradient: &mut [T],
    embedding_gradient: &mut [T],
) -> Option<f64> {
    let scored = scores.iter().flatten().count();
    if scored == 0 {
        return None;
    }
    let dense = style.dense();
    let d = dense.inputs;
    let share = T::from_f64(weight / scored as f64);
    let mut sum = 0.0;
    for (index, score) in scores.iter().enumerate() {
        let Some(score) = *score else { continue };
        let w = &embeddings[index * d..(index + 1) * d];
        let (loss, slope) = squared_error(style.value(parameters, w), score, share);
        sum += loss;
        for i in 0..d {
            let weight = dense.offset + i;
            gradient[weight] = gradient[weight] + slope * w[i];
            let to = &mut embedding_gradient[index * d + i];
            *to = *to + slope * parameters[weight];
        }
        let bias = dense.biases_at();
        gradient[bias] = gradient[bias] + slope;
    }
    Some(sum / scored as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::Architecture;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64Mcg;

    const SMALL: Architecture = Architecture {
        embedding_size: 3,
        hidden_units: 7,
        hidden_layers: 2,
        encoder_units: 6,
        encoding_size: 5,
        window_steps: 4,
    };

    struct Problem {
        networks: Networks,
        windows: Tile<f64>,
        inputs: Inputs<f64>,
        embedding: Tile<f64>,
        parameters: Vec<f64>,
        raw: RawMap<f64>,
    }

    impl Problem {
        fn new() -> Self {
            let mut rng = Pcg64Mcg::seed_from_u64(11);
            let networks = Networks::new(SMALL);
            let mut parameters: Vec<f64> = networks.initialise(&mut rng);
            let mut normal = |n: usize| -> Vec<f64> {
                (0..n).map(|_| StandardNormal.sample(&mut rng)).collect()
            };
            for (p, n) in parameters.iter_mut().zip(normal(networks.parameters)) {
                *p += 0.1 * n;
            }
            let mut fill = |tile: &mut Tile<f64>| {
                let n = tile.all().len();
                tile.all_mut().copy_from_slice(&normal(n));
            };
            let mut inputs = Inputs::new(3);
            let mut windows = Tile::zeros(16);
            let mut embedding = Tile::zeros(3);
            fill(&mut windows);
            fill(&mut embedding);
            fill(&mut inputs.noise);
            fill(&mut inputs.lead_speed);
            fill(&mut inputs.targets);
            fill(&mut inputs.weights);
            for w in inputs.weights.all_mut() {
                *w = w.max(0.0);
            }
            for target in inputs.targets.feature_mut(1) {
                *target = f64::from(u8::from(*target > 0.5));
            }
            let raw = RawMap {
                root: vec![1.2, 0.3, 0.0, 0.3, 0.8, -0.2, 0.0, -0.2, 1.5],
                mean: vec![0.4, -0.1, 0.2],
            };
            Self {
                networks,
                windows,
                inputs,
                embedding,
                parameters,
                raw,
            }
        }

        /// The weighted loss; and its gradients by the parameters and by every row's `w`.
        fn evaluate(
            &self,
            weights: LossWeights,
            reading: Reading,
            mapped: bool,
        ) -> (f64, Vec<f64>, Vec<f64>) {
            let objective = Objective {
                networks: &self.networks,
                parameters: &self.parameters,
                weights,
                reading,
                raw: mapped.then_some(&self.raw),
            };
            let mut pass = Pass::new(&self.networks);
            pass.set_windows(&self.windows);
            objective.encode(&mut pass);
            let mut gradient = vec![0.0; self.parameters.len()];
            let scale = 1.0 / 37.0;
            let sums = objective.evaluate(
                &self.embedding,
                &self.inputs,
                &mut pass,
                scale,
                Some(&mut gradient),
            );
            objective.encoders_backward(&mut pass, &mut gradient);
            let by_w = pass.embedding_gradient.all().to_vec();
            (sums.weighted(&weights) * scale, gradient, by_w)
        }

        fn check(&mut self, weights: LossWeights, reading: Reading, mapped: bool) -> f64 {
            let (_, gradient, by_w) = self.evaluate(weights, reading, mapped);
            let step = 1e-6;
            let value = |p: &Self| p.evaluate(weights, reading, mapped).0;
            let near = |what: &str, index: usize, found: f64, numeric: f64| {
                // Central differences of the likelihood, whose values are large, are less exact.
                let tolerance = 1e-5 * (1.0 + numeric.abs());
                assert!(
                    (found - numeric).abs() < tolerance,
                    "{what} {index}: {found} {numeric} ({weights:?}, {reading:?})"
                );
            };
            for (index, &found) in gradient.iter().enumerate() {
                let at = self.parameters[index];
                self.parameters[index] = at + step;
                let above = value(self);
                self.parameters[index] = at - step;
                let below = value(self);
                self.parameters[index] = at;
                near("parameter", index, found, (above - below) / (2.0 * step));
            }
            for index in (0..by_w.len()).step_by(13) {
                let at = self.embedding.all()[index];
                self.embedding.all_mut()[index] = at + step;
                let above = value(self);
                self.embedding.all_mut()[index] = at - step;
                let below = value(self);
                self.embedding.all_mut()[index] = at;
                near("w", index, by_w[index], (above - below) / (2.0 * step));
            }
            gradient.iter().map(|g| g * g).sum::<f64>().sqrt()
        }
    }

    const NONE: LossWeights = LossWeights {
        following_distance: 0.0,
        lane_change: 0.0,
        velocity: 0.0,
        aggression: 0.0,
        mutual_information: 0.0,
    };

    #[test]
    fn every_predictor_loss_has_its_gradient_by_every_parameter_and_w() {
        let mut problem = Problem::new();
        let each = [
            LossWeights {
                following_distance: 1.0,
                ..NONE
            },
            LossWeights {
                lane_change: 1.0,
                ..NONE
            },
            LossWeights {
                velocity: 1.0,
                ..NONE
            },
        ];
        for weights in each {
            assert!(problem.check(weights, Reading::Sample, false) > 1e-3);
        }
    }

    #[test]
    fn l5_flows_through_m_into_every_sub_network_and_w() {
        let mut problem = Problem::new();
        let weights = LossWeights {
            mutual_information: 1.0,
            ..NONE
        };
        for reading in [Reading::Sample, Reading::Expected, Reading::Likelihood] {
            problem.check(weights, reading, false);
            problem.check(weights, reading, true);
        }
        let (_, gradient, _) = problem.evaluate(weights, Reading::Sample, false);
        for mlp in problem.networks.all() {
            let first = mlp.first();
            let part = &gradient[first.offset..first.end()];
            assert!(part.iter().any(|g| g.abs() > 1e-6));
        }
    }

    #[test]
    fn the_sum_of_all_losses_has_the_sum_of_their_gradients() {
        Problem::new().check(LossWeights::default(), Reading::Sample, true);
    }

    #[test]
    fn l4_has_its_gradient_by_s_and_by_w() {
        let problem = Problem::new();
        let n = problem.parameters.len();
        let scores = [Some(0.7), None, Some(-1.1)];
        let mut w = vec![0.3, -0.5, 1.0, 0.2, 0.1, -0.9, 1.4, 0.6, -0.2];
        let value = |p: &[f64], w: &[f64]| {
            let (mut by_p, mut by_w) = (vec![0.0; n], vec![0.0; 9]);
            let style = &problem.networks.style;
            let l4 = aggression(style, (p, w), &scores, 0.3, &mut by_p, &mut by_w);
            (0.3 * l4.unwrap(), by_p, by_w)
        };
        let mut p = problem.parameters.clone();
        let (_, by_p, by_w) = value(&p, &w);
        let slope = |values: &mut Vec<f64>, i: usize, f: &dyn Fn(&[f64]) -> f64| {
            let at = values[i];
            values[i] = at + 1e-6;
            let above = f(values);
            values[i] = at - 1e-6;
            let below = f(values);
            values[i] = at;
            (above - below) / 2e-6
        };
        for (i, found) in by_w.iter().enumerate() {
            let at = p.clone();
            let numeric = slope(&mut w, i, &|w| value(&at, w).0);
            assert!((found - numeric).abs() < 1e-7);
        }
        for (i, found) in by_p.iter().enumerate() {
            let numeric = slope(&mut p, i, &|p| value(p, &w).0);
            assert!((found - numeric).abs() < 1e-7);
        }
    }
}
