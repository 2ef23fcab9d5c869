//! S: the score that a style is read as, solved in closed form after training.

use crate::{
    error::ModelError,
    linear_algebra::{dot, moments, spread},
};
use maveric_domain::{ParticipantId, stream_seed};
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};

/// A style as far as it is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Posterior {
    /// Its mean, shape `(d,)`.
    pub mean: Vec<f64>,
    /// Its covariance, shape `(d, d)`, row by row.
    pub covariance: Vec<f64>,
}

/// `S(w) = gradient·w + offset`, in points of the score, with how well the people learned from determine it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StyleHead {
    /// Points for each unit of the style, shape `(d,)`.
    pub gradient: Vec<f64>,
    /// Points of the mean style.
    pub offset: f64,
    /// Covariance of gradient and offset over bootstrap samples of people, shape `(d + 1, d + 1)`, row by row.
    pub covariance: Vec<f64>,
    /// SD of a score around what the style says: its own error as a reading of the style, in points.
    pub reading_sd: f64,
    /// Root-mean-square error for people left out, in points; none with fewer than three people.
    pub cross_fitted_rmse: Option<f64>,
    /// Pearson's r of score and reading for people left out.
    pub cross_fitted_r: Option<f64>,
    /// People learned from.
    pub people: usize,
    /// Their drives with a score.
    pub drives: usize,
}

/// A drive with a score: whose, what is known of its style from its driving alone, and the points.
#[derive(Debug, Clone)]
pub(crate) struct ScoredStyle {
    pub(crate) participant: ParticipantId,
    pub(crate) style: Posterior,
    pub(crate) points: f64,
}

/// Bootstrap samples of people.
const RESAMPLES: usize = 1000;
/// Weight of the prior that S is flat, in drives: it decides only where the people do not.
const PRIOR_DRIVES: f64 = 1.0;
/// The reading's error is at least this share of the scores' SD.
const LEAST_ERROR: f64 = 0.2;

impl StyleHead {
    /// S by least squares of the scores on the means of the styles; `None` where no two scores differ.
    ///
    /// A mean given the driving is shrunken as far as the driving is uncertain, so the slope on it is the slope on the style
    /// itself. Every error is of people left out, all their drives together.
    pub(crate) fn fit(scored: &[ScoredStyle], d: usize, seed: u64) -> Option<Self> {
        let first = scored.first()?.points;
        if scored.iter().all(|s| (s.points - first).abs() < 1e-9) {
            return None;
        }
        let mut people: Vec<&ParticipantId> = scored.iter().map(|s| &s.participant).collect();
        people.sort();
        people.dedup();
        let whose = |p: &ParticipantId| people.iter().position(|q| *q == p).unwrap_or(0);
        let owner: Vec<usize> = scored.iter().map(|s| whose(&s.participant)).collect();
        let full_line = least_squares(weighted(scored, &vec![1.0; scored.len()]), d)?;
        let gradient = full_line.as_slice()[..d].to_vec();
        let points = |line: &DVector<f64>, w: &[f64]| dot(&line.as_slice()[..d], w) + line[d];

        let mut left_out = Vec::new();
        for person in 0..people.len() {
            let weights: Vec<f64> =
                owner.iter().map(|o| f64::from(u8::from(*o != person))).collect();
            if let Some(line) = least_squares(weighted(scored, &weights), d) {
                let of_person = scored.iter().zip(&owner).filter(|(_, o)| **o == person);
                left_out.extend(of_person.map(|(s, _)| (s.points, points(&line, &s.style.mean))));
            }
        }
        let crossed = people.len() >= 3;
        let n = scored.len() as f64;
        let square = |pairs: &[(f64, f64)]| {
            pairs.iter().map(|(s, p)| (s - p).powi(2)).sum::<f64>() / pairs.len() as f64
        };
        let within: Vec<(f64, f64)> =
            scored.iter().map(|s| (s.points, points(&full_line, &s.style.mean))).collect();
        let error = square(if crossed { &left_out } else { &within });
        let unknown =
            scored.iter().map(|s| spread(&gradient, &s.style.covariance)).sum::<f64>() / n;
        let mean = scored.iter().map(|s| s.points).sum::<f64>() / n;
        let variance = scored.iter().map(|s| (s.points - mean).powi(2)).sum::<f64>() / n;
        let least = LEAST_ERROR * LEAST_ERROR * variance;
        Some(Self {
            covariance: bootstrap(scored, &owner, people.len(), d, seed),
            offset: full_line[d],
            reading_sd: (error - unknown).max(least).sqrt(),
            cross_fitted_rmse: crossed.then(|| error.sqrt()),
            cross_fitted_r: crossed.then(|| pearson(&left_out)).flatten(),
            people: people.len(),
            drives: scored.len(),
            gradient,
        })
    }

