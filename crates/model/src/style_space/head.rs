//! A score as a linear function of the style, and moving along it.

use crate::{
    error::ModelError,
    linear_algebra::{dot, norm, spread},
    model::{Heads, Model},
};
use maveric_domain::Embedding;

/// A score read from a style: `g·w + c`, within the range in which it was seen. It is linear, so g is one direction.
///
/// # Source
/// Method section 4; paper, "Modulating Aggression".
#[derive(Debug, Clone, PartialEq)]
pub struct LinearHead {
    pub(super) name: String,
    pub(super) gradient: Vec<f64>,
    pub(super) offset: f64,
    pub(super) range: [f64; 2],
    /// Of g over samples of the people learned from, shape `(d, d)`.
    pub(super) covariance: Option<Vec<f64>>,
}

/// A style moved along a score.
#[derive(Debug, Clone, PartialEq)]
pub struct Moved {
    /// Where it is now.
    pub embedding: Embedding,
    /// The score before, in its points.
    pub from_points: f64,
    /// The score now.
    pub to_points: f64,
    /// By how much it really moved.
    pub effective_points: f64,
    /// SD of that, as far as the people learned from determine the direction; see [`LinearHead::step_sd`].
    pub effective_sd: Option<f64>,
    /// Whether an end of the range cut the move short.
    pub clamped: bool,
}

impl LinearHead {
    /// S of a model, under the name `aggression`, within the ends of its scale.
    ///
    /// # Errors
    /// [`ModelError::NoAggressionAxis`] if the model saw no score, or its S is flat.
    pub fn aggression(model: &Model) -> Result<Self, ModelError> {
        let none = ModelError::NoAggressionAxis;
        let (gradient, offset, covariance) = match model.heads() {
            Heads::Linear(linear) => {
                let style = linear.style.as_ref().ok_or(none.clone())?;
                let d = style.gradient.len();
                let of_slopes = style.covariance.chunks_exact(d + 1).take(d);
                let covariance = of_slopes.flat_map(|line| &line[..d]).copied();
                (style.gradient.clone(), style.offset, Some(covariance.collect()))
            }
            Heads::Paper(paper) => {
                let (gradient, offset) = paper.style_points();
                (gradient, offset, None)
            }
        };
        if !model.knows_aggression() || norm(&gradient) < 1e-9 {
            return Err(none);
        }
        Ok(Self {
            name: "aggression".to_owned(),
            gradient,
            offset,
            range: model.score_range().into(),
            covariance,
        })
    }

    /// What the score is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// g, in points of the score per unit of the embedding, shape `(d,)`.
    pub fn gradient(&self) -> &[f64] {
        &self.gradient
    }

    /// g/|g|, shape `(d,)`.
    pub fn direction(&self) -> Vec<f64> {
        let length = norm(&self.gradient);
        self.gradient.iter().map(|g| g / length).collect()
    }

    /// Lowest and highest score seen, or the ends of the scale: moves stop there.
    pub fn range(&self) -> [f64; 2] {
        self.range
    }

    /// The score read from an embedding, in its own points; not limited to the range.
    ///
    /// # Errors
    /// [`ModelError::EmbeddingSize`] if the embedding is not of the head's size.
    pub fn read(&self, embedding: &Embedding) -> Result<f64, ModelError> {
        Ok(self.offset + dot(&self.gradient, self.check(embedding)?))
    }

    /// Position on the line along g: the projection of w on g/|g|.
    ///
    /// # Errors
    /// [`ModelError::EmbeddingSize`] if the embedding is not of the head's size.
    pub fn position(&self, embedding: &Embedding) -> Result<f64, ModelError> {
        Ok(dot(&self.direction(), self.check(embedding)?))
    }

    /// SD of the change of the score along `step`, in points, as far as the people learned from determine the slopes; `None` where
    /// that is not known, as of the paper's S, which was trained with everything else.
    pub fn step_sd(&self, step: &[f64]) -> Option<f64> {
        Some(spread(step, self.covariance.as_ref()?).sqrt())
    }

