//! Whose style drives a ride, and where in style space that is.

use crate::lending::Lending;
use maveric_domain::{
    DriveId, Embedding, Lent,
    design::{Donors, Matched},
};
use maveric_model::{
    Model, ModelError,
    style_space::{LinearHead, PerpendicularEllipse},
};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Whose style drives.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RideStyle {
    /// The person's own, which the dial moves.
    Own,
    /// The average driver's.
    Mean,
    /// The person's own, moved across the dial at an angle that this seed draws.
    Across(Seed),
    /// Somebody else's of whom the model learned, moved along the dial to the person's own score.
    Lent {
        /// How far apart across the dial, least and most, in standard deviations.
        apart_sd: [f64; 2],
        /// Draws the donor.
        seed: Seed,
        /// The drives whose style may not be lent.
        #[serde(default, skip_serializing_if = "BTreeSet::is_empty")]
        withheld: BTreeSet<DriveId>,
    },
    /// This one, whoever rides.
    Given(Embedding),
    /// None: the person's own drive is shown again, which is in their own style.
    Replay,
}

/// Root of a random choice; written as text, since a page's numbers do not hold 64 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Seed(pub u64);

impl TryFrom<String> for Seed {
    type Error = std::num::ParseIntError;
    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse().map(Self)
    }
}

impl From<Seed> for String {
    fn from(seed: Seed) -> Self {
        seed.0.to_string()
    }
}

/// Where a style lies.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedStyle {
    /// In style space.
    pub embedding: Embedding,
    /// How far that is along the dial from the person's own, in points of the score; none where the model has no dial.
    pub moved_points: Option<f64>,
    /// Angle of a move across the dial, in rad; only there.
    pub angle_rad: Option<f64>,
    /// Whose style it is where it is lent.
    pub lent: Option<Lent>,
    /// Whether an end of the scale cut a move along the dial short.
    pub clamped: bool,
}

impl RideStyle {
    /// Where this style lies for somebody whose own is `own`, with the dial at `points`; the dial moves the own style alone.
    ///
    /// # Errors
    /// [`ModelError::NoAggressionAxis`] for a dial, or a move across it, of a model without one; [`ModelError::NoPerpendicular`] where there
    /// is nothing across it; [`ModelError::NoDonor`] where the model keeps nobody who lends; [`ModelError::EmbeddingSize`] for a style of another model.
    pub fn place(
        &self,
        model: &Model,
        own: &Embedding,
        points: f64,
    ) -> Result<PlacedStyle, ModelError> {
        let placed = |embedding, moved_points, angle_rad| PlacedStyle {
            embedding,
            moved_points,
            angle_rad,
            lent: None,
            clamped: false,
        };
        // A style that is not the person's own, and how far along the dial it is from there.
        let elsewhere = |style: &Embedding| {
            let moved = match LinearHead::aggression(model) {
                Ok(dial) => Some(dial.read(style)? - dial.read(own)?),
                Err(_) => None,
            };
            Ok(placed(style.clone(), moved, None))
        };
        match self {
            Self::Replay => Ok(placed(own.clone(), Some(0.0), None)),
            Self::Own if points.abs() < f64::EPSILON => Ok(placed(own.clone(), Some(0.0), None)),
            Self::Own => {
                let moved = LinearHead::aggression(model)?.shift(own, points)?;
                Ok(PlacedStyle {
                    clamped: moved.clamped,
                    ..placed(moved.embedding, Some(moved.effective_points), None)
                })
            }
            Self::Mean => elsewhere(model.mean_embedding()),
            Self::Across(Seed(seed)) => {
                let mut rng = Pcg64Mcg::seed_from_u64(*seed);
                let across = PerpendicularEllipse::of(model)?.sample(own, &mut rng)?;
                Ok(placed(across.embedding, Some(0.0), Some(across.angle_rad)))
            }
            Self::Lent { apart_sd, seed, withheld } => {
                let learned = Matched { from: Donors::Learned, apart_sd: *apart_sd };
                let mut lending = Lending::of(model, learned, Vec::new(), withheld)?;
                let drawn = lending.lend((None, own), seed.0)?;
                let (style, lent) = drawn.ok_or(ModelError::NoDonor)?;
                Ok(PlacedStyle { lent: Some(lent), ..elsewhere(&style)? })
            }
            Self::Given(style) => match (style.size(), model.embedding_size()) {
                (found, expected) if found != expected => {
                    Err(ModelError::EmbeddingSize { found, expected })
                }
                _ => elsewhere(style),
            },
        }
    }
}
