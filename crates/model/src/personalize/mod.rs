//! Personalising: the heads stay, a driver's style is solved for.
//!
//! One damped solve from the mean style, no random starts. Linear heads give the posterior of the style given a drive's events;
//! the paper's networks the minimum of their losses over its rows, with a covariance from how blocks of time disagree.

mod learning_curve;
mod network_rows;

pub use learning_curve::{CurveParams, CurvePoint, CurveSettings, LearningCurve, learning_curve};
pub(crate) use network_rows::NetworkRows;

use crate::{
    error::ModelError,
    heads::{Event, HEADS, Posterior, events_of, length_s, solve},
    model::{Heads, LinearHeads, Model},
    params::PersonalizeParams,
    rows::{Row, rows_of},
    style_space::AggressionAxis,
};
use maveric_domain::{AdbScore, Drive, DriveId, Embedding};

/// A driver in style space.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Personalized {
    /// The mean of the style.
    pub embedding: Embedding,
    /// Its covariance, shape `(d, d)`, row by row; `None` where the drive is too short to tell (networks alone).
    pub covariance: Option<Vec<f64>>,
    /// S's reading, in ADB points; `None` if the model has no aggression axis.
    pub aggression_hat: Option<f64>,
    /// Events, or rows for the paper's networks, that it was solved from.
    pub readings: usize,
    /// Newton steps.
    pub iterations: usize,
    /// Whether an ADB score was read too. With it, position on the aggression line and ADB agree in part by construction.
    pub used_adb: bool,
}

impl Personalized {
    /// SD along each coordinate, shape `(d,)`.
    pub fn standard_error(&self) -> Option<Vec<f64>> {
        let d = self.embedding.size();
        let covariance = self.covariance.as_ref()?;
        Some(
            (0..d)
                .map(|i| covariance[i * d + i].max(0.0).sqrt())
                .collect(),
        )
    }

    /// SD of the style's projection on `direction`, of any length but 0.
    pub fn sd_along(&self, direction: &[f64]) -> Option<f64> {
        let length = crate::linear_algebra::norm(direction);
        let spread = crate::heads::spread(direction, self.covariance.as_ref()?);
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
    params: PersonalizeParams,
}

/// Solves for the style of one drive; see [`Personalizer::fit`].
///
/// # Errors
/// As [`Personalizer::fit`].
pub fn personalize(
    model: &Model,
    drive: &Drive,
    adb: Option<AdbScore>,
    params: &PersonalizeParams,
) -> Result<Personalized, ModelError> {
    Personalizer::new(model, params.clone()).fit(drive, adb)
}

impl<'a> Personalizer<'a> {
    /// Takes a model.
    pub fn new(model: &'a Model, params: PersonalizeParams) -> Self {
        Self { model, params }
    }

    /// The model it solves with.
    pub fn model(&self) -> &Model {
        self.model
    }

    /// Solves for the style of `drive`.
    ///
    /// The score is read where `adb` is given, the model knows a score, and [`crate::PersonalizeSettings::use_adb`] is set.
    ///
    /// # Errors
    /// [`ModelError::NoHabits`] if the drive shows nothing that linear heads read; [`ModelError::DriveTooShort`] if it lasts
    /// less than one window of the networks.
    ///
    /// # Source
    /// Paper, "Personalizing": the weights frozen, `w` fitted. Posterior and damped solve are ours.
    pub fn fit(&self, drive: &Drive, adb: Option<AdbScore>) -> Result<Personalized, ModelError> {
        let shown = self.shown(drive, self.params.settings().fit_fraction)?;
        self.fit_shown(&drive.meta().drive, &shown, adb)
    }

    /// What the first share of a drive shows.
    pub(crate) fn shown(&self, drive: &Drive, fraction: f64) -> Result<Shown, ModelError> {
        Ok(match self.model.heads() {
            Heads::Linear(_) => Shown::Events(events_of(drive, length_s(drive, fraction))),
            Heads::Paper(paper) => Shown::Rows(rows_of(drive, &paper.row_settings(), fraction)?),
        })
    }

    pub(crate) fn fit_shown(
        &self,
        drive: &DriveId,
        shown: &Shown,
        adb: Option<AdbScore>,
    ) -> Result<Personalized, ModelError> {
        let axis = AggressionAxis::of(self.model).ok();
        let adb = adb.filter(|_| self.params.settings().use_adb && axis.is_some());
        let points = adb.map(AdbScore::points);
        let (posterior, readings, iterations) = match (self.model.heads(), shown) {
            (Heads::Linear(linear), Shown::Events(events)) => {
                self.by_events(linear, drive, events, points)?
            }
            (Heads::Paper(paper), Shown::Rows(rows)) => {
                let rows = NetworkRows::new(paper, rows, points);
                let from = self.model.mean_embedding().coordinates();
                let found = rows.solve(from);
                (found.0, rows.len(), found.1)
            }
            // What another model read says nothing to this one.
            _ => {
                return Err(ModelError::NoHabits {
                    drive: drive.clone(),
                });
            }
        };
        let embedding = Embedding::new(posterior.mean)?;
        let aggression_hat = axis.map(|a| a.aggression_hat(&embedding)).transpose()?;
        Ok(Personalized {
            aggression_hat,
            covariance: (!posterior.covariance.is_empty()).then_some(posterior.covariance),
            readings,
            iterations,
            used_adb: adb.is_some(),
            embedding,
        })
    }

    /// Mean loss of what is shown at a style; `None` where nothing is.
    pub(crate) fn loss(&self, shown: &Shown, w: &[f64]) -> Option<f64> {
        match (self.model.heads(), shown) {
            (Heads::Linear(linear), Shown::Events(events)) => {
                let of_each = linear.heads.iter().zip(&HEADS).zip(events);
                let losses: Vec<f64> = of_each
                    .filter(|((fitted, _), _)| fitted.learned())
                    .flat_map(|((fitted, head), events)| {
                        let sd = fitted.within_sd.hypot(fitted.between_sd);
                        events.iter().map(move |e| {
                            let eta = fitted.eta(w, e.z());
                            head.family.loss(e.outcome, eta, sd).value
                        })
                    })
                    .collect();
                let n = losses.len() as f64;
                (n > 0.0).then(|| losses.iter().sum::<f64>() / n)
            }
            (Heads::Paper(paper), Shown::Rows(rows)) => {
                let weights = paper.active_weights();
                let by = [
                    weights.following_distance,
                    weights.lane_change,
                    weights.velocity,
                ];
                let losses = NetworkRows::new(paper, rows, None).losses(w);
                let known = losses.iter().zip(by).filter_map(|(l, by)| Some((*l)? * by));
                losses.iter().any(Option::is_some).then(|| known.sum())
            }
            _ => None,
        }
    }

    fn by_events(
        &self,
        linear: &LinearHeads,
        drive: &DriveId,
        events: &[Vec<Event>],
        points: Option<f64>,
    ) -> Result<(Posterior, usize, usize), ModelError> {
        let readings = events.iter().map(Vec::len).sum();
        if readings == 0 {
            return Err(ModelError::NoHabits {
                drive: drive.clone(),
            });
        }
        let d = self.model.embedding_size();
        let score = points.zip(linear.style.as_ref());
        let latent = solve(&linear.heads, events, score, d, None);
        Ok((latent.style(d), readings, latent.iterations))
    }
}

#[cfg(test)]
mod tests;
