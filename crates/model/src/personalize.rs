//! Personalising: the heads stay, a driver's style is solved for.
//!
//! One solve from the mean style, no random starts. Linear heads give the posterior of the style given a drive's events; the
//! paper's networks the minimum of their losses over its rows, with a covariance from how blocks of time disagree.

mod learning_curve;
mod network_rows;
mod twice;

pub use learning_curve::{CurvePoint, CurveSettings, LearningCurve, learning_curve};
pub(crate) use network_rows::NetworkRows;
pub use twice::learn_days;

use crate::{
    days::Days,
    error::ModelError,
    heads::{Event, Posterior, Support, events_of, length_s, solve},
    losses::LossTerms,
    model::{Heads, Model},
    on_range::points_on,
    params::share,
    rows::{Row, rows_of},
    style_space::LinearHead,
};
use maveric_domain::{Drive, Embedding, StyleScore};

/// A driver in style space.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Personalized {
    /// The mean of the style.
    pub embedding: Embedding,
    /// Its covariance, shape `(d, d)`, row by row; `None` where the drive is too short to tell (networks alone).
    pub covariance: Option<Vec<f64>>,
    /// S's reading, in points of the model's scale; `None` if the model has no aggression axis.
    pub aggression_hat: Option<f64>,
    /// Events, or rows for the paper's networks, that it was solved from.
    pub readings: usize,
    /// How well the people learned from explain the drive, before any style; `None` where it shows no habit.
    pub support: Option<Support>,
    /// Whether what is posted lies outside what was posted for those learned from: a free speed is then compared across limits.
    pub posted_unseen: bool,
    /// Whether a score was read too. With it, position on the aggression line and score agree in part by construction.
    pub used_adb: bool,
}

impl Personalized {
    /// SD along each coordinate, shape `(d,)`.
    pub fn standard_error(&self) -> Option<Vec<f64>> {
        let d = self.embedding.size();
        let covariance = self.covariance.as_ref()?;
        Some((0..d).map(|i| covariance[i * d + i].max(0.0).sqrt()).collect())
    }

    /// SD of the style's projection on `direction`, of any length but 0.
    pub fn sd_along(&self, direction: &[f64]) -> Option<f64> {
        let length = crate::linear_algebra::norm(direction);
        let spread = crate::linear_algebra::spread(direction, self.covariance.as_ref()?);
        Some(spread.sqrt() / length)
    }
}

/// What a drive shows, as far as a model reads it.
#[derive(Debug, Clone)]
pub(crate) enum Shown {
    /// Events of every linear head.
    Events(Vec<Vec<Event>>),
    /// Rows of the paper's networks.
    Rows(Vec<Row>),
}

/// Solves for styles with one model.
///
/// It holds nothing of any drive: to personalise many drives, share one between threads.
#[derive(Debug)]
pub struct Personalizer<'a> {
    model: &'a Model,
    share: f64,
}

/// Solves for the style of one whole drive; see [`Personalizer::fit`].
///
/// # Errors
/// As [`Personalizer::fit`].
pub fn personalize(
    model: &Model,
    drive: &Drive,
    adb: Option<StyleScore>,
) -> Result<Personalized, ModelError> {
    Personalizer::new(model).fit(drive, adb)
}

impl<'a> Personalizer<'a> {
    /// Takes a model, to read whole drives.
    pub fn new(model: &'a Model) -> Self {
        Self { model, share: 1.0 }
    }

    /// Takes a model, to read this first share of every drive.
    ///
    /// # Errors
    /// [`ModelError::BadSetting`] for a share that is not above 0, up to 1.
    pub fn of_first(model: &'a Model, share_of_drive: f64) -> Result<Self, ModelError> {
        share("fit_fraction", share_of_drive)?;
        Ok(Self { model, share: share_of_drive })
    }

    /// The model it solves with.
    pub fn model(&self) -> &Model {
        self.model
    }

