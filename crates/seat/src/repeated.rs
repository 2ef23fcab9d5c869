//! What the experimenter has driven once more: what was driven before is set aside, and what is driven then counts.

use crate::{
    books::{Books, now, whole},
    error::SeatError,
    left_out::{Done, said_why, there},
    listed::Listed,
    person::Person,
    seat::Seat,
    steps::Step,
};
use maveric_domain::{DriveId, ParticipantId};
use rusqlite::params;

impl Books<'_> {
    /// What somebody drove once more.
    pub(crate) fn repeated(&self, participant: &str) -> Result<Vec<Done>, SeatError> {
        self.done_with(("repeated", "attempt"), participant)
    }

    fn set_aside(
        &self,
        participant: &str,
        (step, attempt): (usize, u32),
        what: &str,
    ) -> Result<(), SeatError> {
        self.change(
            "INSERT INTO repeated VALUES (?1, ?2, ?3, ?4, ?5)",
            params![participant, whole(step), attempt, what, now()],
        )?;
        // What was answered on the way is in the record of what was driven.
        self.change(
            "DELETE FROM answer WHERE participant = ?1 AND step = ?2",
            params![participant, whole(step)],
        )
    }

    /// Whether somebody is at a step that they drive once more.
    pub(crate) fn repeats(&self, person: &Person) -> Result<bool, SeatError> {
        let begun = self.begun(&person.participant, person.at)?;
        Ok(begun.iter().any(|begun| begun.set_aside))
    }
}

/// The step that somebody drove last and may drive again, with its last attempt; or why nothing is driven again.
fn last_driven(
    b: &Books<'_>,
    person: &Person,
) -> Result<Result<(usize, u32), &'static str>, SeatError> {
    let who = &person.participant;
    let Some(now_at) = person.steps.get(person.at) else {
        return Ok(Err("this is the end"));
    };
    if matches!(now_at, Step::Aftercare { .. } | Step::Text { .. } | Step::Thanks { .. }) {
        return Ok(Err("nothing is driven any more, or nothing was driven yet"));
    }
    for (step, driven) in person.steps.iter().enumerate().take(person.at + 1).rev() {
        if driven.world().is_none() {
            continue;
        }
        let Some(last) = b.begun(who, step)?.pop() else {
            continue;
        };
        if last.set_aside {
            return Ok(Err("it is to be driven again already, and nothing of that has come yet"));
        }
        if b.is_left_out(who, step)? {
            return Ok(Err("what was driven last was left out"));
        }
        if person.at > step + 1 {
            return Ok(Err("what is asked after it was answered already"));
        }
        let lent = |step: &Step| matches!(step, Step::Ride { lent: Some(_), .. });
        if driven.is_learned_of() && person.steps.iter().any(lent) {
            return Ok(Err("somebody else’s style was lent by what was learned of it"));
        }
        let sheets = b.answers(who)?;
        if sheets.iter().any(|sheet| sheet.step == step && sheet.listed != Listed::NotYet) {
            return Ok(Err("what was answered on the way stands in the study’s table already"));
        }
        return Ok(Ok((step, last.attempt)));
    }
    Ok(Err("nothing was driven yet"))
}

impl Seat {
    /// Has somebody drive again what they drove last, for a reason that stands in the record: what they drove before is kept and counts no
    /// more. `at` is the step at which they are.
    ///
    /// # Errors
    /// [`SeatError::Nobody`]; [`SeatError::Protocol`] for somebody who is elsewhere by now or has ended, who has nothing to drive again, or no
    /// reason; [`SeatError::Store`]; [`SeatError::Study`] if a file cannot be written.
    pub fn repeat(&self, participant: &str, at: usize, reason: &str) -> Result<(), SeatError> {
        let reason = said_why(reason)?;
        let what = format!("repeated: {reason}");
        self.store.within(|b| {
            let person = there(b, participant, at)?;
            let (step, attempt) = last_driven(b, &person)?.map_err(|why| {
                SeatError::cannot(
                    format!("`{participant}` drives nothing again: {why}"),
                    "let them go on, or skip a step",
                )
            })?;
            b.set_aside(participant, (step, attempt), &what)?;
            b.event(Some(participant), &format!("step {}: {what}", step + 1))?;
            b.go_to(&person, person.at, step)?;
            let Some((ride, _)) = person.steps.get(step).and_then(Step::drives) else {
                return Ok(());
            };
            let id = ParticipantId::new(participant)?;
            let name = DriveId::in_condition(&id, ride)?;
            for begun in b.begun(participant, step)? {
                let lines = b.record(participant, (step, begun.attempt))?;
                let files = &self.settings.files;
                files.record(name.as_str(), Some(begun.kept_as()), &lines)?;
            }
            // Last: where it fails nothing is changed.
            self.settings.files.take_back(name.as_str())
        })
    }
}