    /// Ŝ of a style, in points.
    pub fn points(&self, w: &[f64]) -> f64 {
        self.offset + dot(&self.gradient, w)
    }

    /// Checks what was read from a file.
    pub(crate) fn check(&self, d: usize) -> Result<(), ModelError> {
        let numbers = self.gradient.iter().chain(&self.covariance);
        let finite = numbers.chain([&self.offset, &self.reading_sd]).all(|x| x.is_finite());
        let sizes = self.gradient.len() == d && self.covariance.len() == (d + 1) * (d + 1);
        if finite && sizes && self.reading_sd > 0.0 {
            return Ok(());
        }
        Err(ModelError::bad_file("its style head is of another size or no number"))
    }
}

/// Slopes and offset of a score on styles, shape `(n, d)`, as training finds them for S, without how sure they are; none where no two
/// scores differ. It is what exchanging the scores of drives whose styles stay needs again and again.
///
/// # Errors
/// [`ModelError::EmbeddingSize`] for a style of another size than the first.
pub fn score_line(
    styles: &[&[f64]],
    points: &[f64],
) -> Result<Option<(Vec<f64>, f64)>, ModelError> {
    let pairs = styles.iter().zip(points);
    let expected = styles.first().map_or(0, |style| style.len());
    if let Some(other) = styles.iter().find(|style| style.len() != expected) {
        return Err(ModelError::EmbeddingSize { found: other.len(), expected });
    }
    let differ = points.iter().any(|p| (p - points[0]).abs() >= 1e-9);
    let rows = pairs.map(|(style, points)| (*style, *points, 1.0));
    let line = differ.then(|| least_squares(rows, expected)).flatten();
    Ok(line.map(|line| (line.as_slice()[..expected].to_vec(), line[expected])))
}

/// Slopes, then the offset, of rows of a style, its points and a weight.
fn least_squares<'a>(
    rows: impl Iterator<Item = (&'a [f64], f64, f64)>,
    d: usize,
) -> Option<DVector<f64>> {
    let mut total = 0.0;
    let mut normal = DMatrix::zeros(d + 1, d + 1);
    let mut right = DVector::zeros(d + 1);
    for (style, points, weight) in rows {
        let x = DVector::from_iterator(d + 1, style.iter().copied().chain([1.0]));
        normal += weight * &x * x.transpose();
        right += weight * points * x;
        total += weight;
    }
    if total <= 0.0 {
        return None;
    }
    for i in 0..d {
        normal[(i, i)] += PRIOR_DRIVES;
    }
    Some(normal.cholesky()?.solve(&right))
}

/// The scored drives as rows, each with its weight.
fn weighted<'a>(
    scored: &'a [ScoredStyle],
    weights: &'a [f64],
) -> impl Iterator<Item = (&'a [f64], f64, f64)> {
    let pairs = scored.iter().zip(weights);
    pairs.map(|(s, weight)| (s.style.mean.as_slice(), s.points, *weight))
}

