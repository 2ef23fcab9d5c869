//! Whose style is lent to a rider: among which donors one is drawn.

use std::cmp::Ordering;

/// The furthest that a donor's style is moved along the dial, in points of the ADB's scale: two elevenths of it, which has 44.
pub const FURTHEST_SHIFT_POINTS: f64 = 8.0;

/// With fewer possible donors than these nearly everybody meets the same one.
pub const FEWEST_DONORS: usize = 5;

/// What a possible donor's style is to a rider.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Offer {
    /// How far it has to be moved along the dial, in points of the ADB's scale.
    pub shift_points: f64,
    /// How far donor and rider lie apart across the dial, in standard deviations over people.
    pub distance_sd: f64,
    /// How many people it was lent to already.
    pub lent: usize,
}

impl Offer {
    /// Whether the shift is at most [`FURTHEST_SHIFT_POINTS`] and the distance within what was asked for: least and most.
    pub fn within_reach(&self, apart_sd: [f64; 2]) -> bool {
        let [least, most] = apart_sd;
        self.shift_points.abs() <= FURTHEST_SHIFT_POINTS
            && (least..=most).contains(&self.distance_sd)
    }

    /// Places of the offers among which one is drawn: of those within reach the ones that were lent least; where none is, the nearest
    /// alone, first along the dial, then across it. Empty where there is no offer.
    pub fn drawn_among(offers: &[Self], apart_sd: [f64; 2]) -> Vec<usize> {
        let within = |place: &usize| offers[*place].within_reach(apart_sd);
        let mut places: Vec<usize> = (0..offers.len()).filter(within).collect();
        if places.is_empty() {
            let nearer = |a: &usize, b: &usize| offers[*a].nearer(&offers[*b], apart_sd);
            return (0..offers.len()).min_by(nearer).into_iter().collect();
        }
        let least = places.iter().map(|place| offers[*place].lent).min();
        places.retain(|place| Some(offers[*place].lent) == least);
        places
    }

    /// Which of two beyond reach is nearer: first along the dial, then across it.
    fn nearer(&self, other: &Self, [least, most]: [f64; 2]) -> Ordering {
        let along = |offer: &Self| (offer.shift_points.abs() - FURTHEST_SHIFT_POINTS).max(0.0);
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

    const APART_SD: [f64; 2] = [0.7, 2.5];

    fn offers<const N: usize>(of: [(f64, f64, usize); N]) -> Vec<Offer> {
        let offer = |(shift_points, distance_sd, lent)| Offer {
            shift_points,
            distance_sd,
            lent,
        };
        of.map(offer).to_vec()
    }

    #[test]
    fn reach_ends_at_eight_points_and_at_both_distances() {
        let reached = |shift_points, distance_sd| {
            offers([(shift_points, distance_sd, 0)])[0].within_reach(APART_SD)
        };
        assert!(reached(8.0, 0.7) && reached(-8.0, 2.5));
        assert!(!reached(8.01, 1.0) && !reached(-8.01, 1.0));
        assert!(!reached(0.0, 0.69) && !reached(0.0, 2.51));
    }

    #[test]
    fn one_is_drawn_among_those_within_reach_that_were_lent_least() {
        let among = |of: [(f64, f64, usize); 4]| Offer::drawn_among(&offers(of), APART_SD);
        let reached = [(1.0, 1.0, 1), (0.0, 2.0, 0), (-3.0, 1.0, 0)];
        let [a, b, c] = reached;
        // The first was never lent, and is too near.
        assert_eq!(among([(0.0, 0.1, 0), a, b, c]), [2, 3]);
        assert_eq!(among([(0.0, 0.1, 0), a, a, a]), [1, 2, 3]);
    }

    #[test]
    fn where_none_is_within_reach_the_nearest_is_drawn_first_along_the_dial() {
        let among = |of: [(f64, f64, usize); 2]| Offer::drawn_among(&offers(of), APART_SD);
        // 9 points against 12, whoever was lent less; then, both within 8 points, .5 SD against .2, and 3 against 4.
        assert_eq!(among([(12.0, 1.0, 0), (-9.0, 5.0, 7)]), [1]);
        assert_eq!(among([(0.0, 0.2, 0), (4.0, 0.5, 0)]), [1]);
        assert_eq!(among([(0.0, 3.0, 0), (0.0, 4.0, 0)]), [0]);
        assert!(Offer::drawn_among(&[], APART_SD).is_empty());
    }
}
