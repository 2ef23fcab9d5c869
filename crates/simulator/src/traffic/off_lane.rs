//! Single vehicles of the passing lane, all faster than ego.

use super::{Arrival, Car, EgoView, Role};
use crate::scenario::OffLaneSettings;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// When and how the next off-lane vehicle comes.
#[derive(Debug, Clone)]
pub(crate) struct OffLaneTraffic {
    settings: OffLaneSettings,
    rng: Pcg64Mcg,
    next_s: f64,
}

/// Distance between the place of arrival and any other vehicle there, in m.
const ROOM_M: f64 = 40.0;

impl OffLaneTraffic {
    pub(crate) fn new(settings: &OffLaneSettings, seed: u64) -> Self {
        let mut traffic = Self {
            settings: settings.clone(),
            rng: Pcg64Mcg::seed_from_u64(seed),
            next_s: 0.0,
        };
        traffic.next_s = traffic.interval_s();
        traffic
    }

    fn between(&mut self, [low, high]: [f64; 2]) -> f64 {
        low + (high - low) * self.rng.random::<f64>()
    }

    fn interval_s(&mut self) -> f64 {
        self.between(self.settings.interval_s)
    }

    /// Nobody comes before `time_s`.
    pub(crate) fn quiet_until(&mut self, time_s: f64) {
        self.next_s = self.next_s.max(time_s);
    }

    /// The next vehicle, if it is due, ego is in lane 0 and there is room.
    ///
    /// # Source
    /// Calibration section 1.
    pub(crate) fn next(&mut self, cars: &[Car], ego: &EgoView, time_s: f64) -> Option<Arrival> {
        if time_s < self.next_s || ego.lane != 0 || !ego.keeping {
            return None;
        }
        let lane = 1;
        let s = &self.settings;
        let (ahead_m, behind_m) = (s.appears_ahead_m, s.appears_behind_m);
        let (faster, factor) = (s.faster_mps, s.ahead_factor);
        let from_behind = self.rng.random::<f64>() < s.share_from_behind;
        let (x_m, speed_mps) = if from_behind {
            (ego.x_m - behind_m, ego.target_mps + self.between(faster))
        } else {
            (ego.x_m + ahead_m, ego.target_mps * self.between(factor))
        };
        let taken = cars
            .iter()
            .any(|car| car.lane == lane && (car.state.x_m - x_m).abs() < ROOM_M);
        if taken {
            self.next_s = time_s + 1.0;
            return None;
        }
        self.next_s = time_s + self.interval_s();
        Some(Arrival {
            x_m,
            lane,
            speed_mps,
            role: Role::Steady {
                speed_mps,
                passing_by: true,
            },
        })
    }
}
