//! What drives in a driver's place.

use serde::{Deserialize, Serialize};

/// IDM in a driver's place: what its numbers are fitted to, in the order of tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum FollowingMethod {
    /// All numbers are fitted to the other people.
    IdmPopulation,
    /// The same with the time gap fitted to the driver's own fit rows.
    IdmPopulationOwnTimeGap,
    /// All numbers are fitted to the driver's own fit rows.
    IdmOwn,
}

use FollowingMethod as M;

impl FollowingMethod {
    /// All methods, in the order of tables.
    pub const ALL: [Self; 3] = [M::IdmPopulation, M::IdmPopulationOwnTimeGap, M::IdmOwn];

    /// What is driven by default: one law for all people, with the person's own time gap.
    pub const DRIVEN_BY_DEFAULT: Self = M::IdmPopulationOwnTimeGap;

    /// Pairs to compare person by person: what knowing the driver adds, and what more than one number adds.
    pub const PAIRS: [(Self, Self); 3] = [
        (M::IdmPopulationOwnTimeGap, M::IdmPopulation),
        (M::IdmOwn, M::IdmPopulation),
        (M::IdmOwn, M::IdmPopulationOwnTimeGap),
    ];

    pub fn as_str(self) -> &'static str {
        match self {
            M::IdmPopulation => "idm_population",
            M::IdmPopulationOwnTimeGap => "idm_population_own_time_gap",
            M::IdmOwn => "idm_own",
        }
    }

    /// A few words for a person to read.
    pub fn label(self) -> &'static str {
        match self {
            M::IdmPopulation => "IDM, population",
            M::IdmPopulationOwnTimeGap => "IDM, population and own time gap",
            M::IdmOwn => "IDM, own",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_str_is_the_word_in_files() {
        for method in M::ALL {
            let word = serde_json::to_value(method).unwrap();
            assert_eq!(word, method.as_str());
        }
    }
}