    /// Moves `embedding` along g so that the score changes by `points`, kept within the range in the way it moves.
    ///
    /// An embedding that is read beyond the end it is moved towards stays where it is.
    ///
    /// # Errors
    /// [`ModelError::EmbeddingSize`], or [`ModelError::NotFinite`] for `points`.
    ///
    /// # Source
    /// Method section 4: `w ± g·t` with t such that S moves by 15 points.
    pub fn shift(&self, embedding: &Embedding, points: f64) -> Result<Moved, ModelError> {
        let square = dot(&self.gradient, &self.gradient);
        let one: Vec<f64> = self.gradient.iter().map(|g| g / square).collect();
        self.moved(embedding, &one, points)
    }

    /// Moves by `points`, `one` being the move for one point.
    pub(super) fn moved(
        &self,
        embedding: &Embedding,
        one: &[f64],
        points: f64,
    ) -> Result<Moved, ModelError> {
        if !points.is_finite() {
            return Err(ModelError::NotFinite { signal: "points", found: points });
        }
        let from_points = self.read(embedding)?;
        let wanted = from_points + points;
        let [low, high] = self.range;
        let to_points = if points >= 0.0 {
            wanted.min(high).max(from_points)
        } else {
            wanted.max(low).min(from_points)
        };
        let by = to_points - from_points;
        let step: Vec<f64> = one.iter().map(|s| by * s).collect();
        let moved = embedding.coordinates().iter().zip(&step);
        Ok(Moved {
            embedding: Embedding::new(moved.map(|(w, s)| w + s).collect())?,
            from_points,
            to_points,
            effective_points: by,
            effective_sd: self.step_sd(&step),
            clamped: (to_points - wanted).abs() > 1e-9,
        })
    }

    fn check<'a>(&self, embedding: &'a Embedding) -> Result<&'a [f64], ModelError> {
        ModelError::check_size(embedding.size(), self.gradient.len())?;
        Ok(embedding.coordinates())
    }

    #[cfg(test)]
    pub(crate) fn for_tests(name: &str, gradient: &[f64], offset: f64, range: [f64; 2]) -> Self {
        Self { name: name.to_owned(), gradient: gradient.to_vec(), offset, range, covariance: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn axis() -> LinearHead {
        LinearHead::for_tests("aggression", &[6.0, -3.0, 2.0], 30.0, [11.0, 55.0])
    }

    proptest! {
        #[test]
        fn fifteen_points_up_and_down_again_returns(w in prop::collection::vec(-0.4..0.4_f64, 3)) {
            let start = Embedding::new(w).unwrap();
            let up = axis().shift(&start, 15.0).unwrap();
            prop_assert!(!up.clamped);
            prop_assert!((up.effective_points - 15.0).abs() < 1e-9);
            prop_assert!((axis().read(&up.embedding).unwrap() - up.to_points).abs() < 1e-9);
            let back = axis().shift(&up.embedding, -15.0).unwrap();
            for (a, b) in back.embedding.coordinates().iter().zip(start.coordinates()) {
                prop_assert!((a - b).abs() < 1e-9);
            }
        }

        #[test]
        fn no_shift_leaves_the_scale_or_goes_backwards(
            w in prop::collection::vec(-9.0..9.0_f64, 3),
            points in -60.0..60.0_f64,
        ) {
            let shifted = axis().shift(&Embedding::new(w).unwrap(), points).unwrap();
            prop_assert!(shifted.effective_points * points >= 0.0);
            // Beyond the end it moves towards only where it was before.
            let (from, to) = (shifted.from_points, shifted.to_points);
            prop_assert!(points < 0.0 || to <= from.max(55.0) + 1e-9);
            prop_assert!(points > 0.0 || to >= from.min(11.0) - 1e-9);
            prop_assert!(shifted.clamped || (shifted.effective_points - points).abs() < 1e-9);
        }
    }

    #[test]
    fn the_scale_ends_at_55() {
        let start = Embedding::new(vec![3.0, 0.0, 0.0]).unwrap();
        let up = axis().shift(&start, 15.0).unwrap();
        assert!(up.clamped);
        assert!((up.to_points - 55.0).abs() < 1e-9);
        assert!((up.effective_points - 7.0).abs() < 1e-9);
    }

    #[test]
    fn a_step_is_as_sure_as_the_slopes_along_it() {
        let known = LinearHead {
            covariance: Some(vec![4.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]),
            ..axis()
        };
        assert!((known.step_sd(&[2.0, 0.0, 5.0]).unwrap() - 4.0).abs() < 1e-12);
        assert_eq!(axis().step_sd(&[1.0, 0.0, 0.0]), None);
    }
}
