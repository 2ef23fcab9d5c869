//! The training loop: batches through [`crate::fused`], weight decay, clipping and Adam.

use crate::{
    adam::{Adam, cosine, decay_and_norm},
    dataset::{Data, RowSet},
    epochs::EpochReport,
    error::ModelError,
    fused::{
        batch::{At, Batches},
        matrix::Aligned,
        tile::Tile,
    },
    heads::LearnedFrom,
    losses::{LossWeights, MutualInformationLoss, Reading, Sums, aggression},
    model::{Heads, Model, ModelParts, TrainingEmbedding},
    network::Networks,
    paper::PaperNetworks,
    params::TrainSettings,
    whitening::Whitening,
    windows::SIGNALS,
};
use maveric_domain::{Embedding, stream_seed};
use nalgebra::DVector;
use pulp::Arch;
use rand::{SeedableRng, seq::SliceRandom};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use std::ops::Range;

/// Brings rows into a tile, with noise on their windows.
fn gather(data: &RowSet, rows: &[u32], (noise, d): (f32, usize), seed: u64, tile: &mut Tile) {
    // All rows first: they lie anywhere in memory, and the waits for them overlap if nothing else comes between.
    data.fill(rows.iter().map(|&row| row as usize), tile);
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let numbers = data.window_numbers();
    let steps = numbers / SIGNALS;
    let middle = (steps - 1) as f32 / 2.0;
    for row in 0..rows.len() {
        let window = &mut tile.windows.row_mut(row)[..numbers];
        for values in window.chunks_exact_mut(steps) {
            let offset: f32 = StandardNormal.sample(&mut rng);
            let slope: f32 = StandardNormal.sample(&mut rng);
            let unit = noise * slope / middle.max(1.0);
            let first = noise * offset - unit * middle;
            for (step, value) in values.iter_mut().enumerate() {
                *value += first + unit * step as f32;
            }
        }
        for epsilon in &mut tile.noise.row_mut(row)[..d] {
            *epsilon = StandardNormal.sample(&mut rng);
        }
    }
}

/// Moves weights and embeddings, batch by batch.
pub(crate) struct Trainer<'a> {
    data: &'a Data,
    settings: &'a TrainSettings,
    weights: LossWeights,
    seed: u64,
    /// As [`crate::fused::layout`] has them.
    packed: Aligned,
    is_weight: Aligned,
    /// Shape `(drives, d)`.
    embeddings: Vec<f32>,
    adam: Adam,
    embedding_adam: Adam,
    kernel: Batches,
    order: Vec<u32>,
    batches: usize,
    epochs: usize,
}

