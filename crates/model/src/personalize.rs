//! Personalising: all weights frozen, an embedding fitted to one driver's drive.

use crate::{
    bfgs::{Minimum, minimise},
    error::{ModelError, ModelWarning},
    kernel::{ROWS, Tile},
    linear_algebra::norm,
    losses::{Loss, LossTerms, LossWeights, MutualInformationLoss, Reading, Sums},
    model::Model,
    objective::{Inputs, Objective, Pass, RawMap},
    params::PersonalizeParams,
    rows::{Row, rows_of},
    windows::SIGNALS,
};
use maveric_domain::{AdbScore, Drive, Embedding, stream_seed};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

/// Where one start led.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Start {
    /// Where it began; the first is the mean of the training embeddings.
    pub from: Embedding,
    /// Where it ended.
    pub to: Embedding,
    /// What it reached.
    pub objective: f64,
    /// Steps it took.
    pub iterations: usize,
}

/// A driver in style space.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Personalized {
    /// The best of the starts.
    pub embedding: Embedding,
    /// The weighted sum there: the training objective over this driver's rows.
    pub objective: f64,
    /// Each loss there, a mean over the rows it concerns.
    pub losses: LossTerms,
    /// Root mean square distance of the starts' ends from the best, in SDs of the training embeddings.
    pub start_spread: f64,
    /// Every start.
    pub starts: Vec<Start>,
    /// M's mean over the drive, read at the mean training embedding; `None` if M was not trained. M reads outputs
    /// that were made with `w`, so this follows the fitted embedding weakly, and with any sign.
    pub amortized_guess: Option<Embedding>,
    /// S's reading at the embedding, in ADB points; `None` if the model has no aggression axis.
    pub aggression_hat: Option<f64>,
    /// Rows fitted to.
    pub rows: usize,
    /// Rows among them at which ego follows.
    pub following_rows: usize,
    /// Rows among them at which a lane change is being started.
    pub lane_change_rows: usize,
    /// Whether an ADB score was fitted too. With it, position on the aggression line and ADB agree by
    /// construction.
    pub used_adb: bool,
    /// Losses that had no rows.
    pub warnings: Vec<ModelWarning>,
}

/// Fits an embedding to `drive` with the networks of `model` frozen.
///
/// Windows are encoded once; then BFGS runs over the embedding from the mean of the training embeddings and from
/// draws of the prior N(0, I), and the best end is kept. L5 is taken in expectation over M's sample, so that the
/// objective has no noise. L4 is fitted where `adb` is given and [`crate::PersonalizeSettings::use_adb`] is set.
///
/// # Errors
/// [`ModelError::DriveTooShort`] if the drive lasts less than one window.
///
/// # Source
/// Method section 3, "Personalising".
pub fn personalize(
    model: &Model,
    drive: &Drive,
    adb: Option<AdbScore>,
    params: &PersonalizeParams,
    seed: u64,
) -> Result<Personalized, ModelError> {
    let settings = params.settings();
    let rows = rows_of(drive, &model.row_settings(), settings.fit_fraction)?;
    let adb = adb.filter(|_| settings.use_adb && model.learned().aggression);
    let fit = Fit::new(model, &rows, adb);

    let d = model.embedding_size();
    let stream = stream_seed(seed, &["personalize", drive.meta().drive.as_str()]);
    let mut rng = Pcg64Mcg::seed_from_u64(stream);
    let prior = |_| -> Vec<f64> { (0..d).map(|_| StandardNormal.sample(&mut rng)).collect() };
    let mean = model.mean_embedding().coordinates().to_vec();
    let points: Vec<Vec<f64>> = std::iter::once(mean.clone())
        .chain((1..settings.starts).map(prior))
        .collect();
    let ends: Vec<Minimum> = points
        .iter()
        .map(|from| minimise(|w| fit.value(w), from.clone(), settings.iterations))
        .collect();
    let better = |a: &usize, b: &usize| ends[*a].value.total_cmp(&ends[*b].value);
    let best = &ends[(0..ends.len()).min_by(better).unwrap_or(0)];

    let distance = |end: &Minimum| {
        let difference = end.at.iter().zip(&best.at).map(|(a, b)| a - b);
        norm(&difference.collect::<Vec<_>>()).powi(2)
    };
    let start_spread = (ends.iter().map(distance).sum::<f64>() / ends.len() as f64).sqrt();
    let (sums, _, l4) = fit.sums(&best.at);
    let has_m = fit.weights.mutual_information > 0.0;
    let guess = has_m
        .then(|| Embedding::new(fit.reading(&mean)))
        .transpose()?;
    let starts = points.into_iter().zip(&ends).map(|(from, end)| {
        Ok(Start {
            from: Embedding::new(from)?,
            to: Embedding::new(end.at.clone())?,
            objective: end.value,
            iterations: end.iterations,
        })
    });
    let embedding = Embedding::new(best.at.clone())?;
    Ok(Personalized {
        objective: best.value,
        losses: sums.terms(l4, d),
        start_spread,
        starts: starts.collect::<Result<_, ModelError>>()?,
        amortized_guess: guess,
        aggression_hat: crate::style_space::AggressionAxis::of(model)
            .ok()
            .map(|axis| axis.points(embedding.coordinates())),
        rows: rows.len(),
        following_rows: rows
            .iter()
            .filter(|r| r.following_distance_m.is_some())
            .count(),
        lane_change_rows: rows.iter().filter(|r| r.lane_change == Some(true)).count(),
        used_adb: adb.is_some(),
        warnings: warnings(&sums),
        embedding,
    })
}

