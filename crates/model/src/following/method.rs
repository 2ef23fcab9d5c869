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
    /// Helly's law fitted to the other drivers; its gains also steer by F.
    HellyPopulation,
    /// IDM fitted to the driver's own fit rows.
    IdmOwn,
    /// IDM fitted to the other drivers.
    IdmPopulation,
    /// The same with the driver's own time gap.
    IdmPopulationOwnTimeGap,
    /// F with the driver's own embedding.
    FollowingDistanceOwn,
    /// F with the mean embedding: what personalising adds is the difference to it.
    FollowingDistanceMean,
    /// IDM fitted to the test rows themselves: about what it can do at all, and no prediction.
    IdmFloor,
}

impl FollowingMethod {
    /// All methods, in the order of tables.
    pub const ALL: [Self; 8] = [
        Self::ConstantTimeGapOwn,
        Self::HellyPopulation,
        Self::IdmOwn,
        Self::IdmPopulation,
        Self::IdmPopulationOwnTimeGap,
        Self::FollowingDistanceOwn,
        Self::FollowingDistanceMean,
        Self::IdmFloor,
    ];

    /// Word used in files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::ConstantTimeGapOwn => "constant_time_gap_own",
            Self::HellyPopulation => "helly_population",
            Self::IdmOwn => "idm_own",
            Self::IdmPopulation => "idm_population",
            Self::IdmPopulationOwnTimeGap => "idm_population_own_time_gap",
            Self::FollowingDistanceOwn => "following_distance_own",
            Self::FollowingDistanceMean => "following_distance_mean",
            Self::IdmFloor => "idm_floor",
        }
    }

    /// A few words for a person to read.
    pub fn label(self) -> &'static str {
        match self {
            Self::ConstantTimeGapOwn => "constant time gap, own mean",
            Self::HellyPopulation => "Helly, population",
            Self::IdmOwn => "IDM, own",
            Self::IdmPopulation => "IDM, population",
            Self::IdmPopulationOwnTimeGap => "IDM, population and own time gap",
            Self::FollowingDistanceOwn => "F, own embedding",
            Self::FollowingDistanceMean => "F, mean embedding",
            Self::IdmFloor => "floor: IDM fitted to the test rows",
        }
    }
}

impl fmt::Display for FollowingMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}
