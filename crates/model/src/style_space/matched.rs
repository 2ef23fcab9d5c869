//! Another person's style at one's own place on the dial: what is "mine" beyond how aggressive it is.

use super::{LinearHead, PerpendicularEllipse};
use crate::{error::ModelError, model::Model};
use maveric_domain::{
    Embedding,
    design::{Offer, Reach},
};
use rand::{RngExt as _, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// An axis that is so much shorter than the longest is none: nobody differs along it.
const FLAT: f64 = 1e-6;

/// Somebody whose style may be lent.
#[derive(Debug, Clone, Copy)]
pub struct Donor<'a> {
    /// Their own style.
    pub style: &'a Embedding,
    /// How many people it was lent to already.
    pub lent: usize,
}

/// A donor's style, moved along the dial to the rider's score.
#[derive(Debug, Clone, PartialEq)]
pub struct MatchedStyle {
    /// `w_d + g (S_own − S_d)/|g|²`.
    pub embedding: Embedding,
    /// `S_own − S_d`, in points of the score.
    pub shift_points: f64,
    /// How far donor and rider lie apart across the dial, in standard deviations of the people learned from.
    pub distance_sd: f64,
    /// As [`Offer::within`].
    pub within_reach: bool,
}

/// Draws donors of a model.
#[derive(Debug)]
pub struct Matching {
    dial: LinearHead,
    across: PerpendicularEllipse,
    reach: Reach,
}

impl Matching {
    /// Donors and riders shall lie `apart_sd` apart across the dial: least and most, in standard deviations.
    ///
    /// # Errors
    /// [`ModelError::NoAggressionAxis`], or [`ModelError::NoPerpendicular`] for a style of one number.
    pub fn of(model: &Model, apart_sd: [f64; 2]) -> Result<Self, ModelError> {
        Ok(Self {
            dial: LinearHead::aggression(model)?,
            across: PerpendicularEllipse::of(model)?,
            reach: Reach::on(model.score_range(), apart_sd),
        })
    }

    /// A donor's style for a rider. The move goes to the rider's own score even where that lies beyond an end of the scale, since
    /// the rider's own style is driven as it is.
    ///
    /// # Errors
    /// [`ModelError::EmbeddingSize`] for a style of another model.
    pub fn lend(&self, own: &Embedding, donor: &Embedding) -> Result<MatchedStyle, ModelError> {
        let shift_points = self.dial.read(own)? - self.dial.read(donor)?;
        let gradient = self.dial.gradient();
        let a_point = shift_points / gradient.iter().map(|g| g * g).sum::<f64>();
        let moved = donor.coordinates().iter().zip(gradient);
        let embedding = Embedding::new(moved.map(|(w, g)| w + g * a_point).collect())?;
        let apart = |axis: &[f64]| -> f64 {
            let both = embedding.coordinates().iter().zip(own.coordinates());
            both.zip(axis).map(|((a, b), x)| (a - b) * x).sum()
        };
        let halves = self.across.axes().iter().zip(self.across.half_axes());
        let widest = self.across.half_axes().iter().copied().fold(0.0, f64::max);
        let squares = halves.filter(|(_, half)| **half > FLAT * widest);
        let squares = squares.map(|(axis, half)| (apart(axis) / half).powi(2));
        let distance_sd = squares.sum::<f64>().sqrt();
        let offer = Offer { shift_points, distance_sd, lent: 0 };
        Ok(MatchedStyle {
            embedding,
            shift_points,
            distance_sd,
            within_reach: offer.within(self.reach),
        })
    }

