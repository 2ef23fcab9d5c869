//! Moving along one attribute while others stay as they are.

use super::{LinearHead, Moved};
use crate::{
    error::ModelError,
    linear_algebra::{moments, of_symmetric},
    model::Model,
};
use maveric_domain::Embedding;
use nalgebra::{DMatrix, DVector};

/// Heads whose normalised Gram matrix has an eigenvalue below this point the same way: one cannot move alone.
const COLLINEAR: f64 = 1e-4;

/// How far apart two embeddings are: in SDs of the training embeddings along every direction.
#[derive(Debug, Clone, PartialEq)]
pub struct StyleMetric {
    /// Covariance of the training embeddings, 1 in directions in which they do not differ; shape `(d, d)`.
    covariance: DMatrix<f64>,
}

impl StyleMetric {
    /// The metric of a model's training embeddings; the plain Euclidean one where they are whitened.
    pub fn of(model: &Model) -> Self {
        Self::of_points(&model.points(), model.embedding_size())
    }

    fn of_points(points: &[DVector<f64>], d: usize) -> Self {
        let (_, covariance) = moments(points, d);
        let least = 1e-8 * covariance.symmetric_eigenvalues().max().max(f64::MIN_POSITIVE);
        Self { covariance: of_symmetric(&covariance, |v| if v > least { v } else { 1.0 }) }
    }

    /// Moves `embedding` so that `heads[0]` changes by `points` and every other head not at all: the shortest such
    /// move, `δ = C Aᵀ (A C Aᵀ)⁻¹ (points, 0, …)` with the heads' gradients as the rows of A and C the covariance of the training
    /// embeddings. The target is kept within the first head's range, as in [`LinearHead::shift`].
    ///
    /// # Errors
    /// [`ModelError::TooManyAttributes`] for more heads than the embedding has numbers,
    /// [`ModelError::CollinearHeads`] if the first cannot move without the others,
    /// [`ModelError::FlatHead`] for a head that reads nothing, [`ModelError::EmbeddingSize`], or [`ModelError::NotFinite`]
    /// for `points`.
    ///
    /// # Source
    /// Ours; with one head it is the move of method section 4.
    pub fn move_along(
        &self,
        heads: &[&LinearHead],
        embedding: &Embedding,
        points: f64,
    ) -> Result<Moved, ModelError> {
        let one = self.unit_move(heads)?;
        heads[0].moved(embedding, one.as_slice(), points)
    }

