//! Which cars cannot be rehearsed, and why.

use maveric_domain::design::Car;
use std::fmt;

/// What is not known of a car before the first person comes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnknownCar {
    /// What one that was recorded elsewhere does.
    Recorded,
    /// Where a style of a file lies among made-up people.
    Given,
    /// What a drive shown again shows, moment by moment.
    Replayed,
    /// How people turn the dial.
    Turned,
}

impl UnknownCar {
    /// What is not known of a condition's car; none where its drives can be made up.
    pub fn of(car: Option<&Car>) -> Option<Self> {
        match car {
            None => Some(Self::Recorded),
            Some(Car::Dial(_) | Car::Across | Car::Mean | Car::Matched(_)) => None,
            Some(Car::Embedding(_)) => Some(Self::Given),
            Some(Car::Replay) => Some(Self::Replayed),
            Some(_) => Some(Self::Turned),
        }
    }
}

impl fmt::Display for UnknownCar {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Recorded => "what a car that was recorded elsewhere does is not known beforehand",
            Self::Given => {
                "a style of a file is a point of a trained model, which made-up people do not have"
            }
            Self::Replayed => {
                "a replay shows a drive moment by moment, and made-up people have measures of theirs alone"
            }
            Self::Turned => "how people turn the dial while they ride is not known beforehand",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_domain::design::{Donors, Matched};

    #[test]
    fn a_car_is_known_where_it_drives_a_style_that_made_up_people_have() {
        let matched = Matched { from: Donors::Learned, apart_sd: [0.7, 2.5] };
        for car in [Car::Dial(-15.0), Car::Across, Car::Mean, Car::Matched(matched)] {
            assert_eq!(UnknownCar::of(Some(&car)), None, "{car:?}");
        }
        for (car, why, says) in [
            (None, UnknownCar::Recorded, "recorded elsewhere"),
            (Some(Car::Embedding("styles.csv".into())), UnknownCar::Given, "a trained model"),
            (Some(Car::Replay), UnknownCar::Replayed, "moment by moment"),
            (Some(Car::Free), UnknownCar::Turned, "turn the dial"),
        ] {
            assert_eq!(UnknownCar::of(car.as_ref()), Some(why));
            assert!(why.to_string().contains(says), "{why}");
        }
    }
}
