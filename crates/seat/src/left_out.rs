//! What the experimenter does with the step at which somebody is: it is skipped, or nothing is driven any more.

use crate::{
    books::{Books, now, whole},
    error::SeatError,
    person::{Person, lets_in},
    seat::Seat,
    steps::{Act, Step},
};
use maveric_domain::Moment;
use maveric_seat_page::RideStyle;
use rusqlite::params;

/// What the experimenter did with a step, and why.
pub(crate) struct Done {
    /// The step that it is about, or at which somebody was then.
    pub(crate) step: usize,
    /// The last attempt that was set aside by it, with those before it; none where none was.
    pub(crate) attempt: Option<u32>,
    /// Such as `skipped: the wheel came loose` or `extended by 5 min: the lead was late`.
    pub(crate) what: String,
    /// In s since 1970.
    pub(crate) given: i64,
}

impl Books<'_> {
    /// Whether a step of somebody was left out.
    pub(crate) fn is_left_out(&self, participant: &str, step: usize) -> Result<bool, SeatError> {
        self.ask(|c| {
            c.prepare_cached("SELECT 1 FROM left_out WHERE participant = ?1 AND step = ?2")?
                .exists(params![participant, whole(step)])
        })
    }

    /// The steps of somebody that were left out.
    pub(crate) fn left_out(&self, participant: &str) -> Result<Vec<Done>, SeatError> {
        self.done_with(("left_out", "NULL"), participant)
    }

    /// What a table has of somebody, the oldest first; `attempt` is its column of [`Done::attempt`].
    pub(crate) fn done_with(
        &self,
        (table, attempt): (&str, &str),
        participant: &str,
    ) -> Result<Vec<Done>, SeatError> {
        let question = format!(
            "SELECT step, {attempt}, what, given FROM {table} WHERE participant = ?1 ORDER BY rowid"
        );
        self.rows(&question, [participant], |row| {
            Ok(Done {
                step: row.get::<_, i64>(0)? as usize,
                attempt: row.get(1)?,
                what: row.get(2)?,
                given: row.get(3)?,
            })
        })
    }

    /// Whether the experimenter ended somebody's driving.
    pub(crate) fn is_aborted(&self, participant: &str) -> Result<bool, SeatError> {
        let left_out = self.left_out(participant)?;
        Ok(left_out.iter().any(|left| left.what.starts_with(Act::Abort.past())))
    }

    fn leave_out(&self, participant: &str, step: usize, what: &str) -> Result<(), SeatError> {
        self.change(
            "INSERT INTO left_out VALUES (?1, ?2, ?3, ?4)",
            params![participant, whole(step), what, now()],
        )
    }
}

/// Why this cannot be done with the step at which somebody is; none where it can.
fn hindrance(person: &Person, act: Act) -> Option<&'static str> {
    let ride_needs_fit = |step: &Step| {
        let needs_fit = |style: &RideStyle| !matches!(style, RideStyle::Mean | RideStyle::Given(_));
        matches!(step, Step::Ride { style, .. } if needs_fit(style))
    };
    let mut ahead = person.steps.iter().skip(person.at);
    match (act, ahead.clone().next()) {
        (_, None | Some(Step::Thanks { .. })) => Some("this is the end"),
        (Act::Skip, Some(step)) if lets_in(step) => {
            Some("nobody goes on who was not admitted and has not agreed")
        }
        (Act::Skip, Some(step))
            if step.is_learned_of() && person.fit.is_none() && ahead.any(ride_needs_fit) =>
        {
            Some("the rides need the style that is learned of this drive")
        }
        (Act::Skip, _) => None,
        (Act::Abort, _) if ahead.clone().any(lets_in) => {
            Some("somebody who has not agreed yet has nothing to be aborted")
        }
        (Act::Abort, _) => {
            (!ahead.any(|step| step.world().is_some())).then_some("nothing is driven any more")
        }
    }
}

impl Seat {
    /// Leaves out the step at which somebody is, for a reason that stands in the record: what was driven of it is kept, cut short as it is,
    /// and a drive or a ride is out of the analysis by name.
    ///
    /// # Errors
    /// [`SeatError::Nobody`]; [`SeatError::Protocol`] for somebody who is elsewhere by now or has ended, a step that cannot be left out, or
    /// no reason; [`SeatError::Store`]; [`SeatError::Study`] if a file cannot be written.
    pub fn leave_out(
        &self,
        participant: &str,
        step: usize,
        act: Act,
        reason: &str,
    ) -> Result<(), SeatError> {
        let person = self.store.look(|b| there(b, participant, step))?;
        let reason = said_why(reason)?;
        if let Some(why) = hindrance(&person, act) {
            let number = step + 1;
            return Err(SeatError::cannot(
                format!("step {number} of `{participant}` cannot be {}: {why}", act.past()),
                "let them go on, leave by their own page, or forget them",
            ));
        }
        let what = format!("{}: {reason}", act.past());
        if let Some(there) = person.steps.get(step) {
            let why = format!("the experimenter left it out ({what})");
            self.write_drive(&person, (step, there), Some(&why))?;
        }
        self.store.within(|b| {
            // Who went on meanwhile is not held back.
            there(b, participant, step)?;
            b.leave_out(participant, step, &what)?;
            b.event(Some(participant), &format!("step {}: {what}", step + 1))?;
            if act == Act::Abort {
                return b.stop(&person, step);
            }
            b.go_on(&person, step)?;
            // Nobody is asked about a ride of which there was nothing.
            if b.begun(participant, step)?.iter().all(|begun| begun.set_aside) {
                for asked in step + 1..step + 1 + asked_after(&person.steps, step) {
                    b.leave_out(participant, asked, &what)?;
                    b.go_on(&person, asked)?;
                }
            }
            Ok(())
        })
    }
}

/// How many sheets are asked about the ride of a step, right after it.
fn asked_after(steps: &[Step], step: usize) -> usize {
    let ride = steps.get(step).and_then(Step::ridden);
    let about = |step: &&Step| match step {
        Step::Scale { moment: Moment::After(of), .. } => Some(*of) == ride,
        _ => false,
    };
    steps.iter().skip(step + 1).take_while(about).count()
}

/// A reason, which the experimenter gives for everything that is done with a person's steps.
pub(crate) fn said_why(reason: &str) -> Result<&str, SeatError> {
    let reason = reason.trim();
    if reason.is_empty() {
        return Err(SeatError::cannot("this is done for a reason, and none was given", "say why"));
    }
    Ok(reason)
}

/// Somebody who is at this step.
pub(crate) fn there(b: &Books<'_>, participant: &str, step: usize) -> Result<Person, SeatError> {
    let person = b.called(participant)?;
    let elsewhere = match &person.ended {
        Some(how) => format!("the part of `{participant}` has ended: {how}"),
        None if person.at == step => return Ok(person),
        None => format!(
            "`{participant}` is at step {} of {} by now, not at step {}",
            person.at + 1,
            person.steps.len(),
            step + 1
        ),
    };
    Err(SeatError::cannot(elsewhere, "nothing was changed: look at the page again"))
}
