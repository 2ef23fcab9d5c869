//! One driver behind one leader, evenly sampled.

use crate::error::FollowingError;
use maveric_domain::Drive;
use std::ops::Range;

/// Fewest rows that split into two parts of at least two.
const MIN_ROWS: usize = 4;
/// How far a step of time may be from one over the rate, as a share of it.
const TIME_TOLERANCE: f64 = 0.05;

/// What a following run is made of; every column has shape `(n,)`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FollowingColumns {
    /// Time of each row, in s, one sampling step apart.
    pub time_s: Vec<f64>,
    /// Position of the leader along the road, in m. Only its changes are used, so any point of the vehicle will do.
    pub leader_x_m: Vec<f64>,
    /// Speed of the leader, in m/s.
    pub lead_speed_mps: Vec<f64>,
    /// Speed of ego, in m/s.
    pub ego_speed_mps: Vec<f64>,
    /// Gap from bumper to bumper, in m, above 0.
    pub gap_m: Vec<f64>,
}

/// One driver behind one leader, evenly sampled: the first ⌊2n/3⌋ rows to fit, the rest to test.
#[derive(Debug, Clone, PartialEq)]
pub struct FollowingRun {
    driver: String,
    person: String,
    rate_hz: f64,
    columns: FollowingColumns,
}

/// Rows of a run: what a law is fitted to or tried on.
#[derive(Debug, Clone)]
pub struct Stretch<'a> {
    pub(super) run: &'a FollowingRun,
    pub(super) rows: Range<usize>,
}

impl FollowingRun {
    /// Takes the columns of a run sampled `rate_hz` times a second; `driver` names it in results and errors, and who drove.
    ///
    /// # Errors
    /// [`FollowingError::TooShort`] below four rows; [`FollowingError::BadRate`], [`FollowingError::LengthMismatch`],
    /// [`FollowingError::BadValue`] (a number that is not finite, a gap that is not above 0) or
    /// [`FollowingError::UnevenTime`] where a column is not as described.
    pub fn new(
        driver: impl Into<String>,
        rate_hz: f64,
        columns: FollowingColumns,
    ) -> Result<Self, FollowingError> {
        let driver: String = driver.into();
        let run = Self { person: driver.clone(), driver, rate_hz, columns };
        run.check()?;
        Ok(run)
    }

    /// The same run as one of this person's, who may have several.
    #[must_use]
    pub fn of_person(mut self, person: impl Into<String>) -> Self {
        self.person = person.into();
        self
    }

    /// Reads a drive that follows one leader throughout; the leader's position is `ego_x_m` + `lead_dx_m`.
    ///
    /// # Errors
    /// [`FollowingError::NoLead`] if a row has no reference vehicle, [`FollowingError::LeaderChanged`] if it is
    /// not the same one throughout, and those of [`FollowingRun::new`]: a gap of 0 or below, or a hole in time.
    ///
    /// # Source
    /// The leader's position is integrated, not the difference of speeds: in recordings the two do not quite agree.
    pub fn from_drive(drive: &Drive) -> Result<Self, FollowingError> {
        let rows = drive.rows();
        let driver = drive.meta().drive.to_string();
        if let Some(row) = rows.lead_present.iter().position(|present| !present) {
            let missing = rows.lead_present.iter().filter(|present| !**present);
            return Err(FollowingError::NoLead {
                driver,
                row,
                missing: missing.count(),
                rows: drive.len(),
            });
        }
        if let Some(before) = rows.lead_id.windows(2).position(|w| w[0] != w[1]) {
            let row = before + 1;
            return Err(FollowingError::LeaderChanged { driver, row });
        }
        let leader = |(x, dx): (&f64, &f64)| x + dx;
        let columns = FollowingColumns {
            time_s: rows.time_s.clone(),
            leader_x_m: rows.ego_x_m.iter().zip(&rows.lead_dx_m).map(leader).collect(),
            lead_speed_mps: rows.lead_speed_mps.clone(),
            ego_speed_mps: rows.ego_speed_mps.clone(),
            gap_m: rows.lead_dx_m.clone(),
        };
        let run = Self::new(driver, drive.rate_hz(), columns)?;
        Ok(run.of_person(drive.meta().participant.to_string()))
    }

