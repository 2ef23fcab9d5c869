//! Whose style is lent to whom in a study of made-up people.

use crate::{
    error::RehearsalError,
    population::{CarSetting, MeasureModel, PopulationModel},
};
use maveric_domain::{
    ConditionId, ScoreRange,
    design::{FEWEST_DONORS, Matched, Offer, Reach},
    stream_seed,
};
use maveric_participants::{Participant, Trait};
use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg64;
use std::collections::BTreeSet;

/// Points of the ADB's scale in one step of the population's dial.
pub(crate) const POINTS: f64 = 15.0;

/// Where the style of a made-up person lies.
#[derive(Debug, Clone)]
pub(crate) struct Place<'a> {
    pub(crate) person: &'a Participant,
    /// On the line, up with aggression, in points of the ADB's scale.
    pub(crate) line_points: f64,
    /// Across the line, in standard deviations over people.
    pub(crate) across: Vec<f64>,
}

/// A style that somebody else lends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Loan<'a> {
    pub(crate) donor: &'a Participant,
    pub(crate) offer: Offer,
    pub(crate) within_reach: bool,
}

impl<'a> Loan<'a> {
    /// The donor's style, moved to the rider's score.
    pub(crate) fn setting(&self) -> CarSetting<'a> {
        CarSetting::Lent { donor: self.donor, shift: self.offer.shift_points / POINTS }
    }
}

impl Place<'_> {
    fn offer(&self, donor: &Self, lent: usize) -> Offer {
        let both = self.across.iter().zip(&donor.across);
        let squares = both.map(|(own, other)| (own - other).powi(2));
        Offer {
            shift_points: self.line_points - donor.line_points,
            distance_sd: squares.sum::<f64>().sqrt(),
            lent,
        }
    }
}

/// The traits that driving comes from: those that a measure or the line takes something of.
pub(crate) fn style_traits(population: &PopulationModel) -> BTreeSet<Trait> {
    let measures = population.measures.values();
    let measures = measures.filter_map(|measure| match measure {
        MeasureModel::Drawn(drawn) => Some(&drawn.loadings),
        MeasureModel::Derived(_) => None,
    });
    let loadings = measures.chain([&population.line.loadings]).flatten();
    let there = loadings.filter(|(_, loading)| **loading != 0.0);
    there.map(|(name, _)| *name).collect()
}

/// Where a person's style lies across the line: their traits less what of them lies along it. The traits that people drive by are
/// independent, so that a distance counts in standard deviations over people.
pub(crate) fn across(population: &PopulationModel, person: &Participant) -> Vec<f64> {
    let traits = style_traits(population);
    let line = &population.line.loadings;
    let along = |name: &Trait| line.get(name).copied().unwrap_or(0.0);
    let square: f64 = traits.iter().map(|name| along(name).powi(2)).sum();
    let place = traits.iter().map(|t| along(t) * person.latent(*t));
    let place: f64 = place.sum();
    // Without effects nothing lies along the line.
    let share = if square > 0.0 { place / square } else { 0.0 };
    let across = traits.iter().map(|t| person.latent(*t) - share * along(t));
    across.collect()
}

/// Refuses a study of so few that nearly everybody would meet the same donor.
pub(crate) fn enough(condition: ConditionId, people: usize) -> Result<(), RehearsalError> {
    let donors = people.saturating_sub(1);
    if donors < FEWEST_DONORS {
        return Err(RehearsalError::FewDonors { condition, people, donors });
    }
    Ok(())
}

