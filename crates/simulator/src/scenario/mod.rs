//! Every number of the world a user may change, checked once.

mod background;
mod check;
mod controllers;
mod placement;
mod road;
mod traffic;
mod vehicle;

use crate::{drivers::Population, error::SimulatorError, road::CentreLine};
pub use background::{BackgroundSettings, WaveSettings};
use check::{Range, check};
pub use controllers::{ChangeRule, ControllerSettings, FollowingRule};
use maveric_domain::{MetresPerSecond, Road};
pub use placement::{ScriptStep, VehiclePlacement};
pub use road::{RoadSettings, StartSettings};
use serde::{Deserialize, Serialize};
pub use traffic::{BlockedSettings, LeadSettings, OffLaneSettings};
pub use vehicle::{DynamicsSettings, Integrator, VehicleModel, VehicleSettings};

/// A scenario as its file has it; [`Scenario`] is the checked form.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScenarioSettings {
    /// Length of the drive, in s.
    pub duration_s: f64,
    /// The road.
    pub road: RoadSettings,
    /// Ego's car.
    pub vehicle: VehicleSettings,
    /// How ego starts.
    pub start: StartSettings,
    /// The six lead vehicles.
    pub leads: LeadSettings,
    /// Encounters in which the passing lane is taken; those of the paper's scenario without.
    #[serde(default = "usual_blocked")]
    pub blocked: BlockedSettings,
    /// Other vehicles of the passing lane; those of the paper's scenario without.
    #[serde(default = "usual_off_lane")]
    pub off_lane: OffLaneSettings,
    /// The automated car's controllers; those of the paper's scenario without.
    #[serde(default = "usual_controllers")]
    pub controllers: ControllerSettings,
    /// The population of synthetic drivers; that of the paper's scenario without.
    #[serde(default = "usual_drivers")]
    pub drivers: Population,
    /// Further vehicles, there from the start, each keeping its speed and lane.
    #[serde(default)]
    pub vehicles: Vec<VehiclePlacement>,
    /// Background traffic in place of leads and off-lane vehicles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub background: Option<BackgroundSettings>,
}

fn usual_blocked() -> BlockedSettings {
    BlockedSettings::PAPER
}

fn usual_off_lane() -> OffLaneSettings {
    OffLaneSettings::PAPER
}

fn usual_controllers() -> ControllerSettings {
    ControllerSettings::PAPER
}

fn usual_drivers() -> Population {
    Population::PAPER
}

/// A checked scenario: the world, the car, its controllers and who may drive it.
///
/// # Example
/// ```
/// # use maveric_simulator::Scenario;
/// let minutes = Scenario::paper().with_duration(maveric_domain::Seconds(120.0))?;
/// assert!((minutes.settings().duration_s - 120.0).abs() < 1e-12);
/// # Ok::<(), maveric_simulator::SimulatorError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ScenarioSettings", into = "ScenarioSettings")]
pub struct Scenario {
    settings: ScenarioSettings,
    centre_line: CentreLine,
}

impl Scenario {
    /// The world of the paper with the numbers of calibration: `study_data/scenarios/paper.toml` in code.
    pub fn paper() -> Self {
        Self {
            settings: ScenarioSettings {
                duration_s: 600.0,
                road: RoadSettings::PAPER,
                vehicle: VehicleSettings::PAPER,
                start: StartSettings::PAPER,
                leads: LeadSettings::paper(),
                blocked: BlockedSettings::PAPER,
                off_lane: OffLaneSettings::PAPER,
                controllers: ControllerSettings::PAPER,
                drivers: Population::PAPER,
                vehicles: Vec::new(),
                background: None,
            },
            centre_line: CentreLine::default(),
        }
    }

    /// The same scenario over another time.
    ///
    /// # Errors
    /// [`SimulatorError::Setting`] outside 1 s to 24 h.
    pub fn with_duration(
        mut self,
        duration: maveric_domain::Seconds,
    ) -> Result<Self, SimulatorError> {
        self.settings.duration_s = duration.0;
        Self::try_from(self.settings)
    }

    /// The numbers.
    pub fn settings(&self) -> &ScenarioSettings {
        &self.settings
    }

    /// The road's course.
    pub fn centre_line(&self) -> &CentreLine {
        &self.centre_line
    }

    /// The road, as recordings have it.
    pub fn road(&self) -> Road {
        let road = &self.settings.road;
        Road {
            lanes: road.lanes,
            lane_width_m: road.lane_width_m,
            posted_speed_mps: MetresPerSecond::from_mph(road.posted_speed_mph).0,
        }
    }
}

impl TryFrom<ScenarioSettings> for Scenario {
    type Error = SimulatorError;
    fn try_from(settings: ScenarioSettings) -> Result<Self, SimulatorError> {
        check(
            "",
            "duration_s",
            settings.duration_s,
            Range::Within(1.0, 86_400.0, "1 to 86400 s"),
        )?;
        settings.road.check()?;
        settings.vehicle.check()?;
        settings.start.check(&settings.road)?;
        settings.leads.check()?;
        settings.blocked.check()?;
        settings.off_lane.check()?;
        settings.controllers.check()?;
        settings.drivers.check()?;
        placement::check_all(
            &settings.vehicles,
            &settings.road,
            &settings.start,
            settings.vehicle.length_m,
        )?;
        if let Some(background) = &settings.background {
            background.check(&settings)?;
        }
        let centre_line = CentreLine::new(&settings.road.segments);
        Ok(Self {
            settings,
            centre_line,
        })
    }
}

impl From<Scenario> for ScenarioSettings {
    fn from(scenario: Scenario) -> Self {
        scenario.settings
    }
}

pub(crate) use check::{Range as SettingRange, check as check_setting};

#[cfg(test)]
mod tests {
    use super::*;

    const PAPER: &str = maveric_data::SCENARIOS_PAPER;

    #[test]
    fn the_file_of_the_paper_says_what_the_code_says() {
        let read: Scenario = toml::from_str(PAPER).unwrap();
        assert_eq!(read, Scenario::paper());
    }

    #[test]
    fn the_code_of_the_paper_passes_its_own_checks() {
        let settings = Scenario::paper().settings().clone();
        assert!(Scenario::try_from(settings).is_ok());
    }

    #[test]
    fn a_misspelt_key_is_an_error_that_names_it() {
        let text = PAPER.replace("slot_spacing_s", "slot_spaceing_s");
        let error = toml::from_str::<Scenario>(&text).unwrap_err();
        assert!(error.to_string().contains("slot_spaceing_s"));
    }

    #[test]
    fn a_number_outside_its_range_is_an_error_that_names_it() {
        for (key, bad) in [
            ("duration_s = 600.0", "duration_s = nan"),
            ("lane_width_m = 3.66", "lane_width_m = 0.0"),
            ("hazard_threshold = 0.4", "hazard_threshold = -1.0"),
            ("braking_limit_mps2 = 8.0", "braking_limit_mps2 = inf"),
        ] {
            assert!(PAPER.contains(key), "{key}");
            let error = toml::from_str::<Scenario>(&PAPER.replacen(key, bad, 1)).unwrap_err();
            let name = key.split(' ').next().unwrap();
            assert!(error.to_string().contains(name), "{error}");
        }
    }
}