fn bootstrap(
    scored: &[ScoredStyle],
    owner: &[usize],
    people: usize,
    d: usize,
    seed: u64,
) -> Vec<f64> {
    let mut rng = Pcg64Mcg::seed_from_u64(stream_seed(seed, &["style head", "bootstrap"]));
    let mut lines = Vec::new();
    for _ in 0..RESAMPLES {
        let mut drawn = vec![0.0; people];
        for _ in 0..people {
            drawn[rng.random_range(0..people)] += 1.0;
        }
        let weights: Vec<f64> = owner.iter().map(|o| drawn[*o]).collect();
        lines.extend(least_squares(weighted(scored, &weights), d));
    }
    moments(&lines, d + 1).1.iter().copied().collect()
}

fn pearson(pairs: &[(f64, f64)]) -> Option<f64> {
    let n = pairs.len() as f64;
    let (a, b) = pairs.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
    let sum = |f: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(f).sum::<f64>();
    let (xx, yy) = (sum(&|p| (p.0 - a).powi(2)), sum(&|p| (p.1 - b).powi(2)));
    let r = sum(&|p| (p.0 - a) * (p.1 - b)) / (xx * yy).sqrt();
    r.is_finite().then_some(r)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scored(n: usize, noise: f64) -> Vec<ScoredStyle> {
        let of = |i: usize| {
            let x = i as f64;
            let w = vec![(0.7 * x).sin(), (1.3 * x).cos(), (2.1 * x).sin()];
            ScoredStyle {
                participant: ParticipantId::new(format!("P{:02}", i / 2)).unwrap(),
                points: 28.0 + 6.0 * w[0] - 3.0 * w[1] + noise * (3.7 * x).sin(),
                style: Posterior { mean: w, covariance: vec![0.0; 9] },
            }
        };
        (0..n).map(of).collect()
    }

    #[test]
    fn slopes_come_back_and_the_bootstrap_covers_them() {
        let head = StyleHead::fit(&scored(60, 3.0), 3, 1).unwrap();
        for (i, truth) in [6.0, -3.0, 0.0].into_iter().enumerate() {
            let sd = head.covariance[i * 4 + i].sqrt();
            assert!(sd > 0.1 && sd < 1.5, "{sd}");
            assert!((head.gradient[i] - truth).abs() < 3.0 * sd + 0.3, "{head:?}");
        }
        assert!(head.cross_fitted_r.unwrap() > 0.8);
        assert_eq!((head.people, head.drives), (30, 60));
    }

    #[test]
    fn a_score_that_has_nothing_to_do_with_the_style_reads_nothing_for_people_left_out() {
        let mut points = scored(60, 0.0);
        for (i, s) in points.iter_mut().enumerate() {
            s.points = 30.0 + 10.0 * (17.3 * (i / 2) as f64).sin();
        }
        let head = StyleHead::fit(&points, 3, 1).unwrap();
        assert!(head.cross_fitted_r.unwrap() < 0.3, "{head:?}");
        assert!(head.reading_sd > 6.0);
        assert!(StyleHead::fit(&points[..1], 3, 1).is_none());
    }

    #[test]
    fn the_line_of_a_score_is_that_of_training_and_scores_that_are_alike_have_none() {
        let scored = scored(20, 3.0);
        let head = StyleHead::fit(&scored, 3, 1).unwrap();
        let styles: Vec<&[f64]> = scored.iter().map(|s| s.style.mean.as_slice()).collect();
        let mut points: Vec<f64> = scored.iter().map(|s| s.points).collect();
        let line = score_line(&styles, &points).unwrap();
        assert_eq!(line, Some((head.gradient, head.offset)));
        points.fill(30.0);
        assert_eq!(score_line(&styles, &points).unwrap(), None);
        assert_eq!(score_line(&[], &[]).unwrap(), None);
        assert!(score_line(&[&[1.0], &[1.0, 2.0]], &[1.0, 2.0]).is_err());
    }
}