    /// Solves for the style of `drive`.
    ///
    /// The score is read too where `adb` is given and the model knows a score.
    ///
    /// # Errors
    /// [`ModelError::OtherScale`] for a score of another scale than the model's. [`ModelError::DriveTooShort`] if the drive lasts less than
    /// one window of the networks. One that shows nothing that linear
    /// heads read says nothing: what is known is then what is known of everybody, from 0 readings.
    ///
    /// # Source
    /// Paper, "Personalizing": the weights frozen, `w` fitted. Posterior and damped solve are ours.
    pub fn fit(&self, drive: &Drive, adb: Option<StyleScore>) -> Result<Personalized, ModelError> {
        let shown = self.shown(drive, self.share)?;
        let axis = LinearHead::aggression(self.model).ok();
        let adb = adb.filter(|_| axis.is_some());
        let points = adb.map(|adb| points_on(self.model.score_range(), adb));
        let points = points.transpose()?;
        let (posterior, readings) = self.posterior(&shown, points, self.model.days())?;
        let support = match &shown {
            Shown::Events(events) => self.model.support(events),
            Shown::Rows(_) => {
                let events = self.events(drive, self.share);
                self.model.support(&events)
            }
        };
        let embedding = Embedding::new(posterior.mean)?;
        let aggression_hat = axis.map(|a| a.read(&embedding)).transpose()?;
        Ok(Personalized {
            aggression_hat,
            covariance: (!posterior.covariance.is_empty()).then_some(posterior.covariance),
            readings,
            support,
            posted_unseen: (self.model.posted()).unseen(drive.road().posted_speed_mps),
            used_adb: adb.is_some(),
            embedding,
        })
    }

    /// What is shown says of the drive's style or, where it is known how far days differ, of the person's; with the number of
    /// readings.
    fn posterior(
        &self,
        shown: &Shown,
        points: Option<f64>,
        days: Option<&Days>,
    ) -> Result<(Posterior, usize), ModelError> {
        let d = self.model.embedding_size();
        Ok(match shown {
            Shown::Events(events) => {
                let linear = self.model.linear()?;
                let score = points.zip(linear.style.as_ref());
                let solved = |score| solve(&linear.heads, events, score, d, None).style(d);
                let person = days.and_then(|days| days.of_person(&solved(None), score));
                (person.unwrap_or_else(|| solved(score)), events.iter().map(Vec::len).sum())
            }
            Shown::Rows(rows) => {
                let mut rows = NetworkRows::new(self.model.paper()?, rows, points);
                let posterior = rows.solve(self.model.mean_embedding().coordinates());
                let posterior = match days {
                    Some(days) => days.added_to(posterior),
                    None => posterior,
                };
                (posterior, rows.len())
            }
        })
    }

    fn events(&self, drive: &Drive, fraction: f64) -> Vec<Vec<Event>> {
        let posted = Some(self.model.posted());
        events_of(drive, length_s(drive, fraction), posted)
    }

    /// What the first share of a drive shows.
    pub(crate) fn shown(&self, drive: &Drive, fraction: f64) -> Result<Shown, ModelError> {
        Ok(match self.model.heads() {
            Heads::Linear(_) => Shown::Events(self.events(drive, fraction)),
            Heads::Paper(paper) => Shown::Rows(rows_of(drive, &paper.row_settings(), fraction)?),
        })
    }

    /// Mean loss of what is shown at a style; `None` where nothing is.
    pub(crate) fn loss(&self, shown: &Shown, w: &[f64]) -> Option<f64> {
        match (self.model.heads(), shown) {
            (Heads::Linear(linear), Shown::Events(events)) => {
                let of_each = linear.heads.iter().zip(events);
                let losses: Vec<f64> = of_each
                    .filter(|(fitted, _)| fitted.learned())
                    .flat_map(|(fitted, events)| {
                        let sd = libm::hypot(fitted.within_sd, fitted.between_sd);
                        events.iter().map(move |e| {
                            let eta = fitted.eta(w, e.z());
                            fitted.family.loss(e.outcome, eta, sd).value
                        })
                    })
                    .collect();
                let n = losses.len() as f64;
                (n > 0.0).then(|| losses.iter().sum::<f64>() / n)
            }
            (Heads::Paper(paper), Shown::Rows(rows)) => {
                let (sums, _) = NetworkRows::new(paper, rows, None).say(w);
                let predictions =
                    LossTerms { mutual_information: None, ..sums.terms(None, w.len()) };
                Some(predictions.total(&paper.loss_weights))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests;
