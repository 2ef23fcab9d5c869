//! A trained model: where its drivers lie in style space, and the heads that read a style.

use crate::{
    days::Days,
    error::ModelError,
    heads::{
        Event, FittedHead, HEADS, OwnHead, Population, StyleHead, Support, at, check, held_up,
    },
    heads_kind::HeadsKind,
    paper::PaperNetworks,
    posted::Posted,
};
use maveric_domain::{DriveId, Embedding, ScoreRange};
use nalgebra::DVector;
use serde::{Deserialize, Serialize};
use std::str::FromStr;

impl FromStr for HeadsKind {
    type Err = ModelError;
    fn from_str(text: &str) -> Result<Self, ModelError> {
        match text {
            "linear" => Ok(Self::Linear),
            "paper" => Ok(Self::Paper),
            _ => Err(ModelError::UnknownHeads { found: text.to_owned() }),
        }
    }
}

/// What reads a style.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Heads {
    /// Linear heads.
    Linear(LinearHeads),
    /// The paper's networks.
    Paper(Box<PaperNetworks>),
}

/// Habits, each linear in the style, and the score that a style is read as.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinearHeads {
    /// One for each of [`crate::HEADS`], in that order.
    pub heads: Vec<FittedHead>,
    /// S; none where no two people differ in their score.
    pub style: Option<StyleHead>,
}

/// A training drive in style space.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainingEmbedding {
    /// The drive that was trained on.
    pub drive: DriveId,
    /// Where training put it.
    pub embedding: Embedding,
    /// Mean ego speed over the drive, in m/s.
    pub mean_speed_mps: f64,
}

impl TrainingEmbedding {
    /// Where training put it.
    pub(crate) fn point(&self) -> DVector<f64> {
        DVector::from_column_slice(self.embedding.coordinates())
    }
}

/// What a model file holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ModelParts {
    pub(crate) embedding_size: usize,
    /// The scale of the score that it reads.
    pub(crate) score_range: ScoreRange,
    /// How those learned from differ.
    pub(crate) population: Population,
    /// What was posted where they drove.
    pub(crate) posted: Posted,
    pub(crate) training: Vec<TrainingEmbedding>,
    /// How far one person's drives differ, where people learned from drove twice.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) days: Option<Days>,
    pub(crate) heads: Heads,
}

/// A trained model; made by [`crate::train()`] or read by [`crate::model_file::from_bytes`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ModelParts", into = "ModelParts")]
pub struct Model {
    pub(crate) parts: ModelParts,
    mean_embedding: Embedding,
}

impl TryFrom<ModelParts> for Model {
    type Error = ModelError;

    /// Puts the parts together, if they belong together.
    fn try_from(parts: ModelParts) -> Result<Self, ModelError> {
        let d = parts.embedding_size;
        if d == 0 || parts.training.iter().any(|t| t.embedding.size() != d) {
            return Err(ModelError::bad_file("a training embedding is of another size"));
        }
        match &parts.heads {
            Heads::Linear(linear) => {
                check(&linear.heads, d)?;
                linear.style.as_ref().map_or(Ok(()), |s| s.check(d))?;
            }
            Heads::Paper(paper) => paper.check(d)?,
        }
        parts.population.check(HEADS.len())?;
        parts.days.as_ref().map_or(Ok(()), |days| days.check(d))?;
        parts.posted.check()?;
        let n = parts.training.len().max(1) as f64;
        let points = parts.training.iter().map(TrainingEmbedding::point);
        let mean = points.fold(DVector::zeros(d), |sum, p| sum + p) / n;
        let mean_embedding = Embedding::new(mean.iter().copied().collect())?;
        Ok(Self { parts, mean_embedding })
    }
}

impl From<Model> for ModelParts {
    fn from(model: Model) -> Self {
        model.parts
    }
}

impl Model {
    /// What reads a style.
    pub fn heads(&self) -> &Heads {
        &self.parts.heads
    }

    /// How far one person's drives differ; `None` where nobody learned from drove twice: then what is said of a style is said of the
    /// drive.
    pub fn days(&self) -> Option<&Days> {
        self.parts.days.as_ref()
    }

    /// What was posted where those learned from drove.
    pub fn posted(&self) -> &Posted {
        &self.parts.posted
    }

    /// Which heads it has.
    pub fn kind(&self) -> HeadsKind {
        match self.heads() {
            Heads::Linear(_) => HeadsKind::Linear,
            Heads::Paper(_) => HeadsKind::Paper,
        }
    }

    /// People learned from.
    pub fn people(&self) -> usize {
        self.parts.population.people
    }

    /// How well the people learned from explain what a drive shows; `None` where it shows nothing.
    pub(crate) fn support(&self, events: &[Vec<Event>]) -> Option<Support> {
        let heads = match self.heads() {
            Heads::Linear(linear) => &linear.heads,
            Heads::Paper(paper) => &paper.habits,
        };
        self.parts.population.support(heads, events)
    }

    /// The linear heads.
    ///
    /// # Errors
    /// [`ModelError::OtherHeads`] if it has none.
    pub fn linear(&self) -> Result<&LinearHeads, ModelError> {
        match self.heads() {
            Heads::Linear(linear) => Ok(linear),
            Heads::Paper(_) => {
                Err(ModelError::OtherHeads { found: HeadsKind::Paper, expected: HeadsKind::Linear })
            }
        }
    }