impl<'a> Trainer<'a> {
    /// A training of so many epochs, before the first.
    pub(crate) fn new(
        data: &'a Data,
        settings: &'a TrainSettings,
        seed: u64,
        epochs: usize,
    ) -> Self {
        let d = settings.embedding_size;
        let networks = Networks::new(settings.architecture());
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
                // Embeddings that never move stay where they tell nobody from anybody.
                let moves = settings.embedding_learning_rate > 0.0;
                if moves { draw } else { vec![0.0; d] }
            })
            .collect();
        let rows = data.rows.len();
        let batches = ((rows as f64 / settings.batch_size as f64).round() as usize).max(1);
        let most = rows.div_ceil(batches);
        let kernel = Batches::new(Arch::new(), &networks, data.drives.len(), most);
        let packed = kernel.layout.pack(&parameters);
        Self {
            weights: data.active_weights(&settings.loss_weights),
            adam: Adam::new(packed.len()),
            embedding_adam: Adam::new(embeddings.len()),
            is_weight: kernel.layout.is_weight(),
            kernel,
            order: Vec::with_capacity(rows),
            data,
            settings,
            seed,
            packed,
            embeddings,
            batches,
            epochs,
        }
    }

    /// Whitens the embeddings and packs what was learned so far.
    pub(crate) fn model(&self, learned_from: &LearnedFrom) -> Result<Model, ModelError> {
        let (data, settings) = (self.data, self.settings);
        let d = settings.embedding_size;
        let raw = self.embeddings.chunks_exact(d);
        let raw: Vec<DVector<f64>> =
            raw.map(|w| DVector::from_iterator(d, w.iter().map(|&x| f64::from(x)))).collect();
        let (whitening, white) = Whitening::from_embeddings(&raw, d);
        let mut training = Vec::with_capacity(white.len());
        for ((drive, w), &mean_speed_mps) in
            data.drives.iter().zip(&white).zip(&data.mean_speed_mps)
        {
            training.push(TrainingEmbedding {
                drive: drive.clone(),
                embedding: Embedding::new(w.iter().copied().collect())?,
                mean_speed_mps,
            });
        }
        Model::try_from(ModelParts {
            embedding_size: d,
            score_range: data.score_range,
            population: learned_from.population.clone(),
            posted: learned_from.posted,
            training,
            days: None,
            heads: Heads::Paper(Box::new(PaperNetworks {
                architecture: settings.architecture(),
                windows: settings.windows(),
                row_rate_hz: settings.row_rate_hz,
                loss_weights: self.weights,
                scaling: data.scaling,
                row_weights: data.row_weights,
                learned: data.learned,
                speed_range_mps: data.speed_range_mps,
                whitening,
                habits: learned_from.habits.clone(),
                parameters: self.kernel.layout.unpack(&self.packed),
            })),
        })
    }

    /// One epoch, if it stays among numbers.
    pub(crate) fn epoch(&mut self, epoch: usize) -> Result<EpochReport, ModelError> {
        let label = epoch.to_string();
        let shuffle = stream_seed(self.seed, &["train", "order", &label]);
        let rows = self.data.rows.len();
        // From the rows' own order each time, so that an epoch knows nothing of those before.
        self.order.clear();
        self.order.extend(0..rows as u32);
        self.order.shuffle(&mut Pcg64Mcg::seed_from_u64(shuffle));
        let mut sums = Sums::default();
        let mut aggression = 0.0;
        for batch in 0..self.batches {
            let step = (epoch - 1) * self.batches + batch;
            let range = batch * rows / self.batches..(batch + 1) * rows / self.batches;
            let (batch_sums, l4) = self.step(range, step);
            sums.merge(&batch_sums);
            aggression += l4.unwrap_or(0.0) / self.batches as f64;
        }
        let l4 = self.data.learned.aggression.then_some(aggression);
        let losses = sums.terms(l4, self.settings.embedding_size);
        let total = losses.total(&self.weights);
        if !total.is_finite() || self.packed.iter().any(|p| !p.is_finite()) {
            return Err(ModelError::Diverged { epoch });
        }
        Ok(EpochReport {
            epoch,
            epochs: self.epochs,
            rows,
            total,
            losses,
            validation: None,
            validation_total: None,
        })
    }

    /// One batch: losses, and L4 before the step.
    fn step(&mut self, range: Range<usize>, step: usize) -> (Sums, Option<f64>) {
        let settings = self.settings;
        let rate = cosine(step, self.epochs * self.batches);
        let rows = &self.order[range];
        let point = At {
            packed: &self.packed,
            embeddings: &self.embeddings,
            weights: self.weights,
            reading: match settings.mutual_information_loss {
                MutualInformationLoss::MeanSquared => Reading::Sample,
                MutualInformationLoss::GaussianLikelihood => Reading::Likelihood,
            },
        };
        let noise_seed = stream_seed(self.seed, &["train", "noise", &step.to_string()]);
        let data = &self.data.rows;
        let noise = (settings.window_noise as f32, settings.embedding_size);
        let sums = self.kernel.evaluate(
            &point,
            rows.len(),
            |row| data.drive_of[rows[row] as usize],
            |tile, range| {
                let seed = noise_seed.wrapping_add(range.start as u64);
                gather(data, &rows[range], noise, seed, tile);
            },
        );
        let l4 = self.aggression();
        let gradient = &mut self.kernel.gradient;
        let by_embedding = &self.kernel.embedding_gradient;
        let decay = settings.weight_decay as f32;
        let squares = decay_and_norm(gradient, &self.packed, &self.is_weight, decay);
        let embedding_squares = by_embedding.iter().map(|&g| f64::from(g * g)).sum::<f64>();
        let norm = (squares + embedding_squares).sqrt();
        let clip = (settings.gradient_clip / norm.max(settings.gradient_clip)) as f32;
        let rates = [settings.learning_rate, settings.embedding_learning_rate];
        let [by_weight, by_w] = rates.map(|r| r * rate);
        self.adam.step(&mut self.packed, gradient, clip, by_weight);
        self.embedding_adam.step(&mut self.embeddings, by_embedding, clip, by_w);
        (sums, l4)
    }

    /// L4, whose gradients are added to those of the batch.
    fn aggression(&mut self) -> Option<f64> {
        let layer = &self.kernel.layout.style[0];
        let d = self.settings.embedding_size;
        let layer_weights = layer.embedding_weights(&self.packed);
        let mut parameters: Vec<f32> =
            layer_weights.chunks_exact(layer.width).map(|l| l[0]).collect();
        parameters.push(layer.biases(&self.packed)[0]);
        let mut gradient = vec![0.0; d + 1];
        let l4 = aggression(
            (&parameters, &self.embeddings),
            &self.data.adb,
            self.weights.aggression,
            &mut gradient,
            &mut self.kernel.embedding_gradient,
        );
        let to = layer.embedding_weights_mut(&mut self.kernel.gradient);
        for (line, g) in to.chunks_exact_mut(layer.width).zip(&gradient) {
            line[0] += g;
        }
        layer.biases_mut(&mut self.kernel.gradient)[0] += gradient[d];
        l4
    }
}