    /// Name of the driver, or of the drive.
    pub fn driver(&self) -> &str {
        &self.driver
    }

    pub fn person(&self) -> &str {
        &self.person
    }

    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    pub fn rows(&self) -> usize {
        self.columns.time_s.len()
    }

    /// The recorded columns, checked to be equally long and without gaps in time.
    pub fn columns(&self) -> &FollowingColumns {
        &self.columns
    }

    /// First row of the test part, ⌊2n/3⌋.
    pub fn test_start(&self) -> usize {
        2 * self.rows() / 3
    }

    /// The driver's rows: all that may be read before the test.
    pub fn fit(&self) -> Stretch<'_> {
        let rows = 0..self.test_start();
        Stretch { run: self, rows }
    }

    pub fn test(&self) -> Stretch<'_> {
        let rows = self.test_start()..self.rows();
        Stretch { run: self, rows }
    }

    /// Checks that there are nine rows, so that the fit rows have as many errors of the gap as IDM has numbers, and that ego
    /// exceeds `above_mps` (m/s) in the fit rows.
    pub(crate) fn check_fit(&self, above_mps: f64) -> Result<(), FollowingError> {
        self.at_least(9)?;
        let fit = &self.columns.ego_speed_mps[..self.test_start()];
        if fit.iter().any(|speed| *speed > above_mps) {
            return Ok(());
        }
        Err(FollowingError::NeverMoves { driver: self.driver.clone(), above_mps })
    }

    fn at_least(&self, expected: usize) -> Result<(), FollowingError> {
        if self.rows() >= expected {
            return Ok(());
        }
        Err(FollowingError::TooShort { driver: self.driver.clone(), found: self.rows(), expected })
    }

    fn check(&self) -> Result<(), FollowingError> {
        let driver = || self.driver.clone();
        self.at_least(MIN_ROWS)?;
        let expected = self.rows();
        if !(self.rate_hz.is_finite() && self.rate_hz > 0.0) {
            return Err(FollowingError::BadRate { driver: driver(), found: self.rate_hz });
        }
        let c = &self.columns;
        for (column, values, above_m) in [
            ("time_s", &c.time_s, None),
            ("leader_x_m", &c.leader_x_m, None),
            ("lead_speed_mps", &c.lead_speed_mps, None),
            ("ego_speed_mps", &c.ego_speed_mps, None),
            ("gap_m", &c.gap_m, Some(0.0)),
        ] {
            if values.len() != expected {
                return Err(FollowingError::LengthMismatch {
                    driver: driver(),
                    column,
                    found: values.len(),
                    expected,
                });
            }
            let bad = |v: &f64| !v.is_finite() || above_m.is_some_and(|above| *v <= above);
            if let Some(row) = values.iter().position(bad) {
                return Err(FollowingError::BadValue {
                    driver: driver(),
                    column,
                    row,
                    found: values[row],
                    expected: above_m.map_or("a finite number", |_| "a finite number above 0"),
                });
            }
        }
        let step_s = 1.0 / self.rate_hz;
        let uneven = |w: &[f64]| (w[1] - w[0] - step_s).abs() > TIME_TOLERANCE * step_s;
        match c.time_s.windows(2).position(uneven) {
            Some(before) => Err(FollowingError::UnevenTime {
                driver: driver(),
                row: before + 1,
                found_s: c.time_s[before + 1] - c.time_s[before],
                expected_s: step_s,
            }),
            None => Ok(()),
        }
    }
}

impl Stretch<'_> {
    /// Rows of the run that it covers.
    pub fn rows(&self) -> Range<usize> {
        self.rows.clone()
    }
}

/// The people who drove, each once, in the order of their first drives.
pub(crate) fn people(runs: &[FollowingRun]) -> Vec<&str> {
    each_once(runs.iter().map(FollowingRun::person))
}

/// Names, each once, in the order in which they come first.
pub(crate) fn each_once<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut met: Vec<&str> = Vec::new();
    for name in names {
        if !met.contains(&name) {
            met.push(name);
        }
    }
    met
}

#[cfg(test)]
mod tests {
    use super::{FollowingError as E, *};
    use crate::testing;
    use maveric_domain::{DriveMeta, DrivenBy, EgoTrack, ObjectTrack, Recording, Road, VehicleId};

