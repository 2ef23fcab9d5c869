//! How much of what was fitted to a person to believe.

use crate::error::{FollowingError, enough_drivers};
use serde::{Deserialize, Serialize};

/// How much of what was fitted to a person to believe: own rows beside what people are like, by how far those who were
/// learned from moved between the two halves of their fit rows.
///
/// A number fitted to `s` seconds of a person is kept by the share `1 − c · k / (s + k)`, and the rest is taken from the mean of
/// people. k are the seconds after which what changes within a person weighs as little as what tells people apart: seconds of a
/// half · within / between, by the moments of a one-way analysis of variance. It holds the drift of a person as well as the noise
/// of a fit; a fit to one stretch sees neither. c = (m − 2) / m is below 1 because k itself is uncertain: with few people it
/// is shrunken less.
///
/// # Source
/// Bühlmann's credibility (1967); c is the factor of Morris 1983, "Parametric empirical Bayes inference", with m = numbers
/// fitted · (people − 1) degrees of freedom between people.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Shrinkage {
    /// People it was estimated from.
    pub people: usize,
    /// Mean length of one of their halves, in s.
    pub half_s: f64,
    /// Variance between the halves of a person, summed over the numbers fitted.
    pub within: f64,
    /// Variance between people, summed over the numbers fitted; 0 where the halves of a person differ as much as people do.
    pub between: f64,
    /// k, in s; `None` where `between` is 0 and k without bound.
    pub strength_s: Option<f64>,
    /// c: the most that is taken away from what was fitted.
    pub most: f64,
}

impl Shrinkage {
    /// Estimates the strength from both halves of several people: `halves[person][half]` holds the numbers fitted there,
    /// `seconds[person]` the length of one half.
    ///
    /// # Errors
    /// [`FollowingError::TooFewDrivers`] below two people.
    pub fn estimate(halves: &[[Vec<f64>; 2]], seconds: &[f64]) -> Result<Self, FollowingError> {
        let people = halves.len();
        enough_drivers(people, 2)?;
        let n = people as f64;
        let square =
            |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum() };
        let within = halves.iter().map(|[a, b]| 0.5 * square(a, b)).sum::<f64>() / n;
        let middles: Vec<Vec<f64>> = halves
            .iter()
            .map(|[a, b]| a.iter().zip(b).map(|(x, y)| 0.5 * (x + y)).collect())
            .collect();
        let numbers = middles[0].len();
        let mean: Vec<f64> = (0..numbers)
            .map(|k| middles.iter().map(|m| m[k]).sum::<f64>() / n)
            .collect();
        let spread = middles.iter().map(|m| square(m, &mean)).sum::<f64>() / (n - 1.0);
        // The mean of two halves still holds half of what changes within a person.
        let between = (spread - 0.5 * within).max(0.0);
        let half_s = seconds.iter().sum::<f64>() / n;
        let freedom = numbers as f64 * (n - 1.0);
        Ok(Self {
            people,
            half_s,
            within,
            between,
            strength_s: (between > 0.0).then(|| half_s * within / between),
            most: (1.0 - 2.0 / freedom).max(0.0),
        })
    }

    /// The share of what was fitted to `seconds` of a person that is kept.
    pub fn share(&self, seconds: f64) -> f64 {
        1.0 - self.most * self.strength_s.map_or(1.0, |k| k / (seconds + k))
    }

    /// `own` moved towards `mean`.
    pub fn shrink(&self, own: &[f64], mean: &[f64], seconds: f64) -> Vec<f64> {
        let share = self.share(seconds);
        let moved = own.iter().zip(mean).map(|(x, m)| m + share * (x - m));
        moved.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_pcg::Pcg64;

    #[test]
    fn the_strength_is_the_one_worked_out_by_hand() {
        // Halves differ by 2: within 2. Middles 1, 3, 8: variance 13; between 13 - 1 = 12; k = 30 · 2/12. Two degrees of freedom
        // between three people say nothing yet; twice as many numbers say half.
        let halves = [(0.0, 2.0), (4.0, 2.0), (7.0, 9.0)];
        let one = halves.map(|(a, b)| [vec![a], vec![b]]);
        let found = Shrinkage::estimate(&one, &[20.0, 30.0, 40.0]).unwrap();
        assert!((found.within - 2.0).abs() < 1e-12 && (found.between - 12.0).abs() < 1e-12);
        assert!((found.strength_s.unwrap() - 5.0).abs() < 1e-12);
        assert!((found.share(15.0) - 1.0).abs() < 1e-12);
        let two = halves.map(|(a, b)| [vec![a, a], vec![b, b]]);
        let found = Shrinkage::estimate(&two, &[30.0; 3]).unwrap();
        assert!((found.share(15.0) - 0.875).abs() < 1e-12, "1 - 5/20/2");
        assert!((found.shrink(&[4.0], &[0.0], 15.0)[0] - 3.5).abs() < 1e-12);
    }

    #[test]
    fn the_fewer_people_the_less_is_taken_away_even_where_they_move_as_much_as_they_differ() {
        let halves = [(0.0, 2.0), (2.0, 0.0), (0.5, 1.5), (1.5, 0.5)];
        let halves = halves.map(|(a, b)| [vec![a], vec![b]]);
        let found = Shrinkage::estimate(&halves, &[30.0; 4]).unwrap();
        assert_eq!(found.strength_s, None);
        assert!((found.share(1e6) - 2.0 / 3.0).abs() < 1e-12);
        assert!(Shrinkage::estimate(&halves[..1], &[30.0]).is_err());
    }

    #[test]
    fn what_made_up_people_are_made_of_is_found_again() {
        let mut rng = Pcg64::seed_from_u64(1);
        let mut normal = |sd: f64| sd * rng.sample::<f64, _>(StandardNormal);
        // Two numbers a person: variance between people 2 · 1, within 2 · 0.25; k = 40 · 0.5/2.
        let halves: Vec<[Vec<f64>; 2]> = (0..20_000)
            .map(|_| {
                let person = [normal(1.0), normal(1.0)];
                [0, 1].map(|_| person.iter().map(|x| x + normal(0.5)).collect())
            })
            .collect();
        let found = Shrinkage::estimate(&halves, &vec![40.0; 20_000]).unwrap();
        assert!((found.strength_s.unwrap() - 10.0).abs() < 0.5, "{found:?}");
    }
}