/// A donor for each person of a study among all the others, by the rule of a run: as evenly as can be, by the seed.
pub(crate) fn lend<'a>(
    (condition, matched): (ConditionId, Matched),
    places: &[Place<'a>],
    seed: u64,
) -> Result<Vec<Loan<'a>>, RehearsalError> {
    enough(condition, places.len())?;
    // Places are in points of the ADB's scale.
    let reach = Reach::on(ScoreRange::ADB, matched.apart_sd);
    let mut lent = vec![0; places.len()];
    let mut loans = Vec::new();
    for (at, rider) in places.iter().enumerate() {
        let others: Vec<usize> = (0..places.len()).filter(|other| *other != at).collect();
        let offers = others.iter().map(|o| rider.offer(&places[*o], lent[*o]));
        let offers: Vec<Offer> = offers.collect();
        let among = Offer::drawn_among(&offers, reach);
        let labels = [rider.person.id.as_str(), "donor", condition.as_str()];
        let mut rng = Pcg64::seed_from_u64(stream_seed(seed, &labels));
        let drawn = among[rng.random_range(0..among.len())];
        lent[others[drawn]] += 1;
        loans.push(Loan {
            donor: places[others[drawn]].person,
            offer: offers[drawn],
            within_reach: offers[drawn].within(reach),
        });
    }
    Ok(loans)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::design;
    use maveric_domain::design::Donors;
    use maveric_participants::{Cohort, CohortSettings};
    use std::collections::BTreeMap;

    const MATCHED: Matched = Matched { from: Donors::Tested, apart_sd: [0.7, 2.5] };

    fn people(n: usize) -> Vec<Participant> {
        Cohort::draw(0, n, 3, &CohortSettings::default(), &design()).unwrap().participants
    }

    /// These places on the line and across it, of as many people.
    fn placed<'a>(people: &'a [Participant], at: &[(f64, f64)]) -> Vec<Place<'a>> {
        let place = |(person, (line, across)): (&'a Participant, &(f64, f64))| Place {
            person,
            line_points: *line,
            across: vec![*across, 0.0],
        };
        people.iter().zip(at).map(place).collect()
    }

    fn lent<'a>(places: &[Place<'a>], seed: u64) -> Vec<Loan<'a>> {
        lend(("other".parse().unwrap(), MATCHED), places, seed).unwrap()
    }

    #[test]
    fn a_donor_within_reach_is_drawn_as_evenly_as_can_be_and_nobody_lends_to_themselves() {
        let people = people(8);
        // Everybody is 2 points and 1 SD or more from everybody of the other four.
        let at: Vec<(f64, f64)> =
            (0..8).map(|i| (f64::from(i % 2) * 2.0, f64::from(i / 4))).collect();
        let places = placed(&people, &at);
        let loans = lent(&places, 5);
        let mut times = BTreeMap::new();
        for (at, loan) in loans.iter().enumerate() {
            let donor = people.iter().position(|p| p.id == loan.donor.id).unwrap();
            assert!(donor / 4 != at / 4, "{at} from {donor}");
            assert!(loan.within_reach && (loan.offer.distance_sd - 1.0).abs() < 1e-12);
            let line = |at: usize| places[at].line_points;
            assert!((loan.offer.shift_points - (line(at) - line(donor))).abs() < 1e-12);
            *times.entry(donor).or_insert(0) += 1;
        }
        assert_eq!(times.len(), 8, "each of eight once: {times:?}");
        let donors = |seed| {
            let of = lent(&places, seed);
            of.iter().map(|l| l.donor.id.clone()).collect::<Vec<_>>()
        };
        assert_eq!(donors(5), donors(5));
        assert!((6..12).any(|seed| donors(seed) != donors(5)));
    }

    #[test]
    fn where_nobody_is_within_reach_the_nearest_lends_and_is_marked() {
        let people = people(6);
        // The last is 20 points from the next one, whoever was lent how often.
        let at = [(0.0, 0.0), (1.0, 1.0), (2.0, 0.0), (3.0, 1.0), (4.0, 0.0), (24.0, 1.0)];
        let places = placed(&people, &at);
        let loans = lent(&places, 1);
        assert_eq!(loans[5].donor.id, people[4].id);
        assert!(!loans[5].within_reach && loans[..5].iter().all(|loan| loan.within_reach));
    }

    #[test]
    fn fewer_than_five_donors_are_refused() {
        let people = people(6);
        let places = placed(&people, &[(0.0, 0.0); 6]);
        let condition: ConditionId = "other".parse().unwrap();
        let refused = lend((condition, MATCHED), &places[..5], 1).unwrap_err();
        assert_eq!(
            refused.to_string(),
            "`condition.other.car` lends somebody else's style: a study of 5 has 4 who could lend theirs, expected 5 or more"
        );
        assert!(lend((condition, MATCHED), &places, 1).is_ok());
    }
}
