//! The training loop: batches in tiles, tiles in parallel, sums in a fixed order.

use crate::{
    adam::{Adam, cosine},
    dataset::Data,
    kernel::{ROWS, Tile, add_assign},
    losses::{LossWeights, MutualInformationLoss, Reading, Sums},
    model::active_weights,
    network::Networks,
    objective::{Inputs, Objective, Pass, aggression},
    params::TrainSettings,
    train::EpochReport,
    windows::SIGNALS,
};
use maveric_domain::stream_seed;
use rand::{SeedableRng, seq::SliceRandom};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

/// A tile of a batch with room for all it needs, kept from batch to batch.
struct Worker {
    windows: Tile<f32>,
    embedding: Tile<f32>,
    inputs: Inputs<f32>,
    pass: Pass<f32>,
    gradient: Vec<f32>,
    sums: Sums,
}

impl Worker {
    fn new(networks: &Networks) -> Self {
        let a = networks.architecture;
        Self {
            windows: Tile::zeros(SIGNALS * a.window_steps),
            embedding: Tile::zeros(a.embedding_size),
            inputs: Inputs::new(a.embedding_size),
            pass: Pass::new(networks),
            gradient: vec![0.0; networks.parameters],
            sums: Sums::default(),
        }
    }

    /// Brings rows into the tile, with noise on their windows.
    fn gather(&mut self, data: &Data, rows: &[u32], embeddings: &[f32], noise: f32, seed: u64) {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let features = self.windows.features();
        let steps = features / SIGNALS;
        let d = self.embedding.features();
        self.inputs.weights.all_mut().fill(0.0);
        let windows = self.windows.all_mut();
        for (column, &row) in rows.iter().enumerate() {
            let row = row as usize;
            let window = &data.windows[row * features..(row + 1) * features];
            for (signal, values) in window.chunks_exact(steps).enumerate() {
                let draw: [f32; 2] = [
                    StandardNormal.sample(&mut rng),
                    StandardNormal.sample(&mut rng),
                ];
                let [offset, slope] = draw.map(|n| n * noise);
                let middle = (steps - 1) as f32 / 2.0;
                let unit = slope / middle.max(1.0);
                for (step, &value) in values.iter().enumerate() {
                    windows[(signal * steps + step) * ROWS + column] =
                        value + offset + unit * (step as f32 - middle);
                }
            }
            let drive = data.drive_of[row] as usize;
            for i in 0..d {
                self.embedding.feature_mut(i)[column] = embeddings[drive * d + i];
                self.inputs.noise.feature_mut(i)[column] = StandardNormal.sample(&mut rng);
            }
            let [lead, targets @ ..] = data.values[row];
            self.inputs.lead_speed.all_mut()[column] = lead;
            for (i, target) in targets.into_iter().enumerate() {
                self.inputs.targets.feature_mut(i)[column] = target;
            }
            for (i, &weight) in data.weights[row].iter().enumerate() {
                self.inputs.weights.feature_mut(i)[column] = weight;
            }
        }
        self.pass.set_windows(&self.windows);
    }
}

/// Moves weights and embeddings, batch by batch.
pub(crate) struct Trainer<'a> {
    data: &'a Data,
    settings: &'a TrainSettings,
    networks: &'a Networks,
    weights: LossWeights,
    seed: u64,
    pub(crate) parameters: Vec<f32>,
    /// Shape `(drives, d)`.
    pub(crate) embeddings: Vec<f32>,
    adam: Adam,
    embedding_adam: Adam,
    gradient: Vec<f32>,
    embedding_gradient: Vec<f32>,
    workers: Vec<Worker>,
    order: Vec<u32>,
    batches: usize,
}

impl<'a> Trainer<'a> {
    pub(crate) fn new(
        data: &'a Data,
        settings: &'a TrainSettings,
        networks: &'a Networks,
        seed: u64,
    ) -> Self {
        let d = settings.embedding_size;
        let mut rng = Pcg64Mcg::seed_from_u64(stream_seed(seed, &["train", "weights"]));
        let parameters: Vec<f32> = networks.initialise(&mut rng);
        // One stream a drive: another drive more changes nobody's start.
        let embeddings: Vec<f32> = data
            .drives
            .iter()
            .flat_map(|drive| {
                let stream = stream_seed(seed, &["train", "embedding", drive.as_str()]);
                let mut rng = Pcg64Mcg::seed_from_u64(stream);
                let draw: Vec<f32> = (0..d).map(|_| StandardNormal.sample(&mut rng)).collect();
                draw
            })
            .collect();
        let rows = data.rows();
        let batches = ((rows as f64 / settings.batch_size as f64).round() as usize).max(1);
        let workers = rows.div_ceil(batches).div_ceil(ROWS);
        Self {
            weights: active_weights(&settings.loss_weights, data.learned),
            adam: Adam::new(parameters.len()),
            embedding_adam: Adam::new(embeddings.len()),
            gradient: vec![0.0; parameters.len()],
            embedding_gradient: vec![0.0; embeddings.len()],
            workers: (0..workers).map(|_| Worker::new(networks)).collect(),
            order: (0..rows as u32).collect(),
            data,
            settings,
            networks,
            seed,
            parameters,
            embeddings,
            batches,
        }
    }

