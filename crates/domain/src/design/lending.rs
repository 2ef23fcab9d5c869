//! Whose style is lent to a rider: among which donors one is drawn.

use crate::survey::ScoreRange;
use std::cmp::Ordering;

/// With fewer possible donors than these nearly everybody meets the same one.
pub const FEWEST_DONORS: usize = 5;

/// How far a donor's style may lie from a rider's.
#[derive(Debug, Clone, Copy)]
pub struct Reach {
    /// The furthest that it is moved along the dial, in points of the score.
    pub shift_points: f64,
    /// Across the dial, least and most, in standard deviations over people.
    pub apart_sd: [f64; 2],
}

impl Reach {
    /// Two elevenths of the scale along the dial, 8 points of the ADB's 44; what was asked for across it.
    pub fn on(range: ScoreRange, apart_sd: [f64; 2]) -> Self {
        Self { shift_points: 2.0 * range.width() / 11.0, apart_sd }
    }
}

/// What a possible donor's style is to a rider.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Offer {
    /// How far it has to be moved along the dial, in points of the score.
    pub shift_points: f64,
    /// How far donor and rider lie apart across the dial, in standard deviations over people.
    pub distance_sd: f64,
    /// How many people it was lent to already.
    pub lent: usize,
}

impl Offer {
    /// Whether shift and distance are within reach.
    pub fn within(&self, reach: Reach) -> bool {
        let [least, most] = reach.apart_sd;
        self.shift_points.abs() <= reach.shift_points && (least..=most).contains(&self.distance_sd)
    }

    /// Places of the offers among which one is drawn: of those within reach the ones that were lent least; where none is, the nearest
    /// alone, first along the dial, then across it. Empty where there is no offer.
    pub fn drawn_among(offers: &[Self], reach: Reach) -> Vec<usize> {
        let within = |place: &usize| offers[*place].within(reach);
        let mut places: Vec<usize> = (0..offers.len()).filter(within).collect();
        if places.is_empty() {
            let nearer = |a: &usize, b: &usize| offers[*a].nearer(&offers[*b], reach);
            return (0..offers.len()).min_by(nearer).into_iter().collect();
        }
        let least = places.iter().map(|place| offers[*place].lent).min();
        places.retain(|place| Some(offers[*place].lent) == least);
        places
    }

    /// Which of two beyond reach is nearer: first along the dial, then across it.
    fn nearer(&self, other: &Self, reach: Reach) -> Ordering {
        let [least, most] = reach.apart_sd;
        let along = |offer: &Self| (offer.shift_points.abs() - reach.shift_points).max(0.0);
        let across = |offer: &Self| {
            let distance = offer.distance_sd;
            (least - distance).max(distance - most).max(0.0)
        };
        let order = along(self).total_cmp(&along(other));
        order.then(across(self).total_cmp(&across(other)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reach() -> Reach {
        Reach::on(ScoreRange::ADB, [0.7, 2.5])
    }

    fn offers<const N: usize>(of: [(f64, f64, usize); N]) -> Vec<Offer> {
        let offer = |(shift_points, distance_sd, lent)| Offer { shift_points, distance_sd, lent };
        of.map(offer).to_vec()
    }

    #[test]
    fn reach_ends_at_eight_points_and_at_both_distances() {
        assert_eq!(reach().shift_points.to_bits(), 8.0_f64.to_bits());
        let reached =
            |shift_points, distance_sd| offers([(shift_points, distance_sd, 0)])[0].within(reach());
        assert!(reached(8.0, 0.7) && reached(-8.0, 2.5));
        assert!(!reached(8.01, 1.0) && !reached(-8.01, 1.0));
        assert!(!reached(0.0, 0.69) && !reached(0.0, 2.51));
    }

    #[test]
    fn on_another_scale_reach_ends_at_as_large_a_share_of_it() {
        let on = |low, high| Reach::on(ScoreRange::new(low, high).unwrap(), [0.7, 2.5]);
        for (reach, furthest) in [(on(1.0, 6.0), 10.0 / 11.0), (on(11.0, 66.0), 10.0)] {
            assert!((reach.shift_points - furthest).abs() < 1e-12);
            assert_eq!(reach.apart_sd.map(f64::to_bits), [0.7, 2.5].map(f64::to_bits));
            let reached = |shift_points| offers([(shift_points, 1.0, 0)])[0].within(reach);
            assert!(reached(furthest - 1e-9) && reached(1e-9 - furthest));
            assert!(!reached(furthest + 1e-9) && !reached(-1e-9 - furthest));
        }
    }

    #[test]
    fn one_is_drawn_among_those_within_reach_that_were_lent_least() {
        let among = |of: [(f64, f64, usize); 4]| Offer::drawn_among(&offers(of), reach());
        let reached = [(1.0, 1.0, 1), (0.0, 2.0, 0), (-3.0, 1.0, 0)];
        let [a, b, c] = reached;
        // The first was never lent, and is too near.
        assert_eq!(among([(0.0, 0.1, 0), a, b, c]), [2, 3]);
        assert_eq!(among([(0.0, 0.1, 0), a, a, a]), [1, 2, 3]);
    }

    #[test]
    fn where_none_is_within_reach_the_nearest_is_drawn_first_along_the_dial() {
        let among = |of: [(f64, f64, usize); 2]| Offer::drawn_among(&offers(of), reach());
        // 9 points against 12, whoever was lent less; then, both within 8 points, .5 SD against .2, and 3 against 4.
        assert_eq!(among([(12.0, 1.0, 0), (-9.0, 5.0, 7)]), [1]);
        assert_eq!(among([(0.0, 0.2, 0), (4.0, 0.5, 0)]), [1]);
        assert_eq!(among([(0.0, 3.0, 0), (0.0, 4.0, 0)]), [0]);
        assert!(Offer::drawn_among(&[], reach()).is_empty());
    }
}
