//! What the experimenter decides of somebody beside the step at which they are: something is driven longer, or everything that they drove is
//! out of the analysis.

use crate::{
    books::{Books, now, whole},
    error::SeatError,
    left_out::{Done, said_why, there},
    person::Person,
    seat::Seat,
    steps::{Step, TICKS_PER_S},
};
use maveric_domain::{ParticipantId, design::DRIVES_S};
use maveric_study::tables::collected::Stopped;
use rusqlite::params;

/// How what was decided begins in the record.
const EXTENDED: &str = "extended by ";
const EXCLUDED: &str = "excluded: ";
const COUNTS_AGAIN: &str = "counts again: was left out of the analysis";

impl Done {
    /// Whether everything that somebody drove is out of the analysis by it, or counts again; none where it is about something else.
    fn excludes(&self) -> Option<bool> {
        let excluded = self.what.starts_with(EXCLUDED);
        (excluded || self.what == COUNTS_AGAIN).then_some(excluded)
    }
}

impl Books<'_> {
    /// What was decided of somebody, the oldest first.
    pub(crate) fn decided(&self, participant: &str) -> Result<Vec<Done>, SeatError> {
        self.done_with(("decided", "NULL"), participant)
    }

    fn decide(&self, participant: &str, step: usize, what: &str) -> Result<(), SeatError> {
        self.change(
            "INSERT INTO decided VALUES (?1, ?2, ?3, ?4)",
            params![participant, whole(step), what, now()],
        )?;
        self.event(Some(participant), &format!("step {}: {what}", step + 1))
    }

    /// Why everything that somebody drove is out of the analysis, as it stands in the record; none where it is not.
    pub(crate) fn excluded(&self, participant: &str) -> Result<Option<String>, SeatError> {
        let decided = self.decided(participant)?;
        let last = decided.into_iter().rfind(|decided| decided.excludes().is_some());
        Ok(last.filter(|decided| decided.excludes() == Some(true)).map(|decided| decided.what))
    }

    /// Whether it was ever decided of somebody that all that they drove is out of the analysis.
    pub(crate) fn was_excluded(&self, participant: &str) -> Result<bool, SeatError> {
        let decided = self.decided(participant)?;
        Ok(decided.iter().any(|decided| decided.excludes().is_some()))
    }

    /// What somebody drove and rode, also elsewhere, each left out with the reason why everything is; nothing where it is not.
    pub(crate) fn left_out_with(
        &self,
        person: &Person,
        who: &ParticipantId,
    ) -> Result<Vec<Stopped>, SeatError> {
        let Some(reason) = self.excluded(&person.participant)? else {
            return Ok(Vec::new());
        };
        let mut rows = Vec::new();
        for (step, found) in person.steps.iter().enumerate() {
            let Some(ride) = found.ride() else {
                continue;
            };
            let last = self.begun(&person.participant, step)?.pop();
            let elsewhere = found.drives().is_none() && step < person.at;
            if last.is_some() || elsewhere {
                rows.push(Stopped {
                    participant: who.clone(),
                    condition: ride.condition,
                    session: ride.occasion.session,
                    trial: ride.occasion.trial,
                    time_s: last.map_or(0, |begun| begun.ticks) as f64 / TICKS_PER_S,
                    reason: reason.clone(),
                });
            }
        }
        Ok(rows)
    }
}

impl Seat {
    /// Lets somebody drive or ride longer at the next step at which that is done, by so many minutes, for a reason that stands in the record.
    /// `at` is the step at which they are.
    ///
    /// # Errors
    /// [`SeatError::Nobody`]; [`SeatError::Protocol`] for somebody who is elsewhere by now or has ended, who drives no more or has begun to,
    /// minutes with which it is longer than a drive can be, or no reason; [`SeatError::Store`].
    pub fn extend(
        &self,
        participant: &str,
        at: usize,
        minutes: f64,
        reason: &str,
    ) -> Result<(), SeatError> {
        let reason = said_why(reason)?;
        let person = self.store.within(|b| {
            let mut person = there(b, participant, at)?;
            let mut ahead = person.steps.iter_mut().enumerate().skip(at);
            let next = ahead.find_map(|(step, found)| Some((step, found.seconds_mut()?)));
            let Some((step, seconds)) = next else {
                return Err(SeatError::cannot(
                    format!("`{participant}` drives nothing any more"),
                    "let them go on",
                ));
            };
            let before = *seconds;
            let longest = DRIVES_S[1];
            *seconds += 60.0 * minutes;
            if !(minutes > 0.0 && *seconds <= longest) {
                let most = (longest - before) / 60.0;
                return Err(SeatError::cannot(
                    format!("{minutes} minutes more, expected more than 0 and at most {most}"),
                    "a drive has at most two hours",
                ));
            }
            let begun = b.begun(participant, step)?;
            if begun.last().is_some_and(|begun| !begun.set_aside) {
                return Err(SeatError::cannot(
                    format!("what `{participant}` drives at step {} has begun", step + 1),
                    "have it driven again first, and extend it then",
                ));
            }
            b.set_steps(&person.participant, &person.steps)?;
            b.decide(participant, step, &format!("{EXTENDED}{minutes} min: {reason}"))?;
            Ok(person)
        })?;
        self.add_link(&person);
        Ok(())
    }

    /// Leaves everything that somebody drove, and will, out of the analysis by name, with the answers after it, for a reason that stands in
    /// the record; without a reason it counts again.
    ///
    /// # Errors
    /// [`SeatError::Nobody`]; [`SeatError::Protocol`] where it counts already, or is left out already; [`SeatError::Store`];
    /// [`SeatError::Study`] if a file cannot be written.
    pub fn exclude(&self, participant: &str, reason: &str) -> Result<(), SeatError> {
        let reason = reason.trim();
        self.store.within(|b| {
            let person = b.called(participant)?;
            let step = person.at.min(person.steps.len().saturating_sub(1));
            match (b.excluded(participant)?, reason.is_empty()) {
                (None, false) => b.decide(participant, step, &format!("{EXCLUDED}{reason}")),
                (Some(_), true) => b.decide(participant, step, COUNTS_AGAIN),
                (None, true) => said_why(reason).map(drop),
                (Some(what), false) => Err(SeatError::cannot(
                    format!("`{participant}` is left out already ({what})"),
                    "let what they drove count again first",
                )),
            }
        })?;
        self.write_all()
    }
}

impl Step {
    /// How long is driven here, practice included, to be changed.
    pub(crate) fn seconds_mut(&mut self) -> Option<&mut f64> {
        match self {
            Self::Practice { seconds, .. }
            | Self::Drive { seconds, .. }
            | Self::Ride { seconds, .. } => Some(seconds),
            _ => None,
        }
    }
}
