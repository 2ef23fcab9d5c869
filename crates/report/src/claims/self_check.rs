//! Whether the paper's numbers agree with each other.

use super::load::{Claim, Quantity};
use super::recheck::{Recheck, recheck};

/// What a number's own surroundings say of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SelfCheck {
    /// A p against its coefficient and degrees of freedom.
    Correlation(Recheck),
    /// A share, or a mean of whole numbers, against the number of people that it is over.
    People {
        /// How many people.
        of: u32,
        /// The share (percent) or mean nearest to the printed one that so many people can have.
        nearest: f64,
        /// Whether it is printed as the nearest one rounds.
        fits: bool,
    },
    /// A total against its parts.
    Sum {
        /// What the parts add up to.
        sum: f64,
        /// Whether that is the printed number.
        fits: bool,
    },
}

impl SelfCheck {
    /// Whether the paper's numbers agree.
    pub fn agrees(&self) -> bool {
        match self {
            Self::Correlation(result) => result.follows,
            Self::People { fits, .. } | Self::Sum { fits, .. } => *fits,
        }
    }
}

/// Checks a claim against the paper's own figures: its p ([`recheck`]), the people that it is over, or its parts.
/// `None` where there is nothing to check it against.
pub fn self_check(claim: &Claim, all: &[Claim]) -> Option<SelfCheck> {
    if let Some(result) = recheck(claim) {
        return Some(SelfCheck::Correlation(result));
    }
    let printed = claim.printed.value;
    if let Some(of) = claim.of {
        let people = f64::from(of);
        let scale = match claim.quantity {
            Quantity::Percent => 100.0,
            _ => 1.0,
        };
        let nearest = scale * (printed * people / scale).round() / people;
        let half = 0.5 * 0.1_f64.powi(i32::try_from(claim.printed.decimals()).ok()?);
        let fits = (nearest - printed).abs() <= half + 1e-9;
        return Some(SelfCheck::People { of, nearest, fits });
    }
    if claim.sum_of.is_empty() {
        return None;
    }
    let part = |id: &String| Some(all.iter().find(|c| c.id == *id)?.printed.value);
    let parts: Option<Vec<f64>> = claim.sum_of.iter().map(part).collect();
    let sum: f64 = parts?.iter().sum();
    Some(SelfCheck::Sum { sum, fits: (sum - printed).abs() < 1e-9 })
}

#[cfg(test)]
mod tests {
    use super::super::load::load;
    use super::*;

    const CLAIMS: &str = maveric_data::CLAIMS;

    fn one(id: &str) -> SelfCheck {
        let claims = load(CLAIMS).unwrap();
        let claim = claims.iter().find(|c| c.id == id).unwrap();
        self_check(claim, &claims).unwrap()
    }

    #[test]
    fn no_number_of_women_among_twelve_gives_the_printed_share() {
        let SelfCheck::People { of, nearest, fits } = one("study2-internal-female") else {
            panic!("a share of people");
        };
        assert_eq!(of, 12);
        assert!((nearest - 100.0 / 3.0).abs() < 1e-9 && !fits);
        assert!(one("study2-external-female").agrees());
    }

    #[test]
    fn the_mean_ages_can_be_means_of_whole_years() {
        for id in ["study1-age", "study2-internal-age", "study2-external-age"] {
            assert!(one(id).agrees(), "{id}");
        }
    }

    #[test]
    fn the_participants_add_up() {
        let found = one("n-total");
        assert!(matches!(found, SelfCheck::Sum { sum, fits: true } if (sum - 54.0).abs() < 1e-9));
    }
}