    /// The paper's networks.
    ///
    /// # Errors
    /// [`ModelError::OtherHeads`] if it has none.
    pub fn paper(&self) -> Result<&PaperNetworks, ModelError> {
        match self.heads() {
            Heads::Paper(paper) => Ok(paper),
            Heads::Linear(_) => {
                Err(ModelError::OtherHeads { found: HeadsKind::Linear, expected: HeadsKind::Paper })
            }
        }
    }

    /// Whether it read a score from styles while it learned.
    pub fn knows_aggression(&self) -> bool {
        match self.heads() {
            Heads::Linear(linear) => linear.style.is_some(),
            Heads::Paper(paper) => paper.learned().aggression,
        }
    }

    /// Numbers that were learned, the training embeddings aside.
    pub fn parameters(&self) -> usize {
        match self.heads() {
            Heads::Linear(linear) => {
                let count = |h: &FittedHead| h.common.len() + h.slopes.len() + 2;
                let style = linear.style.as_ref().map_or(0, |s| s.gradient.len() + 2);
                linear.heads.iter().map(count).sum::<usize>() + style
            }
            Heads::Paper(paper) => paper.parameters.len(),
        }
    }

    /// Whether another model reads and drives every style as this one does. How sure S is may differ: linear heads draw samples of people
    /// for it, their one use of the training's seed, and no drive depends on it.
    pub fn drives_as(&self, other: &Self) -> bool {
        self.without_draws() == other.without_draws()
    }

    fn without_draws(&self) -> ModelParts {
        let mut parts = self.parts.clone();
        if let Heads::Linear(LinearHeads { style: Some(style), .. }) = &mut parts.heads {
            style.covariance.clear();
        }
        parts
    }

    /// Numbers in an embedding, d.
    pub fn embedding_size(&self) -> usize {
        self.parts.embedding_size
    }

    /// The training drives in style space, in the order they were given.
    pub fn training(&self) -> &[TrainingEmbedding] {
        &self.parts.training
    }

    /// The same with these names of its training drives, in their order.
    #[must_use]
    pub fn with_names(mut self, names: Vec<DriveId>) -> Self {
        for (training, name) in self.parts.training.iter_mut().zip(names) {
            training.drive = name;
        }
        self
    }

    /// The mean of the training embeddings: what is known of a driver not met yet.
    pub fn mean_embedding(&self) -> &Embedding {
        &self.mean_embedding
    }

    /// The training embeddings as points.
    pub(crate) fn points(&self) -> Vec<DVector<f64>> {
        self.training().iter().map(TrainingEmbedding::point).collect()
    }

    /// Distance from the mean of the training embeddings.
    pub(crate) fn distance_from_mean(&self, embedding: &Embedding) -> f64 {
        let pairs = embedding.coordinates().iter().zip(self.mean_embedding().coordinates());
        pairs.map(|(x, m)| (x - m).powi(2)).sum::<f64>().sqrt()
    }

    /// Takes coordinates of the model's size.
    pub(crate) fn check(&self, embedding: &Embedding) -> Result<(), ModelError> {
        ModelError::check_size(embedding.size(), self.embedding_size())
    }
}

/// The habits of one driver: every linear head with the style folded in. Each answer is a mean, and `None` where nothing of the
/// kind was learned.
#[derive(Debug, Clone)]
pub struct Habits {
    /// In the order of [`crate::HEADS`].
    own: Vec<Option<OwnHead>>,
    posted: Posted,
}

impl Habits {
    /// The habits that `embedding` stands for.
    ///
    /// # Errors
    /// [`ModelError::OtherHeads`] if the model has no linear heads, [`ModelError::EmbeddingSize`].
    pub fn new(model: &Model, embedding: &Embedding) -> Result<Self, ModelError> {
        let linear = model.linear()?;
        model.check(embedding)?;
        let w = embedding.coordinates();
        let own_heads = linear.heads.iter().map(|fitted| OwnHead::new(fitted, w));
        Ok(Self { own: own_heads.collect(), posted: *model.posted() })
    }

    fn say(&self, which: usize, reads: &[f64]) -> Option<f64> {
        self.own[which].as_ref().map(|h| h.expected(reads))
    }

    /// Speed without anybody ahead where `posted_mps` is posted, in m/s; without a limit at the mean one learned from.
    pub fn free_speed_mps(&self, posted_mps: Option<f64>) -> Option<f64> {
        let factor = posted_mps.map_or(1.0, |mps| self.posted.factor(mps));
        self.say(at::FREE_SPEED, &[]).map(|speed| speed / factor)
    }

    /// Time gap kept behind a vehicle at `lead_mps` by somebody who would drive `free_mps`, in s.
    pub fn following_gap_s(&self, free_mps: f64, lead_mps: f64) -> Option<f64> {
        self.say(at::FOLLOWING_GAP, &[held_up(free_mps, lead_mps)])
    }

    /// Time gap at which to move out, in s.
    pub fn move_out_s(&self) -> Option<f64> {
        self.say(at::MOVE_OUT, &[])
    }

    /// Time gap to whoever was passed at which to merge back, in s.
    pub fn merge_back_s(&self) -> Option<f64> {
        self.say(at::MERGE_BACK, &[])
    }

    /// Probability of passing a vehicle at `lead_mps` for somebody who would drive `free_mps`.
    pub fn passes(&self, free_mps: f64, lead_mps: f64) -> Option<f64> {
        self.say(at::PASS, &[free_mps - lead_mps])
    }

    /// Speed over a vehicle at `lead_mps` while passing it, in m/s, for somebody who would drive `free_mps`.
    pub fn passing_speed_over_mps(&self, free_mps: f64, lead_mps: f64) -> Option<f64> {
        self.say(at::PASSING_SPEED, &[free_mps - lead_mps])
    }
}