fn warnings(sums: &Sums) -> Vec<ModelWarning> {
    let checks = [
        (
            Loss::FollowingDistance,
            sums.following_distance.weight,
            "no row at which this driver follows, or F was not trained",
        ),
        (
            Loss::LaneChange,
            sums.lane_change.weight,
            "no row to judge lane changes by, or C was not trained",
        ),
    ];
    let empty = checks.into_iter().filter(|(_, weight, _)| *weight <= 0.0);
    empty
        .map(|(loss, _, reason)| ModelWarning::LossLeftOut { loss, reason })
        .collect()
}

/// A tile of rows whose windows are encoded.
#[derive(Debug)]
struct Chunk {
    inputs: Inputs<f32>,
    lane_context: Tile<f32>,
    speed_context: Tile<f32>,
}

/// The losses of a drive's rows as a function of `w`.
pub(crate) struct Fit<'a> {
    model: &'a Model,
    chunks: Vec<Chunk>,
    weights: LossWeights,
    reading: Reading,
    raw: RawMap<f32>,
    /// Standardised.
    adb: Option<f64>,
    grid_rows: f64,
}

impl<'a> Fit<'a> {
    pub(crate) fn new(model: &'a Model, rows: &[Row], adb: Option<AdbScore>) -> Self {
        let mut fit = Self {
            model,
            chunks: Vec::new(),
            weights: model.active_weights(),
            reading: match model.mutual_information_loss() {
                MutualInformationLoss::MeanSquared => Reading::Expected,
                MutualInformationLoss::GaussianLikelihood => Reading::Likelihood,
            },
            raw: model.whitening().raw_map(),
            adb: adb.map(|score| model.scaling().aggression.apply(score.points())),
            grid_rows: rows.iter().filter(|r| r.on_grid).count().max(1) as f64,
        };
        let chunks = rows.par_chunks(ROWS).map_init(
            || Pass::new(model.networks()),
            |pass, rows| fit.encode(pass, rows),
        );
        fit.chunks = chunks.collect();
        fit
    }

