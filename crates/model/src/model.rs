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
            _ => Err(ModelError::UnknownHeads {
                found: text.to_owned(),
            }),
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
    /// How those learned from differ; not in files of before there was support.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) population: Option<Population>,
    /// What was posted where they drove; not in files of before it was kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) posted: Option<Posted>,
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
            return Err(ModelError::bad_file(
                "a training embedding is of another size",
            ));
        }
        match &parts.heads {
            Heads::Linear(linear) => {
                check(&linear.heads, d)?;
                linear.style.as_ref().map_or(Ok(()), |s| s.check(d))?;
            }
            Heads::Paper(paper) => paper.check(d)?,
        }
        let population = parts.population.as_ref();
        population.map_or(Ok(()), |p| p.check(HEADS.len()))?;
        parts.days.as_ref().map_or(Ok(()), |days| days.check(d))?;
        parts.posted.as_ref().map_or(Ok(()), Posted::check)?;
        let n = parts.training.len().max(1) as f64;
        let points = parts.training.iter().map(TrainingEmbedding::point);
        let mean = points.fold(DVector::zeros(d), |sum, p| sum + p) / n;
        let mean_embedding = Embedding::new(mean.iter().copied().collect())?;
        Ok(Self {
            parts,
            mean_embedding,
        })
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

    /// What was posted where those learned from drove; `None` in a file of before it was kept.
    pub fn posted(&self) -> Option<&Posted> {
        self.parts.posted.as_ref()
    }

    /// Which heads it has.
    pub fn kind(&self) -> HeadsKind {
        match self.heads() {
            Heads::Linear(_) => HeadsKind::Linear,
            Heads::Paper(_) => HeadsKind::Paper,
        }
    }

    /// The same model, which knows how the habits of the people learned from differ beside what its networks say.
    pub(crate) fn with_habits(
        mut self,
        habits: Vec<FittedHead>,
        population: Population,
        posted: Option<Posted>,
    ) -> Self {
        if let Heads::Paper(paper) = &mut self.parts.heads {
            paper.habits = Some(habits);
            self.parts.population = Some(population);
            self.parts.posted = posted;
        }
        self
    }

    /// People learned from; `None` in a file of before there was support.
    pub fn people(&self) -> Option<usize> {
        self.parts.population.as_ref().map(|p| p.people)
    }

    /// How well the people learned from explain what a drive shows; `None` where it shows nothing, and for a file of before there
    /// was support.
    pub(crate) fn support(&self, events: &[Vec<Event>]) -> Option<Support> {
        let heads = match self.heads() {
            Heads::Linear(linear) => &linear.heads,
            Heads::Paper(paper) => paper.habits.as_ref()?,
        };
        self.parts.population.as_ref()?.support(heads, events)
    }

    /// The linear heads.
    ///
    /// # Errors
    /// [`ModelError::OtherHeads`] if it has none.
    pub fn linear(&self) -> Result<&LinearHeads, ModelError> {
        match self.heads() {
            Heads::Linear(linear) => Ok(linear),
            Heads::Paper(_) => Err(ModelError::OtherHeads {
                found: HeadsKind::Paper,
                expected: HeadsKind::Linear,
            }),
        }
    }

    /// The paper's networks.
    ///
    /// # Errors
    /// [`ModelError::OtherHeads`] if it has none.
    pub fn paper(&self) -> Result<&PaperNetworks, ModelError> {
        match self.heads() {
            Heads::Paper(paper) => Ok(paper),
            Heads::Linear(_) => Err(ModelError::OtherHeads {
                found: HeadsKind::Linear,
                expected: HeadsKind::Paper,
            }),
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
        if let Heads::Linear(LinearHeads {
            style: Some(style), ..
        }) = &mut parts.heads
        {
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
        self.training()
            .iter()
            .map(TrainingEmbedding::point)
            .collect()
    }

    /// Distance from the mean of the training embeddings.
    pub(crate) fn distance_from_mean(&self, embedding: &Embedding) -> f64 {
        let pairs = embedding
            .coordinates()
            .iter()
            .zip(self.mean_embedding().coordinates());
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
    posted: Option<Posted>,
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
        Ok(Self {
            own: own_heads.collect(),
            posted: model.posted().copied(),
        })
    }

    fn say(&self, which: usize, reads: &[f64]) -> Option<f64> {
        self.own[which].as_ref().map(|h| h.expected(reads))
    }

    /// Speed without anybody ahead where `posted_mps` is posted, in m/s; without a limit at the mean one learned from.
    pub fn free_speed_mps(&self, posted_mps: Option<f64>) -> Option<f64> {
        let factor = self
            .posted
            .zip(posted_mps)
            .map_or(1.0, |(learned, mps)| learned.factor(mps));
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
