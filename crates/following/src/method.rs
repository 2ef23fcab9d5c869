//! What drives in a driver's place.

use serde::{Deserialize, Serialize};
use std::fmt;

/// What drives in a driver's place, in the order of tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum FollowingMethod {
    /// The driver's own mean time gap at every speed.
    ConstantTimeGapOwn,
    /// The mean of the other drivers' mean time gaps.
    ConstantTimeGapPopulation,
    /// Newell's delay and distance, fitted to the driver's own fit rows.
    NewellOwn,
    /// Helly's law fitted to the driver's own fit rows.
    HellyOwn,
    /// Helly's law fitted to the other drivers; its gains also steer by F.
    HellyPopulation,
    /// Gipps' law fitted to the driver's own fit rows.
    GippsOwn,
    /// IDM fitted to the driver's own fit rows.
    IdmOwn,
    /// IDM fitted to the other drivers.
    IdmPopulation,
    /// The same with the driver's own time gap.
    IdmPopulationOwnTimeGap,
    /// The same with the own time gap shrunken towards that of the other drivers.
    IdmPopulationShrunkenTimeGap,
    /// The model's following distance with the driver's own embedding.
    FollowingDistanceOwn,
    /// The same with the mean embedding: what personalising adds is the difference to it.
    FollowingDistanceMean,
    /// The network trained through its own closed loop, with the driver's own embedding.
    ClosedLoopOwn,
    /// The same network with the own embedding shrunken towards the mean one.
    ClosedLoopShrunken,
    /// The same network with the mean embedding.
    ClosedLoopMean,
    /// The mean of what that network and IDM ask for, embedding and time gap shrunken alike.
    ClosedLoopAndIdmShrunken,
    /// IDM fitted to the test rows themselves: about what it can do at all, and no prediction.
    IdmFloor,
}

/// What a method knows of people before the test: methods are compared within one kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Knows {
    /// Not this driver's embedding or parameters: the same for everybody.
    Population,
    /// This driver's first two thirds.
    Driver,
    /// The test rows themselves: no prediction.
    Test,
}

use FollowingMethod as M;

impl FollowingMethod {
    /// All methods, in the order of tables, with their words in files and a few for a person to read.
    const TABLE: [(Self, &'static str, &'static str); 17] = [
        (
            M::ConstantTimeGapOwn,
            "constant_time_gap_own",
            "constant time gap, own mean",
        ),
        (
            M::ConstantTimeGapPopulation,
            "constant_time_gap_population",
            "constant time gap, population mean",
        ),
        (M::NewellOwn, "newell_own", "Newell, own"),
        (M::HellyOwn, "helly_own", "Helly, own"),
        (M::HellyPopulation, "helly_population", "Helly, population"),
        (M::GippsOwn, "gipps_own", "Gipps, own"),
        (M::IdmOwn, "idm_own", "IDM, own"),
        (M::IdmPopulation, "idm_population", "IDM, population"),
        (
            M::IdmPopulationOwnTimeGap,
            "idm_population_own_time_gap",
            "IDM, population and own time gap",
        ),
        (
            M::IdmPopulationShrunkenTimeGap,
            "idm_population_shrunken_time_gap",
            "IDM, population and shrunken time gap",
        ),
        (
            M::FollowingDistanceOwn,
            "following_distance_own",
            "F, own embedding",
        ),
        (
            M::FollowingDistanceMean,
            "following_distance_mean",
            "F, mean embedding",
        ),
        (
            M::ClosedLoopOwn,
            "closed_loop_own",
            "network in closed loop, own embedding",
        ),
        (
            M::ClosedLoopShrunken,
            "closed_loop_shrunken",
            "network in closed loop, shrunken embedding",
        ),
        (
            M::ClosedLoopMean,
            "closed_loop_mean",
            "network in closed loop, mean embedding",
        ),
        (
            M::ClosedLoopAndIdmShrunken,
            "closed_loop_and_idm_shrunken",
            "mean of network and IDM, both shrunken",
        ),
        (
            M::IdmFloor,
            "idm_floor",
            "floor: IDM fitted to the test rows",
        ),
    ];

    /// What may be driven by default: see [`ranked`](crate::ranked).
    pub const CANDIDATES: [Self; 6] = [
        M::IdmOwn,
        M::IdmPopulationOwnTimeGap,
        M::IdmPopulationShrunkenTimeGap,
        M::ClosedLoopOwn,
        M::ClosedLoopShrunken,
        M::ClosedLoopAndIdmShrunken,
    ];

    /// What is driven by default: the first of [`ranked`](crate::ranked) over fit rows of `OpenACC` and NGSIM, chosen once.
    pub const DRIVEN_BY_DEFAULT: Self = M::ClosedLoopOwn;

    /// Pairs to compare driver by driver: what personalising adds, and how each stands beside IDM with the own time gap.
    pub const PAIRS: [(Self, Self); 10] = [
        (M::ClosedLoopOwn, M::ClosedLoopMean),
        (M::ClosedLoopShrunken, M::ClosedLoopMean),
        (M::ClosedLoopShrunken, M::ClosedLoopOwn),
        (M::IdmPopulationOwnTimeGap, M::IdmPopulation),
        (M::IdmPopulationShrunkenTimeGap, M::IdmPopulation),
        (M::FollowingDistanceOwn, M::FollowingDistanceMean),
        (M::IdmPopulationShrunkenTimeGap, M::IdmPopulationOwnTimeGap),
        (M::ClosedLoopShrunken, M::IdmPopulationOwnTimeGap),
        (M::ClosedLoopAndIdmShrunken, M::IdmPopulationOwnTimeGap),
        (M::ClosedLoopShrunken, M::IdmOwn),
    ];

    /// All methods, in the order of tables.
    pub fn all() -> impl Iterator<Item = Self> {
        Self::TABLE.iter().map(|row| row.0)
    }

    /// Word used in files.
    pub fn as_str(self) -> &'static str {
        Self::TABLE[self as usize].1
    }

    /// A few words for a person to read.
    pub fn label(self) -> &'static str {
        Self::TABLE[self as usize].2
    }

    /// What the method knows of people before the test.
    pub fn knows(self) -> Knows {
        match self {
            M::ConstantTimeGapPopulation
            | M::HellyPopulation
            | M::IdmPopulation
            | M::FollowingDistanceMean
            | M::ClosedLoopMean => Knows::Population,
            M::IdmFloor => Knows::Test,
            _ => Knows::Driver,
        }
    }
}

impl fmt::Display for FollowingMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_method_stands_in_its_own_row_under_the_word_of_its_file() {
        for method in FollowingMethod::all() {
            assert_eq!(FollowingMethod::TABLE[method as usize].0, method);
            let text = serde_json::to_string(&method).unwrap();
            assert_eq!(text, format!("\"{method}\""));
        }
    }
}
