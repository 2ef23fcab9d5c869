//! What becomes of a drive that has ended: it is driven again from its record, so that the log holds what the page went through, and
//! a drive by hand is learned from here too.

use crate::{error::SeatError, person::Person, seat::Seat, steps::Step};
use maveric_seat_page::{Fit, Record, Replayed, fit, replay};
use std::fmt;

/// Embeddings of the page and of a processor that fuses its sums agree to this.
const SAME_STYLE: f64 = 1e-5;

impl Seat {
    /// Writes the drive of `step` and those that were cut short before it; false, and nothing done, while none has ended.
    ///
    /// What cannot be driven again is kept as it came, said on the experimenter's page, and holds nobody up.
    ///
    /// # Errors
    /// [`SeatError::Store`]; [`SeatError::Study`] if a file cannot be written.
    pub(crate) fn finish_drive(
        &self,
        person: &Person,
        step: usize,
        found: &Step,
    ) -> Result<bool, SeatError> {
        let begun = self.store.begun(&person.participant, step)?;
        let Some(whole) = begun.iter().find(|b| b.ended) else {
            return Ok(false);
        };
        let Some((condition, by_hand)) = found.drives() else {
            return Ok(true);
        };
        let (who, files) = (&person.participant, &self.settings.files);
        let name = format!("{who}-{condition}");
        for cut in begun.iter().filter(|b| b.attempt != whole.attempt) {
            let lines = self.store.record(who, (step, cut.attempt))?;
            files.record(&name, Some(cut.attempt), &lines)?;
        }
        let lines = self.store.record(who, (step, whole.attempt))?;
        files.record(&name, None, &lines)?;
        let driven = Record::from_lines(&lines).and_then(|record| Ok((replay(&record)?, record)));
        match driven {
            Err(error) => self.tell(who, &format!("{name}: cannot be driven again: {error}"))?,
            Ok((again, record)) => {
                let pictures = Pictures::of(&record);
                let note = pictures.note();
                let kept = (&record, &*lines, note.as_deref());
                files.log(&name, (who, condition), kept, &again)?;
                self.tell(who, &format!("{name}: {pictures}"))?;
                if !again.same() {
                    let text = "the page came through other states than its record gives here";
                    self.tell(who, &format!("{name}: {text}"))?;
                }
                if let Step::Ride {
                    turns: Some(step), ..
                } = found
                {
                    let events = record.chunks.iter().flat_map(|c| &c.events);
                    let turned: Vec<(f64, f64)> = events
                        .filter(|e| e.what == "dial")
                        .filter_map(|e| Some((e.tick as f64 / 100.0, e.points?)))
                        .collect();
                    let seconds = record.ticks() as f64 / 100.0;
                    files.turns((&name, who), &turned, step.abs(), seconds)?;
                }
                if by_hand {
                    self.learn(person, &name, &record, &again)?;
                }
            }
        }
        Ok(true)
    }

    fn tell(&self, who: &str, what: &str) -> Result<(), SeatError> {
        self.store.event(Some(who), what)
    }

    /// Learns of a drive by hand where the page did not come to it, and holds what the page learned against it.
    fn learn(
        &self,
        person: &Person,
        name: &str,
        record: &Record,
        again: &Replayed,
    ) -> Result<(), SeatError> {
        let Some(model) = &self.model else {
            return Ok(());
        };
        let who = &person.participant;
        let here = match fit(model, &again.rollout.recording, record.header.driven_by) {
            Ok(here) => here,
            Err(error) => return self.tell(who, &format!("{name}: no style learned: {error}")),
        };
        let page: Option<Fit> = person
            .fit
            .as_deref()
            .and_then(|f| serde_json::from_str(f).ok());
        let Some(page) = page else {
            let kept = serde_json::to_string(&here).unwrap_or_default();
            return self.store.fit(&person.token, &kept);
        };
        let apart = (page.embedding.iter().zip(&here.embedding))
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        if page.embedding.len() != here.embedding.len() || apart > SAME_STYLE {
            let text = format!(
                "{name}: the page learned another style than its record gives here, {apart:.2e} apart"
            );
            self.tell(who, &text)?;
        }
        Ok(())
    }
}

/// How the pictures of a drive came.
struct Pictures {
    seconds: f64,
    drawn: u64,
    late: u64,
    left_out: u64,
    longest_ms: u32,
    input_ms: u32,
}

impl Pictures {
    fn of(record: &Record) -> Self {
        let frames = || record.chunks.iter().map(|c| c.frames);
        Self {
            seconds: record.ticks() as f64 / 100.0,
            drawn: frames().map(|f| u64::from(f.drawn)).sum(),
            late: frames().map(|f| u64::from(f.late)).sum(),
            left_out: frames().map(|f| u64::from(f.dropped_steps)).sum(),
            longest_ms: frames().map(|f| f.longest_ms).max().unwrap_or(0),
            input_ms: frames().map(|f| f.input_ms).max().unwrap_or(0),
        }
    }

    /// What the drive's log says of them where more than one in a hundred came late.
    fn note(&self) -> Option<String> {
        let Self { drawn, late, .. } = self;
        (100 * late > *drawn).then(|| {
            format!("{late} of {drawn} pictures came more than 50 ms after the one before: more than 1 %")
        })
    }
}

impl fmt::Display for Pictures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rate = self.drawn as f64 / self.seconds.max(0.01);
        write!(
            f,
            "{:.0} s, {rate:.1} pictures a second, {} of {} over 50 ms after the one before (longest {} ms)",
            self.seconds, self.late, self.drawn, self.longest_ms
        )?;
        if self.input_ms > 0 {
            write!(f, ", a key seen after at most {} ms", self.input_ms)?;
        }
        write!(f, ", {} steps left out", self.left_out)?;
        self.note()
            .map_or(Ok(()), |_| write!(f, "; more than 1 % came late"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_of_which_more_than_one_picture_in_a_hundred_came_late_says_so() {
        let pictures = |late| Pictures {
            seconds: 10.0,
            drawn: 600,
            late,
            left_out: 0,
            longest_ms: 80,
            input_ms: 0,
        };
        assert_eq!(pictures(6).note(), None);
        assert!(pictures(7).note().unwrap().starts_with("7 of 600 pictures"));
        assert!(
            pictures(7)
                .to_string()
                .ends_with("0 steps left out; more than 1 % came late")
        );
    }
}