    fn objective(&self) -> Objective<'_, f32> {
        Objective {
            networks: self.model.networks(),
            parameters: self.model.parameters(),
            weights: self.weights,
            reading: self.reading,
            raw: Some(&self.raw),
        }
    }

    fn encode(&self, pass: &mut Pass<f32>, rows: &[Row]) -> Chunk {
        let scaling = self.model.scaling();
        let a = self.model.architecture();
        let mut inputs = Inputs::new(a.embedding_size);
        let mut windows = Tile::zeros(SIGNALS * a.window_steps);
        for (column, row) in rows.iter().enumerate() {
            for (feature, &value) in row.window.iter().enumerate() {
                let signal = &scaling.signals[feature / a.window_steps];
                windows.feature_mut(feature)[column] = signal.apply(value) as f32;
            }
            let [ego, lead, ..] = &scaling.signals;
            inputs.lead_speed.all_mut()[column] = lead.apply(row.lead_speed_mps) as f32;
            let distance = row.following_distance_m;
            let distance = distance.map_or(0.0, |d| scaling.following_distance.apply(d));
            let change = f32::from(u8::from(row.lane_change == Some(true)));
            let speed = ego.apply(row.ego_speed_mps) as f32;
            for (i, target) in [distance as f32, change, speed].into_iter().enumerate() {
                inputs.targets.feature_mut(i)[column] = target;
            }
            let weights = self.model.row_weights().of_row(row);
            for (i, weight) in weights.into_iter().enumerate() {
                inputs.weights.feature_mut(i)[column] = weight as f32;
            }
        }
        pass.set_windows(&windows);
        self.objective().encode(pass);
        let copy = |tile: &Tile<f32>| {
            let mut to = Tile::zeros(tile.features());
            to.all_mut().copy_from_slice(tile.all());
            to
        };
        Chunk {
            inputs,
            lane_context: copy(pass.lane_change.encoded.encoder.output()),
            speed_context: copy(pass.velocity.encoder.output()),
        }
    }

    /// Runs every tile at `w` and gives `read` each tile's pass; results in the tiles' order.
    fn each<R: Send>(
        &self,
        w: &[f64],
        read: impl Fn(&Inputs<f32>, &Pass<f32>, Sums) -> R + Sync,
    ) -> Vec<R> {
        let mut embedding = Tile::zeros(w.len());
        for (i, &x) in w.iter().enumerate() {
            embedding.feature_mut(i).fill(x as f32);
        }
        let objective = self.objective();
        let scale = 1.0 / self.grid_rows;
        let tiles = self.chunks.par_iter().map_init(
            || Pass::new(self.model.networks()),
            |pass, chunk| {
                let to = pass.lane_change.encoded.encoder.output_mut();
                to.all_mut().copy_from_slice(chunk.lane_context.all());
                let to = pass.velocity.encoder.output_mut();
                to.all_mut().copy_from_slice(chunk.speed_context.all());
                let sums = objective.evaluate(&embedding, &chunk.inputs, pass, scale, None);
                read(&chunk.inputs, pass, sums)
            },
        );
        tiles.collect()
    }

    /// Sums over all rows, the gradient by `w` without L4, and L4.
    pub(crate) fn sums(&self, w: &[f64]) -> (Sums, Vec<f64>, Option<f64>) {
        let tiles = self.each(w, |_, pass, sums| {
            let gradient = &pass.embedding_gradient;
            let along = |i| gradient.feature(i).iter().map(|&g| f64::from(g)).sum();
            let gradient: Vec<f64> = (0..w.len()).map(along).collect();
            (sums, gradient)
        });
        let mut total = (Sums::default(), vec![0.0; w.len()]);
        for (sums, gradient) in tiles {
            total.0.merge(&sums);
            for (to, g) in total.1.iter_mut().zip(gradient) {
                *to += g;
            }
        }
        let l4 = self.adb.map(|score| (self.aggression(w) - score).powi(2));
        (total.0, total.1, l4)
    }

    /// S at `w`, standardised.
    fn aggression(&self, w: &[f64]) -> f64 {
        let dense = self.model.networks().style.dense();
        let parameters = self.model.parameters();
        let weights = dense.weights(parameters).iter().zip(w);
        f64::from(dense.biases(parameters)[0])
            + weights.map(|(&a, x)| f64::from(a) * x).sum::<f64>()
    }

    /// The objective and its gradient.
    pub(crate) fn value(&self, w: &[f64]) -> (f64, Vec<f64>) {
        let (sums, mut gradient, l4) = self.sums(w);
        let mut value = sums.weighted(&self.weights) / self.grid_rows;
        if let (Some(l4), Some(score)) = (l4, self.adb) {
            value += self.weights.aggression * l4;
            let slope = 2.0 * self.weights.aggression * (self.aggression(w) - score);
            let dense = self.model.networks().style.dense();
            let weights = dense.weights(self.model.parameters());
            for (to, &a) in gradient.iter_mut().zip(weights) {
                *to += slope * f64::from(a);
            }
        }
        (value, gradient)
    }

    /// Mean of M's μ over the grid rows, read at `w`, in whitened coordinates.
    fn reading(&self, w: &[f64]) -> Vec<f64> {
        let tiles = self.each(w, |inputs, pass, _| {
            let weights = inputs.weights.feature(3);
            let mean = |i: usize| -> f64 {
                let values = pass.reading()[i * ROWS..(i + 1) * ROWS].iter();
                values
                    .zip(weights)
                    .map(|(&m, &c)| f64::from(m) * f64::from(c))
                    .sum()
            };
            (0..w.len()).map(mean).collect::<Vec<f64>>()
        });
        let mut raw = vec![0.0; w.len()];
        for tile in tiles {
            for (to, m) in raw.iter_mut().zip(tile) {
                *to += m / self.grid_rows;
            }
        }
        self.model.whitening().apply(&raw)
    }
}