    /// Draws a donor among those of [`Offer::drawn_among`]. Gives the donor's place in the list; none where the list is empty.
    ///
    /// # Errors
    /// [`ModelError::EmbeddingSize`] for a style of another model.
    pub fn draw(
        &self,
        own: &Embedding,
        donors: &[Donor<'_>],
        seed: u64,
    ) -> Result<Option<(usize, MatchedStyle)>, ModelError> {
        let lent = donors.iter().map(|donor| self.lend(own, donor.style));
        let mut styles: Vec<MatchedStyle> = lent.collect::<Result<_, _>>()?;
        let offers = styles.iter().zip(donors).map(|(style, donor)| Offer {
            shift_points: style.shift_points,
            distance_sd: style.distance_sd,
            lent: donor.lent,
        });
        let offers: Vec<Offer> = offers.collect();
        let among = Offer::drawn_among(&offers, self.reach);
        if among.is_empty() {
            return Ok(None);
        }
        let drawn = among[Pcg64Mcg::seed_from_u64(seed).random_range(0..among.len())];
        Ok(Some((drawn, styles.swap_remove(drawn))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::ScoreRange;
    use nalgebra::DVector;

    /// The first coordinate is the dial, 4 points a unit; across it one SD is 1 along the second and 2 along the third.
    fn matching() -> Matching {
        let points = [-1.0, 1.0].iter().flat_map(|a| [-1.0, 1.0].map(|b| [*a, b]));
        let points = points.map(|[a, b]| DVector::from_vec(vec![a, a, 2.0 * b]));
        let points: Vec<DVector<f64>> = points.collect();
        let direction = DVector::from_vec(vec![1.0, 0.0, 0.0]);
        Matching {
            dial: LinearHead::for_tests("aggression", &[4.0, 0.0, 0.0], 30.0, [11.0, 55.0]),
            across: PerpendicularEllipse::around(&direction, &points, &[20.0; 4]),
            reach: Reach::on(ScoreRange::ADB, [0.7, 2.5]),
        }
    }

    fn style(w: [f64; 3]) -> Embedding {
        Embedding::new(w.to_vec()).unwrap()
    }

    #[test]
    fn a_lent_style_has_the_riders_score_and_keeps_what_lies_across_the_dial() {
        let matching = matching();
        let own = style([1.0, 0.0, 0.0]);
        let lent = matching.lend(&own, &style([-0.5, 1.0, 2.0])).unwrap();
        assert_eq!(lent.embedding, style([1.0, 1.0, 2.0]));
        assert!((lent.shift_points - 6.0).abs() < 1e-12);
        assert!((lent.distance_sd - 2.0_f64.sqrt()).abs() < 1e-9, "{lent:?}");
        assert!(lent.within_reach);
        for (donor, why) in [
            ([-1.1, 1.0, 2.0], "8.4 points away"),
            ([1.0, 0.6, 0.0], "0.6 SD apart"),
            ([1.0, 0.0, 5.2], "2.6 SD apart"),
        ] {
            let lent = matching.lend(&own, &style(donor)).unwrap();
            assert!(!lent.within_reach, "{why}: {lent:?}");
        }
        // Beyond an end of the scale the own style is driven as it is, and so is the one beside it.
        let beyond = style([7.0, 0.0, 0.0]);
        let lent = matching.lend(&beyond, &style([6.0, 1.0, 0.0])).unwrap();
        assert_eq!(lent.embedding, style([7.0, 1.0, 0.0]));
        assert!(matching.lend(&own, &Embedding::new(vec![0.0]).unwrap()).is_err());
    }

    #[test]
    fn who_was_lent_least_is_drawn_and_every_donor_within_reach_comes_up() {
        let matching = matching();
        let own = style([0.0; 3]);
        let styles =
            [[0.0, 1.0, 0.0], [0.5, -1.0, 0.0], [0.0, 0.0, 2.0], [9.0, 0.0, 2.0]].map(style);
        let donors = |lent: [usize; 4]| -> Vec<Donor<'_>> {
            let pairs = styles.iter().zip(lent);
            pairs.map(|(style, lent)| Donor { style, lent }).collect()
        };
        let drawn = |lent, seed| matching.draw(&own, &donors(lent), seed).unwrap().unwrap().0;
        let all: std::collections::BTreeSet<usize> =
            (0..50).map(|s| drawn([1, 1, 1, 0], s)).collect();
        assert_eq!(all, [0, 1, 2].into(), "the fourth is out of reach");
        assert!((0..50).all(|seed| drawn([1, 0, 1, 0], seed) == 1));
        assert_eq!(drawn([1, 1, 1, 0], 3), drawn([1, 1, 1, 0], 3));
        assert_eq!(matching.draw(&own, &[], 1).unwrap(), None);
    }

    #[test]
    fn where_nobody_is_within_reach_the_nearest_is_drawn_and_marked() {
        let matching = matching();
        let own = style([0.0; 3]);
        let nearest = |donors: &[[f64; 3]]| {
            let styles: Vec<Embedding> = donors.iter().copied().map(style).collect();
            let donors: Vec<Donor<'_>> =
                styles.iter().map(|style| Donor { style, lent: 0 }).collect();
            let (at, drawn) = matching.draw(&own, &donors, 1).unwrap().unwrap();
            assert!(!drawn.within_reach);
            at
        };
        // 9 points against 12; then, both within 8 points, .5 SD against .2, and 3 against 4.
        assert_eq!(nearest(&[[3.0, 1.0, 0.0], [2.25, 5.0, 0.0]]), 1);
        assert_eq!(nearest(&[[0.0, 0.2, 0.0], [1.0, 0.5, 0.0], [3.0, 1.0, 0.0]]), 1);
        assert_eq!(nearest(&[[0.0, 4.0, 0.0], [0.0, 3.0, 0.0]]), 1);
    }
}
