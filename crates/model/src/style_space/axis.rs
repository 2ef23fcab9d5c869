//! The direction of aggression: g = ∇_w S(w).

use crate::{
    error::ModelError,
    heads::spread,
    linear_algebra::{dot, norm},
    model::{Heads, Model},
};
use maveric_domain::Embedding;

/// S as a function of the embedding, in ADB points: `S(w) = g·w + c`. S is linear, so g is one direction.
///
/// # Source
/// Method section 4; paper, "Modulating Aggression".
#[derive(Debug, Clone, PartialEq)]
pub struct AggressionAxis {
    gradient: Vec<f64>,
    offset: f64,
    covariance: Option<Vec<f64>>,
}

impl AggressionAxis {
    /// The axis of a model.
    ///
    /// # Errors
    /// [`ModelError::NoAggressionAxis`] if the model saw no ADB score, or its S is flat.
    pub fn of(model: &Model) -> Result<Self, ModelError> {
        let (gradient, offset, covariance) = match model.heads() {
            Heads::Linear(linear) => {
                let style = linear.style.as_ref();
                let style = style.ok_or(ModelError::NoAggressionAxis)?;
                let d = style.gradient.len();
                let of_slopes = style.covariance.chunks_exact(d + 1).take(d);
                let covariance = of_slopes.flat_map(|line| line[..d].iter().copied());
                (
                    style.gradient.clone(),
                    style.offset,
                    Some(covariance.collect()),
                )
            }
            Heads::Paper(paper) => {
                let dense = paper.networks.style.dense();
                let parameters = &paper.parts.parameters;
                let scaling = paper.scaling().aggression;
                let weights = dense.weights(parameters).iter();
                let offset = scaling.undo(f64::from(dense.biases(parameters)[0]));
                let gradient = weights.map(|&w| f64::from(w) * scaling.sd).collect();
                (gradient, offset, None)
            }
        };
        if !model.knows_aggression() || norm(&gradient) < 1e-9 {
            return Err(ModelError::NoAggressionAxis);
        }
        Ok(Self {
            gradient,
            offset,
            covariance,
        })
    }

    /// SD of the change of S along `step`, in points, as far as the people learned from determine the slopes; `None` for the
    /// paper's S, which was trained with everything else.
    pub fn step_sd(&self, step: &[f64]) -> Option<f64> {
        Some(spread(step, self.covariance.as_ref()?).sqrt())
    }

    /// g in ADB points per unit of the embedding, shape `(d,)`.
    pub fn gradient(&self) -> &[f64] {
        &self.gradient
    }

    /// g/|g|, shape `(d,)`.
    pub fn direction(&self) -> Vec<f64> {
        let length = norm(&self.gradient);
        self.gradient.iter().map(|g| g / length).collect()
    }

    /// ŝ: the ADB score that S reads from an embedding, in points; not limited to the scale.
    ///
    /// # Errors
    /// [`ModelError::EmbeddingSize`] if the embedding is not of the model's size.
    pub fn aggression_hat(&self, embedding: &Embedding) -> Result<f64, ModelError> {
        Ok(self.points(self.check(embedding)?))
    }

    /// Position on the aggression line: the projection of w on g/|g|.
    ///
    /// # Errors
    /// [`ModelError::EmbeddingSize`] if the embedding is not of the model's size.
    pub fn position(&self, embedding: &Embedding) -> Result<f64, ModelError> {
        Ok(dot(&self.direction(), self.check(embedding)?))
    }

    pub(crate) fn points(&self, w: &[f64]) -> f64 {
        self.offset + dot(&self.gradient, w)
    }

    pub(crate) fn check<'a>(&self, embedding: &'a Embedding) -> Result<&'a [f64], ModelError> {
        let (found, expected) = (embedding.size(), self.gradient.len());
        if found == expected {
            Ok(embedding.coordinates())
        } else {
            Err(ModelError::EmbeddingSize { found, expected })
        }
    }

    #[cfg(test)]
    pub(crate) fn for_tests(gradient: Vec<f64>, offset: f64) -> Self {
        Self {
            gradient,
            offset,
            covariance: None,
        }
    }
}
