//! The losses of one row in plain double-precision loops that share nothing with the kernel: its witness.

use crate::fused::tile::Known;
use crate::{
    losses::{LossWeights, Reading},
    network::{Mlp, Networks},
};

/// What the losses of one row depend on beside `w` and the parameters.
pub(super) struct Row<'a> {
    /// Shape `(4 × steps,)`, in the order v_ego, v_lead, d_x, d_y.
    pub(super) window: &'a [f32],
    /// ε of the reparameterised sample, shape `(d,)`.
    pub(super) noise: &'a [f32],
    pub(super) known: Known,
}

fn run(mlp: &Mlp, parameters: &[f64], input: Vec<f64>) -> Vec<f64> {
    let mut x = input;
    for (index, layer) in mlp.iter().enumerate() {
        assert_eq!(x.len(), layer.inputs);
        let lines = layer.weights(parameters).chunks_exact(layer.inputs);
        let y = lines.zip(layer.biases(parameters)).map(|(line, bias)| {
            let sum: f64 = line.iter().zip(&x).map(|(w, x)| w * x).sum();
            let y = bias + sum;
            if index + 1 < mlp.len() { y.max(0.0) } else { y }
        });
        x = y.collect();
    }
    x
}

/// The weighted sum of L1, L2, L3 and L5, as the method states them.
pub(super) fn loss(
    n: &Networks,
    parameters: &[f64],
    w: &[f64],
    row: &Row<'_>,
    weights: &LossWeights,
    reading: Reading,
) -> f64 {
    let run = |mlp: &Mlp, input: Vec<f64>| run(mlp, parameters, input);
    let with = |z: &[f64]| -> Vec<f64> { w.iter().chain(z).copied().collect() };
    let steps = n.architecture.window_steps;
    let window: Vec<f64> = row.window.iter().map(|&v| f64::from(v)).collect();
    let [lead, distance, change, speed] = row.known.values.map(f64::from);
    let [c1, c2, c3, c5] = row.known.weights.map(f64::from);

    let z_l = run(&n.lane_encoder, window[..3 * steps].to_vec());
    let z_v = run(&n.speed_encoder, window[steps..].to_vec());
    let f_hat = run(&n.following_distance, with(&[lead]))[0];
    let logits = run(&n.lane_head, with(&z_l));
    let v_hat = run(&n.speed_head, with(&z_v))[0];
    let s_hat = run(&n.style, w.to_vec())[0];
    let p = logits[1].exp() / (logits[0].exp() + logits[1].exp());
    let right = if change > 0.5 { p } else { 1.0 - p };

    let outputs = [f_hat, p, v_hat, s_hat];
    let reads = std::iter::once(lead).chain(z_l).chain(z_v).chain(outputs);
    let m = run(&n.mutual_information, reads.collect());
    let d = w.len();
    let l5 = (0..d).map(|i| {
        let (mean, log_sd) = (m[i], m[d + i].clamp(-6.0, 3.0));
        let sampled = mean + log_sd.exp() * f64::from(row.noise[i]);
        match reading {
            Reading::Sample => (sampled - w[i]).powi(2),
            Reading::Expected => (mean - w[i]).powi(2) + (2.0 * log_sd).exp(),
            Reading::Likelihood => 0.5 * ((w[i] - mean) / log_sd.exp()).powi(2) + log_sd,
        }
    });
    let l5 = l5.sum::<f64>() / d as f64;

    weights.following_distance * c1 * (f_hat - distance).powi(2)
        - weights.lane_change * c2 * right.ln()
        + weights.velocity * c3 * (v_hat - speed).powi(2)
        + weights.mutual_information * c5 * l5
}
