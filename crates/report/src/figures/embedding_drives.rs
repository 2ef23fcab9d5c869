//! What is drawn of a style space, and how one drive and one condition look in it.

use super::ConditionLook;
use super::prelude::*;
use super::theme::viridis;
use maveric_domain::ConditionId;

/// Drivers in the style space.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EmbeddingSpace {
    /// The drivers, all with embeddings of the same size.
    pub points: Vec<EmbeddingPoint>,
    /// The gradient of the style predictor, of the same size; not zero.
    pub gradient: Vec<f64>,
    /// Lowest and highest score.
    pub score_range: (f64, f64),
    /// What the score is called, such as `ADB score`.
    pub score: String,
    /// One participant's conditions.
    pub example: Option<ExampleConditions>,
}

/// One driver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EmbeddingPoint {
    /// Coordinates in the model's style space.
    pub embedding: Vec<f64>,
    /// The driver's score in points: the size of the point.
    pub score_points: f64,
    /// Mean velocity in m/s: the colour of the point.
    pub mean_velocity_mps: f64,
}

/// Where one participant's conditions lie.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExampleConditions {
    /// The participant's id.
    pub participant: String,
    /// Where each lies.
    pub conditions: Vec<(ConditionId, Vec<f64>)>,
    /// Round the own style, one standard deviation wide, across the gradient; in order round it. Empty where it is not drawn.
    pub ellipse: Vec<Vec<f64>>,
}

impl ExampleConditions {
    pub(crate) fn all(&self) -> impl Iterator<Item = &[f64]> {
        self.conditions
            .iter()
            .map(|(_, w)| w.as_slice())
            .chain(self.ellipse.iter().map(Vec::as_slice))
    }
}

pub(crate) fn norm(vector: &[f64]) -> f64 {
    dot(vector, vector).sqrt()
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Mean velocities in m/s, slowest and fastest: what colours stand for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Palette {
    low: f64,
    high: f64,
}

impl Palette {
    pub(crate) fn for_points(points: &[EmbeddingPoint]) -> Self {
        let (low, high) = extent(points.iter().map(|point| point.mean_velocity_mps));
        Self { low, high }
    }

    pub(crate) fn colour(self, mps: f64) -> RGBColor {
        let range = self.high - self.low;
        viridis(if range > 1e-9 { (mps - self.low) / range } else { 0.5 })
    }

    /// Both ends in the unit of the page, in words.
    pub(crate) fn ends(self, context: &Context) -> [String; 2] {
        [self.low, self.high].map(|end| context.speed(end, 1))
    }
}

impl EmbeddingSpace {
    /// The gradient, of length 1.
    pub(crate) fn unit(&self) -> Vec<f64> {
        let length = norm(&self.gradient);
        self.gradient.iter().map(|g| g / length).collect()
    }

    /// Where the drives lie on average.
    pub(crate) fn centre(&self) -> Vec<f64> {
        let n = self.points.len() as f64;
        let along = |axis: usize| self.points.iter().map(move |p| p.embedding[axis]).sum::<f64>();
        (0..self.gradient.len()).map(|axis| along(axis) / n).collect()
    }

    /// Where everything that is drawn lies, the drives first.
    pub(crate) fn everything(&self) -> impl Iterator<Item = &[f64]> {
        let example = self.example.iter().flat_map(ExampleConditions::all);
        self.points.iter().map(|p| p.embedding.as_slice()).chain(example)
    }
}

/// Area grows with the score.
pub(crate) fn radius(score: f64, (low, high): (f64, f64)) -> f64 {
    let share = (score - low) / (high - low);
    (1.2 + share * 12.0).sqrt()
}

pub(crate) fn paint_point(
    canvas: &mut Canvas<'_>,
    at: (f64, f64),
    point: &EmbeddingPoint,
    palette: Palette,
    range: (f64, f64),
) {
    let r = radius(point.score_points, range);
    canvas.disc(at, r, palette.colour(point.mean_velocity_mps), 1.0);
    canvas.ring(at, r, Pen::new(PAPER, stroke::THIN));
}

pub(crate) fn paint_condition(canvas: &mut Canvas<'_>, at: (f64, f64), look: &ConditionLook) {
    canvas.marker(at, 4.6, look.marker, PAPER);
    canvas.marker(at, 3.8, look.marker, look.rgb());
}
