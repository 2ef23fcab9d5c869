//! What people pressed in the seat's rides, ride by ride, and the moments around it.

use crate::{
    design::DesignFile,
    error::StudyError,
    run_folder::{press_moments_path, presses_path},
    tables::{
        TableName,
        collected::{EVENTS, EventRow, SEAT},
        read_rows, write_rows,
    },
};
use maveric_domain::{
    Drive, DrivenBy, ParticipantId,
    press::{PressMoment, PressedRide},
};
use maveric_measures::press_moments;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

/// What the seat writes of a press.
const PRESSED: &str = "uncomfortable";
/// What it writes where a ride has come to its end.
const ENDED: &str = "ended";

/// The table of events of a study's seat.
pub(crate) fn events_path(study: &DesignFile) -> PathBuf {
    study.resolve(&Path::new(SEAT).join(EVENTS))
}

/// Whether a seat wrote down what was pressed in a study, its paths seen from `root`; the paper's own design has no seat.
pub(crate) fn is_pressed_in_seat(root: &Path, study: &DesignFile) -> bool {
    study.path.is_some() && root.join(events_path(study)).is_file()
}

/// When people pressed: in s since the start of each ride of the seat.
pub(crate) struct Presses(BTreeMap<(ParticipantId, String), Vec<f64>>);

impl Presses {
    /// Those of a study; none where it has no seat. Of a ride that was begun several times that counts which came to its end, else the last.
    ///
    /// # Errors
    /// [`StudyError`] naming the table with row and column for events that cannot be read.
    pub(crate) fn read(study: &DesignFile) -> Result<Option<Self>, StudyError> {
        if !is_pressed_in_seat(Path::new(""), study) {
            return Ok(None);
        }
        let path = events_path(study);
        Ok(Some(Self::from_events(&read_rows(&path)?)))
    }

    fn from_events(events: &[EventRow]) -> Self {
        let of_rides = || events.iter().filter_map(|e| Some((e, e.attempt?)));
        let key = |event: &EventRow| (event.participant.clone(), event.page.clone());
        // Whether an attempt came to its end, and its number.
        let mut counts: BTreeMap<(ParticipantId, String), (bool, u32)> = BTreeMap::new();
        for (event, attempt) in of_rides() {
            let best = counts.entry(key(event)).or_insert((false, attempt));
            *best = (*best).max((event.what == ENDED, attempt));
        }
        let mut presses: BTreeMap<(ParticipantId, String), Vec<f64>> = BTreeMap::new();
        for (event, attempt) in of_rides() {
            let ride = key(event);
            if counts.get(&ride).is_some_and(|(_, counted)| *counted == attempt) {
                let times = presses.entry(ride).or_default();
                times.extend(event.time_s.filter(|_| event.what == PRESSED));
            }
        }
        Self(presses)
    }

    /// The presses of a ride; none for a drive in which nothing could be pressed.
    pub(crate) fn during(&self, drive: &Drive) -> Option<&[f64]> {
        let meta = drive.meta();
        let ridden = meta.driven_by == DrivenBy::Automated;
        let key = (meta.participant.clone(), meta.ride().to_string());
        self.0.get(&key).filter(|_| ridden).map(Vec::as_slice)
    }
}

/// Both tables of what was pressed, as they grow drive by drive.
#[derive(Default)]
pub(crate) struct PressTables {
    rides: Vec<PressedRide>,
    moments: Vec<PressMoment>,
}

impl PressTables {
    /// Adds a ride, in which somebody pressed at these times (s since its start).
    pub(crate) fn add(&mut self, times: &[f64], drive: &Drive) {
        let time_s = &drive.rows().time_s;
        let ends = time_s.first().zip(time_s.last());
        let meta = drive.meta();
        self.rides.push(PressedRide {
            participant: meta.participant.clone(),
            condition: meta.condition,
            drive: meta.drive.clone(),
            minutes: ends.map_or(0.0, |(first, last)| (last - first) / 60.0),
            presses: times.len(),
        });
        self.moments.extend(press_moments(drive, times));
    }

    /// Adds what another has, after its own.
    pub(crate) fn extend(&mut self, other: Self) {
        self.rides.extend(other.rides);
        self.moments.extend(other.moments);
    }

    /// Writes both beside the measurements; how many rides and presses there are.
    pub(crate) fn write(&self, measurements: &Path) -> Result<(usize, usize), StudyError> {
        write_rows(TableName::Presses, &presses_path(measurements), &self.rides)?;
        let path = press_moments_path(measurements);
        write_rows(TableName::PressMoments, &path, &self.moments)?;
        let presses = self.rides.iter().map(|ride| ride.presses).sum();
        Ok((self.rides.len(), presses))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn event(page: &str, attempt: u32, what: &str, time_s: f64) -> EventRow {
        EventRow {
            participant: ParticipantId::new("P001").unwrap(),
            step: 1,
            page: page.to_owned(),
            moment: None,
            attempt: Some(attempt),
            time_s: Some(time_s),
            what: what.to_owned(),
            value: None,
            at: None,
        }
    }

    #[test]
    fn of_a_ride_that_was_begun_twice_the_whole_one_counts_and_a_ride_without_a_press_is_there() {
        let events = [
            event("calm", 1, "begun", 0.0),
            event("calm", 1, "uncomfortable", 3.0),
            event("calm", 1, "ended", 60.0),
            event("calm", 2, "begun", 0.0),
            event("calm", 2, "uncomfortable", 4.0),
            event("sporty", 1, "begun", 0.0),
            event("sporty", 1, "uncomfortable", 5.0),
            event("sporty", 2, "begun", 0.0),
            event("quiet", 1, "begun", 0.0),
            event("quiet", 1, "ended", 60.0),
        ];
        let presses = Presses::from_events(&events);
        let of = |page: &str| {
            let key = (ParticipantId::new("P001").unwrap(), page.to_owned());
            presses.0.get(&key).cloned()
        };
        assert_eq!(of("calm"), Some(vec![3.0]));
        assert_eq!(of("sporty"), Some(Vec::new()));
        assert_eq!(of("quiet"), Some(Vec::new()));
        assert_eq!(of("another"), None);
    }
}