    fn columns() -> FollowingColumns {
        testing::behind("P01", 10, 20.0, 10.0, |_| 10.0).columns().clone()
    }

    /// 3 s at 10 m/s; the leader, 25 m from centre to centre and 5 m long like ego, leaves at row `leaves`.
    fn drive(leaves: usize) -> Drive {
        let n = 30;
        let x: Vec<f64> = (0..n).map(|i| i as f64).collect();
        let ego =
            EgoTrack { length_m: 5.0, x_m: x.clone(), y_m: vec![0.0; n], speed_mps: vec![10.0; n] };
        let leader = ObjectTrack {
            id: VehicleId(7),
            length_m: 5.0,
            first_row: 0,
            x_m: x[..leaves].iter().map(|x| x + 25.0).collect(),
            y_m: vec![0.0; leaves],
            speed_mps: vec![10.0; leaves],
        };
        let time_s = (0..n).map(|i| i as f64 / 10.0).collect();
        let recording =
            Recording::new(Road::PAPER, 10.0, time_s, vec![0; n], ego, vec![leader]).unwrap();
        let meta = DriveMeta::named("P01-own", "P01", "own", DrivenBy::Human).unwrap();
        Drive::from_recording(meta, &recording).unwrap()
    }

    #[test]
    fn two_thirds_of_the_rows_are_the_drivers() {
        let run = FollowingRun::new("P01", 10.0, columns()).unwrap();
        assert_eq!(run.fit().rows(), 0..6);
        assert_eq!(run.test().rows(), 6..10);
    }

    #[test]
    fn a_drive_gives_the_gap_and_a_leader_ahead_by_it() {
        let run = FollowingRun::from_drive(&drive(30)).unwrap();
        assert_eq!((run.driver(), run.person()), ("P01-own", "P01"));
        assert!((run.columns().gap_m[3] - 20.0).abs() < 1e-12);
        assert!((run.columns().leader_x_m[3] - 23.0).abs() < 1e-12);
    }

    #[test]
    fn rows_without_a_lead_are_an_error_that_says_so() {
        let error = FollowingRun::from_drive(&drive(22)).unwrap_err();
        assert_eq!(
            error.to_string(),
            "drive `P01-own` has no lead vehicle in 8 of 30 rows, first in row 22; \
             cut it to one stretch of following"
        );
    }

    #[test]
    fn check_fit_refuses_few_rows_and_standstill() {
        let mut columns = columns();
        columns.ego_speed_mps[..5].fill(0.5);
        let run = FollowingRun::new("P01", 10.0, columns.clone()).unwrap();
        assert_eq!(run.check_fit(2.0), Ok(()));
        // The test rows move, the fit rows do not.
        columns.ego_speed_mps[5] = 2.0;
        let run = FollowingRun::new("P01", 10.0, columns).unwrap();
        assert!(matches!(run.check_fit(2.0), Err(E::NeverMoves { .. })));
        let eight = testing::behind("P01", 8, 20.0, 10.0, |_| 10.0);
        assert!(matches!(eight.check_fit(2.0), Err(E::TooShort { expected: 9, .. })));
    }

    #[test]
    fn columns_that_are_not_as_described_are_refused() {
        let refused = |change: fn(&mut FollowingColumns)| {
            let mut columns = columns();
            change(&mut columns);
            FollowingRun::new("P01", 10.0, columns).unwrap_err()
        };
        assert!(matches!(refused(|c| c.gap_m[4] = 0.0), E::BadValue { row: 4, .. }));
        assert!(matches!(refused(|c| c.lead_speed_mps[2] = f64::NAN), E::BadValue { row: 2, .. }));
        assert!(matches!(refused(|c| c.time_s[9] = 3.0), E::UnevenTime { row: 9, .. }));
        assert!(matches!(refused(|c| c.gap_m.truncate(9)), E::LengthMismatch { .. }));
        assert!(matches!(refused(|c| *c = FollowingColumns::default()), E::TooShort { .. }));
        assert!(matches!(FollowingRun::new("P01", 0.0, columns()), Err(E::BadRate { .. })));
    }
}