    pub(crate) fn epoch(&mut self, epoch: usize) -> EpochReport {
        let label = epoch.to_string();
        let shuffle = stream_seed(self.seed, &["train", "order", &label]);
        self.order.shuffle(&mut Pcg64Mcg::seed_from_u64(shuffle));
        let rows = self.order.len();
        let mut sums = Sums::default();
        let (mut aggression, mut norms) = (0.0, 0.0);
        let mut rate = 0.0;
        for batch in 0..self.batches {
            let step = (epoch - 1) * self.batches + batch;
            rate = cosine(step, self.settings.epochs * self.batches);
            let range = batch * rows / self.batches..(batch + 1) * rows / self.batches;
            let (batch_sums, l4, norm) = self.step(range, step, rate);
            sums.merge(&batch_sums);
            aggression += l4.unwrap_or(0.0) / self.batches as f64;
            norms += norm / self.batches as f64;
        }
        let l4 = self.data.learned.aggression.then_some(aggression);
        let losses = sums.terms(l4, self.settings.embedding_size);
        EpochReport {
            epoch,
            epochs: self.settings.epochs,
            total: losses.total(&self.weights),
            losses,
            learning_rate: self.settings.learning_rate * rate,
            gradient_norm: norms,
        }
    }

    /// The embeddings of this batch: each drive's own plus a draw, see [`TrainSettings::embedding_noise`].
    fn shaken_embeddings(&self, seed: u64) -> Vec<f32> {
        let mut shaken = self.embeddings.clone();
        let d = self.settings.embedding_size;
        if self.settings.embedding_noise > 0.0 {
            let mut rng = Pcg64Mcg::seed_from_u64(stream_seed(seed, &["embedding"]));
            let n = (shaken.len() / d) as f64;
            for i in 0..d {
                let own = || {
                    self.embeddings
                        .iter()
                        .skip(i)
                        .step_by(d)
                        .map(|&w| f64::from(w))
                };
                let mean = own().sum::<f64>() / n;
                let sd = (own().map(|w| (w - mean).powi(2)).sum::<f64>() / n).sqrt();
                for w in shaken.iter_mut().skip(i).step_by(d) {
                    let draw: f64 = StandardNormal.sample(&mut rng);
                    *w += (self.settings.embedding_noise * sd * draw) as f32;
                }
            }
        }
        shaken
    }

    /// One batch: losses, L4 before the step, and the gradient's norm.
    fn step(
        &mut self,
        range: std::ops::Range<usize>,
        step: usize,
        rate: f64,
    ) -> (Sums, Option<f64>, f64) {
        let settings = self.settings;
        let rows = &self.order[range];
        let objective = Objective {
            networks: self.networks,
            parameters: &self.parameters,
            weights: self.weights,
            reading: match settings.mutual_information_loss {
                MutualInformationLoss::MeanSquared => Reading::Sample,
                MutualInformationLoss::GaussianLikelihood => Reading::Likelihood,
            },
            raw: None,
        };
        let scale = 1.0 / rows.len() as f64;
        let noise_seed = stream_seed(self.seed, &["train", "noise", &step.to_string()]);
        let data = self.data;
        let embeddings = &self.shaken_embeddings(noise_seed);
        let work = self.workers.par_iter_mut().zip(rows.par_chunks(ROWS));
        work.enumerate().for_each(|(index, (worker, rows))| {
            let noise = settings.window_noise as f32;
            let seed = noise_seed.wrapping_add(index as u64);
            worker.gather(data, rows, embeddings, noise, seed);
            worker.gradient.fill(0.0);
            objective.encode(&mut worker.pass);
            worker.sums = objective.evaluate(
                &worker.embedding,
                &worker.inputs,
                &mut worker.pass,
                scale,
                Some(&mut worker.gradient),
            );
            objective.encoders_backward(&mut worker.pass, &mut worker.gradient);
        });

        // Sums over tiles are taken here, in the tiles' order, whoever computed them.
        let d = settings.embedding_size;
        let mut sums = Sums::default();
        self.gradient.fill(0.0);
        self.embedding_gradient.fill(0.0);
        for (worker, rows) in self.workers.iter().zip(rows.chunks(ROWS)) {
            sums.merge(&worker.sums);
            add_assign(&mut self.gradient, &worker.gradient);
            for (column, &row) in rows.iter().enumerate() {
                let drive = data.drive_of[row as usize] as usize;
                for i in 0..d {
                    self.embedding_gradient[drive * d + i] +=
                        worker.pass.embedding_gradient.feature(i)[column];
                }
            }
        }
        let aggression = aggression(
            &self.networks.style,
            (&self.parameters, &self.embeddings),
            &self.data.adb,
            self.weights.aggression,
            &mut self.gradient,
            &mut self.embedding_gradient,
        );
        for layer in self.networks.all().iter().flat_map(|mlp| mlp.layers()) {
            for i in layer.offset..layer.biases_at() {
                self.gradient[i] += settings.weight_decay as f32 * self.parameters[i];
            }
        }
        let squares = |values: &[f32]| -> f64 { values.iter().map(|&g| f64::from(g * g)).sum() };
        let norm = (squares(&self.gradient) + squares(&self.embedding_gradient)).sqrt();
        let clip = (settings.gradient_clip / norm.max(settings.gradient_clip)) as f32;
        self.adam.step(
            &mut self.parameters,
            &self.gradient,
            clip,
            settings.learning_rate * rate,
        );
        self.embedding_adam.step(
            &mut self.embeddings,
            &self.embedding_gradient,
            clip,
            settings.embedding_learning_rate * rate,
        );
        (sums, aggression, norm)
    }
}
