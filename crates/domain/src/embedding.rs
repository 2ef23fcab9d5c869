//! A point in style space.

use crate::error::{DomainError, at_least, finite};
use serde::{Deserialize, Serialize};

/// A style embedding: shape `(d,)`, without unit, whitened over the training drivers.
///
/// # Source
/// w^(p) in the paper; `embedding` in method section 2.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<f64>", into = "Vec<f64>")]
pub struct Embedding(Vec<f64>);

impl Embedding {
    /// Takes one or more finite coordinates.
    ///
    /// # Errors
    /// [`DomainError::TooShort`] without coordinates, [`DomainError::NotFinite`] for NaN or infinity.
    pub fn new(coordinates: Vec<f64>) -> Result<Self, DomainError> {
        at_least("embedding", coordinates.len(), 1)?;
        finite("embedding", &coordinates)?;
        Ok(Self(coordinates))
    }

    /// Coordinates, shape `(d,)`.
    pub fn coordinates(&self) -> &[f64] {
        &self.0
    }

    /// Number of coordinates, d.
    pub fn size(&self) -> usize {
        self.0.len()
    }
}

impl TryFrom<Vec<f64>> for Embedding {
    type Error = DomainError;
    fn try_from(coordinates: Vec<f64>) -> Result<Self, DomainError> {
        Self::new(coordinates)
    }
}

impl From<Embedding> for Vec<f64> {
    fn from(embedding: Embedding) -> Self {
        embedding.0
    }
}