    /// The move for one point of the first head.
    fn unit_move(&self, heads: &[&LinearHead]) -> Result<DVector<f64>, ModelError> {
        let (k, d) = (heads.len(), self.covariance.nrows());
        if k == 0 || k > d {
            return Err(ModelError::TooManyAttributes { found: k, expected: d });
        }
        let of_other_size = heads.iter().map(|h| h.gradient().len()).find(|&size| size != d);
        if let Some(found) = of_other_size {
            return Err(ModelError::EmbeddingSize { found, expected: d });
        }
        // Gradients as columns, each by its length in the metric, so that heads in points of any size compare.
        let mut gradients = DMatrix::from_fn(d, k, |i, j| heads[j].gradient()[i]);
        let mut first = 0.0;
        for (j, mut gradient) in gradients.column_iter_mut().enumerate() {
            let length = gradient.dot(&(&self.covariance * &gradient)).max(0.0).sqrt();
            if length < 1e-9 {
                return Err(ModelError::FlatHead { head: heads[j].name().to_owned() });
            }
            gradient /= length;
            first = if j == 0 { length } else { first };
        }
        let raised = &self.covariance * &gradients;
        let gram = gradients.tr_mul(&raised);
        let alone = gram.symmetric_eigenvalues().min() >= COLLINEAR;
        let Some(inverse) = gram.try_inverse().filter(|_| alone) else {
            return Err(ModelError::CollinearHeads {
                heads: heads.iter().map(|h| h.name().to_owned()).collect(),
                moved: heads[0].name().to_owned(),
            });
        };
        Ok(raised * inverse.column(0) / first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear_algebra::{dot, norm};
    use proptest::prelude::*;

    fn plain(d: usize) -> StyleMetric {
        StyleMetric::of_points(&[], d)
    }

    fn head(name: &str, gradient: &[f64]) -> LinearHead {
        LinearHead::for_tests(name, gradient, 10.0, [-1e9, 1e9])
    }

    proptest! {
        #[test]
        fn the_first_head_moves_the_others_stay_and_no_move_is_shorter(
            a in prop::collection::vec(-3.0..3.0_f64, 4),
            b in prop::collection::vec(-3.0..3.0_f64, 4),
            c in prop::collection::vec(-3.0..3.0_f64, 4),
            w in prop::collection::vec(-2.0..2.0_f64, 4),
            other in prop::collection::vec(-2.0..2.0_f64, 4),
            points in -5.0..5.0_f64,
        ) {
            let heads = [head("a", &a), head("b", &b), head("c", &c)];
            let refs: Vec<&LinearHead> = heads.iter().collect();
            let start = Embedding::new(w).unwrap();
            let Ok(moved) = plain(4).move_along(&refs, &start, points) else {
                return Ok(()); // nearly collinear
            };
            let change = |h: &LinearHead| h.read(&moved.embedding).unwrap() - h.read(&start).unwrap();
            prop_assert!((change(&heads[0]) - points).abs() < 1e-6);
            prop_assert!(change(&heads[1]).abs() < 1e-6);
            prop_assert!(change(&heads[2]).abs() < 1e-6);
            // The move lies in the heads' span: nothing perpendicular to them all is in it.
            let delta: Vec<f64> = moved.embedding.coordinates().iter().zip(start.coordinates()).map(|(a, b)| a - b).collect();
            let zero: Vec<f64> = {
                // Remove from `other` everything the heads read.
                let mut rest = other;
                let mut basis: Vec<Vec<f64>> = Vec::new();
                for h in &heads {
                    let mut v = h.gradient().to_vec();
                    for _ in 0..2 {
                        for b in &basis {
                            let along = dot(&v, b);
                            for (x, b) in v.iter_mut().zip(b) { *x -= along * b; }
                        }
                    }
                    let length = norm(&v);
                    basis.push(v.iter().map(|x| x / length).collect());
                }
                for b in &basis {
                    let along = dot(&rest, b);
                    for (x, b) in rest.iter_mut().zip(b) { *x -= along * b; }
                }
                rest
            };
            prop_assert!(dot(&delta, &zero).abs() < 1e-4 * (1.0 + norm(&delta)) * (1.0 + norm(&zero)));
        }
    }

    #[test]
    fn one_head_moves_as_the_shift_of_the_aggression_axis() {
        let s = LinearHead::for_tests("aggression", &[6.0, -3.0, 2.0], 30.0, [11.0, 55.0]);
        let start = Embedding::new(vec![0.3, 0.1, -0.4]).unwrap();
        for points in [-40.0, -15.0, 0.0, 15.0, 40.0] {
            let shifted = s.shift(&start, points).unwrap();
            let moved = plain(3).move_along(&[&s], &start, points).unwrap();
            for (a, b) in moved.embedding.coordinates().iter().zip(shifted.embedding.coordinates())
            {
                assert!((a - b).abs() < 1e-9);
            }
            assert_eq!(moved.clamped, shifted.clamped);
        }
    }

    #[test]
    fn the_shortest_move_counts_in_sds_of_the_drivers() {
        // Drivers differ ten times more along the second coordinate, so a move along it is the cheaper one.
        let points = [[1.0, 0.0], [-1.0, 0.0], [0.0, 10.0], [0.0, -10.0]];
        let metric = StyleMetric::of_points(&points.map(|p| DVector::from_column_slice(&p)), 2);
        let start = Embedding::new(vec![0.0, 0.0]).unwrap();
        let moved = metric.move_along(&[&head("a", &[1.0, 1.0])], &start, 1.0).unwrap();
        let [first, second] = moved.embedding.coordinates() else {
            panic!("two coordinates");
        };
        assert!((second / first - 100.0).abs() < 1e-6);
    }

    #[test]
    fn what_cannot_be_held_is_said() {
        let start = Embedding::new(vec![0.0, 0.0]).unwrap();
        let (a, b, c) = (head("a", &[1.0, 2.0]), head("b", &[-2.0, -4.0]), head("c", &[0.0, 1.0]));
        let metric = plain(2);
        let collinear = metric.move_along(&[&a, &b], &start, 1.0).unwrap_err();
        assert!(collinear.to_string().contains("a, b"), "{collinear}");
        let many = metric.move_along(&[&a, &b, &c], &start, 1.0).unwrap_err();
        assert!(matches!(many, ModelError::TooManyAttributes { found: 3, expected: 2 }));
        let flat = head("flat", &[0.0, 0.0]);
        let flat = metric.move_along(&[&a, &flat], &start, 1.0).unwrap_err();
        assert!(matches!(flat, ModelError::FlatHead { .. }));
    }

    #[test]
    fn a_move_stops_at_the_ends_of_what_was_seen() {
        let seen = LinearHead::for_tests("seen", &[2.0, 0.0], 5.0, [1.0, 8.0]);
        let start = Embedding::new(vec![0.0, 0.0]).unwrap();
        let up = plain(2).move_along(&[&seen], &start, 10.0).unwrap();
        assert!(up.clamped && (up.to_points - 8.0).abs() < 1e-12);
        let down = plain(2).move_along(&[&seen], &start, -10.0).unwrap();
        assert!(down.clamped && (down.to_points - 1.0).abs() < 1e-12);
    }
}
