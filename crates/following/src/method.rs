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
    /// The same with the driver's own time gap and gap at standstill.
    IdmPopulationOwnTimeGapAndStandstill,
    /// IDM moved along the principal directions of the other drivers' own fits.
    IdmPrincipalDirections,
    /// V with the driver's own embedding, through a lag.
    VelocityOwn,
    /// The smaller of V's and F's commands, with the driver's own embedding.
    VelocityAndDistanceOwn,
    /// F with the driver's own embedding.
    FollowingDistanceOwn,
    /// F with the mean embedding: what personalising adds is the difference to it.
    FollowingDistanceMean,
    /// The network trained through its own closed loop, with the driver's own embedding.
    ClosedLoopOwn,
    /// The same network with the mean embedding.
    ClosedLoopMean,
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

impl FollowingMethod {
    /// All methods, in the order of tables.
    pub const ALL: [Self; 18] = [
        Self::ConstantTimeGapOwn,
        Self::ConstantTimeGapPopulation,
        Self::NewellOwn,
        Self::HellyOwn,
        Self::HellyPopulation,
        Self::GippsOwn,
        Self::IdmOwn,
        Self::IdmPopulation,
        Self::IdmPopulationOwnTimeGap,
        Self::IdmPopulationOwnTimeGapAndStandstill,
        Self::IdmPrincipalDirections,
        Self::VelocityOwn,
        Self::VelocityAndDistanceOwn,
        Self::FollowingDistanceOwn,
        Self::FollowingDistanceMean,
        Self::ClosedLoopOwn,
        Self::ClosedLoopMean,
        Self::IdmFloor,
    ];

    /// Word used in files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::ConstantTimeGapOwn => "constant_time_gap_own",
            Self::ConstantTimeGapPopulation => "constant_time_gap_population",
            Self::NewellOwn => "newell_own",
            Self::HellyOwn => "helly_own",
            Self::HellyPopulation => "helly_population",
            Self::GippsOwn => "gipps_own",
            Self::IdmOwn => "idm_own",
            Self::IdmPopulation => "idm_population",
            Self::IdmPopulationOwnTimeGap => "idm_population_own_time_gap",
            Self::IdmPopulationOwnTimeGapAndStandstill => {
                "idm_population_own_time_gap_and_standstill"
            }
            Self::IdmPrincipalDirections => "idm_principal_directions",
            Self::VelocityOwn => "velocity_own",
            Self::VelocityAndDistanceOwn => "velocity_and_distance_own",
            Self::FollowingDistanceOwn => "following_distance_own",
            Self::FollowingDistanceMean => "following_distance_mean",
            Self::ClosedLoopOwn => "closed_loop_own",
            Self::ClosedLoopMean => "closed_loop_mean",
            Self::IdmFloor => "idm_floor",
        }
    }

    /// What the method knows of people before the test.
    pub fn knows(self) -> Knows {
        match self {
            Self::ConstantTimeGapPopulation
            | Self::HellyPopulation
            | Self::IdmPopulation
            | Self::FollowingDistanceMean
            | Self::ClosedLoopMean => Knows::Population,
            Self::IdmFloor => Knows::Test,
            _ => Knows::Driver,
        }
    }

    /// A few words for a person to read.
    pub fn label(self) -> &'static str {
        match self {
            Self::ConstantTimeGapOwn => "constant time gap, own mean",
            Self::ConstantTimeGapPopulation => "constant time gap, population mean",
            Self::NewellOwn => "Newell, own",
            Self::HellyOwn => "Helly, own",
            Self::HellyPopulation => "Helly, population",
            Self::GippsOwn => "Gipps, own",
            Self::IdmOwn => "IDM, own",
            Self::IdmPopulation => "IDM, population",
            Self::IdmPopulationOwnTimeGap => "IDM, population and own time gap",
            Self::IdmPopulationOwnTimeGapAndStandstill => {
                "IDM, population and own time gap, standstill"
            }
            Self::IdmPrincipalDirections => "IDM, others' principal directions",
            Self::VelocityOwn => "V alone, own embedding",
            Self::VelocityAndDistanceOwn => "V and F, smaller command, own embedding",
            Self::FollowingDistanceOwn => "F, own embedding",
            Self::FollowingDistanceMean => "F, mean embedding",
            Self::ClosedLoopOwn => "network in closed loop, own embedding",
            Self::ClosedLoopMean => "network in closed loop, mean embedding",
            Self::IdmFloor => "floor: IDM fitted to the test rows",
        }
    }
}

impl fmt::Display for FollowingMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}
