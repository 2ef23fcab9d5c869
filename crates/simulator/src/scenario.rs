//! Every number of the world a user may change, checked once.

mod background;
mod controllers;
#[cfg(test)]
mod page;
mod placement;
mod road;
pub(crate) mod setting;
mod traffic;
mod vehicle;

use crate::{drivers::Population, error::SimulatorError, road::CentreLine};
pub use background::{BackgroundSettings, WaveSettings};
pub use controllers::{ChangeRule, ControllerSettings, FollowingRule};
use maveric_domain::{MetresPerSecond, Road};
pub use placement::{ScriptStep, VehiclePlacement};
pub use road::{RoadSettings, StartSettings};
use serde::{Deserialize, Serialize};
use setting::{check_section, settings};
pub use traffic::{BlockedSettings, LeadSettings, OffLaneSettings};
pub use vehicle::{DynamicsSettings, Integrator, VehicleModel, VehicleSettings};

settings! {
    /// A scenario as its file has it; [`Scenario`] is the checked form.
    pub struct ScenarioSettings {
        /// Length of the drive.
        duration_s: f64 = 600.0, 1.0..=86_400.0;
        /// The road.
        road: RoadSettings = RoadSettings::default();
        /// Ego's car.
        vehicle: VehicleSettings = VehicleSettings::default();
        /// How ego starts.
        start: StartSettings = StartSettings::default();
        /// The six lead vehicles.
        leads: LeadSettings = LeadSettings::default();
        /// Encounters in which the passing lane is taken.
        blocked: BlockedSettings = BlockedSettings::default();
        /// Other vehicles of the passing lane.
        off_lane: OffLaneSettings = OffLaneSettings::default();
        /// The automated car's controllers.
        controllers: ControllerSettings = ControllerSettings::default();
        /// The population of synthetic drivers.
        drivers: Population = Population::default();
        /// Further vehicles, there from the start, each keeping its speed and lane but for its script.
        vehicles: Vec<VehiclePlacement> = Vec::new();
        /// Background traffic in place of leads and off-lane vehicles.
        #[serde(skip_serializing_if = "Option::is_none")]
        background: Option<BackgroundSettings> = None;
    }
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
        let mut settings = ScenarioSettings::default();
        settings.vehicle.integrator = Integrator::InTurn;
        Self { settings, centre_line: CentreLine::default() }
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
        check_section("", &settings)?;
        settings.vehicle.check_all()?;
        let start = settings.start.lane;
        settings.road.check_lane("start.lane", start)?;
        placement::check_placed(&settings)?;
        if let Some(background) = &settings.background {
            background.check_beside(&settings)?;
        }
        let centre_line = CentreLine::new(&settings.road.segments);
        Ok(Self { settings, centre_line })
    }
}

impl From<Scenario> for ScenarioSettings {
    fn from(scenario: Scenario) -> Self {
        scenario.settings
    }
}

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
