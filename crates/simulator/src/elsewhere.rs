//! Traffic that somebody else moves: another simulator, a replayed recording.

use maveric_domain::{DomainError, ObjectTrack, VehicleId, VehicleState};
use std::collections::BTreeMap;

/// Who is around, as told from outside.
#[derive(Debug, Clone, Default)]
pub(crate) struct Elsewhere {
    /// At the row to be recorded next.
    pub(crate) states: Vec<VehicleState>,
    /// The track of everybody who was there at the last row.
    open: BTreeMap<VehicleId, usize>,
}

impl Elsewhere {
    /// Takes who is around at the next row.
    ///
    /// # Errors
    /// [`DomainError`] for a number that is not finite, a length that is not above 0, or a vehicle that is there twice.
    pub(crate) fn tell(
        &mut self,
        vehicles: &[VehicleState],
        row: usize,
    ) -> Result<(), DomainError> {
        for (i, vehicle) in vehicles.iter().enumerate() {
            for (column, found) in [
                ("vehicle.x_m", vehicle.x_m),
                ("vehicle.y_m", vehicle.y_m),
                ("vehicle.speed_mps", vehicle.speed_mps),
                ("vehicle.length_m", vehicle.length_m),
            ] {
                if !found.is_finite() {
                    return Err(DomainError::NotFinite { column, row, found });
                }
            }
            if vehicle.length_m <= 0.0 {
                return Err(DomainError::OutOfRange {
                    name: "vehicle.length_m",
                    found: vehicle.length_m,
                    expected: "above 0",
                });
            }
            if vehicles[..i].iter().any(|other| other.id == vehicle.id) {
                return Err(DomainError::OutOfRange {
                    name: "vehicle.id",
                    found: f64::from(vehicle.id.0),
                    expected: "each vehicle once",
                });
            }
        }
        self.states = vehicles.to_vec();
        Ok(())
    }

    /// Writes everybody down as `row`; who was away begins a new track.
    pub(crate) fn record(&mut self, row: usize, tracks: &mut Vec<ObjectTrack>) {
        let mut open = BTreeMap::new();
        for vehicle in &self.states {
            let known = self.open.get(&vehicle.id).copied();
            let index = known.unwrap_or_else(|| {
                tracks.push(ObjectTrack::new(vehicle.id, vehicle.length_m, row));
                tracks.len() - 1
            });
            tracks[index].push(vehicle);
            open.insert(vehicle.id, index);
        }
        self.open = open;
    }
}

#[cfg(test)]
mod tests {
    use crate::{Driver, Scenario, Session, SimulatorError, View};
    use maveric_domain::{LaneWish, Seconds, Setpoints, VehicleId, VehicleState};
    use std::error::Error as _;

    fn vehicle(id: u32, x_m: f64) -> VehicleState {
        VehicleState { id: VehicleId(id), x_m, y_m: 0.0, speed_mps: 20.0, length_m: 4.7 }
    }

    #[test]
    fn the_car_follows_whoever_it_is_told_of_and_the_recording_has_them() {
        let scenario = Scenario::paper().with_duration(Seconds(60.0)).unwrap();
        let controllers = scenario.settings().controllers.clone();
        let mut planner = |view: &View<'_>| Setpoints {
            speed_mps: 30.0,
            following_distance_m: 1.5 * view.scene.ego.speed_mps,
            wish: LaneWish::Stay,
        };
        let driver = Driver::Automated(&mut planner, &controllers);
        let mut session = Session::among_others(&scenario, driver).unwrap();
        let mut row = 0;
        loop {
            // One car at 20 m/s, and for a while another far behind.
            let ahead = vehicle(7, 80.0 + f64::from(row));
            let behind = vehicle(9, session.ego().x_m - 90.0);
            let both = [ahead, behind];
            let around =
                if (100..200).contains(&row) || row > 400 { &both[..] } else { &both[..1] };
            session.meet(around).unwrap();
            if !session.step() {
                break;
            }
            row += 1;
        }
        let driven = session.finish().unwrap();
        assert_eq!((driven.report.collisions, driven.report.leads), (0, 0));
        let last = *driven.recording.ego().speed_mps.last().unwrap();
        assert!((last - 20.0).abs() < 0.2, "{last}");
        let tracks: Vec<(u32, usize, usize)> =
            driven.recording.others().iter().map(|t| (t.id.0, t.first_row, t.x_m.len())).collect();
        assert_eq!(tracks, [(7, 0, 1200), (9, 100, 100), (9, 401, 799)]);
    }

    #[test]
    fn who_is_told_of_twice_or_without_a_place_is_refused() {
        let scenario = Scenario::paper();
        let controllers = scenario.settings().controllers.clone();
        let mut planner = |_: &View<'_>| Setpoints {
            speed_mps: 30.0,
            following_distance_m: 30.0,
            wish: LaneWish::Stay,
        };
        let driver = Driver::Automated(&mut planner, &controllers);
        let mut session = Session::among_others(&scenario, driver).unwrap();
        let error = session.meet(&[vehicle(1, 50.0), vehicle(1, 90.0)]).unwrap_err();
        let why = |error: &SimulatorError| error.source().unwrap().to_string();
        assert!(why(&error).contains("each vehicle once"), "{error:?}");
        let error = session.meet(&[vehicle(1, f64::NAN)]).unwrap_err();
        assert!(why(&error).contains("vehicle.x_m"), "{error:?}");
    }
}
