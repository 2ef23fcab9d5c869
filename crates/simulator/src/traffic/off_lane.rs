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
        let mut traffic =
            Self { settings: settings.clone(), rng: Pcg64Mcg::seed_from_u64(seed), next_s: 0.0 };
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
        let taken = cars.iter().any(|car| car.lane == lane && (car.state.x_m - x_m).abs() < ROOM_M);
        if taken {
            self.next_s = time_s + 1.0;
            return None;
        }
        self.next_s = time_s + self.interval_s();
        Some(Arrival { x_m, lane, speed_mps, role: Role::Steady { speed_mps, passing_by: true } })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{car, seen_ego};

    fn come(ego: &EgoView, cars: &[Car]) -> Vec<(u32, Arrival)> {
        let mut traffic = OffLaneTraffic::new(&OffLaneSettings::default(), 3);
        let at = |second: u32| Some((second, traffic.next(cars, ego, f64::from(second))?));
        (0..6000).filter_map(at).collect()
    }

    #[test]
    fn somebody_faster_comes_from_either_end_every_minute_or_so() {
        let found = come(&seen_ego(), &[]);
        let times: Vec<u32> = found.iter().map(|f| f.0).collect();
        assert!(times[0] >= 45 && times[0] <= 76);
        // Asked once a second, so up to one more than 75 s.
        assert!(times.windows(2).all(|w| (45..=76).contains(&(w[1] - w[0]))));
        let (behind, ahead): (Vec<_>, Vec<_>) = found.iter().partition(|(_, a)| a.x_m < 0.0);
        let share = behind.len() as f64 / found.len() as f64;
        assert!((0.4..0.8).contains(&share), "{share}");
        let within = |(_, a): &(u32, Arrival), x_m: f64, [low, high]: [f64; 2]| {
            (a.x_m - x_m).abs() < 1e-12 && (low..=high).contains(&a.speed_mps) && a.lane == 1
        };
        assert!(behind.iter().all(|f| within(f, -180.0, [31.5, 35.5])));
        assert!(ahead.iter().all(|f| within(f, 190.0, [31.8, 36.0])));
    }

    #[test]
    fn nobody_comes_while_ego_is_elsewhere_or_where_somebody_is() {
        let left = EgoView { lane: 1, ..seen_ego() };
        let changing = EgoView { keeping: false, ..seen_ego() };
        assert!(come(&left, &[]).is_empty() && come(&changing, &[]).is_empty());
        let role = Role::Steady { speed_mps: 30.0, passing_by: false };
        let at = |x_m: f64, lane| {
            let mut car = car(1, 1.0, lane, 30.0, role);
            car.state.x_m = x_m;
            car
        };
        let from = |cars: &[Car]| {
            let found = come(&seen_ego(), cars);
            let behind = found.iter().filter(|(_, a)| a.x_m < 0.0).count();
            (behind > 0, found.len() > behind)
        };
        assert_eq!(from(&[at(-140.1, 1), at(190.0, 0)]), (false, true));
        assert_eq!(from(&[at(-139.9, 1), at(150.1, 1)]), (true, false));
    }
}
