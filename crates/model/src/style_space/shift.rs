//! Aggressive and Cautious: along g until S has moved by some points, or meets an end of the scale.

use super::AggressionAxis;
use crate::{error::ModelError, linear_algebra::dot};
use maveric_domain::{AdbScore, Embedding};

/// An embedding moved along the direction of aggression.
#[derive(Debug, Clone, PartialEq)]
pub struct Shifted {
    /// Where it is now.
    pub embedding: Embedding,
    /// S before, in points.
    pub from_points: f64,
    /// S now, in points.
    pub to_points: f64,
    /// By how much S really moved, in points.
    pub effective_points: f64,
    /// SD of that, as far as the people learned from determine the direction; see [`AggressionAxis::step_sd`].
    pub effective_sd: Option<f64>,
    /// Whether an end of the scale cut the move short.
    pub clamped: bool,
}

/// Moves `embedding` along g so that S changes by `points`, the target kept below 55 on the way up and
/// above 11 on the way down.
///
/// An embedding that S already reads beyond the end it is moved towards stays where it is.
///
/// # Errors
/// [`ModelError::EmbeddingSize`], or [`ModelError::NotFinite`] for `points`.
///
/// # Source
/// Method section 4: `w ± g·t` with t such that S moves by 15 points.
pub fn shift(
    axis: &AggressionAxis,
    embedding: &Embedding,
    points: f64,
) -> Result<Shifted, ModelError> {
    if !points.is_finite() {
        return Err(ModelError::NotFinite {
            signal: "points",
            found: points,
        });
    }
    let w = axis.check(embedding)?;
    let from_points = axis.points(w);
    let wanted = from_points + points;
    let to_points = if points >= 0.0 {
        wanted.min(AdbScore::MAX).max(from_points)
    } else {
        wanted.max(AdbScore::MIN).min(from_points)
    };
    let g = axis.gradient();
    let t = (to_points - from_points) / dot(g, g);
    let moved = w.iter().zip(g).map(|(w, g)| w + t * g).collect();
    let step: Vec<f64> = g.iter().map(|g| t * g).collect();
    Ok(Shifted {
        embedding: Embedding::new(moved)?,
        from_points,
        to_points,
        effective_points: to_points - from_points,
        effective_sd: axis.step_sd(&step),
        clamped: (to_points - wanted).abs() > 1e-9,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn axis() -> AggressionAxis {
        AggressionAxis::for_tests(vec![6.0, -3.0, 2.0], 30.0)
    }

    proptest! {
        #[test]
        fn fifteen_points_up_and_down_again_returns(w in prop::collection::vec(-0.4..0.4_f64, 3)) {
            let start = Embedding::new(w).unwrap();
            let up = shift(&axis(), &start, 15.0).unwrap();
            prop_assert!(!up.clamped);
            prop_assert!((up.effective_points - 15.0).abs() < 1e-9);
            prop_assert!((axis().aggression_hat(&up.embedding).unwrap() - up.to_points).abs() < 1e-9);
            let back = shift(&axis(), &up.embedding, -15.0).unwrap();
            for (a, b) in back.embedding.coordinates().iter().zip(start.coordinates()) {
                prop_assert!((a - b).abs() < 1e-9);
            }
        }

        #[test]
        fn no_shift_leaves_the_scale_or_goes_backwards(
            w in prop::collection::vec(-9.0..9.0_f64, 3),
            points in -60.0..60.0_f64,
        ) {
            let shifted = shift(&axis(), &Embedding::new(w).unwrap(), points).unwrap();
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
        let up = shift(&axis(), &start, 15.0).unwrap();
        assert!(up.clamped);
        assert!((up.to_points - 55.0).abs() < 1e-9);
        assert!((up.effective_points - 7.0).abs() < 1e-9);
    }
}
